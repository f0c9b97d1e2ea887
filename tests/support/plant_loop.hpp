// skinctl around an arm that we did not write: delays, samples, a skin's cover, walls and hands.
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/passivity/contact_stability.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/mujoco_plant.hpp"

namespace skinctl::testing {

/// Pushes with a constant joint torque, and weakly holds its pose: a task that leans on a wall.
struct Lean : Composable {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  JointTorque<6> push;
  JointPosition<6> pose;
  JointTorque<6> spring;  ///< per joint [N m/rad]
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<6> torque(const Memory&, const K& known) const noexcept {
    JointTorque<6> tau = push;
    for (std::size_t i = 0; i < 6; ++i) tau[i] += spring[i] * (pose[i] - known.q()[i]);
    return tau;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};

/// The arm, touched at a point of link 4 along a fixed line; its skin sends 1000 samples a second.
class PlantLoop {
 public:
  static constexpr std::size_t link = 4;
  static constexpr double at[3] = {0, 0, 0.1};
  static constexpr double servo_lag = 0.008, quantum = 0.05;
  using Wrenches = LinkWrenches<ur5::Model, link_bit<link>>;
  using Robot = ResolverBy<Interface::position, ur5::Model, double, CrankNicolson, 128>;

  struct Setting {
    Nanoseconds period = 8ms;
    double delay = 0.008;   ///< of commands [s]; a measurement is fresh
    double lead = 1;        ///< force lead, in times of the loop's delay
    double heavier = 1;     ///< felt mass: force gain, decay and viscous friction are divided by it
    bool yields = true;     ///< false: the arm stands still, as without skinctl
    bool quantised = true;  ///< the skin's readings, to 0.05 N
    double lean = 0;        ///< force with which it leans into the contact [N]
    double decay = 4;
    std::array<double, 6> viscous{10, 10, 6, 2, 1, 0.5};
    JointPosition<6> q{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
  };

  explicit PlantLoop(const Setting& s)
      : setting_(s),
        plant_(oracle::ur5(), {s.q[0], s.q[1], s.q[2], s.q[3], s.q[4], s.q[5]},
               {.bandwidth = 2 / servo_lag, .rotor = {2, 2, 2, 0.5, 0.5, 0.5}}),
        robot_(ur5::Model{}, configuration(s)) {
    double v[3], R[9];
    plant_.point(int(link), at, start_, v, R);
    // Into the contact: along the axis of the link on which the point lies.
    for (std::size_t r = 0; r < 3; ++r) outward_[r] = R[3 * r + 2];
    Wrenches w;
    w.set<link>({{0, 0, -1}, {at[1] * -1.0, -at[0] * -1.0, 0}});
    contact_ = contacts_of(ur5::Model{}, s.q, w).list[0];
    for (std::size_t i = 0; i < 6; ++i) lean_.push[i] = s.lean * contact_.row[i];
    if (s.lean > 0) lean_.spring = {30, 30, 18, 3, 3, 1.5};
    lean_.pose = s.q;
    State<6> measured = measure(0ns);
    memory_ = robot_.start(measured);
  }

  static RobotConfiguration<6> configuration(const Setting& s) {
    RobotConfiguration<6> c{
        .limits = limits_of<ur5::Description>(100.0), .period = s.period, .delay = nanoseconds(s.delay)};
    c.lag = nanoseconds(servo_lag);
    c.virtual_damping = s.decay / s.heavier;
    for (std::size_t i = 0; i < 6; ++i) c.viscous_friction[i] = s.viscous[i] / s.heavier;
    c.dead_band = JointPosition<6>::constant(0.02);
    c.force_lead = nanoseconds(s.lead * seconds<double>(c.total_delay()));
    return c;
  }
  /// The row of the contact at the start.
  const Contact<6>& contact() const { return contact_; }
  double total_delay() const { return robot_.total_delay(); }
  double time() const { return plant_.time(); }
  /// How far the point has come into the contact [m], and its speed.
  double depth = 0, speed = 0, force = 0;
  Status status;

  /// One step of the plant under `world(t, depth, speed)` >= 0 or not [N], and a cycle where one is due.
  void step(const std::function<double(double, double, double)>& world) {
    const Nanoseconds now = nanoseconds(plant_.time());
    if (now >= next_sample_) {
      const auto rounded = [&](double f) {
        return setting_.quantised ? quantum * std::round(f / quantum) : f;
      };
      samples_.push_back({next_sample_, {rounded(felt_[0]), rounded(felt_[1]), rounded(felt_[2])}});
      next_sample_ += 1ms;
    }
    if (now >= next_) cycle(next_);
    double x[3], v[3], R[9];
    plant_.point(int(link), at, x, v, R);
    depth = speed = 0;
    for (std::size_t r = 0; r < 3; ++r)
      depth += outward_[r] * (x[r] - start_[r]), speed += outward_[r] * v[r];
    force = world(plant_.time(), depth, speed);
    const double push[3] = {-force * outward_[0], -force * outward_[1], -force * outward_[2]};
    // Along the link's axes: what its skin feels.
    for (std::size_t r = 0; r < 3; ++r) felt_[r] = R[r] * push[0] + R[3 + r] * push[1] + R[6 + r] * push[2];
    while (!under_way_.empty() && under_way_.front().first <= plant_.time() + 1e-9) {
      plant_.command(under_way_.front().second.data());
      under_way_.pop_front();
    }
    plant_.step(int(link), at, push);
  }

 private:
  State<6> measure(Nanoseconds now) const {
    State<6> s;
    s.time = now;
    for (std::size_t i = 0; i < 6; ++i) s.q[i] = plant_.q()[i], s.dq[i] = plant_.dq()[i];
    return s;
  }
  void cycle(Nanoseconds now) {
    next_ = now + setting_.period;
    if (!setting_.yields || now == 0ns) return;
    const auto interval = robot_.interval(memory_, now);
    Wrenches parts[max_substeps];
    for (unsigned j = 0; j < interval.substeps; ++j) {
      // The samples from the beginning of the sub-step to its end, linear between them.
      Xyz<double> sum{0, 0, 0};
      double n = 0;
      const Nanoseconds from = interval.at(j), to = interval.at(j + 1);
      for (const auto& [time, f] : samples_)
        if (time >= from && time <= to) {
          const double weight = time == from || time == to ? 0.5 : 1;
          sum = sum + weight * f;
          n += weight;
        }
      const Xyz<double> F = (1 / n) * sum;
      parts[j].set<link>({F, cross(Xyz<double>{at[0], at[1], at[2]}, F)});
    }
    samples_ = {samples_.back()};
    Wrenches changes[max_substeps];
    for (unsigned j = 0; j < interval.substeps; ++j) {
      parts[j] = (1 / setting_.heavier) * parts[j];
      changes[j] = TouchChange<Wrenches>::next(touch_, parts[j]);
    }
    const auto law = 1.0 * lean_ + SkinJointControl{} + GravityControl{};
    const auto out = robot_.step(memory_, law, law_memory_, measure(now), interval,
                                 std::span<const Wrenches>(parts, interval.substeps), AnyState{},
                                 PressedUnknown{}, std::span<const Wrenches>(changes, interval.substeps));
    status |= out.status;
    std::array<double, 6> q{};
    std::copy_n(out.command.position.data, 6, q.begin());
    under_way_.push_back({seconds<double>(now) + setting_.delay, q});
  }

  using Law = decltype(1.0 * Lean{} + SkinJointControl{} + GravityControl{});
  Setting setting_;
  oracle::MujocoPlant plant_;
  Robot robot_;
  Robot::Memory memory_;
  Lean lean_;
  Law::Memory law_memory_{};
  TouchChange<Wrenches>::Memory touch_{};
  Contact<6> contact_;
  double start_[3], outward_[3], felt_[3] = {};
  Nanoseconds next_{}, next_sample_{};
  std::vector<std::pair<Nanoseconds, Xyz<double>>> samples_;
  std::deque<std::pair<double, std::array<double, 6>>> under_way_;
};

/// A wall at `gap` [m], the skin's cover on it: never pulls.
inline auto wall(double stiffness, double gap = 0.002, double cover = 3e4) {
  const double k = stiffness * cover / (stiffness + cover);
  return [=](double, double depth, double) { return std::max(0.0, k * (depth - gap)); };
}

/// How far the admittance at the contact is from the configured one, relative and complex, at `frequency`
/// [1/s]: a hand, a spring and damper, goes to and fro.
inline double admittance_error(PlantLoop::Setting s, double frequency, double speed_amplitude = 0.005) {
  using C = std::complex<double>;
  s.quantised = false;
  PlantLoop loop(s);
  const double w = 2 * M_PI * frequency, amplitude = speed_amplitude / w,
               begin = std::ceil(4 + 1.5 * frequency) / frequency,
               end = begin + std::ceil(4 * std::max(1.0, 0.25 * frequency)) / frequency;
  C v(0), f(0);
  while (loop.time() < end) {
    const double t = loop.time();
    loop.step([&](double now, double depth, double speed) {
      const double ramp = std::min(1.0, now / (0.6 * begin)), smooth = ramp * ramp * (3 - 2 * ramp);
      return 800 * (depth - smooth * amplitude * std::sin(w * now)) +
             30 * (speed - smooth * amplitude * w * std::cos(w * now));
    });
    if (t >= begin) {
      const C turn = std::exp(C(0, -w * t));
      v += loop.speed * turn, f += loop.force * turn;
    }
  }
  // The push goes against the displacement: v / f = -Y.
  auto c = PlantLoop::configuration(s);
  c.delay = 0ns;
  double row[6];
  std::copy_n(loop.contact().row, 6, row);
  const ContactStability<ur5::Model> stability(ur5::Model{}, c, {.stiffness = 1});
  const C want = C(0, w) * stability.response(stability.modes(s.q), row, w) / stability.path().at(w);
  return std::abs(-v / f - want) / std::abs(want);
}

/// What is left of a contact after it has settled: peak-to-peak and mean force over the last second.
struct Settled {
  double mean = 0, swing = 0, peak = 0;
  bool calm() const { return swing < std::max(0.05 * mean, 2 * PlantLoop::quantum); }
};
template <class World>
Settled settle(PlantLoop& loop, const World& world, double time) {
  double low = 1e9, high = 0, sum = 0, peak = 0;
  long n = 0;
  while (loop.time() < time) {
    loop.step(world);
    peak = std::max(peak, loop.force);
    if (loop.time() < time - 1) continue;
    low = std::min(low, loop.force);
    high = std::max(high, loop.force);
    sum += loop.force;
    ++n;
  }
  return {sum / double(n), high - low, peak};
}

/// Whether a tiny disturbance of an arm that is tied to a spring dies out.
inline bool dies_out(PlantLoop::Setting s, double stiffness) {
  s.quantised = false;
  PlantLoop loop(s);
  const double kick = 1e-6, time = 3;
  double early = 0, late = 0;
  while (loop.time() < time) {
    loop.step([&](double, double depth, double) { return stiffness * (depth - kick); });
    const double off = std::abs(loop.speed);
    if (loop.time() > 0.25 * time && loop.time() < 0.5 * time) early = std::max(early, off);
    if (loop.time() > 0.75 * time) late = std::max(late, off);
  }
  return late < early && late < 1e-3;
}

}  // namespace skinctl::testing
