#include "skinctl/tracking/redundancy.hpp"

#include <doctest/doctest.h>

using namespace skinctl;

TEST_CASE("FreeNullSpace: the joints go on as they move") {
  const JointVelocity<3> dq{1, 2, 3};
  CHECK(FreeNullSpace().motion(JointPosition<3>{0.1, -0.2, 0.3}, dq).v == dq);
}
