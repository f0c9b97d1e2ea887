// SPDX-License-Identifier: BSD-3-Clause
// The base of a robot as a cycle believes it: what was told, judged, aged.
#pragma once

#include <algorithm>

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/dynamics/base_motion.hpp"
#include "skinctl/model/moving_base.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The state of a moving base as a cycle takes it. Trivially copyable.
template <Real T>
struct BelievedBase {
  bool seen = false;            ///< whether there has been a good state
  Nanoseconds stamp{};          ///< time of the last good state
  Xyz<T> up{T(0), T(0), T(1)};  ///< upward axis of the world at that time, along the axes of the base
  BaseMotion<T> told;           ///< motion at that time, without gravity
  BaseMotion<T> now;            ///< motion that counts in this cycle
};

/// Checks a state of a base: `sample_not_finite` or `sample_out_of_range`, or empty where it is good.
template <Real T>
[[nodiscard]] Status check_base(const BaseState<T>& b, const MovingBaseSettings& s,
                                Nanoseconds now) noexcept {
  const auto largest = [](const Xyz<T>& v) { return dot(v, v); };
  const auto& R = b.X_WB.axes();
  const T error = rotation_error(R);
  T sum = error + b.sigma + b.sigma_turn;
  for (const Xyz<T>& v :
       {b.X_WB.origin(), b.V_WB_B.linear, b.V_WB_B.angular, b.A_WB_B.linear, b.A_WB_B.angular})
    sum = sum + v.x * T(0) + v.y * T(0) + v.z * T(0);
  if (!(sum - sum == T(0)) || !is_plausible(b.time)) return Reason::sample_not_finite;
  const auto beyond = [&](const Xyz<T>& v, double most) { return !(largest(v) <= T(most) * T(most)); };
  // Of a rotation as a float has it after a chain of transforms.
  constexpr double no_rotation = 1e-3;
  const bool mirrored = !(dot(cross(R.x, R.y), R.z) > T(0));
  if (!(error <= T(no_rotation)) || mirrored || beyond(b.V_WB_B.angular, s.max_rate) ||
      beyond(b.A_WB_B.linear, s.max_acceleration) || beyond(b.A_WB_B.angular, s.max_turning) ||
      b.time > now + s.max_ahead)
    return Reason::sample_out_of_range;
  return {};
}

/// Takes the state of the base `told` by the input of the cycle at `now`: see `OnMovingBase`.
/// @param at_rest  motion of the base that stands; its gravity is as large as that of the world.
template <Real T>
[[nodiscard]] Status see_base(BelievedBase<T>& m, const BaseState<T>& told, const MovingBaseSettings& s,
                              Nanoseconds now, const BaseMotion<T>& at_rest) noexcept {
  Status status;
  const bool set_back = m.stamp > now + s.max_ahead;  // the clock was
  if (!m.seen || told.time != m.stamp) {
    status = check_base(told, s, now);
    if (!status.any() && told.time != Nanoseconds{} && (!m.seen || told.time > m.stamp || set_back)) {
      m.seen = true;
      m.stamp = told.time;
      const auto& R = told.X_WB.axes();
      m.up = {R.x.z, R.y.z, R.z.z};
      m.told = {told.V_WB_B.angular, told.A_WB_B.angular, told.A_WB_B.linear};
    }
  }
  if (!m.seen) {
    m.now = at_rest;
    return status | Reason::sample_stale;
  }
  const Nanoseconds age = now - m.stamp, left = s.max_age - age;
  if (left <= 0ns) status |= Reason::sample_stale;
  const T share = clamp(T(seconds<T>(left) / seconds<T>(s.fade)), T(0), T(1));
  // While the base turns on, its axes leave the upward one behind; it has turned by no more than while that
  // counts.
  const T aged = seconds<T>(std::clamp(age, -s.max_ahead, s.max_age));
  Xyz<T> up = m.up - aged * cross(m.told.angular, m.up);
  up = (T(1) / norm(up)) * up;
  m.now = {share * m.told.angular, share * m.told.turning, share * m.told.linear + norm(at_rest.linear) * up};
  return status;
}

/// A resolver's memory with the state of the base, for models whose base moves.
template <class Memory, Real T>
struct MemoryOnBase : Memory {
  BelievedBase<T> base;
};
template <class M, class Memory, Real T>
using MemoryOf = std::conditional_t<base_moves<M>, MemoryOnBase<Memory, T>, Memory>;

}  // namespace detail
SKINCTL_END_NAMESPACE
