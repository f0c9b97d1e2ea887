#include "skinctl/law/law_values.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("LawShare: all of feedback and feed-forward unless said otherwise") {
  CHECK(LawShare<double>{}.feedback == 1);
  CHECK(LawShare<float>{}.feed_forward == 1);
}
