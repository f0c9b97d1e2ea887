// The four scenes of the trade study.
#pragma once

#include "bench/studies/trade/scene_runner.hpp"
#include "skinctl/skinctl.hpp"

namespace trade {

inline constexpr double newtons_per_unit = 20;
inline constexpr std::array<double, 6> arm_home = {0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

/// 113 N on the upper arm, then 25 N on the forearm: forces that are given; and a finger that plunges 20 mm
/// deep into the forearm, as stiff as the main job's.
inline World pressed_arm() {
  const auto side = [](std::size_t link, const Xyz<double>& place, double force, double from, double to) {
    return Press{
        {.link = link, .place = place, .normal = {0.0, 1.0, 0.0}, .radius = 0.045, .force = force}, from, to};
  };
  return {{side(1, {-0.12, 0.054, 0.13585}, 113, 0.1, 0.25), side(2, {-0.2, 0.04, 0.0165}, 25, 0.8, 0.95)},
          1.6};
}
inline World arm_with_stiff_finger(double stiffness = 3000) {
  Press finger{
      {.link = 2, .place = {-0.2, 0.04, 0.0165}, .normal = {0.0, 1.0, 0.0}, .radius = 0.045}, 0.1, 1.1};
  finger.stiffness = stiffness;
  finger.depth = 0.02;
  return {{finger}, 1.6};
}

template <class T, std::size_t N>
RobotConfiguration<N, T> configuration(const JointLimits<N, T>& limits, const Choices& c) {
  RobotConfiguration<N, T> out{.limits = limits, .period = 8ms, .delay = 8ms, .lag = 8ms};
  out.virtual_damping = T(4);
  out.viscous_friction = JointTorque<N, T>::constant(T(2));
  out.dead_band = JointPosition<N, T>::constant(T(0.02));
  out.substep = c.substep;
  return out;
}
inline SkinSettings open_skin() {
  SkinSettings s;
  s.force = EventGate<>();
  return s;
}
inline Places<ur5::Model, 5> arm_places() {
  const auto& flange = ur5::Description::flange;
  return {{}, {flange[0], flange[1], flange[2]}};
}

/// A UR5 without skin goes to a goal.
template <class T, class M = ur5::Model, class... Parts>
std::unique_ptr<Runner> bare_arm(const Choices& c, const Parts&... parts) {
  const auto arm = by_position<T>(M{}, configuration<T>(limits_of<ur5::Description, T>(T(15)), c), parts...);
  auto settings = JointControlSettings<6, T>{.dt = 8ms};
  settings.lambda = T(12);
  settings.K_c = T(2);
  settings.virtual_dynamics = arm.virtual_dynamics();
  const Cycle scene(arm, NoSkin{}, SplineJoint<6, T>(settings) + GravityControl{});
  const auto goal = [](auto& input, double t) {
    if (t > 0.099 || t < 0.091) return;
    input.goal = {JointPosition<6, T>{T(0.6), T(-0.7), T(0.9), T(-1.2), T(-1.2), T(0.6)}, 1500ms};
  };
  return runner(scene, arm_home, {}, newtons_per_unit, c, arm_places(), goal, World{{}, 2.2}, World{});
}

/// A UR5 with 260 cells, held by skin and gravity alone.
template <class T, class M = ur5::Model, class Law = SkinJointControl, class... Parts>
std::unique_ptr<Runner> pressed_ur5(const Choices& c, const Parts&... parts) {
  const auto arm = by_position<T>(M{}, configuration<T>(limits_of<ur5::Description, T>(T(15)), c), parts...);
  const Cycle scene(arm, ur5_skin<260, T, M>({.force = newtons_per_unit}, open_skin()),
                    Law{} + GravityControl{});
  return runner(scene, arm_home, cell_places(ur5::skin_patches<260>()), newtons_per_unit, c, arm_places(),
                no_goal, pressed_arm(), arm_with_stiff_finger());
}

/// A UR5 that carries a hand, 22 joints by position, with 1260 cells on the arm.
template <class T, class... Parts>
std::unique_ptr<Runner> pressed_arm_and_hand(const Choices& c, const Parts&... parts) {
  using M = ur5_allegro::Model<T>;
  using D = ur5::Description;
  typename JointLimits<22, T>::Values v{.lower = JointPosition<22, T>::constant(T(-3)),
                                        .upper = JointPosition<22, T>::constant(T(3)),
                                        .velocity = JointVelocity<22, T>::constant(T(3)),
                                        .acceleration = JointAcceleration<22, T>::constant(T(15)),
                                        .torque = JointTorque<22, T>::constant(T(10))};
  std::array<double, 22> home{};
  for (std::size_t i = 0; i < 6; ++i) {
    v.lower[i] = T(D::lower[i]), v.upper[i] = T(D::upper[i]), v.torque[i] = T(D::max_torque[i]);
    home[i] = arm_home[i];
  }
  for (std::size_t i = 6; i < 22; ++i) home[i] = 0.3;
  const auto robot =
      by_position<T>(ur5_allegro::arm_with_hand<T>(), configuration<T>(JointLimits<22, T>(v), c), parts...);
  const Cycle scene(robot, ur5_skin<1260, T, M>({.force = newtons_per_unit}, open_skin()),
                    SkinJointControl{} + GravityControl{});
  const auto& flange = ur5::Description::flange;
  const Places<ur5_allegro::Model<double>, 5> places{ur5_allegro::arm_with_hand<double>(),
                                                     {flange[0], flange[1], flange[2]}};
  return runner(scene, home, cell_places(ur5::skin_patches<1260>()), newtons_per_unit, c, places, no_goal,
                pressed_arm(), arm_with_stiff_finger());
}

/// Twelve cells on the inside of a fingertip.
template <std::size_t I>
Patch<I, 12> fingertip(std::uint32_t first, double newtons) {
  std::vector<PlacedCell<I>> cells;
  for (std::uint32_t k = 0; k < 12; ++k)
    cells.push_back({first + k, Transform<Link<I>, Cell>({{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
                                                         {0.012, 0.005 * (k % 3 - 1.0), 0.005 * (k / 3)})});
  return Patch<I, 12>(cells, {.force = newtons});
}
/// An Allegro hand by position, 48 cells on its fingertips: 3 N on one, then a finger of 500 N/m.
template <class T, class... Parts>
std::unique_ptr<Runner> pressed_hand(const Choices& c, const Parts&... parts) {
  constexpr double newtons = 3;
  using M = CalibratedModel<allegro::Tree, T>;
  const JointLimits<16, T> limits({.lower = JointPosition<16, T>::constant(T(-1)),
                                   .upper = JointPosition<16, T>::constant(T(2)),
                                   .velocity = JointVelocity<16, T>::constant(T(7)),
                                   .acceleration = JointAcceleration<16, T>::constant(T(100)),
                                   .torque = JointTorque<16, T>::constant(T(0.7))});
  auto configured = configuration<T>(limits, c);
  configured.viscous_friction = JointTorque<16, T>::constant(T(0.05));
  configured.virtual_inertia = JointTorque<16, T>::constant(T(0.003));
  const auto robot = by_position<T>(allegro::hand<T>(allegro::Side::right), configured, parts...);
  const auto tips = std::tuple(fingertip<3>(1, newtons), fingertip<7>(13, newtons),
                               fingertip<11>(25, newtons), fingertip<15>(37, newtons));
  const auto skin = std::apply(
      [](const auto&... p) { return Skin<M, T, std::remove_cvref_t<decltype(p)>...>(p..., open_skin()); },
      tips);
  const Cycle scene(robot, skin, SkinJointControl{} + GravityControl{});
  std::array<double, 16> home{};
  home.fill(0.5);
  Press push{
      {.link = 3, .place = {0.012, 0.0, 0.0075}, .normal = {1.0, 0.0, 0.0}, .radius = 0.015, .force = 2},
      0.1,
      0.5};
  Press finger = push;
  finger.to = 0.9, finger.stiffness = 500, finger.depth = 0.015;
  const Places<CalibratedModel<allegro::Tree, double>, 3> places{allegro::hand<double>(allegro::Side::right),
                                                                 {0.0, 0.0, 0.0}};
  return runner(scene, home, cell_places(tips), newtons, c, places, no_goal, World{{push}, 1},
                World{{finger}, 1});
}

}  // namespace trade
