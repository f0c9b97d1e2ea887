// simulated_arm: a controller of an arm in a process of its own. KUKA's RSI, ABB's EGM, FANUC's stream
// motion, KUKA's FRI for an iiwa, or Franka's FCI for an FR3.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "examples/simulated_arm/egm.hpp"
#include "examples/simulated_arm/franka.hpp"
#include "examples/simulated_arm/fri.hpp"
#include "examples/simulated_arm/rsi.hpp"
#include "examples/simulated_arm/stream_motion.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"
#if SIMULATED_ARM_FRI
#include "skinctl/io/urdf.hpp"
#endif

namespace {

using namespace simulated_arm;
using examples::job::Exit;

/// Runs a controller until its time is over or somebody asks for an end.
template <class C>
Exit watch(C& controller, double seconds, bool quiet) {
  const examples::job::StopSignals signals;
  examples::job::Progress progress(quiet);
  while (!signals.asked() && controller.snapshot().time < seconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const Standing s = controller.snapshot();
    if (progress.due(s.time))
      progress.show("%6.1f s  %llu answers, %llu missing  %s", s.time,
                    static_cast<unsigned long long>(s.answers), static_cast<unsigned long long>(s.late),
                    s.ended.c_str());
  }
  controller.stop();
  progress.clear();
  const Standing s = controller.snapshot();
  if (!quiet)
    std::printf("%llu states, %llu answers, %llu missing%s%s\n", static_cast<unsigned long long>(s.states),
                static_cast<unsigned long long>(s.answers), static_cast<unsigned long long>(s.late),
                s.ended.empty() ? "" : "; ended: ", s.ended.c_str());
  return signals.asked() ? Exit::interrupted : Exit::fine;
}

int run(int argc, char** argv) {
  CLI::App app{
      "A simulated controller that is the clock. By RSI, EGM and FRI it sends to a program on this computer, "
      "by "
      "stream motion and FCI it waits for one; all on loopback."};
  app.footer(examples::job::exit_help());
  std::string protocol = "rsi";
  std::uint16_t port = 0;
  double seconds = 1e9;
  std::vector<double> push;
  bool simulate = false, quiet = false;
  Config config;
  RsiConfig rsi;
  EgmConfig egm;
  FriConfig fri;
  FrankaConfig franka;
  StreamMotionConfig stream;
  app.add_flag("--simulate", simulate, "a simulated arm (there is no other)");
  app.add_option("--protocol", protocol, "rsi, egm, fri, franka or stream_motion")
      ->check(CLI::IsMember({"rsi", "egm", "fri", "franka", "stream_motion"}));
  app.add_option("--port", port,
                 "to send to (RSI, default 59152; EGM, 6510; FRI, 30200), or to wait at (stream motion, "
                 "60015; FCI, 1337)");
  app.add_option("--version", stream.version, "of stream motion; from 4 on with forces")
      ->check(CLI::Range(3, 4));
  app.add_option("--delay", config.delay, "from an answer to the joints [s]")->check(CLI::Range(0.0, 0.5));
  app.add_option("--lag", config.lag, "of the joints [s]")->check(CLI::Range(0.0, 0.5));
  app.add_flag("!--no-hold", rsi.hold_on, "RSI: HOLDON=\"0\"");
  app.add_option("--timeout", rsi.timeout, "RSI: unanswered cycles in a row");
  app.add_option("--send-period", fri.send_period, "FRI: [ms]")->check(CLI::Range(1u, 100u));
  app.add_option("--stiffness", fri.arm.stiffness, "FRI: of each joint [N m/rad]")
      ->check(CLI::Range(50.0, 5000.0));
  app.add_option("--push", push, "time [s] and force at the flange, along its axes [N]; lasts 1 s")
      ->expected(4);
  app.add_option("--speed", config.speed, "1: by the clock; 0: as fast as answers come")
      ->check(CLI::IsMember({0.0, 1.0}));
  app.add_option("--duration", seconds, "[s]")->check(CLI::Range(0.1, 1e9));
  app.add_flag("--quiet", quiet, "errors only");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  if (!push.empty())
    config.pushes = {{.start = push[0], .duration = 1, .force = {push[1], push[2], push[3]}}};
  const bool waits = protocol == "stream_motion" || protocol == "franka";
  if (port == 0)
    port = protocol == "stream_motion" ? 60015
           : protocol == "franka"      ? adapters::franka::default_port
           : protocol == "rsi"         ? 59152
           : protocol == "egm"         ? 6510
                                       : 30200;
  if (!quiet) std::printf("%s 127.0.0.1:%u\n", waits ? "waits at" : "sends to", port);
#if SIMULATED_ARM_FRI
  if (protocol == "franka") {
    const auto model = skinctl::calibrated_from<skinctl::Chain<7>>(skinctl::read_urdf(SIMULATED_ARM_FR3));
    const auto arm = franka_controller(model, config, franka, port);
    return examples::job::code(watch(*arm, seconds, quiet));
  }
  if (protocol == "fri") {
    const auto model = skinctl::calibrated_from<skinctl::Chain<7>>(skinctl::read_urdf(SIMULATED_ARM_IIWA));
    const auto arm = fri_controller(model, config, fri, "127.0.0.1", port);
    return examples::job::code(watch(*arm, seconds, quiet));
  }
#else
  if (protocol == "fri" || protocol == "franka")
    skinctl::refuse(protocol + ": this program was built without tinyxml2, which reads its arm");
#endif
  const auto controller = protocol == "rsi"   ? rsi_controller(config, rsi, "127.0.0.1", port)
                          : protocol == "egm" ? egm_controller(config, egm, "127.0.0.1", port)
                                              : stream_motion_controller(config, stream, "127.0.0.1", port);
  return examples::job::code(watch(*controller, seconds, quiet));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "simulated_arm: %s\n", e.what());
    return examples::job::code(Exit::refused);
  }
}
