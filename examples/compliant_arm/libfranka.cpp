// compliant_fr3: an FR3 gives way to a hand, over the maker's libfranka: by joint impedance or by torque.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "examples/adapters/franka/libfranka_driver.hpp"
#include "examples/compliant_arm/scene.hpp"
#include "examples/support/program.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/io/urdf.hpp"

namespace {

using namespace skinctl;
using namespace compliant_arm;
using adapters::LibfrankaDriver;
using examples::job::Exit;

constexpr double collision_torque = 60, collision_force = 100;  // [N m], [N]

/// By torque: what the robot feels at its joints is felt as much again, and a friction of its own brings the
/// arm to rest where it was left.
auto torque_scene(const Model<7>& model, const Settings& s, const JointLimits<7>& limits) {
  const auto arm = by_torque(model,
                             {.limits = limits,
                              .period = 1ms,
                              .delay = 2ms,
                              .viscous_friction = JointTorque<7>{30, 30, 30, 30, 3, 3, 0.3}},
                             RobotCompensatesFriction{}, RobotHoldsGravity{});
  const RobotTouch<Model<7>> touch(
      model, {.observer = {}, .gates = same_gate(model, EventGate<>::dead_band(s.torque_threshold))});
  return Cycle(arm, touch, SkinJointControl{});
}

struct NoCells {
  std::span<const CellSample> poll() noexcept { return {}; }
};

template <class Driver, class Scene>
Exit go(Driver& driver, const Scene& scene, const Settings& s, const std::atomic<bool>& stop) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  LoopOptions loop;
  loop.period = 1ms;
  loop.stop = &stop;
  NoCells no_cells;
  Nanoseconds first{};
  JointPosition<7> home;
  std::array<double, 7> moved{};
  double felt = 0;
  const auto before = [&](typename Scene::Input& input, typename Scene::Memory&) {
    if (first == 0ns) {
      first = input.now, home = input.measured.q;
      if constexpr (!Driver::by_torque) input.goal = {driver.told(), 1s};
    }
    return seconds<double>(input.now - first) < s.duration;
  };
  const auto after = [&](const typename Scene::Input& input, const typename Scene::Output&,
                         const Stopwatch&) {
    for (std::size_t i = 0; i < 7; ++i) {
      moved[i] = std::max(moved[i], std::abs(input.measured.q[i] - home[i]));
      felt = std::max(felt, std::abs(driver.motor_torque()[i]));
    }
  };
  driver.start();
  const auto report = run_loop(scene, *memory, driver, no_cells, loop, before, after);
  std::printf("%llu cycles, %llu states passed over; %.1f N m felt at most, joints moved by at most [mrad]",
              static_cast<unsigned long long>(report.cycles),
              static_cast<unsigned long long>(report.lost_packets), felt);
  for (const double m : moved) std::printf(" %.0f", 1e3 * m);
  std::printf("\n");
  if (*driver.error() != 0) std::fprintf(stderr, "compliant_fr3: %s\n", driver.error());
  if (*driver.error() != 0) return Exit::halted;
  return report.ended == LoopEnd::interrupted ? Exit::interrupted : Exit::fine;
}

template <class Driver>
void set(Driver& driver, const Settings& s) {
  std::array<double, 7> torque, stiffness;
  std::array<double, 6> force;
  torque.fill(collision_torque), force.fill(collision_force), stiffness.fill(s.stiffness);
  driver.robot().setCollisionBehavior(torque, torque, force, force);
  if (!Driver::by_torque) driver.robot().setJointImpedance(stiffness);
}

int run(int argc, char** argv) {
  CLI::App app{"An FR3 gives way to a hand, over libfranka."};
  app.footer(examples::job::exit_help());
  Settings s;
  std::string host = "127.0.0.1", mode = "impedance";
  bool any_kernel = false;
  s.robot = Robot::franka;
  simulate_by_default(s);
  app.add_option("--host", host, "the robot's address; of a simulated_arm --protocol franka by default");
  app.add_option("--mode", mode, "impedance or torque")->check(CLI::IsMember({"impedance", "torque"}));
  app.add_option("--stiffness", s.stiffness, "by impedance: of each joint's spring [N m/rad]")
      ->check(CLI::Range(50.0, 5000.0));
  app.add_option("--torque-threshold", s.torque_threshold, "torque at a joint that is no touch [N m]")
      ->check(CLI::Range(0.1, 100.0));
  app.add_option("--duration", s.duration, "[s]")->check(CLI::Range(0.1, 1e6));
  app.add_flag("--any-kernel", any_kernel, "on a kernel without PREEMPT_RT too");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const auto kernel = any_kernel ? ::franka::RealtimeConfig::kIgnore : ::franka::RealtimeConfig::kEnforce;
  const Urdf urdf = read_urdf(SIMULATED_ARM_FR3);
  const auto model = calibrated_from<Chain<7>>(urdf);
  const auto limits = limits_of<7>(urdf, s.acceleration);
  const examples::job::StopSignals signals;
  if (mode == "torque") {
    LibfrankaDriver<Interface::torque> driver(host, kernel);
    set(driver, s);
    return examples::job::code(go(driver, torque_scene(model, s, limits), s, signals.asked()));
  }
  LibfrankaDriver<Interface::impedance> driver(host, kernel);
  set(driver, s);
  Limits<7> own{limits, {}, JointPosition<7>(driver.robot().readOnce().q_d)};
  for (std::size_t i = 0; i < 7; ++i) own.jerk[i] = s.jerk;
  const Springs kind{1ms};
  const double factor = heavier(kind, model, s, own);
  return examples::job::code(go(driver, make_scene(kind, model, s, own, factor), s, signals.asked()));
}

}  // namespace

int main(int argc, char** argv) {
  return examples::job::main_of("compliant_fr3", run, argc, argv);
}
