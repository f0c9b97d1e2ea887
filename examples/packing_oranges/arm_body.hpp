// An arm as a simulator wants it: bodies, masses and shapes, written from a model of the library.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "skinctl/clearance/capsule.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/model/link.hpp"
#include "skinctl/model/model.hpp"

namespace packing {

/// A link, in the frame of the one before it (of the base), at q = 0; it turns about its z axis.
struct LinkBody {
  skinctl::Xyz<double> p{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0};
  double mass = 0;
  skinctl::Xyz<double> com{0, 0, 0};
  std::array<double, 6> inertia{};  ///< about the centre of mass: xx, yy, zz, xy, xz, yz
};
inline constexpr double tip_radius = 0.012;  ///< of a hand's fingertips [m]

/// A hand of four fingers: four links each, the first ones on the palm. Its frame stands in that of the arm's last link.
struct HandBody {
  std::array<LinkBody, 16> links{};
  std::array<skinctl::Xyz<double>, 4> tips{};  ///< middle of each fingertip, in the last link of its finger
  std::array<double, 4> takes_part{};          ///< weights of the fingertips that hold something
  std::array<double, 16> lower{}, upper{}, start{};  ///< joints [rad]
  LinkBody palm{};                                   ///< where the hand's frame is, and the palm's inertia
  skinctl::Xyz<double> grasps{0, 0, 0};  ///< the point between the fingertips, in the hand's frame
};
struct ArmBody {
  std::array<LinkBody, 6> links{};
  std::array<skinctl::Capsule<>, 6> shapes{};  ///< around each link, in its frame
  double flange = 0;                           ///< along the z axis of the last link [m]
  skinctl::Transform<skinctl::World, skinctl::Base> X_WB{};
  std::array<double, 6> home{};    ///< joints at the start [rad]
  std::optional<HandBody> hand{};  ///< instead of a gripper
};

/// The numbers of a link's mass, from a model's.
inline void mass_of(LinkBody& l, const skinctl::LinkParameters<double>& n) {
  using P = skinctl::LinkParameter;
  const double trace = n[P::s_xx] + n[P::s_yy] + n[P::s_zz];
  l.mass = n[P::mass];
  l.com = {n[P::c_x], n[P::c_y], n[P::c_z]};
  l.inertia = {trace - n[P::s_xx], trace - n[P::s_yy], trace - n[P::s_zz],
               -n[P::s_xy],        -n[P::s_xz],        -n[P::s_yz]};
}

/// The bodies of a model of six joints.
template <skinctl::RobotModel M>
[[nodiscard]] ArmBody arm_body(const M& model, const std::array<skinctl::Capsule<>, 6>& shapes, double flange,
                               const skinctl::Transform<skinctl::World, skinctl::Base>& X_WB,
                               const skinctl::JointPosition<6>& home) {
  using namespace skinctl;
  static_assert(M::joints == 6);
  ArmBody out;
  out.shapes = shapes;
  out.flange = flange;
  out.X_WB = X_WB;
  for (std::size_t i = 0; i < 6; ++i) out.home[i] = home[i];
  const auto poses = link_poses(model, JointPosition<6>{});
  const auto one = [&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
    LinkBody& l = out.links[I];
    const auto in_parent = [&](const auto& X) { l.p = X.origin(), l.x = X.axis_x(), l.y = X.axis_y(); };
    if constexpr (I == 0)
      in_parent(poses.template get<0>());
    else
      in_parent(poses.template get<I - 1>().inverse() * poses.template get<I>());
    mass_of(l, numbers_of<I, double>(model));
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (one(std::integral_constant<std::size_t, I>()), ...);
  }(std::make_index_sequence<6>());
  return out;
}

}  // namespace packing
