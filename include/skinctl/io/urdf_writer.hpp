// SPDX-License-Identifier: BSD-3-Clause
// Any model as a URDF, with capsules to look at. Needs no parser.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/clearance/capsule.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/core/xml_text.hpp"
#include "skinctl/frames/rotation.hpp"
#include "skinctl/io/detail/from_chars.hpp"
#include "skinctl/io/formatted.hpp"
#include "skinctl/model/model.hpp"
#include "skinctl/model/named_links.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The contents of a URDF beside the model. Everything may be left out.
struct UrdfDress {
  std::string name = "robot";
  std::string base = "base_link";
  std::vector<std::string> joints{};  ///< names; missing ones are "joint_1", ...
  std::vector<std::string> links{};   ///< names of the moving links; missing ones are "link_1", ...
  struct Limit {
    double lower = 0, upper = 0;  ///< position limits [rad] or [m]
    double velocity = 0, effort = 0;
  };
  std::vector<Limit> limits{};          ///< limits of each joint; without them revolute joints are continuous
  std::vector<LinkCapsule> capsules{};  ///< shapes for viewers, in the links' frames; fixed ones in the base
  std::vector<NamedLink> named_links{};  ///< frames fixed to links, as links without mass
};

namespace detail {

/// Writes the elements of a URDF.
class UrdfBuilder {
 public:
  explicit UrdfBuilder(const UrdfDress& dress) : dress_(dress) {
    text_ = "<?xml version=\"1.0\"?>\n<robot name=\"" + xml_text(dress.name) + "\">\n";
  }
  [[nodiscard]] std::string joint(std::size_t i) const { return given(dress_.joints, i, "joint_"); }
  [[nodiscard]] std::string link(int i) const {
    return i < 0 ? dress_.base : given(dress_.links, static_cast<std::size_t>(i), "link_");
  }
  /// Writes a link of the model with its inertia, or the base, whose `i` is -1.
  void add_link(int i, const LinkParameters<double>* l) {
    using P = LinkParameter;
    text_ += "  <link name=\"" + xml_text(link(i)) + "\">\n";
    if (l != nullptr) {
      const auto& n = *l;
      const double trace = n[P::s_xx] + n[P::s_yy] + n[P::s_zz];
      text_ += "    <inertial>\n      <origin xyz=\"" + list({n[P::c_x], n[P::c_y], n[P::c_z]}) +
               "\"/>\n      <mass value=\"" + list({n[P::mass]}) + "\"/>\n      <inertia ixx=\"" +
               list({trace - n[P::s_xx]}) + "\" iyy=\"" + list({trace - n[P::s_yy]}) + "\" izz=\"" +
               list({trace - n[P::s_zz]}) + "\" ixy=\"" + list({-n[P::s_xy]}) + "\" ixz=\"" +
               list({-n[P::s_xz]}) + "\" iyz=\"" + list({-n[P::s_yz]}) + "\"/>\n    </inertial>\n";
    }
    for (const LinkCapsule& c : dress_.capsules)
      if ((c.link == LinkCapsule::fixed && i < 0) || (i >= 0 && c.link == static_cast<std::size_t>(i)))
        look(c.shape);
    text_ += "  </link>\n";
  }
  /// Writes the joint of a link: its frame at q = 0 is the link's, z on its axis.
  void add_joint(std::size_t i, int parent, JointKind kind, const LinkParameters<double>& n) {
    using P = LinkParameter;
    const bool turns = kind == JointKind::revolute;
    const double g = n[P::sin_gamma], h = n[P::cos_gamma], s = n[P::sin_alpha], c = n[P::cos_alpha];
    const Rotation<double> tilted{{h, g, 0}, {-g * c, h * c, s}, {g * s, -h * s, c}};
    const Angle about = turns ? Angle::radians(n[P::offset]) : Angle{n[P::cos_beta], n[P::sin_beta]};
    const Rotation<double> R =
        tilted * Rotation<double>{{about.cos, about.sin, 0}, {-about.sin, about.cos, 0}, {0, 0, 1}};
    Xyz<double> p{n[P::p_x], n[P::p_y], n[P::p_z]};
    if (!turns) p = p + n[P::offset] * R.z;
    const bool limited = i < dress_.limits.size();
    text_ += "  <joint name=\"" + xml_text(joint(i)) + "\" type=\"" +
             (!turns    ? "prismatic"
              : limited ? "revolute"
                        : "continuous") +
             "\">\n    " + origin(R, p) + "\n    <parent link=\"" + xml_text(link(parent)) +
             "\"/>\n    <child link=\"" + xml_text(link(static_cast<int>(i))) +
             "\"/>\n    <axis xyz=\"0 0 1\"/>\n";
    if (limited) {
      const auto& l = dress_.limits[i];
      text_ += "    <limit lower=\"" + list({l.lower}) + "\" upper=\"" + list({l.upper}) + "\" velocity=\"" +
               list({l.velocity}) + "\" effort=\"" + list({l.effort}) + "\"/>\n";
    }
    text_ += "  </joint>\n";
  }
  [[nodiscard]] std::string take() {
    for (const NamedLink& l : dress_.named_links) {
      const std::string name = xml_text(l.name);
      text_ += "  <link name=\"" + name + "\"/>\n  <joint name=\"" + name + "_fixed\" type=\"fixed\">\n    " +
               origin(l.R, l.p) + "\n    <parent link=\"" + xml_text(link(l.link)) +
               "\"/>\n    <child link=\"" + name + "\"/>\n  </joint>\n";
    }
    return std::move(text_) + "</robot>\n";
  }

 private:
  static std::string given(const std::vector<std::string>& names, std::size_t i, const char* other) {
    return i < names.size() ? names[i] : other + std::to_string(i + 1);
  }
  /// The numbers with the shortest digits that give them again.
  static std::string list(std::initializer_list<double> values) {
    std::string out;
    for (const double v : values) {
      std::string digits;
      for (int n = 6; n <= 17; ++n) {
        digits = formatted("%.*g", n, v == 0 ? 0.0 : v);
        double again = 0;
        detail::from_chars(digits.data(), digits.data() + digits.size(), again);
        if (again == v) break;
      }
      out += (out.empty() ? "" : " ") + digits;
    }
    return out;
  }
  /// An `<origin>` with `R = Rz(yaw) Ry(pitch) Rx(roll)`; the roll is what is left when the yaw is undone, so
  /// that a pitch of a right angle costs no digits.
  static std::string origin(const Rotation<double>& R, const Xyz<double>& p) {
    const double yaw = std::atan2(R.x.y, R.x.x), pitch = std::atan2(-R.x.z, std::hypot(R.x.x, R.x.y));
    const double c = std::cos(yaw), s = std::sin(yaw);
    const double roll = std::atan2(s * R.z.x - c * R.z.y, c * R.y.y - s * R.y.x);
    return "<origin xyz=\"" + list({p.x, p.y, p.z}) + "\" rpy=\"" + list({roll, pitch, yaw}) + "\"/>";
  }
  /// Writes a capsule: a cylinder with a ball at each end.
  void look(const Capsule<>& c) {
    const Xyz<double> way = c.to - c.from;
    const double length = norm(way);
    const auto shape = [&](const std::string& at, const std::string& what) {
      text_ += "    <visual>\n      " + at + "\n      <geometry>" + what + "</geometry>\n    </visual>\n";
    };
    const Rotation<double> upright;
    const std::string radius = "radius=\"" + list({c.radius}) + "\"";
    shape(origin(upright, c.from), "<sphere " + radius + "/>");
    if (!(length > 0)) return;
    const Xyz<double> z = (1 / length) * way;
    const Xyz<double> aside = std::abs(z.x) < 0.7 ? Xyz<double>{1, 0, 0} : Xyz<double>{0, 1, 0};
    Xyz<double> x = aside - dot(aside, z) * z;
    x = (1 / norm(x)) * x;
    shape(origin({x, cross(z, x), z}, c.from + 0.5 * way),
          "<cylinder " + radius + " length=\"" + list({length}) + "\"/>");
    shape(origin(upright, c.to), "<sphere " + radius + "/>");
  }

  const UrdfDress& dress_;
  std::string text_;
};

}  // namespace detail

/// The model as a URDF: the frames of its links are those of `Link<Ix>`. `parse_urdf` reads it back to within
/// rounding; gravity is not part of a URDF. Throws `ConfigurationError` for limits of another number of
/// joints, and for capsules or frames of links that the model does not have.
template <RobotModel M>
[[nodiscard]] std::string urdf_text(const M& model, const UrdfDress& dress = {}) {
  require(dress.limits.empty() || dress.limits.size() == M::joints, "UrdfDress: limits",
          double(dress.limits.size()), "one for each joint, or none");
  for (const LinkCapsule& c : dress.capsules) c.check(M::joints);
  for (const NamedLink& l : dress.named_links)
    require(l.link >= -1 && l.link < int(M::joints), "UrdfDress: link of a frame", l.link,
            "one of the model");
  using T = typename detail::ScalarOf<M>::type;
  detail::UrdfBuilder text(dress);
  text.add_link(-1, nullptr);
  const auto one = [&]<std::size_t Ix>(std::integral_constant<std::size_t, Ix>) {
    const LinkParameters<double> numbers = numbers_of<Ix, T>(model);
    text.add_link(static_cast<int>(Ix), &numbers);
    text.add_joint(Ix, M::parents[Ix], M::kinds[Ix], numbers);
  };
  [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
    (one(std::integral_constant<std::size_t, Ix>()), ...);
  }(std::make_index_sequence<M::joints>());
  return text.take();
}

SKINCTL_END_NAMESPACE
