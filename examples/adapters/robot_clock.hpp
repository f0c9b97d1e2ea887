// Robots that are the clock: the controller sends a datagram each cycle and waits for the answer.
#pragma once

#include <array>
#include <optional>

#include "examples/adapters/clock_fault.hpp"
#include "examples/adapters/udp.hpp"
#include "skinctl/core/time.hpp"

namespace adapters {

using SixJoints = std::array<double, 6>;

/// What one datagram of a controller of N joints says.
template <std::size_t N>
struct ClockedStateOf {
  std::uint64_t number = 0;                         ///< number of the cycle, as the controller counts
  std::array<double, N> q{}, told{};                ///< measured joints, and where they were told to be [rad]
  std::uint32_t late = 0;                           ///< answers that the controller has counted as late
  bool takes = true;                                ///< whether an answer of the loop is waited for
  std::optional<SixJoints> wrench{};                ///< force and moment of a wrist sensor [N], [N m]
  std::optional<std::array<double, N>> external{};  ///< torque of the world at the joints [N m]
};
using ClockedState = ClockedStateOf<6>;

/// The bytes of a controller, and the dialogue around them. `open` may throw `ConnectionError`; the rest does
/// not.
template <class P>
concept ClockProtocol =
    requires(P& p, const P& c, std::span<const std::uint8_t> in, ClockedStateOf<P::joints>& state,
             const std::array<double, P::joints>& q, std::span<std::uint8_t> out, can::Deadline deadline) {
      p.open(deadline);
      p.close(deadline);
      { p.socket() } noexcept -> std::same_as<UdpSocket&>;
      { c.period() } noexcept -> std::same_as<skinctl::Nanoseconds>;
      {
        p.read(in, state)
      } noexcept -> std::same_as<ClockFault>;  // none: a state; why(): words for the others
      { p.answer(state.number, q, true, out) } noexcept -> std::same_as<std::size_t>;  // true: the last one
      { c.refuses(q) } noexcept -> std::same_as<const char*>;  // why this may not be sent; null: it may
      { c.why() } noexcept -> std::same_as<const char*>;
      { c.place() } -> std::same_as<std::string>;                // address and port, for words
      { P::answers_every_number } -> std::convertible_to<bool>;  // those, too, whose datagram was lost
    };

/// By joint impedance: it takes torques beside the positions of the answers that follow.
template <class P>
concept TakesTorque = requires(P& p, const std::array<double, P::joints>& torque) { p.beside(torque); };
/// Its states tell the torque of the world at the joints.
template <class P>
concept FindsTorque = requires { requires P::finds_torque; };

struct ClockOptions {
  Timeout first{5000};     ///< until the first datagrams
  Timeout give_up{150};    ///< without a datagram
  double brake_jerk = 15;  ///< with which the last answers bring a moving arm to rest [rad/s^3]
  bool real_time = true;   ///< false: a simulation that waits for its answers
};
struct ClockCounts {
  std::uint64_t states = 0, lost = 0, doubled = 0, overtaken = 0, skipped = 0, nonsense = 0;
  std::uint64_t late = 0;        ///< answers sent later than a period after their datagram
  std::uint64_t late_there = 0;  ///< the same, as the controller counts them
};

}  // namespace adapters
