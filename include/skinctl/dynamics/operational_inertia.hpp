// SPDX-License-Identifier: BSD-3-Clause
// The inertia of a robot at a frame: operational-space inertia, and the effective mass at a contact.
#pragma once

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/frames/acceleration.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The mobility of a frame of the robot, `A = J M^-1 J'`: accelerations per force, 6 x 6, linear rows first.
/// With the factors of M it costs one solution per row.
///
/// Contacts need A itself. Its inverse is the operational-space inertia; where the frame cannot move in some
/// direction A is singular, and the inertia there is infinite.
template <class J>
class OperationalMobility;
template <Topology M, LinkMask Columns, Frame Body, Scalar T>
class OperationalMobility<Jacobian<M, Columns, Body, Body, Base, T>> {
 public:
  using Of = Jacobian<M, Columns, Body, Body, Base, T>;
  using Load = typename Of::Load;
  using BodyAcceleration = Acceleration<Body, Base, Body, Base, T>;
  static constexpr std::size_t joints = M::joints;

  template <class Tree>
  OperationalMobility(const Of& J, const MassFactors<Tree, T>& mass) noexcept {
    static_assert(Tree::joints == M::joints, "the Jacobian and the mass matrix are of two robots");
    for (std::size_t r = 0; r < 6; ++r) {
      JointTorque<joints, T> row;
      J.for_each([&](auto i, const auto& c) {
        const T six[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
        row[i.value] = six[r];
      });
      const JointAcceleration<joints, T> ddq = mass.solve(row);
      Xyz<T> linear{T(0), T(0), T(0)}, angular{T(0), T(0), T(0)};
      J.for_each([&](auto i, const auto& c) {
        linear = linear + ddq[i.value] * c.linear;
        angular = angular + ddq[i.value] * c.angular;
      });
      const T six[6] = {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z};
      for (std::size_t s = 0; s <= r; ++s) a_[r * 6 + s] = a_[s * 6 + r] = six[s];
    }
  }

  /// `A(r, s)`, linear rows first [1/kg, 1/(kg m), 1/(kg m^2)].
  [[nodiscard]] const T& operator()(std::size_t r, std::size_t s) const noexcept { return a_[r * 6 + s]; }

  /// `A F`: the acceleration due to a load on the frame [m/s^2, rad/s^2].
  [[nodiscard]] BodyAcceleration operator*(const Load& F) const noexcept {
    const T f[6] = {F.force.x, F.force.y, F.force.z, F.moment.x, F.moment.y, F.moment.z};
    T x[6];
    for (std::size_t r = 0; r < 6; ++r) {
      x[r] = T(0);
      for (std::size_t s = 0; s < 6; ++s) x[r] = x[r] + a_[r * 6 + s] * f[s];
    }
    return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // takes a wrench on the Jacobian's body, at its origin, along the base's axes
  // clang-format on

  /// `n' A n` [1/kg]: acceleration along the unit vector `n` (axes of the base) per force along it; >= 0.
  [[nodiscard]] T along(const Xyz<T>& n) const noexcept {
    const Xyz<T> a{a_[0] * n.x + a_[1] * n.y + a_[2] * n.z, a_[6] * n.x + a_[7] * n.y + a_[8] * n.z,
                   a_[12] * n.x + a_[13] * n.y + a_[14] * n.z};
    return dot(a, n);
  }

  /// A as a 6 x 6 matrix.
  [[nodiscard]] friend Mat6<T> as_eigen(const OperationalMobility& A) noexcept {
    Mat6<T> m;
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t s = 0; s < 6; ++s)
        m(static_cast<std::ptrdiff_t>(r), static_cast<std::ptrdiff_t>(s)) = A(r, s);
    return m;
  }

 private:
  T a_[36];
};

template <Topology M, LinkMask C, Frame Body, Scalar T, class Tree>
[[nodiscard]] auto operational_mobility(const Jacobian<M, C, Body, Body, Base, T>& J,
                                        const MassFactors<Tree, T>& mass) noexcept {
  return OperationalMobility<Jacobian<M, C, Body, Body, Base, T>>(J, mass);
}

/// The effective mass at the frame's origin along the unit vector `n`, `1 / (n' J M^-1 J' n)` [kg]; at a
/// cell, n is its normal. At most `heaviest`, which is the mass of an immobile frame (at a singularity, or
/// pushed along its link): `1 / max(n' A n, 1 / heaviest)`.
template <class J, Scalar T>
[[nodiscard]] T effective_mass(const OperationalMobility<J>& A, const Xyz<T>& n, const T& heaviest) noexcept {
  const T give = A.along(n);
  const T least = T(1) / heaviest;
  return T(1) / select(give > least, give, least);
}

/// The operational-space inertia `Lambda = (J M^-1 J' + softness)^-1` (Khatib): `Lambda a` is the load that
/// gives the frame the acceleration `a`.
template <class J, Scalar T>
class OperationalInertia {
 public:
  using Mobility = OperationalMobility<J>;

  /// @param softness  added to the diagonal of A [1/kg], [1/(kg m^2)], >= 0: it limits the inertia to
  ///                  `1 / softness` in every direction. 0 away from singularities; near them
  ///                  `DampedInverse::nearness() / heaviest`, which grows smoothly. With 0 at a singularity
  ///                  the load along an immobile direction is 0, and `positive_definite()` false. A body with
  ///                  fewer than six joints always needs a softness above 0.
  OperationalInertia(const Mobility& A, const T& softness) noexcept : factors_(softened(A, softness).data) {}

  /// `Lambda a` [N, N m], on the frame along the axes of the base.
  [[nodiscard]] typename Mobility::Load operator*(
      const typename Mobility::BodyAcceleration& a) const noexcept {
    T x[6] = {a.linear.x, a.linear.y, a.linear.z, a.angular.x, a.angular.y, a.angular.z};
    factors_.solve(x, x);
    return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // takes an acceleration of the Jacobian's body
  // clang-format on

  /// False if an immobile direction was removed, in any lane.
  [[nodiscard]] bool positive_definite() const noexcept { return factors_.positive_definite(); }

 private:
  struct Matrix {
    T data[36];
  };
  static Matrix softened(const Mobility& A, const T& softness) noexcept {
    Matrix m;
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t s = 0; s < 6; ++s) m.data[r * 6 + s] = r == s ? T(A(r, s) + softness) : A(r, s);
    return m;
  }
  math::Ldlt<6, T> factors_;
};
template <class J, Scalar T>
OperationalInertia(const OperationalMobility<J>&, const T&) -> OperationalInertia<J, T>;

SKINCTL_END_NAMESPACE
