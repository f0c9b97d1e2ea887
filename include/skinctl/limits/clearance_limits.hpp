// Keeps links of a robot clear of each other and of known objects.
#pragma once

#include <limits>

#include "skinctl/limits/detail/towards.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/tactile/clearances.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The pairs of `Clearance` by their distances: a limit of speed in a governor, so it holds whatever a law
/// wants and an energy tank has.
///
/// A velocity is kept only if the robot can stop from it with all clearances above the margin, either along the
/// way on which all joints brake alike, at the rate of the weakest, if they stop before their ends, or along the
/// one on which each joint brakes as it likes. The distances are computed at `looks` places of that way, x
/// apart, and must exceed the margin there by `reach (sum |x_i|)^2` over the joints between the two: what they
/// can fall short in between. What is nearer than the margin may only get farther.
///
/// A velocity that would come too close loses the part that closes; what is left, mixed with braking as far as
/// needed, is kept. So an arm slides along, and whatever leads away passes.
template <RobotModel M, Real T = double>
class ClearanceLimits {
 public:
  static constexpr std::size_t joints = M::joints;
  static constexpr std::size_t most_pairs = Clearances<M, T>::most_pairs;
  static constexpr int looks = 6;  ///< along a way to stop
  using ClearancePart = void;
  using Velocity = JointVelocity<joints, T>;
  using Position = JointPosition<joints, T>;

  /// Throws `ConfigurationError` as `Clearances` does.
  SKINCTL_COLD ClearanceLimits(const M& model, const JointLimits<joints, T>& limits, const Clearance& given)
      : clearances_(model, given), limits_(limits), margin_(T(given.margin + 1e-4)), reach_(T(given.reach)) {}
  [[nodiscard]] const M& model() const noexcept { return clearances_.model(); }
  [[nodiscard]] const Clearances<M, T>& clearances() const noexcept { return clearances_; }

  /// The distances at a position, for several queries.
  class Here {
   public:
    [[nodiscard]] std::size_t size() const noexcept { return count_; }
    [[nodiscard]] const T& distance(std::size_t k) const noexcept { return distance_[k]; }
    [[nodiscard]] T nearest() const noexcept {
      T least = std::numeric_limits<T>::infinity();
      for (std::size_t k = 0; k < count_; ++k) least = distance_[k] < least ? distance_[k] : least;
      return least;
    }
    /// Whether the robot can stop from `u`, reached over `moved`, with its clearances and within `room`. False
    /// for NaN.
    [[nodiscard]] bool keeps(const Velocity& u, const Position& moved,
                             const JointRoom<joints, T>& room) const noexcept {
      return keeps_alike(u, moved, room) || keeps_alone(u, moved);
    }
    /// The same if all joints brake alike.
    [[nodiscard]] bool keeps_alike(const Velocity& u, const Position& moved,
                                   const JointRoom<joints, T>& room) const noexcept {
      T longest(0);
      for (std::size_t i = 0; i < joints; ++i) {
        const T stop = size(u[i]) / of_.brake(i);
        longest = stop > longest ? stop : longest;
      }
      const Position way = integrate(Position(), u, T(T(0.5) * longest));
      for (std::size_t i = 0; i < joints; ++i)
        if (moved[i] + way[i] > room.above[i] || -(moved[i] + way[i]) > room.below[i]) return false;
      return clear_along(moved, [&](const T& part) { return part * way; });
    }
    /// The same if each joint brakes as fast as it can.
    [[nodiscard]] bool keeps_alone(const Velocity& u, const Position& moved) const noexcept {
      T longest(0);
      for (std::size_t i = 0; i < joints; ++i) {
        const T stop = size(u[i]) / of_.brake(i);
        longest = stop > longest ? stop : longest;
      }
      return clear_along(moved, [&](const T& part) {
        Position x;
        for (std::size_t i = 0; i < joints; ++i) {
          const T stop = size(u[i]) / of_.brake(i), t = part * longest < stop ? T(part * longest) : stop;
          x[i] = stop > T(0) ? T(u[i] * t * (T(1) - T(0.5) * t / stop)) : T(0);
        }
        return x;
      });
    }
    /// `u` without what would bring a pair nearer than it can stop, pair by pair and a few times over.
    [[nodiscard]] Velocity slid(Velocity u) const noexcept {
      T gradient[most_pairs][joints];
      of_.clearances_.gradients(q_, gradient);
      for (int round = 0; round < 4; ++round)
        for (std::size_t k = 0; k < count_; ++k) {
          T closing(0), square(0), rate = std::numeric_limits<T>::infinity();
          for (std::size_t i = 0; i < joints; ++i) {
            const T g = gradient[k][i];
            closing = closing - g * u[i], square = square + g * g;
            if (size(g) * rate > of_.brake(i) * square) rate = of_.brake(i) * size(g);
          }
          const T room = distance_[k] - of_.margin_;
          const T most = room > T(0) ? speed_to_stop(room, T(0.02), T(rate > T(0) ? rate : T(1e-3))) : T(0);
          if (!(closing > most) || !(square > T(1e-8))) continue;
          const T share = (closing - most) / square;
          for (std::size_t i = 0; i < joints; ++i) u[i] = u[i] + share * gradient[k][i];
        }
      return u;
    }

   private:
    friend ClearanceLimits;
    static SKINCTL_INLINE T size(const T& x) noexcept { return x < T(0) ? T(-x) : x; }

    /// Whether the clearances hold after `moved`, and from there along `way(part)`, part from 0 to 1.
    template <class Way>
    [[nodiscard]] bool clear_along(const Position& moved, const Way& way) const noexcept {
      Position x = moved, before;
      T all(0);
      for (std::size_t i = 0; i < joints; ++i) all = all + size(moved[i]) + size(way(T(1))[i]);
      if (nearest() - of_.margin_ > of_.reach_ * all) return true;
      for (int n = 0; n <= looks; ++n) {
        if (n > 0) x = moved + way(T(T(n) / T(looks)));
        T distance[most_pairs];
        of_.clearances_.distances(q_ + x, distance);
        for (std::size_t k = 0; k < count_; ++k) {
          T step(0);
          for (std::size_t i = 0; i < joints; ++i)
            if ((of_.clearances_.between(k) >> i) & 1u) step = step + size(x[i] - before[i]);
          const T least = distance_[k] < of_.margin_ ? distance_[k] : of_.margin_;
          if (!(distance[k] >= least + of_.reach_ * step * step)) return false;
        }
        before = x;
      }
      return true;
    }

    Here(const ClearanceLimits& of, const Position& q) noexcept
        : of_(of), q_(q), count_(of.clearances_.size()) {
      of.clearances_.distances(q, distance_);
    }
    const ClearanceLimits& of_;
    Position q_;
    std::size_t count_;
    T distance_[most_pairs];
  };
  [[nodiscard]] Here at(const Position& q) const noexcept { return Here(*this, q); }

  struct Kept {
    Velocity velocity;
    bool limited;
  };
  /// The step from `u0` to `u1` over `h` seconds, as far as the clearances and `also(u)` are kept: `u1` if so.
  template <class Also>
  [[nodiscard]] SKINCTL_NOINLINE Kept within(const Position& q, const JointRoom<joints, T>& room,
                                             const Velocity& u0, const Velocity& u1, const T& h,
                                             const Also& also) const noexcept {
    const Here here = at(q);
    const auto keeps = [&](const Velocity& u) {
      return here.keeps(u, integrate(Position(), u0 + u, T(T(0.5) * h)), room) && also(u);
    };
    if (keeps(u1)) [[likely]]
      return {u1, false};
    T stop(0);
    for (std::size_t i = 0; i < joints; ++i) {
      const T t = Here::size(u0[i]) / (limits_.acceleration()[i] * braking_share<T>);
      stop = t > stop ? t : stop;
    }
    const T left = stop > h ? T(T(1) - h / stop) : T(0);
    Velocity brake = left * u0;
    Velocity wish = limits_.move(room, u0, here.slid(u1), h).velocity;
    if (keeps(wish)) return {wish, true};
    if (!here.keeps_alike(brake, integrate(Position(), u0 + brake, T(T(0.5) * h)), room))
      brake = limits_.move(room, u0, Velocity(), h).velocity;
    return {detail::towards(brake, wish, keeps), true};
  }
  /// Whether the motion that ends at `u` after `moved` keeps the clearances.
  [[nodiscard]] SKINCTL_NOINLINE bool keeps(const Position& q, const Velocity& u, const Position& moved,
                                            const JointRoom<joints, T>& room) const noexcept {
    return at(q).keeps(u, moved, room);
  }
  /// `u` without what closes, and of that the share from which the robot can stop after `time` seconds at it.
  [[nodiscard]] Kept braked(const Position& q, const Velocity& u, const T& time) const noexcept {
    if (share(q, u, time) == T(1)) [[likely]]
      return {u, false};
    const Velocity aside = at(q).slid(u);
    return {share(q, aside, time) * aside, true};
  }
  /// The share in [0, 1] of `u` from which the robot can stop after `time` seconds at it. 0 for NaN.
  [[nodiscard]] SKINCTL_NOINLINE T share(const Position& q, const Velocity& u, const T& time) const noexcept {
    const Here here = at(q);
    const auto room = limits_.room(q);
    const auto keeps = [&](const T& s) {
      return here.keeps(s * u, integrate(Position(), s * u, time), room);
    };
    if (keeps(T(1))) [[likely]]
      return T(1);
    T good(0), part(0.5);
    for (int k = 0; k < 12; ++k, part = T(0.5) * part)
      if (keeps(good + part)) good = good + part;
    return good;
  }

 private:
  /// The rate of braking that is planned, a little less than that of braking itself, for rounding.
  [[nodiscard]] SKINCTL_INLINE T brake(std::size_t i) const noexcept {
    return limits_.acceleration()[i] * braking_share<T> * braking_share<T>;
  }

  Clearances<M, T> clearances_;
  JointLimits<joints, T> limits_;
  T margin_, reach_;  ///< a tenth of a millimetre more than asked for: braking is planned in steps
};

/// The part of a governor that it makes of a robot.
template <RobotModel M, std::size_t N, Real T>
[[nodiscard]] auto part_for(const M& model, const JointLimits<N, T>& limits, const Clearance& clearance) {
  return ClearanceLimits<M, T>(model, limits, clearance);
}

SKINCTL_END_NAMESPACE
