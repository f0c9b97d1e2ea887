// SPDX-License-Identifier: BSD-3-Clause
// A gentle motion that shows how a robot answers commands.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A motion that shows how a robot answers: each joint swings about its start with two frequencies of its
/// own, begins and ends at rest, and keeps within amplitude and speed.
template <std::size_t N>
class ResponseMotion {
 public:
  struct Settings {
    double amplitude = 0.15;  ///< largest distance of a joint from its start [rad], 0.001 to 1
    double speed = 0.4;       ///< largest speed of a joint [rad/s], 0.001 to 10
    double duration = 15;     ///< duration of the motion [s], 5 to 600
  };
  /// Throws `ConfigurationError` for a number out of its range.
  ResponseMotion(const std::array<double, N>& start, const Settings& s) : start_(start), s_(s) {
    require(s.amplitude >= 1e-3 && s.amplitude <= 1, "amplitude", s.amplitude, "0.001 to 1 rad");
    require(s.speed >= 1e-3 && s.speed <= 10, "speed", s.speed, "0.001 to 10 rad/s");
    require(s.duration >= 5 && s.duration <= 600, "duration", s.duration, "5 to 600 s");
  }
  explicit ResponseMotion(const std::array<double, N>& start) : ResponseMotion(start, Settings{}) {}

  [[nodiscard]] const Settings& settings() const noexcept { return s_; }
  /// The commanded joint positions [rad] at `t` [s] after the start of the motion.
  [[nodiscard]] std::array<double, N> at(double t) const noexcept {
    const auto rise = [](double r) {
      return r <= 0 ? 0 : (r >= 1 ? 1 : r * r * r * (10 + r * (6 * r - 15)));
    };
    // It rests for a second at both ends: noise, resolution and gap are seen there.
    const double grown = rise((t - 1) / 2) * rise((s_.duration - 1 - t) / 2);
    std::array<double, N> q = start_;
    for (std::size_t i = 0; i < N; ++i) {
      const double slow = 1.5 + 0.23 * double(i % 8), fast = 3.7 * slow;
      const double size = std::min(s_.amplitude / 1.25, s_.speed / (slow + 0.25 * fast + 1.2));
      q[i] += grown * size * (std::sin(slow * t) + 0.25 * std::sin(fast * t));
    }
    return q;
  }

 private:
  std::array<double, N> start_;
  Settings s_;
};

SKINCTL_END_NAMESPACE
