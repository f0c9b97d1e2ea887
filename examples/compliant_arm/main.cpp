// compliant_arm: an arm whose controller is the clock gives way at its tool. Stiff by position: KUKA by RSI,
// ABB by EGM, FANUC by stream motion. On springs, by joint impedance: KUKA's iiwa by FRI, Franka's FR3 by
// FCI.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <map>

#include "examples/adapters/socket.hpp"
#include "examples/compliant_arm/run.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/io/formatted.hpp"

namespace {

using namespace compliant_arm;
using adapters::fri::Overlay;
using examples::job::Exit;

std::string json(Exit end, const RunLog& log) {
  std::string pushes;
  for (const PushSummary& p : log.pushes)
    pushes += skinctl::formatted("%s{\"at\": %.2f, \"force\": %.1f, \"moved_mm\": %.1f, \"left_mm\": %.2f}",
                                 pushes.empty() ? "" : ", ", p.start, p.force, 1e3 * p.moved, 1e3 * p.left);
  const auto n = [](std::uint64_t x) { return static_cast<unsigned long long>(x); };
  return skinctl::formatted(
             "{\"exit\": %d, \"cycles\": %llu, \"silent\": %llu, \"lost\": %llu, \"doubled\": %llu, "
             "\"late\": %llu, \"late_there\": %llu, \"felt_kg\": %.1f, \"cycle_us\": %.1f, ",
             examples::job::code(end), n(log.cycles), n(log.silent), n(log.counts.lost),
             n(log.counts.doubled), n(log.counts.late), n(log.counts.late_there), log.felt_mass,
             log.cycle_us) +
         "\"pushes\": [" + pushes + "]}\n";
}

void print(const RunLog& log) {
  std::printf("\n  push at [s]  force [N]  moved [mm]  left after 2 s [mm]\n");
  for (const PushSummary& p : log.pushes)
    std::printf("  %11.2f %10.1f %11.1f %20.2f\n", p.start, p.force, 1e3 * p.moved, 1e3 * p.left);
  if (log.bent > 0) std::printf("\n  the springs were bent by %.0f mrad at most\n", 1e3 * log.bent);
  const auto n = [](std::uint64_t x) { return static_cast<unsigned long long>(x); };
  std::printf(
      "\n  cycles %llu, without a state %llu; datagrams lost %llu, twice %llu, overtaken %llu, passed over "
      "%llu, "
      "nonsense %llu\n  answers late here %llu, late at the controller %llu\n"
      "  commands at most %.0f, %.0f and %.0f %% of their limits of velocity, acceleration and jerk\n"
      "  a cycle %.1f us in the median, %.1f us at most; from a datagram to its answer at most %.0f us\n",
      n(log.cycles), n(log.silent), n(log.counts.lost), n(log.counts.doubled), n(log.counts.overtaken),
      n(log.counts.skipped), n(log.counts.nonsense), n(log.counts.late), n(log.counts.late_there),
      100 * log.peak[0], 100 * log.peak[1], 100 * log.peak[2], log.cycle_us, log.cycle_max_us,
      log.load_max_us);
}

void print(const Found& found) {
  std::printf("  delay %.1f ms, lag %.1f ms, both %.1f +- %.1f ms: --delay %.4f --lag %.4f\n",
              1e3 * found.delay, 1e3 * found.lag, 1e3 * found.both, 1e3 * found.deviation, found.delay,
              found.lag);
  for (std::size_t i = 0; i < found.stiffness.size(); ++i)
    if (found.stiffness[i] > 0)
      std::printf("  spring of A%zu: %.0f N m/rad\n", i + 1, found.stiffness[i]);
    else
      std::printf("  spring of A%zu: not known, it was hardly pushed\n", i + 1);
}

int run(int argc, char** argv) {
  Settings s;
  CLI::App app{
      "An arm gives way to pushes on its tool and comes back: a stiff industrial arm by position, felt by a "
      "sensor in its wrist, or an iiwa or FR3 by joint impedance, felt by its joints. The controller is the "
      "clock: KUKA's RSI, ABB's EGM, KUKA's FRI, Franka's FCI, FANUC's stream motion. Without an address it "
      "is "
      "simulated."};
  app.footer(examples::job::exit_help());
  std::string bind, host, from;
  std::uint16_t port = 0;
  bool simulate = false, relative = false;
  double period = 4;
  std::optional<double> delay, lag;
  app.add_flag("--simulate", simulate, "a simulated controller in this process (the default)");
  app.add_option("--robot", s.robot, "rsi, egm, fri, franka or stream_motion")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, Robot>{{"rsi", Robot::rsi},
                                                               {"egm", Robot::egm},
                                                               {"fri", Robot::fri},
                                                               {"franka", Robot::franka},
                                                               {"stream_motion", Robot::stream_motion}}));
  app.add_option("--bind", bind,
                 "RSI, EGM, FRI: this computer's address, as the controller's configuration says it");
  app.add_option("--port", port,
                 "RSI, EGM, FRI: port of that configuration (59152, 6510, 30200); FR3: of a simulation");
  app.add_option("--from", from, "RSI, EGM, FRI: the controller's address; others are not heard");
  app.add_option("--type", s.rsi.type, "RSI: SENTYPE of that configuration");
  app.add_option(
         "--period", period,
         "RSI: 4 (#IPO_FAST) or 12 (#IPO); EGM: \\SampleRate; FRI: send period times receive multiplier [ms]")
      ->check(CLI::Range(1.0, 100.0));
  app.add_flag(
      "--identify", s.identify,
      "the arm moves by 0.1 rad for 15 s: delay and lag; FRI, FR3: then push it, and its stiffness shows");
  app.add_flag("--relative", relative, "RSI: corrections for RSI_ON(#RELATIVE)");
  app.add_option("--max-correction", s.rsi.max_correction, "RSI: of AXISCORR and AXISCORRMON [deg]");
  const auto* stiffness =
      app.add_option("--stiffness", s.stiffness,
                     "of each joint's spring [N m/rad]; FRI: as JointImpedanceControlMode has it; FR3: as it "
                     "is set")
          ->check(CLI::Range(50.0, 5000.0));
  app.add_option("--damping-ratio", s.damping_ratio, "FRI, FR3: of the same")->check(CLI::Range(0.1, 1.0));
  app.add_option("--overlay", s.fri.overlay,
                 "FRI: ClientCommandMode, position or torque (a period of 2 ms at most)")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, Overlay>{{"position", Overlay::position}, {"torque", Overlay::torque}}));
  app.add_option("--torque-threshold", s.torque_threshold,
                 "FRI, FR3: torque at a joint that is no touch [N m]")
      ->check(CLI::Range(0.1, 100.0));
  app.add_option("--host", host, "stream motion, FR3: the controller's address");
  app.add_option("--collision-torque", s.franka.collision_torque,
                 "FR3: torque of the world at a joint that ends the motion [N m]")
      ->check(CLI::Range(1.0, 100.0));
  app.add_option("--collision-force", s.franka.collision_force, "FR3: force at the flange that ends it [N]")
      ->check(CLI::Range(1.0, 500.0));
  app.add_flag("--recover", s.franka.recover, "FR3: clears the errors that ended a motion before");
  app.add_option("--urdf", s.urdf,
                 "of an arm with six joints, the last of which carries the sensor; FRI, FR3: with seven");
  app.add_option("--delay", delay, "of the arm [s]; identify_robot measures it")->check(CLI::Range(0.0, 0.5));
  app.add_option("--lag", lag, "of the arm [s]")->check(CLI::Range(0.0, 0.5));
  app.add_option("--share", s.speed_share, "of the robot's limits that is used")
      ->check(CLI::Range(0.01, 1.0));
  app.add_option("--threshold", s.threshold, "force that is no touch [N]")->check(CLI::Range(0.1, 100.0));
  app.add_option("--duration", s.duration, "[s]")->check(CLI::Range(0.1, 1e6));
  app.add_option("--speed", s.simulation.speed, "of the simulation: 1 real time, 0 as fast as it goes")
      ->check(CLI::IsMember({0.0, 1.0}));
  app.add_option("--json", s.json, "summary as JSON");
  app.add_flag("--quiet", s.quiet, "print errors only");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  s.simulate = bind.empty() && host.empty();
  if (simulate && !s.simulate) skinctl::refuse("--simulate and a real controller's address: one of them");
  const bool has_host = s.robot == Robot::stream_motion || s.robot == Robot::franka;
  if (!bind.empty() && has_host) skinctl::refuse("--bind is for --robot rsi, egm and fri");
  if (!host.empty() && !has_host) skinctl::refuse("--host is for --robot stream_motion and franka");
  if (s.robot == Robot::fri && !s.simulate && stiffness->count() == 0)
    skinctl::refuse("--stiffness: an arm on springs needs the stiffness that its Java program sets");
  if (!bind.empty()) s.rsi.bind = s.egm.bind = s.fri.bind = bind;
  if (port != 0) s.rsi.port = s.egm.port = s.fri.port = s.franka.port = port;
  s.rsi.from = s.egm.from = s.fri.from = from;
  s.stream_motion.host = s.franka.host = host;
  if (relative) s.rsi.correction = s.rsi_controller.correction = adapters::rsi::Correction::relative;
  s.rsi.period = s.egm.period = s.fri.period = skinctl::nanoseconds(1e-3 * period);
  s.rsi_controller.period = s.egm_controller.period = 1e-3 * period;
  s.rsi_controller.ipoc_per_cycle = static_cast<std::uint64_t>(period);
  s.fri_controller.send_period = static_cast<unsigned>(period);
  s.fri_controller.overlay = s.fri.overlay;
  s.fri_controller.arm.stiffness = s.stiffness;
  s.fri_controller.arm.damping_ratio = s.franka_controller.arm.damping_ratio = s.damping_ratio;
  simulate_by_default(s);
  if (s.identify && on_springs(s.robot)) s.simulation.pushes = {{16, 4, {20, 20, 20}}};
  s.delay = delay.value_or(s.delay);
  s.lag = lag.value_or(s.lag);

  const examples::job::StopSignals signals;
  RunLog log;
  const Exit end = run(s, signals.asked(), log);
  if (!s.quiet && !s.identify) print(log);
  if (!s.quiet && log.found.known) print(log.found);
  if (!s.json.empty()) {
    std::ofstream out(s.json);
    if (!(out << json(end, log)).flush()) throw skinctl::ConfigurationError("cannot write " + s.json);
  }
  return examples::job::ended("compliant_arm", end, log.reason);
}

}  // namespace

int main(int argc, char** argv) {
  return examples::job::main_of("compliant_arm", run, argc, argv);
}
