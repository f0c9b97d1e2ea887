// Promise: a robot by torque keeps the position and speed limits of its joints, whatever its law drives
// Tried: UR5 without friction, each joint and all together driven at its ends, 250 to 1000 Hz: 1 mrad
// beyond an end, 5 % above a speed; to the bit as without where no limit is near
//
// Promise: only a joint that would break a limit loses torque, and only towards the inside
// Tried: random states and torques of a UR5, the accelerations asked of forward dynamics;
// `nearest_in_box` against random velocities of the box for up to 16 joints with masses down to a
// millionth. Also: `limits/nearest_in_box_test.cpp`

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// A law that knows no limit: a constant torque beside gravity.
struct Drive : StatelessLaw<Drive> {
  JointTorque<6> tau;
  explicit Drive(const JointTorque<6>& t) : tau(t) {}
  JointTorque<6> torque(const auto&) const noexcept { return tau; }
};
JointLimits<6> limits() {
  auto v = limits_of<ur5::Description>(15.0).values();
  v.lower = JointPosition<6>{-1, -2, 0.5, -2.5, -2.2, -1};
  v.upper = JointPosition<6>{1, -0.5, 2, -1, -1, 1};
  v.velocity = JointVelocity<6>::constant(1.5);
  return JointLimits<6>(v);
}
struct Worst {
  double speed = 0;   ///< over the limit, in parts of it
  double beyond = 0;  ///< beyond an end [rad]
  Status status;
  JointVelocity<6> last;
};
template <class Scene>
Worst run(const Scene& scene, Nanoseconds period, double duration) {
  const ur5::Model model;
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> x{0ns, {0.0, -1.2, 1.4, -1.8, -1.57, 0.3}, {}};
  scene.start(*memory, x);
  Worst w;
  const auto limit = limits();
  for (int k = 1; k * seconds<double>(period) < duration; ++k) {
    typename Scene::Input input;
    input.now = x.time = k * period;
    input.measured = x;
    const auto out = scene.step(*memory, input);
    w.status |= out.status;
    x = simulate(model, x, out.command.torque, seconds<double>(period));
    for (std::size_t i = 0; i < 6; ++i) {
      w.speed = std::max(w.speed, std::abs(x.dq[i]) / limit.velocity()[i]);
      w.beyond = std::max({w.beyond, x.q[i] - limit.upper()[i], limit.lower()[i] - x.q[i]});
    }
  }
  w.last = x.dq;
  return w;
}
}  // namespace

TEST_CASE("MotionLimits: a scene by torque keeps position and speed, whatever its law drives") {
  const JointTorque<6> drives[] = {{30, 0, 0, 0, 0, 0},     {0, 40, 0, 0, 0, 0},      {0, 0, -20, 0, 0, 0},
                                   {0, 0, 0, 6, 0, 0},      {0, 0, 0, 0, -3, 0},      {0, 0, 0, 0, 0, 2},
                                   {30, -40, 20, 5, -3, 2}, {-30, 40, -20, -5, 3, -2}};
  for (const Nanoseconds period : {Nanoseconds(1ms), Nanoseconds(2ms), Nanoseconds(4ms)}) {
    const auto arm = by_torque(ur5::Model{}, {.limits = limits(), .period = period}, FrictionUncompensated{});
    for (const auto& tau : drives) {
      CAPTURE(period.count());
      CAPTURE(tau[0]);
      CAPTURE(tau[1]);
      const auto kept = run(Cycle(arm, Drive(tau) + GravityControl{}), period, 3);
      CHECK(kept.speed <= 1.05);
      CHECK(kept.beyond <= 1e-3);
      CHECK((kept.status.has(Reason::position_limited) || kept.status.has(Reason::velocity_limited)));
      const auto free = run(Cycle(arm, Drive(tau) + GravityControl{}).without<MotionByTorque>(), period, 1);
      CHECK((free.speed > 1.5 || free.beyond > 0.1));
    }
  }
}

TEST_CASE("MotionLimits: leaves a robot that keeps them alone, to the bit") {
  const auto arm = by_torque(ur5::Model{}, {.limits = limits(), .period = 2ms}, FrictionUncompensated{});
  const Cycle kept(arm, Drive(JointTorque<6>{0.5, 0, 0, 0, 0, 0}) + GravityControl{});
  const auto free = kept.without<MotionByTorque>();
  const auto a = run(kept, 2ms, 0.5), b = run(free, 2ms, 0.5);
  CHECK(a.last == b.last);
  CHECK(a.last[0] != 0);
  CHECK_FALSE(a.status.has(Reason::velocity_limited));
}

// Of one step: what it does to a torque, asked of a model that shares no line with it.
TEST_CASE_TEMPLATE(
    "MotionLimits: only joints that would break a limit lose torque, towards the inside, within its rate", T,
    float, double) {
  using M = StaticModel<ur5::Description>;
  auto v = limits_of<ur5::Description, T>(T(15)).values();
  v.lower = JointPosition<6, T>::constant(T(-1));
  v.upper = JointPosition<6, T>::constant(T(1));
  const JointLimits<6, T> limit(v);
  const MotionLimits<M, T> motion(M{});
  Random random = seeded(5);
  int bound = 0, kept = 0;
  for (int k = 0; k < 300; ++k) {
    State<6, T> s;
    JointTorque<6, T> asked;
    for (std::size_t i = 0; i < 6; ++i) {
      s.q[i] = uniform(random, T(-1.02), T(1.02));
      s.dq[i] = uniform(random, T(-3), T(3));
      asked[i] = (random() % 2 == 0 ? T(1) : T(0.05)) * uniform(random, T(-1), T(1)) * limit.torque()[i];
    }
    const T ahead = T(0.01);
    const JointAngles<M, T> angles(M{}, s.q);
    const auto mass = mass_matrix(M{}, angles);
    typename MotionLimits<M, T>::Memory m{};
    const auto out = motion.within(m, limit, mass, bias_torque(M{}, angles, s.dq), s, asked, asked, ahead,
                                   T(0.002), T(1e6));
    const auto given = forward_dynamics(M{}, s.q, s.dq, out.torque).acceleration;
    kept += !out.altered;
    if (!out.altered) CHECK(out.torque == asked);
    for (std::size_t i = 0; i < 6; ++i) {
      CAPTURE(k);
      CAPTURE(i);
      const T u = s.dq[i] + ahead * given[i], lost = asked[i] - out.torque[i];
      const T up = std::min(T(3.14159274), speed_to_stop(T(T(1) - s.q[i]), T(4) * ahead, T(15)));
      const T down = std::min(T(3.14159274), speed_to_stop(T(s.q[i] + T(1)), T(4) * ahead, T(15)));
      const bool saturated = std::abs(out.torque[i]) >= limit.torque()[i];
      const T slack = T(std::is_same_v<T, float> ? 0.02 : 1e-5);
      if (!saturated) CHECK(u <= up + slack);
      if (!saturated) CHECK(u >= -down - slack);
      // Torque is lost at a bound only, and towards the inside.
      if (lost > T(0) && !saturated) CHECK(u >= up - slack);
      if (lost < T(0) && !saturated) CHECK(u <= -down + slack);
      bound += lost != T(0);
    }
    // A guard that turns torques slowly: no step beyond it.
    const auto slow = motion.within(m, limit, mass, bias_torque(M{}, angles, s.dq), s, asked, asked, ahead,
                                    T(0.002), T(10));
    for (std::size_t i = 0; i < 6; ++i)
      CHECK(std::abs(slow.torque[i] - asked[i]) <= T(0.02001) * limit.torque()[i]);
  }
  CHECK(bound > 100);
  CHECK(kept > 0);
  // What cannot be predicted passes.
  State<6, T> s;
  s.q[2] = std::numeric_limits<T>::quiet_NaN();
  typename MotionLimits<M, T>::Memory m{};
  const auto asked = JointTorque<6, T>::constant(T(3));
  const JointAngles<M, T> angles(M{}, s.q);
  const auto out = motion.within(m, limit, mass_matrix(M{}, angles), bias_torque(M{}, angles, s.dq), s, asked,
                                 asked, T(0.01), T(0.002), T(50));
  CHECK_FALSE(out.altered);
  CHECK(out.torque == asked);
}
