// The worlds of the trade study: stiff joints that follow commands, pressed by forces that are given, or by a
// stiff finger.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "bench/studies/trade/point.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/sensing/send_on_delta.hpp"
#include "skinctl/tactile/cell_place.hpp"
#include "skinctl/testing/pressing.hpp"
#include "tests/support/simulated_joints.hpp"

namespace trade {

using namespace skinctl;

/// A press on link `link`: a round body on its cells.
struct Press {
  testing::Pressing body;   ///< its force is the largest [N]
  double from = 0, to = 0;  ///< [s]
  double stiffness =
      0;  ///< of a finger that moves `depth` [m] into the link and back [N/m]; 0: forces are given
  double depth = 0;
};
struct World {
  std::vector<Press> presses;
  double seconds_long = 2;
};

/// Half a sine's square: smooth, and zero at both ends.
inline double bump(double t, double from, double to) {
  if (!(t > from && t < to)) return 0;
  const double s = std::sin(std::numbers::pi * (t - from) / (to - from));
  return s * s;
}

/// One cycle's input in a record.
template <class Scene>
struct Recorded {
  typename Scene::Input input;
  std::size_t first = 0, count = 0;  ///< of its samples
};
template <class Scene>
struct Record {
  State<Scene::joints, typename Scene::scalar> start;
  std::vector<Recorded<Scene>> cycles;
  std::vector<CellSample> samples;

  typename Scene::Input input(std::size_t k) const {
    auto in = cycles[k].input;
    in.samples = std::span<const CellSample>(samples).subspan(cycles[k].first, cycles[k].count);
    return in;
  }
};

/// Places on the links of a robot in the base's axes, by its model in double; `tool` [m] stands on link
/// `Tool`.
template <class M, std::size_t Tool>
struct Places {
  M model;
  Xyz<double> on_tool{0.0, 0.0, 0.0};
  using Row = std::array<double, M::joints>;

  Xyz<double> operator()(const Row& q, std::size_t link, const Xyz<double>& p) const {
    const Poses<M, all_links(M::joints), double> poses(model, JointPosition<M::joints>(q));
    Xyz<double> out{0.0, 0.0, 0.0};
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      ((I == link ? void(out = poses.template get<I>().translated(p.x, p.y, p.z).origin()) : void()), ...);
    }(std::make_index_sequence<M::joints>{});
    return out;
  }
  Xyz<double> tool(const Row& q) const { return (*this)(q, Tool, on_tool); }
};

/// Runs `scene` in `world`; `goal(t)` sets goals. `place(q, link, p)` is a point of a link in the base's axes
/// and `turn` its direction, both in double.
template <class Scene, class Place, class Goal>
Course run(const Scene& scene, const World& world, const std::array<double, Scene::joints>& home,
           const std::vector<CellPlace>& cells, double newtons, const Choices& choices, const Place& place,
           const Goal& goal, Record<Scene>* record) {
  using T = typename Scene::scalar;
  constexpr std::size_t n = Scene::joints;
  constexpr Nanoseconds period = 8ms, tick = 4ms;
  testing::SimulatedJoints<n> joints(testing::SimulatedJoints<n>::Kind::position, 0.008, 0.008, home);
  const auto measure = [&](Nanoseconds now) {
    State<n, T> s;
    s.time = now;
    for (std::size_t i = 0; i < n; ++i) {
      s.q[i] = static_cast<T>(joints.q()[i]);
      s.dq[i] = static_cast<T>(joints.dq()[i]);
    }
    return s;
  };
  // A reading is the third of its cell's force over the gain; all three alike.
  SendOnDelta::Deltas deltas;
  deltas.force = static_cast<float>(std::max(1e-9, choices.event / (3 * newtons)));
  const SendOnDelta cell(deltas, 100ms, choices.patience);
  std::vector<SendOnDelta::Memory> sent(cells.size());
  std::vector<std::vector<double>> weights;
  std::vector<Xyz<double>> began;
  for (const Press& p : world.presses) {
    auto body = p.body;
    body.force = 1;
    weights.push_back(testing::pushes(cells, {&body, 1}));
    began.push_back(place(joints.q(), p.body.link, p.body.place));
  }
  std::vector<Xyz<double>> last = began;
  std::vector<double> before(world.presses.size());

  Course course;
  auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, measure(0ns));
  if (record != nullptr) record->start = measure(0ns);
  std::vector<CellSample> arrived;
  for (Nanoseconds now = tick; seconds<double>(now) < world.seconds_long; now += tick) {
    const double t = seconds<double>(now);
    joints.advance(t);
    double force = 0;
    std::vector<double> push(cells.size());
    for (std::size_t k = 0; k < world.presses.size(); ++k) {
      const Press& p = world.presses[k];
      const auto here = place(joints.q(), p.body.link, p.body.place);
      const auto tip = place(joints.q(), p.body.link, p.body.place + p.body.normal);
      const Xyz<double> normal = tip - here;
      double f = p.body.force * bump(t, p.from, p.to);
      if (p.stiffness > 0) {
        // The finger moves against the normal at the beginning.
        const auto straight = place(home, p.body.link, p.body.place + p.body.normal) - began[k];
        const double ahead = p.depth * bump(t, p.from, p.to) + dot(straight, here - began[k]);
        f = t > p.from && t < p.to ? std::max(0.0, p.stiffness * ahead) : 0;
      }
      course.energy -= 0.5 * (f + before[k]) * dot(normal, here - last[k]);
      last[k] = here;
      before[k] = f;
      force += f;
      for (std::size_t i = 0; i < cells.size(); ++i) push[i] += f * weights[k][i];
    }
    course.peak = std::max(course.peak, force);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      CellSample s;
      s.cell = static_cast<std::uint32_t>(i + 1);
      s.time = now;
      double reading = std::min(1.0, choices.gain * push[i] / (3 * newtons));
      if (choices.bits > 0)
        reading = std::round(std::ldexp(reading, int(choices.bits))) / std::exp2(choices.bits);
      for (float& f : s.force) f = static_cast<float>(reading);
      if (cell.send(sent[i], s)) arrived.push_back(s);
    }
    if (now % period != 0ns) continue;
    Recorded<Scene> in;
    in.input.now = now;
    in.input.measured = measure(now);
    goal(in.input, t);
    in.count = arrived.size();
    course.samples += arrived.size();
    if (record != nullptr) {
      in.first = record->samples.size();
      record->samples.insert(record->samples.end(), arrived.begin(), arrived.end());
      record->cycles.push_back(in);
    }
    in.input.samples = arrived;
    const auto out = scene.step(*memory, in.input);
    arrived.clear();
    std::array<double, n> q{};
    for (std::size_t i = 0; i < n; ++i) q[i] = static_cast<double>(out.command.position[i]);
    joints.command(t, q);
    course.tool.push_back(place.tool(joints.q()));
    course.force.push_back(force);
  }
  return course;
}

}  // namespace trade
