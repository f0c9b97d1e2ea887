// A block that is held by friction and dragged, and the shear of a fingertip on it: a generator.
#pragma once

#include <algorithm>
#include <cmath>

namespace skinctl::testing {

/// Friction of a contact per newton of normal force: LuGre, elasto-plastic, so that what sticks does not
/// creep:
///
///     g(v) = mu_k + (mu - mu_k) exp(-(v/v_s)^2),   z' = v - a k |v| z / g,   f_t = f_n (k z + c z'),
///     a = 0 for |k z| <= 0.7 g or z v < 0, to 1 at |k z| = g
///
/// C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE TAC 40(3), 1995; P. Dupont, V. Hayward,
/// B. Armstrong, F. Altpeter, IEEE TAC 47(5), 2002.
struct Bristle {
  double mu = 0.5;           ///< friction at rest
  double share = 0.8;        ///< ratio of sliding to static friction, mu_k / mu
  double v_s = 0.005;        ///< Stribeck's speed [m/s]
  double k = 1000;           ///< stiffness of the fingertip's skin [1/m]
  double c = 5;              ///< damping of the fingertip's skin [s/m]
  double z = 0, z_rate = 0;  ///< bend of the skin [m], its rate [m/s]

  /// The friction against the speed `v` [m/s] of what is dragged [N], after `dt` [s] under the normal force
  /// `f_n` [N]. Implicit in z: stiff bristles do not ring.
  double step(double dt, double v, double f_n) {
    const double g = mu * (share + (1 - share) * std::exp(-v * v / (v_s * v_s)));
    const double a = z * v < 0 ? 0 : std::clamp((k * std::abs(z) / g - 0.7) / 0.3, 0.0, 1.0);
    const double next = (z + dt * v) / (1 + dt * a * k * std::abs(v) / g);
    z_rate = (next - z) / dt, z = next;
    return std::max(f_n, 0.0) * (k * z + c * z_rate);
  }
};

/// A block of `mass` on one contact, pulled along it by a load.
struct RubbedBlock {
  double mass = 0.25;  ///< mass of the block [kg]
  Bristle bristle{};
  double x = 0, v = 0, friction = 0;  ///< position [m], velocity [m/s], and friction that acts against it [N]

  /// Runs for `dt` [s] under the pull `load` and the normal force `f_n` [N], in steps of 20 us at most.
  void advance(double dt, double load, double f_n) {
    const int steps = static_cast<int>(std::ceil(dt / 20e-6));
    for (int k = 0; k < steps; ++k) {
      const double h = dt / steps;
      friction = bristle.step(h, v, f_n);
      v += h * (load - friction) / mass;
      x += h * v;
    }
  }
  /// The block's speed on the skin [m/s].
  [[nodiscard]] double sliding() const { return v - bristle.z_rate; }
  /// The block's displacement on the skin [m].
  [[nodiscard]] double slid() const { return x - bristle.z; }
};

}  // namespace skinctl::testing
