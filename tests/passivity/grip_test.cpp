// Two hands that grip an arm behind a delay: the force lead, and the felt mass that the check asks for.
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <memory>
#include <vector>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/passivity/stiffest_contact.hpp"
#include "skinctl/testing/hand.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/touched_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// On opposite sides of the forearm.
const std::vector<PlacedCell<2>> cells{cell_at<2>(1, {-0.2, 0, 0.06}, {0, 0, 1}),
                                       cell_at<2>(2, {-0.2, 0, -0.06}, {0, 0, -1})};
constexpr JointPosition<6> pose{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};

struct Arm {
  Nanoseconds period = 8ms, lag = 8ms;
  double heavier = 1;  ///< felt mass, in times of the arm's own
  bool leads = true;

  RobotConfiguration<6> configuration() const {
    RobotConfiguration<6> c{
        .limits = limits_of<ur5::Description>(30.0), .period = period, .delay = 8ms, .lag = lag};
    c.virtual_damping = 8 / heavier;
    c.viscous_friction = (1 / heavier) * JointTorque<6>{20, 20, 10, 2, 1, 0.5};
    c.dead_band = JointPosition<6>::constant(0.02);
    if (!leads) c.force_lead = 0ns;
    return c;
  }
};

/// How far the force on a hand swings in the last two of eight seconds [N], two hands grip it with 30 N. The
/// skin sends 250 samples a second.
double swing(const Arm& arm, const HandSettings& hand) {
  const auto c = arm.configuration();
  const CellGains gains{.force = newtons_per_unit / arm.heavier, .proximity = 0};
  const auto scene = Cycle(by_position(ur5::Model{}, c), open_skin(Patch<2, 2>(cells, gains)),
                           SkinJointControl{} + GravityControl{});
  using Scene = std::remove_cv_t<decltype(scene)>;
  SimulatedJoints<6> joints(SimulatedJoints<6>::Kind::position, seconds<double>(c.delay),
                            seconds<double>(c.lag), std::to_array(pose.data));
  const auto place = [&] {
    const ur5::Model model;
    const Poses<ur5::Model, all_links(6), double> poses(
        model, JointAngles<ur5::Model, double>(model, JointPosition<6>(joints.q())));
    return poses.template get<2>() * cells[0].X_LC;
  };
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, {0ns, pose, {}});
  const auto start = place();
  Grip grip(hand, 30, 0.002);  // they come from one side
  std::vector<CellSample> samples;
  double low = 1e9, high = -1e9;
  constexpr Nanoseconds step = 250us;
  for (Nanoseconds now = step; now <= 8s; now += step) {
    joints.advance(seconds<double>(now));
    const double x = -dot(start.axis_z(), place().origin() - start.origin());
    grip.advance(seconds<double>(step), x, x);
    if (now % 4ms == 0ns)
      for (unsigned k = 0; k < 2; ++k) {
        CellSample s;
        s.cell = k + 1, s.time = now;
        const double force = 0.05 * std::round(grip.hand(k).force() / 0.05);
        for (float& f : s.force) f = static_cast<float>(std::min(1.0, force / (3 * newtons_per_unit)));
        samples.push_back(s);
      }
    if (now > 6s) low = std::min(low, grip.hand(0).force()), high = std::max(high, grip.hand(0).force());
    if (now % arm.period != 0ns) continue;
    typename Scene::Input input{};
    input.now = input.measured.time = now;
    input.measured.q = JointPosition<6>(joints.q());
    input.measured.dq = JointVelocity<6>(joints.dq());
    input.samples = samples;
    const auto out = scene.step(*memory, input);
    samples.clear();
    joints.command(seconds<double>(now), std::to_array(out.command.position.data));
  }
  return high - low;
}
/// How many times too stiff both hands are, by the check of `StiffestContact`, at this pose.
double lack(const Arm& arm, const HandSettings& hand) {
  const auto c = arm.configuration();
  const ContactStability<ur5::Model> stability(
      ur5::Model{}, c, {.stiffness = hand.cover_stiffness, .body = hand.mass, .skin_delay = 4ms});
  LinkWrenches<ur5::Model, link_bit<2>> w;
  w.set<2>({{0, 0, -1}, cross(cells[0].X_LC.origin(), Xyz<double>{0, 0, -1})});
  const auto tau = skin_torque(ur5::Model{}, pose, w);
  double row[6], mode[6], other[6];
  for (std::size_t i = 0; i < 6; ++i) row[i] = -tau[i];
  const auto modes = stability.modes(pose);
  modes.row(row, mode);
  for (std::size_t i = 0; i < 6; ++i) other[i] = -mode[i];
  const double gain = 1 / arm.heavier;
  return lack_of(detail::ContactLoops<6, double>{modes, stability.path(), mode, gain, other, gain},
                 hand.cover_stiffness, hand.mass, 0.1, 1.0);
}
/// A free hand of `mass`, whose cover loses a tenth of a swing at its own frequency.
HandSettings free_hand(double mass, double cover) {
  return {.mass = mass,
          .stiffness = 0,
          .damping = 0,
          .cover_stiffness = cover,
          .cover_damping = 0.1 * std::sqrt(mass * cover)};
}

}  // namespace

TEST_CASE("Grip: no arm rings between two hands that the check of its felt mass allows") {
  int allowed = 0, rings = 0;
  for (const Nanoseconds lag : {Nanoseconds(8ms), Nanoseconds(38ms)})
    for (const Nanoseconds period : {Nanoseconds(8ms), Nanoseconds(2ms)})
      for (const double heavier : {1.0, 4.0})
        for (const double mass : {2.0, 5.0, 10.0})
          for (const double cover : {3e3, 1e4, 1.5e4}) {
            if (sanitized && mass != 5) continue;
            const Arm arm{.period = period, .lag = lag, .heavier = heavier};
            const auto hand = free_hand(mass, cover);
            const double ring = swing(arm, hand), lacks = lack(arm, hand);
            rings += ring > 4;
            if (lacks > 1) continue;
            ++allowed;
            CAPTURE(mass);
            CAPTURE(cover);
            CAPTURE(heavier);
            CHECK(ring < 1.5);
          }
  CHECK(allowed > (sanitized ? 4 : 20));
  CHECK(rings > (sanitized ? 2 : 6));  // so the check can fail
}

TEST_CASE("Grip: the force lead alone calms hands that an arm without it shakes") {
  const auto hand = free_hand(5, 1e4);
  const double late = swing({.leads = false}, hand), led = swing({}, hand);
  MESSAGE("swings by " << late << " N without force lead, " << led << " N with it");
  CHECK(late > 50);
  CHECK(led < 1);
}
