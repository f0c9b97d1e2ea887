// From a state on the wire to the command on the wire, of the main job at 500 Hz on loopback, beside an echo.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "examples/adapters/socket.hpp"
#include "examples/compliant_ur5/tests/beside.hpp"
#include "examples/simulated_ur5/faults.hpp"
#include "examples/support/machine_watch.hpp"
#include "examples/support/program.hpp"
#include "skinctl/hardware/histogram.hpp"

namespace {

using Clock = std::chrono::steady_clock;
using skinctl::Histogram;

void print(const char* what, const Histogram& h) {
  const auto us = [](skinctl::Nanoseconds t) { return 1e-3 * static_cast<double>(t.count()); };
  std::printf("| %s | %llu | %.0f | %.0f | %.0f | %.0f |\n", what, static_cast<unsigned long long>(h.count()),
              us(h.percentile(0.5)), us(h.percentile(0.99)), us(h.percentile(0.999)), us(h.max()));
}

/// How many threads wanted a processor in the last minute.
std::string load_average() {
  std::string out = "unknown";
  std::ifstream("/proc/loadavg") >> out;
  return out;
}

/// A state's bytes there, a command's bytes back, 500 times a second, by the same sockets.
Histogram echo(double seconds) {
  boost::asio::io_context io;
  auto acceptor = adapters::listen(io, "127.0.0.1", 0);
  adapters::Stream near, far;
  near.connect("127.0.0.1", acceptor.local_endpoint().port(), "an echo", adapters::Timeout(1000));
  far.accept(acceptor, {}, "a client", adapters::Timeout(1000));
  std::atomic<bool> end = false;
  std::thread answering([&] {
    std::array<std::uint8_t, 256> block{};
    std::size_t n = 0;
    while (!end)
      if (far.read_some(block, n, adapters::Timeout(50)) == adapters::Read::some)
        far.write(std::span(block).first(32), adapters::Timeout(50));
  });
  Histogram times;
  std::array<std::uint8_t, 240> state{};
  std::array<std::uint8_t, 64> answer{};
  auto next = Clock::now();
  for (int k = 0; k < static_cast<int>(500 * seconds); ++k) {
    next += std::chrono::milliseconds(2);
    std::this_thread::sleep_until(next);
    near.write(state, adapters::Timeout(50));
    const auto sent = Clock::now();
    std::size_t n = 0;
    if (near.read_some(answer, n, adapters::Timeout(50)) == adapters::Read::some)
      times.record(Clock::now() - sent);
  }
  end = true;
  answering.join();
  return times;
}

}  // namespace

int main(int argc, char** argv) {
  namespace job = examples::job;
  double seconds = 10;
  bool simulate = false;
  CLI::App app{
      "Measures from a state on the wire to its command on the wire: the main job by velocity at 500 Hz "
      "against a "
      "simulated UR5, beside an echo on the same sockets. What else the machine does shows: run it alone."};
  app.footer(job::exit_help());
  app.add_option("seconds", seconds, "of the run; of the echo a fifth")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  app.add_flag("--simulate", simulate, "a simulated UR5 (there is no other)");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const job::StopSignals signals;
  using namespace compliant_ur5;
  Settings s;
  s.scenario = COMPLIANT_UR5_SCENARIO;
  s.quiet = true;
  read_scenario(s.scenario, s);
  s.rate = 500;
  s.interface = skinctl::Interface::velocity;
  std::atomic<std::int64_t> left{0};
  Histogram times;
  std::uint64_t late = 0;  // commands that came after the next state was due
  Beside beside(s);
  simulated_ur5::FaultyWire rtde(s.rtde_port, true);
  s.reverse_port = free_tcp_port();
  simulated_ur5::FaultyWire reverse(s.reverse_port, false);
  s.rtde_port = rtde.port();
  s.told_port = reverse.port();
  s.cycles = static_cast<std::uint64_t>(500 * seconds);
  s.task = {{.at = 0.5, .q = {0.5, -1.0, 1.2, -1.7, -1.57, 0.3}, .duration = 0.5 * seconds}};
  // A state leaves one wire, its command comes in at the other, where the robot is the client.
  const auto now = [] { return Clock::now().time_since_epoch().count(); };
  rtde.set_observer([&](bool from_robot, bool sent_on) {
    if (from_robot && sent_on) left = now();
  });
  reverse.set_observer([&](bool from_job, bool sent_on) {
    if (!from_job || sent_on) return;
    if (const std::int64_t since = left.exchange(0); since != 0) {
      const skinctl::Nanoseconds took(now() - since);
      times.record(took);
      late += took > std::chrono::milliseconds(2);
    }
  });
  RunLog log;
  const std::string busy_before = load_average();
  examples::MachineWatch machine;
  const Outcome outcome = run(s, signals.asked(), log);
  machine.stop();
  const Histogram beside_it = echo(outcome == Outcome::interrupted ? 0 : std::max(1.0, 0.2 * seconds));
  std::printf("load average before and after: %s, %s; %u processors\n\n", busy_before.c_str(),
              load_average().c_str(), std::thread::hardware_concurrency());
  std::printf("| on loopback [us] | exchanges | median | p99 | p99.9 | max |\n|---|---|---|---|---|---|\n");
  print("echo, a state's bytes there and a command's back", beside_it);
  print("state to command", times);
  for (const auto& t : log.times)
    if (t.stage == "whole cycle")
      std::printf("| of these the cycle | %llu | %.0f | %.0f | %.0f | %.0f |\n",
                  static_cast<unsigned long long>(s.cycles), t.median, t.p99, t.p999, t.max);
  print("a thread without work, woken so late each millisecond", machine.late());
  std::printf("\ncommands later than 2 ms after their state: %llu of %llu\n",
              static_cast<unsigned long long>(late), static_cast<unsigned long long>(times.count()));
  for (const auto& f : log.result)
    if (f.name == "missed deadlines")
      std::printf("states that came more than 3 ms after the one before: %s\n", f.value.c_str());
  std::printf("the machine woke that thread more than 1 ms late: %llu of %llu times\n",
              static_cast<unsigned long long>(machine.by_a_millisecond()),
              static_cast<unsigned long long>(machine.late().count()));
  std::printf("the run: %s\n", log.words.c_str());
  return examples::job::code(outcome);
}
