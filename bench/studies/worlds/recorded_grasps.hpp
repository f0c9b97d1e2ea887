// A reader of recorded grasps: the iCub Grasp Dataset (H. Soh, Y. Su, Y. Demiris, IROS 2012), which is no
// part of this project.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace skinctl::testing {

/// One grasp of a hand with five fingers of 12 taxels. A reading is 255 minus what the file says: 0
/// untouched, in steps of the sensor. The files have no times: frames are taken to be `period` apart.
struct RecordedGrasp {
  static constexpr std::size_t fingers = 5, taxels_a_finger = 12, taxels = fingers * taxels_a_finger;
  using Frame = std::array<double, taxels>;

  std::string object;  ///< the file's name without number: `blue_bear`
  int trial = 0;
  double period = 0.1;  ///< [s]
  std::vector<Frame> frames;
  Frame rest{};  ///< lowest reading of each taxel: the first frame is often touched

  /// The author declares one object unreliable.
  [[nodiscard]] bool reliable() const { return object != "full_coke"; }
  [[nodiscard]] double lasts() const { return static_cast<double>(frames.size() - 1) * period; }
  /// Reading of a taxel at `t` [s] from the first frame, linear between frames; at the ends it is held.
  [[nodiscard]] double reading(std::size_t taxel, double t) const {
    const double place = std::clamp(t / period, 0.0, static_cast<double>(frames.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(place), frames.size() - 1);
    const auto j = std::min(i + 1, frames.size() - 1);
    return frames[i][taxel] + (place - static_cast<double>(i)) * (frames[j][taxel] - frames[i][taxel]);
  }
  /// Reading of a taxel in the last frame above its rest: how hard it is held [steps].
  [[nodiscard]] double held(std::size_t taxel) const { return frames.back()[taxel] - rest[taxel]; }
};

/// Reads one recording. Throws `std::runtime_error` with the file's name for a file that cannot be read,
/// begins with another mark, or holds no whole frames.
[[nodiscard]] inline RecordedGrasp read_recorded_grasp(const std::filesystem::path& path,
                                                       double period = 0.1) {
  constexpr std::size_t encoders = 9, sums = RecordedGrasp::fingers;
  constexpr std::size_t numbers = encoders + sums + RecordedGrasp::taxels;
  const auto refuse = [&](const std::string& why) -> std::runtime_error {
    return std::runtime_error(path.string() + ": " + why);
  };
  std::ifstream file(path);
  double x = 0;
  if (!(file >> x)) throw refuse("cannot be read");
  if (x != -10000) throw refuse("does not begin with -10000");
  std::vector<double> all;
  while (file >> x) all.push_back(x);
  if (!file.eof()) throw refuse("holds what is no number");
  if (all.empty() || all.size() % numbers != 0) throw refuse("holds no whole frames of 74 numbers");

  RecordedGrasp grasp;
  const std::string name = path.stem().string();
  const std::size_t underscore = name.rfind('_');
  if (underscore == std::string::npos) throw refuse("is not named OBJECT_TRIAL");
  grasp.object = name.substr(0, underscore);
  grasp.trial = std::atoi(name.c_str() + underscore + 1);
  grasp.period = period;
  for (std::size_t first = 0; first < all.size(); first += numbers) {
    RecordedGrasp::Frame frame;
    for (std::size_t i = 0; i < frame.size(); ++i) frame[i] = 255 - all[first + encoders + sums + i];
    grasp.frames.push_back(frame);
  }
  grasp.rest = grasp.frames.front();
  for (const auto& frame : grasp.frames)
    for (std::size_t i = 0; i < frame.size(); ++i) grasp.rest[i] = std::min(grasp.rest[i], frame[i]);
  return grasp;
}

/// All recordings in order of their names, from the folder that holds `icub_grasp_tactile` (for tests:
/// `SKINCTL_DATA_DIR`); none if it has no such folder.
[[nodiscard]] inline std::vector<RecordedGrasp> read_recorded_grasps(const std::filesystem::path& data,
                                                                     double period = 0.1) {
  const auto folder = data / "icub_grasp_tactile" / "iCubGraspDataset";
  std::vector<std::filesystem::path> paths;
  if (!std::filesystem::is_directory(folder)) return {};
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".txt") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<RecordedGrasp> grasps;
  for (const auto& path : paths) grasps.push_back(read_recorded_grasp(path, period));
  return grasps;
}

}  // namespace skinctl::testing
