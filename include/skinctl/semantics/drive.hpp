// SPDX-License-Identifier: BSD-3-Clause
// Drives as activities of a plan: to a place, at which everything is looked at again.
#pragma once

#include "skinctl/semantics/activity.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace activity {
/// The base drives to the place of the step, where `There` holds; of its own facts an application names one
/// for each place, and those of the others as `Elsewhere`: `Drive<fact::own<0>, fact::own<1>>`.
///
/// A drive takes away what was seen: a plan whose hand reaches for something behind one without a `Look`, or
/// puts something down beside a landmark without a `Find`, is refused by `check`. What is in the hand is
/// carried along.
template <Facts There, Facts Elsewhere = fact::none>
struct Drive {
  static_assert(There.any() && !(There & Elsewhere).any(), "a place has a fact of its own");
  static constexpr ActivityRule rule{
      .name = "drive",
      .adds = There,
      .removes = Elsewhere | fact::seen | fact::above | fact::around | fact::there | fact::marked,
      .timeout = 60s};
};
}  // namespace activity

SKINCTL_END_NAMESPACE
