// SPDX-License-Identifier: BSD-3-Clause
// How a frame of a robot gives way to a load.
#pragma once

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/kinematics/jacobian.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The mobility of a frame of the robot, `A = J M^-1 J'`: accelerations per force, 6 x 6, linear rows first.
/// With the factors of M it costs one solution per row.
///
/// Contacts need A itself. Its inverse is the operational-space inertia (Khatib): infinite where the frame
/// cannot move in some direction.
template <class J>
class OperationalMobility;
template <Topology M, LinkMask Columns, Frame Body, Scalar T>
class OperationalMobility<Jacobian<M, Columns, Body, Body, Base, T>> {
 public:
  using Of = Jacobian<M, Columns, Body, Body, Base, T>;
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

  /// Element `A(r, s)` of the mobility, linear rows first [1/kg, 1/(kg m), 1/(kg m^2)].
  [[nodiscard]] const T& operator()(std::size_t r, std::size_t s) const noexcept { return a_[r * 6 + s]; }

  /// `n' A n` [1/kg]: acceleration along the unit vector `n` (axes of the base) per force along it; >= 0.
  [[nodiscard]] T along(const Xyz<T>& n) const noexcept {
    const Xyz<T> a{a_[0] * n.x + a_[1] * n.y + a_[2] * n.z, a_[6] * n.x + a_[7] * n.y + a_[8] * n.z,
                   a_[12] * n.x + a_[13] * n.y + a_[14] * n.z};
    return dot(a, n);
  }

 private:
  T a_[36];
};

template <Topology M, LinkMask C, Frame Body, Scalar T, class Tree>
[[nodiscard]] auto operational_mobility(const Jacobian<M, C, Body, Body, Base, T>& J,
                                        const MassFactors<Tree, T>& mass) noexcept {
  return OperationalMobility<Jacobian<M, C, Body, Body, Base, T>>(J, mass);
}

SKINCTL_END_NAMESPACE
