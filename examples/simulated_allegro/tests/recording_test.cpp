// A real hand's joints, as frames, through the driver and its velocity estimator.
//
// Promise: a real hand's joints pass through the driver
// Tried: 2697 states of a recording: positions to 1e-9 rad, velocities as the estimator states them

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "examples/adapters/allegro/driver.hpp"

using namespace adapters::allegro;
using skinctl::Heard;

namespace {

struct Row {
  double t = 0;
  std::array<double, 16> q{};
};

std::vector<Row> read_log(const std::string& file) {
  std::ifstream in(file);
  std::vector<Row> rows;
  std::string line, number;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    Row r;
    std::getline(cells, number, ',');
    r.t = std::stod(number);
    for (double& q : r.q) {
      std::getline(cells, number, ',');
      q = std::stod(number);
    }
    rows.push_back(r);
  }
  return rows;
}

Frame bytes(std::uint16_t id, const std::array<std::uint8_t, 8>& data, std::uint8_t size) {
  Frame f;
  f.id = id;
  f.data = data;
  f.size = size;
  return f;
}

}  // namespace

TEST_CASE("A real hand's joints: positions to the step, velocities as they are stated") {
  const char* folder = std::getenv("SKINCTL_DATA_DIR");
  const auto rows = folder == nullptr ? std::vector<Row>()
                                      : read_log(std::string(folder) + "/allegro_joint_log/jointstates.csv");
  if (rows.empty()) {
    std::printf("SKIPPED: no allegro_joint_log/jointstates.csv in SKINCTL_DATA_DIR\n");
    return;
  }
  REQUIRE(rows.size() > 2000);
  auto ends = FrameSocket::pair();
  FrameSocket& hand = ends[1];
  using adapters::Timeout;
  REQUIRE(hand.write(bytes(0x200, {1, 4, 2, 1, 0, 40, 0}, 7), Timeout(10)));
  REQUIRE(hand.write(bytes(0x220, {'5', 'T', 'B', 'R', '0', '0', '4', '2'}, 8), Timeout(10)));
  HandOptions options;
  options.stamps = Stamps::counted;
  Driver driver(CanHand(std::move(ends[0])), options);
  driver.connect();
  const auto far = std::chrono::steady_clock::now() + std::chrono::seconds(100);
  Frame f;
  for (int k = 0; k < 5; ++k) REQUIRE(hand.read(f, far) == adapters::Read::some);  // its start-up sequence
  CHECK(f == servo(true));

  const double step = 333.3 / 65536 * 3.14159265358979323846 / 180, T = 0.003;
  std::vector<std::array<double, 16>> q;
  double worst_position = 0, worst_velocity = 0, fastest = 0;
  for (const Row& row : rows) {
    for (unsigned finger = 0; finger < 4; ++finger) {
      std::array<std::uint8_t, 8> data{};
      for (std::size_t i = 0; i < 4; ++i) {
        const auto n = static_cast<int>(std::lround(row.q[4 * finger + i] / step));
        data[2 * i] = static_cast<std::uint8_t>(n & 255);
        data[2 * i + 1] = static_cast<std::uint8_t>((n >> 8) & 255);
      }
      REQUIRE(hand.write(bytes(static_cast<std::uint16_t>((0x20 + finger) << 2), data, 8), Timeout(10)));
    }
    skinctl::State<16> state;
    REQUIRE(driver.wait(state) == Heard::state);
    skinctl::TorqueCommand<16> still;
    still.valid = true;
    REQUIRE(driver.send(still));
    for (int k = 0; k < 4; ++k) REQUIRE(hand.read(f, far) == adapters::Read::some);
    q.push_back(row.q);
    for (std::size_t i = 0; i < 16; ++i)
      worst_position = std::max(worst_position, std::abs(state.q[i] - row.q[i]));
    if (q.size() < 5) continue;
    const auto old = [&](std::size_t back, std::size_t i) { return q[q.size() - 1 - back][i]; };
    for (std::size_t i = 0; i < 16; ++i) {  // the slope of five points, by its closed form
      const double slope = (2 * old(0, i) + old(1, i) - old(3, i) - 2 * old(4, i)) / (10 * T);
      worst_velocity = std::max(worst_velocity, std::abs(state.dq[i] - slope));
      fastest = std::max(fastest, std::abs(state.dq[i]));
    }
  }
  std::printf("%zu states of a real hand: positions within %.1e rad, fastest %.2f rad/s\n", rows.size(),
              worst_position, fastest);
  CHECK(worst_position < 1e-9);
  CHECK(worst_velocity < 1e-6);
  CHECK(fastest > 0.5);
  CHECK(driver.condition().incomplete == 0);
  CHECK_FALSE(driver.odd().any());
  CHECK(driver.packet() == rows.size());
}
