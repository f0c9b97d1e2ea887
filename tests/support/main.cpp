// The main of every test program: doctest's, and a failure when something allocated inside a real-time scope,
// or when the filters left no test to run.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cinttypes>
#include <cstdio>

#include "skinctl/testing/allocation_guard.hpp"

namespace {

bool nothing_ran = false;

struct Count final : doctest::IReporter {
  explicit Count(const doctest::ContextOptions&) {}
  void test_run_end(const doctest::TestRunStats& all) override {
    nothing_ran = all.numTestCasesPassingFilters == 0;
  }
  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_case_start(const doctest::TestCaseData&) override {}
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_end(const doctest::CurrentTestCaseStats&) override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}
};
REGISTER_LISTENER("count", 0, Count);

}  // namespace

int main(int argc, char** argv) {
  const int failed = doctest::Context(argc, argv).run();
  if (nothing_ran) {
    std::fprintf(stderr, "skinctl: no test case of this name, or in this file\n");
    return 1;
  }
  const auto allocations = skinctl::testing::unexpected_real_time_allocations();
  if (allocations == 0) return failed;
  std::fprintf(stderr, "skinctl: %" PRIu64 " calls to the allocator inside real-time scopes\n", allocations);
  return 1;
}
