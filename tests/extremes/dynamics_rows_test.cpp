// Kinematics and dynamics of an arm at the ends of what a number holds: a row each, see rows.hpp.
#include <doctest/doctest.h>

#include "skinctl/skinctl.hpp"
#include "tests/extremes/rows.hpp"

using namespace skinctl;
using namespace skinctl::extremes;

namespace {

using Arm = ur5::Model;
template <class T>
using Position = JointPosition<6, T>;
template <class T>
using Velocity = JointVelocity<6, T>;
template <class T>
using Acceleration6 = JointAcceleration<6, T>;
template <class T>
using Torque = JointTorque<6, T>;

template <class T>
Position<T> home() {
  return {T(0.3), T(-1.2), T(1.4), T(0.2), T(-0.7), T(0.1)};
}
template <class T>
const auto& jacobian_at_home() {
  static const auto J = jacobian<5>(link_poses(Arm{}, home<T>()));
  return J;
}
template <class T>
const auto& mobility_at_home() {
  static const auto A =
      operational_mobility(jacobian_at_home<T>(), MassFactors<Arm, T>(mass_matrix(Arm{}, home<T>())));
  return A;
}

}  // namespace

TEST_CASE_TEMPLATE("extremes: an arm's kinematics", T, SKINCTL_EXTREME_SCALARS) {
  using enum Wrong;
  static const Row<T> rows[] = {
      {"Poses of an angle", 0, shows, shows,
       [](T x) {
         return Results<T>(Poses<Arm, 0b1, T>(Arm{}, Position<T>::constant(x)).template get<0>().axes());
       }},
      {"joint_frame, JointFrame", 0, shows, shows,
       [](T x) {
         const JointAngles<Arm, T> angles(Arm{}, Position<T>::constant(x));
         return Results<T>(dense<T>(joint_frame<1>(Arm{}, angles).to_parent(Xyz<T>{T(1), T(0), T(0)})));
       }},
      {"CentreOfMass::velocity", 1, shows, shows,
       [](T x) {
         return Results<T>(
             centre_of_mass(Arm{}, link_poses(Arm{}, home<T>())).velocity(Velocity<T>::constant(x)));
       }},
      {"jacobian_rate, JacobianRate", 1, shows, shows,
       [](T x) {
         return Results<T>(jacobian_rate(jacobian_at_home<T>(), Velocity<T>::constant(x)) *
                           Velocity<T>::constant(T(1)));
       }},
      {"jacobian_rate_times", 2, shows, shows,
       [](T x) {
         const auto dq = Velocity<T>::constant(x);
         return Results<T>(jacobian_rate_times(jacobian_at_home<T>(), dq, dq, jacobian_at_home<T>() * dq));
       }},
      {"transpose, Transposed", 1, shows, shows,
       [](T x) {
         Wrench<Link<5>, Link<5>, Base, T> F;
         F.force = {x, x, T(0)}, F.moment = {T(0), x, T(0)};
         return Results<T>(transpose(jacobian_at_home<T>()) * F);
       }},
      {"damped_inverse, DampedInverse", 1, shows, shows,
       [](T x) {
         const auto inverse = damped_inverse(jacobian_at_home<T>(), SingularityDamping<T>());
         auto V = jacobian_at_home<T>() * Velocity<T>::constant(T(0));
         V.linear = {x, T(0), x};
         return Results<T>(inverse.solve(V));
       }},
      {"SingularityDamping::scaled", 2, shows, shows,
       [](T x) {
         return Results<T>(SingularityDamping<T>().scaled(T(0.01), T(x * x), T(0), T(1)).squared(T(0)));
       }},
      {"SingularityDamping::nearness", 0, shows, shows,
       [](T x) {
         return Results<T>(std::isinf(x) ? x : SingularityDamping<T>().nearness(x < 0 ? T(0) : x));
       }},
      {"ZyzMap", 0, shows, shows,
       [](T x) { return Results<T>(ZyzMap<T>(Zyz<T>{x, x, x}).solve(Xyz<T>{T(1), T(1), T(1)})); }},
      {"AnalyticJacobian", 1, shows, shows,
       [](T x) {
         const auto V =
             AnalyticJacobian(jacobian_at_home<T>(), Zyz<T>{T(1), T(1), T(1)}) * Velocity<T>::constant(x);
         return Results<T>(V.linear, V.angles);
       }},
  };
  check_rows(rows);
}

TEST_CASE_TEMPLATE("extremes: an arm's dynamics", T, SKINCTL_EXTREME_SCALARS) {
  using enum Wrong;
  static const Row<T> rows[] = {
      {"regressor, Regressor", 2, shows, shows,
       [](T x) {
         const auto dq = Velocity<T>::constant(x);
         return Results<T>(regressor(Arm{}, home<T>(), dq, dq, Acceleration6<T>()) *
                           inertial_parameters<T>(Arm{}));
       }},
      {"regressor_product", 1, shows, shows,
       [](T x) {
         auto theta = inertial_parameters<T>(Arm{});
         for (T& p : theta.data) p = x;
         return Results<T>(
             regressor_product(Arm{}, home<T>(), Velocity<T>(), Velocity<T>(), Acceleration6<T>(), theta));
       }},
      {"regressor_transposed_product", 1, shows, shows,
       [](T x) {
         const auto g = regressor_transposed_product(Arm{}, home<T>(), Velocity<T>(), Velocity<T>(),
                                                     Acceleration6<T>(), Velocity<T>::constant(x));
         return Results<T>(g.data);
       }},
      {"LinkMobility of a link far away", 0, safe, safe,
       [](T x) {
         return Results<T>(LinkMobility<T>(mobility_at_home<T>(),
                                           Transform<Base, Link<5>, T>::translation_xyz(x, x, x))(2, 2));
       }},
      {"to_lanes, from_lanes", 0, shows, shows,
       [](T x) {
         auto v = JointVelocity<16, T>::constant(x);
         allegro::from_lanes(allegro::to_lanes<2>(v), v);
         return Results<T>(v);
       }},
      {"operational_mobility, OperationalMobility", 2, shows, shows,
       [](T x) {
         return Results<T>(mobility_at_home<T>().along({x, T(0), T(0)}) /
                           (std::abs(x) > T(1) ? std::abs(x) : T(1)));
       }},
      {"Quantities of a speed", 2, shows, shows,
       [](T x) {
         State<6, T> s;
         s.q = home<T>(), s.dq = Velocity<T>::constant(x);
         const NoTouch none;
         return Results<T>(Quantities<Arm, Needs{.coriolis = true}, T>(Arm{}, s, T(0.008), none).coriolis());
       }},
      {"JointFriction::torque", 1, shows, shows,
       [](T x) {
         typename JointFriction<6, T>::Settings s;
         s.coulomb = Torque<T>::constant(T(2)), s.stiction = Torque<T>::constant(T(1));
         return Results<T>(JointFriction<6, T>(s).torque(Velocity<T>::constant(x)));
       }},
      {"JointFriction::slope", 1, shows, shows,
       [](T x) {
         typename JointFriction<6, T>::Settings s;
         s.coulomb = Torque<T>::constant(T(2)), s.stiction = Torque<T>::constant(T(1));
         return Results<T>(JointFriction<6, T>(s).slope(Velocity<T>::constant(x)));
       }},
      {"RotorInertia", 1, shows, shows,
       [](T x) {
         const RotorInertia<2, T> rotor({T(1e-5), T(1e-5)}, {T(100), T(-100)});
         return Results<T>(rotor * JointAcceleration<2, T>{x, x});
       }},
      {"momentum_of", 1, shows, shows,
       [](T x) {
         return Results<T>(
             momentum_of<AllJoints<6>>(mass_matrix(Arm{}, home<T>()), Velocity<T>::constant(x)));
       }},
      {"block_of, VirtualMass::add_to", 1, shows, shows,
       [](T x) {
         auto m = mass_matrix(Arm{}, home<T>());
         const auto limits = limits_of<ur5::Description, T>();
         const Torque<T> inertia = Torque<T>::constant(x);
         const NoToolShape none;
         VirtualMass<6, T>(limits, inertia, none).add_to(m, Arm{}, JointAngles<Arm, T>(Arm{}, home<T>()));
         return Results<T>(block_of<AllJoints<6>>(m)(0, 0));
       }},
      {"RealMass::add_to", 0, shows, shows,
       [](T x) {
         auto m = mass_matrix(Arm{}, home<T>());
         const auto limits = limits_of<ur5::Description, T>();
         const Torque<T> motors = Torque<T>::constant(x);
         RealMass<6, T>(limits, motors).add_to(m, Arm{}, 0);
         return Results<T>(m(0, 0));
       }},
  };
  check_rows(rows);
  for (const double wrong : {std::nan(""), HUGE_VAL, -1.0}) {
    Loaded<Arm, 5, T> loaded{Arm{}};
    const auto before = gravity_torque(loaded, home<T>());
    CHECK(refused([&] { loaded.carry({wrong, {0, 0, 0.1}, 0, 0, 0}); }));
    CHECK(refused([&] { loaded.carry({1, {0, 0, wrong}, wrong, 0, 0}); }));
    CHECK(gravity_torque(loaded, home<T>()) == before);
    typename JointFriction<6, T>::Settings s;
    s.stribeck_velocity = static_cast<T>(wrong);
    CHECK(refused([&] { static_cast<void>(JointFriction<6, T>(s)); }));
    s.stribeck_velocity = T(0.1),
    s.sign_velocity = std::numeric_limits<T>::denorm_min();  // at rest 0 times infinity
    CHECK(refused([&] { static_cast<void>(JointFriction<6, T>(s)); }));
    CHECK(refused([&] { static_cast<void>(RotorInertia<1, T>({static_cast<T>(wrong)}, {T(1)})); }));
    CHECK(refused([&] { static_cast<void>(SingularityDamping<T>(static_cast<T>(wrong))); }));
  }
}
