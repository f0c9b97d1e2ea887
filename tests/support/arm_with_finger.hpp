// The smallest robot of two kinds of joints.
#pragma once

#include "skinctl/model/model.hpp"

namespace skinctl::testing {

/// A column, an arm and a finger.
struct ArmWithFinger {
  static constexpr std::size_t joints = 3;
  static constexpr auto parents = chain_parents<3>();
  static constexpr auto kinds = all_of_kind<3>(JointKind::revolute);
  static constexpr double gravity[3] = {0, 0, -9.81};
  static constexpr std::array<LinkParameters<double>, 3> links = {
      make_link({.p = {0, 0, 0.3}}, {3, {0, 0, 0.1}, 0.05, 0.05, 0.04}),
      make_link({.p = {0, 0, 0.2}, .alpha = Angle::quarter(1)}, {2, {0.2, 0, 0}, 0.01, 0.06, 0.06}),
      make_link({.p = {0.4, 0, 0}}, {0.2, {0.05, 0, 0}, 1e-4, 4e-4, 4e-4})};
};
using ArmWithFingerModel = StaticModel<ArmWithFinger>;

}  // namespace skinctl::testing
