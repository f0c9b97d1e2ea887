// The main job: a stiff UR5 covered with skin gives way where it is touched, and goes back to its task.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "examples/adapters/socket.hpp"
#include "examples/compliant_ur5/endings.hpp"
#include "examples/compliant_ur5/report.hpp"
#include "examples/compliant_ur5/run.hpp"
#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "skinctl/core/contract.hpp"

namespace {

void write_json(const compliant_ur5::RunLog& log, const std::string& path) {
  nlohmann::ordered_json out;
  out["title"] = log.title;
  out["ending"] = log.ending;
  out["words"] = log.words;
  out["peak_force"] = log.peak_force;
  out["rigid_peak_force"] = log.rigid_peak_force;
  for (const auto& f : log.scenario) out["scenario"][f.name] = f.value;
  for (const auto& f : log.result) out["result"][f.name] = f.value;
  for (const auto& t : log.touches)
    out["touches"].push_back({{"start", t.start},
                              {"link", t.link},
                              {"cell", t.cell},
                              {"peak_force", t.peak_force},
                              {"true_peak_force", t.true_peak_force},
                              {"deflection", t.deflection},
                              {"give_way", t.give_way},
                              {"return_error", t.return_error}});
  for (const auto& f : log.felt)  // null: nobody notices a push there
    out["places"].push_back(
        {{"cell", f.cell},
         {"link", f.link},
         {"noticed", std::isfinite(f.noticed) ? nlohmann::ordered_json(f.noticed) : nullptr},
         {"speed", f.speed}});
  for (const auto& t : log.times)
    out["times_us"][t.stage] = {{"median", t.median}, {"p99", t.p99}, {"p99.9", t.p999}, {"max", t.max}};
  std::ofstream file(path);
  file << out.dump(2) << '\n';
  if (!file) throw skinctl::ConfigurationError("cannot write " + path);
}

int run(int argc, char** argv) {
  compliant_ur5::Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  s.report = "compliant_ur5.html";
  std::string interface = "position", robot, picture;
  bool simulate = false, endings = false;
  std::string sense = "skin";
  CLI::App app(
      "A UR5 with skin, commanded by position, velocity or torque, gives way to touch and goes back to its "
      "task.");
  auto* host = app.add_option("--robot", robot,
                              "host of a real UR5; without it a simulated one is started in this process");
  app.add_flag("--simulate", simulate, "a simulated UR5 in this process (the default)")->excludes(host);
  app.add_option("--skin", s.skin, "skin file (JSON): cells, gains; without it 260 generated cells")
      ->check(CLI::ExistingFile);
  app.add_option("--simulated-skin", s.simulated_skin,
                 "skin file of the cells that the simulated robot wears, where --skin says it otherwise")
      ->check(CLI::ExistingFile);
  app.add_option("--skin-address", s.skin_address,
                 "this computer's address at which skin datagrams arrive; 0.0.0.0: any")
      ->capture_default_str();
  app.add_option("--skin-port", s.skin_port, "and the UDP port (0: any)");
  app.add_option("--skin-sender", s.skin_sender, "the only address whose skin datagrams are taken");
  app.add_option("--skin-key", s.skin_key, "file with the key of authenticated skin datagrams: 64 hex digits")
      ->check(CLI::ExistingFile);
  app.add_option("--scenario", s.scenario, "TOML file: control, task, and the simulation's touches")
      ->check(CLI::ExistingFile);
  app.add_option("--touch", s.touch_profile,
                 "CSV time,force: a recorded press instead of the scenario's touches")
      ->check(CLI::ExistingFile);
  app.add_option(
      "--skin-faults", s.skin_faults,
      "what is wrong with the simulated skin: FAULT:CELL or FAULT:SHARE%, then @SECONDS and =LEVEL if "
      "wanted, separated by commas; FAULT: stuck, saturated, blinking, noisy, cross-talk, discharge, "
      "unheard");
  app.add_flag("--trust-all-cells", s.trust_all_cells,
               "readings count as they come: nothing is masked, no rest level is followed");
  app.add_option("--cycles", s.cycles, "end after so many cycles (0: as long as the scenario lasts)");
  auto* rate = app.add_option("--rate", s.rate,
                              "cycles a second; by torque 500, and without a skin unless told otherwise")
                   ->check(CLI::IsMember({125.0, 500.0}));
  app.add_option("--preset", s.preset, "speed against accuracy: balanced has sub-steps of 2 ms, fast of 8 ms")
      ->check(CLI::IsMember({"balanced", "fast"}));
  app.add_option("--interface", interface,
                 "what is commanded; torque: from PolyScope 5.23 or PolyScope X 10.11 on")
      ->check(CLI::IsMember({"position", "velocity", "torque"}));
  app.add_option("--sense", sense,
                 "what feels touch: the skin, the sensor in the wrist of an e-Series, or the motors' torques")
      ->check(CLI::IsMember({"skin", "wrist", "motors"}));
  app.add_option("--speed", s.speed, "of the simulation: 0 as fast as possible, in step; 1 real time")
      ->check(CLI::Range(0.0, 100.0));
  app.add_flag("--clear", s.keep_clear,
               "keep clear of its own links, of the table, and of what its cells see, and give way to what "
               "comes near: "
               "see [clear] of the scenario");
  app.add_flag("--rigid", s.rigid, "the skin does not act: what a stiff arm does to the finger");
  app.add_flag("!--no-compare", s.compare, "do not run the scenario rigid as well");
  app.add_flag("--quiet", s.quiet, "print errors only");
  app.add_option("--record", s.record, "write the run to an MCAP file: it replays, and viewers show it");
  app.add_option("--replay", s.replay, "run a recorded file again and compare every command")
      ->check(CLI::ExistingFile);
  app.add_flag("--live", s.live,
               "serve a page on this computer that shows robot, cells, contacts and torques while it runs; "
               "at real-time pace, until it is stopped; a simulated robot is pressed by the pointer");
  app.add_option("--live-port", s.live_port, "of the page (0: any)")->capture_default_str();
  app.add_flag("--allow-control", s.allow_control, "who sees the page may resume; stop is always allowed");
  app.add_option("--report", s.report, "HTML report with plots (empty: none)");
  app.add_option("--json", s.json, "summary as JSON");
  app.add_option("--picture", picture, "one SVG of force and deflection");
  app.add_option("--rtde-port", s.rtde_port);
  app.add_option("--script-port", s.script_port);
  app.add_option("--dashboard-port", s.dashboard_port);
  app.add_option("--rest-port", s.rest_port, "of PolyScope X, which has no dashboard");
  app.add_option("--reverse-port", s.reverse_port,
                 "of this computer, where the robot's program connects (0: any)");
  app.add_option("--told-port", s.told_port,
                 "that the robot is told instead, where it is forwarded to this computer");
  app.add_flag("--unlock", s.unlock,
               "your consent to release a protective stop before the start: look at the arm first");
  app.add_option(
      "--network-delay", s.network_delay,
      "to the robot and back, beyond one cycle [s]; without it measured before the start (replays need it)");
  app.add_flag("--endings", endings, "print how a run can end, as a table, and leave");
  app.footer(examples::job::exit_help());
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  if (endings) {
    std::fputs(compliant_ur5::endings_as_markdown().c_str(), stdout);
    return 0;
  }
  for (const std::string& file : {s.record, s.report, s.json, picture})
    examples::refuse_own_input(file,
                               {s.skin, s.simulated_skin, s.skin_key, s.scenario, s.touch_profile, s.replay});
  if (!robot.empty()) s.robot = robot;
  if (s.live && app.count("--speed") == 0) s.speed = 1;
  s.until_stopped = s.live && s.cycles == 0;
  if (interface == "velocity") s.interface = skinctl::Interface::velocity;
  if (sense == "wrist") s.sense = compliant_ur5::Sense::wrist;
  if (sense == "motors") s.sense = compliant_ur5::Sense::motors;
  if (s.sense != compliant_ur5::Sense::skin && rate->count() == 0) s.rate = 500;
  if (interface == "torque") {
    s.interface = skinctl::Interface::torque;
    if (rate->count() == 0) s.rate = 500;
  }
  if (s.sense != compliant_ur5::Sense::skin && app.count("--scenario") == 0)
    s.scenario = WITHOUT_SKIN_SCENARIO;
  compliant_ur5::read_scenario(s.scenario, s);
  if (!s.replay.empty()) return static_cast<int>(compliant_ur5::replay(s));

  const examples::job::StopSignals signals;
  compliant_ur5::RunLog log;
  auto outcome = compliant_ur5::run(s, signals.asked(), log);
  if (outcome == compliant_ur5::Outcome::fine && s.compare && !s.rigid && !s.robot && s.speed == 0) {
    compliant_ur5::Settings rigid = s;
    rigid.rigid = rigid.quiet = true;
    rigid.record.clear();
    rigid.live = rigid.until_stopped = rigid.keep_clear = false;
    compliant_ur5::RunLog stiff;
    const auto other = compliant_ur5::run(rigid, signals.asked(), stiff);
    if (other == compliant_ur5::Outcome::fine) {
      log.rigid_peak_force = stiff.peak_force;
      if (!s.quiet && log.peak_force > 0)
        std::printf("  %-34s %.1f N: %.1f times as much\n", "the same touches on a rigid arm",
                    stiff.peak_force, stiff.peak_force / log.peak_force);
    } else {
      outcome = other;
    }
  }
  if (!s.report.empty()) {
    compliant_ur5::write_report(log, s.report);
    if (!s.quiet) std::printf("\nreport: %s\n", s.report.c_str());
  }
  if (!s.json.empty()) write_json(log, s.json);
  if (!picture.empty()) {
    std::ofstream file(picture);
    file << compliant_ur5::picture(log);
    if (!file) throw skinctl::ConfigurationError("cannot write " + picture);
  }
  return static_cast<int>(outcome);
}

}  // namespace

int main(int argc, char** argv) {
  return examples::job::main_of("compliant_ur5", run, argc, argv);
}
