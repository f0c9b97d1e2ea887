#include "skinctl/limits/motion_limits.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/testing/plant.hpp"

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
      const auto free = run(Cycle(arm, Drive(tau) + GravityControl{}, NoGovernor{}), period, 1);
      CHECK((free.speed > 1.5 || free.beyond > 0.1));
    }
  }
}

TEST_CASE("MotionLimits: leaves a robot that keeps them alone, to the bit") {
  const auto arm = by_torque(ur5::Model{}, {.limits = limits(), .period = 2ms}, FrictionUncompensated{});
  const Cycle kept(arm, Drive(JointTorque<6>{0.5, 0, 0, 0, 0, 0}) + GravityControl{});
  const Cycle free(arm, Drive(JointTorque<6>{0.5, 0, 0, 0, 0, 0}) + GravityControl{}, NoGovernor{});
  const auto a = run(kept, 2ms, 0.5), b = run(free, 2ms, 0.5);
  CHECK(a.last == b.last);
  CHECK(a.last[0] != 0);
  CHECK_FALSE(a.status.has(Reason::velocity_limited));
}

TEST_CASE_TEMPLATE("MotionLimits: every velocity is answered, the nearest that can still stop", T, float,
                   double) {
  auto v = limits_of<ur5::Description, T>(T(15)).values();
  v.lower = JointPosition<6, T>::constant(T(-1));
  v.upper = JointPosition<6, T>::constant(T(1));
  const JointLimits<6, T> limit(v);
  const MotionLimits<ur5::Model, T> motion(ur5::Model{});
  for (const T q : {T(-2), T(-1), T(0), T(0.999), T(1), T(3)})
    for (const T u : {T(-9), T(-1), T(0), T(0.5), T(9)}) {
      Status status;
      const auto kept = motion.within(limit, JointPosition<6, T>::constant(q),
                                      JointVelocity<6, T>::constant(u), T(0.008), status);
      CAPTURE(q);
      CAPTURE(u);
      const T k = kept[0];
      CHECK(k * u >= T(0));
      CHECK(std::abs(k) <= std::abs(u));
      CHECK(std::abs(k) <= limit.velocity()[0]);
      if (k > T(0)) CHECK(k * T(0.008) + k * k / T(30) <= (T(1) - q) * T(1.0001));
      if (k < T(0)) CHECK(-k * T(0.008) + k * k / T(30) <= (q + T(1)) * T(1.0001));
      CHECK((k == u) == !status.any());
    }
}
