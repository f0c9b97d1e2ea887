// SPDX-License-Identifier: BSD-3-Clause
// Places that several robots share: at most one of them is in a place, in the order in which they asked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A robot's request for shared places in a cycle.
struct PlaceRequest {
  std::uint8_t wants = 255;  ///< place that the robot needs next; 255: none
  std::uint32_t leaves = 0;  ///< bit k: the robot does not need place k any more; it leaves once it is away
  bool step_failed =
      false;  ///< the step failed or asks a person: places that the robot is away from become free
  std::uint32_t away = ~std::uint32_t(0);  ///< bit k: the robot is away from place k
};

/// Shared places: `Places` of them, for `Robots` robots.
///
/// - A place has one holder. It is granted to the one that has waited longest (robots that ask in the same
///   cycle: the lower number), and stays granted until the holder leaves it and is away from it.
/// - One order: a robot that holds a place may ask for places with higher numbers only; other requests are
///   `refused`. So no circle of robots can wait for each other.
/// - A robot that fails releases what it is away from; where it stands it keeps, so that nobody drives into
///   it.
/// - A place that has been held for longer than `timeout` is `overdue`: its holder's executor is to fail. It
///   is not taken away.
template <std::size_t Places, std::size_t Robots>
class Resources {
  static_assert(Places > 0 && Places <= 32 && Robots > 0 && Robots < 255);

 public:
  static constexpr std::uint8_t nobody = 255;
  struct Memory {
    std::array<std::uint8_t, Places> holder{};  ///< robot that holds each place; `nobody`: free
    std::array<Nanoseconds, Places> since{};    ///< time at which each place was granted
    std::array<std::uint8_t, Robots> wants{};   ///< place that each robot asks for; 255: none
    std::array<Nanoseconds, Robots> waits_since{};
  };
  struct Grant {
    bool granted = false;     ///< the robot holds the place that it wants, or wants none
    bool refused = false;     ///< the requested place is lower than one held, or does not exist
    bool overdue = false;     ///< the robot holds a place for too long
    std::uint32_t holds = 0;  ///< bit k: the robot holds place k
  };
  struct Result {
    std::array<Grant, Robots> grants;  ///< answers to the robots' requests
    Memory memory;
  };

  /// Throws `ConfigurationError` unless `timeout` is in (0, 1e5] s.
  SKINCTL_COLD explicit Resources(Nanoseconds timeout = 60s) : timeout_(timeout) {
    require(timeout > 0ns && timeout <= 100000s, "Resources: timeout", milliseconds(timeout),
            "> 0, <= 1e8 ms");
  }
  [[nodiscard]] Memory start() const noexcept {
    Memory m{};
    m.holder.fill(nobody);
    m.wants.fill(255);
    return m;
  }

  [[nodiscard]] Result step(Memory m, Nanoseconds now,
                            const std::array<PlaceRequest, Robots>& asked) const noexcept {
    Result out{{}, m};
    Memory& next = out.memory;
    for (std::size_t r = 0; r < Robots; ++r) {
      const PlaceRequest& a = asked[r];
      const std::uint32_t leaves = (a.step_failed ? a.away : a.leaves & a.away);
      for (std::size_t k = 0; k < Places; ++k)
        if (next.holder[k] == r && ((leaves >> k) & 1u) != 0 && (a.step_failed || a.wants != k))
          next.holder[k] = nobody;
      const bool allowed = a.wants < Places && !a.step_failed && !holds_from(next, r, a.wants + 1u);
      out.grants[r].refused = a.wants != 255 && !a.step_failed && !allowed;
      const std::uint8_t wants = allowed ? a.wants : std::uint8_t(255);
      if (wants != next.wants[r]) next.waits_since[r] = now;
      next.wants[r] = wants;
    }
    for (std::size_t k = 0; k < Places; ++k) {
      if (next.holder[k] != nobody) continue;
      for (std::size_t r = 0; r < Robots; ++r)
        if (next.wants[r] == k &&
            (next.holder[k] == nobody || next.waits_since[r] < next.waits_since[next.holder[k]]))
          next.holder[k] = static_cast<std::uint8_t>(r);
      if (next.holder[k] != nobody) next.since[k] = now;
    }
    for (std::size_t r = 0; r < Robots; ++r) {
      Grant& g = out.grants[r];
      for (std::size_t k = 0; k < Places; ++k)
        if (next.holder[k] == r) {
          g.holds |= 1u << k;
          g.overdue = g.overdue || now - next.since[k] >= timeout_;
        }
      g.granted = !g.refused && (next.wants[r] == 255 || ((g.holds >> next.wants[r]) & 1u) != 0);
    }
    return out;
  }

 private:
  static bool holds_from(const Memory& m, std::size_t robot, std::size_t place) noexcept {
    for (std::size_t k = place; k < Places; ++k)
      if (m.holder[k] == robot) return true;
    return false;
  }
  Nanoseconds timeout_;
};

SKINCTL_END_NAMESPACE
