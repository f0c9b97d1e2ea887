// fault_table: what goes wrong between a program and a device, as it is seen, with the exit code and the way
// back. Simulated devices, real sockets. Nothing may hang: a case that takes a minute ends the program
// with 3.
//
// Promise: what goes wrong between a program and its devices ends as its table says, and nothing hangs:
// cables, killed peers, half-open connections, bytes one by one, bursts, other versions, duplicates,
// wrong order, cut short, 1 to 50 % lost, restarts, stops, clocks that go back
// Tried: 136 cases of a UR5 by position, velocity and torque, an Allegro hand, three grippers, a skin:
// reaction, time, exit code, way back; grippers and skins as a test. Also: program `fault_table`,
// `examples/fault_table`

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdarg>
#include <cstdio>
#include <thread>

#include "examples/fault_table/row.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"

namespace fault_table {

std::string text(const char* format, ...) {
  char out[256];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(out, sizeof out, format, arguments);
  va_end(arguments);
  return out;
}

}  // namespace fault_table

int main(int argc, char** argv) {
  using namespace fault_table;
  namespace job = examples::job;
  CLI::App app{
      "Prints what faults do between a program and its devices: reaction, time to rest, recovery, exit code. "
      "The devices are simulated."};
  app.footer(job::exit_help());
  std::vector<std::string> only;
  std::size_t together = 4;
  bool simulate = false, quiet = false;
  app.add_option("--device", only, "ur, allegro, gripper, skin; without it all")
      ->check(CLI::IsMember({"ur", "allegro", "gripper", "skin"}))
      ->delimiter(',');
  app.add_option("--together", together, "cases side by side, which wait for clocks")
      ->check(CLI::Range(1, 32));
  app.add_flag("--simulate", simulate, "simulated devices (there are no others)");
  app.add_flag("--quiet", quiet, "no progress");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const job::StopSignals signals;
  job::Progress progress(quiet, 0.5);
  const auto wanted = [&](const char* name) {
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  };
  Cases cases;
  const auto add = [&](const char* name, Cases (*make)()) {
    if (!wanted(name)) return;
    for (auto& c : make()) cases.push_back(std::move(c));
  };
  add("ur", ur_cases);
  add("allegro", allegro_cases);
  add("gripper", gripper_cases);
  add("skin", skin_cases);

  using Clock = std::chrono::steady_clock;
  std::vector<Row> rows(cases.size());
  struct Lane {
    std::atomic<std::int64_t> since{0};
    std::atomic<std::size_t> at{0};
  };
  std::vector<Lane> lanes(std::min(together, std::max<std::size_t>(cases.size(), 1)));
  std::atomic<std::size_t> next{0}, done{0}, ended{0}, repeated{0};
  std::vector<std::thread> threads;
  for (Lane& lane : lanes)
    threads.emplace_back([&] {
      for (std::size_t k; !signals.asked() && (k = next++) < cases.size(); ++done) {
        lane.at = k;
        lane.since = Clock::now().time_since_epoch().count();
        try {
          rows[k] = cases[k].run();
          // On a machine that is busy a robot and its program may miss each other: what is not so again was
          // not so.
          for (int again = 0; again < 2 && !rows[k].expected && !signals.asked(); ++again, ++repeated) {
            lane.since = Clock::now().time_since_epoch().count();
            rows[k] = cases[k].run();
          }
        } catch (const std::exception& e) {
          rows[k] = {
              .device = cases[k].device, .fault = e.what(), .expected = false, .otherwise = "no exception"};
        }
        lane.since = 0;
      }
      ++ended;
    });
  while (ended < lanes.size()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (progress.due(std::chrono::duration<double>(Clock::now().time_since_epoch()).count()))
      progress.show("%zu of %zu cases", done.load(), cases.size());
    for (const Lane& lane : lanes) {
      const std::int64_t since = lane.since;
      if (since != 0 && Clock::now().time_since_epoch().count() - since > 60'000'000'000) {
        std::fprintf(stderr, "\nfault_table: case %zu (%s) hangs\n", lane.at.load(),
                     cases[lane.at].device.c_str());
        std::fflush(nullptr);
        std::_Exit(job::code(job::Exit::broken));
      }
    }
  }
  for (auto& t : threads) t.join();
  progress.clear();
  if (signals.asked()) return job::code(job::Exit::interrupted);

  std::printf(
      "| device | what goes wrong | reaction | nothing moves or counts after | exit | way back "
      "|\n|---|---|---|---|---|---|\n");
  std::size_t odd = 0;
  for (const Row& r : rows) {
    std::printf("| %s | %s | %s | %s | %d | %s |\n", r.device.c_str(), r.fault.c_str(), r.reaction.c_str(),
                r.rest_ms >= 0 ? text("%.0f ms", r.rest_ms).c_str() : "-", r.exit, r.recovery.c_str());
    if (r.expected) continue;
    ++odd;
    std::fprintf(stderr, "not as expected: %s, %s: should have been %s\n", r.device.c_str(), r.fault.c_str(),
                 r.otherwise.c_str());
  }
  std::printf("\n%zu cases, %zu otherwise than they should be; %zu times a case was run again\n", rows.size(),
              odd, repeated.load());
  return job::code(odd == 0 ? job::Exit::fine : job::Exit::broken);
}
