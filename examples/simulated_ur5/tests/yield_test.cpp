#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "examples/simulated_ur5/controller.hpp"
#include "examples/simulated_ur5/tests/streaming.hpp"

using namespace simulated_ur5;

namespace {

/// Cells in three rows on the upper side of the forearm.
std::vector<SkinCell> patch() {
  std::vector<SkinCell> cells;
  for (int row = -1; row <= 1; ++row)
    for (int i = 0; i < 9; ++i) {
      SkinCell c;
      c.id = static_cast<std::uint32_t>(cells.size() + 1);
      c.link = 2;
      c.position = {-0.08 - 0.0278 * i, 0.024 * row, 0.06};
      c.normal = {0, 0.3 * row, 1};
      complete(c);
      cells.push_back(c);
    }
  return cells;
}

struct Outcome {
  double peak_force = 0, deflection = 0, highest_speed = 0;
  bool stopped = false;
};

/// A stiff arm that holds its pose and, unless rigid, gives way by what its skin reads: B dq = J' F, softened
/// by M.
Outcome run(Series series, bool rigid, double position_gain) {
  ControllerConfig config;
  config.series = series;
  config.powered = true;
  config.cells = patch();
  config.protective_force = 0;
  Touch touch;
  touch.cell = 14;
  touch.start = 0.5;
  touch.stiffness = 5000;
  touch.approach_speed = 0.1;
  touch.travel = 0.05;
  touch.hold = 1;
  config.touches = {touch};
  Streaming stream(config);
  Controller& c = stream.c;
  std::map<std::uint32_t, SkinSample> latest;
  c.on_skin = [&](Nanoseconds, const std::vector<SkinSample>& samples) {
    for (const SkinSample& s : samples) latest[s.cell] = s;
  };
  const double dt = seconds(c.cycle()), M = 0.3, B = 8;
  Joints q = config.arm.home, v{};
  Outcome out;
  while (c.scenario_time() < 6) {
    const Links links = forward_kinematics(q);
    Joints torque{};
    for (const SkinCell& cell : c.skin().cells()) {
      const auto s = latest.find(cell.id);
      if (rigid || s == latest.end()) continue;
      const double reading = s->second.force[0] + s->second.force[1] + s->second.force[2] - 0.03;
      if (reading <= 0) continue;
      const Pose& pose = links.link[cell.link];
      const Joints t = torque_of_force(links, cell.link, pose.point(cell.position),
                                       -20 * reading * pose.rotate(cell.normal));
      for (std::size_t i = 0; i < joint_count; ++i) torque[i] += t[i];
    }
    for (std::size_t i = 0; i < joint_count; ++i) {
      const double pull = torque[i] + position_gain * (config.arm.home[i] - q[i]);
      v[i] = (v[i] + dt / M * pull) / (1 + dt * B / M);
      q[i] += dt * v[i];
      out.highest_speed = std::max(out.highest_speed, std::abs(v[i]));
    }
    stream.send(100, q, 1);
    if (c.state().safety_mode != SafetyMode::normal) break;
  }
  out.stopped = c.state().safety_mode != SafetyMode::normal;
  out.peak_force = c.world().results()[0].peak_force;
  out.deflection = c.world().results()[0].peak_deflection;
  return out;
}

}  // namespace

TEST_CASE(
    "Contact: an arm that yields by its skin's readings feels less than a quarter of what a rigid one "
    "feels") {
  for (const Series series : {Series::cb3, Series::e_series}) {
    CAPTURE(int(series));
    const Outcome unyielding = run(series, true, 0), yields = run(series, false, 20);
    CHECK(unyielding.peak_force == doctest::Approx(5000 * 0.05).epsilon(0.02));
    CHECK(unyielding.deflection < 1e-3);
    CHECK_FALSE(yields.stopped);
    CHECK(yields.peak_force * 4 < unyielding.peak_force);
    CHECK(yields.deflection > 0.02);
    CHECK(yields.highest_speed < 1);
    MESSAGE("peak force " << unyielding.peak_force << " N unyielding, " << yields.peak_force
                          << " N yielding by " << 1000 * yields.deflection << " mm");
  }
}
