// 36 A base that gives way: a person pushes a forearm, and the arm and the mobile base behind it go along.
//
//   x, y, yaw  joints 0 to 2: a base on wheels as two prismatic joints and a revolute one, by velocity
//   arm        joints 3 to 8: a UR5 by position on top of it, with springs to its posture
//   F          force of the person's hand on the forearm [N]; the skin reaches all nine joints by J' F
//   brakes     the same robot with a base that does not give way
//   drawn      force of the hand; way of the pressed place, of base and arm, along the push
#include <cstdio>
#include <deque>
#include <memory>

#include "examples/support/curves.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/model/attached.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/testing/hand.hpp"

using namespace skinctl;
using namespace examples;

namespace {

struct BaseTree {
  static constexpr std::size_t joints = 3;
  static constexpr auto parents = chain_parents<3>();
  static constexpr std::array<JointKind, 3> kinds = {JointKind::prismatic, JointKind::prismatic,
                                                     JointKind::revolute};
};
using Robot = Attached<CalibratedModel<BaseTree>, 2, ur5::Model>;
constexpr double newtons_per_reading = 60;
constexpr LinkMask base_joints = joints_between(0, 3), arm_joints = joints_between(3, 9);
constexpr std::size_t forearm = 3 + 2, flange = 3 + 5;

Robot robot() {
  // Each link's z axis is its joint's: along x of the world, then along y, then about z.
  const Rotation<double> next_axis{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  std::array<PlacedLink, 3> links;
  for (PlacedLink& link : links) link.R = next_axis;
  links[2].inertia = {60, {0, 0, 0.2}, 3, 3, 4};
  return attach<2>(CalibratedModel<BaseTree>(canonical_links<BaseTree>(links).links), ur5::Model{},
                   Stand{{}, {0.2, 0, 0.5}});
}

const JointPosition<9> posture{0, 0, 0, 0.0, -1.2, 1.4, -1.8, -1.57, 0.0};

/// Springs of the arm: it gives way first, and comes back as the base has followed.
struct Posture : StatelessLaw<Posture> {
  static constexpr const char* name = "posture";
  JointTorque<9> torque(const auto& known) const noexcept {
    JointTorque<9> tau;
    for (std::size_t i = 3; i < 9; ++i)
      tau[i] = (i < 6 ? 30 : 10) * (posture[i] - known.q()[i]) - (i < 6 ? 15 : 4) * known.dq()[i];
    return tau;
  }
};

/// Heavier and slower than the arm, and it stays where a light touch finds it.
RobotConfiguration<3> base_configuration(bool brakes) {
  const double inf = std::numeric_limits<double>::infinity();
  RobotConfiguration<3> c{.limits = JointLimits<3>({.lower = {-5, -5, -inf},
                                                    .upper = {5, 5, inf},
                                                    .velocity = {0.5, 0.5, 0.6},
                                                    .acceleration = {0.8, 0.8, 1},
                                                    .torque = {300, 300, 150}}),
                          .period = 8ms,
                          .delay = 40ms,
                          .lag = 60ms,
                          .virtual_damping = 1};
  c.coulomb_friction = brakes ? JointTorque<3>::constant(1e4) : JointTorque<3>{12, 12, 5};
  return c;
}

auto make_scene(bool brakes) {
  const RobotConfiguration<6> arm{.limits = limits_of<ur5::Description>(15.0),
                                  .period = 8ms,
                                  .delay = 8ms,
                                  .virtual_damping = 1,
                                  .virtual_inertia = {1, 1, 1, 0.3, 0.3, 0.3}};
  // On the side of the forearm: it looks along the axis of the elbow.
  const std::vector<PlacedCell<forearm>> cell{{1, {Rotation<double>{}, {-0.2, 0, 0.0565}}}};
  return Cycle(
             by_groups(robot(), velocity_joints<base_joints>(base_configuration(brakes)),
                       position_joints<arm_joints>(arm)),
             Skin<Robot, double, Patch<forearm, 1>>(Patch<forearm, 1>(cell, {.force = newtons_per_reading})),
             SkinJointControl{} + Posture{} + GravityControl{})
      .with(MaxToolSpeed<flange>{.speed = 0.5, .reach = 1.2});  // in the world: of base and arm together
}

/// A base that follows velocities 40 ms late with a lag of 60 ms, and an arm that follows positions.
class Plant {
 public:
  explicit Plant(const Robot& model) : model_(model) { state_.q = posture; }
  void advance(const auto& command) {
    under_way_.push_back(command);
    if (under_way_.size() > 6) under_way_.pop_front();
    const auto& late = under_way_.front();
    for (std::size_t i = 0; i < 3; ++i) {
      state_.dq[i] += 0.008 / 0.06 * (late.velocity[i] - state_.dq[i]);
      state_.q[i] += 0.008 * state_.dq[i];
    }
    for (std::size_t i = 3; i < 9; ++i) {
      state_.dq[i] = (command.position[i] - state_.q[i]) / 0.008;
      state_.q[i] = command.position[i];
    }
  }
  [[nodiscard]] const State<9>& state() const { return state_; }
  template <std::size_t Ix>
  [[nodiscard]] Transform<Base, Link<Ix>> link() const {
    return link_poses(model_, state_.q).get<Ix>();
  }

 private:
  Robot model_;
  State<9> state_;
  std::deque<RobotCommand<9, double, Interface::position, Interface::velocity>> under_way_;
};

struct Course {
  double force = 0, work = 0, speed = 0;  ///< greatest force [N], work of the hand [J], the tool's top speed
  double tool = 0, place = 0, base = 0, yaw = 0, arm = 0;  ///< ways while pushed [m], [rad]
  double base_left = 0, arm_left = 0;                      ///< of base and of the arm's joints at the end
  Curve push, way, base_way, arm_way;
  Status said;
};

/// A hand leads the forearm `far` metres sideways within 4 s, stays until 6 s, and goes.
Course run(bool brakes, double far) {
  const Robot model = robot();
  const auto scene = make_scene(brakes);
  using Scene = std::remove_const_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();
  Plant plant(model);
  scene.start(*memory, plant.state());

  const Transform<Link<forearm>, Cell> X_LC(Rotation<double>{}, {-0.2, 0, 0.0565});
  const auto pressed = [&] { return plant.link<forearm>() * X_LC; };
  const Xyz<double> along = -1.0 * pressed().axis_z(), from = pressed().origin();
  const Xyz<double> tool = plant.link<flange>().origin();
  const auto in_push = [&](const Xyz<double>& way) { return dot(along, way); };

  testing::Hand hand(testing::leading_hand(), -0.005);
  Course out;
  const double seconds = 8, h = 0.008;
  Xyz<double> tool_before = tool;
  for (int k = 1; k * h <= seconds; ++k) {
    const double t = h * k, share = std::min(1.0, t / 4), smooth = share * share * (3 - 2 * share);
    const double goal = t < 6 ? far * smooth : std::max(-0.1, far - 0.4 * (t - 6));
    const auto place = pressed();
    const double at = in_push(place.origin() - from);
    const double before = out.way.y.empty() ? 0 : out.way.y.back();
    double F = 0;
    for (int i = 1; i <= 16; ++i) F += hand.advance(h / 16, goal, before + (at - before) * i / 16) / 16;

    const double felt = F * std::max(0.0, -in_push(place.axis_z()));
    const auto reading = static_cast<float>(felt / (3 * newtons_per_reading));
    const CellSample sample{.time = k * 8ms, .cell = 1, .force = {reading, reading, reading}};
    Scene::Input input;
    input.now = k * 8ms;
    input.measured = plant.state();
    input.measured.time = input.now;
    input.samples = {&sample, 1};
    const auto sent = scene.step(*memory, input);
    plant.advance(sent.command);
    out.said |= sent.status;

    const JointPosition<9>& q = plant.state().q;
    double bent = 0;
    for (std::size_t i = 3; i < 9; ++i) bent = std::max(bent, std::abs(q[i] - posture[i]));
    const double base = in_push({q[0], q[1], 0});
    const Xyz<double> tool_now = plant.link<flange>().origin();
    out.force = std::max(out.force, F), out.work += F * (at - before);
    out.speed = std::max(out.speed, norm(Xyz<double>(tool_now - tool_before)) / h);
    tool_before = tool_now;
    if (t < 6) {
      out.tool = in_push(tool_now - tool), out.place = at, out.base = base, out.yaw = q[2], out.arm = bent;
    }
    out.base_left = base, out.arm_left = bent;
    out.push.add(t, F), out.way.add(t, at), out.base_way.add(t, base), out.arm_way.add(t, at - base);
  }
  return out;
}
void print(const char* name, const Course& c) {
  std::printf("%-20s %5.1f N %4.1f J | %4.0f %4.0f %4.0f mm, yaw %6.3f, arm %.3f rad | %4.0f mm, %.3f rad\n",
              name, c.force, c.work, 1e3 * c.place, 1e3 * c.tool, std::round(1e3 * c.base) + 0.0, c.yaw,
              c.arm, std::round(1e3 * c.base_left) + 0.0, c.arm_left);
  c.said.for_each([](Reason reason) { std::printf("%22s%s\n", "", describe(reason)); });
}

}  // namespace

int main(int argc, char** argv) {
  const Course light = run(false, 0.06), led = run(false, 0.6), locked = run(true, 0.6);
  std::printf("%-20s %7s %6s | %s | %s\n", "", "force", "work",
              "forearm, tool, base; joints when it is let go", "2 s later: base, arm");
  print("a light touch", light);
  print("led by 0.6 m", led);
  print("the same, brakes on", locked);
  Curve rest = locked.push, push = led.push;
  push.name = "base gives way", rest.name = "brakes on";
  Curve way = led.way, base = led.base_way, arm = led.arm_way, alone = locked.way;
  way.name = "forearm", base.name = "base", arm.name = "arm", alone.name = "forearm, brakes on";
  return draw(argc, argv, "36_moving_base.svg", "A base that gives way: a forearm is led by 0.6 m",
              {Panel("force of the hand [N]", {push, rest}),
               Panel("way along the push [m]", {way, base, arm, alone})},
              while_above_zero(led.push, "pushed")) ||
         !(light.place > 0.01 && std::abs(light.base) < 1e-3 && led.base > 0.3 && led.arm_left < 0.01 &&
           std::abs(locked.base) < 1e-3 && led.force < 0.6 * locked.force && led.speed < 0.5);
}
