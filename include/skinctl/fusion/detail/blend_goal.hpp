// SPDX-License-Identifier: BSD-3-Clause
// Requests to a blended sum: other weights, a goal of one of its laws, or both.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A request for other weights, in the order of the sum; 0: the law fades out. Gravity keeps 1.
template <std::size_t Terms>
struct BlendWeights {
  std::array<double, Terms> of{};

  template <class F>
  friend void each_number(BlendWeights& w, F&& f) {
    for (double& x : w.of) f(x);
  }
};

/// Calls `f` for whether there is a value, then for its numbers, or for those of `V{}`.
template <class V, class F>
void each_optional(std::optional<V>& value, F&& f) {
  bool has = value.has_value();
  V numbers = has ? *value : V{};
  f(has);
  each_number(numbers, f);
  value.reset();
  if (has) value = numbers;
}

/// A request to a blended sum whose laws take goals of type `G`: a goal, weights, or both.
template <class G, std::size_t Terms>
struct BlendGoal {
  std::optional<G> goal = {};
  std::optional<BlendWeights<Terms>> weights = {};

  template <class F>
  friend void each_number(BlendGoal& g, F&& f) {
    each_optional(g.goal, f);
    each_optional(g.weights, f);
  }
};

SKINCTL_END_NAMESPACE
