#include "skinctl/limits/tool_speed.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/sliding_robots.hpp"

using namespace skinctl;

namespace {

template <class T>
using Tool = ToolSpeed<ur5::Model, 5, T>;

template <class T>
Tool<T> tool(double speed, double acceleration = 15) {
  return Tool<T>(ur5::Model{}, limits_of<ur5::Description, T>(T(acceleration)),
                 {.speed = T(speed), .point = {T(0), T(0.05), T(0.1)}, .reach = T(1.3)});
}
const JointRoom<6> endless{JointPosition<6>::constant(HUGE_VAL), JointPosition<6>::constant(HUGE_VAL)};
/// Velocity of the point by differences of poses: independent of Jacobians.
Xyz<double> measured_velocity(const JointPosition<6>& q, const JointVelocity<6>& u) {
  const auto at = [&](double h) {
    const auto X = link_poses<link_bit<5>>(ur5::Model{}, integrate(q, u, h)).get<5>();
    return X.origin() + X.axes() * Xyz<double>{0, 0.05, 0.1};
  };
  return (1 / 2e-6) * (at(1e-6) - at(-1e-6));
}
double measured_speed(const JointPosition<6>& q, const JointVelocity<6>& u) {
  const auto v = measured_velocity(q, u);
  return std::sqrt(dot(v, v));
}
/// The part of `u` that does not move the point at this instant: the arm is fast, and the point soon is.
JointVelocity<6> still(const JointPosition<6>& q, JointVelocity<6> u) {
  Xyz<double> J[6];
  for (std::size_t i = 0; i < 6; ++i) {
    JointVelocity<6> one;
    one[i] = 1;
    J[i] = measured_velocity(q, one);
  }
  for (int k = 0; k < 300; ++k) {
    const auto v = measured_velocity(q, u);
    for (std::size_t i = 0; i < 6; ++i) u[i] -= 0.4 * dot(J[i], v);
  }
  return u;
}

}  // namespace

TEST_CASE("ToolSpeed: refuses what cannot be") {
  CHECK_THROWS_AS(tool<double>(0), ConfigurationError);
  CHECK_THROWS_AS(tool<double>(101), ConfigurationError);
  CHECK_THROWS_AS(tool<double>(std::nan("")), ConfigurationError);
}

TEST_CASE_TEMPLATE("ToolSpeed: its speed is that of the moving point", T, float, double) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto limit = tool<T>(0.25);
  for (int k = 0; k < 200; ++k) {
    JointPosition<6> q;
    JointVelocity<6> u;
    for (std::size_t i = 0; i < 6; ++i) q[i] = 3 * unit(rng), u[i] = 3 * unit(rng);
    const double v = double(limit.at(q.template cast<T>()).speed(u.template cast<T>()));
    CHECK(v == doctest::Approx(measured_speed(q, u)).epsilon(sizeof(T) == 4 ? 1e-5 : 1e-7));
  }
}

// Whatever is asked for, from rest, at whatever intervals: the tool is never too fast, and joints brake only
// as hard as they may.
TEST_CASE_TEMPLATE("ToolSpeed: the limit is always kept", T, float, double) {
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  int near = 0, total = 0;
  double fastest = 0;
  for (const auto& [speed, A] : {std::pair{0.05, 15.0}, {0.25, 15.0}, {1.0, 15.0}, {0.25, 0.5}}) {
    const auto limit = tool<T>(speed, A);
    const auto joints = limits_of<ur5::Description, T>(T(A));
    for (int run = 0; run < 60; ++run) {
      JointPosition<6, T> q;
      JointVelocity<6, T> u, target;
      for (auto& x : q) x = T(2 * unit(rng));
      for (int k = 0; k < 300; ++k, ++total) {
        const T h = T(run % 2 ? 0.002 : std::pow(10, -2.2 + 0.7 * unit(rng)));
        if (k % 60 == 0)
          for (auto& x : target) x = T(4 * unit(rng));
        if (run % 7 == 0) target[5] = T(3);  // turns much, moves little
        if (run % 3 == 0 && k % 10 == 0)
          target = still(q.template cast<double>(), target.template cast<double>()).template cast<T>();
        const auto room = joints.room(q);
        const auto wish = joints.move(room, u, target, h).velocity;
        const auto slow = limit.within(q, room, u, wish, h).velocity;
        for (std::size_t i = 0; i < 6; ++i)
          REQUIRE(std::abs(double(slow[i]) - double(u[i])) <= A * double(h) * 1.0001 + 1e-6);
        // On its way the point follows the joints.
        for (const double part : {0.25, 0.5, 0.75, 1.0}) {
          JointPosition<6> at;
          JointVelocity<6> w;
          for (std::size_t i = 0; i < 6; ++i) {
            w[i] = double(u[i]) + part * (double(slow[i]) - double(u[i]));
            at[i] = double(q[i]) + part * double(h) * 0.5 * (double(u[i]) + w[i]);
          }
          const double v = double(tool<double>(speed).at(at).speed(w));
          REQUIRE(v <= speed * (1 + 1e-5));
          near += v > 0.9 * speed;
          fastest = std::max(fastest, v / speed);
        }
        for (std::size_t i = 0; i < 6; ++i) q[i] += T(0.5) * h * (u[i] + slow[i]);
        u = slow;
      }
    }
  }
  CHECK(near > total / 4);  // used, not shunned
  MESSAGE("fastest " << fastest << " of the limit, above 0.9 of it in " << near << " of " << 4 * total);
}

// A joint that nears its end, and moves the tool little, is slowed alone: the others go on as they were asked
// to.
TEST_CASE("ToolSpeed: a joint beside its end does not hold up the others") {
  for (const double side : {1.0, -1.0})
    for (const double h : {0.002, 0.008}) {
      CAPTURE(side);
      CAPTURE(h);
      const auto limit = tool<double>(0.25, 2);
      auto values = limits_of<ur5::Description>(2.0).values();
      JointPosition<6> q{0.3, -1.2, 1.4, -1.8, -1.57, 0.3};
      (side > 0 ? values.upper : values.lower)[5] = q[5] + side * 0.4;
      const JointLimits<6> joints(values);
      JointVelocity<6> u;
      const JointVelocity<6> target{0.175, 0.07, 0.0, 0.0, 0.0, side * 3};
      double slowest = 1;
      for (double t = 0; t < 1; t += h) {
        const auto room = joints.room(q);
        const auto next = limit.within(q, room, u, joints.move(room, u, target, h).velocity, h).velocity;
        q = integrate(q, 0.5 * (u + next), h);
        q[5] = std::clamp(q[5], values.lower[5], values.upper[5]);  // it may stop within the step
        u = next;
        if (t > 0.2) slowest = std::min({slowest, u[0] / target[0], u[1] / target[1]});
      }
      CHECK(slowest > 0.97);  // 0.76 to 0.85 where only the mix with braking is tried
      CHECK(side * (q[5] - 0.3) == doctest::Approx(0.4).epsilon(1e-3));
    }
}

TEST_CASE(
    "ToolSpeed: what it lets pass stays below the limit while all joints brake, however the arm stretches") {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  int kept = 0, grew = 0;
  for (int k = 0; k < 3000; ++k) {
    const double A = 0.5 + 5 * std::abs(unit(rng));
    const auto limit = tool<double>(0.25, A);
    JointPosition<6> q;
    JointVelocity<6> u;
    for (std::size_t i = 0; i < 6; ++i) q[i] = 2 * unit(rng), u[i] = 2 * unit(rng);
    if (k % 2 == 0) u = still(q, u);
    u = std::abs(unit(rng)) * u;
    if (!limit.keeps(q, u, {}, endless)) continue;
    ++kept;
    double hardest = 0, top = 0;
    for (const double w : u) hardest = std::max(hardest, std::abs(w) / A);
    const double first = measured_speed(q, u);
    for (int step = 0; step <= 100; ++step) {
      const double t = hardest * step / 100, left = 1 - 0.01 * step;
      top = std::max(top, measured_speed(integrate(q, u, t * (1 - 0.5 * t / hardest)), left * u));
    }
    CHECK(top <= 0.25 * (1 + 1e-7));
    grew += top > 1.2 * first;
  }
  CHECK(kept > 500);
  CHECK(grew > 50);
}

TEST_CASE("ToolSpeed: who starts too fast brakes with all joints alike, as hard as the weakest may") {
  const auto limit = tool<double>(0.1);
  const JointPosition<6> q{0.3, -1.2, 1.4, -1.8, -1.57, 0.3};
  JointVelocity<6> u{1.0, 0.5, 0.0, 0.0, 0.0, 0.0};
  const auto slow = limit.within(q, endless, u, u, 0.01).velocity;
  CHECK(slow[0] == doctest::Approx(0.85));
  CHECK(slow[1] == doctest::Approx(0.425));
  u[0] = std::nan("");
  CHECK_FALSE(limit.keeps(q, u, {}, endless));
}

TEST_CASE("ToolSpeed: a step allocates nothing") {
  const auto limit = tool<double>(0.1);
  const testing::AllocationGuard guard;
  for (int k = 0; k < 100; ++k)
    static_cast<void>(
        limit.within({}, endless, JointVelocity<6>::constant(0.1), JointVelocity<6>::constant(0.2), 0.002));
  CHECK(guard.count() == 0);
}

TEST_CASE("ToolSpeed: the share of a motion with which the point keeps its limit for a while") {
  const auto limit = tool<double>(0.25);
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  int slowed = 0;
  for (int k = 0; k < 300; ++k) {
    JointPosition<6> q;
    JointVelocity<6> u;
    for (std::size_t i = 0; i < 6; ++i) q[i] = 3 * unit(rng), u[i] = unit(rng);
    const double time = 0.01, s = limit.share(q, u, time);
    REQUIRE(s >= 0);
    REQUIRE(s <= 1);
    double fastest = 0;  // while it goes on like this
    for (double t = 0; t <= time; t += time / 5)
      fastest = std::max(fastest, measured_speed(integrate(q, u, s * t), s * u));
    CHECK(fastest <= 0.25 * (1 + 1e-6));
    if (s < 1) CHECK(fastest >= 0.12);
    slowed += s < 1;
  }
  CHECK(slowed > 50);
  CHECK(limit.share({}, JointVelocity<6>::constant(std::nan("")), 0.01) == 0);
  CHECK(limit.share({}, {}, 0.01) == 1);
}

// A slide that is turned by the joint before it bends the point's way as much as a long lever does.
TEST_CASE(
    "ToolSpeed: of metres and radians, too, what it lets pass stays below the limit while all joints brake") {
  const auto model = testing::cylindrical();
  using Robot = std::remove_const_t<decltype(model)>;
  const double most = 0.05;
  std::mt19937_64 rng(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto at = [&](const JointPosition<3>& q) {
    return link_poses<link_bit<2>>(model, q).get<2>().origin();
  };
  const auto speed = [&](const JointPosition<3>& q, const JointVelocity<3>& u) {
    return norm(Xyz<double>((1 / 2e-6) * (at(integrate(q, u, 1e-6)) - at(integrate(q, u, -1e-6)))));
  };
  int kept = 0, grew = 0;
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    // The slides carry the point to and fro along y, and the second one turns out of it.
    const double A = 0.5 + 5 * std::abs(unit(rng)), slide = 0.5 * unit(rng);
    JointPosition<3> q{unit(rng), 1.57 + 0.2 * unit(rng), 0};
    JointVelocity<3> u{0.02 * unit(rng) - slide, 2 * unit(rng), slide};
    double hardest = 0, top = 0;
    for (const double w : u) hardest = std::max(hardest, std::abs(w) / A);
    const double reach = std::max(1e-3, 0.5 * hardest * std::abs(slide));
    const ToolSpeed<Robot, 2> limit(model,
                                    JointLimits<3>({.lower = JointPosition<3>::constant(-10),
                                                    .upper = JointPosition<3>::constant(10),
                                                    .velocity = JointVelocity<3>::constant(3),
                                                    .acceleration = JointAcceleration<3>::constant(A),
                                                    .torque = JointTorque<3>::constant(10)}),
                                    {.speed = most, .reach = reach});
    const JointRoom<3> free{JointPosition<3>::constant(HUGE_VAL), JointPosition<3>::constant(HUGE_VAL)};
    if (!limit.keeps(q, u, {}, free)) continue;
    ++kept;
    const double first = speed(q, u);
    for (int step = 0; step <= 100; ++step) {
      const double t = hardest * step / 100, left = 1 - 0.01 * step;
      top = std::max(top, speed(integrate(q, u, t * (1 - 0.5 * t / hardest)), left * u));
    }
    worst = std::max(worst, top);
    grew += top > 1.2 * first;
  }
  CAPTURE(worst);
  CHECK(worst <= most * (1 + 1e-6));
  CHECK(kept > 500);
  CHECK(grew > 50);
}
