// by night: takes minutes
// Real fingers: recorded grasps drive the main job.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "examples/compliant_ur5/run.hpp"
#include "examples/touch_profile/profile.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_ur5;
namespace fs = std::filesystem;

namespace {

/// Two presses of a profile, on a compliant or a rigid arm.
RunLog pressed(const std::string& profile, bool rigid) {
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  s.quiet = true;
  read_scenario(s.scenario, s);
  s.task.clear();
  s.touch_profile = profile;
  s.rigid = rigid;
  s.cycles = 125 * 20;
  RunLog log;
  REQUIRE(run(s, false, log) == Outcome::fine);
  return log;
}

}  // namespace

TEST_CASE("recordings: the shipped push makes the arm give way and return") {
  const auto soft = pressed(SHIPPED_PROFILE, false), rigid = pressed(SHIPPED_PROFILE, true);
  REQUIRE(soft.touches.size() == 2);
  for (const auto& t : soft.touches) {
    CHECK(t.deflection > 0.002);
    CHECK(t.return_error < 0.005);
  }
  CHECK(soft.peak_force < rigid.peak_force);
}

TEST_CASE("recordings: twenty real grasps make it give way and return") {
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  if (data == nullptr) {
    std::fprintf(stderr, "SKIPPED: SKINCTL_DATA_DIR is not set, so there are no recordings\n");
    return;
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(data) / "icub_grasp_tactile" / "iCubGraspDataset"))
    files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const auto csv = (fs::temp_directory_path() / "compliant_ur5_recordings_test.csv").string();
  touch_profile::Mapping mapping;
  mapping.peak = 40;
  mapping.rate = 20;
  // A run takes the sanitizers 2 processor seconds; three of them walk the same paths.
  constexpr std::size_t wanted = skinctl::testing::sanitized ? 3 : 24, stride = 168 / wanted;
  std::size_t used = 0;
  for (std::size_t k = 0; k < files.size() && used < wanted; k += stride) {
    touch_profile::Profile profile;
    try {
      profile = touch_profile::profile_of(touch_profile::read_recording_file(files[k].string()), mapping);
    } catch (const std::exception&) {
      continue;  // an empty hand, or hardly a touch
    }
    {
      std::ofstream out(csv);
      touch_profile::write_profile(out, profile);
    }
    const auto log = pressed(csv, false);
    CAPTURE(files[k].filename().string());
    CHECK(log.touches.size() >= 2);
    double deflection = 0;
    for (const auto& t : log.touches) deflection = std::max(deflection, t.deflection);
    CHECK(deflection > 0.001);
    CHECK(log.touches.back().return_error < 0.005);
    CHECK(log.peak_force < 41);
    ++used;
  }
  fs::remove(csv);
  CHECK(used >= wanted * 5 / 6);
}
