#include "skinctl/tactile/force_lead.hpp"

#include <doctest/doctest.h>

#include <random>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/touch_sum.hpp"

using namespace skinctl;

namespace {

using Wrenches = LinkWrenches<ur5::Model, link_bit<2> | link_bit<5>>;
using Motors = JointTouch<ur5::Model>;
using Both = TouchSum<Wrenches, Motors>;

Both touch(double force, double torque) {
  Both out{};
  out.first.set<2>({{0, force, 0}, {0, 0, 0.1 * force}});
  out.second.torque[3] = torque;
  return out;
}

}  // namespace

static_assert(can_be_led<Wrenches> && can_be_led<Motors> && can_be_led<Both> && !can_be_led<NoTouch>);

TEST_CASE("Force lead: the first touch has no change; a push that ends at once leads to a pull") {
  TouchChange<Both>::Memory m{};
  CHECK(TouchChange<Both>::next(m, touch(20, -3)) ==
        touch(0, 0));  // as of a robot that starts while it is held
  CHECK(TouchChange<Both>::next(m, touch(20, -3)) == touch(0, 0));
  const Both ends = TouchChange<Both>::next(m, touch(0, 0));
  CHECK(ends == touch(-20, 3));
  CHECK(led_by(touch(0, 0), 5.0, ends) == touch(-100, 15));
}

TEST_CASE("Force lead: over any time its impulse is the lead times the change of the touch") {
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> u(0, 30), step(1e-4, 1e-2);
  TouchChange<Wrenches>::Memory m{};
  const double lead = 0.028;
  Wrenches now = touch(u(rng), 0).first;
  const Wrenches first = now;
  static_cast<void>(TouchChange<Wrenches>::next(m, now));
  double impulse = 0, own = 0;  // of the led touch, and of the touch itself
  for (int k = 0; k < 1000; ++k) {
    const double h = step(rng);
    now = touch(u(rng), 0).first;
    const Wrenches felt = led_by(now, lead / h, TouchChange<Wrenches>::next(m, now));
    impulse += h * felt.data[0][1], own += h * now.data[0][1];
  }
  CHECK(impulse - own == doctest::Approx(lead * (now.data[0][1] - first.data[0][1])).epsilon(1e-9));
}
