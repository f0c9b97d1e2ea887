// runs long: robots at any rate and delay
// Promise: the same contact gives the same motion at any rate
// Tried: 125 to 1000 Hz, cycles that jitter, one in ten missing: the end within 0.1 %, the virtual robot
// within 0.2 % of 10 kHz, a command after a late cycle within three periods at full speed (damping once a
// cycle, as usual: 3.5 to 81 %). Also: study `rates`
//
// Promise: it feels like the configured mass and friction
// Tried: within 5 % up to 0.05/(2 pi T), T = delay + lag + period. Also: `resolver/`, `cycle/`

#include "tests/support/closed_loop.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <complex>

#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/by_day.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::array<double, 6> pose{0.1, -1.5, 1.2, -1, -1.5, 0.3};
constexpr std::array<double, 6> still{};

template <class T = double>
RobotConfiguration<6, T> configuration(Nanoseconds period, double delay = 0.008, double lag = 0.008) {
  RobotConfiguration<6, T> c{.limits = limits_of<ur5::Description, T>(T(40)),
                             .period = period,
                             .delay = nanoseconds(delay),
                             .lag = nanoseconds(lag),
                             .virtual_damping = T(0)};
  c.viscous_friction = {T(20), T(20), T(10), T(2), T(1), T(0.5)};
  return c;
}
const Impulse nothing = [](double) { return still; };

// A push of `size` from `from` for `time` seconds that grows and fades smoothly.
double smooth_impulse(double t, double from, double time) {
  const double s = std::clamp(t - from, 0.0, time);
  return 0.5 * s - 0.25 * time / M_PI * std::sin(2 * M_PI * s / time);
}
Impulse constant(std::array<double, 6> torque, double from = 0, double until = 1e9) {
  return [=](double t) {
    auto out = torque;
    for (double& x : out) x *= std::clamp(t, from, until) - from;
    return out;
  };
}

double distance(const std::array<double, 6>& a, const std::array<double, 6>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

// How far the admittance of the real joints is from the configured one, relative.
template <Interface I>
double admittance_error(RobotConfiguration<6> c, double frequency_times_T, double real_delay,
                        double real_lag) {
  ClosedLoop<I> loop(c, pose, real_delay, real_lag);
  const double w = frequency_times_T / loop.robot.total_delay(), cycle = 2 * M_PI / w, k = w / 8;
  constexpr double amplitude[6] = {3, 4, 2, 0.5, 0.3, 0.05};
  // tau = ramp * cos(w t), the ramp over four cycles so that nothing rings on.
  const auto grown = [&](double t) {
    return 0.5 * std::sin(w * t) / w -
           0.25 * (std::sin((w + k) * t) / (w + k) + std::sin((w - k) * t) / (w - k));
  };
  const Impulse impulse = [&](double t) {
    const double ramp = 4 * cycle,
                 f = t < ramp ? grown(t) : grown(ramp) + (std::sin(w * t) - std::sin(w * ramp)) / w;
    std::array<double, 6> out{};
    for (std::size_t i = 0; i < 6; ++i) out[i] = amplitude[i] * f;
    return out;
  };
  const double dt = seconds<double>(c.period);
  const auto begin = static_cast<long>(std::ceil(8 * cycle / dt)), end = begin + std::lround(4 * cycle / dt);
  std::array<double, 6> last{};
  std::array<std::complex<double>, 6> sum{};
  Status status;
  for (long n = 1; n <= end; ++n) {
    status |= loop.step(n * c.period, impulse).status;
    if (n > begin)
      for (std::size_t i = 0; i < 6; ++i)
        sum[i] +=
            (loop.joints.q()[i] - last[i]) * std::exp(std::complex<double>(0, -w * (double(n) - 0.5) * dt));
    last = loop.joints.q();
  }
  CHECK(status == Status{});
  const auto m = mass_matrix(ur5::Model{}, JointPosition<6>(loop.joints.q()));
  Eigen::Matrix<std::complex<double>, 6, 6> Z;
  Eigen::Matrix<std::complex<double>, 6, 1> tau, v;
  const double over = double(end - begin) * dt * std::sin(0.5 * w * dt) / (0.5 * w * dt);
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index j = 0; j < 6; ++j)
      Z(i, j) = std::complex<double>(0, w) * m(std::size_t(i), std::size_t(j));
    Z(i, i) += c.viscous_friction[std::size_t(i)];
    tau(i) = amplitude[i];
    v(i) = 2.0 * sum[std::size_t(i)] / over;
  }
  const auto want = Z.lu().solve(tau).eval();
  return (v - want).norm() / want.norm();
}

}  // namespace

TEST_CASE("Resolver: real joints feel like the configured robot, whatever their delay and rate") {
  for (const double delay : {0.0, 0.008, 0.02, 0.04})
    for (const Nanoseconds period : {8ms, 2ms}) {
      if (by_day && (delay == 0.008 || delay == 0.02)) continue;
      CAPTURE(delay);
      CAPTURE(period);
      const auto c = configuration(period, delay);
      CHECK(admittance_error<Interface::position>(c, 0.05, delay, 0.008) < 0.05);
      CHECK(admittance_error<Interface::velocity>(c, 0.05, delay, 0.008) < 0.05);
      CHECK(admittance_error<Interface::position>(c, 0.02, delay, 0.008) < 0.02);
      CHECK(admittance_error<Interface::velocity>(c, 0.02, delay, 0.008) < 0.02);
    }
}

TEST_CASE_TEMPLATE("Resolver: released, it comes to rest and stays", I,
                   std::integral_constant<Interface, Interface::position>,
                   std::integral_constant<Interface, Interface::velocity>) {
  ClosedLoop<I::value> loop(configuration(8ms), pose, 0.008, 0.008);
  const auto push = constant({10, -8, 5, 1, 0.5, 0.1}, 0.1, 0.6);
  Nanoseconds now{};
  for (; now < 3s;) loop.step(now += 8ms, push);
  const auto rest = loop.joints.q();
  CHECK(distance(rest, pose) > 0.1);
  for (; now < 10s;) loop.step(now += 8ms, push);
  CHECK(distance(rest, loop.joints.q()) < 1e-4);
  for (const double v : loop.joints.dq()) CHECK(std::abs(v) < 1e-6);
}

namespace {

// What was commanded when, and where the real joints were every 100 ms and in the end.
struct Path {
  std::vector<Nanoseconds> time;
  std::vector<std::array<double, 6>> command, joints;

  // Between two commands that lie close.
  std::array<double, 6> at(Nanoseconds t) const {
    const auto next = std::upper_bound(time.begin(), time.end(), t);
    if (next == time.begin()) return command.front();
    if (next == time.end()) return command.back();
    const auto k = std::size_t(next - time.begin());
    const double part = seconds<double>(t - time[k - 1]) / seconds<double>(time[k] - time[k - 1]);
    auto q = command[k - 1];
    for (std::size_t i = 0; i < 6; ++i) q[i] += part * (command[k][i] - q[i]);
    return q;
  }
  // How far the virtual robot is from that of `reference` at the same instants.
  double commands_off(const Path& reference) const {
    double worst = 0;
    for (std::size_t k = 0; k < time.size(); ++k)
      worst = std::max(worst, distance(command[k], reference.at(time[k])));
    return worst;
  }
};

// The same pushes at some rate, with cycles left out and jitter.
template <Interface I, class Integrator = CrankNicolson>
Path pushed_about(Nanoseconds period, double skipped, double jitter, double coulomb = 0) {
  auto c = configuration(period);
  c.limits = limits_of<ur5::Description>(200.0);
  c.virtual_damping = 1;
  c.coulomb_friction = JointTorque<6>::constant(coulomb);
  ClosedLoop<I, double, Integrator> loop(c, pose, 0.008, 0.008);
  const Impulse impulse = [](double t) {
    constexpr double size[6] = {25, -20, 12, 2, 1, 0.3};
    std::array<double, 6> out{};
    for (std::size_t i = 0; i < 6; ++i)
      out[i] = size[i] *
               (smooth_impulse(t, 0.1 + 0.037 * double(i), 0.6) -
                0.7 * smooth_impulse(t, 0.9, 0.3 + 0.05 * double(i)) + 0.5 * smooth_impulse(t, 1.3, 0.04));
    return out;
  };
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(0, 1);
  Nanoseconds now{}, next = 100ms;
  Path path;
  while (now < 4s) {
    Nanoseconds dt = period;
    while (unit(rng) < skipped) dt += period;
    now += dt + nanoseconds(jitter * (unit(rng) - 0.5) * seconds<double>(period));
    for (; next <= now; next += 100ms) {
      loop.joints.advance(seconds<double>(next));
      path.joints.push_back(loop.joints.q());
    }
    const auto out = loop.step(now, impulse);
    path.time.push_back(now);
    path.command.emplace_back();
    for (std::size_t i = 0; i < 6; ++i) path.command.back()[i] = out.command.position[i];
  }
  loop.joints.advance(seconds<double>(now) + 0.3);
  path.joints.push_back(loop.joints.q());
  return path;
}

}  // namespace

TEST_CASE("Resolver: the same touch gives the same motion at any rate, less what late cycles miss") {
  for (const double coulomb : {0.0, 0.5}) {
    const auto reference = pushed_about<Interface::position>(200us, 0, 0, coulomb);
    const double travel = distance(reference.joints.back(), pose);
    CHECK(travel > 0.3);
    const auto end = [&](const Path& path) {
      return distance(path.joints.back(), reference.joints.back()) / travel;
    };
    for (const Nanoseconds period : {8ms, 4ms, 2ms, 1ms})
      for (const double skipped : {0.0, 0.1}) {
        CAPTURE(period);
        CAPTURE(skipped);
        const double jitter = skipped > 0 ? 0.8 : 0;
        const auto path = pushed_about<Interface::position>(period, skipped, jitter, coulomb);
        // What a late cycle misses is not caught up: a share of the way as that of the time.
        CHECK(end(path) < (skipped > 0 ? 0.2 : 5e-4));
        CHECK(path.commands_off(reference) < (skipped > 0 ? 0.25 : 2e-3) * travel);
        if (skipped == 0)  // on the way a held command is half a period late, at up to 3 rad/s
          for (std::size_t k = 0; k < path.joints.size(); ++k)
            CHECK(distance(path.joints[k], reference.joints[k]) <
                  1.5 * seconds<double>(period) + 1e-3 * travel);
        CHECK(end(pushed_about<Interface::velocity>(period, skipped, jitter, coulomb)) <
              (skipped > 0 ? 0.02 : 5e-4));
        const auto semi =
            pushed_about<Interface::position, SemiImplicitEuler>(period, skipped, jitter, coulomb);
        CHECK(end(semi) < (skipped > 0 ? 0.2 : 5e-3));
        CHECK(semi.commands_off(reference) < (skipped > 0 ? 0.25 : 1e-2) * travel);
      }
  }
}

TEST_CASE_TEMPLATE("Resolver: a blocked arm does not run away, says so, and comes back smoothly", I,
                   std::integral_constant<Interface, Interface::position>,
                   std::integral_constant<Interface, Interface::velocity>) {
  for (const Nanoseconds period : {8ms, 2ms})
    for (const double delay : {0.008, 0.02}) {
      CAPTURE(period);
      CAPTURE(delay);
      auto c = configuration(period, delay);
      ClosedLoop<I::value> loop(c, pose, delay, 0.008);
      const double dt = seconds<double>(period), T = loop.robot.total_delay();
      // 300 N at 0.4 m for 2 s; joint 0 is stuck all the while and 1 s longer.
      const auto push = constant({120, 0, 0, 0, 0, 0}, 0.5, 2.5);
      bool blocked = false;
      double last_rate = 0, farthest = 0, blocked_since = 0, free_since = 0;
      for (Nanoseconds now = period; now < 6s; now += period) {
        const double t = seconds<double>(now);
        loop.joints.hold_fast(0, t > 0.3 && t < 3.5);
        const auto out = loop.step(now, push);
        const double lead = std::abs(loop.memory.group().q.value[0] - loop.joints.q()[0]);
        farthest = std::max(farthest, lead);
        REQUIRE(lead <= c.largest_distance()[0]);
        const double rate = out.command.velocity[0];
        REQUIRE(std::abs(rate - last_rate) <= 40 * dt * (1 + 1e-9));
        last_rate = rate;
        if (out.status.has(Reason::blocked)) {
          if (!blocked) blocked_since = t;
          blocked = true;
        } else if (blocked && t > 2.6 && free_since == 0) {
          free_since = t;
        }
        // No push is left: the command stays where it is, within the dead band.
        if (t > 3.3 && t < 3.5) CHECK(lead < 1.01 * c.dead_band[0]);
      }
      CHECK(blocked);
      CHECK(blocked_since < 0.5 + 5 * T + 0.4);
      CHECK(farthest > 0.01);
      CHECK(free_since > 2.5);
      CHECK(free_since < 3.2);
      CHECK(std::abs(loop.joints.q()[0] - pose[0]) < 0.02);  // nothing of the push was saved up
    }
}

TEST_CASE("Resolver: a slow push on a stuck joint is noticed too") {
  for (const double torque : {0.2, 1.0, 5.0}) {
    ClosedLoop<Interface::position> loop(configuration(8ms), pose, 0.008, 0.008);
    ClosedLoop<Interface::velocity> other(configuration(8ms), pose, 0.008, 0.008);
    loop.joints.hold_fast(1, true);
    other.joints.hold_fast(1, true);
    bool noticed = false, other_noticed = false;
    for (Nanoseconds now = 8ms; now < 20s; now += 8ms) {
      noticed |= loop.step(now, constant({0, torque, 0, 0, 0, 0})).status.has(Reason::blocked);
      other_noticed |= other.step(now, constant({0, torque, 0, 0, 0, 0})).status.has(Reason::blocked);
    }
    CAPTURE(torque);
    CHECK(noticed);
    if (torque > 0.5) CHECK(other_noticed);  // 0.2 N m: 0.01 rad/s, the declared drift
  }
}

TEST_CASE_TEMPLATE("Resolver: follows a robot that was moved", I,
                   std::integral_constant<Interface, Interface::position>,
                   std::integral_constant<Interface, Interface::velocity>) {
  ClosedLoop<I::value> loop(configuration(8ms), pose, 0.008, 0.008);
  Nanoseconds now{};
  for (; now < 1s;) loop.step(now += 8ms, nothing);
  loop.joints.displace(0, 0.12);
  loop.joints.displace(2, -0.1);
  double speed = 0;
  for (; now < 4s;) {
    const auto out = loop.step(now += 8ms, nothing);
    for (const double v : out.command.velocity) speed = std::max(speed, std::abs(v));
  }
  CHECK(speed < 3.2);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(std::abs(loop.memory.group().q.value[i] - loop.joints.q()[i]) <
          1.01 * loop.robot.parameters().dead_band[i]);
    CHECK(std::abs(loop.memory.command().velocity[i]) < 1e-3);
  }
}

TEST_CASE_TEMPLATE("Resolver: encoder noise and jitter stay within the dead band", I,
                   std::integral_constant<Interface, Interface::position>,
                   std::integral_constant<Interface, Interface::velocity>) {
  auto c = configuration(8ms);
  ClosedLoop<I::value> loop(c, pose, 0.008, 0.008), quiet(c, pose, 0.008, 0.008);
  loop.noise = 1e-4;
  std::mt19937_64 rng(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto push = constant({10, -8, 5, 1, 0.5, 0.1}, 0.1, 2.1);
  Nanoseconds planned{};
  for (int k = 0; k < 1000; ++k) {
    planned += 8ms;
    const Nanoseconds now = planned + nanoseconds(1e-3 * unit(rng));
    const auto out = loop.step(now, push);
    quiet.step(now, push);
    CHECK_FALSE(out.status.has(Reason::blocked));
    CHECK_FALSE(out.status.has(Reason::lead_limited));
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(std::abs(loop.memory.group().residual[i]) < 2e-3);
      if constexpr (I::value == Interface::position) {
        CHECK(out.command.position[i] == quiet.memory.command().position[i]);  // to the bit
      } else {
        CHECK(std::abs(out.command.velocity[i] - quiet.memory.command().velocity[i]) < 2e-4);
      }
    }
  }
}

TEST_CASE_TEMPLATE("Resolver: an undeclared millisecond of delay stays within the dead band", I,
                   std::integral_constant<Interface, Interface::position>,
                   std::integral_constant<Interface, Interface::velocity>) {
  for (const double wrong : {-0.001, 0.001}) {
    ClosedLoop<I::value> loop(configuration(8ms), pose, 0.008 + wrong, 0.008);
    const auto push = constant({40, -30, 15, 2, 0.5, 0.1}, 0.1, 0.8);
    for (Nanoseconds now = 8ms; now < 2s; now += 8ms)
      CHECK_FALSE(loop.step(now, push).status.has(Reason::blocked));
  }
}

TEST_CASE("Resolver: starts moving with a robot that moves") {
  auto c = configuration(8ms);
  ClosedLoop<Interface::position> loop(c, pose, 0.008, 0.008);
  State<6> s = loop.measure(0ns);
  s.dq = {1, -1, 0, 0, 0, 0};
  auto m = loop.robot.start(s);
  CHECK(m.group().v[0] == 1);
  CHECK(m.group().v[1] == -1);
  CHECK(m.command().position[0] == doctest::Approx(pose[0] + 0.016));
  CHECK(m.command().valid);
  s.dq = {0.05, 0, 0, 0, 0, 0};  // less than a fifth of the dead band in T and the undeclared lag: noise
  m = loop.robot.start(s);
  CHECK(m.group().v[0] == 0);
  CHECK(m.command().position[0] == pose[0]);
}

TEST_CASE("Resolver: a cycle allocates nothing") {
  ClosedLoop<Interface::position> loop(configuration(8ms), pose, 0.008, 0.008);
  const Pushed<6, double> pushes[max_substeps] = {};
  AllocationGuard guard;
  for (Nanoseconds now = 8ms; now < 1s; now += 8ms)
    loop.robot.step(loop.memory, loop.law, loop.law_memory, loop.measure(now),
                    loop.robot.interval(loop.memory, now), std::span<const Pushed<6, double>>(pushes));
  const auto count = guard.count();
  CHECK(count == 0);
}
