// Drives an Allegro hand by torque: states with estimated velocities, torques, and a servo that is off at any
// end.
#pragma once

#include <cstdio>

#include "examples/adapters/allegro/can_hand.hpp"
#include "examples/adapters/allegro/udp_hand.hpp"
#include "skinctl/hardware/robot.hpp"
#include "skinctl/sensing/velocity_estimator.hpp"

namespace adapters::allegro {

/// Reactions of a driver. Silence lasts 1.5 periods and then one period each: a cycle on the last state,
/// which holds the hand. What goes on for `give_up`, or is hot or broken, is lost: the loop ends and the
/// servo goes off.
struct DriverOptions {
  Timeout give_up{100};       ///< without a complete set of positions
  int hottest = 70;           ///< [C]
  Timeout ask_every{100};     ///< for temperature and status
  Timeout first_state{2000};  ///< after the servo went on
};

/// A `RobotDriver` for 16 joints over any `HandLink`. Connecting throws `ConnectionError`; in the loop the
/// reason is kept in `error()`. The servo goes off in `stop`, in the destructor, and therefore with every
/// exception; a program that dies by SIGKILL leaves the last torque to the hand, see `Guardian`.
template <HandLink Link>
class Driver {
 public:
  using Estimator = skinctl::VelocityEstimator<16>;

  Driver(Link link, const HandOptions& hand, const DriverOptions& options = {})
      : link_(std::move(link)),
        hand_(hand),
        options_(options),
        period_(std::chrono::milliseconds(hand.period())),
        estimator_({.period = period_, .max_gap = 20 * period_, .step = encoder_step(hand.generation)}) {
    hand.check();
    using skinctl::require;
    require(options.give_up >= 4 * period_ && options.give_up.count() <= 60000, "time to give up",
            double(options.give_up.count()), "4 periods to 60 000 ms");
    require(options.hottest >= 30 && options.hottest <= 120, "hottest", options.hottest, "30 to 120 C");
    require(options.ask_every.count() >= 10 && options.ask_every.count() <= 10000,
            "time between two questions", double(options.ask_every.count()), "10 to 10 000 ms");
  }
  ~Driver() { stop(); }
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;

  /// The start-up sequence; then the hand sends its positions.
  void connect() {
    error_.clear();
    halted_ = false;
    who_ = link_.connect(hand_);
    running_ = true;
    scale_ = TorqueScale::of(hand_.generation, hand_.full_torque, who_.gears);
    last_state_ = Clock::now() + options_.first_state - options_.give_up;
    asked_ = Clock::now();
    waited_ = true;
  }

  skinctl::Heard wait(skinctl::State<16>& state) noexcept {
    using skinctl::Heard;
    if (!running_) return fail("the hand is not connected");
    const auto now = Clock::now();
    const auto patience =
        std::chrono::duration_cast<Clock::duration>(waited_ ? period_ : period_ + period_ / 2);
    const auto lost_at = last_state_ + options_.give_up;
    const Heard heard =
        link_.next(reading_, hand_.stamps == Stamps::counted ? now + options_.give_up / 4 : now + patience);
    if (heard == Heard::lost) return fail(link_.error());
    if (const char* why = unfit(); *why != 0) {
      halted_ = true;
      return fail(why);
    }
    if (heard == Heard::silent) {
      if (Clock::now() >= lost_at) return fail("no complete positions from the hand");
      waited_ = true;
      return Heard::silent;
    }
    waited_ = false;
    last_state_ = Clock::now();
    skinctl::JointPosition<16> q;
    const double step = encoder_step(hand_.generation);
    for (std::size_t i = 0; i < 16; ++i) q[i] = step * reading_.count[i];
    odd_ |= estimator_.observe(velocity_, q, reading_.stamp);
    state = velocity_.state;
    if (last_state_ - asked_ >= options_.ask_every) {
      asked_ = last_state_;
      link_.ask();
    }
    return Heard::state;
  }

  bool send(const skinctl::TorqueCommand<16>& command) noexcept {
    if (!running_) return false;
    sent_ = scale_.encode(command.torque);
    if (link_.send(sent_)) return true;
    fail("the hand's link takes no torques");
    return false;
  }

  void stop() noexcept {
    running_ = false;
    link_.off();
  }

  /// Whether the hand itself is the reason, and not its link: its servo, temperature, motors.
  [[nodiscard]] bool halted() const noexcept { return halted_; }
  /// Number of the newest sample, for `PacketWatch`.
  [[nodiscard]] std::uint32_t packet() const noexcept { return reading_.number; }
  /// Why the hand was lost; empty while it is there.
  [[nodiscard]] const std::string& error() const noexcept { return error_; }
  [[nodiscard]] const Introduction& introduction() const noexcept { return who_; }
  [[nodiscard]] const Condition& condition() const noexcept { return link_.condition(); }
  [[nodiscard]] const TorqueScale& scale() const noexcept { return scale_; }
  /// The torques of the last command in units of the wire.
  [[nodiscard]] const std::array<std::int16_t, 16>& sent() const noexcept { return sent_; }
  [[nodiscard]] skinctl::Nanoseconds period() const noexcept { return period_; }
  [[nodiscard]] const Estimator& estimator() const noexcept { return estimator_; }
  /// Positions that the estimator refused, as reasons.
  [[nodiscard]] skinctl::Status odd() const noexcept { return odd_; }
  [[nodiscard]] Link& link() noexcept { return link_; }

 private:
  using Clock = std::chrono::steady_clock;

  skinctl::Heard fail(const char* why) noexcept {
    if (error_.empty()) error_.assign(why, std::min(std::char_traits<char>::length(why), error_.capacity()));
    return skinctl::Heard::lost;
  }

  /// Why the hand must not go on; empty: it may.
  [[nodiscard]] const char* unfit() const noexcept {
    const Condition& c = link_.condition();
    if (c.failed_motors != 0) return "a motor of the hand has failed";
    if (c.temperature > options_.hottest) return "the hand is too hot";
    if (!c.status) return "";
    if ((*c.status & status::over_temperature) != 0) return "the hand is too hot, as it says itself";
    if ((*c.status & status::communication_fault) != 0)
      return "the hand has a fault of its own communication";
    if ((*c.status & status::servo_on) == 0) return "the hand has switched its servo off";
    return "";
  }

  Link link_;
  HandOptions hand_;
  DriverOptions options_;
  skinctl::Nanoseconds period_;
  Estimator estimator_;
  typename Estimator::Memory velocity_;
  Introduction who_;
  TorqueScale scale_;
  Reading reading_;
  std::array<std::int16_t, 16> sent_{};
  skinctl::Status odd_;
  std::string error_ = std::string(80, ' ');  // its room is taken before the loop
  Clock::time_point last_state_{}, asked_{};
  bool running_ = false, waited_ = false, halted_ = false;
};

/// The tactile cells of a V5 Sense as a `SkinSource`: samples with ids 0 (the palm) to 15, all three force
/// readings alike. Readings are uncalibrated; `full_scale` is the reading that counts as 1.
template <class HandDriver>
class TactileSkin {
 public:
  /// @param palm  whether the scene has the palm's cell: a hand that is fixed to the world has not.
  explicit TactileSkin(const HandDriver& driver, bool palm, double full_scale = 1020)
      : driver_(driver), first_(palm ? 0 : 1), scale_(1 / full_scale) {
    skinctl::require(full_scale >= 1 && full_scale <= 65535, "full scale of tactile readings", full_scale,
                     "1 to 65 535");
  }
  std::span<const skinctl::CellSample> poll() noexcept {
    const Condition& c = driver_.condition();
    if (c.tactile_number == last_) return {};
    last_ = c.tactile_number;
    for (std::size_t i = 0; i < 16; ++i) {
      const auto f = static_cast<float>(std::min(1.0, c.tactile[i] * scale_));
      samples_[i] = {.time = c.tactile_stamp, .cell = static_cast<std::uint32_t>(i), .force = {f, f, f}};
    }
    return std::span<const skinctl::CellSample>(samples_).subspan(first_);
  }

 private:
  const HandDriver& driver_;
  std::size_t first_;
  double scale_;
  std::uint64_t last_ = 0;
  std::array<skinctl::CellSample, 16> samples_{};
};

}  // namespace adapters::allegro
