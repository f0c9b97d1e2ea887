#include "skinctl/limits/jerk_limits.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "skinctl/limits/detail/group_motion.hpp"
#include "skinctl/testing/allocation_guard.hpp"

using namespace skinctl;

namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr int share = 20;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr int share = 20;
#else
constexpr int share = 1;
#endif
#else
constexpr int share = 1;
#endif

template <class T>
JerkLimits<1, T> one_joint(double lower, double upper, double velocity, double acceleration, double jerk) {
  typename JointLimits<1, T>::Values v;
  v.lower[0] = T(lower);
  v.upper[0] = T(upper);
  v.velocity[0] = T(velocity);
  v.acceleration[0] = T(acceleration);
  v.torque[0] = T(1);
  return {JointLimits<1, T>(v), JointJerk<1, T>::constant(T(jerk))};
}

/// One joint that is asked for velocities, with the true position in double.
template <class T>
struct Joint {
  JerkLimits<1, T> limits;
  double q = 0;
  T u = 0, a = 0;
  Status status{};
  double moved = 0;

  void ask(T target, double h) {
    const double lower = double(limits.joints().lower()[0]), upper = double(limits.joints().upper()[0]);
    JointRoom<1, T> room;
    room.above[0] = T(upper - q);
    room.below[0] = T(q - lower);
    const auto m = limits.move(room, JointVelocity<1, T>::constant(u), JointAcceleration<1, T>::constant(a),
                               JointVelocity<1, T>::constant(target), T(h));
    moved = double(m.displacement[0]);
    q += moved;
    u = m.velocity[0];
    a = m.acceleration[0];
    status = m.status;
  }
};

}  // namespace

TEST_CASE("Stopping: the way to rest is what small steps of the same jerks give") {
  // Independent of the closed form: at every instant the jerk that the switching curve asks for.
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 200; ++k) {
    const double A = 0.5 + 4 * std::abs(unit(rng)), J = 2 + 40 * std::abs(unit(rng));
    const double u0 = 2 * unit(rng), a0 = 1.3 * A * unit(rng);
    double s = 0, u = u0, a = a0, above = 0, below = 0, t = 0;
    const double h = 1e-5;
    for (; t < 20 && (std::abs(u) > 2e-4 || std::abs(a) > 2 * J * h); t += h) {
      const double d = u + a * std::abs(a) / (2 * J);
      double j = d > 0 ? -J : J;
      if (a > A) j = -J;
      if (a < -A) j = J;
      if (std::abs(a) <= A && std::abs(a + j * h) > A) j = 0;
      s += h * (u + h * (a / 2 + h * j / 6));
      u += h * (a + h * j / 2);
      a += h * j;
      above = std::max(above, s);
      below = std::max(below, -s);
    }
    CAPTURE(u0);
    CAPTURE(a0);
    CAPTURE(A);
    CAPTURE(J);
    if (std::abs(a0) > A) continue;  // such a start brakes beyond A: below
    const detail::Stopping<double> stopping(u0, a0, A, J);
    const auto reach = stopping.reach();
    CHECK(reach.above == doctest::Approx(above).epsilon(2e-3).scale(0.1));
    CHECK(reach.below == doctest::Approx(below).epsilon(2e-3).scale(0.1));
    const auto rest = stopping.after(t + 1);
    CHECK(rest.s == doctest::Approx(s).epsilon(2e-3).scale(0.1));
    CHECK(rest.u == 0);
    CHECK(rest.a == 0);
  }
  // From rest of acceleration: u sqrt(u/J) while J alone decides, u^2/(2 A) + u A/(2 J) beyond.
  CHECK(detail::Stopping<double>(0.5, 0, 10, 8).reach().above == doctest::Approx(0.5 * std::sqrt(0.5 / 8)));
  CHECK(detail::Stopping<double>(2, 0, 1, 4).reach().above == doctest::Approx(2.0 + 0.25));
}

TEST_CASE("JerkLimits: refuse what cannot be a limit") {
  const auto refused = [](double jerk) {
    CHECK_THROWS_AS(one_joint<double>(-1, 1, 1, 10, jerk), ConfigurationError);
  };
  for (const double bad : {0.0, -1.0, 1e-3, 2e9, std::numeric_limits<double>::quiet_NaN()}) refused(bad);
  CHECK_NOTHROW(one_joint<double>(-1, 1, 1, 10, 0.01));
}

// The law that matters, for whatever is asked and however long the steps are: a million cycles each.
TEST_CASE_TEMPLATE("JerkLimits: no limit is ever crossed", T, float, double) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const double eps = std::numeric_limits<T>::epsilon();
  long at_end = 0, at_speed = 0, at_acceleration = 0, gave_way = 0, cycles = 0, turned = 0;
  double worst_jerk = 0, worst_end = 0, worst_mean = 0;
  const int scenes = 200 / share;
  for (int scene = 0; scene < scenes; ++scene) {
    const double V = std::pow(10, 0.7 * unit(rng)), A = V * std::pow(10, 1 + unit(rng));
    const double J = A * std::pow(10, 1 + unit(rng));
    // From a narrow slot to a wide range, one now and then without end.
    const double range = std::pow(10, 0.5 + 2.5 * unit(rng));
    const double lower = -range, upper = scene % 10 == 9 ? std::numeric_limits<double>::infinity() : range;
    Joint<T> joint{one_joint<T>(lower, upper, V, A, J)};
    const T v = T(V), a_max = T(A);
    const double low = double(joint.limits.joints().lower()[0]),
                 up = double(joint.limits.joints().upper()[0]);
    double drive = 0;
    for (int k = 0; k < 5000; ++k, ++cycles) {
      const double h = scene % 4 == 0 ? 0.002 : std::pow(10, -2.3 + 0.7 * unit(rng) + (k % 97 == 0 ? 2 : 0));
      if (k % 83 == 0) drive = unit(rng) > 0 ? 1e9 : -1e9;
      T target = T(drive);  // bang-bang, random, what a program sends that has gone wrong
      if (scene % 3 == 1) target = T(3 * V * unit(rng));
      if (scene % 3 == 2 && k % 7 == 0) target = std::numeric_limits<T>::quiet_NaN();
      const Joint<T> was = joint;
      joint.ask(target, h);
      CAPTURE(scene);
      CAPTURE(k);
      CAPTURE(h);
      const double rounding = 64 * eps * (range < 1e6 ? 2 * range : 1) + 600 * eps * (V * V / A + V * A / J);
      worst_end = std::max({worst_end, (joint.q - up) / rounding, (low - joint.q) / rounding});
      REQUIRE(joint.q <= up + rounding);
      REQUIRE(joint.q >= low - rounding);
      REQUIRE(std::abs(joint.u) <= v * T(1 + 300 * eps));
      REQUIRE(std::abs(joint.a) <= a_max * T(1 + 4 * eps));
      worst_mean = std::max(worst_mean, std::abs(joint.moved) / (V * h));
      REQUIRE(std::abs(joint.moved) <= V * h * (1 + 300 * eps));
      // The acceleration that others see: of the velocities, and of the end of the step.
      REQUIRE(std::abs(double(joint.u) - double(was.u)) <= A * h * (1 + 64 * eps) + 8 * eps * V);
      const double change = std::abs(double(joint.a) - double(was.a));
      worst_jerk = std::max(worst_jerk, (change - J * h) / (eps * A));
      if (joint.status.has(Reason::jerk_exceeded)) ++gave_way;
      REQUIRE(change <= J * h * (1 + 64 * eps) + 3000 * eps * A);
      // Some motion within the limits leads there: |s - (u0 h + a0 h^2/2)| <= J h^3/6.
      REQUIRE(std::abs(joint.moved - h * (double(was.u) + h * double(was.a) / 2)) <=
              J * h * h * h / 6 * (1 + 64 * eps) + 3000 * eps * (V * h + A * h * h));
      // Where nothing intervened the jerk is constant: the joint does not turn beyond an end within the step,
      // either.
      const double u0 = double(was.u), a0 = double(was.a), j = (double(joint.a) - a0) / h;
      const double discriminant = a0 * a0 - 2 * j * u0;
      if (!joint.status.has(Reason::position_limited) && !joint.status.has(Reason::velocity_limited) &&
          !joint.status.has(Reason::jerk_exceeded) && discriminant > 0 && j != 0)
        for (const double root : {std::sqrt(discriminant), -std::sqrt(discriminant)}) {
          const double t = (root - a0) / j;
          if (!(t > 0 && t < h)) continue;
          const double turn = was.q + t * (u0 + t * (a0 / 2 + t * j / 6));
          turned += turn > up - 1e-3 * range || turn < low + 1e-3 * range;
          REQUIRE(turn <= up + rounding);
          REQUIRE(turn >= low - rounding);
        }
      at_end += joint.q > up - 1e-3 * range || joint.q < low + 1e-3 * range;
      at_speed += std::abs(joint.u) > T(0.999) * v;
      at_acceleration += std::abs(joint.a) > T(0.99) * a_max;
    }
  }
  MESSAGE(cycles << " cycles, at an end " << at_end << ", at top speed " << at_speed
                 << ", at top acceleration " << at_acceleration << ", jerk gave way " << gave_way
                 << ", mean speed of a step at most " << worst_mean << " of the limit, excess of jerk "
                 << worst_jerk << " eps A, beyond an end " << worst_end);
  CHECK(turned > 20 / share);
  CHECK(at_end > 10000 / share);  // the limits were used, not shunned
  CHECK(at_speed > 10000 / share);
  CHECK(at_acceleration > 1000 / share);
}

TEST_CASE_TEMPLATE("JerkLimits: a target that moves smoothly is followed to the bit of rounding", T, float,
                   double) {
  Joint<T> joint{one_joint<T>(-100, 100, 2, 20, 400)};
  double worst = 0;
  for (int k = 1; k <= 2000; ++k) {
    const double t = 0.002 * k, wish = 0.5 * (1 - std::cos(3 * t));
    joint.ask(T(wish), 0.002);
    if (k > 20) worst = std::max(worst, std::abs(double(joint.u) - wish));
    CHECK_FALSE(joint.status.any());
  }
  CHECK(worst < 2e-5);  // a ramp is met exactly, a bend half a step late
}

TEST_CASE_TEMPLATE("JerkLimits: who starts beyond a limit comes back in, in the documented order", T, float,
                   double) {
  SUBCASE("beyond an end, at rest: only inward") {
    Joint<T> joint{one_joint<T>(-1, 1, 2, 10, 200), 1.2};
    for (int k = 0; k < 100; ++k) joint.ask(T(1), 0.008);
    CHECK(joint.q == 1.2);
    CHECK_FALSE(joint.status.has(Reason::jerk_exceeded));
    for (int k = 0; k < 1000; ++k) joint.ask(T(-1), 0.001);
    CHECK(joint.q < 1);
  }
  SUBCASE("beyond an end and outward: as hard as the acceleration limit, no harder") {
    Joint<T> joint{one_joint<T>(-1, 1, 2, 10, 200), 1.2, T(1)};
    joint.ask(T(1), 0.01);
    CHECK(double(joint.u) == doctest::Approx(0.9));
    CHECK(joint.status.has(Reason::jerk_exceeded));
    for (int k = 0; k < 20; ++k) joint.ask(T(1), 0.01);
    CHECK(joint.u == T(0));
    CHECK(joint.q == doctest::Approx(1.2 + 0.05).epsilon(1e-3));
  }
  SUBCASE("too fast to stop smoothly, not too fast to stop: the jerk gives way, the end is kept") {
    Joint<T> joint{one_joint<T>(-1, 1, 2, 10, 50), 0.94, T(1)};  // needs 0.05 hard, 0.15 smoothly
    bool gave_way = false;
    for (int k = 0; k < 400; ++k) {
      const T before = joint.u;
      joint.ask(T(1), 0.001);
      gave_way |= joint.status.has(Reason::jerk_exceeded);
      CHECK(double(before - joint.u) <= 0.01 * 1.001);
      REQUIRE(joint.q <= 1 + 1e-6);
    }
    CHECK(gave_way);
  }
  SUBCASE("too fast: brakes below the velocity limit") {
    Joint<T> joint{one_joint<T>(-100, 100, 2, 10, 200), 0, T(5)};
    for (int k = 0; k < 500; ++k) joint.ask(T(5), 0.002);
    CHECK(double(joint.u) <= 2 * (1 + 1e-6));
    CHECK(double(joint.u) > 1.99);
  }
  SUBCASE("an acceleration beyond its limit is cut at once") {
    Joint<T> joint{one_joint<T>(-100, 100, 2, 10, 200), 0, T(0), T(50)};
    joint.ask(T(2), 0.002);
    CHECK(double(joint.u) <= 10 * 0.002 * 1.0001);
  }
}

TEST_CASE_TEMPLATE("JerkLimits: extremes of limits and steps", T, float, double) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double V : {1e-8, 1.0, 1e3})
    for (const double A : {1e-6, 1.0, 1e5})
      for (const double ratio : {1e-3, 1.0, 1e4})
        for (const double range : {1e-8, 1.0, 1e6}) {
          if (A * ratio > 1e9) continue;
          Joint<T> joint{one_joint<T>(-range, range, V, A, A * ratio)};
          CAPTURE(V);
          CAPTURE(A);
          CAPTURE(ratio);
          CAPTURE(range);
          const double eps = std::numeric_limits<T>::epsilon();
          for (int k = 0; k < 200 / (share > 1 ? 4 : 1); ++k) {
            joint.ask(T((unit(rng) > 0 ? 2 : -2) * V), k % 50 == 49 ? 1e6 : 0.002 * (1.5 + unit(rng)));
            REQUIRE(std::abs(joint.q) <= range * (1 + 1000 * eps));
            REQUIRE(std::abs(double(joint.u)) <= V * (1 + 300 * eps));
            REQUIRE(std::abs(double(joint.a)) <= A * (1 + 4 * eps));
          }
        }
}

TEST_CASE("JerkLimits: braking ends at rest, the quickest way, and does not overshoot") {
  JointLimits<1>::Values v;
  v.lower[0] = -100, v.upper[0] = 100, v.velocity[0] = 2, v.acceleration[0] = 10, v.torque[0] = 1;
  const JointLimits<1> joints(v);
  const JerkLimits<1> limits(joints, JointJerk<1>::constant(50));
  // From 2 rad/s: 0.2 s to -10 rad/s^2 and 0.2 s back, which is just all of it. So is 0.4 s.
  for (const double h : {0.004, 0.0073, 0.05}) {
    JointPosition<1> q;
    auto u = JointVelocity<1>::constant(2);
    JointAcceleration<1> a;
    double t = 0;
    while (u[0] != 0 && t < 1) {
      const auto motion = limits.brake(joints.room(q), u, a, h);
      CHECK(motion.velocity[0] >= -1e-12);
      CHECK(std::abs(motion.acceleration[0] - a[0]) <= 50 * h * (1 + 1e-9));
      CHECK_FALSE(motion.status.any());
      u = motion.velocity, a = motion.acceleration;
      q += motion.displacement;
      t += h;
    }
    CHECK(a[0] == 0);
    CHECK(t <= 0.4 + h + 1e-9);
    CHECK(q[0] == doctest::Approx(0.4));  // half of 2 rad/s in 0.4 s
  }
}

// Going on with this step's jerk would pass the end, in many steps from now; a stop that begins later does
// not.
TEST_CASE("JerkLimits: a joint near its end that can still stop does as it is asked") {
  for (const double side : {1.0, -1.0}) {
    CAPTURE(side);
    Joint<double> joint{one_joint<double>(side > 0 ? -1 : -0.03, side > 0 ? 0.03 : 1, 2, 10, 1000)};
    Joint<double> free{one_joint<double>(-100, 100, 2, 10, 1000)};
    for (Joint<double>* j : {&joint, &free}) {
      j->u = side * 0.5;  // 15 mrad from rest by the quickest stop
      j->ask(side * 0.49, 0.01);
    }
    CHECK(joint.u == free.u);
    CHECK(joint.a == free.a);
    CHECK(joint.q == free.q);
    CHECK_FALSE(joint.status.any());
  }
}

TEST_CASE("JerkLimits: a motion allocates nothing") {
  Joint<double> joint{one_joint<double>(-1, 1, 1, 10, 100)};
  const testing::AllocationGuard guard;
  for (int k = 0; k < 1000; ++k) joint.ask(k % 200 < 100 ? 1 : -1, 0.002);
  CHECK(guard.count() == 0);
}

TEST_CASE("GroupMotion: a motion that another limit slows comes to rest no further than the wished one") {
  // The resolver's bounds of the rest point, an end by velocity or the leash, hold beside other limits.
  std::mt19937 rng(11);
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  double furthest = 0, furthest_alone = 0;
  for (int k = 0; k < 1000 / share; ++k) {
    const double A = roll(3, 40), J = std::max(20 * std::pow(5000.0, roll(0, 1)), A),
                 h = 5e-4 * std::pow(40.0, roll(0, 1));
    const auto limits = one_joint<double>(-1e3, 1e3, 3, A, J);
    const detail::GroupMotion<1, double, JerkLimits<1>> group(limits.joints(), limits);
    JointCommand<1> last;
    for (int cycle = 0; cycle < 200; ++cycle) {
      JointCommand<1> wish = last;  // of four sub-steps
      const auto target = JointVelocity<1>::constant(roll(-2, 2));
      for (int part = 0; part < 4; ++part) {
        const auto room = limits.joints().room(wish.position);
        const auto m = cycle / 40 % 2 == 0
                           ? limits.move(room, wish.velocity, wish.acceleration, target, h / 4)
                           : limits.brake(room, wish.velocity, wish.acceleration, h / 4);
        wish.position += m.displacement, wish.velocity = m.velocity, wish.acceleration = m.acceleration;
      }
      const auto room = limits.joints().room(last.position);
      const auto slower = roll(0.7, 1) * wish.velocity;
      const auto kept = group.smoothed(last, wish, slower, h);
      const auto alone = limits.move(room, last.velocity, last.acceleration, slower, h);
      const auto stop = limits.brake(room, last.velocity, last.acceleration, h);
      const double side = wish.velocity[0] < 0 ? -1 : 1;
      const auto rest = [&](const auto& m) {
        return side * limits.rest_of(last.velocity, m.velocity, m.acceleration, h)[0];
      };
      const double allowed = std::max(rest(wish), rest(stop));
      furthest = std::max(furthest, rest(kept) - allowed);
      furthest_alone = std::max(furthest_alone, rest(alone) - allowed);
      last.position += kept.displacement, last.velocity = kept.velocity,
                                          last.acceleration = kept.acceleration;
    }
  }
  CHECK(furthest < 1e-3);
  CHECK(furthest_alone > 0.01);  // so the test can fail
  MESSAGE("beyond by ", furthest, " rad, towards the slower velocity alone by ", furthest_alone);
}
