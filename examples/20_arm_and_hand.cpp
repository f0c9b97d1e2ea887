// 20 An arm by velocity and a hand by torque in one cycle: the hand closes, a push on a finger moves both.
//
//   tau   one torque of skin, grip and gravity, 22 joints
//   arm   6 of them: a UR5 that takes only velocities; its virtual robot carries their torque
//   hand  16 of them: an Allegro hand that takes torques; the law reads the measured fingers
#include <cstdio>
#include <deque>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/velocity_and_torque.hpp"
#include "skinctl/robots/ur5_allegro.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/skin_torque.hpp"

using namespace skinctl;

using ArmWithHand = ur5_allegro::Model<>;
constexpr LinkMask fingers = joints_between(6, 22);

// Springs that close the fingers.
struct Grip : StatelessLaw<Grip> {
  static constexpr const char* name = "grip";
  JointPosition<16> closed;

  JointTorque<22> torque(const auto& known) const noexcept {
    JointTorque<22> tau;
    for (std::size_t k = 0; k < 16; ++k) tau[6 + k] = 0.6 * (closed[k] - known.q()[6 + k]);
    return tau;
  }
};

// A cell on the middle of the first finger (link 8) with its normal along x, and one on the wrist of the arm.
auto cells() {
  const Rotation<double> along_x{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
  const std::vector<PlacedCell<4>> wrist{{1, {along_x, {0.04, 0, 0}}}};
  const std::vector<PlacedCell<8>> finger{{2, {along_x, {0.01, 0, 0}}}};
  return Skin<ArmWithHand, double, Patch<4, 1>, Patch<8, 1>>(Patch<4, 1>(wrist, {.force = 20}),
                                                             Patch<8, 1>(finger, {.force = 3}));
}

auto make_cycle() {
  const JointLimits<16> hand({.lower = JointPosition<16>::constant(-1),
                              .upper = JointPosition<16>::constant(2),
                              .velocity = JointVelocity<16>::constant(7),
                              .acceleration = JointAcceleration<16>::constant(500),
                              .torque = JointTorque<16>::constant(0.7)});
  const auto robot = by_velocity_and_torque<fingers>(ur5_allegro::arm_with_hand(),
                                                     {.stiff = {.limits = limits_of<ur5::Description>(15.0),
                                                                .period = 2ms,
                                                                .delay = 8ms,
                                                                .virtual_damping = 4},
                                                      .limits = hand,
                                                      .viscous = JointTorque<16>::constant(0.02)});
  return Cycle(robot, cells(),
               SkinJointControl{} + Grip{{}, JointPosition<16>::constant(0.9)} + GravityControl{});
}

// Simulates an arm by velocity with a hand by torque for one cycle.
void move(const ArmWithHand& model, State<22>& s, const JointVelocity<6>& arm, const JointTorque<16>& hand) {
  JointSubset<22, fingers>::Others::put(arm, s.dq);
  for (int k = 0; k < 8; ++k) {
    const JointAngles<ArmWithHand, double> angles(model, s.q);
    const auto M = mass_matrix(model, angles);
    const auto bias = bias_torque(model, angles, s.dq);
    double block[16 * 16], net[16], ddq[16];
    for (std::size_t i = 0; i < 16; ++i) {
      net[i] = hand[i] - bias[6 + i] - 0.005 * s.dq[6 + i];
      for (std::size_t j = 0; j < 16; ++j) block[16 * i + j] = M(6 + i, 6 + j) + (i == j ? 1e-5 : 0);
    }
    math::Ldlt<16, double>(block).solve(net, ddq);
    for (std::size_t i = 0; i < 16; ++i) s.dq[6 + i] += 0.00025 * ddq[i];
    s.q = integrate(s.q, s.dq, 0.00025);
  }
}

int main() {
  const auto cycle = make_cycle();
  using Joints = std::remove_cvref_t<decltype(cycle.resolver())>;
  const auto& model = cycle.resolver().model();
  State<22> real;
  real.q = JointPosition<22>::constant(0.2);
  Joints::Stiff::put(JointPosition<6>{0.0, -1.2, 1.4, -1.8, -1.57, 0.0}, real.q);
  const auto start = real.q;
  auto memory = cycle.start(real);
  std::deque<JointVelocity<6>> under_way(4);

  std::printf("   t            finger [rad]   wrist [rad]   torque at the finger [N m]\n");
  double opened = 0, gave_way = 0;
  JointVelocity<6> last;
  for (int k = 1; k <= 2000; ++k) {
    real.time = k * 2ms;
    const bool wrist = k > 600 && k < 800, finger = k > 1100 && k < 1300;
    const float f = 0.2f;
    const CellSample samples[2] = {
        {.time = real.time - 1ms, .cell = 1, .force = {wrist ? f : 0, wrist ? f : 0, wrist ? f : 0}},
        {.time = real.time - 1ms, .cell = 2, .force = {finger ? f : 0, finger ? f : 0, finger ? f : 0}}};
    decltype(cycle)::Input input;
    input.now = real.time;
    input.measured = real;
    input.samples = samples;
    const auto out = cycle.step(memory, input);
    under_way.push_back(Joints::stiff(out.command).velocity);  // for the arm
    const auto hand = Joints::torque(out.command);             // for the hand
    move(model, real, under_way.front(), hand);
    under_way.pop_front();
    if (k == 600 || k == 1100) opened = real.q[7], gave_way = 0;
    gave_way = std::max(gave_way, std::abs(real.q[0] - start[0]));
    if (k % 100 == 0)
      std::printf("%5.2f %s %8.3f %14.3f %14.3f\n", 0.002 * k,
                  wrist ? "wrist " : (finger ? "finger" : "      "), real.q[7], real.q[4], hand[1]);
    last = under_way.back();
  }
  double speed = 0;
  for (const double v : last) speed = std::max(speed, std::abs(v));
  std::printf("closed to %.3f rad (asked: 0.9), joint 0 gave way by %.3f rad, at rest: %.1e rad/s\n", opened,
              gave_way, speed);
  return std::abs(opened - 0.9) < 0.05 && gave_way > 0.01 && speed < 0.05 ? 0 : 1;
}
