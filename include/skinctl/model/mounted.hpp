// SPDX-License-Identifier: BSD-3-Clause
// A robot whose base is not upright.
#pragma once

#include "skinctl/frames/rotation.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The gravitational acceleration in the axes of a base mounted at `R_WB` (axes of the base in a world whose
/// z points up) [m/s^2].
template <Real T>
[[nodiscard]] constexpr Xyz<T> gravity_in_base(const Rotation<T>& R_WB, const T& g = T(9.81)) noexcept {
  return {T(-g * R_WB.x.z), T(-g * R_WB.y.z), T(-g * R_WB.z.z)};
}

/// `M` on a wall, a ceiling or a tilted plinth: the same model with another direction of gravity. Poses are
/// still relative to the base. The mounting may change at run time, as on a vehicle.
template <RobotModel M, Scalar T = double>
class Mounted : public M {
 public:
  using scalar = T;

  /// Throws `ConfigurationError` for axes that are no rotation (error above 1e-6), and a g beyond 1000 m/s^2.
  explicit Mounted(const M& model, const Rotation<double>& R_WB, double g = 9.81) : M(model) {
    mount(R_WB, g);
  }
  /// Sets the orientation of the base to `R_WB` from now on. Throws as the constructor does, and then changes
  /// nothing.
  void mount(const Rotation<double>& R_WB, double g = 9.81) {
    require(rotation_error(R_WB) <= 1e-6, "|R'R - 1| of a base's mounting", rotation_error(R_WB), "<= 1e-6");
    require(g >= -1000 && g <= 1000, "acceleration of free fall", g, "-1000 to 1000 m/s^2");
    const auto down = gravity_in_base(R_WB, g);
    gravity_ = {T(down.x), T(down.y), T(down.z)};
  }
  template <Scalar U>
  SKINCTL_INLINE constexpr Xyz<T> gravity() const noexcept {
    static_assert(std::same_as<U, T>, "a mounted model computes in the scalar that it stores");
    return gravity_;
  }

 private:
  Xyz<T> gravity_;
};

SKINCTL_END_NAMESPACE
