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
std::optional<Joints> goal(const Call& c, const Value& to, std::string& why) {
  std::optional<Joints> q;
  if (const auto* pose = to.as<Pose6>()) {
    if (finite(*pose))
      q = joints_that_reach(pose_of(*pose) * inverse(pose_of(c.robot.state.tcp_offset)),
                            c.robot.arm.target_q());
    if (!q) why = "runtime_error_inverse_kinematics:no_solution:";
  } else {
    q = six_finite(to);
    if (!q) why = "runtime_error_type:joint_positions";
  }
  const auto& limits = c.robot.state.limits;
  for (std::size_t i = 0; q && i < joint_count; ++i)
    if ((*q)[i] < limits.lower[i] || (*q)[i] > limits.upper[i]) {
      why = "runtime_error_joint_limit:" + std::to_string(i + 1) + ":";
      return std::nullopt;
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
    const auto q = goal(c, c[0], why);
    if (!q) return c.fail(why);
    if (!motion_numbers(c, 1, 4)) return c.fail("runtime_error_type:number");
    c.robot.line.goal = six_of(forward_kinematics(*q).flange * pose_of(c.robot.state.tcp_offset));
    c.robot.arm.move(*q, c.number(1, robot_data::default_joint_acceleration),
                     c.number(2, robot_data::default_joint_speed), c.number(3, 0));
    c.stage = move;
    return Outcome::again;
  }
  return c.robot.arm.moving() ? Outcome::again : Outcome::done;
}

/// Where the tool's point goes, and how it gets there; the pose between is by value.
struct Way {
  Value to, via{};  ///< `via`: on an arc
  double acceleration, speed, duration;
  bool turns_along = false;  ///< on an arc: the orientation turns with it
};

/// The tool's pose at each share of a way, 0 to 1.
class Track {
 public:
  Track(const Pose& from, const Pose& to) : from_(from), to_(to), turn_(rotation_vector(to * inverse(from))) {
    // Metres along the line; a pure turn counts by the equivalent radius.
    length_ = std::max(norm(to.origin - from.origin), robot_data::equivalent_radius * norm(turn_));
  }
  /// On the circle through three points; false if they lie on a line.
  bool bend(Vec3 via, bool turns_along) {
    const Vec3 a = via - from_.origin, b = to_.origin - from_.origin, n = cross(a, b);
    const double nn = dot(n, n);
    if (!(nn > 1e-12)) return false;
    const Vec3 arm = (1 / (2 * nn)) * (dot(a, a) * cross(b, n) + dot(b, b) * cross(n, a));  // to the centre
    centre_ = from_.origin + arm;
    axis_ = (1 / std::sqrt(nn)) * n;
    const Vec3 u = -arm, v = cross(axis_, u), end = to_.origin - centre_;
    angle_ = std::atan2(dot(end, v), dot(end, u));
    if (angle_ <= 0) angle_ += 2 * pi;
    length_ = std::max(angle_ * norm(arm), robot_data::equivalent_radius * norm(turn_));
    if (turns_along) turn_ = angle_ * axis_;
    return true;
  }
  double length() const { return length_; }
  Pose at(double share) const {
    Pose p = pose_of({0, 0, 0, share * turn_.x, share * turn_.y, share * turn_.z}) *
             Pose{from_.x, from_.y, from_.z, {}};
    p.origin = from_.origin + share * (to_.origin - from_.origin);
    if (angle_ > 0) {
      const Vec3 u = from_.origin - centre_, v = cross(axis_, u);
      p.origin = centre_ + std::cos(share * angle_) * u + std::sin(share * angle_) * v;
    }
    return p;
  }

 private:
  Pose from_, to_;
  Vec3 turn_, centre_{}, axis_{};
  double length_ = 0, angle_ = 0;
};

/// Share of a way of `length` after `t` seconds, and whether that is its end: trapezoidal speed.
double share_of(double length, const Way& way, double t, bool& over) {
  double a = std::clamp(way.acceleration, 0.01, 10.0), speed = way.speed;
  if (way.duration > 0) {  // a third of the time each: up, along, down
    a = std::min(4.5 * length / (way.duration * way.duration),
                 std::max(a, robot_data::default_tool_acceleration));
    speed = 1.5 * length / way.duration;
  }
  const double peak = std::min(std::clamp(speed, 1e-4, 3.0), std::sqrt(a * length));
  const double ramp = a > 0 ? peak / a : 0;
  const double total = length > 0 ? std::max(length / peak + ramp, way.duration) : way.duration;
  over = t >= total;
  if (length <= 0 || over) return 1;
  const double left = total - t, s = t < ramp      ? 0.5 * a * t * t
                                     : left < ramp ? length - 0.5 * a * left * left
                                                   : peak * (t - 0.5 * ramp);
  return std::min(s / length, 1.0);
}

/// The tool's point along a way, by servoj to poses on it. What cannot be reached is a protective stop, in
/// which the program stays.
Outcome travel(Call& c, const Way& way) {
  enum { begin, slow_down, under_way, settle };
  auto& r = c.robot;
  if (c.first) {
    c.stage = begin;
    r.arm.stop(4);
  }
  if (c.stage == begin) {
    if (!r.arm.at_rest()) return Outcome::again;
    c.stage = slow_down;
  }
  const auto unreachable = [&](const char* what) {
    r.protective_stop(std::string(c.name) + what, path_code);
    return Outcome::again;
  };
  const Pose tool = pose_of(r.state.tcp_offset);
  std::string why;
  const auto end_q = goal(c, way.to, why);
  if (!end_q && (!way.to.as<Pose6>() || !finite(*way.to.as<Pose6>()))) return c.fail(why);
  if (!end_q) return unreachable(" cannot reach its pose");
  if (c.stage == slow_down) {
    for (const double x : {way.acceleration, way.speed, way.duration})
      if (!std::isfinite(x)) return c.fail("runtime_error_type:number");
    c.since = r.now;
    r.line.start = r.arm.target_q();
    r.line.goal = six_of(forward_kinematics(*end_q).flange * tool);
    c.stage = under_way;
  }
  if (c.stage == settle) {
    double left = 0;
    for (std::size_t i = 0; i < joint_count; ++i)
      left = std::max(left, std::abs(r.line.end[i] - r.arm.target_q()[i]));
    if (left > 1e-6) return Outcome::again;
    r.arm.stop(4);
    return Outcome::done;
  }
  Track track(forward_kinematics(r.line.start).flange * tool,
              way.to.as<Pose6>() ? pose_of(*way.to.as<Pose6>()) : forward_kinematics(*end_q).flange * tool);
  if (!way.via.empty()) {
    const auto via_q = goal(c, way.via, why);
    if (!via_q && !way.via.as<Pose6>()) return c.fail(why);
    const Vec3 via = way.via.as<Pose6>() ? pose_of(*way.via.as<Pose6>()).origin
                                         : (forward_kinematics(*via_q).flange * tool).origin;
    if (!track.bend(via, way.turns_along)) return unreachable(": its three points lie on a line");
  }
  bool over = false;
  const double share = share_of(track.length(), way, seconds(r.now + r.cycle - c.since), over);
  const auto q = joints_that_reach(track.at(share) * inverse(tool), r.arm.target_q());
  if (!q) return unreachable(" comes to a pose that cannot be reached");
  r.line.end = *q;
  r.arm.servo(*q, 0.03, 2000);
  if (over) c.stage = settle;
  return Outcome::again;
}

/// movel(pose, a, v, t, r)
Outcome movel(Call& c) {
  return travel(c, {.to = c[0],
                    .acceleration = c.number(1, robot_data::default_tool_acceleration),
                    .speed = c.number(2, robot_data::default_tool_speed),
                    .duration = c.number(3, 0)});
}
/// movec(pose_via, pose_to, a, v, r, mode)
Outcome movec(Call& c) {
  return travel(c, {.to = c[1],
                    .via = c[0],
                    .acceleration = c.number(2, robot_data::default_tool_acceleration),
                    .speed = c.number(3, robot_data::default_tool_speed),
                    .duration = 0,
                    .turns_along = c.number(5, 0) == 1});
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

/// servoc(pose, a, v, r): a cycle towards the pose at the tool's speed `v`; blends are left out.
Outcome servoc(Call& c) {
  if (!c.first) return c.after(0);
  const auto* pose = c[0].as<Pose6>();
  if (!pose || !finite(*pose) || !std::isfinite(c.number(2, 0))) return c.fail("runtime_error_type:pose");
  auto& r = c.robot;
  const Pose tool = pose_of(r.state.tcp_offset);
  const Track track(forward_kinematics(r.arm.target_q()).flange * tool, pose_of(*pose));
  const double step = std::clamp(c.number(2, robot_data::default_tool_speed), 1e-4, 3.0) * seconds(r.cycle);
  const auto q = joints_that_reach(
      track.at(track.length() > step ? step / track.length() : 1) * inverse(tool), r.arm.target_q());
  if (!q) {
    r.protective_stop("servoc comes to a pose that cannot be reached", path_code);
  } else {
    r.arm.servo(*q, 0.03, 2000);
  }
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
  c.robot.protective_stop("by the program", by_program_code);
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
    {"movec", "pose_via pose_to a v r mode", movec, true},
    {"servoc", "pose a v r", servoc, true},
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
