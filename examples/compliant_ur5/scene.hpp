// The scene of the main job: a UR5 that goes to its goals and gives way to touch, with a skin or without one.
#pragma once

#include <Eigen/Eigenvalues>

#include "examples/adapters/ur5/program.hpp"
#include "examples/compliant_ur5/clear.hpp"
#include "examples/compliant_ur5/senses.hpp"
#include "examples/compliant_ur5/settings.hpp"
#include "examples/compliant_ur5/skin.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/blended.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/clearance_limits.hpp"
#include "skinctl/limits/felt_places.hpp"
#include "skinctl/limits/skin_watch.hpp"
#include "skinctl/passivity/stiffest_contact.hpp"
#include "skinctl/robot/preset.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/tracking/friction_learning.hpp"

namespace compliant_ur5 {

inline skinctl::JointLimits<6> limits(const Settings& s) {
  using namespace skinctl;
  return JointLimits<6>({.lower = JointPosition<6>(ur5::Description::lower),
                         .upper = JointPosition<6>(ur5::Description::upper),
                         .velocity = JointVelocity<6>::constant(s.control.velocity_limit),
                         .acceleration = JointAcceleration<6>::constant(s.control.acceleration_limit),
                         .torque = JointTorque<6>(ur5::Description::max_torque)});
}

/// Gains of the way back to the task: as stiff to a hand whatever the arm's felt mass, `heavier` times that
/// of its links.
template <class Arm>
skinctl::JointControlSettings<6> tracking(const Arm& arm, const Settings& s, double heavier) {
  auto t = skinctl::tracking_settings(arm);
  t.lambda = s.control.lambda / std::sqrt(heavier);
  t.K_c = s.control.K_c / std::sqrt(heavier);
  t.K_i1 = s.control.K_i1;
  t.K_i2 = s.control.K_i2;
  t.tb = {};
  t.max_velocity = skinctl::JointVelocity<6>::constant(s.control.max_velocity);
  t.waits = 0.5;  // a place that feels badly slows the arm: its plan waits
  return t;
}

/// A touch is what a cell reads beyond this.
inline skinctl::SkinSettings skin_settings(const Settings& s) {
  skinctl::SkinSettings settings;
  settings.force = skinctl::EventGate<>::dead_band(s.control.force_threshold);
  return settings;
}
/// Rest levels and fault rules of cells of TUM's size. The virtual arm has no dry friction that would hold
/// the force of a cell alone, so that a cell without a witness does not count.
inline skinctl::TrustSettings trust_settings(const Settings& s) {
  skinctl::TrustSettings trust;
  trust.lone_force = {s.trust_all_cells ? std::numeric_limits<double>::infinity() : 0.0};
  trust.follow_rest = trust.find_faults = !s.trust_all_cells;
  trust.noise = {{.force = force_noise, .rest = static_cast<float>(s.rest_reading / trust.health.step)}};
  trust.health.delta = s.force_delta / trust.health.step;
  trust.witness_share = 0.05;  // a finger on the middle of a cell of 28 mm gives each neighbour 7 % of it
  return trust;
}

/// Behind rest levels and fault rules: a stuck cell, or one that drifts, does not push.
inline auto trusted_skin(const Settings& s, double heavier = 1) {
  using namespace skinctl;
  TrustSettings trust = trust_settings(s);
  const auto patches = skin_patches(s, heavier);
  if (!s.trust_all_cells && s.hand) {  // a palm has one cell: nobody else can be its witness
    std::vector<double> lone;
    std::vector<SensorNoise> noise;
    for (const SkinPatch& patch : patches)
      for (const SkinCell& cell : patch.cells) {
        const bool palm = cell.id == palm_cell;
        lone.push_back(palm ? std::numeric_limits<double>::infinity() : 0.0);
        // A finger's tap is no blinking; steps of 1/255 of the range repeat.
        noise.push_back(palm ? SensorNoise{.force = 20, .repeats = true} : trust.noise[0]);
      }
    trust.lone_force = lone;
    trust.noise = noise;
  }
  const UrSkin skin(patches, skin_settings(s));
  return TrustedSkin(skin, trust, FillIn(skin_graph(s, patches), skin.places()));
}

/// The robot's numbers, from the settings.
template <skinctl::Interface I>
skinctl::RobotConfiguration<6> configuration(const Settings& s, double heavier = 1) {
  using namespace skinctl;
  // The two lags of servoj in a row are declared as one.
  const double ahead = I == Interface::position ? adapters::ur5::servoj_lookahead : 0;
  return {.limits = limits(s),
          .period = nanoseconds(1 / s.rate),
          .delay = nanoseconds(s.control.delay),
          .lag = nanoseconds(s.control.lag + ahead),
          .virtual_damping = s.control.decay / heavier,
          .viscous_friction =
              (1 / heavier) * JointTorque<6>(s.sense == Sense::motors ? s.motors.damping : s.control.viscous),
          .virtual_inertia =
              s.sense == Sense::skin ? JointTorque<6>() : JointTorque<6>(s.control.virtual_inertia),
          .dead_band = JointPosition<6>::constant(0.02),
          .substep = s.preset == preset::Fast::name ? preset::Fast::substep : preset::Balanced::substep};
}

/// The same by torque: no virtual arm, no lag; the motors' inertia is known.
template <>
inline skinctl::RobotConfiguration<6> configuration<skinctl::Interface::torque>(const Settings& s, double) {
  using namespace skinctl;
  return {.limits = limits(s),
          .period = nanoseconds(1 / s.rate),
          .delay = nanoseconds(std::max(s.network_delay, 0.0)),
          .viscous_friction = JointTorque<6>(s.torque.viscous),
          .virtual_inertia = JointTorque<6>(s.torque.motor_inertia)};
}

/// Weights may change while it runs: how firmly the task is followed, and how much the skin counts. At most
/// those of the start, for which contacts come to rest; the task never to 0, which would forget it.
struct WeightLimits {
  static constexpr double least_task = 0.1, least_skin = 0, most = 1;
};

/// The controller holds the weight; the friction that it leaves over is learnt, so that the arm comes back to
/// its task.
inline auto scene_by_torque(const Settings& s) {
  using namespace skinctl;
  const auto arm = by_torque(ur5::Model{}, configuration<Interface::torque>(s), RobotHoldsGravity{},
                             RobotCompensatesFriction{});
  auto t = tracking_settings(arm);
  t.lambda = s.torque.lambda;
  t.K_c = s.torque.K_c;
  t.K_i1 = t.K_i2 = 0;  // they have no dead zone
  t.tb = {};
  t.max_velocity = JointVelocity<6>::constant(s.control.max_velocity);
  t.waits = 0.5;
  const FrictionLearning<SplineJoint<6>> reach(SplineJoint<6>(t), t,
                                               {.rate = s.torque.learning,
                                                .bound = JointTorque<6>(s.torque.most_friction),
                                                .dead_zone = s.torque.dead_zone});
  return Cycle(arm, trusted_skin(s), blended(weighted(reach + SkinJointControl{})));
}

/// What the arm gives way to, its gains divided by `heavier`.
/// @param mass  with which the arm is felt [kg].
template <Sense S>
auto touch_of(const Settings& s, double heavier = 1, double mass = 5) {
  if constexpr (S == Sense::skin) {
    return trusted_skin(s, heavier);
  } else if constexpr (S == Sense::wrist) {
    return wrist_touch(s, heavier, mass);
  } else {
    return motor_touch(s, heavier, mass);
  }
}
/// The same as far as the stability of contacts asks for it.
template <Sense S>
auto places_of_touch(const Settings& s, double heavier = 1) {
  if constexpr (S == Sense::skin) {
    return UrSkin(skin_patches(s, heavier), {});
  } else {
    return touch_of<S>(s, heavier);
  }
}

/// What may touch the arm, for which it must be felt heavy enough: a finger, or an edge, that stays where it
/// is, and hands, whose tissue loses a third of a swing. Delay and lag are declared in full, so that little
/// margin is enough. The observer of the motors filters, and waits for the end of a cycle.
inline skinctl::Nanoseconds delay_of_sense(const Settings& s) {
  return s.sense == Sense::motors ? skinctl::nanoseconds(1 / s.motors.rate + 1 / s.rate)
                                  : skinctl::Nanoseconds(0);
}
inline double stiffest(const Settings& s, double declared) {
  return s.sense == Sense::motors ? std::min(declared, s.motors.stiffest) : declared;
}
inline skinctl::StiffestContact hardest_finger(const Settings& s) {
  return {.stiffness = stiffest(s, s.control.stiffest_wall),
          .newtons = s.newtons_per_reading,
          .skin_delay = delay_of_sense(s),
          .margin = 1.2,
          .margin_of_two = 1};
}
inline skinctl::StiffestContact heaviest_hand(const Settings& s) {
  return {.stiffness = stiffest(s, s.control.stiffest_hand),
          .body = s.control.heaviest_hand,
          .loss = 0.3,
          .newtons = s.newtons_per_reading,
          .skin_delay = delay_of_sense(s)};
}

/// By how much an arm is felt heavier than its links and the gains of its skin make it, so that all of that
/// rests, times `Settings::heavier_than_needed`.
/// @param places  what feels, as far as the stability of contacts asks for it.
template <class Arm, class Places>
double heavier_for(const Settings& s, const Arm& arm, const Places& places) {
  return 1.05 * s.control.heavier_than_needed *
         std::max({1.0, hardest_finger(s).heavier(arm, places), heaviest_hand(s).heavier(arm, places)});
}
template <skinctl::Interface I, Sense S = Sense::skin>
double heavier(const Settings& s) {
  return heavier_for(s, skinctl::robot_by<I>(skinctl::ur5::Model{}, configuration<I>(s)),
                     places_of_touch<S>(s));
}

/// The felt mass of the lightest place by position or velocity [kg], `factor` being `heavier(s)`.
template <skinctl::Interface I, Sense S = Sense::skin>
double felt_mass(const Settings& s, double factor) {
  return hardest_finger(s).min_felt_mass(
      skinctl::robot_by<I>(skinctl::ur5::Model{}, configuration<I>(s, factor)),
      places_of_touch<S>(s, factor));
}
template <skinctl::Interface I, Sense S = Sense::skin>
double felt_mass(const Settings& s) {
  return felt_mass<I, S>(s, heavier<I, S>(s));
}

/// A virtual arm goes to its goals and gives way to `touch`, and its motion is commanded.
template <class Arm, class Touch>
auto scene_of(const Settings& s, const Arm& arm, const Touch& touch, double heavier) {
  using namespace skinctl;
  return Cycle(
      arm, touch,
      blended(weighted(SplineJoint<6>(tracking(arm, s, heavier)) + SkinJointControl{} + GravityControl{})));
}
template <skinctl::Interface I, Sense S>
auto scene_by_motion(const Settings& s) {
  const double factor = heavier<I, S>(s);
  const auto arm = skinctl::robot_by<I>(skinctl::ur5::Model{}, configuration<I>(s, factor), hardest_finger(s),
                                        heaviest_hand(s));
  constexpr double heaviest = 1000;  // [kg]; a rigid arm, whose touch is muted, is heavier still
  return scene_of(s, arm, touch_of<S>(s, factor, std::min(heaviest, felt_mass<I, S>(s, factor))), factor);
}

/// From skin and state to commands for `I`: every number of it comes from the settings.
template <skinctl::Interface I, Sense S = Sense::skin>
auto make_scene(const Settings& s) {
  using namespace skinctl;
  if constexpr (I == Interface::torque) {
    static_assert(S == Sense::skin, "by torque the arm feels by its skin");
    return scene_by_torque(s);
  } else {
    return scene_by_motion<I, S>(s);
  }
}

/// How fast those of its places go that feel badly: from the touch to the beginning of braking pass two
/// cycles, delay and lag.
inline skinctl::FeltPlaces<max_cells> felt_places(const Settings& s,
                                                  const skinctl::RobotConfiguration<6>& robot,
                                                  std::vector<skinctl::CellPlace> places) {
  return {.places = std::move(places),
          .force = s.control.force_limit,
          .stiffness = s.control.stiffest_wall,
          .deceleration = s.control.stopping,
          .reaction_time = 2 * robot.period + robot.delay + robot.lag,
          .newtons = s.newtons_per_reading};
}
template <skinctl::Interface I>
skinctl::FeltPlaces<max_cells> felt_places(const Settings& s) {
  return felt_places(s, configuration<I>(s), UrSkin(skin_patches(s), {}).places());
}

/// The same, as the job runs it: it does not move before its skin is heard, stops when a patch falls silent,
/// and leads with no place that feels nothing. It keeps clear where its type says so.
template <skinctl::Interface I, Sense S = Sense::skin, bool Clear = false>
auto make_watched_scene(const Settings& s) {
  static_assert(S == Sense::skin || !Clear, "what keeps clear sees by its skin");
  if constexpr (Clear) {
    return make_watched_scene<I>(s).with(clearance(s));
  } else if constexpr (S == Sense::skin) {
    return make_scene<I>(s).with(skinctl::SkinWatch{}, felt_places<I>(s));
  } else {
    return make_scene<I, S>(s);  // its watch is its own: see `PushWatch`
  }
}

}  // namespace compliant_ur5
