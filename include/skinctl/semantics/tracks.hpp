// SPDX-License-Identifier: BSD-3-Clause
// Things seen without a number: where they are, and how far to believe that they are there.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/semantics/track.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Tracks of at most `Capacity` things, without identity: a value, and pure functions of its memory.
///
/// A picture's detections go to the nearest tracks within `max_deviations` of both deviations, the nearest
/// pair first. A track is a Kalman filter of a place that wanders, and its belief a sum of log odds:
///
///     sight <- min(sight + log(d / n), c)                 if detected, d = seen_if_there, n = seen_if_not
///     sight <- max(sight + log((1 - d) / (1 - n)), -c)    if a picture should show it, and does not
///     touch <- touch + log P(fail | real)                 after a take that failed
///     P(fail | real) = (b + f) / (a + b + f + s), at least that of no take: prior counts a, b
///     c = log((1 - thing_prior) / thing_prior) = 2.94
///
/// with `s` takes that succeeded and `f` that failed, each of these weighted by the belief that was left. A
/// new track starts with -c + log(d / n) = -1.39: a single flash is not believed. The cap `c` keeps any
/// number of pictures below two failed takes: no ghost is voted up. `touch` is undone when the track moves,
/// as only real things do.
///
/// A take of a ghost fails without contact, and its detections stay in place: two such takes end the belief.
/// A take that misses a real thing touches it, or moves it. Where that happens at `places` places, with fewer
/// than `takes` successes in between, the cause is the camera or the hand: `touch` of real things does not
/// count, and the next takes go to where things are seen, then `bias_step` off along +x, -x, +y, -y, these
/// twice. Of takes without contact only `max_empty_takes` decide a try: a ghost says nothing. The offset of
/// the first success is added to `bias` (without offset: it was the places, and `touch` counts again); where
/// fewer than `takes` successes confirm it before places fail again, it is taken back, and the search goes on
/// with the next try. Without success `asks` is set once; failures before the answer do not count after it.
///
/// Immutable; what changes is a `Memory`, trivially copyable: `Memory{}` has seen nothing. Nothing allocates.
template <std::size_t Capacity, Real T = double>
class Tracks {
  static_assert(Capacity > 0 && Capacity < no_object, "1 to 254 tracks");

 public:
  static constexpr std::size_t capacity = Capacity;
  static constexpr std::uint8_t no_trial = 0, trials = 5;
  struct Memory {
    std::array<Track<T>, Capacity> tracks{};
    Xyz<T> bias{T(0), T(0), T(0)};    ///< offset from the places seen to those where hands find things [m]
    Xyz<T> failed{T(0), T(0), T(0)};  ///< place in the world at which a hand last missed a real thing [m]
    T successes = T(0);               ///< number of takes that succeeded
    T failures = T(0);                ///< number of takes that failed, weighted by the belief that was left
    Nanoseconds time{};               ///< time of the newest picture
    std::uint8_t trial = no_trial;    ///< number of the try of the search for the bias; 0: it does not search
    std::uint8_t places = 0;  ///< places where a take missed a real thing, fewer than `takes` successes apart
    std::uint8_t since = 0;   ///< takes that succeeded since a take missed a real thing
    std::uint8_t takes = 0;  ///< takes that succeeded since the bias changed, at most `takes` of the settings
    std::uint8_t found = no_trial;       ///< try whose offset was added to the bias, and is not confirmed
    std::uint8_t empty = 0;              ///< takes without contact since the try began
    std::uint8_t searches = 0;           ///< rounds of the search for the bias
    bool asks = false, started = false;  ///< a person shall look at camera and hand; a picture was seen
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit Tracks(const TrackSettings<T>& s = {}) : s_(s) {
    const auto within = [](const T& value, const char* name, double low, double high, const char* range) {
      const auto x = static_cast<double>(value);
      require(x > low && x <= high, name, x, range);
    };
    within(s.random_walk, "Tracks: random_walk", 0, 10, "> 0, <= 10 m/sqrt(s)");
    within(s.max_deviations, "Tracks: max_deviations", 0.999, 100, "1 to 100 deviations");
    within(s.seen_if_not, "Tracks: seen_if_not", 0, 0.99, "> 0, <= 0.99");
    within(s.seen_if_there, "Tracks: seen_if_there", static_cast<double>(s.seen_if_not), 0.9999,
           "> seen_if_not, <= 0.9999");
    within(s.thing_prior, "Tracks: thing_prior", 1e-6, 0.4, "> 1e-6, <= 0.4");
    require(s.keep_doubted >= 0ns && s.keep_doubted <= 9s, "Tracks: keep_doubted",
            milliseconds(s.keep_doubted), "0 to 9e3 ms");
    within(s.prior_successes, "Tracks: prior_successes", 0, 1e6, "> 0, <= 1e6 takes");
    within(s.prior_failures, "Tracks: prior_failures", 0, 1e6, "> 0, <= 1e6 takes");
    for (const T& x : {s.min_motion, s.bias_step}) within(x, "Tracks: motion, step", 0, 10, "> 0, <= 10 m");
    require(s.places >= 1 && s.takes >= 1 && s.max_empty_takes >= 1, "Tracks: counts", s.places, "1 to 255");
    using std::log;
    cap_ = log((T(1) - s.thing_prior) / s.thing_prior);
    hit_ = log(s.seen_if_there / s.seen_if_not);
    miss_ = log((T(1) - s.seen_if_there) / (T(1) - s.seen_if_not));
  }

  /// Takes a picture of the instant `time`. `shows(p_W)`: whether the picture would show a thing at `p_W`,
  /// neither hidden nor outside. A picture not later than the last (`time_backwards`) changes nothing;
  /// detections that are no numbers (`sample_not_finite`), or beyond `Capacity` (`sample_out_of_range`), are
  /// left out.
  template <class Shows>
  Status see(Memory& m, Nanoseconds time, std::span<const ClassDetection<T>> seen,
             const Shows& shows) const noexcept {
    if (!detail::is_plausible(time)) return Reason::sample_not_finite;
    if (m.started && time <= m.time) return Reason::time_backwards;
    const T dt = m.started ? seconds<T>(time - m.time) : T(0);
    m.time = time, m.started = true;
    using std::sqrt;
    for (Track<T>& t : m.tracks) t.sigma = sqrt(t.sigma * t.sigma + s_.random_walk * s_.random_walk * dt);
    Status out = seen.size() > Capacity ? Status(Reason::sample_out_of_range) : Status{};
    const std::size_t count = seen.size() < Capacity ? seen.size() : Capacity;
    Matched done;
    for (std::size_t i = 0; i < count; ++i)
      if (!is_detection(seen[i])) done.detections[i] = true, out = Reason::sample_not_finite;
    for (Pair next; (next = nearest(m, seen.first(count), done)).track < Capacity;) {
      done.detections[next.detection] = done.tracks[next.track] = true;
      update(m, m.tracks[next.track], seen[next.detection]);
    }
    for (std::size_t k = 0; k < Capacity; ++k)
      if (m.tracks[k].kind != 0 && !done.tracks[k] && shows(m.tracks[k].p)) miss(m, m.tracks[k]);
    for (std::size_t i = 0; i < count; ++i)
      if (!done.detections[i]) begin(m, seen[i], time);
    return out;
  }
  /// Index of the most believed track (above 0) with `fits(track)`; among equals that with fewest failed
  /// takes, then that of the least `cost(track)`. `no_object`: there is none. In a search for the bias only
  /// the sign of the belief counts.
  template <class Fits, class Cost>
  [[nodiscard]] std::uint8_t choose(const Memory& m, const Fits& fits, const Cost& cost) const noexcept {
    std::uint8_t best = no_object;
    T least{};
    for (std::size_t k = 0; k < Capacity; ++k) {
      const Track<T>& t = m.tracks[k];
      if (t.kind == 0 || !(belief(m, t) > T(0)) || !fits(t)) continue;
      const T c = cost(t);
      if (const Track<T>& b = m.tracks[best < Capacity ? best : k]; best < Capacity) {
        const T more = m.trial == no_trial ? belief(m, t) - belief(m, b) : T(0);
        if (more != T(0) ? more < T(0) : t.fails != b.fails ? t.fails > b.fails : !(c < least)) continue;
      }
      best = static_cast<std::uint8_t>(k), least = c;
    }
    return best;
  }
  /// Log odds that a thing is at the place of the track.
  [[nodiscard]] static T belief(const Memory& m, const Track<T>& t) noexcept {
    return m.trial != no_trial && t.real ? t.sight : t.sight + t.touch;
  }
  /// Whether pictures show a thing at the place of the track that hands have not found.
  [[nodiscard]] static bool is_doubted(const Memory& m, const Track<T>& t) noexcept {
    return t.kind != 0 && t.sight > T(0) && !(belief(m, t) > T(0));
  }
  /// The place [m] to which a hand goes for a thing seen at `p_W`: by the bias, and the try that is due.
  [[nodiscard]] Xyz<T> aim(const Memory& m, const Xyz<T>& p_W) const noexcept {
    return p_W + m.bias + tried(m.trial);
  }
  /// Reports that the take of a track succeeded: the thing that was there is in the hand.
  void took(Memory& m, std::uint8_t track) const noexcept {
    if (track >= Capacity || m.tracks[track].kind == 0) return;
    m.tracks[track] = {};
    m.successes += T(1);
    if (m.takes < s_.takes && ++m.takes == s_.takes) m.found = no_trial;
    if (++m.since >= s_.takes) m.since = m.places = 0;
    if (m.trial == no_trial) return;
    m.bias = m.bias + tried(m.trial);
    if (m.trial > 1) m.takes = 1, m.found = m.trial, give_back(m);
    m.trial = no_trial, m.places = m.since = 0;
  }
  /// Reports that the take of a track failed: a hand there has nothing. `felt`: the fingers touched something
  /// on their way or while they closed, other than each other; true for a hand that cannot tell.
  /// `fits(track)`: this hand could take that one.
  template <class Fits>
  void failed(Memory& m, std::uint8_t track, bool felt, const Fits& fits) const noexcept {
    if (track >= Capacity || m.tracks[track].kind == 0) return;
    Track<T>& t = m.tracks[track];
    if (t.fails < 255) ++t.fails;
    t.touched = t.p;
    t.real = t.real || felt;
    if (m.trial != no_trial && (t.real || ++m.empty == s_.max_empty_takes)) return try_next(m);
    using std::exp, std::log;
    // Takes fail at one place for one reason: that hands are good does not make a single failure tell more.
    const T a = s_.prior_successes, b = s_.prior_failures, least = b / (a + b);
    const T rate = (b + m.failures) / (a + b + m.failures + m.successes);
    t.touch += log(rate > least ? rate : least);
    m.failures += T(1) / (T(1) + exp(-t.sight - t.touch));
    bool fresh = false;  // where takes succeeded, only a place that is still to try can tell
    for (const Track<T>& other : m.tracks)
      fresh = fresh || (other.kind != 0 && other.fails == 0 && other.sight > T(0) && fits(other));
    if (t.real) missed(m, t.p, fresh);
  }
  /// Reports that a person has looked: `asks` is cleared, and not set again; hands are good until takes tell
  /// otherwise.
  void answered(Memory& m) const noexcept {
    m.asks = false, m.searches = max_searches;
    m.successes = m.failures = T(0);
  }

 private:
  static constexpr std::uint8_t max_searches = 2;  ///< rounds: a right try fails by chance, or at a ghost
  static constexpr std::uint8_t max_votes = 20;    ///< cap of votes: no class is wrong 20 times in a row
  struct Pair {
    std::size_t track = Capacity, detection = 0;
  };
  struct Matched {
    std::array<bool, Capacity> tracks{}, detections{};
  };
  [[nodiscard]] bool is_at(const Track<T>& t, const Xyz<T>& p) const noexcept {
    return dot(t.p - p, t.p - p) <= s_.min_motion * s_.min_motion;
  }
  /// Counts that a take missed a real thing at `p`, and begins the search for the bias if it is due.
  void missed(Memory& m, const Xyz<T>& p, bool fresh) const noexcept {
    const bool elsewhere = m.places == 0 || dot(p - m.failed, p - m.failed) > s_.min_motion * s_.min_motion;
    m.failed = p;
    if (!elsewhere || m.searches == max_searches) return;
    m.since = 0;
    if (m.places < 255) ++m.places;
    if (m.places >= s_.places && (fresh || m.takes < s_.takes)) search(m);
  }
  /// Begins the search for the bias again. An offset that a take found by chance, and that no others
  /// confirmed, is taken off the bias first: then the try after it is due.
  void search(Memory& m) const noexcept {
    m.trial = 1, m.empty = 0;
    if (m.found == no_trial) return;
    m.bias = m.bias - tried(m.found);
    m.trial = std::exchange(m.found, no_trial);
    try_next(m);
  }
  /// Goes on to the next try. After the last one all are made once more, without the first; then it asks.
  static void try_next(Memory& m) noexcept {
    m.empty = 0;
    if (++m.trial == 2) ++m.searches;
    if (m.trial <= trials) return;
    m.asks = m.searches == max_searches;
    m.trial = m.asks ? no_trial : std::uint8_t(2), m.searches = max_searches;
    if (m.asks) m.places = m.since = 0, give_back(m);
  }
  /// Undoes failures, as the hand went beside: real things are believed again, `touch` of others is halved.
  static void give_back(Memory& m) noexcept {
    for (Track<T>& t : m.tracks) t.touch = t.real ? T(0) : T(0.5) * t.touch, t.fails = 0;
  }
  /// Offset of a try [m]: along +x, -x, +y, -y from the second one on.
  [[nodiscard]] Xyz<T> tried(std::uint8_t trial) const noexcept {
    const T a = trial % 2 == 0 ? s_.bias_step : -s_.bias_step;
    if (trial < 2 || trial > trials) return {T(0), T(0), T(0)};
    return trial < 4 ? Xyz<T>{a, T(0), T(0)} : Xyz<T>{T(0), a, T(0)};
  }
  [[nodiscard]] static bool is_detection(const ClassDetection<T>& d) noexcept {
    return d.kind != 0 && dot(d.p_W, d.p_W) <= T(1e12) && d.sigma >= T(1e-6) && d.sigma <= T(100);
  }
  /// The nearest detection and track that have none yet, of all pairs within the association's radius.
  [[nodiscard]] Pair nearest(const Memory& m, std::span<const ClassDetection<T>> seen,
                             const Matched& done) const noexcept {
    Pair best;
    T least{};
    for (std::size_t k = 0; k < Capacity; ++k) {
      const Track<T>& t = m.tracks[k];
      if (t.kind == 0 || done.tracks[k]) continue;
      for (std::size_t i = 0; i < seen.size(); ++i) {
        if (done.detections[i]) continue;
        const Xyz<T> off = seen[i].p_W - t.p;
        const T square = dot(off, off), n = s_.max_deviations;
        if (square > n * n * (t.sigma * t.sigma + seen[i].sigma * seen[i].sigma)) continue;
        if (best.track == Capacity || square < least) best = {k, i}, least = square;
      }
    }
    return best;
  }
  void update(Memory& m, Track<T>& t, const ClassDetection<T>& d) const noexcept {
    using std::sqrt;
    const T older = t.sigma * t.sigma, theirs = d.sigma * d.sigma, share = older / (older + theirs);
    t.p = t.p + share * Xyz<T>(d.p_W - t.p);
    t.sigma = sqrt(share * theirs);
    t.sight = detail::smaller(T(t.sight + hit_), cap_);
    t.seen = m.time;
    if (t.votes == 0) t.kind = d.kind;
    if (d.kind != t.kind)
      --t.votes;
    else if (t.votes < max_votes)
      ++t.votes;
    if (t.fails > 0 && !is_at(t, t.touched)) moved(m, t), t.touch = T(0), t.fails = 0;
  }
  void miss(Memory& m, Track<T>& t) const noexcept {
    t.sight += miss_;
    if (t.sight >= -cap_) return;
    t.sight = -cap_;
    if (t.fails > 0 && m.time - t.seen <= s_.keep_doubted) return;
    if (t.fails > 0) moved(m, t);
    t = {};
  }
  /// Takes a thing that a take missed, and that has moved, for real, though no finger felt it.
  void moved(Memory& m, Track<T>& t) const noexcept {
    if (!std::exchange(t.real, true)) m.trial == no_trial ? missed(m, t.touched, false) : try_next(m);
  }
  /// Begins a track, in a free place or in that of the least believed one that was not seen now.
  void begin(Memory& m, const ClassDetection<T>& d, Nanoseconds time) const noexcept {
    Track<T>* place = nullptr;
    T least = hit_ - cap_;
    for (Track<T>& t : m.tracks) {
      const T sight = t.kind == 0 ? T(-2) * cap_ : t.seen < time ? t.sight : cap_;
      if (sight <= least) place = &t, least = sight;
    }
    if (place == nullptr) return;
    *place = {.p = d.p_W, .sigma = d.sigma, .sight = hit_ - cap_, .seen = time, .kind = d.kind, .votes = 1};
  }
  TrackSettings<T> s_;
  T cap_{}, hit_{}, miss_{};
};

SKINCTL_END_NAMESPACE
