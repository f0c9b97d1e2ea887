// Cases that fail, for the rule of support/doctest_main.cpp about a machine that does not keep time.
#include <doctest/doctest.h>

TEST_SUITE_BEGIN("real time");

TEST_CASE("fails always, in real time") {
  CHECK(false);
}

TEST_CASE("holds the third time, in real time") {
  static int times = 0;
  CHECK(++times == 3);
}

TEST_SUITE_END();

TEST_CASE("fails always, without a clock") {
  CHECK(false);
}
