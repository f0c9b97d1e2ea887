// SPDX-License-Identifier: BSD-3-Clause
// The polynomial sine and cosine of a lane, for arguments within its limit.
#pragma once

#include <cmath>
#include <cstddef>

#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/math/detail/polynomial.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math::detail {

/// The largest reduced argument where the thread rounds to nearest, and some room (proven: 0.7855).
inline constexpr float max_reduced = 0.7857f;

/// Constants by type. `half_pi` is pi/2 in parts, the first two so short that their product with a count of
/// quarter turns up to `limit` is exact, with FMA or without. The polynomials are minimax on |r| <= 0.7856,
/// rounded coefficient by coefficient: sin r = r + r^3 p(r^2), cos r = 1 - r^2 / 2 + r^4 p(r^2).
template <class T>
struct SinCosTable;

/// Parts of 33 bits and 53; relative error of the sine 2^-57.8, absolute of the cosine 2^-64.
template <>
struct SinCosTable<double> {
  static constexpr double limit = 1e6;
  static constexpr double round_to_integer = 0x1.8p52;
  static constexpr double two_over_pi = 0x1.45f306dc9c883p-1;
  static constexpr double half_pi[] = {0x1.921fb544p0, 0x1.0b4611a6p-34, 0x1.3198a2e037073p-69};
  static constexpr double sin[] = {-0x1.5555555555548p-3, 0x1.111111110f730p-7,   -0x1.a01a019be9217p-13,
                                   0x1.71de35552b51ap-19, -0x1.ae5e4b83e1a71p-26, 0x1.5d8b5592ec546p-33};
  static constexpr double cos[] = {-0.5,
                                   0x1.555555555554cp-5,
                                   -0x1.6c16c16c1521ep-10,
                                   0x1.a01a019cbf35fp-16,
                                   -0x1.27e4f8128a89dp-22,
                                   0x1.1ee9f12e061fbp-29,
                                   -0x1.8fb11b0b2c9b9p-37};
};

/// Parts of 15 bits and 24; relative error of the sine 2^-27.9, absolute of the cosine 2^-33.
template <>
struct SinCosTable<float> {
  static constexpr float limit = 800.0f;
  static constexpr float round_to_integer = 0x1.8p23f;
  static constexpr float two_over_pi = 0x1.45f306p-1f;
  static constexpr float half_pi[] = {0x1.921cp0f, 0x1.daap-15f, 0x1.10b462p-30f};
  static constexpr float sin[] = {-0x1.555546p-3f, 0x1.110778p-7f, -0x1.9954p-13f};
  static constexpr float cos[] = {-0.5f, 0x1.55554ap-5f, -0x1.6c0c1ap-10f, 0x1.99e0eep-16f};
};

/// Sine and cosine of `x`. Returns the reduced argument: above `max_reduced` the results are not accurate.
/// That happens beyond the limit, and where the thread does not round to nearest, so that the count of
/// quarter turns is one off.
template <class T, std::size_t W>
SKINCTL_INLINE Lane<T, W> sincos_kernel(Lane<T, W> x, Lane<T, W>& sin, Lane<T, W>& cos) noexcept {
  using Table = SinCosTable<T>;
  using L = Lane<T, W>;
  using Bits = skinctl::detail::LaneBits<T, W>;
  using Word = typename skinctl::detail::LaneTypes<T, 1>::Word;
  constexpr auto to_bits = [](L y)
                               SKINCTL_INLINE_LAMBDA { return skinctl::detail::to_bits<T, W>(y.vector()); };
  constexpr Word sign = skinctl::detail::sign_bit<T>;

  // The rounded sum has no fraction; its lowest bits count the quarter turns.
  const L turns = x * L(Table::two_over_pi) + L(Table::round_to_integer);
  const L k = turns - L(Table::round_to_integer);
  L r = x - k * L(Table::half_pi[0]);
  r = r - k * L(Table::half_pi[1]);
  r = r - k * L(Table::half_pi[2]);

  const L z = r * r;
  const L sin_r = r + (r * z) * polynomial(z, Table::sin);
  const L cos_r = L(T(1)) + z * polynomial(z, Table::cos);

  // Odd quadrants swap sine and cosine, by bit operations: no branch, and no blend, which some instruction
  // sets lack. The sum above loses the sign of -0, so the sign is taken from r.
  constexpr Word one = 1;
  constexpr int to_sign = 8 * sizeof(T) - 2;
  const Bits quadrant = to_bits(turns);
  const Bits s = to_bits(sin_r) | (to_bits(r) & sign);
  const Bits c = to_bits(cos_r);
  const Bits swapped = (s ^ c) & -(quadrant & one);
  sin = skinctl::detail::to_lane<T, W>(s ^ swapped ^ ((quadrant << to_sign) & sign));
  cos = skinctl::detail::to_lane<T, W>(c ^ swapped ^ (((quadrant + one) << to_sign) & sign));
  return r;
}

/// Recomputes the results of arguments beyond the polynomial's limit, or all of them. Cold: joint angles are
/// within it, and threads round to nearest.
template <class T>
[[gnu::cold, gnu::noinline]] inline void sincos_beyond(const T* x, T* sin, T* cos, std::size_t n,
                                                       bool all) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    if (!all && !(std::abs(x[i]) > SinCosTable<T>::limit)) continue;
    sin[i] = std::sin(x[i]);
    cos[i] = std::cos(x[i]);
  }
}

/// `sincos_beyond` for `B` lanes. Function arguments passed by address stay in memory; the copy keeps the
/// originals in registers.
template <class T, std::size_t W, std::size_t B>
SKINCTL_INLINE void sincos_beyond(const Lane<T, W> (&x)[B], Lane<T, W> (&sin)[B], Lane<T, W> (&cos)[B],
                                  bool all) noexcept {
  T angles[B * W], sines[B * W], cosines[B * W];
  skinctl::detail::unrolled<B>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    x[i].store(angles + W * i), sin[i].store(sines + W * i), cos[i].store(cosines + W * i);
  });
  sincos_beyond(angles, sines, cosines, B * W, all);
  skinctl::detail::unrolled<B>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    sin[i] = Lane<T, W>::load(sines + W * i), cos[i] = Lane<T, W>::load(cosines + W * i);
  });
}

/// Sines and cosines of `B` lanes, for any arguments.
template <class T, std::size_t W, std::size_t B>
SKINCTL_INLINE void sincos_lanes(const Lane<T, W> (&x)[B], Lane<T, W> (&sin)[B],
                                 Lane<T, W> (&cos)[B]) noexcept {
  using L = Lane<T, W>;
  L largest(T(0)), reduced(T(0));
  skinctl::detail::unrolled<B>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
    reduced = max(reduced, abs(sincos_kernel(x[i], sin[i], cos[i])));
    largest = max(largest, abs(x[i]));
  });
  const auto beyond = largest > L(SinCosTable<T>::limit);
  const auto off = reduced > L(T(max_reduced));
  if (any(beyond | off)) [[unlikely]]
    sincos_beyond(x, sin, cos, any(off & !beyond));
}

}  // namespace math::detail
SKINCTL_END_NAMESPACE
