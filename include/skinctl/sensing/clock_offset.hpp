// SPDX-License-Identifier: BSD-3-Clause
// The clock of a sensor, brought together with the robot's.
#pragma once

#include <array>
#include <cstddef>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Offset (the robot's time less the sender's) and rate of a robot's clock against a sender's, from messages
/// that say when they were sent.
///
/// `arrived - sent` is the offset plus the delay of a message, so the least of many is the offset plus the
/// least delay, which is declared. Each second of the sender's clock gives one point: its least difference.
/// Of the lower convex hull of 30 such points, the edge over their mean time is the line of offset and rate,
/// within `max_rate`. Stamps follow that line at `slew`, so that the map from the sender's time to the
/// robot's rises everywhere: no stamp runs back.
///
/// Clocks within 200 ppm are followed for good; a minimum that is let rise at a fixed rate loses those that
/// drift faster. A change of rate by r is followed after half a window; until then stamps are off by up to r
/// times 15 s if the difference turns upwards.
///
/// Messages may be lost, repeated or overtaken. The sender's clock is taken to have leapt, and everything
/// begins anew with `gather`, if a message
/// - would have arrived more than `ahead` before it was sent,
/// - was sent more than `overtaken` before one that has arrived,
/// - would have been under way for more than 10 s longer or less than the oldest one that counts, or
/// - ends a second in which none of at least 10 came within `late` of the line (a leap back of less than
///   `overtaken`, or another path through the network); or after a silence of 30 s.
///
/// In the first second after a beginning, a message that was faster than all before by up to `gather` makes
/// everything begin anew, too, and is no leap: the first ones were slow, as of a network that wakes up.
class ClockOffset {
 public:
  struct Settings {
    Nanoseconds min_delay =
        0ns;  ///< the time that the fastest message takes; what is not declared stays in the stamps
    Nanoseconds gather = 100ms;  ///< time by either clock for which messages are heard before the first stamp
    Nanoseconds ahead = 1ms, overtaken = 20ms, late = 5ms;  ///< times by which leaps are told, see the class
  };
  static constexpr std::size_t window = 30;  ///< number of seconds of the window
  static constexpr double max_rate = 200e-6, slew = 500e-6;

  /// The result of a message.
  enum class Heard : unsigned char {
    refused,    ///< a time beyond +-73 years: not taken
    gathering,  ///< `stamp` gives no stamps yet
    tied,       ///< `stamp` gives stamps
    leapt       ///< the sender's clock leapt: begins anew with this message
  };

  struct Point {
    Nanoseconds sent{}, difference{};  ///< sender's time of a message, and `arrived - sent`
  };
  /// A piece of the map from the sender's time to the robot's, from the sender's time `at` on: to add are
  /// `offset + rate t + error`, t since `at`, with an error that goes to 0 at `slew`.
  struct Piece {
    Nanoseconds at{}, offset{};
    double rate = 0, error = 0;  ///< rate of the offset [s/s]; error at `at` [ns], which goes to 0
  };
  /// Trivially copyable; `Memory{}` has heard nothing.
  struct Memory {
    std::array<Point, window + 1> points{};  ///< fastest message of each second, the newest last
    std::size_t count = 0;
    std::size_t messages = 0;       ///< messages in the present second
    std::array<Piece, 4> pieces{};  ///< pieces of the map, the newest first
    std::size_t pieces_count = 0;   ///< number of pieces; 0: no stamps yet
    Nanoseconds began{};            ///< beginning of the present second
    Nanoseconds first_arrived{};    ///< robot's time when the first message since the start or a leap arrived
    Nanoseconds newest{};           ///< time at which the newest message was sent
    bool near = false;              ///< whether a message of this second came within `late` of the line
    std::size_t leaps = 0;          ///< leaps since the start
  };

  ClockOffset() : ClockOffset(Settings{}) {}
  /// Throws `ConfigurationError` unless `min_delay` and `gather` are in [0, 1] s, `ahead`, `overtaken` and
  /// `late` in (0, 1] s.
  explicit ClockOffset(const Settings& s) : s_(s) {
    const auto check = [](const char* name, Nanoseconds t, bool may_be_zero) {
      require((t > 0ns || (may_be_zero && t == 0ns)) && t <= 1s, name, milliseconds(t),
              may_be_zero ? "0 to 1000 ms" : "> 0, <= 1000 ms");
    };
    check("ClockOffset: min_delay", s.min_delay, true);
    check("ClockOffset: gather", s.gather, true);
    check("ClockOffset: ahead", s.ahead, false);
    check("ClockOffset: overtaken", s.overtaken, false);
    check("ClockOffset: late", s.late, false);
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// Takes one message: when it was sent, by the sender's clock, and when it arrived, by the robot's. Bounded
  /// time: eight times a second all points are looked at.
  Heard hear(Memory& m, Nanoseconds sent, Nanoseconds arrived) const noexcept {
    constexpr Nanoseconds far(std::int64_t(1) << 61);
    if (sent <= -far || sent >= far || arrived <= -far || arrived >= far) return Heard::refused;
    const Nanoseconds difference = arrived - sent - s_.min_delay;
    if (m.count == 0) {
      begin(m, {sent, difference}, arrived);
      return tie(m, arrived) ? Heard::tied : Heard::gathering;
    }
    if (leaps(m, sent, difference)) {
      const bool first_ones_slow = faster_than_first(m, sent, difference);
      begin(m, {sent, difference}, arrived);
      if (!first_ones_slow) ++m.leaps;
      const bool tied = tie(m, arrived);
      return !first_ones_slow ? Heard::leapt : tied ? Heard::tied : Heard::gathering;
    }
    if (sent > m.newest) m.newest = sent;
    Point& present = m.points[m.count - 1];
    if (difference < present.difference) present = {sent, difference};
    ++m.messages;
    if (!ready(m)) return tie(m, arrived) ? Heard::tied : Heard::gathering;
    if (difference <= offset(m, sent) + s_.late) m.near = true;
    if (m.newest - m.pieces[0].at >= 125ms) revise(m);
    if (m.newest - m.began >= 1s) next_second(m, {sent, difference});
    return Heard::tied;
  }

  /// Whether `stamp` can give stamps.
  [[nodiscard]] static bool ready(const Memory& m) noexcept { return m.pieces_count != 0; }
  /// The robot's time when the sender's clock shows `t`; requires `ready`. For `t` up to the newest message
  /// and 0.3 s before it, it does not run back: neither from one `t` to a later one, nor to what was given
  /// before, a leap of the clock excepted.
  [[nodiscard]] static Nanoseconds stamp(const Memory& m, Nanoseconds t) noexcept {
    SKINCTL_EXPECTS(ready(m), "a clock that is tied");
    return t + offset(m, t);
  }
  /// Rate of the offset [s/s]: the robot's seconds for each of the sender's, less 1.
  [[nodiscard]] static double rate(const Memory& m) noexcept { return ready(m) ? m.pieces[0].rate : 0; }

 private:
  static double count(Nanoseconds t) noexcept { return static_cast<double>(t.count()); }
  static Nanoseconds rounded(double ns) noexcept {
    return Nanoseconds(static_cast<std::int64_t>(ns < 0 ? ns - 0.5 : ns + 0.5));
  }
  static double size(double x) noexcept { return x < 0 ? -x : x; }

  /// Robot's time less sender's at the sender's time `t`.
  static Nanoseconds offset(const Memory& m, Nanoseconds t) noexcept {
    std::size_t k = 0;
    while (k + 1 < m.pieces_count && t < m.pieces[k].at) ++k;
    const Piece& p = m.pieces[k];
    const double since = count(t - p.at);
    const double left = size(p.error) - (since > 0 ? slew * since : 0);
    const double error = left > 0 ? (p.error < 0 ? -left : left) : 0;
    return p.offset + rounded(p.rate * since + error);
  }

  void begin(Memory& m, const Point& first, Nanoseconds arrived) const noexcept {
    const std::size_t leaps_so_far = m.leaps;
    m = {};
    m.leaps = leaps_so_far;
    m.first_arrived = arrived;
    m.points[0] = first;
    m.count = m.messages = 1;
    m.began = m.newest = first.sent;
  }
  [[nodiscard]] bool leaps(const Memory& m, Nanoseconds sent, Nanoseconds difference) const noexcept {
    if (sent < m.newest - s_.overtaken || sent > m.newest + std::chrono::seconds(window)) return true;
    if (size(count(difference) - count(m.points[0].difference)) > 1e10)
      return true;  // no sum overflows below
    if (!ready(m)) return false;
    if (difference < offset(m, sent) - s_.ahead) return true;
    return sent - m.began >= 1s && m.messages >= 10 && !m.near && difference > offset(m, sent) + s_.late;
  }
  [[nodiscard]] bool faster_than_first(const Memory& m, Nanoseconds sent,
                                       Nanoseconds difference) const noexcept {
    if (!ready(m) || m.count > 1 || sent < m.newest - s_.overtaken || sent >= m.began + 1s) return false;
    const Nanoseconds early = offset(m, sent) - difference;
    return early > s_.ahead && early <= s_.gather;
  }
  /// Begins the map at the least difference so far, once enough was gathered; whether it did. By the robot's
  /// clock, too: of messages that had waited to be read only the newest tells the delay.
  [[nodiscard]] bool tie(Memory& m, Nanoseconds arrived) const noexcept {
    if (arrived < m.first_arrived) m.first_arrived = arrived;
    if (m.newest - m.began < s_.gather || arrived - m.first_arrived < s_.gather) return false;
    m.pieces[0] = {m.newest, m.points[m.count - 1].difference, 0, 0};
    m.pieces_count = 1;
    m.near = true;
    return true;
  }
  void next_second(Memory& m, const Point& first) const noexcept {
    if (m.count == m.points.size()) {
      for (std::size_t i = 1; i < m.count; ++i) m.points[i - 1] = m.points[i];
      --m.count;
    }
    m.points[m.count++] = first;
    m.began = m.newest;
    m.messages = 1;
    m.near = ready(m) && first.difference <= offset(m, first.sent) + s_.late;
  }

  /// Adds a piece to the map: the newest line, with the error at which the map is now.
  void revise(Memory& m) const noexcept {
    const Nanoseconds now = m.newest, old = offset(m, now);
    // The present second has not seen its fastest message yet: it counts where it lies below the others'
    // line.
    const Line line = lower_edge(m, now);
    for (std::size_t k = m.pieces.size() - 1; k > 0; --k) m.pieces[k] = m.pieces[k - 1];
    if (m.pieces_count < m.pieces.size()) ++m.pieces_count;
    m.pieces[0] = {now, line.offset, line.rate, count(old - line.offset)};
  }
  struct Line {
    Nanoseconds offset;  ///< offset at the time asked for
    double rate;
  };
  /// The edge over the mean time of the lower convex hull of all points, at the sender's time `now`.
  static Line lower_edge(const Memory& m, Nanoseconds now) noexcept {
    // Seconds are short of each other by design: x in [ns] before now, y in [ns] above the first.
    const Nanoseconds base = m.points[0].difference;
    std::array<double, window + 1> x, y;
    std::array<std::size_t, window + 1> hull;
    std::size_t n = 0, h = 0;
    double mean = 0;
    for (std::size_t i = 0; i < m.count; ++i) {
      if (now - m.points[i].sent > std::chrono::seconds(window + 1)) continue;
      x[n] = count(m.points[i].sent - now);
      y[n] = count(m.points[i].difference - base);
      mean += x[n++];
    }
    if (n == 0)
      return {m.pieces[0].offset + rounded(m.pieces[0].rate * count(now - m.pieces[0].at)), m.pieces[0].rate};
    mean /= static_cast<double>(n);
    const auto above = [&](std::size_t a, std::size_t b, std::size_t c) {
      return (y[b] - y[a]) * (x[c] - x[a]) >= (y[c] - y[a]) * (x[b] - x[a]);
    };
    for (std::size_t i = 0; i < n; ++i) {
      // Of two messages overtaken across the end of a second, the later point is left out.
      if (h > 0 && !(x[i] > x[hull[h - 1]])) continue;
      while (h >= 2 && above(hull[h - 2], hull[h - 1], i)) --h;
      hull[h++] = i;
    }
    std::size_t k = 0;
    while (k + 2 < h && x[hull[k + 1]] < mean) ++k;
    const std::size_t a = hull[k], b = hull[h > 1 ? k + 1 : k];
    // Two points next to each other say nothing of the rate.
    double rate = x[b] - x[a] >= 0.5e9 ? (y[b] - y[a]) / (x[b] - x[a]) : 0;
    if (x[b] - x[a] < 0.5e9 && m.pieces_count != 0) rate = m.pieces[0].rate;
    rate = rate > max_rate ? max_rate : (rate < -max_rate ? -max_rate : rate);
    // Through the lowest of them under the slope: no point lies below.
    double least = y[a] - rate * x[a];
    for (std::size_t i = 0; i < n; ++i) {
      const double level = y[i] - rate * x[i];
      if (level < least) least = level;
    }
    return {base + rounded(least), rate};
  }

  Settings s_;
};

SKINCTL_END_NAMESPACE
