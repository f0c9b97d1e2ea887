// A calibration in a folder: what it is told, and all of its steps.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "examples/calibrate_skin/robot.hpp"
#include "skinctl/core/time.hpp"

namespace calibrate_skin {

namespace fs = std::filesystem;
using JointAngles6 = std::array<double, 6>;

/// Somebody asked for the end: the arm has been stopped.
struct Interrupted {};

struct ArmOptions {
  Robot robot = ur5_robot();
  std::string host;  ///< of a real robot; empty: a simulated one
  /// Of its controller: ur (RTDE), stream_motion, franka, or rsi, egm, fri; of these three `host` is the
  /// address of this computer.
  std::string protocol = "ur";
  std::uint16_t port = 0;      ///< of all but ur; 0: as the maker has it
  double period = 0.004;       ///< of rsi, egm, fri [s]
  double max_correction = 90;  ///< of rsi: farthest way of a joint from where it stands [deg]
  double stiffness = 3000;     ///< of franka: of each joint's spring [N m/rad]
  std::uint16_t rtde_port = 0, script_port = 0,
                dashboard_port = 0;  ///< of a UR's host; 0: as the maker has them
  bool own_clock = false;  ///< the host is a simulation: its clock need not agree with this computer's
  /// At the joints [N m/A]: of the order of what others measured for a UR5. All masses that are found scale
  /// with it.
  JointAngles6 torque_per_ampere = {12.5, 12.5, 12.5, 9, 9, 9};
  const std::atomic<bool>* stop = nullptr;  ///< set: the arm stops, and `Interrupted` is thrown
  std::function<void(const std::string&)> say = [](const std::string&) {};
  bool quiet = true;  ///< no progress line
  /// Told the robot's clock in each of its cycles.
  std::function<void(skinctl::Nanoseconds now)> each_cycle = [](skinctl::Nanoseconds) {};
};

/// A skin that exists, and sends datagrams to this computer.
struct WireOptions {
  std::string address = "127.0.0.1";  ///< of this computer
  std::uint16_t port = 0;             ///< 0: there is none, the skin is simulated
  std::string key;                    ///< file with the key that seals the datagrams; may be empty
  fs::path network;                   ///< ids and neighbours of its cells, as `network.json`
};

/// Eight bits of grey, row by row from the top.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// A camera that exists, and looks at a skin that exists.
struct CameraOptions {
  fs::path lens;                    ///< its intrinsics, see `Lens`; empty: there is none
  std::function<GreyImage()> take;  ///< its next image
  double settle =
      0.2;  ///< time from the skin's word that lights are switched to an image that shows them [s]
};

struct Options {
  fs::path folder;
  bool shoulder_by_hand = false;  ///< the first link's patch was turned by hand before it was glued on
  bool camera = true;   ///< false: patches are placed by motion alone; the first link's then has no place
  bool images = false;  ///< lights are found in rendered images, by OpenCV, not told with errors
  fs::path placed;  ///< a skin file in which first cells of patches lie as somebody placed them; may be empty
  bool masses = true;  ///< false: the model has axes only
  WireOptions wire{};
  CameraOptions camera_device{};
  ArmOptions arm{};
  std::function<void(const std::string&)> say = [](const std::string&) {};
  /// Told what is going to move before it moves; false: nobody agreed, and nothing moves.
  std::function<bool(const std::vector<std::string>& announcement)> agreed =
      [](const std::vector<std::string>&) { return true; };
};

/// Does the steps that are missing in the folder, on the skin of this seed, as `run_steps` says, and writes
/// the results; with `truth` also the skin file of the cells where they truly are. How many cells `skin.json`
/// has; nothing where a step behind `until` is left. Throws what `run_steps` and `write_results` throw, and
/// `ConfigurationError` for a folder with a calibration of other options.
std::optional<std::size_t> calibrate(const Options& options, std::uint64_t seed, const std::string& again,
                                     const std::string& until, const std::string& truth);

/// Writes the simulated skin of a seed for a robot that wears it: `worn.json`, a skin file of all cells where
/// they are, and `network.json`, what their network reports.
void write_worn(const fs::path& folder, std::uint64_t seed);

}  // namespace calibrate_skin
