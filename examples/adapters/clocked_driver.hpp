// The driver of robots that are the clock.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <future>
#include <utility>

#include "examples/adapters/robot_clock.hpp"
#include "skinctl/hardware/robot.hpp"
#include "skinctl/sensing/velocity_estimator.hpp"
#include "skinctl/sensing/wrench_sample.hpp"

namespace adapters {

/// A `RobotDriver` by position, or by joint impedance where the protocol takes torques beside. Each datagram
/// has one answer, within the cycle; of those that waited together only the newest, unless the controller
/// counts answers. Nothing is sent unasked, and nothing waits longer than one and a half periods.
template <ClockProtocol P>
class ClockedDriver {
 public:
  static constexpr std::size_t joints = P::joints;
  using Joints = std::array<double, joints>;
  explicit ClockedDriver(P protocol, const ClockOptions& options = {})
      : protocol_(std::move(protocol)), options_(options) {}
  ~ClockedDriver() { stop(); }
  ClockedDriver(const ClockedDriver&) = delete;
  ClockedDriver& operator=(const ClockedDriver&) = delete;

  /// Waits for the controller and answers that the arm stays where it is. Throws `ConnectionError`, and
  /// `ConfigurationError` for a cycle other than declared or another number of joints.
  void connect();
  /// The result of `work`, e.g. a scene that takes its time to be built, while the arm is held.
  template <class F>
  auto hold_while(F&& work) {
    const auto when = options_.real_time ? std::launch::async : std::launch::deferred;
    auto done = std::async(when, std::forward<F>(work));
    skinctl::State<joints> state;
    while (done.wait_for(Timeout(0)) == std::future_status::timeout && fault_ == ClockFault::none)
      if (wait(state) == skinctl::Heard::state) answer(target_);
    return done.get();
  }

  skinctl::Heard wait(skinctl::State<joints>& state) noexcept;
  /// False when it was refused: see `fault()`. While the controller is silent nothing asks, and nothing is
  /// sent.
  bool send(const skinctl::PositionCommand<joints>& c) noexcept {
    for (std::size_t i = 0; i < joints; ++i) target_[i] = c.position[i];
    return go(target_);
  }
  bool send(const skinctl::ImpedanceCommand<joints>& c) noexcept
    requires TakesTorque<P>
  {
    for (std::size_t i = 0; i < joints; ++i) target_[i] = c.position[i], torque_[i] = c.torque[i];
    protocol_.beside(torque_);
    return go(target_);
  }
  /// Brings the arm to rest by answers, and ends the dialogue.
  void stop() noexcept;

  [[nodiscard]] skinctl::JointPosition<joints> told() const noexcept {
    return skinctl::JointPosition<joints>(newest_.told);
  }
  [[nodiscard]] std::uint32_t packet() const noexcept { return static_cast<std::uint32_t>(cycle_); }
  [[nodiscard]] std::span<const skinctl::WrenchSample> wrenches() noexcept {
    return {&sample_, std::exchange(has_sample_, false) ? 1u : 0u};
  }
  /// Torque of the world at the joints, for a touch that reads it as the robot finds it [N m].
  [[nodiscard]] skinctl::JointTorque<joints> motor_torque() const noexcept
    requires FindsTorque<P>
  {
    return skinctl::JointTorque<joints>(newest_.external.value_or(Joints{}));
  }
  [[nodiscard]] ClockFault fault() const noexcept { return fault_; }
  /// The same in words; empty while the robot is there.
  [[nodiscard]] const char* error() const noexcept { return error_.data(); }
  [[nodiscard]] ClockCounts counts() const noexcept {
    ClockCounts out = counts_;
    out.late_there = newest_.late - late_at_start_;
    return out;
  }
  /// Periods without a datagram.
  [[nodiscard]] int silent() const noexcept { return silent_; }
  [[nodiscard]] const ClockedStateOf<joints>& newest() const noexcept { return newest_; }
  [[nodiscard]] P& protocol() noexcept { return protocol_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t at_once = 64;        // datagrams of one wait
  static constexpr std::int64_t first_states = 12;  // that show how the controller counts
  static constexpr double longest_brake = 1.5;      // [s]
  static constexpr std::int64_t late_window = 100;  // cycles, of which a quarter may be late

  ClockFault take(ClockedStateOf<joints>& s, can::Deadline deadline) noexcept;
  void judge_counting(std::uint64_t unit, std::int64_t cycles, Clock::duration since) const;
  ClockFault judge(const ClockedStateOf<joints>& s, std::int64_t& ahead) noexcept;
  bool answer(const Joints& q, bool last = false) noexcept;
  /// The command of a cycle; of one whose state has not come it is kept, for the answer that its number may
  /// need.
  bool go(const Joints& q, bool last = false) noexcept {
    if (silent_ > 0 && unsent_count_ < unsent_.size()) unsent_[unsent_count_++] = q;
    return answer(q, last);
  }
  void brake() noexcept;
  skinctl::Heard fail(ClockFault fault, const char* detail) noexcept;

  P protocol_;
  ClockOptions options_;
  std::optional<skinctl::VelocityEstimator<joints>> estimator_;
  typename skinctl::VelocityEstimator<joints>::Memory velocity_;
  ClockedStateOf<joints> newest_;
  ClockCounts counts_;
  Joints target_{};
  Joints torque_{};                  ///< beside the last command [N m]
  std::array<Joints, 10> unsent_{};  ///< commands of a silence
  std::size_t unsent_count_ = 0;
  std::array<Joints, 3> sent_{};  ///< the last answers, the newest first
  skinctl::WrenchSample sample_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::array<char, 256> error_{};
  Clock::time_point heard_at_{};
  std::uint64_t unit_ = 1, answered_ = 0;  ///< number from one cycle to the next; of the last answer
  std::int64_t cycle_ = 0, window_at_ = 0;
  std::uint32_t late_at_start_ = 0, late_at_ = 0;
  ClockFault fault_ = ClockFault::none;
  int silent_ = 0;  ///< periods without a state
  bool running_ = false, has_sample_ = false;
};

template <ClockProtocol P>
skinctl::Heard ClockedDriver<P>::fail(ClockFault fault, const char* detail) noexcept {
  if (fault_ == ClockFault::none) {
    fault_ = fault;
    std::snprintf(error_.data(), error_.size(), "%s%s%s", row(fault).words, *detail != 0 ? ": " : "", detail);
  }
  return skinctl::Heard::lost;
}

/// The next datagram; `silent`: none until the deadline.
template <ClockProtocol P>
ClockFault ClockedDriver<P>::take(ClockedStateOf<joints>& s, can::Deadline deadline) noexcept {
  std::size_t size = 0;
  const Read got = protocol_.socket().receive(buffer_, size, deadline);
  if (got != Read::some) return got == Read::closed ? ClockFault::socket : ClockFault::silent;
  const ClockFault fault = protocol_.read({buffer_.data(), size}, s);
  if (fault == ClockFault::nonsense) ++counts_.nonsense;
  return fault;
}

/// How many cycles `s` is ahead of the newest state, in cycles.
template <ClockProtocol P>
ClockFault ClockedDriver<P>::judge(const ClockedStateOf<joints>& s, std::int64_t& ahead) noexcept {
  constexpr std::int64_t overtaken = 50, leap = 2500;
  const auto by = static_cast<std::int64_t>(s.number - newest_.number);
  ahead = by / static_cast<std::int64_t>(unit_);
  if (by % static_cast<std::int64_t>(unit_) != 0 || ahead > leap || ahead < -overtaken)
    return ClockFault::sequence;
  return ClockFault::none;
}

/// Throws unless the controller counts cycles or milliseconds, at the period that was declared.
template <ClockProtocol P>
void ClockedDriver<P>::judge_counting(std::uint64_t unit, std::int64_t cycles, Clock::duration since) const {
  const double period = skinctl::milliseconds(protocol_.period());
  char text[160];
  if (unit != 1 && unit != static_cast<std::uint64_t>(std::lround(period))) {
    std::snprintf(text, sizeof text, "the controller's numbers grow by %llu a cycle, neither by 1 nor by %g",
                  static_cast<unsigned long long>(unit), period);
    skinctl::refuse(text);
  }
  const double measured =
      std::chrono::duration<double, std::milli>(since).count() / static_cast<double>(cycles);
  if (!options_.real_time || (measured > 0.6 * period && measured < 1.6 * period)) return;
  std::snprintf(text, sizeof text,
                "datagrams come every %.1f ms, not every %g ms: which cycle does its program set?", measured,
                period);
  skinctl::refuse(text);
}

template <ClockProtocol P>
void ClockedDriver<P>::connect() {
  fault_ = ClockFault::none;
  error_[0] = 0;
  counts_ = {};
  const auto deadline = Clock::now() + options_.first;
  protocol_.open(deadline);
  ClockedStateOf<joints> s;
  std::uint64_t unit = ~std::uint64_t{0}, first = 0;
  Clock::time_point begin{};
  for (std::int64_t heard = 0; heard < first_states;) {
    const ClockFault fault = Clock::now() < deadline ? take(s, deadline) : ClockFault::silent;
    if (fault == ClockFault::joints || fault == ClockFault::declared)
      skinctl::refuse(row(fault).words + std::string(": ") + protocol_.why());
    if (fault == ClockFault::stopped || fault == ClockFault::socket)
      throw ConnectionError(row(fault).words + std::string(": ") + protocol_.why());
    if (fault == ClockFault::silent && *protocol_.why() != 0)  // it is there
      throw ConnectionError("the controller takes no commands (" + protocol_.place() +
                            "): " + protocol_.why());
    if (fault == ClockFault::silent)
      throw ConnectionError(std::string(row(ClockFault::unreachable).words) + " (" + protocol_.place() +
                            "): " + row(ClockFault::unreachable).way_back +
                            (counts_.nonsense > 0 ? " What came is none of this protocol." : ""));
    if (fault != ClockFault::none || !s.takes) continue;
    if (heard == 0) {
      protocol_.socket().keep_peer();
      target_ = s.told;
      sent_.fill(target_);
      begin = Clock::now();
      first = s.number;
    } else {
      unit = std::min(unit, s.number - newest_.number);
    }
    newest_ = s;
    answered_ = s.number - 1;
    heard_at_ = Clock::now();
    answer(target_);
    ++heard;
  }
  judge_counting(unit, std::max<std::int64_t>(1, static_cast<std::int64_t>((s.number - first) / unit)),
                 Clock::now() - begin);
  unit_ = unit;
  late_at_start_ = late_at_ = newest_.late;
  cycle_ = window_at_ = 0;
  velocity_ = {};
  estimator_.emplace(typename skinctl::VelocityEstimator<joints>::Settings{
      .period = protocol_.period(), .max_gap = 20 * protocol_.period()});
  silent_ = 0;
  has_sample_ = false;
  running_ = true;
}

template <ClockProtocol P>
skinctl::Heard ClockedDriver<P>::wait(skinctl::State<joints>& state) noexcept {
  using skinctl::Heard;
  if (fault_ != ClockFault::none || !running_) return fail(ClockFault::socket, "not connected");
  answer(target_);  // if nobody has
  const auto period = protocol_.period();
  // From when the last one came, not from now: a cycle that is lost has to be run in its time.
  const auto due = heard_at_ + period + period / 2 + silent_ * period;
  const auto until = options_.real_time ? due : Clock::now() + options_.give_up;
  bool fresh = false;
  for (std::size_t k = 0; k < at_once; ++k) {
    ClockedStateOf<joints> s;
    const ClockFault fault = take(s, fresh ? Clock::time_point{} : until);
    if (fault == ClockFault::silent) break;
    if (fault == ClockFault::nonsense) continue;
    if (fault != ClockFault::none) return fail(fault, protocol_.why());
    std::int64_t ahead = 0;
    if (!s.takes) continue;  // no answer is due to this one
    if (judge(s, ahead) != ClockFault::none) return fail(ClockFault::sequence, protocol_.why());
    if (ahead <= 0) {
      ++(ahead == 0 ? counts_.doubled : counts_.overtaken);
      continue;
    }
    if (fresh) ++counts_.skipped;
    counts_.lost += static_cast<std::uint64_t>(ahead - 1);
    cycle_ += ahead;
    newest_ = s;
    fresh = true;
    if (P::answers_every_number) break;  // a cycle for each
  }
  const auto now = Clock::now();
  if (!fresh) {
    ++silent_;
    if (now - heard_at_ < options_.give_up) return Heard::silent;
    const bool were_late = newest_.late - late_at_ > 2;
    return fail(were_late ? ClockFault::late : ClockFault::silent,
                were_late ? "and it has ended" : protocol_.why());
  }
  silent_ = 0;
  heard_at_ = now;
  ++counts_.states;
  if (cycle_ - window_at_ >= late_window) {
    if (newest_.late - late_at_ > late_window / 4)
      return fail(ClockFault::late, "more than a quarter of them");
    late_at_ = newest_.late;
    window_at_ = cycle_;
  }
  static_cast<void>(
      estimator_->observe(velocity_, skinctl::JointPosition<joints>(newest_.q), cycle_ * period));
  state = velocity_.state;
  if ((has_sample_ = newest_.wrench.has_value())) {
    const SixJoints& w = *newest_.wrench;
    sample_ = {state.time, {w[0], w[1], w[2]}, {w[3], w[4], w[5]}};
  }
  return Heard::state;
}

/// Answer `k` of `n` that lead to `q`: they go on at the acceleration of those before, and reach it smoothly.
template <std::size_t N>
std::array<double, N> between(const std::array<std::array<double, N>, 3>& before,
                              const std::array<double, N>& q, std::int64_t k, std::int64_t n) {
  std::array<double, N> way = q;
  const auto s = static_cast<double>(k), all = static_cast<double>(n), share = s / all;
  for (std::size_t i = 0; i < N; ++i) {
    const double v = before[0][i] - before[1][i], a = v - (before[1][i] - before[2][i]);
    const double rest = q[i] - (before[0][i] + v * all + a * all * (all + 1) / 2);
    way[i] = before[0][i] + v * s + a * s * (s + 1) / 2 + rest * share * share * share;
  }
  return way;
}

template <ClockProtocol P>
bool ClockedDriver<P>::answer(const Joints& q, bool last) noexcept {
  if (fault_ != ClockFault::none) return false;
  const auto missing = static_cast<std::int64_t>((newest_.number - answered_ + unit_ - 1) / unit_);
  if (answered_ == newest_.number || missing <= 0) return true;
  if (const char* why = protocol_.refuses(q)) return fail(ClockFault::limit, why), false;
  const auto n = P::answers_every_number ? std::min<std::int64_t>(missing, 10) : 1;
  const bool exact = static_cast<std::int64_t>(unsent_count_) == n - 1;
  const auto before = sent_;
  for (std::int64_t k = 1; k <= n; ++k) {
    const Joints way =
        k == n ? q : (exact ? unsent_[static_cast<std::size_t>(k - 1)] : between(before, q, k, n));
    const auto number = newest_.number - unit_ * static_cast<std::uint64_t>(n - k);
    const auto size = protocol_.answer(number, way, last && k == n, buffer_);
    if (size == 0 || !protocol_.socket().send({buffer_.data(), size}))
      return fail(ClockFault::socket, ""), false;
    sent_ = {way, sent_[0], sent_[1]};
  }
  answered_ = newest_.number;
  unsent_count_ = 0;
  if (Clock::now() - heard_at_ > protocol_.period()) ++counts_.late;
  return true;
}

/// From the motion of the last answers to rest: the velocity is a cubic in time, with the acceleration that
/// it has. Its jerk is largest at the beginning, (6 v + 4 a T) / T^2.
template <ClockProtocol P>
void ClockedDriver<P>::brake() noexcept {
  const auto before = sent_;
  const double period = skinctl::seconds<double>(protocol_.period()), jerk = options_.brake_jerk;
  Joints v{}, a{};
  double time = 0;
  for (std::size_t i = 0; i < joints; ++i) {
    v[i] = before[0][i] - before[1][i];
    a[i] = v[i] - (before[1][i] - before[2][i]);
    const double u = std::abs(v[i]) / period, w = std::abs(a[i]) / (period * period);
    time = std::max(time, (4 * w + std::sqrt(16 * w * w + 24 * jerk * u)) / (2 * jerk));
  }
  const auto cycles = std::max<std::int64_t>(1, std::llround(std::min(time, longest_brake) / period));
  Joints q = before[0];
  skinctl::State<joints> state;
  for (std::int64_t k = 1, waits = 0; waits < 2 * cycles + 20; ++waits) {
    // A state that the loop has left unanswered is the first.
    if (answered_ == newest_.number && wait(state) == skinctl::Heard::lost) return;
    const double s = std::min(1.0, static_cast<double>(k) / static_cast<double>(cycles)),
                 rest = (1 - s) * (1 - s);
    for (std::size_t i = 0; i < joints; ++i)
      q[i] += v[i] * rest * (1 + 2 * s) + a[i] * static_cast<double>(cycles) * s * rest;
    if constexpr (TakesTorque<P>) {
      Joints torque = torque_;
      for (double& x : torque) x *= 1 - s;
      protocol_.beside(torque);
    }
    const bool last = k >= cycles && silent_ == 0;
    if (!go(q, last) || last) return;
    ++k;
  }
}

template <ClockProtocol P>
void ClockedDriver<P>::stop() noexcept {
  if (!running_) return;
  if (fault_ == ClockFault::none) brake();
  running_ = false;
  protocol_.close(Clock::now() + std::chrono::milliseconds(500));
}

}  // namespace adapters
