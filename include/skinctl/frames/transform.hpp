// SPDX-License-Identifier: BSD-3-Clause
// Pose of one frame in another; the type names both frames.
#pragma once

#include <array>
#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/eigen.hpp"
#include "skinctl/frames/frame.hpp"
#include "skinctl/frames/rotation.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// `p + R v`, each component one expression.
template <Scalar T>
SKINCTL_INLINE constexpr Xyz<T> moved(const Xyz<T>& p, const Rotation<T>& R, const Xyz<T>& v) noexcept {
  return {p.x + R.x.x * v.x + R.y.x * v.y + R.z.x * v.z, p.y + R.x.y * v.x + R.y.y * v.y + R.z.y * v.z,
          p.z + R.x.z * v.x + R.y.z * v.y + R.z.z * v.z};
}
}  // namespace detail

/// Pose of frame `B` in frame `A`, written `X_AB`; the paper's ^B T_A, eqs. (1)-(3).
///
/// The frames are in the type: `X_AB * X_BC` is a `Transform<A, C>`, `X_AB * X_CB` an error. Twelve numbers,
/// trivially copyable: the axes of B in A, then B's origin. Identity by default.
///
/// A `Transform<A, A>` arises only as a product of poses around a loop; constructors refuse it. A pose of
/// several steps stays between its two frames: `Transform<A, B>::translation_xyz(1, 0, 0).rotated_z(0.5)`.
template <Frame A, Frame B, Scalar T = double>
class Transform {
 public:
  using scalar = T;

  /// The pose of two frames that coincide.
  constexpr Transform() noexcept = default;

  /// @param R_AB  axes of B in A; a rotation to within `tolerance<T>`: see `normalised()`. Not checked: a
  ///              cycle refuses a goal whose axes are none (`Reason::goal_refused`); `nearest` throws.
  /// @param p_AB  origin of B in A [m].
  SKINCTL_INLINE constexpr Transform(const Rotation<T>& R_AB, const Xyz<T>& p_AB) noexcept
      : R_(R_AB), p_(p_AB) {
    static_assert(!std::is_same_v<A, B>,
                  "a frame has no pose in itself: name two, or go on from X_AB by X_AB.translated(...), "
                  ".rotated_z(...)");
  }
  /// A pose from Eigen: `R_AB` 3x3 and `p_AB` 3x1 of scalar `T`; `R_AB` is a rotation, which is not checked.
  template <VectorExpression M, VectorExpression V>
    requires(std::same_as<typename M::Scalar, T> && std::same_as<typename V::Scalar, T>)
  Transform(const M& R_AB, const V& p_AB) noexcept : Transform(Rotation<T>::from_eigen(R_AB), as_xyz(p_AB)) {}
  /// A pose from an `Eigen::Isometry3<T>`.
  template <int Options>
  explicit Transform(const Eigen::Transform<T, 3, 1, Options>& X_AB) noexcept
      : Transform(X_AB.linear(), X_AB.translation()) {}
  // clang-format off
  template <class S, int O>
  Transform(const Eigen::Quaternion<S, O>&, const Xyz<T>&) = delete;  // axes, not a quaternion: q.toRotationMatrix() and an Eigen vector
  template <class S, int O, VectorExpression V>
  Transform(const Eigen::Quaternion<S, O>&, const V&) = delete;  // axes, not a quaternion: q.toRotationMatrix()
  template <class S, std::size_t N, class P>
  Transform(const std::array<S, N>&, const P&) = delete;  // axes, not an array: Rotation<double>{{x axis}, {y axis}, {z axis}}, {x, y, z}
  template <class S, std::size_t N>
  Transform(const Rotation<T>&, const std::array<S, N>&) = delete;  // an origin, not an array: {p[0], p[1], p[2]}
  template <class S, int D, int M, int O>
  Transform(const Eigen::Transform<S, D, M, O>&) = delete;  // an Eigen pose has no frames: name them, Transform<A, B>(isometry)
  template <class S, int D, int M, int O>
  void operator=(const Eigen::Transform<S, D, M, O>&) = delete;  // an Eigen pose has no frames: name them, Transform<A, B>(isometry)
  template <class X, std::enable_if_t<is_eigen_pose<X>, int> = 0>
  operator X() const = delete;  // to Eigen: as_eigen(X_AB)
  // clang-format on

  /// The pose with the rotation nearest to `R_AB`, whose numbers are one only to within measurement or
  /// rounding (a file's six digits). Throws `ConfigurationError` if `rotation_error(R_AB)` exceeds 0.1 or a
  /// number is not finite.
  [[nodiscard]] static Transform nearest(const Rotation<T>& R_AB, const Xyz<T>& p_AB) {
    require(rotation_error(R_AB) <= T(0.1), "Transform: |R'R - 1|", double(rotation_error(R_AB)), "<= 0.1");
    require(dot(p_AB, p_AB) <= (std::numeric_limits<T>::max)(), "Transform: |p|^2", double(dot(p_AB, p_AB)),
            "finite m^2");
    return Transform(skinctl::normalised(R_AB), p_AB);
  }
  /// The pose of B that is A translated by (x, y, z) [m].
  [[nodiscard]] SKINCTL_INLINE static constexpr Transform translation_xyz(const T& x, const T& y,
                                                                          const T& z) noexcept {
    return {Rotation<T>{}, {x, y, z}};
  }
  /// The pose of B that is A rotated by `angle` [rad] about their common x axis; NaN for an angle that is not
  /// finite.
  [[nodiscard]] static Transform rotation_x(const T& angle) noexcept {
    using std::cos;
    using std::sin;
    const T c = cos(angle), s = sin(angle), l(1), o(0);
    return turned({{l, o, o}, {o, c, s}, {o, -s, c}});
  }
  /// The pose of B that is A rotated by `angle` [rad] about their common y axis.
  [[nodiscard]] static Transform rotation_y(const T& angle) noexcept {
    using std::cos;
    using std::sin;
    const T c = cos(angle), s = sin(angle), l(1), o(0);
    return turned({{c, o, -s}, {o, l, o}, {s, o, c}});
  }
  /// The pose of B that is A rotated by `angle` [rad] about their common z axis.
  [[nodiscard]] static Transform rotation_z(const T& angle) noexcept {
    using std::cos;
    using std::sin;
    const T c = cos(angle), s = sin(angle), l(1), o(0);
    return turned({{c, s, o}, {-s, c, o}, {o, o, l}});
  }

  /// The pose after B is translated by (x, y, z) [m] along its own axes.
  [[nodiscard]] SKINCTL_INLINE constexpr Transform translated(const T& x, const T& y,
                                                              const T& z) const noexcept {
    return trusted(R_, detail::moved(p_, R_, Xyz<T>{x, y, z}));
  }
  /// The pose after B is rotated by `angle` [rad] about its own x axis.
  [[nodiscard]] Transform rotated_x(const T& angle) const noexcept {
    using std::cos;
    using std::sin;
    const T c = cos(angle), s = sin(angle);
    return trusted({R_.x, c * R_.y + s * R_.z, c * R_.z - s * R_.y}, p_);
  }
  /// The pose after B is rotated by `angle` [rad] about its own y axis.
  [[nodiscard]] Transform rotated_y(const T& angle) const noexcept {
    using std::cos;
    using std::sin;
    const T c = cos(angle), s = sin(angle);
    return trusted({c * R_.x - s * R_.z, R_.y, c * R_.z + s * R_.x}, p_);
  }
  /// The pose after B is rotated by `angle` [rad] about its own z axis.
  [[nodiscard]] Transform rotated_z(const T& angle) const noexcept {
    using std::cos;
    using std::sin;
    const T c = cos(angle), s = sin(angle);
    return trusted({c * R_.x + s * R_.y, c * R_.y - s * R_.x, R_.z}, p_);
  }

  /// The x axis of B in A, a unit vector; below, the y and the z axis.
  [[nodiscard]] SKINCTL_INLINE constexpr const Xyz<T>& axis_x() const noexcept { return R_.x; }
  [[nodiscard]] SKINCTL_INLINE constexpr const Xyz<T>& axis_y() const noexcept { return R_.y; }
  [[nodiscard]] SKINCTL_INLINE constexpr const Xyz<T>& axis_z() const noexcept { return R_.z; }
  /// Origin of B in A [m].
  [[nodiscard]] SKINCTL_INLINE constexpr const Xyz<T>& origin() const noexcept { return p_; }
  /// Axes of B in A, all three.
  [[nodiscard]] SKINCTL_INLINE constexpr const Rotation<T>& axes() const noexcept { return R_; }

  /// `R_AB` as an Eigen matrix.
  [[nodiscard]] Mat3<T> rotation() const noexcept { return as_eigen(R_); }
  /// `p_AB` as an Eigen vector [m].
  [[nodiscard]] Vec3<T> translation() const noexcept { return as_eigen(p_); }

  /// The pose as an `Eigen::Isometry3<T>`; include <Eigen/Geometry> first.
  [[nodiscard]] friend EigenIsometry<T> as_eigen(const Transform& X_AB) noexcept {
    EigenIsometry<T> X = EigenIsometry<T>::Identity();
    X.linear() = X_AB.rotation();
    X.translation() = X_AB.translation();
    return X;
  }

  /// `X_BA`, the pose of A in B.
  [[nodiscard]] SKINCTL_INLINE constexpr Transform<B, A, T> inverse() const noexcept {
    return Transform<B, A, T>::trusted(R_.transpose(), -turn_back(R_, p_));
  }
  /// The pose with orthonormal axes, after many products: see `skinctl::normalised`.
  [[nodiscard]] constexpr Transform normalised() const noexcept {
    return trusted(skinctl::normalised(R_), p_);
  }
  /// The same pose in another scalar. A wider scalar does not make the axes more orthonormal.
  template <Scalar U>
  [[nodiscard]] SKINCTL_INLINE constexpr Transform<A, B, U> cast() const noexcept {
    return Transform<A, B, U>::trusted(
        {skinctl::cast<U>(R_.x), skinctl::cast<U>(R_.y), skinctl::cast<U>(R_.z)}, skinctl::cast<U>(p_));
  }
  /// The same numbers as the pose of `D` in `C` (after a run-time index, from a file). The names are not
  /// checked.
  template <Frame C, Frame D>
  [[nodiscard]] SKINCTL_INLINE constexpr Transform<C, D, T> renamed() const noexcept {
    static_assert(!std::is_same_v<C, D>, "a frame has no pose in itself");
    return Transform<C, D, T>::trusted(R_, p_);
  }
  /// The pose with these axes and this origin, also of a frame in itself: for algorithms whose axes are
  /// orthonormal by construction up to accumulated rounding.
  [[nodiscard]] SKINCTL_INLINE static constexpr Transform trusted(const Rotation<T>& R_AB,
                                                                  const Xyz<T>& p_AB) noexcept {
    Transform X;
    X.R_ = R_AB;
    X.p_ = p_AB;
    return X;
  }

  /// `transformed(*this, q)`: `X_AB * X_BC` is `X_AC`, eq. (2); `X_AB` times a twist or wrench of B is the
  /// same quantity in A.
  template <class Q>
    requires requires(const Transform& X_AB, const Q& q) { transformed(X_AB, q); }
  [[nodiscard]] SKINCTL_INLINE constexpr auto operator*(const Q& q) const noexcept {
    return transformed(*this, q);
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // inner frames differ: invert, swap or express
  // clang-format on

  friend SKINCTL_INLINE constexpr bool operator==(const Transform& X, const Transform& Y) noexcept {
    return X.R_ == Y.R_ && X.p_ == Y.p_;
  }

 private:
  /// The pose with axes that a sine and a cosine make, NaN as well.
  [[nodiscard]] SKINCTL_INLINE static constexpr Transform turned(const Rotation<T>& R_AB) noexcept {
    static_assert(!std::is_same_v<A, B>,
                  "a frame has no pose in itself: name two, or go on from X_AB by X_AB.rotated_z(...)");
    return trusted(R_AB, {T(0), T(0), T(0)});
  }

  Rotation<T> R_;
  Xyz<T> p_{T(0), T(0), T(0)};
};

template <class X>
inline constexpr bool is_transform = false;
template <class A, class B, class T>
inline constexpr bool is_transform<Transform<A, B, T>> = true;
template <class X>
concept AnyTransform = is_transform<X>;

/// `X_AC = X_AB * X_BC`, eq. (2).
template <class A, class B, class C, class T>
[[nodiscard]] SKINCTL_INLINE constexpr Transform<A, C, T> transformed(
    const Transform<A, B, T>& X_AB, const Transform<B, C, T>& X_BC) noexcept {
  return Transform<A, C, T>::trusted(X_AB.axes() * X_BC.axes(),
                                     detail::moved(X_AB.origin(), X_AB.axes(), X_BC.origin()));
}

SKINCTL_END_NAMESPACE
