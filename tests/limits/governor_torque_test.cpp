// A governor of torques on an arm that obeys them, and on people and walls made of springs.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <functional>

#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/limits/governor.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/digits.hpp"
#include "tests/support/governor_alone.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Arm = ur5::Model;
constexpr double dt = 0.002;
using Touch = LinkWrenches<Arm, link_bit<2>, double>;
const auto limits = limits_of<ur5::Description>(20.0);

// Numbers of the test, nobody's recommendation.
const LinkContact<2> region{
    .region = {.force = 80, .blow = 120, .first = 100ms, .stiffness = 2e4, .mass = 4, .power = 50},
    .reach = 0.5,
    .reaction_time = 20ms};
auto governing(const LinkContact<2>& contact) {
  return governor_alone<Interface::torque, Arm>(
      limits, contact_limits(Arm{}, contact), ToolSpeed<Arm, 5>(Arm{}, limits, {.speed = 0.3, .reach = 1.3}));
}
const auto governor = governing(region);
const auto tool_only =
    governing({.region = {.force = 1e6, .blow = 1e6, .first = 1s, .stiffness = 1, .mass = 1},
               .reach = 0.5,
               .reaction_time = 20ms});
using Governors = std::remove_const_t<decltype(governor)>;
constexpr std::array<double, 1> nobody_near{0.0};

/// A spring at a point of the forearm: it is pushed back along `n` (base) beyond where it touches.
struct Wall {
  Xyz<double> point{-0.2, 0, 0.1}, n{0, 0, 1}, at{0, 0, 0};
  double stiffness = 0, force = 0;

  SKINCTL_NOINLINE Xyz<double> place(const JointPosition<6>& q) const {
    const auto X = link_poses<link_bit<2>>(Arm{}, q).template get<2>();
    return X.origin() + X.axes() * point;
  }
  SKINCTL_NOINLINE Touch push(const JointPosition<6>& q) {
    const auto X = link_poses<link_bit<2>>(Arm{}, q).template get<2>();
    const double depth = -dot(n, place(q) - at);
    force = depth > 0 ? stiffness * depth : 0;
    const Xyz<double> F = force * n;
    const Xyz<double> f{dot(X.axes() * Xyz<double>{1, 0, 0}, F), dot(X.axes() * Xyz<double>{0, 1, 0}, F),
                        dot(X.axes() * Xyz<double>{0, 0, 1}, F)};
    Touch out;
    out.template set<2>({f, cross(point, f)});
    return out;
  }
};

/// The arm for `duration` seconds under gravity compensation, `drive`, and a governor or none.
// One function, and loops in it: compilers take long for what is inlined.
using Each = std::function<void(double, const State<6>&, double, Status)>;
State<6> run(const Governors* with, State<6> s, const JointTorque<6>& drive, Wall wall, double duration,
             const Each& each) {
  Governors::Memory memory{};
  for (double t = 0; t < duration; t += dt) {
    const JointTorque<6> hold = gravity_torque(Arm{}, s.q);
    JointCommand<6> wish;
    wish.valid = true;
    wish.torque = limits.within(hold + drive, s.dq);
    Status status;
    if (with != nullptr) {
      const auto out =
          with->step_torque(memory, wish, wish, hold, false, 50, s, wall.push(s.q), nobody_near, dt);
      wish.torque = out.command.torque;
      status = out.status;
    }
    for (int k = 0; k < 10; ++k) {
      const JointAngles<Arm, double> angles(Arm{}, s.q);
      const JointTorque<6> net =
          wish.torque + skin_torque(Arm{}, angles, wall.push(s.q)) - bias_torque(Arm{}, angles, s.dq);
      JointAcceleration<6> a;
      math::Ldlt<6, double>(mass_matrix(Arm{}, angles).data).solve(net.data, a.data);
      const auto mean = integrate(s.dq, a, dt / 20);
      s.dq = integrate(s.dq, a, dt / 10);
      s.q = integrate(s.q, mean, dt / 10);
    }
    each(t, s, wall.force, status);
  }
  return s;
}
double tool_speed(const State<6>& s) {
  const auto at = [&](double h) {
    return link_poses<link_bit<5>>(Arm{}, integrate(s.q, s.dq, h)).template get<5>().origin();
  };
  const auto v = (1 / 2e-6) * (at(1e-6) - at(-1e-6));
  return std::sqrt(dot(v, v));
}
State<6> pose(Random& random) {
  State<6> s;
  s.q = {0.2, -1.2, 1.4, -1.8, -1.57, 0.3};
  for (double& q : s.q) q += uniform(random, -0.3, 0.3);
  return s;
}
constexpr int scenes = SKINCTL_MANY_DIGITS ? 30 : 3;

}  // namespace

TEST_CASE("Governor of torques: what keeps all limits passes to the bit, and what it cannot judge as well") {
  Governors::Memory memory{};
  Random random(1);
  const State<6> s = pose(random);
  JointCommand<6> wish;
  wish.valid = true;
  const JointTorque<6> hold = gravity_torque(Arm{}, s.q);
  wish.torque = hold;
  wish.torque[4] += 0.05;
  auto out = governor.step_torque(memory, wish, wish, hold, false, 50, s, Touch{}, nobody_near, dt);
  CHECK_FALSE(out.altered);
  CHECK_FALSE(out.status.any());
  CHECK(out.command.torque == wish.torque);
  wish.torque[0] = std::nan("");
  out = governor.step_torque(memory, wish, wish, hold, false, 50, s, Touch{}, nobody_near, dt);
  CHECK_FALSE(out.altered);  // the guard refuses it
  wish.torque[0] = 0;
  CHECK_FALSE(
      governor.step_torque(memory, wish, wish, hold, false, 50, s, Touch{}, nobody_near, 0.0).altered);
}

TEST_CASE("Governor of torques: by a velocity that is too old, and without a wish, it brakes nothing") {
  Random random(1);
  State<6> s = pose(random);
  s.dq[0] = 2;  // the tool is much too fast
  JointCommand<6> wish;
  wish.valid = true;
  const JointTorque<6> hold = gravity_torque(Arm{}, s.q);
  wish.torque = hold;
  const auto step = [&](bool stale) {
    Governors::Memory memory{};
    return governor.step_torque(memory, wish, wish, hold, stale, 50, s, Touch{}, nobody_near, dt);
  };
  CHECK(step(false).altered);
  const auto passes = [&](bool stale) {
    const auto out = step(stale);
    CHECK_FALSE(out.altered);
    CHECK_FALSE(out.status.any());
    CHECK(out.command.torque == wish.torque);
    CHECK(out.command.valid == wish.valid);
  };
  passes(true);
  wish.valid = false;
  passes(false);
}

TEST_CASE("Governor of torques: no drive makes the tool faster than its limit, and it gets near it") {
  for (int k = 0; k < scenes; ++k) {
    CAPTURE(k);
    Random random(static_cast<std::uint64_t>(k));
    const State<6> s = pose(random);
    JointTorque<6> drive;
    for (std::size_t i = 0; i < 3; ++i) drive[i] = uniform(random, -60.0, 60.0);
    double fastest = 0, free = 0;
    Status seen;
    run(&tool_only, s, drive, {}, 0.6, [&](double, const State<6>& x, double, Status status) {
      fastest = std::max(fastest, tool_speed(x));
      seen |= status;
    });
    run(nullptr, s, drive, {}, 0.6,
        [&](double, const State<6>& x, double, Status) { free = std::max(free, tool_speed(x)); });
    CHECK(fastest <= 0.3 * 1.01);
    if (free > 0.5) {
      CHECK(fastest >= 0.1);  // the wrist could bring the tool more: it is reckoned with
      CHECK(seen.has(Reason::tool_speed_limited));
    }
  }
}

TEST_CASE(
    "Governor of torques: a contact is pressed no harder than its region bears, however hard the law "
    "drives") {
  int harder = 0, slowed = 0;
  for (int k = 0; k < scenes; ++k) {
    CAPTURE(k);
    Random random(static_cast<std::uint64_t>(k));
    const State<6> s = pose(random);
    Wall wall;
    wall.stiffness = 2e4;
    wall.at = wall.place(s.q) - Xyz<double>{0, 0, 0.05 * uniform(random, 0.0, 1.0)};
    JointTorque<6> drive;
    drive[1] = uniform(random, 20.0, 100.0);  // down
    drive[2] = uniform(random, -10.0, 10.0);
    double most = 0, free = 0;
    Status seen;
    run(&governor, s, drive, wall, 1.0, [&](double, const State<6>&, double F, Status status) {
      most = std::max(most, F);
      seen |= status;
    });
    run(nullptr, s, drive, wall, 1.0,
        [&](double, const State<6>&, double F, Status) { free = std::max(free, F); });
    CHECK(most <= region.region.force);
    CHECK_FALSE(seen.has(Reason::contact_force));
    harder += free > region.region.blow;
    slowed += seen.has(Reason::contact_slowed);
  }
  CHECK(harder > scenes / 3);  // so the test can fail
  CHECK(slowed > 0);
}

TEST_CASE(
    "Governor of torques: whatever bits are in what it reads, a torque within the limits or the wish "
    "itself") {
  Random random(11);
  const auto any = [&](double usual) {
    if (random() % 6 != 0) return usual;
    constexpr double special[] = {
        std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min()};
    const auto k = random() % 8;
    return k < 4 ? special[k] : std::bit_cast<double>(random());
  };
  Governors::Memory memory{};
  int braked = 0, stopped = 0;
  for (int k = 0; k < (SKINCTL_MANY_DIGITS ? 20000 : 1000); ++k) {
    State<6> s = pose(random);  // measured states are those that the guard believes
    for (double& v : s.dq) v = uniform(random, -3.0, 3.0);
    JointTorque<6> hold = gravity_torque(Arm{}, s.q);
    JointCommand<6> wish;
    wish.valid = random() % 20 != 0;
    for (std::size_t i = 0; i < 6; ++i) wish.torque[i] = any(hold[i] + uniform(random, -20.0, 20.0));
    for (double& x : hold) x = any(x);
    Touch touch;
    for (double& x : touch.data[0]) x = any(random() % 2 == 0 ? 0.0 : uniform(random, -30.0, 30.0));
    const std::array<double, 1> nearest{any(0.5)};
    const auto out =
        governor.step_torque(memory, wish, wish, hold, random() % 50 == 0, 50, s, touch, nearest, dt);
    for (std::size_t i = 0; i < 6; ++i) {
      if (out.altered) CHECK(std::abs(out.command.torque[i]) <= limits.torque()[i]);
      if (!out.altered)
        CHECK(std::bit_cast<std::uint64_t>(out.command.torque[i]) ==
              std::bit_cast<std::uint64_t>(wish.torque[i]));
    }
    braked += out.altered;
    stopped += out.status.has(Reason::contact_force);
  }
  CHECK(braked > 100);
  CHECK(stopped > 10);  // a wrench that is not a number counts as pressed too hard
}
