#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "skinctl/dynamics/energy.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

template <class T>
using Robot = ResolverBy<Interface::torque, ur5::Model, T>;
static_assert(std::is_trivially_copyable_v<Robot<double>::Memory>);

template <class T>
RobotConfiguration<6, T> configuration() {
  return {.limits = limits_of<ur5::Description, T>(), .period = 2ms};
}
/// What acts against a motion, of a torque that is held for 2 ms: D is 3 ms.
struct Drag {
  Eigen::Matrix<double, 6, 1> friction;  ///< `(B^-1 + D M^-1)^-1 dq`
  Eigen::Matrix<double, 6, 1> brakes;    ///< the same with 0.3 of what lacks to `M dq / D`
};
template <class T>
Drag held_drag(const JointTorque<6, T>& b, const State<6, T>& s, const JointTorque<6, T>& motors = {}) {
  auto mass = mass_matrix(ur5::Model{}, s.q);
  for (std::size_t i = 0; i < 6; ++i) mass(i, i) += motors[i];
  Eigen::Matrix<double, 6, 6> M, B;
  Eigen::Matrix<double, 6, 1> dq;
  B.setZero();
  for (std::size_t i = 0; i < 6; ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    B(r, r) = double(b[i]);
    dq[r] = double(s.dq[i]);
    for (std::size_t j = 0; j < 6; ++j) M(r, static_cast<Eigen::Index>(j)) = double(mass(i, j));
  }
  Drag out;
  out.friction = (B.inverse() + 0.003 * M.inverse()).inverse() * dq;
  out.brakes = out.friction + 0.3 * (M * dq / 0.003 - out.friction);
  return out;
}
struct Asks {
  static constexpr Needs needs = {.mass = true};
};
template <class T>
State<6, T> at(Nanoseconds time) {
  return {time, {T(0.1), T(-1.5), T(1.2), T(-1), T(-1.5), T(0.3)}, {T(0.5), T(0), T(-0.2), T(0), T(0), T(1)}};
}
template <class T>
auto step(const Robot<T>& robot, typename Robot<T>::Memory& m, Yield::Memory& law, const State<6, T>& s,
          Nanoseconds now, const JointTorque<6, T>& push) {
  const Pushed<6, T> pushes[1] = {{push}};
  return robot.step(m, Yield{}, law, s, robot.interval(m, now), std::span<const Pushed<6, T>>(pushes));
}

}  // namespace

TEST_CASE("Resolver for torques: refuses shapes that it cannot give a real robot") {
  const auto refused = [](auto&& change) {
    auto c = configuration<double>();
    change(c);
    return complaint_of([&] { const Robot<double> robot(ur5::Model{}, c); });
  };
  CHECK(refused([](auto&) {}).empty());
  CHECK(refused([](auto& c) { c.viscous_friction[0] = 3; }).empty());
  CHECK(refused([](auto& c) { c.virtual_damping = 1; }) ==
        "skinctl: virtual damping = 1, allowed: 0 for joints by torque");
  CHECK(refused([](auto& c) { c.coulomb_friction[1] = 1; }).find("Coulomb") != std::string::npos);
  CHECK(refused([](auto& c) { c.virtual_inertia[1] = 1; }).empty());  // of a motor
}

TEST_CASE_TEMPLATE(
    "Resolver for torques: the command is the law's torque at the measured state, less friction", T,
    SKINCTL_SCALARS) {
  auto c = configuration<T>();
  c.viscous_friction = {T(4), T(4), T(4), T(1), T(1), T(1)};
  const Robot<T> robot(ur5::Model{}, c);
  auto m = robot.start(at<T>(0ns));
  Yield::Memory law;
  const JointTorque<6, T> push{T(1), T(2), T(3), T(-1), T(0), T(0.5)};
  const auto out = step(robot, m, law, at<T>(2ms), 2ms, push);
  const auto s = at<T>(0ns);
  const auto gravity = gravity_torque(ur5::Model{}, s.q);
  CHECK_FALSE(out.status.any());
  CHECK(out.command.valid);
  CHECK(out.command.time == 2ms);
  CHECK(out.command.position == s.q);
  CHECK(law.evaluations == 1);
  const auto drag = held_drag(c.viscous_friction, s);
  for (std::size_t i = 0; i < 6; ++i) {
    const auto r = static_cast<Eigen::Index>(i);
    const double want = double(push[i]) + double(gravity[i]) - drag.friction[r];
    CHECK(double(out.command.torque[i]) == doctest::Approx(want).epsilon(1e-6));
    CHECK(double(out.hold[i]) == doctest::Approx(want - double(push[i])).epsilon(1e-5));
    CHECK(double(out.fallback[i]) == doctest::Approx(double(gravity[i]) - drag.brakes[r]).epsilon(1e-5));
  }
}

TEST_CASE_TEMPLATE("Resolver for torques: laws and friction know the motors, which outweigh a wrist", T,
                   SKINCTL_SCALARS) {
  auto c = configuration<T>();
  c.viscous_friction = JointTorque<6, T>::constant(T(4));
  const Robot<T> light(ur5::Model{}, c);
  c.virtual_inertia = {T(0.5), T(0.5), T(0.5), T(0.1), T(0.1), T(0.1)};
  const Robot<T> robot(ur5::Model{}, c);
  const State<6, T> s = at<T>(0ns);
  const auto drag = held_drag(c.viscous_friction, s, c.virtual_inertia);
  const auto gravity = gravity_torque(ur5::Model{}, s.q);
  const auto held = robot.held({}, s), too_little = light.held({}, s);
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(double(held[i]) ==
          doctest::Approx(double(gravity[i]) - drag.brakes[static_cast<Eigen::Index>(i)]).epsilon(1e-5));
  CHECK(drag.friction[5] > 3.5);  // of 4 N m at 1 rad/s
  CHECK(double(gravity[5] - too_little[5]) < 1.5);
  const NoTouch none;
  const auto known = robot.template known<Asks>(s, T(0.002), none);
  const auto links = mass_matrix(ur5::Model{}, s.q);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 0; j < 6; ++j)
      CHECK(double(known.mass()(i, j)) ==
            doctest::Approx(double(links(i, j)) + (i == j ? double(c.virtual_inertia[i]) : 0)).epsilon(1e-6));
}

TEST_CASE_TEMPLATE("Resolver for torques: torques are cut to the limits", T, SKINCTL_SCALARS) {
  const Robot<T> robot(ur5::Model{}, configuration<T>());
  auto m = robot.start(at<T>(0ns));
  Yield::Memory law;
  const auto out = step(robot, m, law, at<T>(2ms), 2ms, {T(1e9), T(-1e9), T(0), T(0), T(0), T(1e9)});
  CHECK(out.status == Status(Reason::torque_limited));
  CHECK(out.command.torque[0] == T(150));
  CHECK(out.command.torque[1] == T(-150));
  CHECK(out.command.torque[5] == T(28));
}

TEST_CASE_TEMPLATE("Resolver for torques: when no law can be asked, the robot brakes and gravity is held", T,
                   SKINCTL_SCALARS) {
  auto c = configuration<T>();
  c.viscous_friction = JointTorque<6, T>::constant(T(2));
  const Robot<T> robot(ur5::Model{}, c);
  const T nan = std::numeric_limits<T>::quiet_NaN();
  Yield::Memory law;
  const auto holds = [&](const auto& out, bool brakes = true) {
    const auto gravity = gravity_torque(ur5::Model{}, at<T>(0ns).q);
    const auto drag = held_drag(c.viscous_friction, at<T>(0ns));
    for (std::size_t i = 0; i < 6; ++i) {
      const double want = double(gravity[i]) - (brakes ? drag.brakes[static_cast<Eigen::Index>(i)] : 0.0);
      CHECK(double(out.command.torque[i]) == doctest::Approx(want).epsilon(1e-5));
    }
  };
  auto m = robot.start(at<T>(0ns));
  auto out = step(robot, m, law, at<T>(2ms), 2ms, JointTorque<6, T>::constant(nan));
  CHECK(out.status == Status(Reason::torque_not_finite));
  CHECK(law.evaluations == 0);
  holds(out);

  robot.stop(m);
  out = step(robot, m, law, at<T>(4ms), 4ms, JointTorque<6, T>::constant(T(3)));
  CHECK(out.status == Status(Reason::stopping));
  holds(out);
  robot.resume(m);
  CHECK_FALSE(step(robot, m, law, at<T>(6ms), 6ms, {}).status.any());

  auto bad = at<T>(8ms);
  bad.q[3] = nan;
  out = step(robot, m, law, bad, 8ms, {});
  CHECK(out.status == Status(Reason::state_not_finite));
  CHECK(m.measured().q == at<T>(0ns).q);
  out = step(robot, m, law, bad, 40ms, JointTorque<6, T>::constant(T(3)));
  CHECK(out.status.has(Reason::state_stale));
  holds(out, false);  // nobody knows how it moves: braking by an old velocity would push
}

TEST_CASE_TEMPLATE("Resolver for torques: a push moves a robot that obeys, friction stops it", T,
                   SKINCTL_SCALARS) {
  // One turn of the real thing: M ddq = command + push - C dq - G, integrated finely by its definition.
  auto c = configuration<T>();
  c.viscous_friction = {T(20), T(20), T(10), T(2), T(1), T(0.5)};
  const Robot<T> robot(ur5::Model{}, c);
  State<6, T> s = at<T>(0ns);
  s.dq = {};
  auto m = robot.start(s);
  Yield::Memory law;
  const NoTouch none;
  const VirtualDynamics<6, T> ideal;
  const auto start = s.q;
  for (Nanoseconds now = 2ms; now < 4s; now += 2ms) {
    s.time = now;
    const T push = now < 500ms ? T(5) : T(0);
    const auto out = step(robot, m, law, s, now, {push, T(0), T(0), T(0), T(0), T(0)});
    JointAcceleration<6, T> last;
    const Quantities<ur5::Model, CrankNicolson::needs, T> known(ur5::Model{}, s, T(0.002), none);
    const auto next = detail::step_velocity<CrankNicolson>(known, ideal, false, out.command.torque, last);
    for (std::size_t i = 0; i < 6; ++i) s.q[i] += T(0.001) * (s.dq[i] + next.velocity[i]);
    s.dq = next.velocity;
  }
  CHECK(double(s.q[0] - start[0]) == doctest::Approx(5 * 0.5 / 20).epsilon(0.05));  // impulse / friction
  CHECK(std::abs(s.dq[0]) < T(1e-3));
}

TEST_CASE(
    "Resolver for torques: a stopped robot without friction brakes within 50 ms, stays, and can be moved "
    "away") {
  const Robot<double> robot(ur5::Model{}, configuration<double>());
  auto m = robot.start(at<double>(0ns));
  Yield::Memory law;
  robot.stop(m);
  State<6> s = at<double>(0ns);
  const auto energy = [&] {
    return kinetic_energy(ur5::Model{}, JointAngles<ur5::Model, double>(ur5::Model{}, s.q), s.dq);
  };
  const auto run = [&](Nanoseconds duration, const JointTorque<6>& push) {
    for (const Nanoseconds end = s.time + duration; s.time < end;) {
      const auto out = step(robot, m, law, s, s.time + 2ms, {});
      s = simulate(ur5::Model{}, s, out.command.torque + push, 0.002);
    }
  };
  const double begun = energy();
  run(50ms, {});
  CHECK(energy() < 0.01 * begun);
  const double from = s.q[0];
  run(1s, {20.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  CHECK(s.q[0] - from > 0.001);
  CHECK(s.q[0] - from < 0.02);
  run(1s, {});
  CHECK(std::abs(s.q[0] - from) < 1e-4);
  // More than 0.3 of the limit: a person moves it away, and there it stays.
  run(1s, {60.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  CHECK(s.q[0] - from > 0.1);
  const double led = s.q[0];
  run(1s, {});
  CHECK(energy() < 1e-6);
  CHECK(std::abs(s.q[0] - led) < 0.05);
}

TEST_CASE("Resolver for torques: time that goes back or stands still repeats the command") {
  const Robot<double> robot(ur5::Model{}, configuration<double>());
  auto m = robot.start(at<double>(10ms));
  Yield::Memory law;
  CHECK(step(robot, m, law, at<double>(10ms), 10ms, {}).status == Status(Reason::interval_empty));
  auto elsewhere = at<double>(8ms);
  elsewhere.q[1] += 0.4;
  const auto late = step(robot, m, law, elsewhere, 8ms, {});
  CHECK(late.status == Status(Reason::time_backwards));
  const auto gravity = gravity_torque(ur5::Model{}, elsewhere.q);  // where it is, not where it was
  const auto drag = held_drag(JointTorque<6>::constant(1e-12), elsewhere);
  for (std::size_t i = 0; i < 6; ++i)
    CHECK(late.fallback[i] ==
          doctest::Approx(gravity[i] - drag.brakes[static_cast<Eigen::Index>(i)]).epsilon(1e-9));
  CHECK(law.evaluations == 0);
  auto bad = at<double>(0ns);
  bad.q[0] = std::nan("");
  m = robot.start(bad);
  CHECK_FALSE(step(robot, m, law, at<double>(8ms), 8ms, {}).command.valid);
}
