#include "skinctl/core/link_mask.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

static_assert(link_bit<0> == 1 && link_bit<63> == LinkMask(1) << 63);

TEST_CASE("LinkMask: bit i is link i") {
  const LinkMask both = link_bit<2> | link_bit<5>;
  for (int i = 0; i < 64; ++i) CHECK(((both >> i) & 1u) == (i == 2 || i == 5 ? 1u : 0u));
}
