// Everything that goes wrong between the job and a hand: the reaction, the time until the servo is off, the
// exit code.
#include <doctest/doctest.h>

#include <cstdio>
#include <thread>

#include "examples/adapters/socket.hpp"
#include "examples/compliant_allegro/tests/fault_rows.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace compliant_allegro;
using namespace compliant_allegro::faults;

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
      rest = rest_of(log);
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
