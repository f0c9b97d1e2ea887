// Goals that cannot be meant: what comes from outside is refused with a status, in debug and in release
// builds.
//
// Promise: a goal that cannot be meant is refused in debug and in release builds, and the last one stands
// Tried: joints beyond their limits by one unit in the last place, in degrees, no numbers; poses of
// zeros, mirrored, scaled, skew, no numbers; by position, velocity and torque, float and double (by day
// double)

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <limits>
#include <tuple>
#include <type_traits>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

template <class Goal>
using Goals = std::vector<Goal>;

SceneSettings scene_settings(Interface i) {
  SceneSettings s;
  if (i == Interface::torque) s.decay = 0;
  return s;
}

/// All that robots take of a command.
template <class Output>
auto numbers(const Output& out) {
  const auto& c = out.planned;
  return std::make_tuple(c.valid, c.position, c.velocity, c.acceleration, c.torque);
}

/// Sends `good`, then each of `wrong` to a scene whose robot stands: refused, and no command differs from
/// those of a scene that never heard of it.
template <Interface I, class L>
void check_refused(const L& law, const typename L::Goal& good, const Goals<typename L::Goal>& wrong) {
  using T = typename L::scalar;
  const Cycle scene(test_robot<I, T>(scene_settings(I)), law);
  using Scene = std::remove_const_t<decltype(scene)>;
  State<6, T> at{0ns, home_position<T>(), {}};
  const auto started = scene.start(at);
  auto told = started;
  typename Scene::Input input;
  const auto step = [&](typename Scene::Memory& m, int k, const typename L::Goal* goal) {
    input.now = input.measured.time = k * 8ms;
    input.measured.q = at.q;
    input.goal.reset();
    if (goal != nullptr) input.goal = *goal;
    return scene.step(m, input);
  };
  auto idle = started;
  bool moves = false;
  for (int k = 1; k < 12; ++k) {
    const auto out = step(told, k, k == 1 ? &good : nullptr);
    CHECK_FALSE(out.status.has(Reason::goal_refused));
    moves |= numbers(out) != numbers(step(idle, k, nullptr));
  }
  CHECK(moves);
  for (std::size_t n = 0; n < wrong.size(); ++n) {
    CAPTURE(n);
    auto refusing = told, keeps = told;
    for (int k = 12; k < 20; ++k) {
      const auto out = step(refusing, k, k % 4 == 0 ? &wrong[n] : nullptr);
      CHECK(out.status.has(Reason::goal_refused) == (k % 4 == 0));
      CHECK((numbers(out) == numbers(step(keeps, k, nullptr))));
    }
  }
}

template <Interface I, class T>
auto gains() {
  return tracking_settings(test_robot<I, T>(scene_settings(I)));
}
template <Interface I, class T>
OperationalSettings<6, T> tool_gains() {
  return {.tracking = gains<I, T>()};
}

/// Beyond the limits of a joint by the smallest number, in degrees, and no numbers.
template <class T>
Goals<JointPosition<6, T>> wrong_positions() {
  const auto limits = ur5_test_limits<T>();
  const T infinity = std::numeric_limits<T>::infinity();
  Goals<JointPosition<6, T>> all;
  for (const std::size_t i : {std::size_t(0), std::size_t(2), std::size_t(5)})
    for (const T& q :
         {std::nextafter(limits.upper()[i], infinity), std::nextafter(limits.lower()[i], -infinity), T(-90),
          infinity, std::numeric_limits<T>::quiet_NaN()}) {
      all.push_back(home_position<T>());
      all.back()[i] = q;
    }
  all.emplace_back(Eigen::Matrix<T, -1, 1>::Zero(5).eval());
  return all;
}
template <class T>
JointPosition<6, T> near_home() {
  auto q = home_position<T>();
  q[1] += T(0.05);
  return q;
}

/// Poses as a user makes them from numbers: zeros, a mirror image, axes that are not square, no numbers.
template <class T>
Goals<Transform<Base, Tool, T>> wrong_poses(const Transform<Base, Tool, T>& good) {
  const T nan = std::numeric_limits<T>::quiet_NaN(), o(0), l(1);
  const auto& p = good.origin();
  Goals<Transform<Base, Tool, T>> all;
  for (const Rotation<T>& R :
       {Rotation<T>{{o, o, o}, {o, o, o}, {o, o, o}}, Rotation<T>{{l, o, o}, {o, l, o}, {o, o, -l}},
        Rotation<T>{{l, o, o}, {l, o, o}, {o, o, l}}, Rotation<T>{{T(2), o, o}, {o, T(2), o}, {o, o, T(2)}},
        Rotation<T>{{nan, o, o}, {o, l, o}, {o, o, l}}}) {
    all.emplace_back(R, p);
    all.emplace_back(Mat3<T>(as_eigen(R)), Vec3<T>(as_eigen(p)));
  }
  all.emplace_back(good.axes(), Xyz<T>{nan, o, o});
  all.emplace_back(Eigen::Matrix<T, -1, -1>::Identity(2, 2).eval(), Eigen::Matrix<T, -1, 1>::Zero(3).eval());
  all.emplace_back(Eigen::Matrix<T, -1, -1>::Identity(3, 3).eval(), Eigen::Matrix<T, -1, 1>::Zero(2).eval());
  return all;
}
template <class T>
Transform<Base, Tool, T> tool_at(const JointPosition<6, T>& q) {
  const Poses<ur5::Model, link_bit<5>, T> poses(ur5::Model{},
                                                JointAngles<ur5::Model, T, all_links(6)>(ur5::Model{}, q));
  return poses.template get<5>() * Transform<Link<5>, Tool, T>();
}

template <Interface I, class T>
void joint_goals() {
  Goals<JointGoal<6, T>> wrong;
  for (const auto& q : wrong_positions<T>()) wrong.push_back({q, 1s});
  wrong.push_back({home_position<T>(), -1ns});
  check_refused<I>(SplineJoint<6, T>(gains<I, T>()), {near_home<T>(), 1s}, wrong);
}
template <Interface I, class L, class T = typename L::scalar>
void joint_targets(const L& law) {
  Goals<JointReference<6, T>> wrong;
  for (const auto& q : wrong_positions<T>()) wrong.push_back({q, {}, {}});
  check_refused<I>(law, {near_home<T>(), {}, {}}, wrong);
}
template <Interface I, class T>
void pose_goals() {
  Goals<PoseGoal<Tool, T>> wrong;
  const auto good = tool_at<T>(near_home<T>());
  for (const auto& X : wrong_poses<T>(good)) wrong.push_back({X, 1s});
  check_refused<I>(SplineOperational<6, 5, Tool, T>(Transform<Link<5>, Tool, T>(), tool_gains<I, T>()),
                   {good, 1s}, wrong);
}
template <Interface I, class L, class T = typename L::scalar>
void pose_targets(const L& law) {
  Goals<PoseReference<Tool, T>> wrong;
  const auto good = tool_at<T>(near_home<T>());
  for (const auto& X : wrong_poses<T>(good)) wrong.push_back({X, {}, {}});
  check_refused<I>(law, {good, {}, {}}, wrong);
}

}  // namespace

TEST_CASE_TEMPLATE("wrong goals: joints beyond their limits, in degrees, or no numbers are refused", T,
                   SKINCTL_SCALARS) {
  joint_goals<Interface::position, T>();
  if constexpr (!by_day) joint_goals<Interface::velocity, T>();
  joint_goals<Interface::torque, T>();
}

TEST_CASE("wrong goals: the same for targets, reactive targets and impedances") {
  using T = std::conditional_t<by_day, double, float>;
  joint_targets<Interface::position>(JointControl<6, T>(gains<Interface::position, T>()));
  joint_targets<Interface::torque>(ReactiveJoint<6>(gains<Interface::torque, double>()));
  Goals<JointGoal<6>> wrong;
  for (const auto& q : wrong_positions<double>()) wrong.push_back({q, 1s});
  JointImpedance<6>::Settings soft;
  soft.space = gains<Interface::torque, double>();
  for (auto& k : soft.stiffness) k = 100;
  for (auto& d : soft.damping) d = 10;
  check_refused<Interface::torque>(JointImpedance<6>(soft), {near_home<double>(), 1s}, wrong);
}

TEST_CASE_TEMPLATE("wrong goals: a pose whose axes are no rotation is refused", T, SKINCTL_SCALARS) {
  pose_goals<Interface::position, T>();
  pose_goals<Interface::torque, T>();
}

TEST_CASE("wrong goals: the same for targets of a tool, by velocity") {
  const Transform<Link<5>, Tool> X_LP;
  pose_targets<Interface::velocity>(
      OperationalControl<6, 5>(X_LP, tool_gains<Interface::velocity, double>()));
}

TEST_CASE("wrong goals: axes with six digits, as files have them, are a rotation") {
  const auto good = tool_at(near_home<double>());
  const auto digits = [](const Xyz<double>& v) {
    return Xyz<double>{1e-6 * std::round(1e6 * v.x), 1e-6 * std::round(1e6 * v.y),
                       1e-6 * std::round(1e6 * v.z)};
  };
  const Transform<Base, Tool> read({digits(good.axis_x()), digits(good.axis_y()), digits(good.axis_z())},
                                   good.origin());
  CHECK_FALSE(read == good);
  check_refused<Interface::position>(
      SplineOperational<6, 5>(Transform<Link<5>, Tool>(), tool_gains<Interface::position, double>()),
      {read, 1s}, {});
}
