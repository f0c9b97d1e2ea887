// Traced: a scalar that records what a program computes, for error bounds over boxes of its inputs.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "bench/studies/proofs/bound.hpp"
#include "bench/studies/proofs/limits_like.hpp"
#include "bench/studies/proofs/tape.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// A scalar for error bounds over boxes of inputs of a program that computes in `R`, float or double. It
/// records each operation on the tape of the thread's `Tape::Recording`; `TracedOutput` then bounds the error
/// of a result.
///
/// Where `Bound` adds up errors in magnitude, step by step, the tape knows how far each rounding reaches:
/// rotated errors do not grow. Numbers made outside of a recording are constants of the program. A comparison
/// is decided by the ranges over the box of the recording and checked again in every other box; where ranges
/// overlap it is counted in `undecided()`, and the box must be split.
template <class R>
class Traced {
  static_assert(std::is_same_v<R, float> || std::is_same_v<R, double>, "Traced<R>: R is float or double");

 public:
  constexpr Traced() noexcept = default;
  template <class U>
    requires std::is_arithmetic_v<U>
  constexpr explicit(false) Traced(U x) noexcept : number_(static_cast<double>(x)) {}

  /// An input of the program, any number of `R` in `range`.
  [[nodiscard]] static Traced input(const Enclosure& range) { return at(Tape::current()->input(range)); }
  /// Its place on the tape.
  [[nodiscard]] std::int32_t node() const {
    return node_ >= 0 ? node_ : Tape::current()->constant(number_, rounded(number_));
  }
  /// The middle of the range, for texts. What depends on it is not traced.
  template <class U>
    requires std::is_arithmetic_v<U>
  constexpr explicit operator U() const noexcept {
    return static_cast<U>(node_ < 0 ? number_ : Tape::current()->range(node_).middle());
  }

  friend Traced operator-(const Traced& a) {
    return a.node_ < 0 ? Traced(-a.number_) : unary(TapeOp::negate, a);
  }
  friend Traced operator+(const Traced& a) { return a; }
  friend Traced operator+(const Traced& a, const Traced& b) {
    if (a.is(0)) return b;
    if (b.is(0)) return a;
    return binary(TapeOp::add, a, b, [](R x, R y) { return x + y; });
  }
  friend Traced operator-(const Traced& a, const Traced& b) {
    if (b.is(0)) return a;
    if (a.is(0)) return -b;
    return binary(TapeOp::subtract, a, b, [](R x, R y) { return x - y; });
  }
  friend Traced operator*(const Traced& a, const Traced& b) {
    if (a.is(0) || b.is(0)) return Traced(0);
    return binary(TapeOp::multiply, a, b, [](R x, R y) { return x * y; });
  }
  friend Traced operator/(const Traced& a, const Traced& b) {
    if (a.is(0) || (b.node_ < 0 && std::isinf(b.number_))) return Traced(0);
    return binary(TapeOp::divide, a, b, [](R x, R y) { return x / y; });
  }
  Traced& operator+=(const Traced& b) { return *this = *this + b; }
  Traced& operator-=(const Traced& b) { return *this = *this - b; }
  Traced& operator*=(const Traced& b) { return *this = *this * b; }
  Traced& operator/=(const Traced& b) { return *this = *this / b; }

  friend bool operator<(const Traced& a, const Traced& b) {
    const Enclosure x = a.range(), y = b.range();
    const bool less = x.high < y.low;
    if (a.node_ < 0 && b.node_ < 0) return less;
    if (!less && !(x.low >= y.high)) {
      ++undecided();
      return x.middle() < y.middle();
    }
    Tape::current()->decided(a.node(), b.node(), less);
    return less;
  }
  friend bool operator>(const Traced& a, const Traced& b) { return b < a; }
  friend bool operator<=(const Traced& a, const Traced& b) { return !(b < a); }
  friend bool operator>=(const Traced& a, const Traced& b) { return !(a < b); }
  friend bool operator==(const Traced& a, const Traced& b) {
    if (a.node_ < 0 && b.node_ < 0) return rounded(a.number_) == rounded(b.number_);
    if (a.node_ == b.node_) return true;
    const Enclosure x = a.range(), y = b.range();
    if (x.is_point() && y.is_point()) return x.low == y.low;
    return a < b || b < a ? false : (++undecided(), false);
  }

  friend Traced abs(const Traced& a) {
    return a.node_ < 0 ? Traced(std::fabs(a.number_)) : unary(TapeOp::abs, a);
  }
  friend Traced sqrt(const Traced& a) { return unary(TapeOp::sqrt, a); }
  friend Traced sin(const Traced& a) { return a.is(0) ? a : unary(TapeOp::sin, a); }
  friend Traced cos(const Traced& a) { return a.is(0) ? Traced(1) : unary(TapeOp::cos, a); }
  friend Traced tanh(const Traced& a) { return a.is(0) ? a : unary(TapeOp::tanh, a); }
  friend Traced exp(const Traced& a) { return a.is(0) ? Traced(1) : unary(TapeOp::exp, a); }

 private:
  static constexpr double unit = 4 * static_cast<double>(std::numeric_limits<R>::epsilon());
  static constexpr double least = static_cast<double>(std::numeric_limits<R>::min());

  static Traced at(std::int32_t node) noexcept {
    Traced t;
    t.node_ = node;
    return t;
  }
  static constexpr double rounded(double x) noexcept { return static_cast<double>(static_cast<R>(x)); }
  constexpr bool is(double x) const noexcept { return node_ < 0 && number_ == x; }
  [[nodiscard]] Enclosure range() const {
    if (node_ >= 0) return Tape::current()->range(node_);
    const double r = rounded(number_);
    return r < number_ ? Enclosure(r, number_) : Enclosure(number_, r);
  }
  static Traced unary(TapeOp op, const Traced& a) {
    return at(Tape::current()->operation(op, a.node(), -1, unit, least));
  }
  template <class F>
  static Traced binary(TapeOp op, const Traced& a, const Traced& b, F&& outside) {
    if (Tape::current() == nullptr)
      return Traced(outside(static_cast<R>(a.number_), static_cast<R>(b.number_)));
    const std::int32_t left = a.node();
    return at(Tape::current()->operation(op, left, a.node_ >= 0 && a.node_ == b.node_ ? left : b.node(), unit,
                                         least));
  }

  double number_ = 0;
  std::int32_t node_ = -1;
};

}  // namespace math
SKINCTL_END_NAMESPACE

/// @cond
template <class R>
struct std::numeric_limits<skinctl::math::Traced<R>>
    : skinctl::detail::LimitsLike<skinctl::math::Traced<R>, R> {};
/// @endcond
