#include "examples/adapters/franka/franka.hpp"

#include <algorithm>
#include <cmath>

#include "skinctl/core/contract.hpp"

namespace adapters::franka {
namespace {

constexpr double at_rest = 5e-3;  // of what a joint is told; half of the step that an FR3 takes [rad/s]

/// What a robot says that does not begin to move.
const char* refusal(std::uint8_t status) noexcept {
  switch (status) {
    case moved::not_possible:
      return "it does not begin to move: is FCI activated, are its brakes open, and has no error ended a "
             "motion before?";
    case moved::invalid:
      return "it does not take such a motion";
    case moved::by_emergency:
      return "its user stop is pressed";
    case moved::by_reflex:
      return "a reflex ended the motion before it began";
    default:
      return "it does not begin to move";
  }
}
/// Kind of an error that ended a motion.
ClockFault kind_of(std::size_t error) noexcept {
  switch (static_cast<Error>(error)) {
    case Error::communication:
      return ClockFault::late;
    case Error::position_limits:
    case Error::velocity:
    case Error::start_pose:
    case Error::position_range:
    case Error::velocity_limits:
    case Error::velocity_step:
    case Error::acceleration_step:
    case Error::torque_step:
    case Error::torque_range:
      return ClockFault::limit;
    default:
      return ClockFault::stopped;
  }
}

}  // namespace

Franka::Franka(const Options& options) : options_(options), stream_(std::make_unique<Stream>()) {
  skinctl::require(options.stiffness > 0 && options.stiffness <= 14250, "stiffness of an FR3's joints",
                   options.stiffness, "> 0, <= 14250 N m/rad");
  skinctl::require(options.collision_torque > 0, "collision torque", options.collision_torque, "> 0 N m");
  skinctl::require(options.collision_force > 0, "collision force", options.collision_force, "> 0 N");
}

/// The first byte of the answer to a request: answers to others are passed over.
std::uint8_t Franka::answer_to(std::uint32_t number, Function function, can::Deadline deadline) {
  for (;;) {
    Message m;
    while (inbox_.next(m)) {
      if (m.number != number || m.function != function || m.payload.empty()) continue;
      if (function == Function::connect && m.payload.size() >= 3)
        other_version_ = static_cast<std::uint16_t>(m.payload[1] | m.payload[2] << 8);
      return m.payload[0];
    }
    std::size_t count = 0;
    const Read got =
        inbox_.broken() ? Read::closed : stream_->read_some(inbox_.room(), count, left_until(deadline));
    if (got != Read::some)
      throw ConnectionError("the robot at " + place() +
                            (got == Read::closed ? " hung up" : " does not answer"));
    inbox_.took(count);
  }
}

std::uint8_t Franka::ask(Function function, std::span<const std::uint8_t> payload, can::Deadline deadline) {
  std::array<std::uint8_t, 512> bytes;
  const auto size = print(Message{function, requests_, payload}, bytes);
  if (size == 0 || !stream_->write({bytes.data(), size}, left_until(deadline)))
    throw ConnectionError("the robot at " + place() + " hung up");
  return answer_to(requests_++, function, deadline);
}

void Franka::set(Function function, std::span<const double> numbers, const char* what,
                 can::Deadline deadline) {
  std::array<std::uint8_t, 512> bytes;
  const auto size = print(numbers, bytes);
  const auto status = ask(function, {bytes.data(), size}, deadline);
  if (status == invalid) skinctl::refuse(std::string("the robot refuses the ") + what);
  if (status != success)
    throw ConnectionError(std::string("the robot does not take the ") + what +
                          " now: " + refusal(moved::not_possible));
}

void Franka::open(can::Deadline deadline) {
  moves_ = false;
  why_ = "";
  inbox_ = {};
  requests_ = late_ = 0;
  answered_ = 0;
  success_ = 1;
  in_a_row_ = 0;
  newest_ = {};
  stream_->connect(options_.host, options_.port, "the robot", left_until(deadline));
  socket_ = UdpSocket::at(stream_->local_address(), 0, stream_->remote_address().to_string());

  std::array<std::uint8_t, 64> bytes;
  auto size = print(Connect{version, socket_.port()}, bytes);
  if (ask(Function::connect, {bytes.data(), size}, deadline) != success)
    skinctl::refuse("the robot speaks version " + std::to_string(other_version_) + " of FCI, not " +
                    std::to_string(version));
  if (options_.recover && ask(Function::recover, {}, deadline) != success)
    throw ConnectionError("the robot does not recover by itself: see Desk");

  SevenJoints stiffness;
  stiffness.fill(options_.stiffness);
  set(Function::set_joint_impedance, stiffness, "stiffness", deadline);
  // Lower and upper thresholds of torques, while it accelerates and else; then of forces and moments.
  std::array<double, 4 * joints + 4 * 6> thresholds;
  thresholds.fill(options_.collision_torque);
  std::fill(thresholds.begin() + 4 * joints, thresholds.end(), options_.collision_force);
  set(Function::set_collision_behavior, thresholds, "thresholds of collisions", deadline);

  size = print(Move{Control::joint_impedance, Generator::position}, bytes);
  const auto status = ask(Function::move, {bytes.data(), size}, deadline);
  if (status != moved::started) throw ConnectionError("the robot at " + place() + ": " + refusal(status));
}

ClockFault Franka::ended(const State& s) noexcept {
  if (s.mode == Mode::user_stopped) return why_ = "its user stop is pressed", ClockFault::stopped;
  const Errors errors = s.errors.any() ? s.errors : s.reasons;
  for (std::size_t k = 0; k < error_count; ++k)
    if (errors[k]) return why_ = name(k), kind_of(k);
  return why_ = "it ended the motion", ClockFault::stopped;
}

ClockFault Franka::read(std::span<const std::uint8_t> bytes, ClockedStateOf<joints>& state) noexcept {
  State s;
  why_ = "";
  if (!parse(bytes, s)) return ClockFault::nonsense;
  const bool runs =
      s.mode == Mode::move && s.generator == Generator::position && s.control == Control::joint_impedance;
  // Those of before the motion may still be under way.
  if (!runs &&
      (s.mode == Mode::reflex || s.mode == Mode::user_stopped || (moves_ && s.number > newest_.number)))
    return ended(s);
  moves_ = moves_ || runs;
  // Of the last 100 commands; those of before are no loss of this motion. One that was overtaken tells
  // nothing.
  if (s.number > newest_.number) {
    const auto lost = std::lround(100 * (success_ - s.success));
    if (moves_ && lost > 0) late_ += static_cast<std::uint32_t>(lost);
    success_ = s.success;
    newest_ = s;
  }
  state = {.number = s.number,
           .q = s.q,
           .told = s.told,
           .late = late_,
           .takes = runs,
           .wrench = {},
           .external = s.external};
  if (!moves_) why_ = "it has not begun to move";
  return ClockFault::none;
}

/// In a cycle without an answer the robot goes on at its acceleration, beside the plan, and an answer that
/// jumps back ends its motion: so a joint that stands beside is led back, critically damped, well within the
/// limits of acceleration and jerk.
SevenJoints Franka::towards(std::uint64_t number, const SevenJoints& q) noexcept {
  constexpr double dt = 1e-3, settling = 0.01;       // [s]
  constexpr double most = 9, step = 3, same = 1e-3;  // of acceleration, and from cycle to cycle [rad/s^2]
  const State& s = newest_;
  in_a_row_ = number == answered_ + 1 ? std::min(in_a_row_ + 1, 2) : 0;
  SevenJoints out = q;
  for (std::size_t i = 0; i < joints; ++i) {
    // After a gap nothing is known of the plan's motion but where it is.
    const double dq = in_a_row_ > 0 ? (q[i] - plan_[i]) / dt : s.told_dq[i];
    const double ddq = in_a_row_ > 1 ? (dq - plan_dq_[i]) / dt : s.told_ddq[i];
    plan_[i] = q[i], plan_dq_[i] = dq;
    const double straight = ((q[i] - s.told[i]) / dt - s.told_dq[i]) / dt;
    const bool smooth = std::abs(straight) <= most && std::abs(straight - s.told_ddq[i]) <= step;
    if (smooth && std::abs(straight - ddq) <= same) continue;  // it stands in the plan
    const double beside = q[i] - dt * dq - s.told[i], faster = dq - dt * ddq - s.told_dq[i];
    const double wanted = ddq + 2 / settling * faster + beside / (settling * settling);
    const double a = std::clamp(s.told_ddq[i] + std::clamp(wanted - s.told_ddq[i], -step, step), -most, most);
    out[i] = s.told[i] + dt * (s.told_dq[i] + dt * a);
  }
  return out;
}

std::size_t Franka::answer(std::uint64_t number, const SevenJoints& q, bool last,
                           std::span<std::uint8_t> out) noexcept {
  Command c;
  c.number = number;
  c.q = towards(number, q);
  // A robot that is told to be fast is not told that it is at rest: `close` goes on.
  c.finished = last && std::all_of(newest_.told_dq.begin(), newest_.told_dq.end(),
                                   [](double v) { return std::abs(v) < at_rest; });
  answered_ = number;
  return print(c, out);
}

void Franka::close(can::Deadline deadline) noexcept {
  std::array<std::uint8_t, 4096> bytes;
  bool ended = !moves_ || answered_ == 0;
  while (!ended) {
    std::size_t size = 0;
    State s;
    if (socket_.receive(bytes, size, deadline) != Read::some) break;
    if (!parse({bytes.data(), size}, s)) continue;
    ended = s.mode != Mode::move;
    if (ended || s.number <= newest_.number) continue;
    newest_ = s;
    static_cast<void>(socket_.send({bytes.data(), answer(s.number, SevenJoints(plan_), true, bytes)}));
  }
  if (!ended) {
    const auto size = print(Message{Function::stop_move, requests_++, {}}, bytes);
    static_cast<void>(stream_->write({bytes.data(), size}, Timeout(20)));
  }
  stream_->close();
  socket_.close();
  moves_ = false;
}

}  // namespace adapters::franka
