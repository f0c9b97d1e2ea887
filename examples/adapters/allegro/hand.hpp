// What a driver needs to know of an Allegro hand, whatever it is reached by.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "examples/adapters/allegro/frames.hpp"
#include "examples/adapters/socket.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/hardware/robot.hpp"

namespace adapters::allegro {

/// Where time stamps come from. CAN frames carry none.
enum class Stamps : std::uint8_t {
  arrival,  ///< this computer's clock
  counted   ///< one period per set of positions: for a simulation that waits for its commands
};

/// Which hand, and how long to wait for it.
struct HandOptions {
  Generation generation = Generation::v4;
  std::optional<Side> side;                ///< expected; another one is refused. None: as the hand says
  unsigned hand = 0;                       ///< its number on the bus, 0 to 3
  std::optional<std::uint16_t> period_ms;  ///< of positions; none: 2 for V5, else 3
  double full_torque = 0.7;                ///< V4: at 1200 PWM [N m]; unverified, the maker states none
  std::optional<bool> geared;              ///< V5: gears in joints 1, 5 and 9; none: see `gears`
  Timeout answer{1000};                    ///< to a request
  unsigned tries = 3;
  Timeout sending{2};  ///< for one frame or datagram
  Stamps stamps = Stamps::arrival;

  [[nodiscard]] std::uint16_t period() const noexcept {
    return period_ms.value_or(generation == Generation::v5 ? std::uint16_t(2) : std::uint16_t(3));
  }
  /// Throws `ConfigurationError` with number and range.
  void check() const {
    skinctl::require(hand <= 3, "number of the hand", hand, "0 to 3");
    skinctl::require(period() >= 1 && period() <= 100, "period of positions", period(), "1 to 100 ms");
    skinctl::require(full_torque > 0 && full_torque <= 100, "torque at 1200 PWM", full_torque,
                     "> 0, <= 100 N m");
    skinctl::require(!geared || generation != Generation::v4, "gears of a V4", geared.value_or(false),
                     "for a V5 only");
    skinctl::require(answer.count() >= 1 && answer.count() <= 60000, "time for an answer",
                     double(answer.count()), "1 to 60 000 ms");
    skinctl::require(tries >= 1 && tries <= 100, "tries", tries, "1 to 100");
    skinctl::require(sending.count() >= 1 && sending.count() <= 1000, "time for sending",
                     double(sending.count()), "1 to 1000 ms");
  }
};

/// What the hand says of itself at the start.
struct Introduction {
  Info info;
  std::string serial;  ///< empty: it gave none
  Side side = Side::right;
  Gears gears = Gears::plain;
};

/// Positions of one instant.
struct Reading {
  skinctl::Nanoseconds stamp{};
  std::uint32_t number = 0;  ///< of the sample; gaps are lost ones
  std::array<std::int16_t, 16> count{};
};

/// What else the hand has said.
struct Condition {
  std::optional<std::uint8_t> status;  ///< newest information: see `status`
  int temperature = 0;                 ///< highest that it has said of hand or fingers lately [C]
  std::uint32_t failed_motors = 0;     ///< a bit for each
  std::array<std::uint16_t, 16> tactile{};
  skinctl::Nanoseconds tactile_stamp{};
  std::uint64_t tactile_number = 0;  ///< grows with every report of the cells
  std::array<double, 16> milliampere{};
  std::uint64_t incomplete = 0;  ///< sets of positions of which a part was lost
  std::uint64_t duplicates = 0;
  std::uint64_t nonsense = 0;  ///< frames or datagrams that say nothing
};

/// A hand at the other end of a link. Connecting throws `ConnectionError`; everything else is bounded in time
/// and does not throw.
template <class H>
concept HandLink =
    requires(H& hand, const HandOptions& options, Reading& reading,
             std::chrono::steady_clock::time_point deadline, const std::array<std::int16_t, 16>& torque) {
      { hand.connect(options) } -> std::same_as<Introduction>;
      { hand.next(reading, deadline) } noexcept -> std::same_as<skinctl::Heard>;
      { hand.send(torque) } noexcept -> std::same_as<bool>;
      { hand.ask() } noexcept;
      { hand.off() } noexcept;
      { hand.condition() } noexcept -> std::same_as<const Condition&>;
      { hand.error() } noexcept -> std::same_as<const char*>;
    };

/// The newest of what one call may take off a link's queue; a flood does not hold the loop.
inline constexpr int most_frames_at_once = 256;

/// Throws `ConnectionError` for a hand of another generation than declared: its frames have the same ids and
/// other numbers in them. The upper byte of the hardware version is the generation, as the maker's drivers
/// read it; a number that they do not know is left to the first positions, see `plausible`.
inline void require_generation(const HandOptions& options, const Info& info) {
  const unsigned says = info.hardware >> 8, declared = options.generation == Generation::v4 ? 4 : 5;
  if (says < 3 || says > 5 || says == declared) return;
  const auto digit = [](unsigned x) { return "0123456789abcdef"[x & 15]; };
  throw ConnectionError(std::string("this is a V") + digit(says) + " (hardware version 0x0" + digit(says) +
                        digit(info.hardware >> 4) + digit(info.hardware) + "), a V" + digit(declared) +
                        " was expected: see --generation");
}
inline constexpr const char* implausible_positions =
    "the hand's joints stand where none can be: is it of another generation? See --generation";

/// The hand's side, or `ConnectionError` where another one was expected.
inline Side agreed_side(const HandOptions& options, Side says) {
  if (options.side && *options.side != says)
    throw ConnectionError(std::string("this is a ") + (says == Side::right ? "right" : "left") +
                          " hand, the other one was expected");
  return says;
}

}  // namespace adapters::allegro
