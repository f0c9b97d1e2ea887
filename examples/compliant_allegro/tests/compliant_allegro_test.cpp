// The hand's job against simulated hands.
#include <doctest/doctest.h>
TEST_CASE("x") {}
