#include "examples/touch_profile/profile.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "examples/simulated_ur5/contact.hpp"
#include "skinctl/core/contract.hpp"

using namespace touch_profile;

namespace {

/// Every taxel reads 240, and falls by `pressed[k]` in slice k.
Recording recording_of(const std::vector<double>& pressed) {
  Recording r;
  r.name = "folder/some_grasp.txt";
  for (const double p : pressed) r.slices.emplace_back().taxels.fill(240 - p);
  return r;
}

std::string csv(const Profile& profile) {
  std::ostringstream out;
  write_profile(out, profile);
  return out.str();
}

simulated_ur5::ForceProfile accepted(const Profile& profile) {
  std::istringstream in(csv(profile));
  return simulated_ur5::read_profile(in, "profile");
}

}  // namespace

TEST_CASE("Profile: force is the rise of the readings over rest, scaled to its peak") {
  Mapping m;
  m.peak = 30;
  m.rate = 20;
  m.release = 0.4;
  const Profile p = profile_of(recording_of({0, 1, 3, 6, 4}), m);
  REQUIRE(p.force.size() == 15);
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(p.time[k] == doctest::Approx(0.05 * static_cast<double>(k)));
    CHECK(p.force[k] == doctest::Approx(std::vector<double>{0, 5, 15, 30, 20}[k]));
  }
  CHECK(p.time.back() == doctest::Approx(0.6));
  CHECK(p.force[9] == doctest::Approx(10));  // half way through the release
  CHECK(std::is_sorted(p.force.begin() + 4, p.force.end(), std::greater<>()));
  CHECK(csv(p).find("some_grasp.txt") != std::string::npos);
  CHECK(csv(p).find("folder") == std::string::npos);
  CHECK(csv(p).find("Copyright 2012 Harold Soh") != std::string::npos);

  m.rest = 2;  // the mean of 0 and 1 is rest, and at rest there is no force
  const Profile q = profile_of(recording_of({0, 1, 3, 6, 4}), m);
  CHECK(q.force[1] == 0);
  CHECK(q.force[2] == doctest::Approx(30 * 2.5 / 5.5).epsilon(1e-4));
}

TEST_CASE(
    "Profile: never negative, zero at both ends, its peak as asked, and the simulated finger reads it back") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(0, 1);
  for (int round = 0; round < 400; ++round) {
    std::vector<double> pressed(2 + random() % 60);
    for (double& p : pressed) p = 200 * any(random) - 10;
    Mapping m;
    m.peak = std::pow(10, 5 * any(random) - 2);
    m.rate = std::pow(10, 4 * any(random) - 1);
    m.release = 0.01 + 60 * any(random) * any(random);
    if (m.release > 60) m.release = 60;
    m.threshold = 1e-9;
    m.rest = 1 + random() % (pressed.size() - 1);
    CAPTURE(round);
    Profile p;
    try {
      p = profile_of(recording_of(pressed), m);
    } catch (const skinctl::ConfigurationError& e) {
      CHECK(std::string(e.what()).find("no touch") != std::string::npos);
      continue;
    }
    const auto read = accepted(p);
    REQUIRE(read.force.size() == p.force.size());
    CHECK(read.force.front() == 0);
    CHECK(read.force.back() == 0);
    CHECK(*std::min_element(read.force.begin(), read.force.end()) == 0);
    CHECK(std::abs(*std::max_element(read.force.begin(), read.force.end()) - m.peak) <=
          0.5001e-4);  // as written
    for (std::size_t i = 0; i < read.force.size(); ++i)
      CHECK(read.force[i] == doctest::Approx(p.force[i]).epsilon(1e-12));
  }
}

TEST_CASE("Profile: only the chosen taxels count") {
  Recording r = recording_of({0, 0, 0});
  r.slices[1].taxels[14] = 140;
  r.slices[2].taxels[59] = 40;
  Mapping m;
  m.taxels = parse_taxels("index");
  CHECK(profile_of(r, m).force[1] == 40);
  CHECK(profile_of(r, m).force[2] == 0);
  m.taxels = parse_taxels("59");
  CHECK(profile_of(r, m).force[2] == 40);
  m.taxels = parse_taxels("thumb,24-58");
  CHECK_THROWS_WITH_AS(profile_of(r, m), doctest::Contains("no touch"), skinctl::ConfigurationError);

  CHECK(parse_taxels("13,index,13") == parse_taxels("12-23"));
  CHECK(parse_taxels("0,little").size() == 13);
  for (const char* wrong :
       {"", ",", "60", "1,", "-1", "3-", "5-4", "toe", "1 2", "0x1", "99999999999999999999999"}) {
    CAPTURE(wrong);
    CHECK_THROWS_AS(parse_taxels(wrong), skinctl::ConfigurationError);
  }
}

TEST_CASE("Profile: noise is not scaled up to a touch, and numbers outside their ranges are refused") {
  CHECK_THROWS_WITH_AS(profile_of(recording_of({0, 0.4, -3, 0.1}), {}),
                       doctest::Contains("rises by 24 counts, a touch needs 25"),
                       skinctl::ConfigurationError);
  CHECK_NOTHROW(profile_of(recording_of({0, 0.42, -3, 0.1}), {}));
  const auto refused = [](void (*change)(Mapping&)) {
    Mapping m;
    change(m);
    CHECK_THROWS_AS(profile_of(recording_of({0, 9, 9}), m), skinctl::ConfigurationError);
  };
  refused([](Mapping& m) { m.peak = 0; });
  refused([](Mapping& m) { m.peak = std::numeric_limits<double>::quiet_NaN(); });
  refused([](Mapping& m) { m.peak = 1001; });
  refused([](Mapping& m) { m.rate = 0; });
  refused([](Mapping& m) { m.rate = std::numeric_limits<double>::infinity(); });
  refused([](Mapping& m) { m.release = 0; });
  refused([](Mapping& m) { m.threshold = 0; });
  refused([](Mapping& m) { m.rest = 0; });
  refused([](Mapping& m) { m.rest = 3; });
  refused([](Mapping& m) { m.taxels = {60}; });
  CHECK_THROWS_AS(profile_of(Recording{}, {}), skinctl::ConfigurationError);
  CHECK_THROWS_AS(profile_of(recording_of({5}), {}), skinctl::ConfigurationError);
}

TEST_CASE("Profile: the computed push is smooth at its ends and as high as asked") {
  for (const double peak : {0.01, 1.0, 40.0, 1000.0}) {
    const auto p = accepted(synthetic_push(peak));
    CHECK(p.duration() == doctest::Approx(1.6));
    CHECK(*std::max_element(p.force.begin(), p.force.end()) == doctest::Approx(peak));
    CHECK(p.at(0) == 0);
    CHECK(p.at(1.6) == 0);
    CHECK(p.at(0.02) < 0.01 * peak);
    CHECK(p.at(1.58) < 0.01 * peak);
    CHECK(p.at(0.7) > 0.85 * peak);
  }
  CHECK_THROWS_AS(synthetic_push(0), skinctl::ConfigurationError);
  CHECK_THROWS_AS(synthetic_push(std::nan("")), skinctl::ConfigurationError);
}

TEST_CASE("Profile: the shipped one is what the program generates") {
  std::ifstream in(SHIPPED_PROFILE);
  REQUIRE(in.good());
  std::ostringstream shipped;
  shipped << in.rdbuf();
  CHECK(shipped.str() == csv(synthetic_push(40)));
}

TEST_CASE("Profile: a file name cannot end its comment line") {
  Recording r = recording_of({0, 9});
  r.name = "a\nb\r,1";
  CHECK(csv(profile_of(r, {})).find("# Touch force made from a?b?,1 of") == 0);
  CHECK(accepted(profile_of(r, {})).force.size() == 12);
}
