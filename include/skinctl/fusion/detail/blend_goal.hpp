// Requests to a blended sum: other weights, a goal of one of its laws, or both.
#pragma once

#include <array>
#include <cstddef>

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

/// A request to a blended sum whose laws take goals of type `G`: a goal, weights, or both.
template <class G, std::size_t Terms>
struct BlendGoal {
  bool has_goal = false;
  G goal{};
  bool has_weights = false;
  BlendWeights<Terms> weights{};

  template <class F>
  friend void each_number(BlendGoal& g, F&& f) {
    f(g.has_goal);
    each_number(g.goal, f);
    f(g.has_weights);
    each_number(g.weights, f);
  }
};

SKINCTL_END_NAMESPACE
