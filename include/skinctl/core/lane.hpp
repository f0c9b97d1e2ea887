// SPDX-License-Identifier: BSD-3-Clause
// Lane: several reals in one register, computed on at once.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>

#include "skinctl/core/config.hpp"
#include "skinctl/core/detail/lane_vector.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Number of `T` in a register of the target: 32 bytes with AVX (also with AVX-512), 16 with SSE2 or 64-bit
/// NEON, else one number.
template <class T>
inline constexpr std::size_t native_lanes =
    detail::lane_bytes < sizeof(T) ? 1 : detail::lane_bytes / sizeof(T);

/// The result of a comparison, lane by lane. Combine with `&`, `|`, `!`; use with `select`, `any`, `all`.
template <class T, std::size_t W>
class LaneMask {
 public:
  using Bits = detail::LaneCompare<T, W>;

  LaneMask() = default;
  SKINCTL_INLINE constexpr explicit LaneMask(Bits bits) noexcept : bits_(bits) {}
  [[nodiscard]] SKINCTL_INLINE constexpr Bits bits() const noexcept { return bits_; }

  [[nodiscard]] SKINCTL_INLINE bool operator[](std::size_t lane) const noexcept {
    if constexpr (W == 1)
      return static_cast<void>(lane), bits_;
    else
      return bits_[lane] != 0;
  }

  SKINCTL_INLINE friend LaneMask operator&(LaneMask a, LaneMask b) noexcept {
    return LaneMask(static_cast<Bits>(a.bits_ & b.bits_));
  }
  SKINCTL_INLINE friend LaneMask operator|(LaneMask a, LaneMask b) noexcept {
    return LaneMask(static_cast<Bits>(a.bits_ | b.bits_));
  }
  SKINCTL_INLINE friend LaneMask operator!(LaneMask a) noexcept {
    if constexpr (W == 1)
      return LaneMask(!a.bits_);
    else
      return LaneMask(~a.bits_);
  }
  /// True if the comparison holds in at least one lane.
  [[nodiscard]] SKINCTL_INLINE friend bool any(LaneMask a) noexcept {
    if constexpr (W == 1)
      return a.bits_;
    else
      return detail::any_bit(a.bits_);
  }
  /// True if the comparison holds in every lane.
  [[nodiscard]] SKINCTL_INLINE friend bool all(LaneMask a) noexcept { return !any(!a); }

 private:
  Bits bits_;
};

/// `W` numbers of type `T` (float or double) on which every operation works lane by lane, as on a plain `T`.
///
/// An algorithm templated on its scalar computes four fingers at once with `Lane<double, 4>`. A number
/// converts to a lane that holds it `W` times. A lane is never wider than the target's registers: split a
/// longer row into several lanes of `native_lanes<T>`. Trivially copyable; `Lane{}` is zero, `Lane x;` is
/// uninitialised. Comparisons give a `LaneMask`; there is no conversion to bool.
template <class T, std::size_t W = native_lanes<T>>
class Lane {
  static_assert(std::is_same_v<T, float> || std::is_same_v<T, double>, "Lane<T, W>: T is float or double");
  static_assert(W != 0 && (W & (W - 1)) == 0, "Lane<T, W>: W is a power of two");
  static_assert(W <= native_lanes<T>, "Lane<T, W>: wider than the target's registers; use native_lanes<T>");

 public:
  using Vector = detail::LaneVector<T, W>;
  using Mask = LaneMask<T, W>;
  static constexpr std::size_t lanes = W;

  Lane() = default;
  /// A lane with the same number in every lane.
  SKINCTL_INLINE constexpr Lane(T x) noexcept : v_(detail::broadcast<T, W>(x)) {}
  /// The same number in every lane, for `T(0.5)` and `T(2)` in generic code.
  template <class U>
    requires(std::is_arithmetic_v<U> && !std::is_same_v<U, T>)
  SKINCTL_INLINE constexpr explicit Lane(U x) noexcept : Lane(static_cast<T>(x)) {}
  SKINCTL_INLINE constexpr explicit Lane(Vector v) noexcept
    requires(W > 1)
      : v_(v) {}

  /// The `W` numbers from `from` on; any alignment.
  [[nodiscard]] SKINCTL_INLINE static Lane load(const T* from) noexcept {
    return of(*reinterpret_cast<const Anywhere*>(from));
  }
  /// Writes the `W` numbers to `to` and after; any alignment.
  SKINCTL_INLINE void store(T* to) const noexcept { *reinterpret_cast<Anywhere*>(to) = v_; }

  /// The number in lane `lane`, `0 <= lane < W`.
  [[nodiscard]] SKINCTL_INLINE constexpr T operator[](std::size_t lane) const noexcept {
    if constexpr (W == 1)
      return static_cast<void>(lane), v_;
    else
      return v_[lane];
  }
  /// The compiler's vector (a plain number for one lane).
  [[nodiscard]] SKINCTL_INLINE constexpr Vector vector() const noexcept { return v_; }

  SKINCTL_INLINE friend constexpr Lane operator+(Lane a, Lane b) noexcept {
    SKINCTL_CONTRACT return of(a.v_ + b.v_);
  }
  SKINCTL_INLINE friend constexpr Lane operator-(Lane a, Lane b) noexcept {
    SKINCTL_CONTRACT return of(a.v_ - b.v_);
  }
  SKINCTL_INLINE friend constexpr Lane operator*(Lane a, Lane b) noexcept {
    SKINCTL_CONTRACT return of(a.v_ * b.v_);
  }
  SKINCTL_INLINE friend constexpr Lane operator/(Lane a, Lane b) noexcept { return of(a.v_ / b.v_); }
  SKINCTL_INLINE friend constexpr Lane operator-(Lane a) noexcept { SKINCTL_CONTRACT return of(-a.v_); }
  SKINCTL_INLINE friend constexpr Lane operator+(Lane a) noexcept { return a; }
  SKINCTL_INLINE constexpr Lane& operator+=(Lane b) noexcept { return *this = *this + b; }
  SKINCTL_INLINE constexpr Lane& operator-=(Lane b) noexcept { return *this = *this - b; }
  SKINCTL_INLINE constexpr Lane& operator*=(Lane b) noexcept { return *this = *this * b; }
  SKINCTL_INLINE constexpr Lane& operator/=(Lane b) noexcept { return *this = *this / b; }

  SKINCTL_INLINE friend Mask operator<(Lane a, Lane b) noexcept { return Mask(a.v_ < b.v_); }
  SKINCTL_INLINE friend Mask operator<=(Lane a, Lane b) noexcept { return Mask(a.v_ <= b.v_); }
  SKINCTL_INLINE friend Mask operator>(Lane a, Lane b) noexcept { return Mask(a.v_ > b.v_); }
  SKINCTL_INLINE friend Mask operator>=(Lane a, Lane b) noexcept { return Mask(a.v_ >= b.v_); }
  SKINCTL_INLINE friend Mask operator==(Lane a, Lane b) noexcept { return Mask(a.v_ == b.v_); }
  SKINCTL_INLINE friend Mask operator!=(Lane a, Lane b) noexcept { return Mask(a.v_ != b.v_); }

  /// `a` where the mask holds, else `b`; both are computed.
  [[nodiscard]] SKINCTL_INLINE friend Lane select(Mask mask, Lane a, Lane b) noexcept {
    return of(mask.bits() ? a.v_ : b.v_);
  }
  /// The smaller number of each lane, as `std::min`: `b < a ? b : a`, so `a` if either is NaN.
  [[nodiscard]] SKINCTL_INLINE friend Lane min(Lane a, Lane b) noexcept {
    return of(b.v_ < a.v_ ? b.v_ : a.v_);
  }
  /// The larger number of each lane, as `std::max`: `a < b ? b : a`, so `a` if either is NaN.
  [[nodiscard]] SKINCTL_INLINE friend Lane max(Lane a, Lane b) noexcept {
    return of(a.v_ < b.v_ ? b.v_ : a.v_);
  }
  /// The magnitude; clears the sign bit, also of zeros and NaN.
  [[nodiscard]] SKINCTL_INLINE friend Lane abs(Lane a) noexcept {
    return of(detail::from_bits<T, W>(detail::to_bits<T, W>(a.v_) & ~detail::sign_bit<T>));
  }
  /// The magnitude of `a` with the sign bit of `b`.
  [[nodiscard]] SKINCTL_INLINE friend Lane copysign(Lane a, Lane b) noexcept {
    return of(detail::from_bits<T, W>((detail::to_bits<T, W>(a.v_) & ~detail::sign_bit<T>) |
                                      (detail::to_bits<T, W>(b.v_) & detail::sign_bit<T>)));
  }
  /// The square root, correctly rounded; NaN for negative numbers, -0 for -0; never sets errno.
  [[nodiscard]] SKINCTL_INLINE friend Lane sqrt(Lane a) noexcept {
    return of(detail::square_root<T, W>(a.v_));
  }
  /// The sum of the lanes, halves first: (v0 + v2) + (v1 + v3).
  [[nodiscard]] SKINCTL_INLINE friend T sum(Lane a) noexcept { return detail::sum_halves<T, W>(a.v_); }

 private:
  using Anywhere = typename detail::LaneTypes<T, W>::Anywhere;

  SKINCTL_INLINE static constexpr Lane of(Vector v) noexcept {
    Lane lane{};
    lane.v_ = v;
    return lane;
  }

  Vector v_;
};

/// `a` if the condition holds, else `b`: the counterpart of the lanes' `select`, for code templated on its
/// scalar.
template <Real T>
[[nodiscard]] SKINCTL_INLINE constexpr T select(bool condition, const std::type_identity_t<T>& a,
                                                const T& b) noexcept {
  return condition ? a : b;
}

template <class T, std::size_t W>
inline constexpr bool is_lane<Lane<T, W>> = true;

namespace detail {
template <class T, std::size_t W>
struct RealOf<Lane<T, W>> {
  using type = T;
};
template <class T, std::size_t W>
[[nodiscard]] SKINCTL_INLINE Lane<T, W> to_lane(LaneBits<T, W> bits) noexcept {
  return Lane<T, W>(from_bits<T, W>(bits));
}
}  // namespace detail

SKINCTL_END_NAMESPACE
