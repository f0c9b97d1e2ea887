// The largest amount of torques, for tests.
#pragma once

#include <algorithm>

#include "skinctl/core/joint.hpp"

namespace skinctl::testing {

template <std::size_t N, class T>
T largest(const JointTorque<N, T>& tau) {
  T most(0);
  for (const T& x : tau) most = std::max(most, magnitude(x));
  return most;
}

}  // namespace skinctl::testing
