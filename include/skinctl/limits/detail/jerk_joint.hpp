// SPDX-License-Identifier: BSD-3-Clause
// One joint that moves within limits of jerk.
#pragma once

#include <limits>
#include <utility>

#include "skinctl/core/status.hpp"
#include "skinctl/limits/detail/stopping.hpp"
#include "skinctl/math/greatest_share.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// One joint with its limits of velocity, acceleration and jerk, and its room, as `JerkLimits` moves it.
template <Real T>
struct JerkJoint {
  using Moved = detail::Moved<T>;
  /// Steps of a bisection between two motions: a share to 6e-8.
  static constexpr int mixing_steps = 24;
  static constexpr double rounding_of_ways = 0.01;  ///< margin for rounding: share of a way to rest
  T V, A, J, above, below, slack;
  bool roomy;  ///< no end is near enough to matter in this step

  JerkJoint(const T& v, const T& a, const T& j, const T& up, const T& down, const T& far) noexcept
      : V(v),
        A(a),
        J(j),
        above(up > T(0) ? up : T(0)),
        below(down > T(0) ? down : T(0)),
        slack(0),
        roomy(up > far && down > far) {
    if (roomy) [[likely]]
      return;
    const T both = up + down;
    slack = T(16) * eps() * (both <= std::numeric_limits<T>::max() ? both : T(V * V / A + V * A / J));
  }
  static T eps() noexcept { return std::numeric_limits<T>::epsilon(); }

  /// Whether the quickest stop stays between the ends, to within rounding.
  [[nodiscard]] bool can_rest(const T& u, const T& a) const noexcept {
    const auto reach = detail::Stopping<T>(u, a, A, J).reach();
    const T more = slack + T(256) * eps() * (reach.above + reach.below);
    return reach.above <= above + more && reach.below <= below + more;
  }
  /// Whether a step of `h` seconds may end as `m`: the quickest stop stays between the ends with a margin,
  /// and below the velocity limit; the mean speed of the step does not exceed that limit either, as it might
  /// where the acceleration changes its sign within the step.
  [[nodiscard]] bool may_end(const Moved& m, const T& h) const noexcept {
    if (!(m.s <= V * h && -m.s <= V * h)) [[unlikely]]
      return false;
    if (roomy) [[likely]]
      return slow_enough(m);
    const T j = J * braking_share<T>;
    const auto reach = detail::Stopping<T>(m.u, m.a, T(A * braking_share<T>), j).reach();
    return reach.above <= above - m.s && reach.below <= below + m.s && slow_enough(m);
  }
  [[nodiscard]] bool slow_enough(const Moved& m) const noexcept {
    const T own = m.a * m.a / (T(2) * J * braking_share<T>);
    return (m.a > T(0) ? m.u : -m.u) + own <= V && m.u <= V && -m.u <= V;
  }
  /// Whether a step of constant jerk stays between the ends.
  [[nodiscard]] bool stays_inside(const T& u, const T& a, const T& j, const T& h) const noexcept {
    using std::sqrt;
    const T square = a * a - T(2) * j * u;  // it reverses where u + a t + j t^2/2 = 0
    if (!(square >= T(0))) return true;
    const T root = a < T(0) ? T(a - sqrt(square)) : T(a + sqrt(square));
    const T first = j != T(0) ? T(-root / j) : T(0), second = root != T(0) ? T(T(-2) * u / root) : T(0);
    for (const T t : {first, second}) {
      if (!(t > T(0) && t < h)) continue;
      const T s = Moved{T(0), u, a}.after(t, j).s;
      if (!(s <= above && -s <= below)) return false;
    }
    return true;
  }
  struct Bearable {
    T a;
    bool rests;
  };
  /// The acceleration nearest to `a` from which the joint can stop inside and below the velocity limit; in
  /// nearly all cases `a` itself.
  [[nodiscard]] Bearable bearable(const T& u, T a) const noexcept {
    using std::sqrt;
    if (roomy && slow_enough({T(0), u, a})) [[likely]]
      return {a, true};
    const T j = T(2) * J, more = V * (T(1) + T(256) * eps());
    const T up = more > u ? T(sqrt(j * (more - u))) : T(0), down = more > -u ? T(sqrt(j * (more + u))) : T(0);
    a = a > up ? up : (a < -down ? -down : a);
    if (can_rest(u, a)) [[likely]]
      return {a, true};
    const T hardest = detail::Stopping<T>(u, a, A, J).reach().above > above ? T(-A) : A;
    if (!can_rest(u, hardest)) return {hardest, false};
    T good = hardest, bad = a;
    for (int k = 0; k < std::numeric_limits<T>::digits; ++k) {
      const T middle = T(0.5) * (good + bad);
      (can_rest(u, middle) ? good : bad) = middle;
    }
    return {good, true};
  }

  /// `a` within the acceleration limit, 0 if it is NaN.
  [[nodiscard]] T within_acceleration(const T& a) const noexcept {
    return a == a ? (a > A ? A : (a < -A ? T(-A) : a)) : T(0);
  }

  [[nodiscard]] std::pair<Moved, Status> move(const T& u, const T& a, const T& target,
                                              const T& h) const noexcept {
    Status status;
    const T wish = target == target ? (target > V ? V : (target < -V ? -V : target)) : T(0);
    if (wish != target) status |= Reason::velocity_limited;
    const T asked = (wish - u) / h, most = a + J * h, least = a - J * h;
    T a1 = asked > A ? A : (asked < -A ? -A : asked);
    if (a1 != asked) status |= Reason::acceleration_limited;
    const T before = a1;
    a1 = a1 > most ? most : (a1 < least ? least : a1);
    if (a1 != before) status |= Reason::jerk_limited;
    const T slope = (a1 - a) / h;
    Moved m = Moved{T(0), u, a}.after(h, slope);
    m.a = a1;
    if (!may_end(m, h) || (!roomy && !stays_inside(u, a, slope, h))) [[unlikely]] {
      const bool slow = slow_enough(m) && m.s <= V * h && -m.s <= V * h;
      status |= slow ? Reason::position_limited : Reason::velocity_limited;
      const Moved brake = detail::Stopping<T>(u, a, A, J).after(h);
      T share(0);  // as much of the step as possible: both parts keep all limits
      if (roomy || stays_inside(u, a, slope, h))
        share = math::greatest_share<mixing_steps, T>(
            [&](const T& part) { return may_end(mixed(brake, m, part), h); });
      m = share > T(0) ? mixed(brake, m, share) : brake;
    }
    return {without_dust(m), status};
  }
  /// The interpolation from the motion `from` (`share` 0) to `towards` (1), which begin alike.
  [[nodiscard]] static Moved mixed(const Moved& from, const Moved& towards, const T& share) noexcept {
    return {from.s + share * (towards.s - from.s), from.u + share * (towards.u - from.u),
            from.a + share * (towards.a - from.a)};
  }
  /// The displacement until rest of a joint that moved as `m` and then stops [rad].
  [[nodiscard]] T rest_of(const Moved& m) const noexcept {
    return m.s + detail::Stopping<T>(m.u, m.a, A, J).rest();
  }
  /// The motion `m` of `h` seconds from speed `u` and acceleration `a`, mixed with the quickest stop as far
  /// as the rest point needs to lie within `most` and `-least`. Where the stop ends beyond, the joint comes
  /// back as hard as it can, if `comes_back`.
  [[nodiscard]] Moved held_back(const Moved& m, const T& u, const T& a, const T& h, const T& least,
                                const T& most, bool comes_back) const noexcept {
    const T rest = rest_of(m);
    if (rest <= most && -rest <= least) return m;
    const Moved stop = detail::Stopping<T>(u, a, A, J).after(h);
    const T side = rest > most ? T(1) : T(-1), end = rest > most ? most : least;
    const auto inside = [&](const Moved& x) { return side * rest_of(x) <= end; };
    Moved within = stop, beyond = m;
    if (!inside(stop)) {
      if (!comes_back) return stop;
      within = move(u, a, T(-side * V), h).first, beyond = stop;
      if (!inside(within)) return within;
    }
    const auto keeps = [&](const T& part) { return inside(mixed(within, beyond, part)); };
    return mixed(within, beyond, math::greatest_share<mixing_steps, T>(keeps));
  }
  /// Whether the quickest stop passes the place `above` ahead, or `below` behind, by more than rounding.
  [[nodiscard]] bool passes(const T& u, const T& a, const T& up, const T& down) const noexcept {
    const T rest = detail::Stopping<T>(u, a, A, J).rest(), way = rest < T(0) ? T(-rest) : rest;
    return way * T(1 - rounding_of_ways) > (rest < T(0) ? down : up) && rest * u > T(0);
  }
  /// The next `h` seconds of the steady stop within `left`, as far as the acceleration limit allows. Its
  /// acceleration is told as 0: it ends with the motion, whatever jerk it takes.
  [[nodiscard]] Moved steady_stop(const T& u, const T& left, const T& h) const noexcept {
    const T speed = u < T(0) ? T(-u) : u;
    const T asked = left > T(0) ? T(speed * speed / (T(2) * left)) : A, brake = asked < A ? asked : A;
    const T next = speed - h * brake;
    const T s = next > T(0) ? T(T(0.5) * h * (speed + next)) : T(speed * speed / (T(2) * brake));
    const T sign = u < T(0) ? T(-1) : T(1);
    return {sign * s, next > T(0) ? T(sign * next) : T(0), T(0)};
  }
  /// `m` with 0 for a speed and an acceleration whose squares are denormal numbers.
  [[nodiscard]] static Moved without_dust(Moved m) noexcept {
    if (m.u < dust<T> && -m.u < dust<T>) m.u = T(0);
    if (m.a < dust<T> && -m.a < dust<T>) m.a = T(0);
    return m;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
