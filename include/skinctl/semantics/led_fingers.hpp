// SPDX-License-Identifier: BSD-3-Clause
// How the fingers of a hand were led: how they stood before they were closed, around an object, and after it
// was let go.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "skinctl/core/joint.hpp"
#include "skinctl/semantics/bit.hpp"
#include "skinctl/semantics/demonstration.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One cycle of fingers that a person leads.
/// @tparam N  joints of the hand.  @tparam F  its fingertips.
template <std::size_t N, std::size_t F>
struct LedFingersSample {
  Nanoseconds time{};
  JointPosition<N> q;             ///< [rad]
  std::array<double, F> touch{};  ///< force of each fingertip on the object [N]
};

/// A step that the fingers were led through.
template <std::size_t N, std::size_t F>
struct TaughtFingers {
  Activity activity = Activity::unknown;  ///< take or release
  Nanoseconds time{};                     ///< time at which the fingers closed, or opened
  JointPosition<N> before;                ///< posture before `time` [rad]
  JointPosition<N> q;                     ///< posture after `time` [rad]
  std::array<double, F> force{};          ///< force of each fingertip in the posture `q` [N]
};

/// Numbers of a `LedFingersReader`.
struct LedFingersSettings {
  /// Thresholds of the second largest force of a fingertip [N]: above them the hand holds something.
  Bit<>::Settings holds{0.5, 0.25, 16ms, 32ms};
  double within = 0.02;          ///< fingers stand while no joint moves by more than this [rad], ...
  Nanoseconds min_rest = 200ms;  ///< ... for at least this long
};

/// Reads how fingers are led, cycle by cycle.
///
/// - The hand is closed while two fingertips press on what is between them: one that a person pushes against
///   an object that lies there holds nothing. That bit is the switch of the arm's `DemonstrationReader`, so
///   nobody has to reach for a button, and the two readers agree on when something was taken.
/// - The fingers stand while no joint leaves `within` for `least`. Their posture is the median of that
///   stretch, joint by joint.
/// - Taking is taught by the first stand of the closed hand, with the median force of each fingertip; letting
///   go by the first stand of the open hand. A hand that did not stand before it closed or opened, or does
///   not stand afterwards, teaches nothing.
///
/// It keeps the samples of a stretch: it allocates, and belongs beside the loop.
template <std::size_t N, std::size_t F>
class LedFingersReader {
  static_assert(F >= 2, "a hand holds with two fingertips");

 public:
  using Sample = LedFingersSample<N, F>;
  using Taught = TaughtFingers<N, F>;

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit LedFingersReader(const LedFingersSettings& s = {}) : s_(s), holds_(s.holds) {
    require(s.holds.off > 0, "LedFingers: holds.off", s.holds.off, "> 0 N");
    require(s.within > 0 && s.within <= 1, "LedFingers: within", s.within, "> 0, <= 1 rad");
    require(s.min_rest > 0ns && s.min_rest <= 60s, "LedFingers: min_rest", milliseconds(s.min_rest),
            "> 0, <= 6e4 ms");
  }

  /// Takes a sample. One that is not finite or not later than the last one is ignored.
  void take(const Sample& x) {
    double sum = 0;
    for (std::size_t i = 0; i < N; ++i) sum += x.q[i];
    for (const double f : x.touch) sum += f;
    if (!(sum - sum == 0) || (started_ && x.time <= last_)) return;
    auto touch = x.touch;
    std::nth_element(touch.begin(), touch.begin() + 1, touch.end(), std::greater<>());
    const bool was = bit_.on;
    if (holds_.step(bit_, x.time, touch[1]).any()) return;
    if (was != bit_.on) {
      end_of_stand();
      pending_ = stood_;
      next_ = Taught{};
      next_.activity = bit_.on ? Activity::take : Activity::release;
      next_.time = x.time;
      next_.before = stands_;
    }
    for (std::size_t i = 0; i < N && !stretch_.empty(); ++i)
      if (std::abs(x.q[i] - stretch_.front().q[i]) > s_.within) end_of_stand();
    stretch_.push_back(x);
    last_ = x.time;
    started_ = true;
  }
  /// Whether they hold something between them.
  [[nodiscard]] bool closed() const { return bit_.on; }
  /// The end of the demonstration: what was taught, in order.
  [[nodiscard]] std::vector<Taught> finish() {
    end_of_stand();
    return std::move(taught_);
  }

 private:
  void end_of_stand() {
    if (!stretch_.empty() && last_ - stretch_.front().time >= s_.min_rest) {
      std::vector<double> values(stretch_.size());
      const auto median_of = [&](const auto& value) {
        std::transform(stretch_.begin(), stretch_.end(), values.begin(), value);
        return detail::median(values);
      };
      for (std::size_t i = 0; i < N; ++i) stands_[i] = median_of([&](const Sample& x) { return x.q[i]; });
      stood_ = true;
      if (pending_) {
        next_.q = stands_;
        for (std::size_t f = 0; f < F; ++f)
          next_.force[f] = median_of([&](const Sample& x) { return x.touch[f]; });
        taught_.push_back(next_);
        pending_ = false;
      }
    }
    stretch_.clear();
  }

  LedFingersSettings s_;
  Bit<> holds_;
  Bit<>::Memory bit_{};
  std::vector<Sample> stretch_;
  std::vector<Taught> taught_;
  Taught next_{};
  JointPosition<N> stands_;
  Nanoseconds last_{};
  bool stood_ = false, pending_ = false, started_ = false;
};

SKINCTL_END_NAMESPACE
