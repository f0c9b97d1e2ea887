// The force of a cell over time, from all of its samples at once, by definition: the oracle for what a skin
// makes of them cycle by cycle.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "skinctl/core/time.hpp"

namespace skinctl::testing {

/// What passed the gates of one cell at one time [N].
struct Knot {
  Nanoseconds time;
  double force;
};

/// The law that `Skin` states: held after each sample, fading from `max_age - fade` on, changing linearly
/// within at most `ramp` before the next sample. Samples in order.
class CellSignal {
 public:
  CellSignal(std::vector<Knot> knots, Nanoseconds max_age, Nanoseconds fade, Nanoseconds ramp)
      : knots_(std::move(knots)), max_age_(max_age), fade_(fade), ramp_(ramp) {}

  [[nodiscard]] long double at(long double t) const {
    const auto after =
        std::find_if(knots_.begin(), knots_.end(), [&](const Knot& k) { return count(k.time) > t; });
    const Knot* last = after == knots_.begin() ? nullptr : &*(after - 1);
    if (after == knots_.end()) return last ? faded(*last, t) : 0.0L;
    const long double turn = turn_before(last, *after);
    if (t <= turn) return last ? faded(*last, t) : 0.0L;
    const long double from = last ? faded(*last, turn) : 0.0L;
    const long double share = (t - turn) / (count(after->time) - turn);
    return from + share * (static_cast<long double>(after->force) - from);
  }

  /// Integral from `a` to `b` [N s]: between its corners the force is linear, so the value in the middle of
  /// each piece tells all.
  [[nodiscard]] long double impulse(Nanoseconds a, Nanoseconds b) const {
    std::vector<long double> corners = {count(a), count(b)};
    for (std::size_t k = 0; k < knots_.size(); ++k) {
      const auto t = count(knots_[k].time);
      corners.push_back(t);
      corners.push_back(t + count(max_age_ - fade_));
      corners.push_back(t + count(max_age_));
      corners.push_back(turn_before(k > 0 ? &knots_[k - 1] : nullptr, knots_[k]));
    }
    std::sort(corners.begin(), corners.end());
    long double sum = 0;
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
      const long double lower = std::max(corners[k], count(a));
      const long double upper = std::min(corners[k + 1], count(b));
      if (upper > lower) sum += (upper - lower) * 1e-9L * at(0.5L * (lower + upper));
    }
    return sum;
  }

 private:
  /// Nanoseconds as a number.
  [[nodiscard]] static long double count(Nanoseconds t) { return static_cast<long double>(t.count()); }
  [[nodiscard]] long double turn_before(const Knot* last, const Knot& next) const {
    const auto turn = count(next.time) - count(ramp_);
    return last ? std::max(turn, count(last->time)) : turn;
  }
  [[nodiscard]] long double faded(const Knot& k, long double t) const {
    const long double left = (count(max_age_) - (t - count(k.time))) / count(fade_);
    return static_cast<long double>(k.force) * std::clamp(left, 0.0L, 1.0L);
  }
  std::vector<Knot> knots_;
  Nanoseconds max_age_, fade_, ramp_;
};

}  // namespace skinctl::testing
