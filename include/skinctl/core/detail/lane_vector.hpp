// SPDX-License-Identifier: BSD-3-Clause
// The compilers' vector types under Lane, and the few operations that need more than one expression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// AVX-512 targets also use 32 bytes: four fingers are four doubles.
#if defined(__AVX__)
inline constexpr std::size_t lane_bytes = 32;
#elif defined(__SSE2__) || (defined(__ARM_NEON) && defined(__aarch64__))
inline constexpr std::size_t lane_bytes = 16;
#else
inline constexpr std::size_t lane_bytes = 1;
#endif

template <class T, std::size_t W>
struct LaneTypes {
  using Word = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  typedef T Vector __attribute__((vector_size(W * sizeof(T))));
  typedef Word Bits __attribute__((vector_size(W * sizeof(T))));
  /// The vector at the alignment of `T`. GCC keeps the operands of a `memcpy` of 32 bytes in memory.
  typedef T Anywhere __attribute__((vector_size(W * sizeof(T)), aligned(alignof(T)), may_alias));
};
template <class T>
struct LaneTypes<T, 1> {
  using Word = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  using Vector = T;
  using Bits = Word;
  using Anywhere = T;
};

template <class T, std::size_t W>
using LaneVector = typename LaneTypes<T, W>::Vector;
/// Unsigned integers as wide as `T`, one per lane.
template <class T, std::size_t W>
using LaneBits = typename LaneTypes<T, W>::Bits;
/// The result of comparing two vectors: bool for one lane, else all bits set or none.
template <class T, std::size_t W>
using LaneCompare = decltype(LaneVector<T, W>{} < LaneVector<T, W>{});

template <class T>
inline constexpr auto sign_bit =
    static_cast<typename LaneTypes<T, 1>::Word>(typename LaneTypes<T, 1>::Word{1} << (8 * sizeof(T) - 1));

template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE LaneBits<T, W> to_bits(LaneVector<T, W> v) noexcept {
  return __builtin_bit_cast(LaneBits<T, W>, v);
}
template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE LaneVector<T, W> from_bits(LaneBits<T, W> bits) noexcept {
  return __builtin_bit_cast(LaneVector<T, W>, bits);
}

template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE constexpr LaneVector<T, W> broadcast(T x) noexcept {
  return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
    return LaneVector<T, W>{(static_cast<void>(Ix), x)...};
  }(std::make_index_sequence<W>{});
}

/// Half of the lanes, from `first` on.
template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE LaneVector<T, W / 2> half(LaneVector<T, W> v,
                                                       std::integral_constant<std::size_t, 0>) noexcept {
  if constexpr (W == 2)
    return v[0];
  else if constexpr (W == 4)
    return __builtin_shufflevector(v, v, 0, 1);
  else
    return __builtin_shufflevector(v, v, 0, 1, 2, 3);
}
template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE LaneVector<T, W / 2> half(LaneVector<T, W> v,
                                                       std::integral_constant<std::size_t, 1>) noexcept {
  if constexpr (W == 2)
    return v[1];
  else if constexpr (W == 4)
    return __builtin_shufflevector(v, v, 2, 3);
  else
    return __builtin_shufflevector(v, v, 4, 5, 6, 7);
}
using Lower = std::integral_constant<std::size_t, 0>;
using Upper = std::integral_constant<std::size_t, 1>;

template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE T sum_halves(LaneVector<T, W> v) noexcept {
  if constexpr (W == 1)
    return v;
  else
    return sum_halves<T, W / 2>(half<T, W>(v, Lower{}) + half<T, W>(v, Upper{}));
}

/// Whether a comparison holds in some lane. From the signs of the lanes where the target can collect them:
/// combining the halves with `or` takes three times as many instructions.
template <class Bits>
[[nodiscard]] SKINCTL_INLINE bool any_bit(Bits bits) noexcept {
#if defined(__AVX__)
  if constexpr (sizeof(Bits) == 32)
    return __builtin_ia32_movmskps256(__builtin_bit_cast(LaneVector<float, 8>, bits)) != 0;
#endif
#if defined(__SSE2__)
  if constexpr (sizeof(Bits) == 16)
    return __builtin_ia32_movmskps(__builtin_bit_cast(LaneVector<float, 4>, bits)) != 0;
#endif
  constexpr std::size_t words = sizeof(Bits) / sizeof(std::uint64_t);
  if constexpr (words == 1) {
    return __builtin_bit_cast(std::uint64_t, bits) != 0;
  } else {
    const auto wide = __builtin_bit_cast(LaneBits<double, words>, bits);
    if constexpr (words == 4) {
      return any_bit(__builtin_shufflevector(wide, wide, 0, 1) | __builtin_shufflevector(wide, wide, 2, 3));
    } else {
      return (wide[0] | wide[1]) != 0;
    }
  }
}

/// The square roots of the lanes.
template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE LaneVector<T, W> square_root(LaneVector<T, W> v) noexcept {
  if constexpr (W == 1) {
    if constexpr (sizeof(T) == 4)
      return __builtin_sqrtf(v);
    else
      return __builtin_sqrt(v);
  } else {
    LaneVector<T, W> roots{};
    for (std::size_t i = 0; i < W; ++i) roots[i] = square_root<T, 1>(v[i]);
    return roots;
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
