// compliant_allegro: an Allegro hand by torque that holds, gives way to a touch and closes on an object.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <map>

#include "examples/compliant_allegro/run.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"
#include "skinctl/io/formatted.hpp"

namespace {

using namespace compliant_allegro;
using examples::job::Exit;

int run(int argc, char** argv) {
  Settings s;
  default_task(s);
  CLI::App app{
      "An Allegro hand by torque: it holds a posture, gives way to touches, closes on what is between its "
      "fingers, and "
      "opens. Without a hand's address it runs a simulated one."};
  app.footer(examples::job::exit_help());
  const std::map<std::string, Generation> generations{
      {"v4", Generation::v4}, {"v5", Generation::v5}, {"v5_sense", Generation::v5_sense}};
  const std::map<std::string, Side> sides{{"right", Side::right}, {"left", Side::left}};
  bool simulate = false;
  Side side = Side::right;
  app.add_flag("--simulate", simulate, "a simulated hand in this process (the default)");
  app.add_option("--can", s.can,
                 "a real hand: CAN interface (can0) or tty of an slcan adapter (/dev/ttyACM0)");
  app.add_option("--udp", s.udp, "a real V5 Sense on Ethernet: its IPv4 address");
  app.add_option("--udp-port", s.udp_port, "its port")->check(CLI::Range(1, 65535));
  app.add_option("--generation", s.generation, "v4, v5 or v5_sense")
      ->transform(CLI::CheckedTransformer(generations, CLI::ignore_case));
  auto* with_side = app.add_option("--side", side, "right or left; a hand of the other side is refused")
                        ->transform(CLI::CheckedTransformer(sides, CLI::ignore_case));
  app.add_option("--hand", s.hand, "its number on the bus")->check(CLI::Range(0, 3));
  app.add_option("--full-torque", s.full_torque,
                 "V4: torque of 1200 PWM [N m]; not published, so measure it");
  app.add_option(
         "--geared", s.geared,
         "V5: gears in joints 1, 5 and 9, yes or no; not said: the smaller torque. A V5 Sense has them")
      ->transform(CLI::CheckedTransformer(std::map<std::string, bool>{{"yes", true}, {"no", false}}));
  app.add_option("--duration", s.duration, "[s]")->check(CLI::Range(0.1, 1e6));
  app.add_option("--stiffness", s.stiffness, "of every joint [N m/rad]")->check(CLI::Range(0.0, 2.0));
  app.add_option("--force-gain", s.force_gain, "of the tactile cells [N] per unit of reading")
      ->check(CLI::Range(0.0, 100.0));
  app.add_flag("--simulate-udp", s.simulate_udp,
               "the simulated V5 Sense speaks UDP on loopback instead of CAN");
  app.add_option("--speed", s.speed, "of the simulation: 1 real time, 0 as fast as it goes")
      ->check(CLI::IsMember({0.0, 1.0}));
  app.add_option("--lose", s.faults.lose, "simulated: share of lost frames")->check(CLI::Range(0.0, 1.0));
  app.add_option("--report", s.report, "HTML report with plots");
  app.add_option("--json", s.json, "summary as JSON");
  app.add_flag("--quiet", s.quiet, "print errors and assumptions only");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const bool real = !s.can.empty() || !s.udp.empty();
  if (simulate && real)
    throw skinctl::ConfigurationError("--simulate and a real hand's address: one of them");
  if (!s.can.empty() && !s.udp.empty()) throw skinctl::ConfigurationError("--can and --udp: one of them");
  if ((s.simulate_udp || !s.udp.empty()) && s.generation != Generation::v5_sense)
    throw skinctl::ConfigurationError("UDP: only a V5 Sense has it");
  if (with_side->count() > 0) s.side = side;
  if (s.faults.lose > 0) s.speed = 1;

  const examples::job::StopSignals signals;
  RunLog log;
  const Exit end = run(s, signals.asked(), log);
  if (!s.quiet) {
    std::printf("\n  touch   at [s]  cell  reading  moved [mm]  1 mm after [ms]  return error [mm]\n");
    int k = 0;
    for (const TouchSummary& t : log.touches) {
      char after[16] = "never";
      if (t.after >= 0) std::snprintf(after, sizeof after, "%.0f", 1000 * t.after);
      std::printf("  %5d %8.2f %5zu %8.2f %11.1f %16s %18.2f\n", ++k, t.start, t.cell, t.reading,
                  1000 * t.moved, after, 1000 * t.return_error);
    }
    std::printf("\n  closed: torque of index, middle, ring, thumb %.3f %.3f %.3f %.3f N m", log.squeeze[0],
                log.squeeze[1], log.squeeze[2], log.squeeze[3]);
    if (!real)
      std::printf("; on the ball %.1f %.1f %.1f %.1f N", log.ball[0], log.ball[1], log.ball[2], log.ball[3]);
    std::printf("\n\n");
    for (const Fact& f : log.facts) std::printf("  %-44s %s\n", f.name.c_str(), f.value.c_str());
  }
  const auto write = [](const std::string& file, const std::string& what) {
    std::ofstream out(file);
    out << what << std::flush;
    if (!out) throw skinctl::ConfigurationError("cannot write " + file);
  };
  if (!s.report.empty()) {
    write(s.report, report(log));
    if (!s.quiet) std::printf("\nreport: %s\n", s.report.c_str());
  }
  if (!s.json.empty()) {
    const std::string line = skinctl::formatted(
        "{\"exit\": %d, \"cycles\": %llu, \"silent\": %llu, \"missed\": %llu, \"incomplete\": %llu, "
        "\"touches\": %zu, \"cycle_us\": {\"median\": %.2f, \"p99\": %.2f, \"max\": %.2f}}\n",
        examples::job::code(end), static_cast<unsigned long long>(log.cycles),
        static_cast<unsigned long long>(log.silent), static_cast<unsigned long long>(log.missed),
        static_cast<unsigned long long>(log.incomplete), log.touches.size(), log.median_us, log.p99_us,
        log.max_us);
    write(s.json, line);
  }
  return examples::job::ended("compliant_allegro", end, log.reason);
}

}  // namespace

int main(int argc, char** argv) {
  return examples::job::main_of("compliant_allegro", run, argc, argv);
}
