// What each step of a calibration does: from files of the folder, the robot and the skin to the contents of
// its own file.
#pragma once

#include <string>
#include <vector>

#include "examples/calibrate_skin/arm.hpp"
#include "examples/calibrate_skin/steps.hpp"

namespace calibrate_skin {

[[nodiscard]] Json network_step(const World& world, const Options& options);
[[nodiscard]] Json rest_step(const World& world, const Options& options);
[[nodiscard]] Json shape_step(const Options& options);
[[nodiscard]] Json motion_step(const World& world, const Options& options);
[[nodiscard]] Json lines_step(const Options& options);
[[nodiscard]] Json camera_step(const World& world, const Options& options);
[[nodiscard]] Json torques_step(const World& world, const Options& options);
[[nodiscard]] Json masses_step(const World& world, const Options& options);
[[nodiscard]] Json result_step(const World& world, const Options& options);

/// Into `placed`, where the patches of `shapes` lie whose first cell is in `file`, as the placing page saves
/// it. Throws `std::runtime_error` if that lies on another link than it moves with (`moved`).
void place_by(const Robot& robot, const skinctl::SkinFile& file, const Json& shapes, const Json& moved,
              Json& placed);
/// Throws `ConfigurationError` if nobody agrees to this motion.
void ask(const Options& options, std::vector<std::string> announcement);
/// A tour of poses, in words.
[[nodiscard]] std::string announced(const Robot& robot, const std::vector<JointAngles>& poses,
                                    double seconds);
/// The robot stands in each of the poses, and goes home; where it stood.
[[nodiscard]] std::vector<Arm::Stand> stands(Arm& arm, const std::vector<JointAngles>& poses,
                                             const Options& options);
[[nodiscard]] std::vector<JointAngles> truths(const std::vector<Arm::Stand>& stands);

}  // namespace calibrate_skin
