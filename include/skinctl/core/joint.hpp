// SPDX-License-Identifier: BSD-3-Clause
// Joint vectors: one number per joint, of one kind. Positions, velocities, accelerations and torques do not
// mix.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/detail/unrolled.hpp"
#include "skinctl/core/eigen_expression.hpp"
#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace kind {
struct Position {};      ///< kind of joint positions: [rad] revolute, [m] prismatic
struct Velocity {};      ///< kind of joint velocities [rad/s], [m/s]
struct Acceleration {};  ///< kind of joint accelerations [rad/s^2], [m/s^2]
struct Torque {};        ///< kind of generalised forces at joints [N m], [N]
struct Jerk {};          ///< kind of joint jerks [rad/s^3], [m/s^3]
struct Power {};         ///< kind of powers at joints [W]
}  // namespace kind

/// `N` numbers of one kind, in the order of the model's joints. Zero by default, trivially copyable, as cheap
/// as a bare array. Addition needs equal kinds: `q + tau` does not compile.
template <class Kind, std::size_t N, Scalar T = double>
struct JointVector {
  using kind = Kind;
  using scalar = T;
  static constexpr std::size_t size() noexcept { return N; }

  T data[N > 0 ? N : 1];

  constexpr JointVector() noexcept : data{} {}
  JointVector(const JointVector&) = default;
  JointVector& operator=(const JointVector&) = default;

  /// A joint vector from a bare array, in the order of the joints.
  SKINCTL_INLINE constexpr explicit JointVector(const std::array<T, N>& values) noexcept : data{} {
    for (std::size_t i = 0; i < N; ++i) data[i] = values[i];
  }
  /// A joint vector from exactly `N` numbers: `JointPosition<2>{0.1, 0.2}`.
  template <class... U>
    requires(sizeof...(U) == N && N > 1 && (std::is_convertible_v<U, T> && ...))
  SKINCTL_INLINE constexpr explicit(false) JointVector(const U&... values) noexcept : data{T(values)...} {}

  /// A joint vector from an Eigen vector of `N` elements of scalar `T`: `JointPosition<6>(v)`. A dynamic one
  /// of another size gives NaN. Assignment to an existing joint vector: `as_eigen(q) = v`.
  template <VectorExpression V>
  SKINCTL_INLINE explicit JointVector(const V& values) noexcept : data{} {
    static_assert(std::is_same_v<typename V::Scalar, T>, "other scalar: v.cast<T>()");
    static_assert(bool(V::IsVectorAtCompileTime), "one number per joint");
    static_assert(int(V::SizeAtCompileTime) == int(N) || int(V::SizeAtCompileTime) == -1,
                  "one number per joint");
    if (std::size_t(values.size()) != N) {
      for (T& x : data) x = std::numeric_limits<T>::quiet_NaN();
      return;
    }
    const auto v = values.eval();
    for (std::size_t i = 0; i < N; ++i) data[i] = v.coeff(static_cast<std::ptrdiff_t>(i));
  }
  // Deleted operations. Compilers print only the line that bears the operator's name, so the hint is a
  // comment on that line. The operators are members or friends, because compilers list all other candidates
  // in the error.
  // clang-format off
  template <class L, std::size_t M, class U>
  void operator+(const JointVector<L, M, U>&) const = delete;  // other kind, size or scalar: q + tau has no meaning
  template <class L, std::size_t M, class U>
  void operator-(const JointVector<L, M, U>&) const = delete;  // other kind, size or scalar: q - tau has no meaning
  template <class L, std::size_t M, class U>
  void operator*(const JointVector<L, M, U>&) const = delete;  // for tau . dq: power(tau, dq)
  template <class L, std::size_t M, class U>
  JointVector(const JointVector<L, M, U>&) = delete;  // other kind, size or scalar: cast<U>() changes the scalar
  template <class... U>
    requires(sizeof...(U) != N && sizeof...(U) > 1)
  JointVector(const U&...) = delete;  // one number per joint, or an array: JointPosition<N>(numbers)
  template <EigenExpression V>
  JointVector(const V&) = delete;  // an Eigen vector has no kind: name it, JointPosition<N>(v)
  template <class V>
    requires(EigenExpression<V> || BareNumbers<V>)
  void operator=(const V&) = delete;  // bare numbers have no kind: q = JointPosition<N>(numbers), or of Eigen as_eigen(q) = v
  template <EigenExpression V>
  operator V() const = delete;  // an Eigen vector has no kind: v = as_eigen(tau) drops it
  // clang-format on

  /// A vector of the numbers `f(0)` to `f(N - 1)`.
  template <class F>
  static SKINCTL_INLINE constexpr JointVector generate(F&& f) noexcept {
    JointVector v(unset);
    each([&](std::size_t i) SKINCTL_INLINE_LAMBDA { v.data[i] = f(i); });
    return v;
  }
  /// The numbers that `write(data)` writes; it must write all `N`.
  template <class F>
  static SKINCTL_INLINE JointVector written(F&& write) noexcept {
    JointVector v(unset);
    write(v.data);
    return v;
  }
  /// A vector with the same number for every joint.
  static SKINCTL_INLINE constexpr JointVector constant(const T& value) noexcept {
    return generate([&](std::size_t) SKINCTL_INLINE_LAMBDA { return value; });
  }
  /// The numbers converted to another scalar.
  template <Scalar U>
  SKINCTL_INLINE constexpr JointVector<Kind, N, U> cast() const noexcept {
    return JointVector<Kind, N, U>::generate([&](std::size_t i)
                                                 SKINCTL_INLINE_LAMBDA { return static_cast<U>(data[i]); });
  }

  /// A view of the numbers as an Eigen vector, without a copy.
  [[nodiscard]] friend SKINCTL_INLINE EigenMap<EigenMatrix<T, int(N), 1>> as_eigen(JointVector& v) noexcept {
    return EigenMap<EigenMatrix<T, int(N), 1>>(v.data);
  }
  [[nodiscard]] friend SKINCTL_INLINE EigenMap<const EigenMatrix<T, int(N), 1>> as_eigen(
      const JointVector& v) noexcept {
    return EigenMap<const EigenMatrix<T, int(N), 1>>(v.data);
  }
  friend void as_eigen(const JointVector&&) = delete;  // a view of a temporary: give it a name first

  SKINCTL_INLINE constexpr T& operator[](std::size_t i) noexcept { return data[i]; }
  SKINCTL_INLINE constexpr const T& operator[](std::size_t i) const noexcept { return data[i]; }
  SKINCTL_INLINE constexpr T* begin() noexcept { return data; }
  SKINCTL_INLINE constexpr T* end() noexcept { return data + N; }
  SKINCTL_INLINE constexpr const T* begin() const noexcept { return data; }
  SKINCTL_INLINE constexpr const T* end() const noexcept { return data + N; }

  SKINCTL_INLINE constexpr JointVector& operator+=(const JointVector& b) noexcept {
    return *this = *this + b;
  }
  SKINCTL_INLINE constexpr JointVector& operator-=(const JointVector& b) noexcept {
    return *this = *this - b;
  }
  SKINCTL_INLINE constexpr JointVector& operator*=(const T& s) noexcept { return *this = s * *this; }

  SKINCTL_INLINE constexpr JointVector operator+(const JointVector& b) const noexcept {
    JointVector c(unset);
    each([&](std::size_t i) SKINCTL_INLINE_LAMBDA { c.data[i] = data[i] + b.data[i]; });
    return c;
  }
  SKINCTL_INLINE constexpr JointVector operator-(const JointVector& b) const noexcept {
    JointVector c(unset);
    each([&](std::size_t i) SKINCTL_INLINE_LAMBDA { c.data[i] = data[i] - b.data[i]; });
    return c;
  }
  SKINCTL_INLINE constexpr JointVector operator-() const noexcept {
    JointVector c(unset);
    each([&](std::size_t i) SKINCTL_INLINE_LAMBDA { c.data[i] = -data[i]; });
    return c;
  }
  friend SKINCTL_INLINE constexpr JointVector operator*(const T& s, const JointVector& a) noexcept {
    JointVector c(unset);
    each([&](std::size_t i) SKINCTL_INLINE_LAMBDA { c.data[i] = s * a.data[i]; });
    return c;
  }
  SKINCTL_INLINE constexpr JointVector operator*(const T& s) const noexcept { return s * *this; }
  friend SKINCTL_INLINE constexpr bool operator==(const JointVector& a, const JointVector& b) noexcept {
    for (std::size_t i = 0; i < N; ++i)
      if (!(a.data[i] == b.data[i])) return false;
    return true;
  }

 private:
  /// Leaves the numbers uninitialised, for results that are overwritten completely: GCC does not remove the
  /// zeros, and the sum of 16 joints would take five times as long.
  struct Unset {};
  static constexpr Unset unset{};
  SKINCTL_INLINE constexpr explicit JointVector(Unset) noexcept {}
  template <class F>
  static SKINCTL_INLINE constexpr void each(F&& f) noexcept {
    detail::for_each_index<N>(f);
  }
};

template <std::size_t N, Scalar T = double>
using JointPosition = JointVector<kind::Position, N, T>;
template <std::size_t N, Scalar T = double>
using JointVelocity = JointVector<kind::Velocity, N, T>;
template <std::size_t N, Scalar T = double>
using JointAcceleration = JointVector<kind::Acceleration, N, T>;
template <std::size_t N, Scalar T = double>
using JointTorque = JointVector<kind::Torque, N, T>;
template <std::size_t N, Scalar T = double>
using JointJerk = JointVector<kind::Jerk, N, T>;
template <std::size_t N, Scalar T = double>
using JointPower = JointVector<kind::Power, N, T>;

/// `q + h dq`, the position after `h` seconds at constant velocity.
template <std::size_t N, class T>
SKINCTL_INLINE constexpr JointPosition<N, T> integrate(const JointPosition<N, T>& q,
                                                       const JointVelocity<N, T>& dq, const T& h) noexcept {
  return JointPosition<N, T>::generate([&](std::size_t i) SKINCTL_INLINE_LAMBDA { return q[i] + h * dq[i]; });
}
/// `dq + h ddq`, the velocity after `h` seconds at constant acceleration.
template <std::size_t N, class T>
SKINCTL_INLINE constexpr JointVelocity<N, T> integrate(const JointVelocity<N, T>& dq,
                                                       const JointAcceleration<N, T>& ddq,
                                                       const T& h) noexcept {
  return JointVelocity<N, T>::generate([&](std::size_t i)
                                           SKINCTL_INLINE_LAMBDA { return dq[i] + h * ddq[i]; });
}
/// `tau . dq`, the power [W].
template <std::size_t N, class T>
SKINCTL_INLINE constexpr T power(const JointTorque<N, T>& tau, const JointVelocity<N, T>& dq) noexcept {
  T sum(0);
  for (std::size_t i = 0; i < N; ++i) sum = sum + tau[i] * dq[i];
  return sum;
}

SKINCTL_END_NAMESPACE
