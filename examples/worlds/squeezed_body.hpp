// What a gripper with skin reads while it squeezes a body: a generator.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// A body of some stiffness in series with skin and fingers; force and closing as they are read.
struct SqueezedBody {
  double stiffness = 1500;         ///< stiffness of the body [N/m]
  double finger_stiffness = 5000;  ///< stiffness of skin and fingers in series [N/m]
  /// Stiffening of the body per newton: `k (1 + stiffening F)`, as of peels and flesh.
  double stiffening = 0.1;
  double speed = 0.01;          ///< speed of closing [m/s]
  double rate = 250;            ///< rate of the readings [Hz]
  double force_noise = 0.05;    ///< standard deviation of the force [N]
  double force_step = 0.02;     ///< step of the force sensor [N]
  double closing_noise = 1e-4;  ///< standard deviation of the closing [m]
  double max_force = 5;         ///< force at which the fingers stop [N]

  /// Calls `f(force, closing)` [N], [m] for each reading from the first contact on, until the force is
  /// `max_force`.
  template <class F>
  void squeeze(Random& rng, F&& f) const {
    std::normal_distribution<double> normal;
    for (double force = 0, n = 0; force < max_force; ++n) {
      // Closing x = F/finger_stiffness + ln(1 + c F)/(c k): found by Newton steps from the last force.
      const double x = n * speed / rate, c = stiffening > 1e-9 ? stiffening : 1e-9;
      for (int k = 0; k < 8; ++k)
        force -= (force / finger_stiffness + std::log1p(c * force) / (c * stiffness) - x) /
                 (1 / finger_stiffness + 1 / (stiffness * (1 + c * force)));
      const double read = std::max(0.0, force + force_noise * normal(rng));
      f(force_step * std::round(read / force_step), x + closing_noise * normal(rng));
    }
  }
};

}  // namespace skinctl::testing
