// A UR5 that follows a law under random touches, and its overshoot beyond the target after each release.
#pragma once

#include <algorithm>
#include <cmath>

#include "skinctl/law/evaluate.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/tracking/joint_space.hpp"
#include "skinctl/trajectory/quintic.hpp"

namespace skinctl::testing {

template <class T>
using Skinned = LinkWrenches<ur5::Model, 0b110110, T>;

/// A force on link 2, about 0.2 m off its origin.
inline Skinned<double> touch_of(double x, double y, double z) {
  Skinned<double> touch;
  touch.set<2>({{x, y, z}, {0.05 * z, -0.1 * z, 0.1 * y - 0.05 * x}});
  return touch;
}

struct Swings {
  int counted = 0;       ///< deflections of joints by 0.02 rad or more
  double furthest = 0;   ///< [rad]
  double overshoot = 0;  ///< the largest, as a share of its deflection
  double fastest = 0;    ///< largest rate of any joint's torque without the skin's [N m/s]
};

/// Touches of 10 to 40 N in any direction for 0.3 to 2 s, on the way to a goal or at it, each followed by at
/// least 2.5 s without. The law's first share is the skin's.
/// @param wanted  the present joint target of a memory.
template <class L, class Wanted>
Swings touch_and_release(const L& law, Wanted&& wanted, double rate, int trials, unsigned seed = 101) {
  using K = Quantities<ur5::Model, L::needs, double, Skinned<double>>;
  const ur5::Model model;
  const double dt = 1 / rate;
  const Skinned<double> untouched;
  Seeded rng(seed);
  Swings out;
  for (int trial = 0; trial < trials; ++trial) {
    State<6> x{0ns, rng.vector<JointPosition<6>>(1.5), {}};
    JointGoal<6> goal{x.q, nanoseconds(rng.between(1.5, 3))};
    for (double& q : goal.q_g) q += 0.6 * rng();
    auto memory = law.start(K(model, x, dt, untouched));
    memory = law.receive(memory, K(model, x, dt, untouched), goal).memory;
    const double begin = rng.between(0.2, 2.5), lasts = rng.between(0.3, 2);
    const double force = rng.between(10, 40);
    const double u = rng(), v = rng(), w = rng(), size = std::sqrt(u * u + v * v + w * w);
    const auto touch = touch_of(force * u / size, force * v / size, force * w / size);
    JointPosition<6> deflection, side, over;
    JointTorque<6> last;
    for (int i = 0; i < static_cast<int>(7 * rate); ++i) {
      const double t = i * dt;
      const double since = std::min(t - begin, begin + lasts - t);
      const Skinned<double> now = quintic(since / 0.1).a1 * touch;
      const K known(model, x, dt, now);
      const auto e = evaluate(law, memory, known, dt);
      const auto target = wanted(memory);
      for (std::size_t j = 0; j < 6; ++j) {
        const double off = x.q[j] - target[j];
        if (t < begin + lasts + 0.06) {
          if (detail::magnitude(off) > detail::magnitude(deflection[j])) deflection[j] = off;
          side[j] = off;
        } else if (off * side[j] < 0) {
          over[j] = std::max(over[j], detail::magnitude(off));
        }
      }
      const auto own = e.torque - e.shares[0];
      if (i > 0)
        for (std::size_t j = 0; j < 6; ++j)
          out.fastest = std::max(out.fastest, detail::magnitude(own[j] - last[j]) * rate);
      last = own;
      memory = e.memory;
      x = simulate(model, x, e.torque, dt, 1);
    }
    for (std::size_t j = 0; j < 6; ++j) {
      const double far = detail::magnitude(deflection[j]);
      if (far < 0.02) continue;
      ++out.counted;
      out.furthest = std::max(out.furthest, far);
      out.overshoot = std::max(out.overshoot, over[j] / far);
    }
  }
  return out;
}

}  // namespace skinctl::testing
