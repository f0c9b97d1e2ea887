// SPDX-License-Identifier: BSD-3-Clause
// Masses and inertias that a URDF does not give, or that no body has.
#pragma once

#include <Eigen/Eigenvalues>
#include <numbers>

#include "skinctl/io/detail/urdf_text.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Replaces the moments by those of the nearest second moments of mass that are not negative, in the
/// Frobenius norm: negative eigenvalues become 0.
/// @return the distance [kg m^2].
inline double make_possible(LinkInertia& in) {
  const double half = 0.5 * (in.xx + in.yy + in.zz);
  Mat3<double> S;
  S << half - in.xx, -in.xy, -in.xz, -in.xy, half - in.yy, -in.yz, -in.xz, -in.yz, half - in.zz;
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> solver(S);
  const Mat3<double> V = solver.eigenvectors();
  const Mat3<double> P = V * solver.eigenvalues().cwiseMax(0.0).asDiagonal() * V.transpose();
  in.xx = P(1, 1) + P(2, 2), in.yy = P(0, 0) + P(2, 2), in.zz = P(0, 0) + P(1, 1);
  in.xy = -P(0, 1), in.xz = -P(0, 2), in.yz = -P(1, 2);
  return (P - S).norm();
}

/// Collision geometry of a body as solids of 1 kg/m^3, in its joint's frame.
struct UrdfShapes {
  LinkInertia solid{};
  bool any = false;
  bool unknown = false;  ///< whether a shape is a mesh, whose volume is not read

  void add(const UrdfText& text, const tinyxml2::XMLElement& link, const UrdfPlace& X_link) {
    for (auto* c = link.FirstChildElement("collision"); c; c = c->NextSiblingElement("collision")) {
      const auto* geometry = c->FirstChildElement("geometry");
      const auto* shape = geometry ? geometry->FirstChildElement() : nullptr;
      if (shape == nullptr) continue;
      const auto size = [&](const char* name) { return std::abs(text.number(link, *shape, name)); };
      LinkInertia in;
      if (std::strcmp(shape->Name(), "box") == 0) {
        const auto s = text.numbers<3>(link, *shape, "size", nullptr);
        in = box(std::abs(s[0]), std::abs(s[1]), std::abs(s[2]));
      } else if (std::strcmp(shape->Name(), "cylinder") == 0) {
        const double r = size("radius"), l = size("length");
        in = cylinder(std::numbers::pi * r * r * l, r, l);
      } else if (std::strcmp(shape->Name(), "sphere") == 0) {
        const double r = size("radius"), m = 4.0 / 3.0 * std::numbers::pi * r * r * r,
                     moment = 0.4 * m * r * r;
        in = {m, {0, 0, 0}, moment, moment, moment, 0, 0, 0};
      } else {
        unknown = true;
        continue;
      }
      if (!(in.mass > 0 && in.mass < 1e6)) continue;
      const UrdfPlace X = product(X_link, text.origin(link, *c));
      const LinkInertia part = seen_from(X.R, X.p, in);
      solid = any ? combined(solid, part) : part;
      any = true;
    }
  }
  static LinkInertia box(double x, double y, double z) {
    const double m = x * y * z, f = m / 12;
    return {m, {0, 0, 0}, f * (y * y + z * z), f * (x * x + z * z), f * (x * x + y * y), 0, 0, 0};
  }
  /// A cylinder about z.
  static LinkInertia cylinder(double m, double radius, double length) {
    const double across = m * (3 * radius * radius + length * length) / 12, along = m * radius * radius / 2;
    return {m, {0, 0, 0}, across, across, along, 0, 0, 0};
  }
};

/// Spreads a mass over the links without one: see `UrdfOptions::total_mass`.
class UrdfEstimate {
 public:
  /// `urdf` with the frames of its file; must outlive this object.
  explicit UrdfEstimate(Urdf& urdf) : urdf_(urdf) {
    for (const UrdfJoint& j : urdf_.joints) given_ += j.placed.inertia.mass;
  }
  /// Adds the shapes of the next joint's body.
  void add(const UrdfShapes& shapes) { shapes_.push_back(&shapes); }

  /// Mass of the links that the file gives [kg].
  [[nodiscard]] double given() const { return given_; }
  /// Spreads what is left of a mass of all links [kg]. False if nothing is left, and a link needs it.
  bool spread(double total) {
    std::vector<std::size_t> open;
    bool needs = false;
    by_shape_ = true;
    for (std::size_t j = 0, a = 0; j < urdf_.joints.size() && a < urdf_.assumed_masses.size(); ++j) {
      if (urdf_.joints[j].link != urdf_.assumed_masses[a].link) continue;
      open.push_back(j);
      by_shape_ = by_shape_ && shapes_[j]->any && !shapes_[j]->unknown;
      needs = needs || urdf_.assumed_masses[a].mass == 0;
      ++a;
    }
    const double mass = total - given_;
    if (needs && !(mass > 0)) return false;
    measure();
    std::vector<double> share;
    double sum = 0;
    for (std::size_t a = 0; a < open.size(); ++a) {
      const std::size_t j = open[a];
      const bool given = urdf_.assumed_masses[a].mass > 0;  // it lacks an inertia only
      share.push_back(given       ? 0
                      : by_shape_ ? shapes_[j]->solid.mass
                                  : length(j) * std::cbrt(reach_[j] * reach_[j]));
      sum += share.back();
    }
    for (std::size_t a = 0; a < open.size(); ++a) {
      LinkInertia& in = urdf_.joints[open[a]].placed.inertia;
      const double m =
          urdf_.assumed_masses[a].mass > 0 ? urdf_.assumed_masses[a].mass : mass * share[a] / sum;
      in = by_shape_ ? scaled(shapes_[open[a]]->solid, m) : rod(open[a], m);
      urdf_.assumed_masses[a].mass = m;
    }
    return true;
  }
  /// The estimated masses and their source, for a warning.
  [[nodiscard]] std::string words(double total) const {
    return "masses estimated from " + urdf_number(total) + " kg in all by " +
           (by_shape_ ? "volumes of collision shapes" : "lengths of links") + ": " +
           listed(urdf_.assumed_masses,
                  [](const UrdfAssumedMass& a) { return a.link + " " + urdf_number(a.mass) + " kg"; }) +
           "; by torque the model is refused";
  }

 private:
  static constexpr double bulk_density = 1500;  ///< density of arms, castings with motors inside [kg/m^3]
  static constexpr double wrist_share =
      0.05;  ///< length of a link whose joint and end coincide, over the longest reach

  /// Finds the furthest point of each link from its joint, and the length that the joint carries.
  void measure() {
    const std::size_t n = urdf_.joints.size();
    end_.resize(n);
    reach_.assign(n, 0);
    const auto extend = [&](int j, const Xyz<double>& p) {
      if (j >= 0 && norm(p) > norm(end_[std::size_t(j)])) end_[std::size_t(j)] = p;
    };
    const auto origin = [&](std::size_t j) {
      const auto& p = urdf_.joints[j].placed.p;
      return Xyz<double>{p[0], p[1], p[2]};
    };
    for (const UrdfFrame& f : urdf_.frames) extend(f.joint, f.p);
    for (std::size_t j = 0; j < n; ++j) extend(urdf_.joints[j].parent, origin(j));
    for (std::size_t j = n; j-- > 0;) {
      reach_[j] = std::max(reach_[j], norm(end_[j]));
      longest_ = std::max(longest_, reach_[j]);
      if (const int parent = urdf_.joints[j].parent; parent >= 0) {
        double& above = reach_[std::size_t(parent)];
        above = std::max(above, norm(origin(j)) + reach_[j]);
      }
    }
    for (double& r : reach_) r = std::max(r, shortest());
  }
  double shortest() const { return longest_ > 0 ? wrist_share * longest_ : 0.1; }
  double length(std::size_t j) const { return std::max(norm(end_[j]), shortest()); }

  static LinkInertia scaled(LinkInertia in, double mass) {
    const double f = mass / in.mass;
    for (double* x : {&in.xx, &in.yy, &in.zz, &in.xy, &in.xz, &in.yz}) *x *= f;
    in.mass = mass;
    return in;
  }
  /// A cylinder from the joint to the link's end.
  LinkInertia rod(std::size_t j, double mass) const {
    const double l = length(j), square = mass / (bulk_density * std::numbers::pi * l);
    const double across = mass * (3 * square + l * l) / 12, less = across - mass * square / 2;
    const Xyz<double> end = end_[j];
    const Xyz<double> u = norm(end) > 0 ? (1 / norm(end)) * end : Xyz<double>{0, 0, 1};
    return {mass,
            {0.5 * end.x, 0.5 * end.y, 0.5 * end.z},
            across - less * u.x * u.x,
            across - less * u.y * u.y,
            across - less * u.z * u.z,
            -less * u.x * u.y,
            -less * u.x * u.z,
            -less * u.y * u.z};
  }

  Urdf& urdf_;
  std::vector<const UrdfShapes*> shapes_;
  std::vector<Xyz<double>> end_;
  std::vector<double> reach_;
  double longest_ = 0, given_ = 0;
  bool by_shape_ = true;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
