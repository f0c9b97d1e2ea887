#include "skinctl/core/command.hpp"

#include <doctest/doctest.h>

#include <type_traits>

using namespace skinctl;

static_assert(std::is_trivially_copyable_v<JointCommand<6>>);
static_assert(std::is_trivially_copyable_v<JointCommand<16, float>>);

namespace {
template <std::size_t N, class T>
JointCommand<N, T> numbered() {
  JointCommand<N, T> c;
  c.time = 7ns;
  c.valid = true;
  T next(0);
  for (auto* row : {c.position.data, c.velocity.data, c.acceleration.data, c.torque.data})
    for (std::size_t i = 0; i < N; ++i) row[i] = next = next + T(1);
  return c;
}
}  // namespace

TEST_CASE("JointCommand: a fresh one may not be sent, and moves nothing") {
  const JointCommand<3> fresh;
  CHECK_FALSE(fresh.valid);
  for (std::size_t i = 0; i < 3; ++i) CHECK(fresh.velocity[i] == 0);
}

TEST_CASE_TEMPLATE("RobotCommand: holds what the interfaces take, and nothing else", T, float, double) {
  const auto planned = numbered<5, T>();
  const PositionCommand<5, T> q(planned);
  const VelocityCommand<5, T> dq(planned);
  const RobotCommand<5, T, Interface::position, Interface::torque> both(planned);
  CHECK(q.position == planned.position);
  CHECK(dq.velocity == planned.velocity);
  CHECK(both.position == planned.position);
  CHECK(both.torque == planned.torque);
  CHECK(both.time == planned.time);
  CHECK(both.valid);
  CHECK_FALSE(TorqueCommand<5, T>().valid);
  static_assert(sizeof(PositionCommand<5, T>) < sizeof(both));
}
