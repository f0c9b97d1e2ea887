// SPDX-License-Identifier: BSD-3-Clause
// The quickest stop of one joint under limits of acceleration and jerk.
#pragma once

#include <cmath>

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The motion of a joint after some time: moved by `s`, at speed `u`, accelerating by `a`.
template <Real T>
struct Moved {
  T s, u, a;

  /// The motion `t` seconds later, at the constant jerk `j`.
  [[nodiscard]] SKINCTL_INLINE Moved after(const T& t, const T& j) const noexcept {
    const T half = T(0.5) * t, sixth = t / T(6);
    return {s + t * (u + half * (a + T(2) * sixth * j)), u + t * (a + half * j), a + t * j};
  }
};

/// The distances that a joint covers to both sides before it is at rest; >= 0.
template <Real T>
struct Reach {
  T above, below;
};

/// The quickest stop from speed `u` and acceleration `a` under |jerk| <= `j` and |acceleration| <= `A`: a
/// ramp to the deceleration p, p held, a ramp to zero. An `a` beyond A is brought back to it first.
///
/// The sign of `d = u + a |a| / (2 j)`, the speed that remains when only a is brought to zero, gives the
/// direction: the code below treats the mirrored motion, which has d >= 0.
template <Real T>
class Stopping {
 public:
  SKINCTL_INLINE Stopping(const T& u, const T& a, const T& A, const T& j) noexcept : j_(j) {
    using std::sqrt;
    const T own = a * a / (T(2) * j), d = a < T(0) ? T(u - own) : T(u + own);
    sign_ = d < T(0) ? T(-1) : T(1);
    start_ = {T(0), sign_ * u, sign_ * a};
    const T square = j * start_.u + T(0.5) * a * a;
    const T peak = square > T(0) ? T(sqrt(square)) : T(0);
    p_ = peak < A ? peak : A;
    const T change = start_.a + p_;
    first_ = change < T(0) ? j : T(-j);
    t_[0] = change < T(0) ? T(-change / j) : T(change / j);
    turned_ = start_.after(t_[0], first_);
    const T left = turned_.u - T(0.5) * p_ * p_ / j;
    t_[1] = p_ > T(0) && left > T(0) ? T(left / p_) : T(0);
    held_ = turned_.after(t_[1], T(0));
    t_[2] = p_ / j;
  }

  /// The motion after `h` seconds.
  [[nodiscard]] SKINCTL_INLINE Moved<T> after(const T& h) const noexcept {
    Moved<T> m = start_.after(h, first_);
    if (h > t_[0]) m = turned_.after(h - t_[0], T(0));
    if (h > t_[0] + t_[1]) m = held_.after(h - t_[0] - t_[1], j_);
    if (!(h < t_[0] + t_[1] + t_[2])) m = {end(), T(0), T(0)};
    return {sign_ * m.s, sign_ * m.u, sign_ * m.a};
  }

  /// The signed displacement until the joint is at rest [rad].
  [[nodiscard]] SKINCTL_INLINE T rest() const noexcept { return sign_ * end(); }
  /// The distances covered to both sides before rest [rad].
  [[nodiscard]] SKINCTL_INLINE Reach<T> reach() const noexcept {
    using std::sqrt;
    const T s = end();
    T back = T(0);
    if (start_.u < T(0)) {  // it moves the other way until its acceleration has reversed it
      const T square = start_.a * start_.a + T(2) * j_ * start_.u;
      const T t = T(-2) * start_.u / (start_.a + (square > T(0) ? T(sqrt(square)) : T(0)));
      back = -start_.after(t, first_).s;
    }
    const T on = s > T(0) ? s : T(0);
    if (-s > back) back = -s;
    return sign_ > T(0) ? Reach<T>{on, back} : Reach<T>{back, on};
  }

 private:
  SKINCTL_INLINE T end() const noexcept { return held_.s + p_ * t_[2] * t_[2] / T(6); }

  T j_, sign_, p_, first_, t_[3];
  Moved<T> start_, turned_, held_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
