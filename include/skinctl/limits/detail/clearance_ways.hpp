// SPDX-License-Identifier: BSD-3-Clause
// Whether a robot can stop with its clearances, from a position.
#pragma once

#include <limits>

#include "skinctl/clearance/clearances.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The distances of a `ClearanceLimits` at a position, and whether ways to stop from there keep them.
template <class Limits>
class ClearanceWays {
 public:
  static constexpr std::size_t joints = Limits::joints, max_pairs = Limits::max_pairs;
  static constexpr int stop_checks = Limits::stop_checks;
  using T = typename Limits::scalar;
  using Velocity = typename Limits::Velocity;
  using Position = typename Limits::Position;
  using Near = typename Limits::Near;
  using Memory = typename Limits::Memory;
  using Sum = typename Limits::Sum;
  /// Largest speed at which a motion along a margin leaves it [m/s]: a faster one would throw the arm off.
  static constexpr double leaving = 0.05;
  /// Time before a pair brakes, of a step that slides [s]: some cycles, so that the next need not brake hard.
  static constexpr double reaction = 0.02;
  /// Squared gradient of a pair that no joint moves [m^2]: by 0.1 mm a radian, which no braking needs.
  static constexpr double square_of_none = 1e-8;
  /// Part of the margin that is kept between the spaces that robots fill until they stand: all of it would
  /// keep two from braking side by side.
  static constexpr double inner_share = 0.25;
  /// Rounds over all pairs: what leaves one may close another one.
  static constexpr int rounds = 4;

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] const T& distance(std::size_t k) const noexcept { return distance_[k]; }
  [[nodiscard]] T nearest() const noexcept {
    T least = std::numeric_limits<T>::infinity();
    for (std::size_t k = 0; k < count_; ++k) least = distance_[k] < least ? distance_[k] : least;
    return least;
  }
  /// Whether the robot can stop from the velocity `u`, reached by the displacement `moved`, with its
  /// clearances and within `room`. False for NaN.
  [[nodiscard]] bool keeps(const Velocity& u, const Position& moved,
                           const JointRoom<joints, T>& room) const noexcept {
    return (keeps_alike(u, moved, room) || keeps_alone(u, moved)) && stays_apart(u, moved);
  }
  /// Whether the robot can stop so if all joints brake alike, `stays_apart` not asked.
  [[nodiscard]] bool keeps_alike(const Velocity& u, const Position& moved,
                                 const JointRoom<joints, T>& room) const noexcept {
    const T longest = of_.time_to_rest(u);
    const Position way = integrate(Position(), u, T(T(0.5) * longest));
    for (std::size_t i = 0; i < joints; ++i)
      if (moved[i] + way[i] > room.above[i] || -(moved[i] + way[i]) > room.below[i]) return false;
    return clear_along(moved, longest, [&](const T& part) { return part * way; });
  }
  /// Whether the robot can stop so if each joint brakes as fast as it can, whatever its room, `stays_apart`
  /// not asked.
  [[nodiscard]] bool keeps_alone(const Velocity& u, const Position& moved) const noexcept {
    const T longest = of_.time_to_rest(u);
    return clear_along(moved, longest, [&](const T& part) {
      Position x;
      for (std::size_t i = 0; i < joints; ++i) {
        const T stop = size(u[i]) / of_.brake(i), t = part * longest < stop ? T(part * longest) : stop;
        x[i] = stop > T(0) ? T(u[i] * t * (T(1) - T(0.5) * t / stop)) : T(0);
      }
      return x;
    });
  }
  /// `u`, of a step of `h` seconds, without what would bring a pair nearer than it can stop, pair by pair and
  /// a few times over. At the margin it leaves a little, at up to `leaving`: by as much as the distance may
  /// fall short of its gradient until the robot stands, because a motion along the margin would not be kept.
  [[nodiscard]] Velocity slid(Velocity u, const T& h) const noexcept {
    T gradient[max_pairs][joints], gradient_off[max_pairs][joints];
    of_.clearances_.gradients(q_, near(), gradient);
    if (seen_.is_off) of_.clearances_.gradients(q_ + seen_.off, near(), gradient_off);
    for (int round = 0; round < rounds; ++round) {
      open(u, h, gradient, distance_);
      if (seen_.is_off) open(u, h, gradient_off, distance_off_);
    }
    return u;
  }

 private:
  friend Limits;
  static SKINCTL_INLINE T size(const T& x) noexcept { return x < T(0) ? T(-x) : x; }

  /// One round of `slid`: takes from `u` what closes each pair too fast.
  void open(Velocity& u, const T& h, const T (&gradient)[max_pairs][joints],
            const T (&distance)[max_pairs]) const noexcept {
    for (std::size_t k = 0; k < count_; ++k) {
      const T longest = of_.time_to_rest(u);
      Sum sum;
      T closing(0), square(0), rate = std::numeric_limits<T>::infinity();
      for (std::size_t i = 0; i < joints; ++i) {
        const T g = gradient[k][i];
        closing = closing - g * u[i], square = square + g * g, sum.add(i, u[i]);
        if (size(g) * rate > of_.brake(i) * square) rate = of_.brake(i) * size(g);
      }
      const T room = distance[k] - margin(k, T(0)), bend = sum.bend(of_.reach_) * (h + longest);
      if (!(square > T(square_of_none))) continue;
      const T most = (room > T(0) ? speed_to_stop(room, T(reaction), rate) : T(0)) -
                     (bend < T(leaving) ? bend : T(leaving));
      if (!(closing > most)) continue;
      const T share = (closing - most) / square;
      for (std::size_t i = 0; i < joints; ++i) u[i] = u[i] + share * gradient[k][i];
    }
  }
  [[nodiscard]] SKINCTL_INLINE const Near& near() const noexcept {
    if constexpr (Limits::around > 0) {
      return seen_.near;
    } else {
      static constexpr Near nothing{};
      return nothing;
    }
  }
  /// Whether the volume that the robot may fill until it stands, from `u` after `moved`, is clear of each
  /// obstacle with approach 0; one that is too near a robot at rest here already does not count.
  [[nodiscard]] bool stays_apart([[maybe_unused]] const Velocity& u,
                                 [[maybe_unused]] const Position& moved) const noexcept {
    if constexpr (Limits::around > 0) {
      const T inner = T(inner_share) * of_.margin_;
      const auto& c = of_.clearances_;
      const auto box = of_.until_rest(seen_.measured, q_ + moved, u);
      Sum wide;
      for (std::size_t i = 0; i < joints; ++i) wide.add(i, box.half[i]);
      const T grows = T(2) * wide.way(of_.reach_) + wide.bend(of_.reach_);
      bool close = false;
      for (std::size_t k = c.size(); k < count_; ++k)
        close = close || (!(distance_[k] - inner > grows) && c.approach(k, near()) == T(0));
      if (!close) return true;
      using Volume = Surroundings<max_exposed_capsules, Base, T>;
      const auto least = [&](const Volume& volume, std::size_t k) {
        const std::size_t n = count_ - c.size(), per = n / volume.count, of = k - c.size();
        return skinctl::distance(volume.obstacles[of / per].shape, near().obstacles[of % per].shape).distance;
      };
      Volume swept, standing;
      c.sweep(box.middle, box.half, of_.reach_, swept);
      for (std::size_t k = c.size(); k < count_; ++k) {
        if (distance_[k] - inner > grows || c.approach(k, near()) > T(0) || least(swept, k) >= inner)
          continue;
        if (standing.count == 0) {
          const auto here = of_.until_rest(seen_.measured, q_, Velocity());
          c.sweep(here.middle, here.half, of_.reach_, standing);
        }
        if (least(standing, k) >= inner) return false;
      }
    }
    return true;
  }
  /// The distance that pair `k` needs `t` seconds after the robot set out [m]: an obstacle comes closer by
  /// itself.
  [[nodiscard]] SKINCTL_INLINE T margin(std::size_t k, const T& t) const noexcept {
    if constexpr (Limits::around > 0) {
      return of_.margin_ + of_.clearances_.approach(k, seen_.near) * (seen_.age + of_.late_ + t);
    } else {
      return of_.margin_;
    }
  }
  /// Whether the clearances hold after `moved`, and from there along `way(part)`, part from 0 to 1, which
  /// lasts `time` seconds.
  template <class Way>
  [[nodiscard]] bool clear_along(const Position& moved, const T& time, const Way& way) const noexcept {
    if constexpr (Limits::around > 0)
      if (seen_.blind) return false;
    return clear_from(q_, distance_, moved, time, way) &&
           (!seen_.is_off || clear_from(q_ + seen_.off, distance_off_, moved, time, way));
  }
  /// As `clear_along`, whether the clearances hold from the position `q`, with the distances `here` [m].
  template <class Way>
  [[nodiscard]] bool clear_from(const Position& q, const T (&here)[max_pairs], const Position& moved,
                                const T& time, const Way& way) const noexcept {
    Position x = moved, before;
    Sum all;
    for (std::size_t i = 0; i < joints; ++i) all.add(i, moved[i]), all.add(i, way(T(1))[i]);
    const T longest = all.way(of_.reach_);
    bool close[max_pairs], any = false;
    for (std::size_t k = 0; k < count_; ++k) any = (close[k] = !(here[k] - margin(k, time) > longest)) || any;
    if (!any) return true;
    for (int n = 0; n <= stop_checks; ++n) {
      const T part = T(n) / T(stop_checks);
      if (n > 0) x = moved + way(part);
      T distance[max_pairs];
      of_.clearances_.distances(q + x, near(), distance, [&](std::size_t k) { return close[k]; });
      for (std::size_t k = 0; k < count_; ++k) {
        if (!close[k]) continue;
        Sum step;
        for (std::size_t i = 0; i < joints; ++i)
          if ((of_.clearances_.between(k, near()) >> i) & 1u) step.add(i, x[i] - before[i]);
        const T wanted = margin(k, part * time), least = here[k] < wanted ? here[k] : wanted;
        if (!(distance[k] >= least + step.bend(of_.reach_))) return false;
      }
      before = x;
    }
    return true;
  }

  ClearanceWays(const Limits& of, const Memory& seen, const Position& q) noexcept
      : of_(of), seen_(seen), q_(q), count_(of.clearances_.size(near())) {
    const auto all = [](std::size_t) { return true; };
    of.clearances_.distances(q, near(), distance_, all);
    if (seen.is_off) of.clearances_.distances(q + seen.off, near(), distance_off_, all);
  }
  const Limits& of_;
  const Memory& seen_;
  Position q_;
  std::size_t count_;
  T distance_[max_pairs];
  T distance_off_[max_pairs];  ///< distances at the real position of a robot that stands off its commands [m]
};

}  // namespace detail
SKINCTL_END_NAMESPACE
