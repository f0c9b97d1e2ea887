// SPDX-License-Identifier: BSD-3-Clause
// The inertia of a virtual robot, as its laws read it.
#pragma once

#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/robot/tool_shape.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The rows and columns of a mass matrix that belong to the joints of a subset.
template <class S, std::size_t N, Real T>
  requires(S::is_all)
[[nodiscard]] SKINCTL_INLINE const MassMatrix<N, T>& block_of(const MassMatrix<N, T>& whole) noexcept {
  return whole;
}
template <class S, std::size_t N, Real T>
  requires(!S::is_all)
[[nodiscard]] SKINCTL_INLINE MassMatrix<S::count, T> block_of(const MassMatrix<N, T>& whole) noexcept {
  MassMatrix<S::count, T> m;
  for (std::size_t i = 0; i < S::count; ++i)
    for (std::size_t j = 0; j < S::count; ++j) m(i, j) = whole(S::index[i], S::index[j]);
  return m;
}

/// `M u` of the joints of a subset while the others rest [N m s]: the impulse that stops them.
template <class S, std::size_t N, Real T>
[[nodiscard]] SKINCTL_INLINE JointTorque<S::count, T> momentum_of(const MassMatrix<N, T>& mass,
                                                                  const JointVelocity<N, T>& u) noexcept {
  JointTorque<S::count, T> p;
  for (std::size_t i = 0; i < S::count; ++i)
    for (std::size_t j = 0; j < S::count; ++j) p[i] = p[i] + mass(S::index[i], S::index[j]) * u[S::index[j]];
  return p;
}

/// The additions of a robot by torque to its model: the limits of its joints, and the inertia of its motors
/// at the joints, which outweighs that of a wrist's links.
template <std::size_t N, Real T = double>
class RealMass {
 public:
  using Limits = JointLimits<N, T>;
  static constexpr bool is_virtual = false;
  /// Keeps references: both must outlive this object.
  /// @param motors  inertia of the motors, seen at the joints [kg m^2], >= 0.
  SKINCTL_INLINE RealMass(const JointLimits<N, T>& limits, const JointTorque<N, T>& motors) noexcept
      : limits_(limits), motors_(motors) {}
  [[nodiscard]] SKINCTL_INLINE const JointLimits<N, T>& limits() const noexcept { return limits_; }
  /// Adds the motors' inertia to the mass matrix `m` of the links.
  template <class M, class Angles>
  SKINCTL_INLINE void add_to(MassMatrix<N, T>& m, const M&, const Angles&) const noexcept {
    for (std::size_t i = 0; i < N; ++i) m(i, i) = m(i, i) + motors_[i];
  }

 private:
  const JointLimits<N, T>& limits_;
  const JointTorque<N, T>& motors_;
};

/// The inertia of a virtual robot beside M(q) of its model: the virtual inertia of its joints, and the shape
/// of its tool. With it `Quantities` gives laws the inertia of the robot that they move: projections into a
/// null space, postures and dampers that used the bare M would disturb the task.
///
/// @tparam S  the joints of the virtual robot; the others, by torque, have their model's inertia.
template <std::size_t N, Real T = double, class Tool = NoToolShape, class S = AllJoints<N>>
class VirtualMass {
 public:
  using Limits = JointLimits<N, T>;
  static constexpr bool is_virtual = true;
  static constexpr bool shaped = !std::same_as<Tool, NoToolShape>;
  /// Keeps references: all must outlive this object.
  /// @param inertia  virtual inertia of the joints [kg m^2], >= 0.
  SKINCTL_INLINE VirtualMass(const JointLimits<N, T>& limits, const JointTorque<N, T>& inertia,
                             const Tool& tool) noexcept
      : limits_(limits), inertia_(inertia), tool_(tool) {}
  [[nodiscard]] SKINCTL_INLINE const JointLimits<N, T>& limits() const noexcept { return limits_; }

  /// Turns the model's mass matrix `m` at `angles` into that of the virtual robot, M_v.
  template <class M, class Angles>
  SKINCTL_INLINE void add_to(MassMatrix<N, T>& m, [[maybe_unused]] const M& model,
                             [[maybe_unused]] const Angles& angles) const noexcept {
    for (std::size_t i = 0; i < N; ++i) m(i, i) = m(i, i) + inertia_[i];
    if constexpr (shaped) {
      ToolTerms<S::count, Tool::rows, T> terms;
      if (tool_.template terms<detail::NoWeight, S>(model, angles, JointVelocity<N, T>{}, block_of<S>(m),
                                                    JointTorque<S::count, T>{}, T(0), terms)) {
        if constexpr (S::is_all) {
          m = terms.mass;
        } else {
          for (std::size_t i = 0; i < S::count; ++i)
            for (std::size_t j = 0; j < S::count; ++j) m(S::index[i], S::index[j]) = terms.mass(i, j);
        }
      }
    }
  }

 private:
  const JointLimits<N, T>& limits_;
  const JointTorque<N, T>& inertia_;
  const Tool& tool_;
};

SKINCTL_END_NAMESPACE
