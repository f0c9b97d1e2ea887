// Everything that goes wrong between the job and a hand: the reaction, the time until the servo is off, the exit code.
#include <doctest/doctest.h>

#include <cstdio>
#include <functional>
#include <thread>
#include <vector>

#include "examples/adapters/socket.hpp"
#include "examples/compliant_allegro/run.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_allegro;
using examples::job::Exit;
using simulated_allegro::Faults;

namespace {

constexpr double at = 0.25;  ///< when it goes wrong [s]

struct Row {
  const char* name;
  bool udp;
  Faults faults;
  Exit expected;
  double most;              ///< from the fault until the torques are gone [s]; 0: it goes on
  const char* reason = "";  ///< in the job's words
  std::function<bool(const RunLog&)> shows = {};  ///< that the fault was there
  bool or_fine = false;                           ///< chance decides whether it ends
};

Faults share(double Faults::* what, double x) {
  Faults f;
  f.from = at;
  f.*what = x;
  return f;
}
Faults when(double Faults::* what) {
  Faults f;
  f.*what = at;
  return f;
}
Faults late(double seconds) {
  Faults f = when(&Faults::late_at);
  f.late_for = seconds;
  return f;
}

bool lost_some(const RunLog& log) {
  return log.incomplete > 0;
}

std::vector<Row> rows() {
  const char* gone = "no complete positions from the hand";
  return {
      {"nothing", false, {}, Exit::fine, 0},
      {"1 % of frames lost", false, share(&Faults::lose, 0.01), Exit::fine, 0, "", lost_some},
      {"10 % of frames lost", false, share(&Faults::lose, 0.1), Exit::fine, 0, "", lost_some},
      {"50 % of frames lost", false, share(&Faults::lose, 0.5), Exit::lost, 1, "", lost_some, true},
      {"80 % of frames lost", false, share(&Faults::lose, 0.8), Exit::lost, 0.4, gone, lost_some},
      {"half of the frames twice", false, share(&Faults::duplicate, 0.5), Exit::fine, 0, "",
       [](const RunLog& l) { return l.duplicates > 20; }},
      {"half of the sets in another order", false, share(&Faults::reorder, 0.5), Exit::fine, 0},
      {"10 % of frames cut", false, share(&Faults::truncate, 0.1), Exit::fine, 0, "", lost_some},
      {"30 ms late", false, late(0.03), Exit::fine, 0, "", [](const RunLog& l) { return l.silent > 2; }},
      {"1 s late", false, late(1), Exit::lost, 0.2, gone},
      {"silent hand", false, when(&Faults::silent_at), Exit::lost, 0.2, gone},
      {"link gone", false, when(&Faults::unplug_at), Exit::lost, -1, "the CAN link"},
      {"servo dropped", false, when(&Faults::servo_off_at), Exit::halted, 0.01, "switched its servo off"},
      {"too hot", false, when(&Faults::hot_at), Exit::halted, 0.4, "too hot"},
      {"UDP: 10 % lost", true, share(&Faults::lose, 0.1), Exit::fine, 0, "", lost_some},
      {"UDP: half of them twice", true, share(&Faults::duplicate, 0.5), Exit::fine, 0, "",
       [](const RunLog& l) { return l.duplicates > 20; }},
      {"UDP: a third in another order", true, share(&Faults::reorder, 0.3), Exit::fine, 0},
      {"UDP: 10 % cut", true, share(&Faults::truncate, 0.1), Exit::fine, 0, "", lost_some},
      {"UDP: a motor error", true, when(&Faults::motor_error_at), Exit::halted, 0.2, "motor"},
      {"UDP: another version", true, when(&Faults::other_version_at), Exit::lost, 0.3, gone},
      {"UDP: silent hand", true, when(&Faults::silent_at), Exit::lost, 0.3, gone},
  };
}

struct Ran {
  Exit exit{};
  RunLog log;
  std::string thrown;
};

Ran run_row(const Row& row) {
  Settings s;
  default_task(s);
  s.plant.touches.clear();
  s.quiet = true;
  s.generation = row.udp ? Generation::v5_sense : Generation::v4;
  s.simulate_udp = row.udp;
  s.speed = 1;
  s.duration = 1.2;
  s.faults = row.faults;
  Ran out;
  try {
    out.exit = run(s, false, out.log);
  } catch (const std::exception& e) {
    out.thrown = e.what();
  }
  return out;
}

bool has_torque(const RunLog& log) {
  for (const double x : log.last.torque)
    if (x != 0) return true;
  return false;
}

}  // namespace

TEST_SUITE_BEGIN("real time");

TEST_CASE("Faults of hand and link: reaction, time to rest, exit code") {
  if (skinctl::testing::sanitized) return;  // deadlines of 100 ms mean nothing there
  const auto all = rows();
  std::vector<Ran> ran(all.size());
  // Real time, a few hands at once.
  for (std::size_t begin = 0; begin < all.size(); begin += 7) {
    std::vector<std::thread> threads;
    for (std::size_t k = begin; k < std::min(begin + 7, all.size()); ++k)
      threads.emplace_back([&, k] { ran[k] = run_row(all[k]); });
    for (auto& t : threads) t.join();
  }
  std::printf("| what goes wrong | end | exit | torques gone after [ms] | sets lost | without state |\n");
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Row& row = all[k];
    const RunLog& log = ran[k].log;
    CAPTURE(row.name);
    CHECK(ran[k].thrown == "");
    if (!(row.or_fine && ran[k].exit == Exit::fine)) CHECK(ran[k].exit == row.expected);
    if (*row.reason != 0) {
      CAPTURE(log.reason);
      CHECK(log.reason.find(row.reason) != std::string::npos);
    }
    if (row.shows) CHECK(row.shows(log));
    double rest = -1;
    if (row.most > 0 && ran[k].exit != Exit::fine) {
      rest = (log.last.servo_off_time > 0 ? log.last.servo_off_time : log.last.time) - at;
      CHECK(rest < row.most);
    }
    if (row.most >= 0) {
      if (!row.udp) CHECK_FALSE(log.last.servo);
      CHECK_FALSE(has_torque(log));
    }
    char gone[16] = "-";
    if (rest >= 0) std::snprintf(gone, sizeof gone, "%.0f", 1e3 * rest);
    std::printf("| %s | %s | %d | %s | %llu | %llu |\n", row.name, examples::job::row(ran[k].exit).name,
                examples::job::code(ran[k].exit), gone, static_cast<unsigned long long>(log.incomplete),
                static_cast<unsigned long long>(log.silent));
  }
}

TEST_CASE("A mute hand is refused in time, before anything moves") {
  Settings s;
  default_task(s);
  s.quiet = true;
  s.generation = Generation::v4;
  s.speed = 1;
  s.faults.mute = true;
  RunLog log;
  const auto begin = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(static_cast<void>(run(s, false, log)), adapters::ConnectionError);
  CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(5));  // three times 1 s
}

TEST_SUITE_END();
