// The main program of the examples' tests: doctest's runner, and a rule for those that need the clock.
//
// A case in the suite "real time" has a robot and its job wait for each other by the clock. Beside every case
// runs a thread that asks to be woken each millisecond. A case of that suite that fails while this thread was
// once left waiting for more than 20 ms (SKINCTL_TOLERATED_PAUSE in the environment says otherwise), or while
// other programs took more than a fifth of the processors (SKINCTL_TOLERATED_SHARE), or all of them were busy
// for 95 % of a second (SKINCTL_TOLERATED_LOAD), is tried again, twice at most: an empty thread is soon
// served where one that computes waits for its turn. If it still fails, and the machine still does not run
// what is due, nothing is proven: it says so and exits with 77, which ctest counts as skipped. A case that
// fails on a machine that kept time has failed. So has a filter that no case matches.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;
constexpr int attempts = 3, skipped = 77;

double told(const char* variable, double otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::strtod(text, nullptr) : otherwise;
}

/// What the processors have done since the machine was started [s]; nothing where no /proc/stat says so.
struct Processors {
  double all = 0;   ///< idle too
  double ours = 0;  ///< for this program and those that it has waited for
  double busy = 0;  ///< for anybody, other machines on the same hardware included

  static Processors now() {
    Processors p;
    std::ifstream stat("/proc/stat");
    std::string cpu;
    stat >> cpu;
    const double tick = 1. / static_cast<double>(::sysconf(_SC_CLK_TCK));
    for (int k = 0; k < 8; ++k) {  // user nice system idle iowait irq softirq steal
      double ticks = 0;
      stat >> ticks;
      p.all += tick * ticks;
      if (k != 3 && k != 4) p.busy += tick * ticks;
    }
    for (const int whose : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
      rusage used{};
      ::getrusage(whose, &used);
      for (const timeval& t : {used.ru_utime, used.ru_stime})
        p.ours += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    }
    return p;
  }
  /// Share of the time since `then` in which the processors were busy.
  double load_since(const Processors& then) const {
    return all > then.all ? (busy - then.busy) / (all - then.all) : 0;
  }
  /// Share of the processors that others had between `then` and this.
  double of_others(const Processors& then) const {
    const double passed = all - then.all;
    return passed > 0 ? std::max(0., busy - then.busy - (ours - then.ours)) / passed : 0;
  }
};

/// An empty thread that keeps time, as far as the machine lets it, and looks each second at the load.
class Pace {
 public:
  Pace() : thread_([this] { keep(); }) {}
  ~Pace() {
    end_ = true;
    thread_.join();
  }
  void begin() { longest_ = busiest_ = 0; }
  Milliseconds longest() const { return Milliseconds(longest_); }
  /// Load of the busiest second.
  double busiest() const { return busiest_; }

 private:
  void keep() {
    auto looked = Clock::now();
    Processors then = Processors::now();
    while (!end_) {
      const auto due = Clock::now() + std::chrono::milliseconds(1);
      std::this_thread::sleep_until(due);
      longest_ = std::max(longest_.load(), Milliseconds(Clock::now() - due).count());
      if (due - looked < std::chrono::seconds(1)) continue;
      const Processors now = Processors::now();
      busiest_ = std::max(busiest_.load(), now.load_since(then));
      looked = due, then = now;
    }
  }
  std::atomic<bool> end_ = false;
  std::atomic<double> longest_ = 0;  // [ms]
  std::atomic<double> busiest_ = 0;
  std::thread thread_;
};

struct Failure {
  std::string name;
  bool starved;  ///< in real time, on a machine that did not keep time
};
Pace* pace = nullptr;
std::vector<Failure> failures;
int ran = 0;

struct Listener : doctest::IReporter {
  explicit Listener(const doctest::ContextOptions&) {}
  void test_case_start(const doctest::TestCaseData& test) override {
    test_ = &test;
    ++ran;
    begun_ = Processors::now();
    if (pace) pace->begin();
  }
  void test_case_end(const doctest::CurrentTestCaseStats& stats) override {
    if (stats.failure_flags == 0 || !pace) return;
    const bool real_time = std::string_view(test_->m_test_suite) == "real time";
    const double longest = pace->longest().count(), others = Processors::now().of_others(begun_);
    const double busiest = pace->busiest();
    failures.push_back({test_->m_name, real_time && (longest > told("SKINCTL_TOLERATED_PAUSE", 20) ||
                                                     others > told("SKINCTL_TOLERATED_SHARE", 0.2) ||
                                                     busiest > told("SKINCTL_TOLERATED_LOAD", 0.95))});
    if (failures.back().starved)
      std::fprintf(stderr,
                   "STARVED: %s: the machine left a thread waiting for %.0f ms, gave others %.0f %% of its "
                   "processors, "
                   "and was busy for %.0f %% of a second\n",
                   test_->m_name, longest, 100 * others, 100 * busiest);
  }
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}

 private:
  const doctest::TestCaseData* test_ = nullptr;
  Processors begun_;
};
REGISTER_LISTENER("real time", 1, Listener);

}  // namespace

int main(int argc, char** argv) {
  Pace beside;
  pace = &beside;
  std::string again;
  for (int attempt = 1;; ++attempt) {
    doctest::Context context(argc, argv);
    if (!again.empty()) context.setOption("test-case", again.c_str());
    failures.clear();
    const int result = context.run();
    const bool starved = !failures.empty() && std::all_of(failures.begin(), failures.end(),
                                                          [](const Failure& f) { return f.starved; });
    if (context.shouldExit()) return result;
    if (ran == 0) {
      std::fprintf(stderr, "no case matches\n");
      return 1;
    }
    if (result == 0 || !starved) return result;
    if (attempt == attempts) {
      std::fprintf(stderr, "SKIPPED: nothing is proven on a machine that does not run what is due\n");
      return skipped;
    }
    again.clear();
    for (const Failure& f : failures) {
      again += again.empty() ? "" : ",";
      for (const char c : f.name) again += c == ',' || c == '*' ? '?' : c;  // filters are separated by commas
    }
    std::fprintf(stderr, "AGAIN: %zu cases in real time, attempt %d of %d\n", failures.size(), attempt + 1,
                 attempts);
  }
}
