// Every number of a robot's description, of its limits and of what it feels: refused where it is no number,
// see rows.hpp.
#include <doctest/doctest.h>

#include "skinctl/clearance/sightings.hpp"
#include "skinctl/control/grasp_control.hpp"
#include "skinctl/control/impedance.hpp"
#include "skinctl/control/joint_limits.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/limits/felt_places.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/skin_watch.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/model/attached.hpp"
#include "skinctl/passivity/contact_stability.hpp"
#include "skinctl/resolver/following_monitor.hpp"
#include "skinctl/robot/joint_groups.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/robot/velocity_and_torque.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_allegro.hpp"
#include "skinctl/tactile/motor_touch.hpp"
#include "skinctl/tactile/weighted_skin.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"
#include "skinctl/tracking/adaptation.hpp"
#include "skinctl/tracking/friction_learning.hpp"
#include "tests/extremes/rows.hpp"

using namespace skinctl;
using namespace skinctl::extremes;

namespace {

using Arm = ur5::Model;
template <class T>
JointLimits<6, T> limits() {
  return limits_of<ur5::Description, T>(T(15));
}
template <class T>
constexpr T not_numbers[] = {std::numeric_limits<T>::quiet_NaN(), std::numeric_limits<T>::infinity(),
                             -std::numeric_limits<T>::infinity(), std::numeric_limits<T>::max()};
/// Refusals of one joint's number in each of some vectors.
template <class Settings, class Make, class... Member>
void check_joints(const char* name, const Settings& defaults, Make&& make, Member... member) {
  CAPTURE(std::string(name));
  CHECK_NOTHROW(make(defaults));
  int at = 0;
  const auto one = [&](auto m) {
    CAPTURE(at);
    ++at;
    using T = std::remove_cvref_t<decltype((defaults.*m)[0])>;
    for (const T x : not_numbers<T>) {
      CAPTURE(x);
      Settings s = defaults;
      (s.*m)[2] = x;
      CHECK(refused([&] { make(s); }));
    }
  };
  (one(member), ...);
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: descriptions of robots and their limits", T, SKINCTL_EXTREME_SCALARS) {
  using C = RobotConfiguration<6, T>;
  const C c{.limits = limits<T>(), .period = 8ms, .delay = 8ms, .virtual_damping = T(4)};
  const auto by = [](const C& x) { static_cast<void>(by_position(Arm{}, x)); };
  check_refusals("RobotDescription, by_position", c, by, &C::period, &C::delay, &C::lag, &C::virtual_damping,
                 &C::force_lead, &C::undeclared_lag, &C::substep, &C::torque_rate, &C::largest_gap);
  check_joints("RobotDescription: joints", c, by, &C::viscous_friction, &C::coulomb_friction,
               &C::virtual_inertia);
  check_refusals(
      "by_velocity", c, [](const C& x) { static_cast<void>(by_velocity(Arm{}, x)); }, &C::period,
      &C::undeclared_lag);
  check_refusals(
      "by_torque", c, [](const C& x) { static_cast<void>(by_torque(Arm{}, x, FrictionUncompensated{})); },
      &C::period, &C::delay);
  check_refusals(
      "robot_by", c, [](const C& x) { static_cast<void>(robot_by<Interface::position, T>(Arm{}, x)); },
      &C::period);
  for (const Nanoseconds wrong : {Nanoseconds::min(), Nanoseconds(0), Nanoseconds::max()})
    CHECK(refused([&] { static_cast<void>(FollowingMonitor<6, T>(c, wrong)); }));
  for (const T wrong : not_numbers<T>) {
    C other = c;
    other.drift = wrong;
    CHECK(refused([&] { by(other); }));
    other = c, other.dead_band = JointPosition<6, T>::constant(wrong);
    CHECK(refused([&] { by(other); }));
  }
  using Values = typename JointLimits<6, T>::Values;
  check_joints(
      "JointLimits", limits<T>().values(), [](const Values& v) { static_cast<void>(JointLimits<6, T>(v)); },
      &Values::velocity, &Values::acceleration);
  struct Jerk {
    JointJerk<6, T> jerk = JointJerk<6, T>::constant(T(400));
  };
  check_joints(
      "JerkLimits", Jerk{}, [](const Jerk& j) { static_cast<void>(JerkLimits<6, T>(limits<T>(), j.jerk)); },
      &Jerk::jerk);
  using Fast = typename ToolSpeed<Arm, 5, T>::Values;
  check_refusals(
      "ToolSpeed", Fast{.speed = T(0.5), .reach = T(1.3)},
      [](const Fast& v) { static_cast<void>(ToolSpeed<Arm, 5, T>(Arm{}, limits<T>(), v)); }, &Fast::speed,
      &Fast::reach);
  check_refusals(
      "CoverageLimits", SkinWatch{}, [](const SkinWatch& w) { static_cast<void>(CoverageLimits<T>(w)); },
      &SkinWatch::settle);
  using Felt = FeltPlaces<2>;
  check_refusals(
      "FeltPlaces", Felt{.places = {CellPlace{}}, .stiffness = 3e3, .newtons = 20},
      [](const Felt& f) { static_cast<void>(PlaceSpeed<Arm, 2, T>(Arm{}, f)); }, &Felt::force,
      &Felt::stiffness, &Felt::speed, &Felt::deceleration, &Felt::newtons, &Felt::reaction_time,
      &Felt::wrist_force);
  using Shape = ToolShape<5, 3, T>;
  typename Shape::Settings shape;
  shape.mass = Shape::diagonal({T(3), T(3), T(3)}), shape.damping = Shape::diagonal({T(30), T(30), T(30)});
  check_refusals(
      "ToolShape", shape, [](const typename Shape::Settings& s) { static_cast<void>(Shape(s)); },
      &Shape::Settings::rest_decay, &Shape::Settings::min_mass_ratio);
  for (const T wrong : not_numbers<T>) {
    auto other = shape;
    other.mass[1][1] = wrong;
    CHECK(refused([&] { static_cast<void>(Shape(other)); }));
  }
  using Environment = ContactEnvironment<T>;
  check_refusals(
      "ContactStability", Environment{.stiffness = T(3e4)},
      [&](const Environment& e) { static_cast<void>(ContactStability<Arm, T>(Arm{}, c, e)); },
      &Environment::stiffness, &Environment::cover, &Environment::body, &Environment::force_gain,
      &Environment::skin_delay);

  // What differs between a law and its robot is refused, as is what is no number there.
  JointControlSettings<6, T> law;
  const auto law_of = [](const JointControlSettings<6, T>& s) { static_cast<void>(SplineJoint<6, T>(s)); };
  using S = JointControlSettings<6, T>;
  check_refusals("JointControlSettings", law, law_of, &S::dt, &S::loop_delay, &S::mass_ratio, &S::lambda,
                 &S::kappa, &S::K_i1, &S::K_i2, &S::mu, &S::integral_speed, &S::gravity_rate, &S::tb, &S::K_c,
                 &S::settle, &S::bumpless_transfer, &S::target_age, &S::max_acceleration, &S::max_jerk);
  check_joints("max_velocity", law, law_of, &S::max_velocity, &S::integral_limit);
  const auto by_torque_arm = by_torque(Arm{}, c, FrictionUncompensated{});
  for (const T x : not_numbers<T>) {
    CAPTURE(x);
    CHECK(refused([&] { static_cast<void>(tracking_settings(by_torque_arm, x)); }));
    CHECK(refused([&] { static_cast<void>(operational_settings(by_torque_arm, x)); }));
  }
  const LawTerms<6, T> terms{.dt = law.dt, .virtual_dynamics = {}};
  CHECK_NOTHROW(check_for(law, terms));
  law.virtual_dynamics.damping = std::numeric_limits<T>::quiet_NaN();
  CHECK_THROWS_AS(check_for(law, terms), ConfigurationError);
}

TEST_CASE("extremes: settings of what feels, learns and grasps") {
  for (const double wrong : not_numbers<double>) {
    CAPTURE(wrong);
    WristSensorSettings<5> wrist;
    CHECK_NOTHROW(WristSensor<5, Arm>(Arm{}, wrist));
    for (double WristSensorSettings<5>::* member :
         {&WristSensorSettings<5>::mass, &WristSensorSettings<5>::reach, &WristSensorSettings<5>::gain,
          &WristSensorSettings<5>::max_force, &WristSensorSettings<5>::max_moment}) {
      auto other = wrist;
      other.*member = wrong;
      CHECK(refused([&] { WristSensor<5, Arm>(Arm{}, other); }));
    }
    MotorTouchSettings<Arm> motors{.gates = same_gate(Arm{}, EventGate<>(1, 1, 1))};
    CHECK_NOTHROW(MotorTouch<Arm>(Arm{}, motors));
    motors.gain = wrong;
    CHECK(refused([&] { MotorTouch<Arm>(Arm{}, motors); }));
    MomentumObserver<Arm>::Settings observer;
    observer.rate = wrong;
    CHECK(refused([&] { MomentumObserver<Arm>(Arm{}, observer); }));
    SightSettings sight;
    const CellPlace cell{.link = 5, .normal = {0, 0, 1}};
    for (double SightSettings::* member :
         {&SightSettings::range, &SightSettings::half_angle, &SightSettings::error, &SightSettings::radius,
          &SightSettings::approach, &SightSettings::min_reading}) {
      auto other = sight;
      other.*member = wrong;
      CHECK(refused([&] { (Sightings<Arm>(Arm{}, std::span(&cell, 1), other)); }));
    }
    CHECK(refused([&] {
      ImpedanceSettings<JointSpace<6>> s;
      s.stiffness[2] = wrong;
      JointImpedance<6>{s};
    }));
    JointLimitSettings<6> margin;
    margin.margin = wrong;
    CHECK(refused([&] { JointLimitLaw<6>{margin}; }));
    const SplineJoint<6> law(JointControlSettings<6>{});
    AdaptationSettings<6> learning{.bound = deviations(Arm{}, 0.5)};
    CHECK_NOTHROW(Adaptive<SplineJoint<6>>(law, learning));
    learning.gamma = wrong;
    CHECK(refused([&] { Adaptive<SplineJoint<6>>(law, learning); }));
    JointControlSettings<6> alone;
    alone.K_i1 = alone.K_i2 = 0;
    FrictionLearningSettings<6> friction{.rate = wrong, .bound = JointTorque<6>::constant(1)};
    CHECK(refused([&] { FrictionLearning<SplineJoint<6>>(SplineJoint<6>(alone), alone, friction); }));
    GraspSettings<double> grasp;
    grasp.max_force = wrong;
    CHECK(refused([&] { GraspControl<6, double, 1, 2>({}, grasp); }));
    grasp = {.lowering = wrong};
    CHECK(refused([&] { GraspControl<6, double, 1, 2>({}, grasp); }));
  }
}

TEST_CASE(
    "extremes: GroupsDescription: groups of joints hold any bits, and refuse numbers as the whole robot "
    "does") {
  using Half = RobotConfiguration<3>;
  const JointLimits<3> some({JointPosition<3>::constant(-3), JointPosition<3>::constant(3),
                             JointVelocity<3>::constant(3), JointAcceleration<3>::constant(15),
                             JointTorque<3>::constant(100)});
  const Half c{.limits = some, .period = 8ms, .virtual_damping = 4};
  for (const double wrong : not_numbers<double>) {
    Half other = c;
    other.torque_rate = wrong;
    CHECK(refused([&] {
      static_cast<void>(by_groups(Arm{}, position_joints<0b000111>(other), velocity_joints<0b111000>(c)));
    }));
    other = c, other.torque_rate = wrong;
    CHECK(refused([&] {
      static_cast<void>(by_groups(Arm{}, position_joints<0b000111>(c), torque_joints<0b111000>(other)));
    }));
    HybridConfiguration<3, 3> both{.stiff = c, .limits = some};
    CHECK_NOTHROW(static_cast<void>(by_velocity_and_torque<0b111000>(Arm{}, both)));
    both.stiff.torque_rate = wrong;
    CHECK(refused([&] { static_cast<void>(by_velocity_and_torque<0b111000>(Arm{}, both)); }));
    const Stand away{{}, {0, wrong, 0}};
    CHECK(refused([&] { static_cast<void>(ur5_allegro::arm_with_hand(allegro::Side::right, away)); }));
    CHECK(refused([&] { static_cast<void>(ur5_allegro::two_arms_with_hands(away, {})); }));
    State<6> state{0ns, JointPosition<6>::constant(wrong), JointVelocity<6>::constant(wrong)};
    JointCommand<6> whole{};
    whole.position = state.q;
    const auto part = part_of<JointSubset<6, 0b101>>(whole);
    put_part<JointSubset<6, 0b101>>(part, whole);
    const auto same = [&](double x) { return x == wrong || (std::isnan(x) && std::isnan(wrong)); };
    CHECK((same(whole.position[0]) && same(part_of<JointSubset<6, 0b101>>(state).dq[1]) &&
           whole.velocity[1] == 0));
  }
}
