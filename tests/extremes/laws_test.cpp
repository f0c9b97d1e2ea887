// Laws at goals, states and touches at the ends of what a number holds: a goal that is no number is refused
// and the last one kept, and nothing of a state that was no number stays in a law's memory.
//
// Promise: a goal that is no number is refused and the last one kept; nothing of a state or touch that
// was no number stays in a law's memory
// Tried: 13 laws, 16 values

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/skinctl.hpp"
#include "tests/extremes/rows.hpp"

using namespace skinctl;
using namespace skinctl::extremes;

namespace {

using Arm = ur5::Model;
template <class T>
using Touch = LinkWrenches<Arm, 0b100000, T>;
/// What any of these laws reads.
constexpr Needs all{.jacobians = link_bit<5>,
                    .angles = true,
                    .gravity = true,
                    .mass = true,
                    .mass_factors = true,
                    .touch = true,
                    .middle = true};
template <class T>
using Known = Quantities<Arm, all, T, Touch<T>>;

template <class T>
State<6, T> at_home() {
  return {0ns, {T(0.3), T(-1.2), T(1.4), T(-1.8), T(-1.4), T(0.3)}, {}};
}
template <class T>
bool finite(const JointTorque<6, T>& tau) {
  for (const T x : tau)
    if (!std::isfinite(x)) return false;
  return true;
}
const auto X_LT = Transform<Link<5>, Tool>::translation_xyz(0.02, 0, 0.15);

/// A goal that is `x` where it can be.
template <class Goal, class T>
Goal goal_of(T x) {
  Goal goal{};
  if constexpr (requires { goal.q_g; }) goal.q_g = JointPosition<6, T>::constant(x);
  if constexpr (requires { goal.q_d; }) goal.q_d = JointPosition<6, T>::constant(x);
  if constexpr (requires { goal.X_BP.translated(x, x, x); }) goal.X_BP = goal.X_BP.translated(x, x, x);
  if constexpr (requires { goal.velocity; }) goal.velocity = JointVelocity<6, T>::constant(x);
  if constexpr (requires { goal.direction; }) goal.direction = {x, T(0), T(0)}, goal.force = x;
  return goal;
}

template <class T, class L>
void attack(const char* name, const L& law) {
  CAPTURE(std::string(name));
  const Arm arm;
  const Touch<T> untouched{};
  const State<6, T> home = at_home<T>();
  const Known<T> here(arm, home, T(0.002), untouched);
  const auto begun = law.start(here);
  REQUIRE(finite(torque_of(law, begun, here)));
  for (const T size :
       {T(0), std::numeric_limits<T>::denorm_min(), T(1), T(100), T(1e15), std::numeric_limits<T>::max(),
        std::numeric_limits<T>::infinity(), std::numeric_limits<T>::quiet_NaN()})
    for (const T x : {size, -size}) {
      CAPTURE(x);
      auto m = begun;
      if constexpr (requires { typename L::Goal; }) {
        const auto received = follow_or_receive(law, m, here, goal_of<typename L::Goal>(x));
        if (!std::isfinite(x)) CHECK(received.status.has(Reason::goal_refused));
        m = received.memory;
        for (int k = 0; k < 3; ++k) {
          const auto out = evaluate(law, m, here, T(0.002));
          if (std::abs(x) < T(1e16) || !std::isfinite(x)) CHECK(finite(out.torque));
          m = out.memory;
        }
      }
      // A cycle refuses such a state; one that came by nevertheless is forgotten.
      m = begun;
      State<6, T> there = home;
      there.q[3] = x, there.dq[1] = x;
      Touch<T> touched{};
      touched.template set<5>({{x, T(0), T(0)}, {T(0), x, T(0)}});
      const Known<T> away(arm, there, T(0.002), untouched), pushed(arm, home, T(0.002), touched);
      static_cast<void>(settled(law, m, away, T(0.01)));
      static_cast<void>(status_of(law, m));
      if (!std::isfinite(x)) {
        m = evaluate(law, m, away, T(0.002)).memory;
        m = evaluate(law, m, pushed, T(0.002)).memory;
        CHECK(finite(evaluate(law, m, here, T(0.002)).torque));
      } else if (std::abs(x) <= T(100)) {
        CHECK(finite(evaluate(law, m, away, T(0.002)).torque));
        CHECK(finite(evaluate(law, m, pushed, T(0.002)).torque));
      }
    }
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: laws of joints", T, SKINCTL_EXTREME_SCALARS) {
  const SplineJoint<6, T> spline(JointControlSettings<6, T>{});
  attack<T>("SplineJoint: Tracking, JointSpace, SplinePlan", spline);
  attack<T>("ReactiveJoint: ReactivePlan", ReactiveJoint<6, T>(JointControlSettings<6, T>{}));
  attack<T>("JointImpedance: Impedance", JointImpedance<6, T>());
  attack<T>("JointLimitLaw", JointLimitLaw<6, T>());
  attack<T>("FrictionControl",
            FrictionControl<6, T>(JointFriction<6, T>({{}, JointTorque<6, T>::constant(T(2)), {}})));
  attack<T>("VelocityControl", VelocityControl<6, T>());
  attack<T>("SkinJointControl: StatelessLaw", SkinJointControl{});
  const auto sum = T(0.5) * spline + SkinJointControl{} + GravityControl{};
  attack<T>("Fused", sum);
  for (const double wrong : {std::nan(""), HUGE_VAL, -1.0})
    CHECK_THROWS_AS(static_cast<void>(blended(sum, {.contact = {.on = wrong}})), ConfigurationError);
  CHECK_FALSE(describe(sum, {std::nan(""), HUGE_VAL, 1}).view().empty());
}

TEST_CASE("extremes: laws of a tool") {
  const SplineOperational<6, 5> spline(X_LT, OperationalSettings<6>{});
  attack<double>("OnJoints", on_joints<0b111111>(spline));
  attack<double>("SplineOperational: OperationalSpace, PoseTargets", spline);
  attack<double>("ForceControl", ForceControl<6, 5>(X_LT));
  attack<double>("NullSpacePosture", NullSpacePosture<6, 5>(X_LT, at_home<double>().q));
  attack<double>("SkinCartesianControl: touch_on_tool, chosen", SkinCartesianControl<5>(X_LT));
  attack<double>("NullSpace", task_priority<5>(spline, JointImpedance<6>()));
  const Clearance wall{.capsules = {{5, {{0.0, 0.0, 0.03}, {0.0, 0.0, 0.08}, 0.04}},
                                    {LinkCapsule::fixed, {{-1, 0, 0}, {1, 0, 0}, 0.1}}},
                       .pairs = {{0, 1}}};
  const auto limits = limits_of<ur5::Description, double>(15.0);
  for (const double wrong : {std::nan(""), HUGE_VAL, -1.0}) {
    Clearance other = wall;
    other.margin = wrong;
    CHECK(refused([&] { static_cast<void>(part_for(Arm{}, limits, other)); }));  // ClearanceLimits
  }
}
