// One UR5, one servo and one person at its flange, whichever rule commands it.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "bench/peers/rules.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/tactile/wrist_sensor.hpp"
#include "skinctl/testing/hand.hpp"
#include "tests/support/simulated_joints.hpp"

namespace peers {

using skinctl::nanoseconds;
using Row = std::array<double, 6>;

inline Six six(const Row& q) {
  return Eigen::Map<const Six>(q.data());
}

/// When it is commanded, and how late it follows [s].
struct Timing {
  double period = 0.008, lag = 0.008, delay = 0.008;
};

/// How an arm feels along the line of the touch, where the scene begins.
struct Admittance {
  double mass = 0, friction = 0;  ///< [kg], [N s/m]
  /// Of rotations [kg m^2]: that of the mass at 0.25 m.
  [[nodiscard]] double turned_mass() const { return mass / 16; }
};

/// Where a scene begins, and along which line it is touched.
struct Place {
  Row q{0.0, -1.2, 1.4, -1.8, -1.57, 0.0};
  Point along{1, 0, 0};
  double ends = 0;  ///< position limits this far to either side [rad]; 0: the maker's

  /// Inverse felt mass of a mass matrix at the flange [1/kg].
  [[nodiscard]] double mobility(const Square& M) const {
    const Six tau = Kinematics(six(q)).jacobian().topRows<3>().transpose() * along;
    return tau.dot(M.inverse() * tau);
  }
};

enum class Rule { ideal, skinctl, skinctl_agile, ros2, ros2_unfiltered, fzi };
inline constexpr Rule all_rules[] = {Rule::ideal, Rule::skinctl,         Rule::skinctl_agile,
                                     Rule::ros2,  Rule::ros2_unfiltered, Rule::fzi};

/// From measured joints and a force at the flange (base axes) to commanded joints, once a period.
using Commands = std::function<Row(double t, const Row& q, const Row& dq, const Point& F)>;

/// The maker's limits, or ends around the place where a scene begins; the README's acceleration [rad/s^2].
inline auto limits_at(const Place& place, double acceleration = 15) {
  auto v = skinctl::limits_of<skinctl::ur5::Description>(acceleration).values();
  for (std::size_t i = 0; i < 6 && place.ends > 0; ++i)
    v.lower[i] = place.q[i] - place.ends, v.upper[i] = place.q[i] + place.ends;
  return skinctl::JointLimits<6>(v);
}

/// The README's scene with a wrist sensor as its touch, which all rules have, and a mass that is shaped at
/// the flange, which theirs is.
inline Commands skinctl_commands(const Place& place, const Timing& timing, const Admittance& a,
                                 double acceleration) {
  using namespace skinctl;
  using Shape = ToolShape<5>;
  constexpr double flange = ur5::Description::flange[2];
  const auto X = Transform<Link<5>, ForceSensor>::translation_xyz(0, 0, flange);
  const double turned = a.turned_mass(), d = a.friction, e = d / a.mass * turned;
  const auto arm =
      by_position(ur5::Model{},
                  {.limits = limits_at(place, acceleration),
                   .period = nanoseconds(timing.period),
                   .delay = nanoseconds(timing.delay),
                   .lag = nanoseconds(timing.lag),
                   .virtual_damping = 0},
                  Shape({.X_LT = Transform<Link<5>, Tool>::translation_xyz(0, 0, flange),
                         .mass = Shape::diagonal({a.mass, a.mass, a.mass, turned, turned, turned}),
                         .damping = Shape::diagonal({d, d, d, e, e, e})}));
  const auto sensor =
      wrist_sensor<5>(ur5::Model{}, {.X_LS = X, .force = EventGate<>(), .moment = EventGate<>()});
  const Cycle scene(arm, sensor, SkinJointControl{} + GravityControl{});
  using Scene = std::remove_const_t<decltype(scene)>;
  auto memory = std::make_shared<typename Scene::Memory>();
  scene.start(*memory, State<6>{0ns, JointPosition<6>(place.q), {}});
  return [scene, memory](double t, const Row& q, const Row& dq, const Point& F) {
    const Point f = Kinematics(six(q)).R.transpose() * F;
    const WrenchSample sample{nanoseconds(t), {f.x(), f.y(), f.z()}, {0, 0, 0}};
    typename Scene::Input input{};
    input.now = nanoseconds(t);
    input.measured = {input.now, JointPosition<6>(q), JointVelocity<6>(dq)};
    input.sensed.wrenches = {&sample, 1};
    const auto out = scene.step(*memory, input);
    Row command;
    for (std::size_t i = 0; i < 6; ++i) command[i] = out.command.position[i];
    return command;
  };
}

/// A peer that feels like `a` along the line of the touch.
inline Commands peer_commands(Rule rule, const Place& place, const Timing& timing, const Admittance& a) {
  Six lower, upper;
  const auto limits = limits_at(place);
  for (std::size_t i = 0; i < 6; ++i) lower(int(i)) = limits.lower()[i], upper(int(i)) = limits.upper()[i];
  const auto row = [](const Six& q) {
    Row out;
    Eigen::Map<Six>(out.data()) = q;
    return out;
  };
  if (rule == Rule::fzi) {
    Fzi fzi;
    fzi.lower = lower, fzi.upper = upper;
    // Mass over friction is fixed by its damping. Steady: `dq = 0.18 ddq`, and ahead of the measured position
    // by 0.02 dq, which is made good in delay, lag and half a period.
    fzi.gain = (timing.delay + timing.lag + 0.5 * timing.period) /
               (0.02 * 0.18 * a.friction * place.mobility(Fzi::inertia(Kinematics(six(place.q)))));
    return [fzi, row](double, const Row& q, const Row&, const Point& F) mutable {
      return row(fzi.step(six(q), (Six() << F, Point::Zero()).finished()));
    };
  }
  Ros2 ros2;
  ros2.mass << a.mass, a.mass, a.mass, a.turned_mass(), a.turned_mass(), a.turned_mass();
  ros2.stiffness.setZero(), ros2.ratio.setZero();
  ros2.joint_damping = a.friction / a.mass;  // its only friction without a spring
  ros2.reference = six(place.q);
  if (rule == Rule::ros2_unfiltered) ros2.filter = 1;
  return [=](double, const Row& q, const Row&, const Point& F) mutable {
    const Six command = ros2.step(six(q), (Six() << F, Point::Zero()).finished(), timing.period);
    return row(command.cwiseMax(lower).cwiseMin(upper));  // it has no limits: clamped behind it
  };
}

/// The world's force on the flange along the line, and the one that a table shows [N].
struct Touching {
  double net, shown;
};

/// What a scene shows.
struct Measured {
  double mean = 0, peak = 0;          ///< |force| on the robot [N]
  double ring = 0;                    ///< from least to greatest force in the last second [N]
  bool away = false;                  ///< whether the force passed 1000 N; the run ends there
  int turns = 0;                      ///< of the force, by more than 3 N
  double joint_speed = 0;             ///< fastest, of the real joints [rad/s]
  double beyond = 0;                  ///< furthest beyond a position limit [rad]
  double speed = 0;                   ///< of the flange in the last second, mean along the line [m/s]
  std::vector<double> times, forces;  ///< every 4 ms [s], [N]
};

/// Runs a rule for `time` [s] under `touch(dt, t, x)`: the forces while the flange has come to x.
template <class Touch>
Measured run(Rule rule, const Place& place, const Timing& timing, const Admittance& a, double time,
             Touch&& touch) {
  // The ideal mass answers each step at once: shorter ones, or a stiff wall would give it energy.
  const double h = rule == Rule::ideal ? 1e-5 : 2.5e-4;
  const Commands commands = rule == Rule::ideal           ? Commands()
                            : rule == Rule::skinctl       ? skinctl_commands(place, timing, a, 15)
                            : rule == Rule::skinctl_agile ? skinctl_commands(place, timing, a, 1000)
                                                          : peer_commands(rule, place, timing, a);
  using Joints = skinctl::testing::SimulatedJoints<6>;
  Joints joints(Joints::Kind::position, timing.delay, timing.lag, place.q);
  const auto limits = limits_at(place);
  const Point start = Kinematics(six(place.q)).p[6];
  Measured out;
  double x = 0, v = 0, net = 0, low = 1e9, high = -1e9, turn = 0;
  int side = 0;
  const long steps = std::lround(time / h), every = std::lround(timing.period / h);
  for (long n = 1; n <= steps; ++n) {
    const double t = h * double(n);
    if (rule == Rule::ideal) {  // the midpoint rule
      const double mean = (2 * a.mass / h * v + net) / (2 * a.mass / h + a.friction);
      x += h * mean, v = 2 * mean - v;
    } else {
      joints.advance(t);
      x = place.along.dot(Kinematics(six(joints.q())).p[6] - start);
      for (std::size_t i = 0; i < 6; ++i) {
        out.joint_speed = std::max(out.joint_speed, std::abs(joints.dq()[i]));
        out.beyond =
            std::max({out.beyond, joints.q()[i] - limits.upper()[i], limits.lower()[i] - joints.q()[i]});
      }
    }
    const Touching now = touch(h, t, x);
    net = now.net;
    const double force = now.shown;
    out.mean += std::abs(force) / double(steps);
    out.peak = std::max(out.peak, std::abs(force));
    if (!(std::abs(force) < 1000)) {
      out.away = true;
      break;
    }
    // A turn: the force has left its last extreme by more than 3 N.
    if ((force - turn) * side > 0 || (side == 0 && force < turn)) turn = force;
    if (std::abs(force - turn) > 3) out.turns += side != 0, side = force > turn ? 1 : -1, turn = force;
    if (n % std::lround(0.004 / h) == 0) out.times.push_back(t), out.forces.push_back(force);
    if (t > time - 1) {
      if (low > 1e8) out.speed = -x;
      low = std::min(low, force), high = std::max(high, force);
    }
    if (rule != Rule::ideal && n % every == 0)
      joints.command(t, commands(t, joints.q(), joints.dq(), net * place.along));
  }
  out.speed += x;
  out.ring = high - low;
  return out;
}

}  // namespace peers
