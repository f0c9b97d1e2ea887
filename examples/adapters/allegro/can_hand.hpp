// An Allegro hand on a CAN bus: start-up, positions, torques, status; V4, V5 and V5 Sense.
#pragma once

#include <algorithm>
#include <utility>

#include "examples/adapters/allegro/guardian.hpp"
#include "examples/adapters/allegro/hand.hpp"
#include "examples/adapters/allegro/position_set.hpp"
#include "examples/adapters/can/link.hpp"

namespace adapters::allegro {

using can::CanLink;
using can::Deadline;

template <CanLink Link>
class CanHand {
 public:
  explicit CanHand(Link link) : link_(std::move(link)) {}

  /// Servo off, information, serial number, period of positions, servo on. Frames of an earlier session are
  /// skipped. A hand that contradicts its generation, by its hardware or by its positions, is refused before
  /// the servo is on.
  Introduction connect(const HandOptions& options) {
    options.check();
    options_ = options;
    period_ = std::chrono::milliseconds(options.period());
    set_ = PositionSet(period_);
    begun_ = Clock::now();
    judged_ = false;
    write_or_throw(servo(false, options.hand));
    Introduction who;
    who.info = ask_for<Info>(message::info, "information");
    require_generation(options, who.info);
    const Serial serial = ask_for<Serial>(message::serial, "its serial number");
    who.serial.assign(serial.text.begin(), serial.text.end());
    const bool v4 = options.generation == Generation::v4;
    who.side = agreed_side(options, v4 ? who.info.side : serial.side());
    who.gears = gears(options.generation, options.geared);
    condition_ = {};
    note(who.info);
    condition_.status.reset();                // its servo was off by our own command
    const std::uint16_t slow = v4 ? 500 : 0;  // temperatures; only a V4 has them
    write_or_throw(allegro::period(options.period(), 0, slow, options.hand));
    on_ = true;
    early_ = wait_for_set();
    if (early_ && !plausible(options.generation, set_.count())) {
      off();
      throw ConnectionError(implausible_positions);
    }
    write_or_throw(servo(true, options.hand));
    return who;
  }

  skinctl::Heard next(Reading& reading, Deadline deadline) noexcept {
    using skinctl::Heard;
    Frame frame;
    bool complete = std::exchange(early_, false);
    if (complete) tell(reading);
    for (int k = 0; k < most_frames_at_once; ++k) {
      const Read got = link_.read(frame, complete ? Clock::time_point{} : deadline);
      if (got == Read::closed) {
        error_ = "the CAN link is gone";
        return Heard::lost;
      }
      if (got == Read::nothing) break;
      if (take(frame)) {
        complete = true;
        tell(reading);
      }
    }
    if (complete && !judged_ &&
        !plausible(options_.generation, reading.count)) {  // a V5 is silent until its servo is on
      error_ = implausible_positions;
      return Heard::lost;
    }
    judged_ = judged_ || complete;
    if (complete) return Heard::state;
    set_.drop();
    ++number_;  // a set that did not come
    return Heard::silent;
  }

  /// Torques. Nothing is sent before a set of positions was plausible: to a hand of another generation the
  /// same bytes are other torques.
  bool send(const std::array<std::int16_t, 16>& value) noexcept {
    if (!judged_) return true;
    for (unsigned f = 0; f < 4; ++f)
      if (!link_.write(
              torque(f, {value[4 * f], value[4 * f + 1], value[4 * f + 2], value[4 * f + 3]}, options_.hand),
              options_.sending))
        return false;
    return true;
  }

  /// Asks for the status; the answer comes with the positions.
  void ask() noexcept {
    static_cast<void>(link_.write(request(message::info, options_.hand), options_.sending));
  }

  /// No torque, servo off twice, no more positions.
  void off() noexcept {
    if (!on_) return;
    on_ = false;
    static_cast<void>(send({}));
    for (const Frame& f :
         {servo(false, options_.hand), allegro::period(0, 0, 0, options_.hand), servo(false, options_.hand)})
      static_cast<void>(link_.write(f, options_.sending));
    link_.close();
  }

  [[nodiscard]] const Condition& condition() const noexcept { return condition_; }
  [[nodiscard]] const char* error() const noexcept { return error_; }
  [[nodiscard]] Guardian::Words last_words() const { return allegro::last_words(link_, options_.hand); }
  [[nodiscard]] int handle() const noexcept { return link_.handle(); }

 private:
  using Clock = std::chrono::steady_clock;

  void write_or_throw(const Frame& f) {
    if (!link_.write(f, options_.answer)) throw ConnectionError("the CAN link takes no frames");
  }

  template <class Answer>
  Answer ask_for(std::uint16_t what, const char* name) {
    for (unsigned t = 0; t < options_.tries; ++t) {
      write_or_throw(request(what, options_.hand));
      const auto deadline = Clock::now() + options_.answer;
      Frame frame;
      while (Clock::now() < deadline) {
        const Read got = link_.read(frame, deadline);
        if (got == Read::closed) throw ConnectionError("the CAN link is gone");
        if (got == Read::nothing) break;
        const Message m = decode(frame, options_.generation, options_.hand);
        if (const auto* answer = std::get_if<Answer>(&m)) return *answer;
      }
    }
    throw ConnectionError(
        std::string("the hand does not say ") + name + ": asked " + std::to_string(options_.tries) +
        " times, " + std::to_string(options_.answer.count()) +
        " ms each. Is it switched on, at 1 Mbit/s, and number " + std::to_string(options_.hand) + "?");
  }

  void tell(Reading& reading) const noexcept {
    reading.stamp = options_.stamps == Stamps::counted ? period_ * std::int64_t(number_) : set_.stamp();
    reading.number = number_;
    reading.count = set_.count();
  }
  /// Whether the hand sends its positions with its servo off: four periods are waited for them.
  bool wait_for_set() noexcept {
    const auto deadline = Clock::now() + 4 * period_;
    Frame frame;
    for (int k = 0; k < most_frames_at_once && link_.read(frame, deadline) == Read::some; ++k)
      if (take(frame)) return true;
    return false;
  }

  skinctl::Nanoseconds now() const noexcept {
    return options_.stamps == Stamps::counted ? period_ * std::int64_t(number_)
                                              : skinctl::Nanoseconds(Clock::now() - begun_);
  }

  void note(const Info& info) noexcept {
    condition_.status = info.status;
    condition_.temperature = info.temperature;
  }

  /// Whether this frame completed a set of positions.
  bool take(const Frame& frame) noexcept {
    // Frames that only the older layout of tactile readings has.
    const unsigned m = message_of(frame);
    if (m == message::tactile + 2u || m == message::tactile + 3u) tactile_ = TactileFrames::four;
    const Message what = decode(frame, options_.generation, options_.hand, tactile_);
    if (const auto* p = std::get_if<Positions>(&what)) {
      const std::uint64_t before = set_.incomplete();
      const auto added = set_.add(*p, now());
      number_ += static_cast<std::uint32_t>(set_.incomplete() - before);
      condition_.incomplete = set_.incomplete();
      condition_.duplicates = set_.duplicates();
      if (added != PositionSet::Added::complete) return false;
      ++number_;
      return true;
    }
    if (const auto* info = std::get_if<Info>(&what)) {
      note(*info);
    } else if (const auto* t = std::get_if<Temperature>(&what)) {
      condition_.temperature = std::max(condition_.temperature, int(std::clamp(t->celsius, -100, 1000)));
    } else if (const auto* cells = std::get_if<Tactile>(&what)) {
      for (std::size_t i = 0; i < cells->count; ++i) condition_.tactile[cells->first + i] = cells->reading[i];
      if (cells->first + cells->count == 16) {
        condition_.tactile_stamp = now();
        ++condition_.tactile_number;
      }
    } else if (const auto* c = std::get_if<Currents>(&what)) {
      for (std::size_t i = 0; i < 8; ++i) condition_.milliampere[c->first + i] = c->milliampere[i];
    } else if (std::holds_alternative<Unknown>(what)) {
      ++condition_.nonsense;
    }
    return false;
  }

  Link link_;
  HandOptions options_;
  skinctl::Nanoseconds period_ = std::chrono::milliseconds(3);
  PositionSet set_{period_};
  Clock::time_point begun_{};
  std::uint32_t number_ = 0;
  TactileFrames tactile_ = TactileFrames::two;
  Condition condition_;
  const char* error_ = "";
  bool on_ = false;      ///< it was told to send positions, or more
  bool early_ = false;   ///< a set came before the servo was on, and is not told yet
  bool judged_ = false;  ///< a set was plausible
};

}  // namespace adapters::allegro
