// by night: a world of studies
#include "bench/studies/worlds/recorded_grasps.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

using namespace skinctl::testing;

TEST_CASE("Recorded grasps: 230 of 60 taxels, with a rest below every reading") {
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  if (data == nullptr) {
    MESSAGE("skipped: SKINCTL_DATA_DIR is not set");
    return;
  }
  const auto grasps = read_recorded_grasps(data);
  REQUIRE(grasps.size() == 230);
  std::set<std::string> objects;
  int held = 0;
  for (const RecordedGrasp& g : grasps) {
    objects.insert(g.object);
    CHECK(g.trial >= 1);
    CHECK(g.frames.size() >= 4);
    for (std::size_t i = 0; i < RecordedGrasp::taxels; ++i) {
      double least = 1e9;
      for (const auto& frame : g.frames) {
        REQUIRE(frame[i] >= 0);
        REQUIRE(frame[i] <= 255);
        least = std::min(least, frame[i]);
      }
      REQUIRE(g.rest[i] == least);
      CHECK(g.reading(i, -1) == g.frames.front()[i]);
      CHECK(g.reading(i, 0.5 * g.period) == doctest::Approx((g.frames[0][i] + g.frames[1][i]) / 2));
      CHECK(g.reading(i, g.lasts() + 3600) == g.frames.back()[i]);
      held += g.held(i) >= 8;
    }
  }
  CHECK(objects.size() == 11);
  CHECK(held == 1019);
  // Its first time slice.
  const auto& book = *std::find_if(grasps.begin(), grasps.end(),
                                   [](const RecordedGrasp& g) { return g.object == "book" && g.trial == 1; });
  CHECK(book.frames[0][0] == 12);  // 255 - 243
  CHECK(book.frames[0][59] == 9);  // 255 - 246
  CHECK(book.reliable());
}

TEST_CASE("Recorded grasps: files that are none are refused by name") {
  const auto folder = std::filesystem::temp_directory_path() / "skinctl_recorded_grasps";
  std::filesystem::create_directories(folder);
  const auto path = folder / "cup_3.txt";
  const auto refused = [&](const char* text, const char* why) {
    std::ofstream(path) << text;
    try {
      static_cast<void>(read_recorded_grasp(path));
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      return what.find("cup_3.txt") != std::string::npos && what.find(why) != std::string::npos;
    }
    return false;
  };
  CHECK(refused("", "cannot be read"));
  CHECK(refused("12 13", "begin with -10000"));
  CHECK(refused("-10000\n1 2 3", "whole frames"));
  CHECK(refused("-10000\n1 2 x", "no number"));
  std::filesystem::remove_all(folder);
  CHECK(read_recorded_grasps(folder).empty());
}
