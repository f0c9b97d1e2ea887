// The shape of a UR5 for pictures: links and covers as tubes with round ends.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace examples {

using LinkPose = skinctl::Transform<skinctl::Base, skinctl::FrameTag>;
using LinkPoses = std::array<LinkPose, 6>;

/// A stretch of a link with round ends [m, base's frame].
struct Capsule {
  skinctl::Xyz<double> from{}, to{};
  double radius = 0;
  bool covered = false;  ///< by skin
};

inline LinkPoses ur5_poses(const skinctl::JointPosition<6>& q) {
  const auto all = skinctl::link_poses(skinctl::ur5::Model{}, q);
  const auto plain = [](const auto& X) { return X.template renamed<skinctl::Base, skinctl::FrameTag>(); };
  return {plain(all.get<0>()), plain(all.get<1>()), plain(all.get<2>()),
          plain(all.get<3>()), plain(all.get<4>()), plain(all.get<5>())};
}
/// A point of a link in the base's frame.
inline skinctl::Xyz<double> in_base(const LinkPose& X, const skinctl::Xyz<double>& p) {
  return X.origin() + X.axes() * p;
}
/// The point of a tube's axis, which has no ends here, next to `p`.
inline skinctl::Xyz<double> on_axis(const skinctl::ur5::Tube& tube, const skinctl::Xyz<double>& p) {
  const skinctl::Xyz<double> d = tube.to - tube.from;
  return tube.from + (dot(p - tube.from, d) / dot(d, d)) * d;
}

/// The links: from each joint to the axis of its tube, along it, and to the next joint. Four capsules a link,
/// the cover last.
inline std::vector<Capsule> ur5_capsules(const LinkPoses& X) {
  constexpr double thinner = 0.85;  // a link than its skin
  std::vector<Capsule> out;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& tube = skinctl::ur5::tubes[i];
    const skinctl::Xyz<double> here{},
        next = i < 5 ? X[i].axes().transpose() * (X[i + 1].origin() - X[i].origin()) : tube.to;
    const skinctl::Xyz<double> a = on_axis(tube, here), b = on_axis(tube, next);
    const double thin = thinner * tube.radius;
    const auto add = [&](const skinctl::Xyz<double>& from, const skinctl::Xyz<double>& to, double radius,
                         bool covered) {
      out.push_back({in_base(X[i], from), in_base(X[i], to), radius, covered});
    };
    add(here, a, thin, false);
    add(a, b, thin, false);
    add(b, next, thin, false);
    add(tube.from, tube.to, tube.radius, true);
  }
  return out;
}

}  // namespace examples
