// Messages of a sender whose clock is not the robot's, over a network that delays, loses and swaps them.
#pragma once

#include <cstdint>
#include <map>

#include "skinctl/core/time.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// A sender's clock and the way of its messages. `next()` gives them in the order of their arrival, and the
/// truth beside them.
class SkewedClock {
 public:
  struct Settings {
    Nanoseconds period = 1ms;      ///< between two messages
    double ppm = 0;                ///< the sender's clock gains so many microseconds in each second
    Nanoseconds offset = 0ns;      ///< the sender's clock when the robot's shows 0
    Nanoseconds min_delay = 0ns;   ///< of a message
    Nanoseconds jitter = 0ns;      ///< beyond it: uniform from 0 to this
    double lost = 0, swapped = 0;  ///< share of messages that never arrive; that others overtake
    bool queued = false;           ///< no message overtakes another by jitter: it waits for the one before
    Nanoseconds leap = 0ns, leap_at = Nanoseconds::max();  ///< the clock is set by `leap` then
    double changed_ppm = 0;
    Nanoseconds changes_at = Nanoseconds::max();  ///< then it has this rate
  };
  struct Message {
    Nanoseconds sent{};     ///< by the sender's clock
    Nanoseconds truth{};    ///< the same instant by the robot's
    Nanoseconds arrived{};  ///< by the robot's
  };

  SkewedClock(const Settings& settings, std::uint64_t seed) : s_(settings), random_(seeded(seed)) {}

  /// The sender's clock when the robot's shows `t`.
  [[nodiscard]] Nanoseconds shows(Nanoseconds t) const {
    const Nanoseconds before = t < s_.changes_at ? t : s_.changes_at;
    const double gained = seconds<double>(before) * s_.ppm + seconds<double>(t - before) * s_.changed_ppm;
    return t + s_.offset + nanoseconds(1e-6 * gained) + (t >= s_.leap_at ? s_.leap : 0ns);
  }

  [[nodiscard]] Message next() {
    // A message that is still to be sent arrives after this time.
    while (way_.empty() || way_.begin()->first >= now_ + s_.period + s_.min_delay) send();
    const Message out = way_.begin()->second;
    way_.erase(way_.begin());
    return out;
  }

 private:
  void send() {
    do now_ += s_.period;
    while (uniform(random_, 0.0, 1.0) < s_.lost);
    const Nanoseconds delay =
        s_.min_delay + nanoseconds(seconds<double>(s_.jitter) * uniform(random_, 0.0, 1.0));
    Nanoseconds arrived = now_ + delay;
    if (s_.queued && arrived < last_) arrived = last_;
    if (uniform(random_, 0.0, 1.0) < s_.swapped)
      arrived += s_.period + s_.jitter;
    else
      last_ = arrived;
    way_.emplace(arrived, Message{shows(now_), now_, arrived});
  }

  Settings s_;
  Random random_;
  Nanoseconds now_{}, last_{};
  std::multimap<Nanoseconds, Message> way_;  ///< sent, not arrived
};

}  // namespace skinctl::testing
