// networks: what a network between the main job and a UR5 does that loses, delays, repeats and reorders IP
// packets. Job and robot live in two network namespaces, so that TCP of the kernel itself retransmits: no
// proxy stands between them.
//
// The scenario's first 22 s: two touches at rest, at 3 and 10 s, and one at 18 s while the arm moves; the
// skin's datagrams take the same way. Needs the right to make network namespaces (root, or a user namespace)
// and /dev/net/tun; ends with 2 and words without them.

#include <pthread.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <thread>

#include "examples/compliant_ur5/tests/beside.hpp"
#include "examples/fault_table/network_link.hpp"
#include "examples/fault_table/plain_stream.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"

namespace {

using namespace fault_table;
using skinctl::Interface;
namespace job = examples::job;
using Clock = std::chrono::steady_clock;

constexpr double most_behind = 0.02;  // of the simulated robot; half of what its program waits by torque [s]
constexpr double run_time = 22;       // [s]
constexpr double pressed = 18.6;      // the arm moves, and a finger presses on it [s of the scenario]

struct Network {
  const char* name;
  LinkFault fault{};
  double from = -10;   ///< [s of the scenario]; negative: before the start, so that the job measures it
  double until = 1e9;  ///< likewise
};

std::vector<Network> networks() {
  return {
      {"none", {}},
      {"0.1 % of packets lost", {.loss = 0.001}, 0},
      {"1 % of packets lost", {.loss = 0.01}, 0},
      {"3 % of packets lost", {.loss = 0.03}, 0},
      {"5 ms each way", {.delay = 0.005}},
      {"20 ms each way", {.delay = 0.02}},
      {"5 ms more each way, from 8 s on", {.delay = 0.005}, 8},
      {"20 ms more each way, from 8 s on", {.delay = 0.02}, 8},
      {"20 ms more each way, under a touch", {.delay = 0.02}, pressed},
      {"jitter of 5 ms each way", {.jitter = 0.005}},
      {"5 % of packets twice", {.duplicate = 0.05}, 0},
      {"5 % of packets overtaken", {.reorder = 0.05}, 0},
      {"down for 50 ms under a touch", {.down = true}, pressed, pressed + 0.05},
      {"down for 100 ms under a touch", {.down = true}, pressed, pressed + 0.1},
      {"down for 200 ms under a touch", {.down = true}, pressed, pressed + 0.2},
      {"down for 500 ms under a touch", {.down = true}, pressed, pressed + 0.5},
  };
}

/// Longest time in which a TCP stream brought nothing new, in order, to its reader.
class Streams {
 public:
  void see(const SeenPacket& p) {
    if (p.lost || !p.tcp) return;
    last_ = p.time;
    if (p.length == 0) return;
    Stream& s = streams_[{p.source, p.destination, p.to_robot}];
    if (s.count == 0) s.next = p.sequence;
    s.early.emplace(p.sequence, p.length);
    bool moved = false;
    for (auto at = s.early.begin(); at != s.early.end();) {
      const auto ahead = static_cast<std::int32_t>(at->first - s.next);
      if (ahead > 0) {
        ++at;
        continue;
      }
      const auto end = at->first + at->second;
      if (static_cast<std::int32_t>(end - s.next) > 0) s.next = end, moved = true;
      at = s.early.erase(at);
    }
    if (!moved) return;
    if (++s.count > start) s.longest = std::max(s.longest, p.time - s.last);
    s.last = p.time;
  }
  /// Of the stream that brought most, until the last packet of all [s].
  [[nodiscard]] double longest(bool to_robot) const {
    const Stream* most = nullptr;
    for (const auto& [key, s] : streams_)
      if (std::get<2>(key) == to_robot && (most == nullptr || s.count > most->count)) most = &s;
    return most == nullptr ? 0 : std::max(most->longest, last_ - most->last);
  }

 private:
  double last_ = 0;                  // of all packets [s]
  static constexpr int start = 100;  // pieces that belong to connecting
  struct Stream {
    std::uint32_t next = 0;
    std::map<std::uint32_t, std::uint32_t> early;  ///< number and length of what came
    int count = 0;
    double last = 0, longest = 0;
  };
  std::map<std::tuple<std::uint16_t, std::uint16_t, bool>, Stream> streams_;
};

struct Result {
  int exit = -1;
  std::string words;
  double peak = 0;                  ///< of the touches [N]
  double states = 0, commands = 0;  ///< longest time without [s]
  std::array<double, 3> peaks{};
  bool moved = false;  ///< whether the arm was told to, before the job ended
  double behind = 0;   ///< the simulated robot, of the clock [s]
};

Result suffer(const Network& network, Interface by, std::uint64_t seed) {
  NetworkLink link(seed);
  Streams streams;
  std::mutex mutex;
  link.set_observer([&](const SeenPacket& p) {
    const std::lock_guard lock(mutex);
    streams.see(p);
  });
  compliant_ur5::Settings s = compliant_ur5::settings();
  s.interface = by;
  if (by == Interface::torque) s.rate = 500;
  s.cycles = static_cast<std::uint64_t>(run_time * s.rate);
  std::unique_ptr<compliant_ur5::Beside> beside;
  link.at_robot([&] {
        beside = std::make_unique<compliant_ur5::Beside>(s, [](simulated_ur5::Config& c) {
          const auto touches = c.controller.touches;
          simulated_ur5::Config scenario;
          simulated_ur5::read_scenario(COMPLIANT_UR5_SCENARIO, scenario);
          c.controller.touches = scenario.controller.touches;
          c.controller.touches.resize(3);
          c.address = NetworkLink::robot_address;
          c.skin_host = NetworkLink::job_address;
          c.reach_out = true;
          c.real_time = true;
        });
      })
      .join();
  s.skin_address = NetworkLink::job_address;
  if (network.from < 0) link.set(network.fault);
  Result result;
  compliant_ur5::RunLog log;
  std::atomic<bool> over = false, stop = false;
  std::thread program = link.at_job([&] {
    try {
      result.exit = static_cast<int>(run(s, stop, log));
      result.words = log.words;
    } catch (const skinctl::ConfigurationError& e) {
      result.exit = job::code(job::Exit::refused);
      result.words = std::string("refused before it moves; ") + e.what();
    } catch (const std::exception& e) {
      result.exit = job::code(job::Exit::lost);
      result.words = e.what();
    }
    over = true;
  });
  bool begun = network.from < 0, ended = false, moves = false;
  while (!over) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (begun && ended) continue;
    const double t = beside->robot->snapshot().scenario_time;
    if (!moves &&
        t >= 0) {  // from here on as it asks for itself where it is not quiet; setting up takes long
      moves = true;
      const sched_param priority{.sched_priority = 80};
      static_cast<void>(::pthread_setschedparam(program.native_handle(), SCHED_FIFO, &priority));
    }
    if (!begun && t >= network.from && t >= 0) begun = true, link.set(network.fault);
    if (begun && t >= network.until) ended = true, link.set({});
  }
  program.join();
  const auto world = beside->robot->snapshot();
  for (std::size_t i = 0; i < world.touches.size(); ++i) {
    result.peak = std::max(result.peak, world.touches[i].peak_force);
    result.peaks[i] = world.touches[i].peak_force;
  }
  result.behind = world.behind;
  result.moved = moves || network.from < 0;
  beside->robot->stop();
  const std::lock_guard lock(mutex);
  result.states = streams.longest(false);
  result.commands = streams.longest(true);
  return result;
}

/// Words without their details.
std::string cause(const std::string& words) {
  return words.substr(0, std::min({words.find(": "), words.find("; "), words.size()}));
}

constexpr const char* in_words(Interface by) {
  return by == Interface::position ? "position" : by == Interface::velocity ? "velocity" : "torque";
}

/// `work` for each of 0 to `count` - 1, several side by side; false where a signal came before the last.
/// Throws what one of them throws first.
bool side_by_side(std::size_t count, std::size_t together, bool quiet,
                  const std::function<void(std::size_t)>& work) {
  const job::StopSignals signals;
  job::Progress progress(quiet, 0.5, stderr);
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> failed = false;
  std::exception_ptr why;
  std::vector<std::thread> lanes;
  for (std::size_t lane = 0; lane < together; ++lane)
    lanes.emplace_back([&] {
      for (std::size_t k; !signals.asked() && !failed && (k = next++) < count; ++done) try {
          work(k);
        } catch (...) {
          if (!failed.exchange(true)) why = std::current_exception();
        }
    });
  while (done < count && !signals.asked() && !failed) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (progress.due(std::chrono::duration<double>(Clock::now().time_since_epoch()).count()))
      progress.show("%zu of %zu runs", done.load(), count);
  }
  for (auto& t : lanes) t.join();
  progress.clear();
  if (why) std::rethrow_exception(why);
  return !signals.asked();
}

/// Plain streams of the messages that the job sends, without job and robot: how often they wait.
struct PlainCase {
  Network network;
  PlainStream stream;
  std::vector<std::vector<double>> stalls;  ///< of each run [s]
};
std::vector<PlainCase> plain_cases(const std::vector<Network>& chosen, std::size_t runs,
                                   const std::string& congestion) {
  std::vector<PlainCase> out;
  for (const Network& network : chosen)
    for (const double rate : {125.0, 500.0})
      for (const int again : {0, rate > 125 ? 4 : 10})
        out.push_back({network,
                       {.bytes = 32, .rate = rate, .congestion = congestion, .retransmission = again},
                       std::vector<std::vector<double>>(runs)});
  return out;
}
void print_plain(const std::vector<PlainCase>& cases) {
  constexpr double patience[] = {0.04, 0.1};  // of the robot's program by torque, and else [s]
  std::printf(
      "| messages | sent again after | network | waits above 40 ms a minute | above 100 ms | longest |\n"
      "|---|---|---|---|---|---|\n");
  for (const PlainCase& c : cases) {
    double longest = 0, above[2] = {};
    for (const auto& run : c.stalls)
      for (const double wait : run) {
        longest = std::max(longest, wait);
        for (std::size_t i = 0; i < 2; ++i) above[i] += wait > patience[i];
      }
    const double minutes = static_cast<double>(c.stalls.size()) * run_time / 60;
    const int again = c.stream.retransmission;
    std::printf("| %.0f a second | %s | %s | %.1f | %.1f | %.0f ms |\n", c.stream.rate,
                again == 0 ? "as the system has it" : (std::to_string(again) + " ms").c_str(), c.network.name,
                above[0] / minutes, above[1] / minutes, 1e3 * longest);
  }
}

struct Case {
  Network network;
  Interface by;
  std::vector<Result> results;
};
void print(const std::vector<Case>& cases) {
  std::printf(
      "| by | network | finished | other ends | largest force | longest without a state | without a command "
      "|\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Case& c : cases) {
    std::size_t finished = 0;
    std::map<std::string, std::pair<std::size_t, int>> others;  // how often, exit code
    double force = 0, states = 0, commands = 0;
    for (const Result& r : c.results) {
      if (r.exit == 0)
        ++finished;
      else
        ++others[cause(r.words)].first, others[cause(r.words)].second = r.exit;
      force = std::max(force, r.peak);
      states = std::max(states, r.states);
      commands = std::max(commands, r.commands);
    }
    std::string words;
    for (const auto& [text, times] : others)
      words += (words.empty() ? "" : "; ") + std::to_string(times.first) + " with " +
               std::to_string(times.second) + ": " + text;
    std::printf("| %s | %s | %zu of %zu | %s | %.0f N | %.0f ms | %.0f ms |\n", in_words(c.by),
                c.network.name, finished, c.results.size(), words.empty() ? "-" : words.c_str(), force,
                1e3 * states, 1e3 * commands);
  }
}

/// The run of a case that is counted. What this computer did not run when it was due is no fault of the
/// network: such a run is repeated.
Result counted_run(const Case& c, std::uint64_t seed, bool each, std::atomic<std::size_t>& repeated) {
  Result r;
  for (int again = 0; again < 4; ++again) {
    r = suffer(c.network, c.by, seed);
    if (r.behind < most_behind && r.moved) break;
    ++repeated;
  }
  if (each)
    std::fprintf(stderr,
                 "%s, %s: exit %d, %.0f %.0f %.0f N, states %.0f ms, commands %.0f ms, behind %.0f ms: %s\n",
                 in_words(c.by), c.network.name, r.exit, r.peaks[0], r.peaks[1], r.peaks[2], 1e3 * r.states,
                 1e3 * r.commands, 1e3 * r.behind, r.words.c_str());
  return r;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Prints what a network that loses, delays, repeats and reorders IP packets does to the main job: job "
      "and simulated "
      "robot in two network namespaces of this process."};
  app.footer(job::exit_help());
  std::vector<std::string> interfaces{"position", "velocity", "torque"};
  std::vector<std::size_t> rows;
  std::size_t runs = 3, together = 4;
  bool quiet = false, each = false, plain = false;
  std::string congestion;
  auto* by = app.add_option("--interface", interfaces, "position, velocity, torque")
                 ->check(CLI::IsMember({"position", "velocity", "torque"}))
                 ->delimiter(',');
  app.add_option("--row", rows, "only these networks, from 0 on")
      ->check(CLI::Range(std::size_t(0), networks().size() - 1))
      ->delimiter(',');
  app.add_option("--runs", runs, "of each")->check(CLI::Range(1, 1000))->capture_default_str();
  app.add_option("--together", together, "runs side by side, in real time")
      ->check(CLI::Range(1, 32))
      ->capture_default_str();
  auto* without_job =
      app.add_flag("--plain", plain,
                   "instead: TCP streams of the job's messages on the same wire, without job and robot; how "
                   "often they wait, as the system sends again and as the job asks it to");
  app.add_option("--congestion", congestion, "--plain: cubic, reno or bbr; without it as the system has it")
      ->needs(without_job);
  without_job->excludes(by, app.add_flag("--each", each, "a line for each run, on standard error"));
  app.add_flag("--quiet", quiet, "no progress");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  become_root_of_own_namespace();
  std::vector<Network> chosen;
  const auto all = networks();
  for (std::size_t k = 0; k < all.size(); ++k)
    if (rows.empty() || std::find(rows.begin(), rows.end(), k) != rows.end()) chosen.push_back(all[k]);
  try {
    NetworkLink(0);
    if (plain) {
      auto cases = plain_cases(chosen, runs, congestion);
      const auto stream = [&](std::size_t k) {
        PlainCase& c = cases[k / runs];
        NetworkLink link(1 + k % runs);
        c.stalls[k % runs] =
            stalls(link, c.network.fault, c.stream, run_time, {c.network.from, c.network.until});
      };
      if (!side_by_side(cases.size() * runs, together, quiet, stream))
        return job::code(job::Exit::interrupted);
      print_plain(cases);
      return job::code(job::Exit::fine);
    }
    std::vector<Case> cases;
    for (const Network& network : chosen)
      for (const std::string& name : interfaces)
        for (const Interface i : {Interface::position, Interface::velocity, Interface::torque})
          if (name == in_words(i)) cases.push_back({network, i, std::vector<Result>(runs)});
    std::atomic<std::size_t> repeated{0};
    const auto suffer_one = [&](std::size_t k) {
      Case& c = cases[k / runs];
      c.results[k % runs] = counted_run(c, 1 + k % runs, each, repeated);
    };
    if (!side_by_side(cases.size() * runs, together, quiet, suffer_one))
      return job::code(job::Exit::interrupted);
    print(cases);
    std::printf("\n%zu times a run was repeated, as this computer did not run what was due\n",
                repeated.load());
    return job::code(job::Exit::fine);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "networks: %s\n", e.what());
    return job::code(job::Exit::refused);
  }
}
