// What the driver does in every cycle.
#include <cmath>

#include "examples/adapters/ur5/driver.hpp"

namespace adapters::ur5 {
namespace {

using Clock = std::chrono::steady_clock;
using skinctl::Heard;
using skinctl::Interface;

constexpr double allowed = 0.1;       // of a slider at zero and of states that are no numbers [s]
constexpr double program_starts = 1;  // until our program is seen to run [s]
constexpr auto window = std::chrono::milliseconds(250);  // over which the clocks are compared
constexpr int windows = 3;                               // in a row that must disagree
constexpr int most_reads = 64;                           // of the states that have waited, at once
// One of the states of so long, or of as long before, came in time: four come at 125 Hz, and an overtaken
// packet keeps back fewer. Cells may be silent for longer.
constexpr auto fastest_of = std::chrono::milliseconds(30);

/// What comes after a silence. TCP brings it piece by piece, and the first of it is of a time that the loop has
/// left behind: newer states are waited for, and where they stop again the silence goes on. A robot whose clock
/// stood stays behind, but goes on sending: then its clock counts.
class CatchUp {
 public:
  /// @param stamp     of the newest state by the controller's clock [s], heard at `heard_at`.
  /// @param patience  time for which states behind the clock are read on from.
  CatchUp(double stamp, Clock::time_point heard_at, Clock::duration period, Clock::duration patience)
      : stamp_(stamp), heard_at_(heard_at), period_(period), patience_(patience) {}

  /// Whether a state of this time, which has come now, is the robot's state.
  bool counts(double stamp) {
    using Seconds = std::chrono::duration<double>;
    const auto now = Clock::now();
    // A way that has become longer by a few periods is no such silence.
    if (stamp_ + Seconds(now - heard_at_).count() - stamp < 2 * Seconds(patience_).count()) return true;
    if (!lags_) enough_ = now + patience_;
    lags_ = true, pause_ = now + 3 * period_;
    return now >= enough_;
  }
  /// Until when the next state is waited for.
  [[nodiscard]] Clock::time_point until(Clock::time_point without) const {
    return lags_ ? std::min(enough_, pause_) : without;
  }
  /// Whether states have come until the patience was over.
  [[nodiscard]] bool goes_on() const { return lags_ && enough_ <= pause_; }

 private:
  double stamp_;
  Clock::time_point heard_at_;
  Clock::duration period_, patience_;
  Clock::time_point enough_{}, pause_{};
  bool lags_ = false;
};

}  // namespace

Heard Driver::fail(Fault fault, const std::string& detail) noexcept {
  if (fault_ == Fault::none) {
    fault_ = fault;
    error_ = row(fault).words + (detail.empty() ? "" : ": " + detail);
    if (!rtde_.said().empty()) error_ += "; the robot says: " + rtde_.said();
  }
  return Heard::lost;
}

/// What the states tell of a protective stop.
std::string Driver::explanation() const {
  char text[160];
  const double force = std::hypot(report_.wrench[0], report_.wrench[1], report_.wrench[2]);
  std::size_t farthest = 0;
  for (std::size_t i = 1; i < 6; ++i)
    if (std::abs(sent_[i] - sent_before_[i]) > std::abs(sent_[farthest] - sent_before_[farthest]))
      farthest = i;
  const double step = std::abs(sent_[farthest] - sent_before_[farthest]);
  if (force > 50) {
    std::snprintf(text, sizeof text, "%.0f N at the tool: it has hit something", force);
  } else if (config_.interface == Interface::position && step * config_.rate > 3.2) {
    std::snprintf(text, sizeof text, "the last command moved joint %zu by %.3f rad in a cycle", farthest + 1,
                  step);
  } else {
    std::size_t beside = 0;
    for (std::size_t i = 1; i < 6; ++i)
      if (std::abs(report_.q[i] - report_.told[i]) > std::abs(report_.q[beside] - report_.told[beside]))
        beside = i;
    std::snprintf(text, sizeof text,
                  "joint %zu stands %.3f rad from where it was told to be and %.0f N act at the tool; see "
                  "the log at the panel",
                  beside + 1, report_.q[beside] - report_.told[beside], force);
  }
  return text;
}

Fault Driver::halted() noexcept {
  const Report& r = report_;
  if (r.safety_mode == 3) return Fault::protective_stop;
  if (r.safety_mode > 3) return Fault::safety_stop;
  if (r.robot_mode != 7) return Fault::not_running;
  if (r.runtime_state == 2 || r.runtime_state == 5) playing_ = true;
  if (playing_ || r.timestamp - started_ > program_starts) {
    if (r.runtime_state == 3 || r.runtime_state == 4) return Fault::paused;
    if (r.runtime_state <= 1) return Fault::program_ended;
  }
  if (r.slider >= 0.01) slider_up_ = r.timestamp;  // not of NaN either
  if (!(r.timestamp - slider_up_ <= allowed)) return Fault::slider_at_zero;
  if (r.finite()) finite_at_ = r.timestamp;
  if (!(r.timestamp - finite_at_ <= allowed)) return Fault::not_a_number;
  return Fault::none;
}

bool Driver::clocks_agree() noexcept {
  const auto now = Clock::now();
  if (!config_.real_time || now - window_ < window) return true;
  const double here = std::chrono::duration<double>(now - window_).count(),
               there = report_.timestamp - window_stamp_;
  wrong_windows_ = there < 0.5 * here || there > 2 * here ? wrong_windows_ + 1 : 0;
  window_ = now;
  window_stamp_ = report_.timestamp;
  return wrong_windows_ < windows;
}

Heard Driver::wait(skinctl::State<6>& state) noexcept {
  if (!running_) return fail(Fault::unreachable, "it is not connected");
  if (silent_waits_ == 0) waits_since_ = Clock::now(), nonsense_before_ = nonsense_, stood_before_ = stood_;
  auto lost_at = waits_since_ + config_.give_up;
  const Clock::duration period = std::chrono::nanoseconds(skinctl::nanoseconds(1 / config_.rate));
  // After the patience as many cycles as it lasted, at once: the loop's clock stays with the robot's, which has
  // gone on since the newest state, while this computer was busy, too.
  const auto silent_at = heard_at_ + std::max<Clock::duration>(config_.silence, (silent_waits_ + 1) * period);
  const Report newest = report_;
  CatchUp catch_up(newest.timestamp, heard_at_, period, config_.silence);
  for (bool fresh = false; !fresh;) {
    const auto now = Clock::now();
    if (now >= lost_at) {
      const Fault why = stood_ != stood_before_         ? Fault::clock_stands
                        : nonsense_ != nonsense_before_ ? Fault::nonsense
                                                        : Fault::silent;
      return fail(why, "for " + std::to_string(config_.give_up.count()) + " ms");
    }
    Package p{};
    const RtdeEnd end = rtde_.read(p, left_until(std::min(catch_up.until(silent_at), lost_at)));
    if (end == RtdeEnd::closed) return fail(Fault::stream_closed);
    if (end == RtdeEnd::nonsense) return fail(Fault::nonsense, "a package of impossible size");
    if (end == RtdeEnd::time_over) {  // also of a cycle that is owed: states may have come meanwhile
      if (Clock::now() < catch_up.until(silent_at)) continue;
      if (catch_up.goes_on()) break;
      report_ = newest;
      ++silent_waits_;
      return Heard::silent;
    }
    fresh = take(p);
    // What has waited does not fit the framer at once, and the first part of it is long past.
    for (int k = 0; silent_waits_ > 0 && k < most_reads && rtde_.read(p, Timeout(0)) == RtdeEnd::none; ++k)
      fresh = take(p) || fresh;
    if (fresh && silent_waits_ > 0 && config_.real_time && !catch_up.counts(report_.timestamp)) {
      fresh = false;
      lost_at = (waits_since_ = Clock::now()) + config_.give_up;  // it is there
    }
  }
  heard_at_ = Clock::now();
  time_state();
  if (silent_waits_ > 0)
    window_ = Clock::now(), window_stamp_ = report_.timestamp;  // states came late, all at once
  silent_waits_ = 0;
  take_echo();
  if (const Fault why = halted(); why != Fault::none) {
    if (why == Fault::protective_stop) return fail(why, explanation());
    if (why == Fault::safety_stop) return fail(why, describe_safety_mode(report_.safety_mode));
    if (why == Fault::not_running) return fail(why, describe_robot_mode(report_.robot_mode));
    return fail(why);
  }
  if (!clocks_agree()) return fail(Fault::clock_runs_wrong);
  state.time = clock();
  for (std::size_t i = 0; i < 6; ++i) {
    state.q[i] = report_.q[i];
    state.dq[i] = report_.dq[i];
  }
  return Heard::state;
}

/// The newest of what has come counts; time is the controller's, so that skipped packages lose nothing. False
/// without a newer state.
bool Driver::take(const Package& first) noexcept {
  bool fresh = false;
  for (std::optional<Package> next = first; next; next = rtde_.next()) {
    Report newer;
    if (next->type == package::message) {
      rtde_.hear(next->payload);
    } else if (!is_state(*next, newer) || !std::isfinite(newer.timestamp)) {
      ++nonsense_;
    } else if (newer.timestamp > report_.timestamp) {
      report_ = newer;
      fresh = true;
    } else {
      ++stood_;
    }
  }
  return fresh;
}

void Driver::take_echo() noexcept {
  const std::int32_t behind = (posted_ - report_.echo + echo_numbers) % echo_numbers;
  const bool known = report_.echo > 0 && report_.echo <= echo_numbers && behind < kept;
  if (!echoes() || !known) return;  // the register may hold what an earlier program wrote
  const auto at = posted_at_[static_cast<std::size_t>(report_.echo % kept)];
  round_trip_ = std::chrono::duration<double>(Clock::now() - at).count();
}

/// How late the newest state is. TCP keeps all back that comes behind a packet which is lost or overtaken, so
/// the newest may be as old as that took; a way that has become longer is the way soon, which `ClockOffset`
/// would find after a second. After a silence nothing is known.
void Driver::time_state() noexcept {
  const skinctl::Nanoseconds ahead = stamp() - heard_at_.time_since_epoch();
  const auto since = heard_at_ - fastest_since_;
  if (since >= fastest_of) {
    fastest_before_ = since >= 2 * fastest_of ? ahead : fastest_;
    fastest_ = ahead;
    fastest_since_ = heard_at_;
  }
  fastest_ = std::max(fastest_, ahead);
  late_ = config_.real_time ? std::max(fastest_, fastest_before_) - ahead : skinctl::Nanoseconds(0);
}

skinctl::Nanoseconds Driver::stamp() const noexcept {
  // Whole microseconds: a double of seconds after a boot long ago is not much finer, and equal intervals stay
  // equal.
  return skinctl::nanoseconds(report_.timestamp * 1e-3) * 1000;
}

skinctl::Nanoseconds Driver::clock() const noexcept {
  return stamp() + silent_waits_ * skinctl::nanoseconds(1 / config_.rate);
}

skinctl::Nanoseconds Driver::clock_now() const noexcept {
  const skinctl::Nanoseconds at_report = stamp() + late_;
  return silent_waits_ == 0 ? at_report : at_report + (Clock::now() - heard_at_);
}

bool Driver::send(skinctl::Interface interface, const double (&numbers)[6]) noexcept {
  if (interface != config_.interface) return false;
  std::int32_t how = mode::servoj;
  if (interface == Interface::velocity) how = mode::speedj;
  if (interface == Interface::torque) how = mode::torque;
  sent_before_ = sent_;
  std::copy(std::begin(numbers), std::end(numbers), sent_.begin());
  return deliver(sent_, how);
}

bool Driver::hold() noexcept {
  return deliver({}, mode::idle);
}

bool Driver::deliver(const std::array<double, 6>& numbers, std::int32_t how) noexcept {
  if (post(numbers, how, Timeout(20))) return true;
  // A program that has ended closes the socket, and the states may not have told yet why.
  skinctl::State<6> last;
  const auto deadline = Clock::now() + 4 * config_.silence;
  Heard heard = Heard::silent;
  while (fault_ == Fault::none && heard != Heard::lost && Clock::now() < deadline) heard = wait(last);
  std::array<std::uint8_t, 16> said{};
  std::size_t count = 0;
  const bool closed = reverse_.read_some(said, count, Timeout(0)) == Read::closed;
  if (closed && heard == Heard::state && report_.runtime_state == 2)
    static_cast<void>(fail(Fault::program_ended, "another program plays in its place"));
  static_cast<void>(fail(Fault::commands_refused));
  return false;
}

bool Driver::post(const std::array<double, 6>& numbers, std::int32_t how, Timeout timeout) noexcept {
  posted_ = posted_ % echo_numbers + 1;
  posted_at_[static_cast<std::size_t>(posted_ % kept)] = Clock::now();
  const auto patience = static_cast<std::int32_t>(config_.robot_patience.count());
  return reverse_.write(message(patience, numbers, how), timeout);
}

void Driver::stop() noexcept {
  if (!running_) return;
  running_ = false;
  static_cast<void>(post({}, mode::stopped, Timeout(20)));
  reverse_.close();
  script_.close();
  rtde_.close();
}

}  // namespace adapters::ur5
