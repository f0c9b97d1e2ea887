#include "skinctl/robot/joint_limits.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>
#include <string>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/digits50.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;
namespace {

template <class T>
JointLimits<1, T> one_joint(T lower, T upper, T velocity, T acceleration) {
  typename JointLimits<1, T>::Values v;
  v.lower[0] = lower;
  v.upper[0] = upper;
  v.velocity[0] = velocity;
  v.acceleration[0] = acceleration;
  v.torque[0] = T(1);
  return JointLimits<1, T>(v);
}
template <class T>
JointVelocity<1, T> speed(T u) {
  return JointVelocity<1, T>::constant(u);
}

std::string refusal(const JointLimits<2>::Values& v) {
  return skinctl::testing::complaint_of([&] { JointLimits<2>{v}; });
}

}  // namespace

TEST_CASE("JointLimits: refuse what cannot be a limit, with the number and the range") {
  JointLimits<2>::Values good;
  good.lower = {-1, -2};
  good.upper = {1, 2};
  good.velocity = {1, 1};
  good.acceleration = {1, 1};
  good.torque = {1, 1};
  CHECK(refusal(good).empty());
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, inf}) {
    auto v = good;
    v.velocity[1] = bad;
    CHECK(refusal(v).find("velocity limit") != std::string::npos);
    v = good;
    v.acceleration[0] = bad;
    CHECK(refusal(v).find("acceleration limit") != std::string::npos);
    v = good;
    v.torque[0] = bad;
    CHECK(refusal(v).find("torque limit") != std::string::npos);
  }
  for (const double bad : {1.0, 7.5, nan}) {
    auto v = good;
    v.lower[0] = bad;
    CHECK(refusal(v).find("lower position limit") != std::string::npos);
  }
  auto v = good;
  v.velocity[0] = -7.5;
  CHECK(refusal(v) == "skinctl: velocity limit of joint 0 = -7.5, allowed: > 0, <= 1e3 rad/s");
  v = good;
  v.lower = {-inf, -inf};
  v.upper = {inf, inf};
  CHECK(refusal(v).empty());
}

TEST_CASE_TEMPLATE("limits_of: the maker's numbers of a UR5", T, float, double) {
  const auto limits = limits_of<ur5::Description, T>(T(25));
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(limits.lower()[i] == T(ur5::Description::lower[i]));
    CHECK(limits.upper()[i] == T(ur5::Description::upper[i]));
    CHECK(limits.velocity()[i] == T(ur5::Description::max_velocity));
    CHECK(limits.acceleration()[i] == T(25));
    CHECK(limits.torque()[i] == T(ur5::Description::max_torque[i]));
  }
}

TEST_CASE_TEMPLATE("speed_to_stop: reacts and brakes within exactly the distance", T, float, double) {
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> exponent(-12, 6);
  for (int k = 0; k < 20000; ++k) {
    const T d = T(std::pow(10, exponent(rng))), t = k % 3 == 0 ? T(0) : T(std::pow(10, exponent(rng))),
            a = T(std::pow(10, exponent(rng)));
    const T u = speed_to_stop(d, t, a);
    const Digits50 used = Digits50(u) * Digits50(u) / (2 * Digits50(a)) + Digits50(u) * Digits50(t);
    CAPTURE(d);
    CAPTURE(t);
    CAPTURE(a);
    CHECK(static_cast<double>(abs(used - Digits50(d)) / Digits50(d)) <
          8 * double(std::numeric_limits<T>::epsilon()));
  }
  CHECK(speed_to_stop(T(0), T(1), T(1)) == T(0));
  CHECK(speed_to_stop(T(-1), T(1), T(1)) == T(0));
  CHECK(speed_to_stop(std::numeric_limits<T>::quiet_NaN(), T(1), T(1)) == T(0));
}

// The law that matters: whatever is asked for, and however long the steps are.
TEST_CASE_TEMPLATE("JointLimits: no limit is ever crossed, by whatever targets and steps", T, float, double) {
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  int at_upper = 0, at_speed = 0;
  for (int scene = 0; scene < (skinctl::testing::sanitized ? 40 : 200); ++scene) {
    const T a = T(std::pow(10, 1.5 + unit(rng))), vm = T(std::pow(10, unit(rng)));
    const T upper = T(0.5 + std::abs(unit(rng)) * 6), lower = T(-0.1 + 0.5 * unit(rng));
    if (!(lower < upper)) continue;
    const auto limits = one_joint(lower, upper, vm, a);
    T q = (lower + upper) / 2, u = 0;
    double bias = unit(rng);
    for (int k = 0; k < 5000; ++k) {
      if (k % 700 == 0) bias = unit(rng) > 0 ? 1e3 : -1e3;  // run into an end
      const T h = T(std::pow(10, -2 + 1.5 * unit(rng)));
      const T target = k % 3 == 0 ? T(bias) : T(3 * vm * unit(rng) + bias);
      const JointPosition<1, T> here = JointPosition<1, T>::constant(q);
      const auto motion = limits.move(limits.room(here), speed(u), speed(target), h);
      const T next = motion.velocity[0], moved = motion.displacement[0];
      const double eps = std::numeric_limits<T>::epsilon();
      REQUIRE(std::abs(double(next)) <= double(vm) * (1 + eps));
      REQUIRE(std::abs(double(next) - double(u)) <= double(a) * double(h) + 4 * eps * double(vm));
      // Some motion with that acceleration does it: the displacement is reachable.
      const double du = double(next) - double(u);
      const double aside = 0.25 * (double(a) * h * h - du * du / double(a));
      REQUIRE(std::abs(double(moved) - 0.5 * h * (double(u) + double(next))) <=
              std::max(aside, 0.0) + 16 * eps * (double(vm) * h + 1));
      const T before = q;
      q = q + moved;
      u = next;
      REQUIRE(q <= upper + std::numeric_limits<T>::epsilon() * upper);
      REQUIRE(q >= lower - std::numeric_limits<T>::epsilon() * (std::abs(lower) + std::abs(before)));
      at_upper += q > upper - T(1e-3) ? 1 : 0;
      at_speed += std::abs(u) > T(0.999) * vm ? 1 : 0;
    }
  }
  CHECK(at_upper > 1000);  // the ends were used, not shunned
  CHECK(at_speed > 1000);
}

TEST_CASE_TEMPLATE("JointLimits: what is free is left alone", T, float, double) {
  const auto limits = one_joint(T(-3), T(3), T(2), T(40));
  const auto room = limits.room(JointPosition<1, T>::constant(T(0.3)));
  const auto motion = limits.move(room, speed(T(1)), speed(T(1.05)), T(0.002));
  CHECK(motion.velocity[0] == T(1.05));
  CHECK(double(motion.displacement[0]) == doctest::Approx(0.00205).epsilon(1e-6));
  CHECK_FALSE(motion.status.any());
  CHECK(motion.braked == 0);
}

TEST_CASE_TEMPLATE("JointLimits: say which limit acted", T, float, double) {
  const auto limits = one_joint(T(-3), T(3), T(2), T(40));
  const auto at = [&](T q) { return limits.room(JointPosition<1, T>::constant(q)); };
  CHECK(limits.move(at(T(0)), speed(T(0)), speed(T(1)), T(0.002)).status ==
        Status(Reason::acceleration_limited));
  CHECK(limits.move(at(T(0)), speed(T(2)), speed(T(3)), T(0.002)).status == Status(Reason::velocity_limited));
  const auto end = limits.move(at(T(2.9999)), speed(T(0.05)), speed(T(0.08)), T(0.002));
  CHECK(end.status == Status(Reason::position_limited));
  CHECK(end.braked == 1);
}

TEST_CASE_TEMPLATE("JointLimits: beyond an end only inward motion is given", T, float, double) {
  const auto limits = one_joint(T(-3), T(3), T(2), T(40));
  const auto room = limits.room(JointPosition<1, T>::constant(T(3.2)));
  T u = 0;
  auto motion = limits.move(room, speed(u), speed(T(1)), T(0.01));
  CHECK(motion.velocity[0] == T(0));
  CHECK(motion.displacement[0] == T(0));
  motion = limits.move(room, speed(u), speed(T(-1)), T(0.01));
  CHECK(double(motion.velocity[0]) == doctest::Approx(-0.4));
  CHECK(motion.displacement[0] < T(0));
  // Who starts there outward brakes as hard as allowed, and no harder.
  motion = limits.move(room, speed(T(1)), speed(T(1)), T(0.01));
  CHECK(double(motion.velocity[0]) == doctest::Approx(0.6));
}

TEST_CASE_TEMPLATE("JointLimits: who starts where not all can be kept comes back, in the documented order", T,
                   float, double) {
  const T h = T(0.004);
  const auto limits = one_joint(T(-3), T(3), T(2), T(40));
  for (const double start : {2.5, 2.99, 3.2})
    for (const double fast : {-6.0, 1.5, 6.0}) {
      CAPTURE(start);
      CAPTURE(fast);
      T q = T(start), u = T(fast);
      double farthest = start;
      bool within = false;
      for (int k = 0; k < 1000; ++k) {
        const auto motion =
            limits.move(limits.room(JointPosition<1, T>::constant(q)), speed(u), speed(T(2)), h);
        // 1. acceleration never;
        CHECK(std::abs(motion.velocity[0] - u) <= T(40) * h * T(1.0001));
        // 2. an end no further than the whole deceleration needs;
        q += motion.displacement[0];
        // 3. velocity: as soon as it can, and never again;
        const bool slow = std::abs(motion.velocity[0]) <= T(2) * T(1.0001);
        CHECK((slow || !within));
        if (!slow) CHECK(std::abs(motion.velocity[0]) <= std::abs(u) - T(40) * h * T(0.999));
        within = within || slow;
        u = motion.velocity[0];
        farthest = std::max(farthest, double(q));
      }
      const double stop = start + (fast > 0 ? fast * fast / 80 : 0);
      CHECK(farthest <= std::max(3.0, stop) * (1 + 1e-5));
      CHECK(within);
      // Beyond an end it stays where it stands as long as the target leads outward; inside it reaches the
      // end.
      CHECK(double(q) <= std::max(3.0, farthest) * (1 + 1e-6));
      const auto inward =
          limits.move(limits.room(JointPosition<1, T>::constant(q)), speed(u), speed(T(-1)), h);
      CHECK(inward.velocity[0] < T(0));
    }
}

TEST_CASE_TEMPLATE("JointLimits: a target that is NaN counts as zero", T, float, double) {
  const auto limits = one_joint(T(-3), T(3), T(2), T(40));
  const auto room = limits.room(JointPosition<1, T>::constant(T(0)));
  const auto motion = limits.move(room, speed(T(1)), speed(std::numeric_limits<T>::quiet_NaN()), T(0.01));
  CHECK(double(motion.velocity[0]) == doctest::Approx(0.6));
}

TEST_CASE("JointLimits: a motion allocates nothing") {
  const auto limits = limits_of<ur5::Description>(40.0);
  JointVelocity<6> u;
  testing::AllocationGuard guard;
  for (int k = 0; k < 1000; ++k)
    u = limits.move(limits.room(JointPosition<6>{}), u, JointVelocity<6>::constant(1.0), 0.002).velocity;
  const auto count = guard.count();
  CHECK(count == 0);
}

TEST_CASE_TEMPLATE("JointLimits: a speed that decays ends at zero, not at denormal numbers", T, float,
                   double) {
  const auto limits = one_joint<T>(T(-1), T(1), T(1), T(10));
  const auto room = limits.room(JointPosition<1, T>::constant(T(0)));
  for (const T sign : {T(1), T(-1)}) {
    T u = sign * T(0.01);
    int steps = 0;
    for (; u != T(0) && steps < 2000; ++steps) {
      CHECK(u * u >= std::numeric_limits<T>::min());
      u = limits.move(room, speed(u), speed(T(u / 2)), T(0.002)).velocity[0];
    }
    CHECK(steps > 40);
    CHECK(u == T(0));
  }
  const T slow = sizeof(T) == 4 ? T(1e-15) : T(1e-140);  // as slow as one can tell: it moves
  CHECK(limits.move(room, speed(slow), speed(slow), T(0.002)).velocity[0] == slow);
}

TEST_CASE_TEMPLATE("JointLimits: torques are cut to their limit, and to the power where they drive", T, float,
                   double) {
  typename JointLimits<2, T>::Values v;
  v.lower = {T(-1), T(-1)};
  v.upper = {T(1), T(1)};
  v.velocity = {T(3), T(3)};
  v.acceleration = {T(9), T(9)};
  v.torque = {T(20), T(20)};
  const JointTorque<2, T> tau{T(30), T(-15)};
  const JointVelocity<2, T> dq{T(2), T(-2)};
  CHECK(JointLimits<2, T>(v).within(tau, dq) == JointTorque<2, T>{T(20), T(-15)});
  v.power = {T(10), T(50)};
  const JointLimits<2, T> limits(v);
  CHECK(limits.within(tau, dq) == JointTorque<2, T>{T(5), T(-15)});
  CHECK(limits.within(tau, T(-1) * dq) == JointTorque<2, T>{T(20), T(-15)});  // braking is free
  CHECK(limits.within(tau, JointVelocity<2, T>{}) == JointTorque<2, T>{T(20), T(-15)});
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int k = 0; k < 10000; ++k) {
    const JointTorque<2, T> t{T(1e6 * unit(rng)), T(40 * unit(rng))};
    const JointVelocity<2, T> w{T(k % 2 ? 1e-8 * unit(rng) : 1e6 * unit(rng)), T(3 * unit(rng))};
    const auto out = limits.within(t, w);
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(std::abs(out[i]) <= T(20));
      CHECK(out[i] * w[i] <= v.power[i] * (1 + 4 * std::numeric_limits<T>::epsilon()));
      CHECK(out[i] * t[i] >= T(0));
    }
  }
  v.power[1] = T(0);
  CHECK_THROWS_AS((JointLimits<2, T>(v)), ConfigurationError);
}

TEST_CASE_TEMPLATE("JointLimits: torques beyond them keep their direction", T, float, double) {
  auto v = limits_of<ur5::Description, T>(T(15)).values();
  const T eps = std::numeric_limits<T>::epsilon();
  std::mt19937_64 rng(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto some = [&](double size) {
    JointTorque<6, T> tau;
    for (std::size_t i = 0; i < 6; ++i) tau[i] = T(size * unit(rng)) * v.torque[i];
    return tau;
  };
  for (int k = 0; k < 4000; ++k) {
    if (k == 2000) v.power = JointPower<6, T>::constant(T(60));
    const JointLimits<6, T> limits(v);
    const double size = std::pow(10.0, 6 * unit(rng));
    const JointTorque<6, T> tau = some(size), hold = some(0.9);
    JointVelocity<6, T> dq;
    for (T& x : dq) x = T(unit(rng));
    if (k >= 2000) dq = T(0.3) * dq;  // so that `hold` is within the power
    const auto out = limits.along(tau, hold, dq);
    CHECK(limits.within(out, dq) == out);
    if (limits.within(tau, dq) == tau) continue;
    if (!(limits.within(hold, dq) == hold)) continue;
    T share(0), scale(0);
    for (std::size_t i = 0; i < 6; ++i) {
      const T drive = tau[i] - hold[i];
      if (std::abs(drive) > scale) scale = std::abs(drive), share = (out[i] - hold[i]) / drive;
    }
    CHECK(share >= T(0));
    CHECK(share <= T(1) + 8 * eps);
    bool full = false;
    for (std::size_t i = 0; i < 6; ++i) {
      const T drive = tau[i] - hold[i];
      CHECK(std::abs(out[i] - hold[i] - share * drive) <= 64 * eps * v.torque[i]);
      full = full ||
             !(limits.within(hold + T(1 + 1e-4) * (out - hold), dq) == hold + T(1 + 1e-4) * (out - hold));
    }
    CHECK(full);  // no more would do
  }
  const JointLimits<6, T> limits(v);
  const JointVelocity<6, T> still{};
  // What weight overloads already is cut off by itself, and the others are not held back.
  const JointTorque<6, T> heavy{T(0), T(400), T(0), T(0), T(0), T(0)},
      tau{T(75), T(500), T(0), T(0), T(0), T(0)};
  CHECK(limits.along(tau, heavy, still) == JointTorque<6, T>{T(75), T(150), T(0), T(0), T(0), T(0)});
  const T nan = std::numeric_limits<T>::quiet_NaN(), most = std::numeric_limits<T>::max();
  for (const T& x : {nan, most, T(-most)}) {
    auto odd = heavy;
    odd[3] = x;
    const auto out = limits.along(tau, odd, still);
    for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(out[i]) <= v.torque[i]);
  }
}
