// SPDX-License-Identifier: BSD-3-Clause
// The parameters of one link of a model: the placement of its joint in the parent, and its inertia.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/real.hpp"
#include "skinctl/frames/symmetric.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The parameters of a link, by name. The link's frame has its z axis on its joint; its pose in the parent is
/// `Rz(gamma) Rx(alpha)` at origin `p`, followed by the motion `Rz(q + offset)` (or `q + offset` along z).
/// Every tree of one-axis joints has this form: the parent's x axis is chosen perpendicular to both joint
/// axes, so that the first child has gamma = 0; each further child needs its own gamma. Near-parallel axes
/// are no special case, because `p` has three numbers (a DH row of four numbers is ill-conditioned there).
enum class LinkParameter : std::size_t {
  cos_gamma,
  sin_gamma,
  cos_alpha,
  sin_alpha,
  p_x,  ///< origin of the joint in the parent's frame [m]
  p_y,
  p_z,
  offset,    ///< offset of the joint, added to q [rad] or [m]
  cos_beta,  ///< cosine of beta, a constant turn of the link about z, of a prismatic joint only
  sin_beta,
  mass,  ///< mass [kg]
  c_x,   ///< centre of mass in the link's frame [m]
  c_y,
  c_z,
  s_xx,  ///< second moments of mass about the centre of mass, link axes [kg m^2]: S = tr(I)/2 1 - I
  s_yy,
  s_zz,
  s_xy,
  s_xz,
  s_yz,
  count
};

/// The parameters of one link, indexed by `LinkParameter`.
template <Scalar T = double>
struct LinkParameters {
  std::array<T, std::size_t(LinkParameter::count)> numbers{};

  constexpr T& operator[](LinkParameter p) noexcept { return numbers[std::size_t(p)]; }
  constexpr const T& operator[](LinkParameter p) const noexcept { return numbers[std::size_t(p)]; }

  /// The same parameters in another scalar.
  template <Scalar U>
  constexpr LinkParameters<U> cast() const {
    LinkParameters<U> out;
    for (std::size_t i = 0; i < numbers.size(); ++i) out.numbers[i] = U(numbers[i]);
    return out;
  }
};

/// Cosine and sine of a placement's angle. `quarter(k)` is exact for multiples of a right angle, so that a
/// static model recognises its zeros and ones.
struct Angle {
  double cos = 1, sin = 0;
  static constexpr Angle quarter(int k) noexcept {
    constexpr double c[4] = {1, 0, -1, 0};
    constexpr double s[4] = {0, 1, 0, -1};
    return {c[k & 3], s[k & 3]};
  }
  static Angle radians(double a) noexcept { return {std::cos(a), std::sin(a)}; }
};

/// The placement of a joint in its parent link. See `LinkParameter`.
struct JointPlacement {
  double p[3] = {0, 0, 0};  ///< origin of the joint in the parent's frame [m]
  Angle alpha{};
  Angle gamma{};
  double offset = 0;  ///< offset of the joint, added to q [rad] or [m]
  Angle beta{};       ///< constant turn of the link about z; prismatic joints only
};

/// Mass [kg], centre of mass (link's frame) [m] and inertia about the centre of mass (link's axes) [kg m^2],
/// as makers publish them.
struct LinkInertia {
  double mass = 0;
  double c[3] = {0, 0, 0};
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

/// The inertia of two bodies fixed to each other, both given in the same frame: a link and its tip, a flange
/// and its payload.
constexpr LinkInertia combined(const LinkInertia& a, const LinkInertia& b) noexcept {
  LinkInertia sum;
  sum.mass = a.mass + b.mass;
  if (!(sum.mass > 0)) return a;
  for (std::size_t k = 0; k < 3; ++k) sum.c[k] = (a.mass * a.c[k] + b.mass * b.c[k]) / sum.mass;
  const double reduced = a.mass * b.mass / sum.mass;
  const double x = b.c[0] - a.c[0], y = b.c[1] - a.c[1], z = b.c[2] - a.c[2];
  sum.xx = a.xx + b.xx + reduced * (y * y + z * z);
  sum.yy = a.yy + b.yy + reduced * (x * x + z * z);
  sum.zz = a.zz + b.zz + reduced * (x * x + y * y);
  sum.xy = a.xy + b.xy - reduced * x * y;
  sum.xz = a.xz + b.xz - reduced * x * z;
  sum.yz = a.yz + b.yz - reduced * y * z;
  return sum;
}

/// The inertia in axes that are rotated by `t` about z: `Rz(t)' I Rz(t)`.
constexpr LinkInertia turned_back_z(const LinkInertia& in, const Angle& t) noexcept {
  const double c = t.cos, s = t.sin;
  LinkInertia out = in;
  out.c[0] = c * in.c[0] + s * in.c[1];
  out.c[1] = c * in.c[1] - s * in.c[0];
  out.xx = c * c * in.xx + 2 * c * s * in.xy + s * s * in.yy;
  out.yy = s * s * in.xx - 2 * c * s * in.xy + c * c * in.yy;
  out.xy = c * s * (in.yy - in.xx) + (c * c - s * s) * in.xy;
  out.xz = c * in.xz + s * in.yz;
  out.yz = c * in.yz - s * in.xz;
  return out;
}

/// A link of a model from its placement and inertia.
constexpr LinkParameters<double> make_link(const JointPlacement& placement,
                                           const LinkInertia& inertia) noexcept {
  using P = LinkParameter;
  LinkParameters<double> l;
  l[P::cos_gamma] = placement.gamma.cos;
  l[P::sin_gamma] = placement.gamma.sin;
  l[P::cos_alpha] = placement.alpha.cos;
  l[P::sin_alpha] = placement.alpha.sin;
  l[P::p_x] = placement.p[0];
  l[P::p_y] = placement.p[1];
  l[P::p_z] = placement.p[2];
  l[P::offset] = placement.offset;
  l[P::cos_beta] = placement.beta.cos;
  l[P::sin_beta] = placement.beta.sin;
  l[P::mass] = inertia.mass;
  l[P::c_x] = inertia.c[0];
  l[P::c_y] = inertia.c[1];
  l[P::c_z] = inertia.c[2];
  l[P::s_xx] = 0.5 * (inertia.yy + inertia.zz - inertia.xx);
  l[P::s_yy] = 0.5 * (inertia.xx + inertia.zz - inertia.yy);
  l[P::s_zz] = 0.5 * (inertia.xx + inertia.yy - inertia.zz);
  l[P::s_xy] = -inertia.xy;
  l[P::s_xz] = -inertia.xz;
  l[P::s_yz] = -inertia.yz;
  return l;
}

/// The inertia from which a link was made.
constexpr LinkInertia inertia_of(const LinkParameters<double>& l) noexcept {
  using P = LinkParameter;
  return {l[P::mass],
          {l[P::c_x], l[P::c_y], l[P::c_z]},
          l[P::s_yy] + l[P::s_zz],
          l[P::s_xx] + l[P::s_zz],
          l[P::s_xx] + l[P::s_yy],
          -l[P::s_xy],
          -l[P::s_xz],
          -l[P::s_yz]};
}

/// Physical inconsistency of a link's inertia: minus the smallest of its three principal second moments of
/// mass, relative to their sum; 0 for every real body. A second moment is negative exactly if the principal
/// moments of inertia violate the triangle inequality, `I_1 + I_2 < I_3`. Infinite for NaN, and where the sum
/// of the moments is not positive.
template <Real T>
[[nodiscard]] double density_defect(const LinkParameters<T>& l) noexcept {
  using P = LinkParameter;
  const auto number = [&](P p) { return static_cast<double>(l[p]); };
  const Symmetric<double> S{number(P::s_xx), number(P::s_yy), number(P::s_zz),
                            number(P::s_xy), number(P::s_xz), number(P::s_yz)};
  const Xyz<double> s = eigenvalues(S);
  if (s.x >= 0) return 0;
  return s.x + s.y + s.z > 0 ? -s.x / (s.x + s.y + s.z) : std::numeric_limits<double>::infinity();
}

/// Allowed values of `density_defect`: rounding only, or that of published files. Some files have products of
/// inertia that no body has; the worst link of an Allegro hand has 0.164. Its principal moments are still
/// positive, so M stays positive definite and kinetic energy positive.
inline constexpr double rounded_density = 1e-9, makers_density = 0.18;

/// Throws `ConfigurationError` unless the link is physically possible: finite numbers, mass >= 0, unit
/// angles, principal moments of inertia >= 0, and a `density_defect` of at most `allowed_defect` or the
/// rounding of `T`, whichever is greater.
template <Real T>
void check_link(const LinkParameters<T>& l, double allowed_defect = rounded_density) {
  using P = LinkParameter;
  for (std::size_t i = 0; i < l.numbers.size(); ++i) {
    const double x = static_cast<double>(l.numbers[i]);
    require(x - x == 0, "link parameter", x, "a finite number");
  }
  const auto number = [&](P p) { return static_cast<double>(l[p]); };
  require(number(P::mass) >= 0, "link mass", number(P::mass), ">= 0 kg");
  const auto unit = [&](P c, P s) { return number(c) * number(c) + number(s) * number(s); };
  const double near = 1e-5;
  const double alpha = unit(P::cos_alpha, P::sin_alpha), gamma = unit(P::cos_gamma, P::sin_gamma),
               beta = unit(P::cos_beta, P::sin_beta);
  require(alpha > 1 - near && alpha < 1 + near, "cos^2 + sin^2 of alpha", alpha, "1");
  require(beta > 1 - near && beta < 1 + near, "cos^2 + sin^2 of beta", beta, "1");
  require(gamma > 1 - near && gamma < 1 + near, "cos^2 + sin^2 of gamma", gamma, "1");
  const double rounding = 16 * static_cast<double>(std::numeric_limits<T>::epsilon());
  const double slack = rounding > rounded_density ? rounding : rounded_density;
  const LinkInertia in = inertia_of(l.template cast<double>());
  const Symmetric<double> Ix{in.xx, in.yy, in.zz, in.xy, in.xz, in.yz};
  const double least = eigenvalues(Ix).x;
  require(least >= -slack * Ix.trace(), "smallest principal moment of inertia", least, ">= 0 kg m^2");
  const double defect = density_defect(l);
  require(defect <= (slack > allowed_defect ? slack : allowed_defect),
          "negative part of the second moments of mass", defect,
          "0 (triangle inequality of the principal moments of inertia; a maker's file: see makers_density)");
}

SKINCTL_END_NAMESPACE
