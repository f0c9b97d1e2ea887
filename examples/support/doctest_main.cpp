// The main program of the examples' tests: doctest's runner, and a rule for those that need the clock.
//
// A case in the suite "real time" has a robot and its job wait for each other by the clock. Beside every case runs a thread that
// asks to be woken each millisecond. A case of that suite that fails while this thread was once left waiting for more than 20 ms
// (SKINCTL_TOLERATED_PAUSE in the environment says otherwise) is tried again, twice at most. If it still fails, and the machine still
// does not run what is due, nothing is proven: it says so and exits with 77, which ctest counts as skipped. A case that fails on a
// machine that kept time has failed. So has a filter that no case matches.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;
constexpr int attempts = 3, skipped = 77;

Milliseconds tolerated() {
  const char* told = std::getenv("SKINCTL_TOLERATED_PAUSE");
  return Milliseconds(told ? std::strtod(told, nullptr) : 20);
}

/// An empty thread that keeps time, as far as the machine lets it.
class Pace {
 public:
  Pace() : thread_([this] { keep(); }) {}
  ~Pace() {
    end_ = true;
    thread_.join();
  }
  void begin() { longest_ = 0; }
  Milliseconds longest() const { return Milliseconds(longest_); }

 private:
  void keep() {
    while (!end_) {
      const auto due = Clock::now() + std::chrono::milliseconds(1);
      std::this_thread::sleep_until(due);
      longest_ = std::max(longest_.load(), Milliseconds(Clock::now() - due).count());
    }
  }
  std::atomic<bool> end_ = false;
  std::atomic<double> longest_ = 0;  // [ms]
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
    if (pace) pace->begin();
  }
  void test_case_end(const doctest::CurrentTestCaseStats& stats) override {
    if (stats.failure_flags == 0 || !pace) return;
    const bool real_time = std::string_view(test_->m_test_suite) == "real time";
    failures.push_back({test_->m_name, real_time && pace->longest() > tolerated()});
    if (failures.back().starved)
      std::fprintf(stderr, "STARVED: %s: the machine left a thread waiting for %.0f ms\n", test_->m_name,
                   pace->longest().count());
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
