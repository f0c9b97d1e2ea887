#include "examples/adapters/franka/messages.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace adapters::franka {
namespace {

using Bytes = std::span<const std::uint8_t>;
static_assert(sizeof(double) == 8);

constexpr std::size_t header_size = 12;

/// Reads fields one behind the other; `fine` falls for good when they end too early or are no numbers.
struct Reader {
  Bytes left;
  bool fine = true;

  std::uint64_t integer(std::size_t size) noexcept {
    std::uint64_t x = 0;
    if (left.size() < size) return fine = false, 0;
    for (std::size_t k = 0; k < size; ++k) x |= std::uint64_t{left[k]} << (8 * k);
    left = left.subspan(size);
    return x;
  }
  void number(std::uint64_t& x) noexcept { x = integer(8); }
  void real(double& x) noexcept {
    x = std::bit_cast<double>(integer(8));
    fine = fine && std::isfinite(x);
  }
  void reals(std::span<double> x) noexcept {
    for (double& r : x) real(r);
  }
  void aside(std::span<const double> x) noexcept { skip(x.size()); }
  void skip(std::size_t count) noexcept {
    if (left.size() < 8 * count)
      fine = false;
    else
      left = left.subspan(8 * count);
  }
  void flag(bool& x) noexcept { x = integer(1) != 0; }
  void flags(Errors& x) noexcept {
    for (std::size_t k = 0; k < error_count; ++k) x[k] = integer(1) != 0;
  }
  template <class E>
  void choice(E& x, E last) noexcept {
    const auto value = integer(1);
    fine = fine && value <= static_cast<std::uint64_t>(last);
    x = fine ? static_cast<E>(value) : last;
  }
};

/// Writes them; what others may read and is of no interest here goes `aside`, or is left zero.
struct Writer {
  std::span<std::uint8_t> left;
  std::size_t size = 0;
  bool fine = true;

  void integer(std::uint64_t x, std::size_t bytes) noexcept {
    if (left.size() < bytes) {
      fine = false;
      return;
    }
    for (std::size_t k = 0; k < bytes; ++k) left[k] = static_cast<std::uint8_t>(x >> (8 * k));
    left = left.subspan(bytes);
    size += bytes;
  }
  void number(std::uint64_t x) noexcept { integer(x, 8); }
  void real(double x) noexcept { integer(std::bit_cast<std::uint64_t>(x), 8); }
  void reals(std::span<const double> x) noexcept {
    for (const double r : x) real(r);
  }
  void aside(std::span<const double> x) noexcept { reals(x); }
  void skip(std::size_t count) noexcept {
    for (std::size_t k = 0; k < count; ++k) real(0);
  }
  void flag(bool x) noexcept { integer(x ? 1 : 0, 1); }
  void flags(const Errors& x) noexcept {
    for (std::size_t k = 0; k < error_count; ++k) flag(x[k]);
  }
  template <class E>
  void choice(E x, E) noexcept {
    integer(static_cast<std::uint64_t>(x), 1);
  }
  [[nodiscard]] std::size_t written() const noexcept { return fine ? size : 0; }
};

/// The fields in their order. Counts are of doubles.
template <class Archive, class S>
void each_field(Archive& a, S& s) noexcept {
  a.number(s.number);
  a.reals(s.pose), a.aside(s.pose);                            // measured, told
  for (int frame = 0; frame < 4; ++frame) a.aside(no_motion);  // of flange, hand, stiffness
  a.skip(2 * (1 + 9 + 3));  // masses, inertias and centres of hand and load
  a.skip(2 + 2);            // elbow
  a.reals(s.motor_torque), a.reals(s.told_torque), a.skip(joints);  // its derivative
  a.reals(s.q), a.reals(s.told), a.reals(s.dq), a.reals(s.told_dq), a.reals(s.told_ddq);
  a.skip(2 * (joints + 6));  // contacts and collisions
  a.reals(s.external), a.reals(s.wrench);
  a.skip(6 + 6 + 3 + 3 * 2);       // wrench along other axes, twist, acceleration of the base, elbow
  a.aside(s.pose), a.skip(6 + 6);  // commanded
  a.aside(s.q), a.aside(s.dq);     // of the motors
  a.choice(s.generator, Generator::none), a.choice(s.control, Control::other);
  a.flags(s.errors), a.flags(s.reasons);
  a.choice(s.mode, Mode::recovery);
  a.real(s.success);
}
template <class Archive, class C>
void each_command_field(Archive& a, C& c, bool& torque_finished) noexcept {
  a.number(c.number);
  a.reals(c.q), a.reals(c.dq);
  a.skip(16 + 6 + 2);  // pose, twist, elbow
  bool elbow = false;
  a.flag(elbow), a.flag(c.finished);
  a.reals(c.torque);
  a.flag(torque_finished);
}

}  // namespace

const char* name(std::size_t error) noexcept {
  static constexpr std::array<const char*, error_count + 1> names{
      "joint_position_limits_violation",
      "cartesian_position_limits_violation",
      "self_collision_avoidance_violation",
      "joint_velocity_violation",
      "cartesian_velocity_violation",
      "force_control_safety_violation",
      "joint_reflex",
      "cartesian_reflex",
      "max_goal_pose_deviation_violation",
      "max_path_pose_deviation_violation",
      "cartesian_velocity_profile_safety_violation",
      "joint_position_motion_generator_start_pose_invalid",
      "joint_motion_generator_position_limits_violation",
      "joint_motion_generator_velocity_limits_violation",
      "joint_motion_generator_velocity_discontinuity",
      "joint_motion_generator_acceleration_discontinuity",
      "cartesian_position_motion_generator_start_pose_invalid",
      "cartesian_motion_generator_elbow_limit_violation",
      "cartesian_motion_generator_velocity_limits_violation",
      "cartesian_motion_generator_velocity_discontinuity",
      "cartesian_motion_generator_acceleration_discontinuity",
      "cartesian_motion_generator_elbow_sign_inconsistent",
      "cartesian_motion_generator_start_elbow_invalid",
      "force_controller_desired_force_tolerance_violation",
      "start_elbow_sign_inconsistent",
      "communication_constraints_violation",
      "power_limit_violation",
      "cartesian_motion_generator_joint_position_limits_violation",
      "cartesian_motion_generator_joint_velocity_limits_violation",
      "cartesian_motion_generator_joint_velocity_discontinuity",
      "cartesian_motion_generator_joint_acceleration_discontinuity",
      "cartesian_position_motion_generator_invalid_frame_flag",
      "controller_torque_discontinuity",
      "joint_p2p_insufficient_torque_for_planning",
      "tau_J_range_violation",
      "instability_detected",
      "joint_move_in_wrong_direction",
      "cartesian_spline_motion_generator_violation",
      "joint_via_motion_generator_planning_joint_limit_violation",
      "base_acceleration_initialization_timeout",
      "base_acceleration_invalid_reading",
      "unknown_error"};
  return names[std::min(error, error_count)];
}

bool parse(Bytes bytes, State& out) noexcept {
  out = {};
  if (bytes.size() != state_size) return false;
  Reader r{bytes};
  each_field(r, out);
  return r.fine && r.left.empty();
}
std::size_t print(const State& state, std::span<std::uint8_t> out) noexcept {
  Writer w{out};
  each_field(w, state);
  return w.written();
}

bool parse(Bytes bytes, Command& out) noexcept {
  out = {};
  if (bytes.size() != command_size) return false;
  Reader r{bytes};
  bool torque_finished = false;
  each_command_field(r, out, torque_finished);
  out.finished = out.finished || torque_finished;
  return r.fine && r.left.empty();
}
std::size_t print(const Command& command, std::span<std::uint8_t> out) noexcept {
  Writer w{out};
  bool finished = command.finished;
  each_command_field(w, command, finished);
  return w.written();
}

bool parse(Bytes payload, Connect& out) noexcept {
  Reader r{payload};
  out.version = static_cast<std::uint16_t>(r.integer(2));
  out.udp_port = static_cast<std::uint16_t>(r.integer(2));
  return r.fine && r.left.empty();
}
std::size_t print(const Connect& payload, std::span<std::uint8_t> out) noexcept {
  Writer w{out};
  w.integer(payload.version, 2), w.integer(payload.udp_port, 2);
  return w.written();
}

// A request counts generators from the first that moves, a state from none.
bool parse(Bytes payload, Move& out) noexcept {
  Reader r{payload};
  const auto control = r.integer(4), generator = r.integer(4);
  r.skip(2 * 3);  // deviations of a pose
  if (!r.fine || !r.left.empty() || control > 2 || generator > 4) return false;
  out = {static_cast<Control>(control), static_cast<Generator>(generator + 1)};
  return true;
}
std::size_t print(const Move& payload, std::span<std::uint8_t> out) noexcept {
  Writer w{out};
  const auto generator = static_cast<std::uint64_t>(payload.generator);
  w.integer(static_cast<std::uint64_t>(payload.control), 4), w.integer(generator > 0 ? generator - 1 : 0, 4);
  for (int k = 0; k < 2; ++k) w.reals(std::array<double, 3>{10, 3.12, 6.28});  // deviations of a pose: wide
  return w.written();
}

bool parse(Bytes payload, std::span<double> out) noexcept {
  Reader r{payload};
  r.reals(out);
  return r.fine && r.left.empty();
}
std::size_t print(std::span<const double> payload, std::span<std::uint8_t> out) noexcept {
  Writer w{out};
  w.reals(payload);
  return w.written();
}

std::size_t print(const Message& message, std::span<std::uint8_t> out) noexcept {
  const std::size_t size = header_size + message.payload.size();
  if (out.size() < size) return 0;
  Writer w{out};
  w.integer(static_cast<std::uint64_t>(message.function), 4), w.integer(message.number, 4);
  w.integer(size, 4);
  std::copy(message.payload.begin(), message.payload.end(), w.left.begin());
  return size;
}

std::span<std::uint8_t> Inbox::room() noexcept {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
            bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
  end_ -= begin_;
  begin_ = 0;
  return std::span(bytes_).subspan(end_);
}
void Inbox::took(std::size_t count) noexcept {
  end_ = std::min(end_ + count, bytes_.size());
}
bool Inbox::next(Message& out) noexcept {
  const Bytes have = Bytes(bytes_).subspan(begin_, end_ - begin_);
  if (broken_ || have.size() < header_size) return false;
  Reader r{have};
  const auto function = r.integer(4), number = r.integer(4), size = r.integer(4);
  const auto known = static_cast<std::uint64_t>(Function::count);
  if (function >= known || size < header_size || size > bytes_.size() / 2) return broken_ = true, false;
  if (have.size() < size) return false;
  out = {static_cast<Function>(function), static_cast<std::uint32_t>(number),
         have.subspan(header_size, static_cast<std::size_t>(size) - header_size)};
  begin_ += static_cast<std::size_t>(size);
  return true;
}

}  // namespace adapters::franka
