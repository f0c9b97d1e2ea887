#include <doctest/doctest.h>

#include <cmath>

#include "examples/simulated_ur5/scenario.hpp"

using namespace simulated_ur5;

namespace {

std::vector<SkinCell> row_of_cells(std::size_t n) {
  std::vector<SkinCell> cells(n);
  for (std::size_t i = 0; i < n; ++i) {
    cells[i].id = static_cast<std::uint32_t>(100 + i);
    cells[i].link = 2;
    cells[i].position = {-0.1 - 0.028 * static_cast<double>(i), 0, 0.05};
    cells[i].normal = {0, 0, 1};
    complete(cells[i]);
  }
  return cells;
}

SkinConfig silent() {
  SkinConfig c;
  c.force_noise = c.proximity_noise = c.acceleration_noise = 0;
  return c;
}

}  // namespace

TEST_CASE("Skin: readings come in the sensors' steps and inside their ranges") {
  Skin skin(row_of_cells(3), SkinConfig{}, 1);
  const Links links = forward_kinematics(ArmConfig{}.home);
  SkinStimulus s;
  s.force = {0, 6, 1e6};
  s.proximity = {0, 0.4, 7};
  for (int k = 1; k < 200; ++k) {
    for (const SkinSample& sample : skin.sample(k * 4'000'000, links, s)) {
      for (const float f : sample.force) {
        CHECK(f >= 0);
        CHECK(f <= 1);
        CHECK(f * 1024 == std::round(f * 1024));
        if (sample.cell == 101) CHECK(f == doctest::Approx(0.004 + 0.1).epsilon(0.02));
      }
      CHECK(sample.proximity * 65536 == std::round(sample.proximity * 65536));
      CHECK(sample.proximity <= 1);
      CHECK(sample.temperature == 30);
      const double a = std::sqrt(std::pow(sample.acceleration[0], 2) + std::pow(sample.acceleration[1], 2) +
                                 std::pow(sample.acceleration[2], 2));
      CHECK(a == doctest::Approx(9.81).epsilon(0.02));
    }
  }
}

TEST_CASE("Skin: only news are sent, and every cell before its keep-alive ends") {
  const std::size_t n = 40;
  Skin skin(row_of_cells(n), silent(), 1);
  const Links links = forward_kinematics(ArmConfig{}.home);
  SkinStimulus s;
  s.force.assign(n, 0);
  s.proximity.assign(n, 0);
  std::vector<Nanoseconds> last(n, 0);
  std::size_t sent = 0;
  Nanoseconds t{};
  CHECK(skin.sample(t += 4'000'000, links, s).size() == n);
  for (int k = 0; k < 500; ++k) {
    const auto& samples = skin.sample(t += 4'000'000, links, s);
    sent += samples.size();
    CHECK(samples.size() <= 4);  // they take turns
    for (const SkinSample& sample : samples) {
      CHECK(sample.time.count() == t);
      last[sample.cell - 100] = t;
    }
    if (k > 30)
      for (const Nanoseconds l : last) CHECK(t - l <= 100'000'000);
  }
  CHECK(sent == 500 * n / 25);
  // News: one cell is pressed.
  s.force[17] = 3;
  bool seen = false;
  for (const SkinSample& sample : skin.sample(t += 4'000'000, links, s)) seen = seen || sample.cell == 117;
  CHECK(seen);
  // A dead cell says nothing.
  skin.set_dead(117, true);
  for (int k = 0; k < 100; ++k)
    for (const SkinSample& sample : skin.sample(t += 4'000'000, links, s)) CHECK(sample.cell != 117);
}

TEST_CASE("Skin: a pressed cell sends every measurement, and each message says how many it stands for") {
  SkinConfig config;
  config.force_noise = 0.7 / 1024;
  config.faults = {
      {.cell = 102, .fault = skinctl::CellFault::stuck, .from = std::chrono::seconds(1), .level = 0.01}};
  Skin skin(row_of_cells(3), config, 1);
  const Links links = forward_kinematics(ArmConfig{}.home);
  SkinStimulus s;
  s.force = {0, 6, 0};
  std::array<unsigned, 3> measured{}, messages{}, still{};
  for (int k = 1; k <= 500; ++k)
    for (const SkinSample& sample : skin.sample(k * 4'000'000, links, s)) {
      const std::size_t i = sample.cell - 100;
      ++messages[i], measured[i] += sample.measured;
      still[i] = sample.unrest == 0 ? still[i] + sample.measured : 0;
      if (i == 0 && k > 1) CHECK(sample.unrest != skinctl::unsaid);
    }
  for (const unsigned m : measured) CHECK(m >= 475);
  CHECK(messages[0] < 250);
  CHECK(messages[1] == 500);
  CHECK(still[0] < 19);
  CHECK(still[2] > 200);  // for a second, at rest
}

TEST_CASE("Skin: accelerometers feel gravity in the cell's axes, and motion") {
  std::vector<SkinCell> cells = row_of_cells(1);
  Skin skin(cells, silent(), 1);
  SkinStimulus s;
  Joints q = ArmConfig{}.home;
  const Links links = forward_kinematics(q);
  const auto& samples = skin.sample(4'000'000, links, s);
  REQUIRE(samples.size() == 1);
  const SkinSample at_rest = samples[0];
  const Vec3 up = links.link[2].rotate_back({0, 0, 9.81});
  const Vec3 y = cross(cells[0].normal, cells[0].axis);
  CHECK(at_rest.acceleration[0] == doctest::Approx(dot(up, cells[0].axis)).scale(9.81).epsilon(0.01));
  CHECK(at_rest.acceleration[1] == doctest::Approx(dot(up, y)).scale(9.81).epsilon(0.01));
  CHECK(at_rest.acceleration[2] == doctest::Approx(dot(up, cells[0].normal)).scale(9.81).epsilon(0.01));

  // Turning about the vertical at w: w^2 r towards the axis.
  Skin turning(cells, silent(), 1);
  const double w = 2;
  SkinSample last;
  Links then;
  for (int k = 0; k < 100; ++k) {
    q[0] = w * 0.004 * k;
    then = forward_kinematics(q);
    for (const SkinSample& sample : turning.sample(4'000'000 * (k + 1), then, s)) last = sample;
  }
  const Vec3 here = then.link[2].point(cells[0].position);
  const Vec3 felt = Vec3{-w * w * here.x, -w * w * here.y, 9.81};
  const Vec3 local = then.link[2].rotate_back(felt);
  CHECK(last.acceleration[0] == doctest::Approx(dot(local, cells[0].axis)).scale(9.81).epsilon(0.02));
  CHECK(last.acceleration[2] == doctest::Approx(dot(local, cells[0].normal)).scale(9.81).epsilon(0.02));
}

TEST_CASE("Skin: the same seed gives the same samples") {
  const auto stream = [](std::uint64_t seed) {
    Skin skin(row_of_cells(5), SkinConfig{}, seed);
    const Links links = forward_kinematics(ArmConfig{}.home);
    SkinStimulus s;
    std::vector<float> all;
    for (int k = 1; k < 100; ++k)
      for (const SkinSample& sample : skin.sample(k * 4'000'000, links, s)) all.push_back(sample.proximity);
    return all;
  };
  CHECK(stream(3) == stream(3));
  CHECK(stream(3) != stream(4));
}

TEST_CASE("Cells: those of a skin file are where the file puts them, by the names of the links") {
  const auto cells = read_skin_cells(SKIN_FILE);
  REQUIRE(cells.size() == 260);
  std::array<std::size_t, 6> on{};
  // Radii of the housings, of the file.
  const double radius[6] = {0.060, 0.054, 0.040, 0.045, 0.045, 0.0375};
  for (const SkinCell& c : cells) {
    ++on[c.link];
    CHECK(norm(c.normal) == doctest::Approx(1).epsilon(1e-8));
    CHECK(dot(c.normal, c.axis) == doctest::Approx(0));
    // From the tube's axis, along the normal: upper arm and forearm lie along x, the others along z.
    const bool along_x = c.link == 1 || c.link == 2;
    const Vec3 middle = c.position - radius[c.link] * c.normal;
    CHECK(middle.y == doctest::Approx(0).epsilon(1e-8));
    CHECK(std::abs(along_x ? middle.z - (c.link == 1 ? 0.13585 : 0.0165) : middle.x) < 1e-8);
  }
  CHECK(on == std::array<std::size_t, 6>{36, 97, 67, 27, 27, 6});
}
