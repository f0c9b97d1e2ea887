// SPDX-License-Identifier: BSD-3-Clause
// A whole recording of a led hand, cut where contact and motion change, by the recording's own noise.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "skinctl/semantics/detail/recorded_signal.hpp"
#include "skinctl/semantics/world.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One sample of a recorded demonstration.
template <Frame W = World>
struct ShownSample {
  Nanoseconds time{};
  Transform<W, Tool> X_WH{};
  double force = 0;  ///< force of the fingers on the object [N]
  /// Opening of the fingers [m]; NaN: nothing measures it.
  double opening = std::numeric_limits<double>::quiet_NaN();
};

/// A squeeze: the object in hand is pressed harder for a while, and the hand stands.
struct ShownSqueeze {
  Span span{};
  double felt =
      std::numeric_limits<double>::quiet_NaN();  ///< stiffness of the object [N/m]; NaN: not measured
};
/// A contact: the span in which something is between the fingers, and the squeezes in it.
struct ShownContact {
  Span span{};
  std::vector<ShownSqueeze> squeezes;
};
/// A recording in segments, and the numbers by which it was cut.
struct Segments {
  std::vector<ShownContact> contacts;
  std::vector<char> moving;    ///< 1: the hand moves; one per sample
  std::vector<Xyz<double>> p;  ///< smoothed positions of the hand [m]; one per sample
  double smoothing = 0;        ///< deviation of the Gaussian that smooths the positions [s]
  double fast = 0;             ///< 90 % quantile of the speed [m/s]
  double noise = 0;            ///< root mean square of the noise of the velocity [m/s]
  double grip = 0;             ///< typical force while something is in hand [N]
  double force_noise = 0;      ///< deviation of the force from sample to sample [N]
  double stands = 0;           ///< largest speed about a change of contact, median of all [m/s]
  double moves_on = 0;         ///< speed above which a hand moves [m/s]
};

namespace detail {
/// Cuts one recording.
class Cutter {
 public:
  template <Frame W>
  explicit Cutter(const std::vector<ShownSample<W>>& samples) {
    const Nanoseconds begun = samples.front().time;
    std::vector<Xyz<double>> p;
    for (const auto& x : samples) {
      at_.push_back(seconds<double>(x.time - begun));
      p.push_back(x.X_WH.origin());
      force_.push_back(x.force);
      opening_.push_back(x.opening);
    }
    smooth(p);
    contacts();
    motion();
    for (auto& c : out_.contacts) squeezes(c);
  }
  [[nodiscard]] Segments take() { return std::move(out_); }

 private:
  /// Smooths by the shortest Gaussian at which noise is a fiftieth of fast motions; by a longer one only if
  /// it helps.
  void smooth(const std::vector<Xyz<double>>& raw) {
    for (const double sigma : sigmas) {
      auto p = smoothed(at_, raw, sigma);
      const auto v = velocities(at_, p);
      const double noise = velocity_noise(at_, v);
      if (out_.smoothing > 0 && noise > worth * out_.noise) continue;
      v_.clear();
      for (const auto& x : v) v_.push_back(norm(x));
      out_.p = std::move(p);
      out_.smoothing = sigma, out_.noise = noise, out_.fast = quantile(v_, 0.9);
      if (noise <= clean * out_.fast) return;
    }
  }
  void contacts() {
    std::vector<double> steps;
    for (std::size_t i = 1; i < force_.size(); ++i) steps.push_back(std::abs(force_[i] - force_[i - 1]));
    out_.force_noise = steps.empty() ? 0 : 1.4826 / std::sqrt(2.0) * median(steps);
    const double most = quantile(force_, 0.95);
    std::vector<double> pressed;
    for (const double f : force_)
      if (f > pressed_from * most && f > surely * out_.force_noise) pressed.push_back(f);
    if (pressed.empty()) return;
    out_.grip = median(pressed);
    const auto quick = smoothed(at_, force_, sigmas[0]);
    const double on = std::max(held_from * out_.grip, surely * out_.force_noise),
                 off = std::max(held_to * out_.grip, likely * out_.force_noise);
    for (const Span& s : stretches(
             at_, {0, quick.size()}, shortest, [&](std::size_t i) { return quick[i] >= on; },
             [&](std::size_t i) { return quick[i] < off; }))
      out_.contacts.push_back({s, {}});
  }
  /// Finds where the hand moves. At a change of contact it stands: its speed there is that of a hand at rest.
  void motion() {
    std::vector<double> largest;
    const auto change = [&](std::size_t i) {
      double v = 0;
      for (std::size_t j = i; j < at_.size() && at_[j] - at_[i] <= about; ++j) v = std::max(v, v_[j]);
      for (std::size_t j = i; j-- > 0 && at_[i] - at_[j] <= about;) v = std::max(v, v_[j]);
      largest.push_back(v);
    };
    for (const auto& c : out_.contacts) {
      if (c.span.begin > 0) change(c.span.begin);
      if (c.span.end < at_.size()) change(c.span.end);
    }
    out_.stands = largest.empty() ? 0 : median(largest);
    const double w = out_.fast;
    out_.moves_on =
        std::min(std::max({moves_from * w, likely * out_.noise, beyond * out_.stands}), on_way * w);
    const double off = std::min(std::max(moves_to * out_.moves_on, just_beyond * out_.stands), out_.moves_on);
    out_.moving.assign(at_.size(), 0);
    for (const Span& s : stretches(
             at_, {0, at_.size()}, 0, [&](std::size_t i) { return v_[i] > out_.moves_on; },
             [&](std::size_t i) { return v_[i] < off; }))
      std::fill(out_.moving.begin() + static_cast<std::ptrdiff_t>(s.begin),
                out_.moving.begin() + static_cast<std::ptrdiff_t>(s.end), char(1));
  }
  /// Finds squeezes: two levels of force, further apart than the force wanders on the way.
  void squeezes(ShownContact& c) {
    Span in = c.span;
    while (in.begin < in.end && at_[in.begin] - at_[c.span.begin] < edge) ++in.begin;
    while (in.end > in.begin && at_[c.span.end - 1] - at_[in.end - 1] < edge) --in.end;
    if (in.end - in.begin < 10) return;
    const auto part = [&](const std::vector<double>& x) {
      return std::vector<double>(x.begin() + static_cast<std::ptrdiff_t>(in.begin),
                                 x.begin() + static_cast<std::ptrdiff_t>(in.end));
    };
    const auto level = smoothed(part(at_), part(force_), level_sigma);
    std::vector<double> on_the_way;
    for (std::size_t i = 0; i < level.size(); ++i)
      if (v_[in.begin + i] > on_way * out_.fast) on_the_way.push_back(level[i]);
    double wander = 0;
    if (on_the_way.size() > 10 && quantile(on_the_way, 0.5) > 0)
      wander = (quantile(on_the_way, 0.975) - quantile(on_the_way, 0.025)) / quantile(on_the_way, 0.5);
    const Levels two = two_means(level);
    if (!(two.high - two.low > std::max(beyond * wander, harder) * two.low &&
          two.high - two.low > surely * out_.force_noise))
      return;
    const double border = 0.5 * (two.low + two.high);
    for (const Span& s : stretches(
             at_, in, shortest, [&](std::size_t i) { return level[i - in.begin] > border; },
             [&](std::size_t i) { return level[i - in.begin] < border; })) {
      const auto slow = std::count_if(v_.begin() + static_cast<std::ptrdiff_t>(s.begin),
                                      v_.begin() + static_cast<std::ptrdiff_t>(s.end),
                                      [&](double v) { return v <= out_.moves_on; });
      if (2 * static_cast<std::size_t>(slow) > s.end - s.begin) c.squeezes.push_back({s, felt(in, s)});
    }
  }
  /// Stiffness [N/m] of the object: change of the force over the closing of the fingers, from holding to
  /// squeezing; NaN: not known.
  [[nodiscard]] double felt(Span contact, Span s) const {
    std::vector<double> f[2], x[2];
    for (std::size_t i = contact.begin; i < contact.end; ++i) {
      const bool inside = at_[i] > at_[s.begin] + edge && at_[i] < at_[s.end - 1] - edge;
      const bool beside = (at_[i] < at_[s.begin] - edge && at_[i] > at_[s.begin] - 5 * edge) ||
                          (at_[i] > at_[s.end - 1] + edge && at_[i] < at_[s.end - 1] + 5 * edge);
      if ((inside || beside) && std::isfinite(opening_[i]))
        f[inside ? 1 : 0].push_back(force_[i]), x[inside ? 1 : 0].push_back(opening_[i]);
    }
    const double none = std::numeric_limits<double>::quiet_NaN();
    if (f[0].empty() || f[1].empty()) return none;
    const double force = median(f[1]) - median(f[0]), way = median(x[0]) - median(x[1]);
    return force > 0 && way > 0 ? force / way : none;
  }

  static constexpr double sigmas[] = {0.01,  0.016, 0.025, 0.04,
                                      0.063, 0.1,   0.16,  0.25};  ///< deviations of the Gaussians [s]
  static constexpr double clean = 0.02;  ///< noise, as a share of `fast`, that needs no longer Gaussian
  static constexpr double worth = 0.6;   ///< share of the noise below which a longer Gaussian must bring it
  static constexpr double surely = 5;    ///< standard deviations that noise does not reach
  static constexpr double likely = 3;    ///< deviations of noise in one of hundreds of samples
  static constexpr double pressed_from =
      0.3;                                  ///< share of the force's 95 % quantile that tells a thing in hand
  static constexpr double held_from = 0.2;  ///< share of the typical grip at which a contact begins
  static constexpr double held_to = 0.1;    ///< share of the typical grip below which it has ended
  static constexpr double shortest = 0.06;  ///< shortest contact, squeeze or gap; shorter ones bounce [s]
  static constexpr double about = 0.05;     ///< time about a change of contact in which the hand stands [s]
  static constexpr double moves_from = 0.06;   ///< share of the speed `fast` above which a hand moves
  static constexpr double moves_to = 0.67;     ///< share of the moving hand's speed bound at which it rests
  static constexpr double beyond = 1.3;        ///< factor on values seen where no motion or squeeze was meant
  static constexpr double just_beyond = 1.1;   ///< margin over the speed `stands`, to come to rest
  static constexpr double on_way = 0.25;       ///< share of the speed `fast` above which nobody squeezes
  static constexpr double level_sigma = 0.03;  ///< deviation of the Gaussian over a grip [s]
  static constexpr double harder = 0.12;       ///< smallest share by which a squeeze is harder than a grip
  static constexpr double edge = 0.1;          ///< time in which fingers press or let go [s]
  std::vector<double> at_, force_, opening_, v_;
  Segments out_;
};
}  // namespace detail

/// The segments of a recording, whose times rise and whose numbers are finite; an empty one has none.
///
/// - Positions are smoothed by a Gaussian without delay, of 10 to 250 ms: the shortest at which the noise of
///   the velocity is a fiftieth of the 90 % quantile of the speed; a longer one only if it cuts the noise to
///   60 %.
/// - In hand: from 0.2 of the typical grip and 5 deviations of the force until below 0.1 or 3 deviations.
/// - Moving: faster than 0.06 of the 90 % quantile, than 3 times the noise, and than 1.3 times the largest
///   speed while fingers close or open, where the hand stands, or than a quarter of the quantile; until 0.67
///   of that, or 1.1 times the speed of the standing hand.
/// - Squeezed: two levels of force in a contact, apart by more than 12 %, 5 deviations, and 1.3 times the
///   range in which the force wanders while the hand is on its way (faster than a quarter of the quantile),
///   where nobody squeezes; the hand stands for most of it.
template <Frame W = World>
[[nodiscard]] Segments segments_of(const std::vector<ShownSample<W>>& recording) {
  return recording.empty() ? Segments{} : detail::Cutter(recording).take();
}

SKINCTL_END_NAMESPACE
