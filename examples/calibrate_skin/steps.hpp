// The steps of a skin's calibration, each from files to a file: what has been done is kept.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "examples/calibrate_skin/calibration.hpp"
#include "skinctl/calibration/sighting_types.hpp"
#include "skinctl/io/skin_contents.hpp"

namespace calibrate_skin {

class World;
using Json = nlohmann::json;

/// A step: its name, the file it writes, and what it is for. Each reads what those before it wrote; a text in
/// `"said"` of its result is for the user.
struct Step {
  std::string name, file, purpose;
  std::function<Json()> run;
};
[[nodiscard]] std::vector<Step> steps_of(const Options& options, const World& world);

/// Runs the steps whose files are missing, and all behind the first of them or behind `again`; then writes
/// the results. Before a step runs, the files of what stands on it are removed. With `until` it ends behind
/// that step, true if that was not the last. Throws `ConfigurationError` or `std::runtime_error` with the
/// step's name, and `Interrupted`; the files of the steps before it stay.
bool run_steps(const Options& options, const World& world, const std::string& again = {},
               const std::string& until = {});

/// From `result.json` and `lines.json`, each whatever becomes of the others: `skin.json`, `model.urdf`,
/// `dh.txt`, `report.html`. Throws `std::runtime_error` if no patch is known well enough for a skin file.
void write_results(const Options& options);

/// Throws `std::runtime_error` for a file that is missing or no JSON.
[[nodiscard]] Json read_json(const fs::path& path);
/// Whole or not at all.
void write_text(const fs::path& path, const std::string& text);
void write_json(const fs::path& path, const Json& value);

/// The skin file of `result.json`, on the robot's links.
[[nodiscard]] skinctl::SkinFile skin_file_of(const Robot& robot, const Json& result);
/// The same cells where they truly are, on a UR5: for judging only.
[[nodiscard]] skinctl::SkinFile true_skin_file(skinctl::SkinFile found, const World& world);

/// All cells where they truly are, a patch a link: for a simulated robot that wears them.
[[nodiscard]] skinctl::SkinFile worn_skin_file(const World& world);

/// `{p, q}`, and back.
[[nodiscard]] Json json_of(const skinctl::FitPose& X);
[[nodiscard]] skinctl::FitPose pose_of(const Json& X);

}  // namespace calibrate_skin
