#include "examples/touch_profile/tests/dataset.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "examples/simulated_ur5/contact.hpp"
#include "examples/touch_profile/profile.hpp"
#include "skinctl/core/contract.hpp"

using namespace touch_profile;

TEST_CASE(
    "Dataset: every recording reads, grasps become touches that the simulated finger repeats, an empty hand "
    "none") {
  const auto files = dataset();
  std::size_t converted = 0;
  for (const auto& file : files) {
    const std::string name = file.filename().string();
    CAPTURE(name);
    const Recording recording = read_recording_file(file.string());
    CHECK(recording.slices.size() >= 4);
    if (name.rfind("none", 0) == 0) {
      CHECK_THROWS_AS(profile_of(recording, {}), skinctl::ConfigurationError);
      continue;
    }
    Profile profile;
    try {
      profile = profile_of(recording, {});
    } catch (const skinctl::ConfigurationError& e) {
      // Light and soft objects hardly press the fingertips.
      CHECK(std::string(e.what()).find("no touch") != std::string::npos);
      continue;
    }
    ++converted;
    std::stringstream csv;
    write_profile(csv, profile);
    const auto read = simulated_ur5::read_profile(csv, name);
    REQUIRE(read.time.size() == recording.slices.size() + 10);
    CHECK(read.force.front() == 0);
    CHECK(read.force.back() == 0);
    CHECK(*std::max_element(read.force.begin(), read.force.end()) == 40);
    CHECK(*std::min_element(read.force.begin(), read.force.end()) == 0);
    CHECK(read.duration() == doctest::Approx(0.1 * static_cast<double>(recording.slices.size() - 1) + 0.5));
  }
  MESSAGE("recordings: ", files.size(), ", converted: ", converted);
  if (!files.empty()) CHECK(converted >= 150);
}
