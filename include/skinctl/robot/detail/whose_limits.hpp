// SPDX-License-Identifier: BSD-3-Clause
// Refuses the limits of one robot on the model of another.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// Throws `ConfigurationError` for limits that `limits_of` took from another robot than `Description`, and
/// that are beyond its own.
template <DescribesLimits Description, std::size_t N, Real T>
SKINCTL_COLD void check_whose(const JointLimits<N, T>& limits) {
  if (limits.robot_identity() == nullptr || limits.robot_identity() == &robot_mark<Description>) return;
  const auto own = limits_of<Description, T>();
  const auto check = [](bool within, const char* what, std::size_t i, const T& x, const char* relation,
                        const T& bound) {
    if (within) return;
    char name[64], range[160];
    std::snprintf(name, sizeof name, "%s of joint %zu", what, i);
    std::snprintf(range, sizeof range,
                  "%s %.9g, the model's own: these are the limits of another robot; "
                  "JointLimits(limits.values()) insists",
                  relation, static_cast<double>(bound));
    refuse_value(name, static_cast<double>(x), range);
  };
  for (std::size_t i = 0; i < N; ++i) {
    check(limits.lower()[i] >= own.lower()[i], "lower position limit", i, limits.lower()[i],
          ">=", own.lower()[i]);
    check(limits.upper()[i] <= own.upper()[i], "upper position limit", i, limits.upper()[i],
          "<=", own.upper()[i]);
    check(limits.velocity()[i] <= own.velocity()[i], "velocity limit", i, limits.velocity()[i],
          "<=", own.velocity()[i]);
    check(limits.torque()[i] <= own.torque()[i], "torque limit", i, limits.torque()[i],
          "<=", own.torque()[i]);
  }
}

// The description of a model, or of the one that carries a load.
template <DescribesLimits D, std::size_t N, Real T>
void check_own(const StaticModel<D>&, const JointLimits<N, T>& limits) {
  check_whose<D>(limits);
}
template <DescribesLimits D, Scalar U, std::size_t N, Real T>
void check_own(const CalibratedModel<D, U>&, const JointLimits<N, T>& limits) {
  check_whose<D>(limits);
}
/// Throws `ConfigurationError` for limits of another robot, where the model has its own: see `check_whose`.
template <class M, std::size_t N, Real T>
SKINCTL_COLD void check_limits([[maybe_unused]] const M& model,
                               [[maybe_unused]] const JointLimits<N, T>& limits) {
  if constexpr (requires { check_own(model, limits); }) check_own(model, limits);
}
}  // namespace detail

SKINCTL_END_NAMESPACE
