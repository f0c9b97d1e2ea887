#include "examples/playground/own_robot.hpp"

#include <algorithm>
#include <numbers>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/tactile/cover.hpp"

namespace playground {

using namespace skinctl;

namespace {

constexpr double turn = 2 * std::numbers::pi;

Rotation<double> rotation(const Robot::Place& p) {
  const double* a = p.axes;
  return {{a[0], a[1], a[2]}, {a[3], a[4], a[5]}, {a[6], a[7], a[8]}};
}
Xyz<double> point(const double (&p)[3]) {
  return {p[0], p[1], p[2]};
}
double length(const Xyz<double>& v) {
  return std::sqrt(dot(v, v));
}
LinkInertia ball(double mass, const Xyz<double>& centre, double moment) {
  return {mass, {centre.x, centre.y, centre.z}, moment, moment, moment};
}

}  // namespace

/// The lines between the joints, in the frames of the file.
struct OwnRobot::Shape {
  std::array<Xyz<double>, 6> to;  ///< from each joint to the next one, or the tip [m]
  double reach = 0;               ///< their lengths together [m]

  explicit Shape(const Robot& r) {
    for (std::size_t i = 0; i < Robot::joints; ++i) {
      to[i] = i + 1 < Robot::joints ? point(r.joint[i + 1].place.origin) : point(r.tip);
      reach += length(to[i]);
    }
    require(reach >= 0.1 && reach <= 10, "reach of the robot", reach, "0.1 to 10 m");
  }
  /// Of a link's tube, as of a UR5: 60 mm at its first axis, 40 at its tip, of a large arm not more [m].
  [[nodiscard]] double radius(std::size_t i) const {
    return std::min(0.065, reach * (0.06 - 0.004 * static_cast<double>(i)));
  }
  [[nodiscard]] TurnedLinks<Chain> links(const Robot& r) const {
    std::array<PlacedLink, 6> placed;
    for (std::size_t i = 0; i < 6; ++i) {
      const Robot::Place& at = r.joint[i].place;
      placed[i] = {rotation(at), {at.origin[0], at.origin[1], at.origin[2]}};
    }
    require(r.bodies >= 0 && r.bodies <= Robot::max_bodies, "bodies of the robot", r.bodies, "0 to 64");
    for (std::size_t k = 0; k < static_cast<std::size_t>(r.bodies); ++k) {
      const Robot::Body& b = r.body[k];
      require(b.joint >= 0 && b.joint < 6, "joint of a body", b.joint, "0 to 5");
      require(b.mass >= 0 && b.mass <= 1e5, "mass of a body", b.mass, "0 to 1e5 kg");
      const double* x = b.inertia;
      LinkInertia own{b.mass, {}, x[0], x[1], x[2], x[3], x[4], x[5]};
      // Moments that no body has are those of a ball of the same size.
      if (density_defect(make_link({}, own)) > makers_density)
        own = ball(own.mass, {}, std::max(0.0, x[0] + x[1] + x[2]) / 3);
      LinkInertia& all = placed[static_cast<std::size_t>(b.joint)].inertia;
      all = combined(all, seen_from(rotation(b.place), point(b.place.origin), own));
    }
    for (std::size_t i = 0; i < 6; ++i) {
      if (placed[i].inertia.mass > 0) continue;
      const double thick = radius(i), long_as = std::max(2 * thick, length(to[i]));
      const double mass = assumed_density * std::numbers::pi * thick * thick * long_as;
      placed[i].inertia = ball(mass, 0.5 * to[i], mass * (long_as * long_as / 12 + thick * thick / 4));
    }
    return canonical_links<Chain>(placed);
  }
};

OwnRobot::OwnRobot(const Robot& r) : OwnRobot(r, Shape(r)) {}
OwnRobot::OwnRobot(const Robot& r, const Shape& shape)
    : canonical_(shape.links(r)),
      model_(canonical_.links, {0, 0, -9.81}, makers_density),
      reach_(shape.reach) {
  for (std::size_t i = 0; i < 6; ++i) {
    const Robot::Joint& j = r.joint[i];
    const bool endless = j.lower == j.upper;
    require(endless || j.lower < j.upper, "lower limit of a joint", j.lower, "below the upper one");
    require(j.velocity >= 0 && j.velocity <= 100, "velocity of a joint", j.velocity, "0 to 100 rad/s");
    lower_[i] = endless ? -turn : std::clamp(j.lower, -turn, turn);
    upper_[i] = endless ? turn : std::clamp(j.upper, -turn, turn);
    require(j.torque >= 0 && j.torque <= 1e6, "torque of a joint", j.torque, "0 to 1e6 N m");
    torque_[i] = j.torque > 0 ? j.torque : assumed_torque;
    velocity_[i] = j.velocity > 0 ? j.velocity : std::numbers::pi;

    const double c = std::cos(canonical_.turn[i]), s = std::sin(canonical_.turn[i]);
    const Xyz<double>& d = shape.to[i];
    const Xyz<double> to{c * d.x + s * d.y, c * d.y - s * d.x, d.z};
    if (i == 5) tip_ = to;
    constexpr double free = 0.12;  // of a link at each end, for its joints
    if ((1 - 2 * free) * length(to) < 4 * HexagonalCell::port_y) continue;
    const Xyz<double> from = free * to, end = (1 - free) * to;
    tubes_[i] = {shape.radius(i), from.x, from.y, from.z, end.x, end.y, end.z};
  }
  cover_tubes();
}

/// Cells of TUM's size, on each tube as many as its share of the room allows, around its middle.
void OwnRobot::cover_tubes() {
  std::array<CylinderSurface, 6> surface{};
  std::array<std::size_t, 6> room{};
  std::size_t all = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const Tube& t = tubes_[i];
    if (t[0] == 0) continue;
    surface[i] = {t[0], length({t[4] - t[1], t[5] - t[2], t[6] - t[3]})};
    all += room[i] = full_cover(surface[i]).size();
  }
  require(all > 0, "cells that find room on the robot", 0, "1 at least");
  std::uint32_t id = 1;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::size_t count =
        all <= compliant_ur5::max_cells ? room[i] : room[i] * compliant_ur5::max_cells / all;
    if (count == 0) continue;
    const Tube& t = tubes_[i];
    const Xyz<double> from{t[1], t[2], t[3]}, to{t[4], t[5], t[6]};
    const Xyz<double> z = (1 / length(to - from)) * (to - from);
    const Xyz<double> beside = std::abs(z.x) < 0.7 ? Xyz<double>{1, 0, 0} : Xyz<double>{0, 1, 0};
    const Xyz<double> across = cross(z, beside), y = (1 / length(across)) * across;
    const Transform<SomeLink, Surface> X_LS({cross(y, z), y, z}, 0.5 * (from + to));
    for (const auto& cell : detail::cover_any(X_LS, surface[i], count, id))
      cells_[i].push_back({.id = cell.id, .X_LC = cell.X_LC});
    id += static_cast<std::uint32_t>(count);
  }
}

JointLimits<6> OwnRobot::limits(const compliant_ur5::ControlSettings& control) const {
  JointLimits<6>::Values v;
  for (std::size_t i = 0; i < 6; ++i) {
    v.lower[i] = lower_[i], v.upper[i] = upper_[i];
    v.velocity[i] = std::min(velocity_[i], control.velocity_limit);
    v.acceleration[i] = control.acceleration_limit, v.torque[i] = torque_[i];
  }
  return JointLimits<6>(v);
}

void OwnRobot::limit(simulated_ur5::ArmConfig& arm) const noexcept {
  arm.lower = lower_, arm.upper = upper_, arm.velocity_limit = velocity_;
}

simulated_ur5::Links OwnRobot::links(const Joints& q) const noexcept {
  simulated_ur5::Links out;
  const auto poses = link_poses(model_, JointPosition<6>(q));
  const auto vec = [](const Xyz<double>& v) { return Vec3{v.x, v.y, v.z}; };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    const auto place = [&](simulated_ur5::Pose& to, const auto& X) {
      to = {vec(X.axis_x()), vec(X.axis_y()), vec(X.axis_z()), vec(X.origin())};
    };
    (place(out.link[I], poses.template get<I>()), ...);
  }(std::make_index_sequence<6>{});
  out.flange = out.link[5];
  out.flange.origin = out.link[5].point(vec(tip_));
  return out;
}

std::vector<SkinPatch> OwnRobot::patches(const compliant_ur5::Settings& s, double heavier) const {
  std::vector<SkinPatch> out;
  for (std::size_t i = 0; i < 6; ++i)
    if (!cells_[i].empty())
      out.push_back(
          {i, {.force = s.rigid ? 0 : s.control.force_gain[i] / heavier, .proximity = 0}, cells_[i]});
  return out;
}

Joints OwnRobot::posture(double height, double distance, const Joints* near) const noexcept {
  constexpr double step = 0.2, low = 0.08;  // [rad]; of the reach, for every joint
  Joints best{}, q{};
  // Away from the ends by an eighth of the range, for a touch has to move the joint.
  const auto within = [&](std::size_t i, double x) {
    const double room = 0.125 * (upper_[i] - lower_[i]);
    return std::clamp(x, lower_[i] + room, upper_[i] - room);
  };
  for (std::size_t i = 0; i < 6; ++i) q[i] = within(i, 0);
  double least = 1e9;
  for (double a = -turn / 2; a <= turn / 2; a += step)
    for (double b = -turn / 2; b <= turn / 2; b += step) {
      q[1] = within(1, a), q[2] = within(2, b);
      const auto at = links(q);
      double floor = at.flange.origin.z;
      for (std::size_t i = 1; i < 6; ++i) floor = std::min(floor, at.link[i].origin.z);
      const Vec3 tip = at.flange.origin - at.link[0].origin;
      const double off = std::abs(tip.z / reach_ - height) +
                         std::abs(std::hypot(tip.x, tip.y) / reach_ - distance) +
                         20 * std::max(0.0, low - floor / reach_) +
                         (near != nullptr ? 0.3 * std::hypot(q[1] - (*near)[1], q[2] - (*near)[2]) : 0);
      if (off < least) least = off, best = q;
    }
  return best;
}

std::array<Joints, 2> OwnRobot::task() const noexcept {
  std::array<Joints, 2> out{posture(0.35, 0.5)};
  out[1] = posture(0.2, 0.6, &out[0]);
  const double middle = out[0][0], aside = std::min(0.4, 0.2 * (upper_[0] - lower_[0]));
  out[0][0] = middle - aside, out[1][0] = middle + aside;
  return out;
}

}  // namespace playground
