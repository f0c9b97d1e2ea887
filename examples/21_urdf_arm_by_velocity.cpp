// 21 Your robot, your skin, by velocity: an arm read from a URDF, cells placed by hand on its links by name,
// numbers from a text file, which change without a compiler.
//
//   X_NC   pose of a cell in the link of the file, as a drawing or a viewer shows it; z is the outward normal
//   tau    torque of skin and gravity on the virtual robot, whose velocity is the command
//   drawn  displacement of the touched cells along the finger's direction [mm]
#include <cstdio>
#include <deque>
#include <string>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/io/scene_numbers.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/tactile/skin.hpp"

using namespace skinctl;

using Arm = CalibratedModel<Chain<7>>;

struct Numbers {
  CellGains gains{.force = 20};
  double acceleration = 10, virtual_damping = 4;
  Nanoseconds delay = 8ms;
};
Numbers numbers_of(const std::string& file) {
  auto given = SceneNumbers::of_file(file);
  Numbers out;
  given.set("skin.force", out.gains.force);
  given.set("limits.acceleration", out.acceleration);
  given.set("robot.delay", out.delay);
  given.set("robot.virtual_damping", out.virtual_damping);
  given.finish();
  return out;
}

// The forearm's tube runs along y of forearm_link; the normal of the palm is z of hand_link.
constexpr Rotation<double> looks_along_x{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}};
constexpr Rotation<double> looks_along_z{};

auto make_skin(const Urdf& urdf, const CellGains& gains) {
  const auto forearm = patch_on<3, "forearm_link">(urdf,
                                                   {{1, {looks_along_x, {-0.03, 0.10, 0}}},
                                                    {2, {looks_along_x, {-0.03, 0.13, 0}}},
                                                    {3, {looks_along_x, {-0.03, 0.16, 0}}}},
                                                   gains);
  const auto hand = patch_on<6, "hand_link">(urdf, {{4, {looks_along_z, {0, 0.03, 0.066}}}}, gains);
  return Skin<Arm, double, Patch<3, 3>, Patch<6, 1>>(forearm, hand);
}

auto make_cycle(const Urdf& urdf, const Numbers& numbers) {
  const auto arm =
      by_velocity(calibrated_from<Chain<7>>(urdf), {.limits = limits_of<7>(urdf, numbers.acceleration),
                                                    .period = 4ms,
                                                    .delay = numbers.delay,
                                                    .virtual_damping = numbers.virtual_damping});
  return Cycle(arm, make_skin(urdf, numbers.gains), SkinJointControl{} + GravityControl{});
}

int main(int argc, char** argv) {
  const std::string file = argc > 1 ? argv[1] : EXAMPLES_DATA "/arm7.urdf";
  const Urdf urdf = read_urdf(file, {.tip = "hand_link"});  // without the fingers' joints
  for (const std::string& warning : urdf.warnings) std::printf("%s\n", warning.c_str());
  const Numbers numbers = numbers_of(argc > 2 ? argv[2] : EXAMPLES_DATA "/arm7_numbers.txt");
  const auto cycle = make_cycle(urdf, numbers);
  const Arm& model = cycle.resolver().model();

  State<7> measured;
  measured.q = {0.0, -0.4, 0.0, -2.0, 0.0, 1.7, 0.0};
  const auto pose_of = [&](std::uint32_t cell, const JointPosition<7>& q) {
    const auto X_FC = Transform<NamedFrame<"forearm_link">, Cell>(looks_along_x, {-0.03, 0.13, 0});
    const auto X_HC = Transform<NamedFrame<"hand_link">, Cell>(looks_along_z, {0, 0.03, 0.066});
    const auto poses = link_poses(model, q);
    return cell == 4 ? poses.get<6>() * named_link_pose<6, "hand_link">(urdf) * X_HC
                     : poses.get<3>() * named_link_pose<3, "forearm_link">(urdf) * X_FC;
  };
  auto memory = cycle.start(measured);
  std::deque<JointVelocity<7>> under_way(2);  // the robot follows two cycles late

  double yielded[2] = {};
  int touch = 0;
  for (const auto& [cell, force] : {std::pair{2u, 8.0}, {4u, 4.0}}) {
    const auto before = pose_of(cell, measured.q);
    for (int k = 1; k <= 750; ++k) {
      measured.time += 4ms;
      measured.dq = under_way.front();
      measured.q = integrate(measured.q, measured.dq, 0.004);
      under_way.pop_front();
      const double newtons = k <= 250 ? force : 0;  // a finger for a second
      const auto f = static_cast<float>(newtons / (3 * numbers.gains.force));
      const CellSample sample{.time = measured.time - 1ms, .cell = cell, .force = {f, f, f}};
      decltype(cycle)::Input input;
      input.now = measured.time;
      input.measured = measured;
      input.samples = {&sample, 1};
      under_way.push_back(cycle.step(memory, input).command.velocity);
      const Xyz<double> way = pose_of(cell, measured.q).origin() - before.origin();
      yielded[touch] = -dot(way, before.axis_z());
      if (k % 50 == 0)
        std::printf("%5.2f s cell %u %s %s* %4.0f mm\n", 0.004 * k, cell, newtons > 0 ? "pressed" : "       ",
                    std::string(static_cast<std::size_t>(std::max(0.0, 200 * yielded[touch])), ' ').c_str(),
                    1e3 * yielded[touch]);
    }
    ++touch;
  }
  double speed = 0;
  for (const double v : measured.dq) speed = std::max(speed, std::abs(v));
  std::printf("the forearm gave way by %.0f mm, the hand by %.0f mm; at rest: %.1e rad/s\n", 1e3 * yielded[0],
              1e3 * yielded[1], speed);
  return yielded[0] > 0.01 && yielded[1] > 0.01 && speed < 0.02 ? 0 : 1;
}
