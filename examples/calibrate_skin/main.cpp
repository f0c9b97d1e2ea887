// Calibrates a skin that was glued on this morning: from cells without names to a skin file, a robot model
// and a report.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <numbers>

#include "examples/calibrate_skin/calibration.hpp"
#include "examples/support/job.hpp"
#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"

#ifdef CALIBRATE_SKIN_HAS_CAMERA
#include "examples/calibrate_skin/wire_camera.hpp"
#endif

namespace {

using namespace calibrate_skin;
namespace job = examples::job;

void listen_at(const std::string& where, Options& options, bool no_camera) {
  const auto colon = where.rfind(':');
  if (colon != std::string::npos) options.wire.address = where.substr(0, colon);
  const int port = std::atoi(where.c_str() + (colon == std::string::npos ? 0 : colon + 1));
  skinctl::require(port >= 1 && port <= 65535, "--skin: the port", port, "1 to 65535");
  options.wire.port = static_cast<std::uint16_t>(port);
  if (options.arm.host.empty())
    throw skinctl::ConfigurationError(
        "--skin: a skin that exists sits on a robot that exists; --robot names it");
  if (options.wire.network.empty())
    throw skinctl::ConfigurationError(
        "--skin: its datagrams do not say who is joined to whom; --network does");
  if (!no_camera && options.camera_device.lens.empty())
    throw skinctl::ConfigurationError(
        "--skin: --camera names the lens of a camera that looks at it; --no-camera places the patches by "
        "motion alone");
}

/// Another robot than a UR5, in options of their own.
void add_model([[maybe_unused]] CLI::App& app, [[maybe_unused]] UrdfRobot& model,
               [[maybe_unused]] ArmOptions& arm) {
#ifdef CALIBRATE_SKIN_HAS_URDF
  auto* given = app.add_option("--model", model.file,
                               "URDF of another robot: a chain of six or seven joints with limits")
                    ->check(CLI::ExistingFile);
  const auto add = [&](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->needs(given)->group("Model");
  };
  add("--tip", model.tip, "last link of the chain, where the URDF has more behind it");
  add("--home", model.home,
      "joints [rad] where it stands before each motion; the middle of its limits if left out");
  add("--reach", model.reach, "farthest way of a joint from home [rad]")->check(CLI::Range(0.3, 3.14));
  add("--acceleration", model.acceleration, "of its joints at most [rad/s^2]")->check(CLI::Range(0.5, 100.0));
  add("--jerk", model.jerk, "[rad/s^3]")->check(CLI::Range(10.0, 1e5));
  add("--arm", arm.protocol, "who moves it: ur, stream_motion, rsi, egm, fri, franka")
      ->check(CLI::IsMember({"ur", "stream_motion", "rsi", "egm", "fri", "franka"}));
  add("--arm-port", arm.port, "of its controller, or for rsi, egm and fri of this computer");
  add("--arm-period", arm.period, "of rsi, egm, fri [s]")->check(CLI::Range(0.001, 0.1));
  add("--max-correction", arm.max_correction,
      "of rsi: of AXISCORR and AXISCORRMON, from where the arm stands [deg]")
      ->check(CLI::Range(20.0, 360.0));
  add("--stiffness", arm.stiffness, "franka: of each joint's spring [N m/rad]");
#endif
}
/// Masses come from a UR5's currents, and the simulated skin is made for its tubes.
void take_model([[maybe_unused]] UrdfRobot model, const std::string& skin, Options& options) {
  if (skin.empty())
    throw skinctl::ConfigurationError("--model: what is simulated is a UR5; --skin names a skin that exists");
  options.masses = false;
#ifdef CALIBRATE_SKIN_HAS_URDF
  constexpr double beside_home = 0.05, degree = std::numbers::pi / 180;  // it need not stand there exactly
  if (options.arm.protocol == "rsi" && model.reach == UrdfRobot{}.reach)
    model.reach = std::min(model.reach, degree * options.arm.max_correction - beside_home);
  options.arm.robot = robot_of(model);
#endif
}

/// The camera is opened when its first image is wanted.
void look_by([[maybe_unused]] const std::string& device, [[maybe_unused]] Options& options) {
#ifdef CALIBRATE_SKIN_HAS_CAMERA
  options.camera_device.take = [device, images = std::shared_ptr<VideoImages>()]() mutable {
    if (!images) images = std::make_shared<VideoImages>(device);
    return (*images)();
  };
#endif
}

int run(int argc, char** argv) {
  CLI::App app(
      "Calibrates a skin that was glued on this morning: ids, shape, links, axes, places.\n"
      "The skin is simulated; so is the robot, unless --robot names a real one, on whose motion the skin is "
      "then simulated. What "
      "a step found is kept in the folder: a run that was stopped goes on where it was.");
  Options options;
  std::string folder = "calibration", again, until, truth;
  std::uint64_t seed = 1;
  bool yes = false, quiet = false, no_camera = false, no_masses = false;
  app.add_option("--folder", folder, "where the files of the steps and the results are kept")
      ->capture_default_str();
  app.add_option("--seed", seed, "which simulated skin")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option(
      "--robot", options.arm.host,
      "host of a real UR5 that is switched on: it MOVES; of --arm egm, rsi and fri this computer's "
      "address, as the controller's program has it");
  UrdfRobot model;
  add_model(app, model, options.arm);
  std::string skin, write, device = "0";
  app.add_option("--skin", skin,
                 "[ADDRESS:]PORT of this computer at which the datagrams of a skin on that robot arrive; its "
                 "accelerations are read in place of simulated ones");
  app.add_option("--network", options.wire.network,
                 "that skin's cells and who is joined to whom, as network.json has them")
      ->check(CLI::ExistingFile);
  app.add_option("--skin-key", options.wire.key, "file with the key that seals the datagrams: 64 hex digits")
      ->check(CLI::ExistingFile);
  app.add_option("--write-worn", write,
                 "only write worn.json and network.json of the simulated skin into this folder, for "
                 "simulated_ur5 to wear");
  app.add_flag("--yes", yes, "your consent to all motions of a real robot, instead of one question each");
  app.add_flag("--shoulder-by-hand", options.shoulder_by_hand,
               "the first link's patch was turned by hand in eight poses before it was glued on");
  app.add_flag("--no-camera", no_camera, "patches are placed by motion alone");
#ifdef CALIBRATE_SKIN_HAS_CAMERA
  app.add_flag("--images", options.images,
               "the camera's images are rendered, and OpenCV finds the lights in them");
  app.add_option("--camera", options.camera_device.lens,
                 "with --skin: the lens of a camera that looks at the robot, a JSON of fx, fy, cx, cy and "
                 "distortion; the skin is told which lights are on")
      ->check(CLI::ExistingFile);
  app.add_option("--camera-device", device, "number of that camera, or the address of its stream")
      ->capture_default_str();
  app.add_option("--camera-delay", options.camera_device.settle,
                 "from the switching of lights to an image that shows them [s]")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
#endif
  app.add_option(
         "--placed", options.placed,
         "a skin file of the placing page: the camera step starts from the first cells that lie there")
      ->check(CLI::ExistingFile);
  app.add_flag("--no-masses", no_masses, "no motion for masses: the model has axes only");
  app.add_option("--rtde-port", options.arm.rtde_port, "of the robot, where it is not the maker's")
      ->group("Robot");
  app.add_option("--script-port", options.arm.script_port)->group("Robot");
  app.add_option("--dashboard-port", options.arm.dashboard_port)->group("Robot");
  app.add_flag("--own-clock", options.arm.own_clock,
               "the robot is a simulation: its clock need not agree with this computer's")
      ->group("Robot");
  const std::vector<std::string> names = {"network", "rest",   "shape",   "motion", "lines",
                                          "camera",  "result", "torques", "masses"};
  app.add_option("--again", again, "from which step on everything is done again")
      ->check(CLI::IsMember(names));
  app.add_option("--until", until, "the last step that is done now; without --until, the next run goes on")
      ->check(CLI::IsMember(names));
  app.add_option("--truth", truth,
                 "also write the simulated skin as it truly is, as a skin file to judge by");
  app.add_flag("--quiet", quiet, "print errors only");
  app.footer(job::exit_help());
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const job::StopSignals signals;
  options.folder = folder;
  examples::refuse_own_input((options.folder / "skin.json").string(), {options.placed.string()});
  options.camera = !no_camera, options.masses = !no_masses;
  if (!skin.empty()) listen_at(skin, options, no_camera);
  if (skin.empty() && !options.camera_device.lens.empty())
    throw skinctl::ConfigurationError("--camera: it looks at a skin that exists; --skin names it");
  if (!model.file.empty()) take_model(model, skin, options);
  look_by(device, options);
  if (!write.empty()) {
    write_worn(write, seed);
    return job::code(job::Exit::fine);
  }
  options.arm.stop = &signals.asked();
  options.arm.quiet = quiet;
  if (!quiet)
    options.say = [](const std::string& line) {
      std::printf("%s\n", line.c_str());
      std::fflush(stdout);
    };
  options.arm.say = options.say;
  options.agreed = [&](const std::vector<std::string>& announcement) {
    const bool real = !options.arm.host.empty();
    for (const auto& line : announcement)
      if (real || !quiet) std::printf("  %s\n", line.c_str());
    std::fflush(stdout);
    if (!real || yes) return true;
    if (::isatty(0) == 0) {
      std::fprintf(stderr, "nobody can be asked: --yes says that the robot may move\n");
      return false;
    }
    std::printf("  Is nobody within its reach, and may it move? Type yes: ");
    std::fflush(stdout);
    std::string answer;
    return std::getline(std::cin, answer) && answer == "yes";
  };

  const auto cells = calibrate(options, seed, again, until, truth);
  const bool has_model = fs::exists(options.folder / "model.urdf");  // only where all axes are known
  options.say(cells ? folder + ": skin.json with " + std::to_string(*cells) + " cells, " +
                          (has_model ? "model.urdf, " : "") +
                          "dh.txt; report.html says what is not known, and what would show it"
                    : "ended behind the step " + until);
  return job::code(job::Exit::fine);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const calibrate_skin::Interrupted&) {
    std::fprintf(stderr, "calibrate_skin: stopped; what was found so far is kept\n");
    return job::code(job::Exit::interrupted);
  } catch (const skinctl::ConfigurationError& e) {
    std::fprintf(stderr, "calibrate_skin: %s\n", e.what());
    return job::code(job::Exit::refused);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "calibrate_skin: %s\n", e.what());
    return job::code(job::Exit::lost);
  }
}
