// Stochastic: a scalar that rounds every result up or down by chance.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "bench/studies/proofs/limits_like.hpp"
#include "skinctl/core/config.hpp"

namespace skinctl::testing {

/// A number `R`, float or double, whose operations round to one of the two neighbours of the exact result,
/// chosen by lot with equal chances (exact results stay). Runs of the same program then differ by as much as
/// rounding matters to it: their spread tells how many digits of a result are its own, also after a million
/// steps, where bounds say nothing any more (Vignes 2004, Discrete stochastic arithmetic).
///
/// Any algorithm of the library takes it as its `Real`. Sines, tanh and the like are the C library's, rounded
/// so; constants are rounded to nearest. The lot is drawn from `seed()` of the thread.
template <class R>
class Stochastic {
  static_assert(std::is_same_v<R, float> || std::is_same_v<R, double>, "Stochastic<R>: R is float or double");

 public:
  constexpr Stochastic() noexcept = default;
  template <class U>
    requires std::is_arithmetic_v<U>
  constexpr explicit(false) Stochastic(U x) noexcept : x_(static_cast<R>(x)) {}
  template <class U>
    requires std::is_arithmetic_v<U>
  constexpr explicit operator U() const noexcept {
    return static_cast<U>(x_);
  }

  /// The state of the thread's lot; not 0.
  [[nodiscard]] static std::uint64_t& seed() noexcept {
    static thread_local std::uint64_t state = 0x9e3779b97f4a7c15u;
    return state;
  }

  friend constexpr Stochastic operator-(const Stochastic& a) noexcept { return Stochastic(-a.x_); }
  friend constexpr Stochastic operator+(const Stochastic& a) noexcept { return a; }
  friend Stochastic operator+(const Stochastic& a, const Stochastic& b) noexcept {
    const R s = a.x_ + b.x_, seen = s - a.x_;
    return drawn(s, (a.x_ - (s - seen)) + (b.x_ - seen));
  }
  friend Stochastic operator-(const Stochastic& a, const Stochastic& b) noexcept { return a + -b; }
  friend Stochastic operator*(const Stochastic& a, const Stochastic& b) noexcept {
    const R p = a.x_ * b.x_;
    return drawn(p, std::fma(a.x_, b.x_, -p));
  }
  friend Stochastic operator/(const Stochastic& a, const Stochastic& b) noexcept {
    const R q = a.x_ / b.x_, rest = std::fma(-q, b.x_, a.x_);
    return drawn(q, b.x_ < R(0) ? -rest : rest);
  }
  Stochastic& operator+=(const Stochastic& b) noexcept { return *this = *this + b; }
  Stochastic& operator-=(const Stochastic& b) noexcept { return *this = *this - b; }
  Stochastic& operator*=(const Stochastic& b) noexcept { return *this = *this * b; }
  Stochastic& operator/=(const Stochastic& b) noexcept { return *this = *this / b; }

  friend constexpr bool operator==(const Stochastic& a, const Stochastic& b) noexcept { return a.x_ == b.x_; }
  friend constexpr auto operator<=>(const Stochastic& a, const Stochastic& b) noexcept {
    return a.x_ <=> b.x_;
  }

  friend Stochastic abs(const Stochastic& a) noexcept { return Stochastic(std::abs(a.x_)); }
  friend Stochastic copysign(const Stochastic& a, const Stochastic& b) noexcept {
    return Stochastic(std::copysign(a.x_, b.x_));
  }
  friend Stochastic sqrt(const Stochastic& a) noexcept {
    const R r = std::sqrt(a.x_);
    return drawn(r, std::fma(-r, r, a.x_));
  }
  friend Stochastic sin(const Stochastic& a) noexcept { return either(std::sin(a.x_)); }
  friend Stochastic cos(const Stochastic& a) noexcept { return either(std::cos(a.x_)); }
  friend Stochastic tanh(const Stochastic& a) noexcept { return either(std::tanh(a.x_)); }
  friend Stochastic exp(const Stochastic& a) noexcept { return either(std::exp(a.x_)); }
  friend Stochastic atan2(const Stochastic& y, const Stochastic& x) noexcept {
    return either(std::atan2(y.x_, x.x_));
  }
  friend Stochastic pow(const Stochastic& x, const Stochastic& y) noexcept {
    return either(std::pow(x.x_, y.x_));
  }

 private:
  static std::uint64_t lot() noexcept {
    std::uint64_t& s = seed();
    s ^= s << 13, s ^= s >> 7, s ^= s << 17;
    return s >> 32;
  }
  /// `nearest`, or its neighbour on the side where the rest of the exact result lies.
  static Stochastic drawn(R nearest, R rest) noexcept {
    if (rest == R(0) || !(nearest - nearest == R(0)) || lot() % 2 == 0) return Stochastic(nearest);
    constexpr R endless = std::numeric_limits<R>::infinity();
    return Stochastic(std::nextafter(nearest, rest > R(0) ? endless : -endless));
  }
  /// A value of the C library, which does not tell on which side the exact one lies.
  static Stochastic either(R y) noexcept {
    return drawn(y, y == R(0) || y == R(1) || y == R(-1) ? R(0) : (lot() % 2 == 0 ? R(1) : R(-1)));
  }

  R x_ = 0;
};

}  // namespace skinctl::testing

/// @cond
template <class R>
struct std::numeric_limits<skinctl::testing::Stochastic<R>>
    : skinctl::detail::LimitsLike<skinctl::testing::Stochastic<R>, R> {};
/// @endcond
