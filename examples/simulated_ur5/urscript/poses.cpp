// Functions of poses and of the arm's kinematics.
#include "examples/simulated_ur5/kinematics.hpp"
#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

template <class F>
Outcome of_poses(Call& c, F&& f) {
  const auto a = c[0].six(), b = c[1].six();
  return a && b ? c.give(f(*a, *b)) : c.fail("runtime_error_type:pose");
}

Outcome translate(Call& c) {
  return of_poses(c, [](const Pose6& a, const Pose6& b) { return Value(six_of(pose_of(a) * pose_of(b))); });
}
/// Positions add, orientations follow one another.
Outcome add(Call& c) {
  return of_poses(c, [](const Pose6& a, const Pose6& b) {
    Pose6 turned = six_of(pose_of({0, 0, 0, a[3], a[4], a[5]}) * pose_of({0, 0, 0, b[3], b[4], b[5]}));
    for (std::size_t i = 0; i < 3; ++i) turned[i] = a[i] + b[i];
    return Value(turned);
  });
}
Outcome distance(Call& c) {
  return of_poses(c, [](const Pose6& a, const Pose6& b) {
    return Value(norm(Vec3{a[0] - b[0], a[1] - b[1], a[2] - b[2]}));
  });
}
Outcome inverted(Call& c) {
  const auto a = c[0].six();
  return a ? c.give(Value(six_of(inverse(pose_of(*a))))) : c.fail("runtime_error_type:pose");
}
Outcome from_numbers(Call& c) {
  const auto a = c[0].six();
  return a ? c.give(Value(*a)) : c.fail("runtime_error_type:pose");
}

std::optional<Joints> reached(Call& c) {
  const auto pose = c[0].six();
  if (!pose) return std::nullopt;
  const Joints near = c[1].six().value_or(c.robot.arm.target_q());
  const Pose tool = pose_of(c[4].six().value_or(c.robot.state.tcp_offset));
  return joints_that_reach(pose_of(*pose) * inverse(tool), near);
}
Outcome inverse_kinematics(Call& c) {
  const auto q = reached(c);
  return q ? c.give(list_of(*q)) : c.fail("runtime_error_inverse_kinematics:no_solution:");
}
Outcome forward(Call& c) {
  const Joints q = c[0].six().value_or(c.robot.arm.measured_q());
  const Pose tool = pose_of(c[1].six().value_or(c.robot.state.tcp_offset));
  return c.give(Value(six_of(forward_kinematics(q).flange * tool)));
}

constexpr Builtin pose_table[] = {
    {"pose_trans", "p_from p_from_to", translate},
    {"pose_add", "p_1 p_2", add},
    {"pose_inv", "p_from", inverted},
    {"pose_dist", "p_from p_to", distance},
    {"point_dist", "p_from p_to", distance},
    {"to_pose", "list", from_numbers},
    {"get_inverse_kin", "x qnear maxPositionError maxOrientationError tcp", inverse_kinematics},
    {"get_inverse_kin_has_solution", "pose qnear maxPositionError maxOrientationError tcp",
     [](Call& c) { return c.give(reached(c).has_value()); }},
    {"get_forward_kin", "q tcp", forward},
};

}  // namespace

std::span<const Builtin> pose_functions() {
  return pose_table;
}

}  // namespace simulated_ur5::urscript
