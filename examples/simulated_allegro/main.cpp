// simulated_allegro: an Allegro hand at a pseudo-terminal (slcan), on a CAN interface, or on UDP.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>

#include "examples/simulated_allegro/simulated_hand.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"

namespace {

using namespace simulated_allegro;
using examples::job::Exit;

int run(int argc, char** argv) {
  Config config;
  config.generation = Generation::v5_sense;
  CLI::App app{
      "A simulated Allegro hand, in real time. Without an option it sits at a pseudo-terminal as an slcan "
      "adapter."};
  app.footer(examples::job::exit_help());
  const std::map<std::string, Generation> generations{
      {"v4", Generation::v4}, {"v5", Generation::v5}, {"v5_sense", Generation::v5_sense}};
  const std::map<std::string, Side> sides{{"right", Side::right}, {"left", Side::left}};
  std::string can;
  bool udp = false, ball = false;
  std::uint16_t port = 7000;
  double duration = 0;
  Faults& f = config.faults;
  app.add_option("--generation", config.generation, "v4, v5 or v5_sense (the default)")
      ->transform(CLI::CheckedTransformer(generations, CLI::ignore_case));
  app.add_option("--side", config.plant.side, "right or left")
      ->transform(CLI::CheckedTransformer(sides, CLI::ignore_case));
  app.add_option("--hand", config.hand, "number on the bus")->check(CLI::Range(0, 3));
  app.add_option("--can", can, "a CAN interface, such as vcan0");
  app.add_flag("--udp", udp, "UDP on loopback (V5 Sense)");
  app.add_option("--port", port, "of UDP");
  app.add_flag("--geared", config.geared, "V5: joints 1, 5 and 9 with another gear");
  app.add_flag("--ball", ball, "with a ball between the fingers");
  app.add_option("--duration", duration, "[s]; 0: until a signal");
  for (const auto& [name, share, words] : {std::tuple{"--lose", &f.lose, "share of lost frames"},
                                           std::tuple{"--duplicate", &f.duplicate, "of frames twice"},
                                           std::tuple{"--reorder", &f.reorder, "of sets in another order"},
                                           std::tuple{"--cut", &f.truncate, "of frames cut"}})
    app.add_option(name, *share, words)->check(CLI::Range(0.0, 1.0));
  for (const auto& [name, time, words] :
       {std::tuple{"--silent-at", &f.silent_at, "it says nothing any more [s]"},
        std::tuple{"--servo-off-at", &f.servo_off_at, "it drops its servo [s]"},
        std::tuple{"--hot-at", &f.hot_at, "it becomes too hot [s]"},
        std::tuple{"--late-at", &f.late_at, "30 ms late [s]"}})
    app.add_option(name, *time, words);
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  if (udp && config.generation != Generation::v5_sense)
    throw skinctl::ConfigurationError("--udp: only a V5 Sense has it");
  if (ball) config.plant.ball = Ball{};

  const examples::job::StopSignals signals;
  SimulatedHand hand(config);
  if (udp) {
    std::printf("udp 127.0.0.1:%d\n", hand.udp(port));
  } else if (!can.empty()) {
    hand.bus(can);
    std::printf("can %s\n", can.c_str());
  } else {
    std::printf("slcan %s\n", hand.terminal().c_str());
  }
  std::fflush(stdout);
  const auto begin = std::chrono::steady_clock::now();
  bool servo = false;
  while (!signals.asked() && (duration <= 0 || std::chrono::steady_clock::now() - begin <
                                                   std::chrono::duration<double>(duration))) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const Snapshot s = hand.snapshot();
    if (s.servo != servo)
      std::printf("%8.2f s  servo %s\n", s.time, s.servo ? "on" : "off"), std::fflush(stdout);
    servo = s.servo;
  }
  const Snapshot s = hand.snapshot();
  std::printf("%llu sets of positions, %llu of torques\n", static_cast<unsigned long long>(s.sets),
              static_cast<unsigned long long>(s.torques));
  return examples::job::code(signals.asked() ? Exit::interrupted : Exit::fine);
}

}  // namespace

int main(int argc, char** argv) {
  return examples::job::main_of("simulated_allegro", run, argc, argv);
}
