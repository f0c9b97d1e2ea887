#include "examples/calibrate_skin/steps.hpp"

#include <chrono>

#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"
#include "skinctl/io/skin_file.hpp"

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

std::vector<Step> steps_of(const Options& options, const World& world) {
  std::vector<Step> all = {
      {"network", "network.json", "cells find their ids, their neighbours and their tree",
       [&] { return network_step(world, options); }},
      {"rest", "rest.json", "the robot rests in eight poses", [&] { return rest_step(world, options); }},
      {"shape", "shape.json", "patches are reconstructed from gravity", [&] { return shape_step(options); }},
      {"motion", "motion.json", "the robot moves for a minute: each joint alone, then all",
       [&] { return motion_step(world, options); }},
      {"lines", "lines.json", "links, axes and places are found from the motion",
       [&] { return lines_step(options); }},
      {"camera", "camera.json", "patches are placed on their links",
       [&] { return camera_step(world, options); }},
      {"result", "result.json", "what is not known well enough is masked",
       [&] { return result_step(world, options); }},
      {"torques", "torques.json", "the robot moves for forty seconds: its currents are recorded",
       [&] { return torques_step(world, options); }},
      {"masses", "masses.json", "masses, friction and rotors are found from the currents",
       [&] { return masses_step(world, options); }},
  };
  if (!options.masses)
    std::erase_if(all, [](const Step& s) { return s.name == "torques" || s.name == "masses"; });
  return all;
}

bool run_steps(const Options& options, const World& world, const std::string& again,
               const std::string& until) {
  const auto steps = steps_of(options, world);
  bool anew = false;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (k > 0 && steps[k - 1].name == until) return true;
    const Step& step = steps[k];
    const std::string head = text("[%zu/%zu] ", k + 1, steps.size()) + step.name + ": ";
    const fs::path file = options.folder / step.file;
    anew = anew || step.name == again;
    try {
      if (!anew && fs::exists(file)) {
        options.say(head + "kept: " + read_json(file).at("said").get<std::string>());
        continue;
      }
      if (options.arm.stop != nullptr && *options.arm.stop) throw Interrupted{};
      if (!anew || step.name == again) {
        for (std::size_t later = k; later < steps.size(); ++later)
          fs::remove(options.folder / steps[later].file);
        for (const char* result : {"skin.json", "model.urdf", "dh.txt", "report.html"})
          fs::remove(options.folder / result);
      }
      anew = true;
      options.say(head + step.purpose);
      const auto from = std::chrono::steady_clock::now();
      const Json found = step.run();
      write_json(file, found);
      options.say(
          "  " + found.at("said").get<std::string>() +
          text(" (%.1f s)", std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count()));
    } catch (const Json::exception& e) {
      throw std::runtime_error("step " + step.name + ": a file is not as the step before wrote it (" +
                               e.what() + "); --again with that step's name makes it anew");
    } catch (const ConfigurationError& e) {
      throw ConfigurationError("step " + step.name + ": " + e.what());
    } catch (const std::runtime_error& e) {
      throw std::runtime_error("step " + step.name + ": " + e.what());
    }
  }
  return false;
}

std::optional<std::size_t> calibrate(const Options& options, std::uint64_t seed, const std::string& again,
                                     const std::string& until, const std::string& truth) {
  fs::create_directories(options.folder);
  Json which = {{"seed", seed},
                {"shoulder_by_hand", options.shoulder_by_hand},
                {"camera", options.camera},
                {"masses", options.masses},
                {"robot", options.arm.host}};
  if (options.wire.port != 0) which["skin"] = "wire";
  const Robot &robot = options.arm.robot, &maker = ur5_robot();
  if (robot.name != maker.name || robot.home != maker.home || options.arm.protocol != "ur")
    which["model"] = {robot.name, robot.home, options.arm.protocol};
  if (!options.camera_device.lens.empty()) which["lens"] = options.camera_device.lens.string();
  const fs::path described = options.folder / "which.json";
  if (fs::exists(described) && read_json(described) != which)
    throw ConfigurationError(options.folder.string() +
                             " holds a calibration with other options: choose another folder");
  write_json(described, which);
  const World world(seed);
  try {
    if (run_steps(options, world, again, until)) return std::nullopt;
  } catch (...) {
    // What motion and camera found does not depend on the masses, nor on anything else that comes behind it.
    if (fs::exists(options.folder / "result.json")) write_results(options);
    throw;
  }
  write_results(options);
  const SkinFile skin = read_skin_file((options.folder / "skin.json").string());
  if (!truth.empty()) write_skin_file(true_skin_file(skin, world), truth);
  return skin.cells();
}

void write_worn(const fs::path& folder, std::uint64_t seed) {
  fs::create_directories(folder);
  const World world(seed);
  write_skin_file(worn_skin_file(world), (folder / "worn.json").string());
  write_json(folder / "network.json", network_step(world, {}));
}

}  // namespace calibrate_skin
