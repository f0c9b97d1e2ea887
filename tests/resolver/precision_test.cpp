// not sanitized: fifty digits take minutes there
#include <doctest/doctest.h>

#include "tests/support/closed_loop.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/digits50.hpp"

using namespace skinctl;
using namespace skinctl::testing;
namespace {

// A push, through a robot that does what is declared, in scalar T: where the virtual robot ends.
template <Interface I, class T>
JointPosition<6, T> pushed() {
  RobotConfiguration<6, T> c{.limits = limits_of<ur5::Description, T>(T(40)),
                             .period = 8ms,
                             .delay = 8ms,
                             .lag = 15625us,
                             .virtual_damping = T(0)};
  for (auto& b : c.viscous_friction) b = T(8);
  const ResolverBy<I, ur5::Model, T> robot(ur5::Model{}, c);
  State<6, T> s;
  s.q = {T(0.125), T(-1.5), T(1.25), T(-1), T(-1.5), T(0.25)};
  auto m = robot.start(s);
  Yield::Memory law;
  std::array<Pushed<6, T>, max_substeps> pushes;
  pushes.fill({{T(5), T(-4), T(2), T(0.25), T(0.125), T(0.0625)}});
  for (int k = 1; k <= 60; ++k) {
    s.time = k * 8ms;
    s.q = m.group().under_way.reached;
    robot.step(m, Yield{}, law, s, robot.interval(m, s.time), std::span<const Pushed<6, T>>(pushes));
  }
  return m.group().q.value;
}

template <Interface I, class T>
double error() {
  const auto exact = pushed<I, Digits50>();
  const auto q = pushed<I, T>();
  double worst = 0;
  for (std::size_t i = 0; i < 6; ++i)
    worst = std::max(worst, std::abs(static_cast<double>(Digits50(q[i]) - exact[i])));
  return worst;
}

}  // namespace

#if SKINCTL_MANY_DIGITS
TEST_CASE("Resolver: 60 cycles agree with 50 digits to a few units in the last place") {
  CHECK(error<Interface::position, double>() < 4e-15);
  CHECK(error<Interface::velocity, double>() < 4e-15);
  CHECK(error<Interface::position, float>() < 4e-6);
  CHECK(error<Interface::velocity, float>() < 4e-6);
}
#endif
