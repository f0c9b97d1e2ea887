// How late an arm follows, and how stiff its springs are: a gentle motion, then a push by hand.
#pragma once

#include <cmath>

#include "examples/adapters/clocked_driver.hpp"
#include "examples/compliant_arm/scene.hpp"
#include "skinctl/calibration/response_motion.hpp"
#include "skinctl/calibration/robot_response.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"

namespace compliant_arm {

/// Stiffness of a joint's spring by least squares of its deflections, `q - q_c = torque / k`.
class SpringFit {
 public:
  void add(double torque, double deflection) {
    tt_ += torque * torque, td_ += torque * deflection, dd_ += deflection * deflection;
    if (std::abs(torque) > largest_) largest_ = std::abs(torque);
    ++n_;
  }
  /// [N m/rad]; 0: unknown, the push was too weak, or what is deflected is no spring.
  [[nodiscard]] double stiffness() const {
    constexpr double weakest = 5, unexplained = 0.1;  // [N m]; share of the squared deflections
    if (n_ < 50 || largest_ < weakest || !(td_ > 0)) return 0;
    return 1 - td_ * td_ / (tt_ * dd_) < unexplained ? tt_ / td_ : 0;
  }

 private:
  double tt_ = 0, td_ = 0, dd_ = 0, largest_ = 0;
  int n_ = 0;
};

/// Where springs of the stiffness declared were held while the links moved so: without it what the links
/// swing on them is taken for a delay. `d de/dt + k e = M ddq + C dq`, e from the links to what holds them, d
/// the springs' damping.
template <std::size_t N>
void take_off_springs(const Model<N>& model, const Settings& s, skinctl::ResponseLog<N>& log) {
  using namespace skinctl;
  constexpr std::size_t wide = 3;  // samples to both sides, of which a velocity and an acceleration are made
  auto& m = log.measured;
  if (m.size() <= 2 * wide) return;
  const auto as_measured = m;
  JointPosition<N> e;
  for (std::size_t k = wide; k + wide < m.size(); ++k) {
    const auto &before = as_measured[k - wide], &now = as_measured[k], &after = as_measured[k + wide];
    const double a = now.time - before.time, b = after.time - now.time,
                 dt = now.time - as_measured[k - 1].time;
    if (!(a > 0 && b > 0)) continue;
    JointVelocity<N> dq;
    JointAcceleration<N> ddq;
    for (std::size_t i = 0; i < N; ++i) {
      const double u = (now.q[i] - before.q[i]) / a, w = (after.q[i] - now.q[i]) / b;
      dq[i] = (u * b + w * a) / (a + b), ddq[i] = 2 * (w - u) / (a + b);
    }
    const JointPosition<N> q(now.q);
    const auto mass = mass_matrix(model, q);
    const auto inertia = inverse_dynamics(model, q, dq, ddq) - gravity_torque(model, q);
    for (std::size_t i = 0; i < N; ++i) {
      const double lag = 2 * s.damping_ratio * std::sqrt(mass(i, i) / s.stiffness);
      const double to = inertia[i] / s.stiffness;
      e[i] = to + std::exp(-dt / lag) * (e[i] - to);
      m[k].q[i] += e[i];
    }
  }
}

/// Moves the joints by 0.1 rad for 15 s, then holds for `hold` seconds. The driver is connected.
template <class Driver>
Found identify_on(Driver& driver, const Model<Driver::joints>& model, const Settings& s, double hold,
                  const std::atomic<bool>& stop) {
  using namespace skinctl;
  constexpr std::size_t N = Driver::joints;
  const std::array<double, N> home = driver.newest().told;
  const ResponseMotion<N> motion(home, {.amplitude = 0.1, .speed = 0.6 * s.speed_share, .duration = 15});
  ResponseLog<N> log;
  std::array<SpringFit, N> springs;
  State<N> state;
  Nanoseconds begin{-1};
  const double period = seconds<double>(driver.protocol().period());
  Found found;
  for (double t = 0; t < motion.settings().duration + hold && !stop;) {
    const Heard heard = driver.wait(state);
    if (heard == Heard::lost) return found;
    if (begin < 0ns) begin = state.time;
    t = heard == Heard::state ? seconds<double>(state.time - begin) : t + period;
    const bool moves = t < motion.settings().duration;
    const std::array<double, N> q = moves ? motion.at(t) : home;
    PositionCommand<N> command;
    command.valid = true;
    command.position = JointPosition<N>(q);
    if (!driver.send(command)) return found;
    if (heard != Heard::state) continue;
    if (moves) {
      std::array<double, N> measured{};
      for (std::size_t i = 0; i < N; ++i) measured[i] = state.q[i];
      log.sent.push_back({t, q});
      log.measured.push_back({t, measured});
    } else if (driver.newest().external) {
      // Torques that change push masses too: a hand that pushes slowly, and all of its push, tell the spring.
      for (std::size_t i = 0; i < N; ++i)
        springs[i].add((*driver.newest().external)[i], state.q[i] - home[i]);
    }
  }
  driver.stop();  // nobody answers while it computes
  if (stop) return found;
  if (driver.newest().external) take_off_springs(model, s, log);
  const auto response = identify_response(model, log);
  found.known = response.total_delay.known();
  found.delay = response.delay.value, found.lag = response.lag.value;
  found.both = response.total_delay.value, found.deviation = response.total_delay.deviation;
  if (driver.newest().external)
    for (const SpringFit& spring : springs) found.stiffness.push_back(spring.stiffness());
  return found;
}

}  // namespace compliant_arm
