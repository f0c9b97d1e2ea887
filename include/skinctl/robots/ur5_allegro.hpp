// SPDX-License-Identifier: BSD-3-Clause
// Arms with hands: UR5 with an Allegro hand (22 joints), two of them on one base (44).
#pragma once

#include "skinctl/model/attached.hpp"
#include "skinctl/model/loaded.hpp"
#include "skinctl/robots/allegro.hpp"
#include "skinctl/robots/ur5.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace ur5_allegro {

/// An arm with a hand: joints 0 to 5 are the arm's, 6 to 21 the hand's (`allegro::Tree`), frames as there.
template <Scalar T = double>
using Model = Attached<Loaded<ur5::Model, 5, T>, 5, CalibratedModel<allegro::Tree, T>, T>;

/// Two of them on one base: joints 0 to 21 the right arm with its hand, 22 to 43 the left.
template <Scalar T = double>
using TwoModel = Attached<Attached<BareBase, -1, Model<T>, T>, -1, Model<T>, T>;

/// Pose of the hand's frame in link 5 when the heel of its palm (95 mm below that frame) lies on the flange,
/// axes alike. The thickness of an adapter is not included.
inline constexpr Stand on_flange{{}, {0, 0, ur5::Description::flange[2] + 0.095}};

/// A UR5 that carries a hand; its link 5 has the palm's inertia.
template <Scalar T = double>
[[nodiscard]] Model<T> arm_with_hand(allegro::Side side = allegro::Side::right,
                                     const Stand& stand = on_flange) {
  const Xyz<double> p{stand.p[0], stand.p[1], stand.p[2]};
  return {Loaded<ur5::Model, 5, T>(ur5::Model{}, seen_from(stand.R, p, allegro::palm)),
          allegro::hand<T>(side), stand};
}

/// Two arms with hands; `right` and `left` are the poses of their bases in a common base.
template <Scalar T = double>
[[nodiscard]] TwoModel<T> two_arms_with_hands(const Stand& right, const Stand& left) {
  return {{BareBase{}, arm_with_hand<T>(allegro::Side::right), right},
          arm_with_hand<T>(allegro::Side::left),
          left};
}

}  // namespace ur5_allegro

SKINCTL_END_NAMESPACE
