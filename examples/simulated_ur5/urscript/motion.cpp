// Functions that move the arm or wait.
#include <algorithm>

#include "examples/simulated_ur5/kinematics.hpp"
#include "examples/simulated_ur5/robot_data.hpp"
#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

constexpr Joints default_viscous = {0.9, 0.9, 0.8, 0.9, 0.9, 0.9},
                 default_coulomb = {0.8, 0.8, 0.7, 0.8, 0.8, 0.8};

bool finite(const std::array<double, 6>& v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}
std::optional<std::array<double, 6>> six_finite(const Value& v) {
  const auto six = v.six();
  return six && finite(*six) ? six : std::nullopt;
}
bool motion_numbers(const Call& c, std::size_t from, std::size_t to) {
  for (std::size_t i = from; i < to; ++i)
    if (!std::isfinite(c.number(i, 0))) return false;
  return true;
}

/// Joints that a motion is to reach: joint positions, or those of a pose.
std::optional<Joints> goal(const Call& c, std::string& why) {
  std::optional<Joints> q;
  if (const auto* pose = c[0].as<Pose6>()) {
    if (finite(*pose))
      q = joints_that_reach(pose_of(*pose) * inverse(pose_of(c.robot.state.tcp_offset)),
                            c.robot.arm.target_q());
    if (!q) why = "runtime_error_inverse_kinematics:no_solution:";
  } else {
    q = six_finite(c[0]);
    if (!q) why = "runtime_error_type:joint_positions";
  }
  return q;
}

/// movej(q, a, v, t, r): the arm stops at every point, blends are left out.
Outcome movej(Call& c) {
  enum { begin, slow_down, move };
  if (c.first) c.stage = begin;
  if (c.stage == begin) {
    c.robot.arm.stop(4);
    c.stage = slow_down;
  }
  if (c.stage == slow_down) {
    if (!c.robot.arm.at_rest()) return Outcome::again;
    std::string why;
    const auto q = goal(c, why);
    if (!q) return c.fail(why);
    if (!motion_numbers(c, 1, 4)) return c.fail("runtime_error_type:number");
    c.robot.arm.move(*q, c.number(1, robot_data::default_joint_acceleration),
                     c.number(2, robot_data::default_joint_speed), c.number(3, 0));
    c.stage = move;
    return Outcome::again;
  }
  return c.robot.arm.moving() ? Outcome::again : Outcome::done;
}

/// movel(pose, a, v, t, r): a straight line of the tool's point, by servoj to poses on it.
Outcome movel(Call& c) {
  enum { begin, slow_down, travel, settle };
  auto& r = c.robot;
  if (c.first) {
    c.stage = begin;
    r.arm.stop(4);
  }
  if (c.stage == begin) {
    if (!r.arm.at_rest()) return Outcome::again;
    c.stage = slow_down;
  }
  const Pose tool = pose_of(r.state.tcp_offset);
  if (c.stage == slow_down) {
    if (!motion_numbers(c, 1, 4)) return c.fail("runtime_error_type:number");
    std::string why;
    if (!goal(c, why)) {
      r.protective_stop("movel cannot reach its pose");
      return c.fail(why);
    }
    c.since = r.now;
    r.line.start = r.arm.target_q();
    c.stage = travel;
  }
  std::string why;
  const auto end_q = goal(c, why);
  if (!end_q) return c.fail(why);
  if (c.stage == settle) {
    double left = 0;
    for (std::size_t i = 0; i < joint_count; ++i)
      left = std::max(left, std::abs(r.line.end[i] - r.arm.target_q()[i]));
    if (left > 1e-6) return Outcome::again;
    r.arm.stop(4);
    return Outcome::done;
  }
  const Pose from = forward_kinematics(r.line.start).flange * tool;
  const Pose to = c[0].as<Pose6>() ? pose_of(*c[0].as<Pose6>()) : forward_kinematics(*end_q).flange * tool;
  const Vec3 turn = rotation_vector(to * inverse(from));
  // Metres along the line; a pure turn counts by the equivalent radius.
  const double length = std::max(norm(to.origin - from.origin), robot_data::equivalent_radius * norm(turn));
  const double a = std::clamp(c.number(1, robot_data::default_tool_acceleration), 0.01, 10.0);
  const double wanted =
      c.number(3, 0) > 0 ? 1.5 * length / c.number(3, 0) : c.number(2, robot_data::default_tool_speed);
  const double peak = std::min(std::clamp(wanted, 1e-4, 3.0), std::sqrt(a * length));
  const double ramp = peak / a, total = length > 0 ? length / peak + ramp : 0;
  const double t = std::min(total, seconds(r.now + r.cycle - c.since));
  const double s = t < ramp           ? 0.5 * a * t * t
                   : t > total - ramp ? length - 0.5 * a * (total - t) * (total - t)
                                      : peak * (t - 0.5 * ramp);
  const double share = length > 0 ? s / length : 1;
  Pose at =
      pose_of({0, 0, 0, share * turn.x, share * turn.y, share * turn.z}) * Pose{from.x, from.y, from.z, {}};
  at.origin = from.origin + share * (to.origin - from.origin);
  const auto q = joints_that_reach(at * inverse(tool), r.arm.target_q());
  if (!q) {
    r.protective_stop("movel comes to a pose that cannot be reached");
    return c.fail("runtime_error_inverse_kinematics:no_solution:");
  }
  r.line.end = *q;
  r.arm.servo(*q, 0.03, 2000);
  if (t >= total) c.stage = settle;
  return Outcome::again;
}

/// Motions without a time: their fourth argument is a blend.
template <Outcome (*Move)(Call&)>
Outcome untimed(Call& c) {
  Call shorter{c.name,  c.robot, c.arguments.first(std::min<std::size_t>(3, c.arguments.size())),
               c.first, c.since, c.stage};
  const Outcome outcome = Move(shorter);
  c.error = shorter.error;
  return outcome;
}

Outcome servoj(Call& c) {
  if (!c.first) return c.after(c.number(3, seconds(c.robot.cycle)));
  const auto q = six_finite(c[0]);
  if (!q) return c.fail("runtime_error_type:joint_positions");
  c.robot.arm.servo(*q, c.number(4, 0.1), c.number(5, 300));
  return Outcome::again;
}

/// Without a time it returns when the speed is reached.
Outcome until_speed(Call& c, const Joints& dq, double time) {
  if (time > 0) return c.after(time);
  for (std::size_t i = 0; i < joint_count; ++i)
    if (std::abs(c.robot.arm.target_dq()[i] - dq[i]) > 1e-9) return c.after(10);
  return Outcome::done;
}
Outcome speedj(Call& c) {
  const auto dq = six_finite(c[0]);
  if (!dq) return c.fail("runtime_error_type:joint_speeds");
  if (!c.first) return until_speed(c, *dq, c.number(2, 0));
  c.robot.arm.speed(*dq, c.number(1, 40));
  return Outcome::again;
}
Outcome speedl(Call& c) {
  const auto twist = six_finite(c[0]);
  if (!twist) return c.fail("runtime_error_type:tool_speed");
  const Links links = forward_kinematics(c.robot.arm.target_q());
  const Joints dq = joint_speeds(links, (links.flange * pose_of(c.robot.state.tcp_offset)).origin, *twist);
  if (!c.first && c.after(c.number(2, 0)) == Outcome::done) return Outcome::done;
  c.robot.arm.speed(dq, 40);
  return Outcome::again;
}

Outcome stop(Call& c) {
  if (c.first) c.robot.arm.stop(c.number(0, 4));
  return c.robot.arm.at_rest() ? Outcome::done : Outcome::again;
}

/// direct_torque(torque, friction_comp, viscous_scale, coulomb_scale): one cycle.
Outcome torque(Call& c) {
  if (!c.first) {
    if (c.after(0) == Outcome::again) return Outcome::again;
    return Outcome::done;
  }
  const auto tau = six_finite(c[0]);
  if (!tau) return c.fail("runtime_error_type:joint_torques");
  const bool scales = !c[2].empty() || !c[3].empty();
  if (scales && c.robot.version < friction_scales_since)
    return c.fail("compile_error_arguments:direct_torque:");
  const bool compensated = c[1].empty() || c[1].truth();
  const Joints viscous = compensated ? c[2].six().value_or(default_viscous) : Joints{};
  const Joints coulomb = compensated ? c[3].six().value_or(default_coulomb) : Joints{};
  if (!finite(viscous) || !finite(coulomb)) return c.fail("runtime_error_type:scale");
  c.robot.arm.torque(*tau, viscous, coulomb);
  return Outcome::again;
}

Outcome pause_for(Call& c) {
  return c.first ? Outcome::again : c.after(std::max(0.0, c.number(0, 0)));
}

Outcome protective_stop(Call& c) {
  c.robot.protective_stop("by the program");
  return Outcome::ended;
}

/// Steps since a contact that opposes `direction`: 1 while the tool feels 5 N against it, else 0.
Outcome tool_contact(Call& c) {
  const auto direction = c[0].six();
  double against = 0;
  for (std::size_t i = 0; direction && i < 3; ++i)
    against -= (*direction)[i] * c.robot.state.actual_tcp_force[i];
  return c.give(against > 0 && c.robot.state.tcp_force > 5 ? 1 : 0);
}

constexpr Builtin motion_table[] = {
    {"movej", "q a v t r", movej, true},
    {"optimovej", "q a v r", untimed<movej>, true, false, {5, 21, 0, 0}},
    {"movel", "pose a v t r", movel, true},
    {"optimovel", "pose a v r", untimed<movel>, true, false, {5, 21, 0, 0}},
    {"movep", "pose a v r", untimed<movel>, true},
    {"servoj", "q a v t lookahead_time gain", servoj, true},
    {"speedj", "qd a t", speedj, true},
    {"speedl", "xd a t aRot", speedl, true},
    {"stopj", "a", stop, true},
    {"stopl", "a aRot", stop, true},
    {"direct_torque", "torque friction_comp viscous_scale coulomb_scale", torque, true, false,
     direct_torque_since},
    {"sleep", "t", pause_for, true},
    {"sync", "", pause_for, true},
    {"protective_stop", "", protective_stop},
    {"tool_contact", "direction", tool_contact},
};

}  // namespace

std::span<const Builtin> motion_functions() {
  return motion_table;
}

}  // namespace simulated_ur5::urscript
