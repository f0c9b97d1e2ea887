#include <doctest/doctest.h>

#include <type_traits>

#include "bench/studies/worlds/touches.hpp"
#include "skinctl/skinctl.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/largest.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
template <class L, class T = double>
using KnownTo = Quantities<Arm, L::needs, T, Skinned<T>>;
const Arm model;

/// A law that gives known torques for its feedback and its feed-forward, and for gravity if it may.
struct Told : Composable {
  struct Memory {
    int held = 0, released = 0;
  };
  Told(double feedback_torque, double feed_forward_torque)
      : feedback(feedback_torque), feed_forward(feed_forward_torque) {}
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::tracking;
  double feedback, feed_forward;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <GravityTerm G = GravityTerm::included, class K>
  JointTorque<6> torque(const Memory&, const K& known, const LawShare<double>& share = {}) const noexcept {
    auto tau = JointTorque<6>::constant(share.feedback * feedback + share.feed_forward * feed_forward);
    if (G == GravityTerm::included) tau += share.feed_forward * gravity_torque(known.model(), known.q());
    return tau;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition o) const noexcept {
    return {m.held + (o == Opposition::lasting), m.released + (o == Opposition::released)};
  }
};

const State<6> pose{0ns, JointPosition<6>{0.3, -1.2, 1.0, 0.1, 0.4, 0.2}, {}};

template <class L>
auto evaluated(const L& law, const Skinned<double>& touch = {}) {
  const KnownTo<L> known(model, pose, 0.0, touch);
  return evaluate(law, law.start(known), known, 0.002);
}

}  // namespace

// Joint limits answer no touch: tracking that works against them is not held.
static_assert(!decltype(SplineJoint<6>() + JointLimitLaw<6>() + GravityControl())::watches);
static_assert(decltype(SplineJoint<6>() + JointLimitLaw<6>() + SkinJointControl())::watches);

namespace {
/// The same as `Told`, as a user writes it: two parts, and no word about gravity.
struct InParts : StatelessLaw<InParts> {
  static constexpr LawRole role = LawRole::tracking;
  double feedback = 0, feed_forward = 0;
  TorqueParts<6> parts(const auto&) const noexcept {
    return {JointTorque<6>::constant(feedback), JointTorque<6>::constant(feed_forward)};
  }
};
template <class A, class B>
void check_alike(const A& told, const B& in_parts) {
  const auto a = evaluated(told);
  const auto b = evaluated(in_parts);
  for (std::size_t i = 0; i < A::terms; ++i) CHECK(largest(a.shares[i] - b.shares[i]) < 1e-9);
  CHECK(largest(a.torque - b.torque) < 1e-9);
}
}  // namespace

TEST_CASE("Fused: a tracking law of two parts is weighed as one of one function, gravity once") {
  const InParts one{{}, 3, 5}, other{{}, -2, 4};
  const Told told_one(3, 5), told_other(-2, 4);
  check_alike(0.7 * told_one + 0.2 * told_other, 0.7 * one + 0.2 * other);
  check_alike(0.7 * told_one + 0.2 * told_other + GravityControl(),
              0.7 * one + 0.2 * other + GravityControl());
  check_alike(weighted(0.7 * told_one + 0.2 * told_other), weighted(0.7 * one + 0.2 * other));
  check_alike(plain(0.7 * told_one + 0.2 * told_other + GravityControl()),
              plain(0.7 * one + 0.2 * other + GravityControl()));
  check_alike(0.7 * told_one + SkinJointControl(), 0.7 * one + SkinJointControl());
}

TEST_CASE("Fused: settled when all of its laws are") {
  const SplineJoint<6> reach({.dt = 2ms});
  const auto law = reach + GravityControl();
  const KnownTo<decltype(law)> known(model, pose, 0.002, Skinned<double>{});
  auto memory = law.start(known);
  CHECK(settled(law, memory, known, 0.01));
  memory = law.receive(memory, known, JointGoal<6>{JointPosition<6>{}, 5s}).memory;
  for (int k = 0; k < 100; ++k) memory = law.advance(memory, known, 0.002, Opposition::none);
  CHECK_FALSE(settled(law, memory, known, 0.01));
  CHECK_FALSE(settled(reach, law.memory<0>(memory), known, 0.01));
}

TEST_CASE("Fused: is a law, and its memory can be copied byte by byte") {
  const SplineJoint<6> reach({.dt = 2ms});
  const SkinJointControl skin;
  const GravityControl gravity;
  const auto law = 0.6 * skin + 0.4 * reach + gravity;
  using L = std::remove_const_t<decltype(law)>;
  static_assert(Law<L, KnownTo<L>>);
  static_assert(std::is_trivially_copyable_v<L::Memory>);
  static_assert(terms_of<L> == 3 && L::role == LawRole::tracking);
  static_assert(std::is_same_v<L::Goal, JointGoal<6>>);
  static_assert(L::needs == (Needs{.angles = true, .touch = true, .middle = true}));
  // Nothing is asked for that no law reads.
  static_assert(decltype(0.4 * reach + gravity)::needs == Needs{.middle = true});
  static_assert(decltype(1.0 * skin + gravity)::role == LawRole::reactive);
  CHECK(sizeof(L::Memory) <= sizeof(SplineJoint<6>::Memory) + 2 * sizeof(Nanoseconds));
}

TEST_CASE("Fused: weighs as its policy says, and its shares add up") {
  const Told a{2, 30}, b{4, 50};
  const GravityControl gravity;
  const auto G = gravity_torque(model, pose.q);
  const auto expect = [&](const auto& law, double without_gravity, const JointTorque<6>& held) {
    const auto e = evaluated(law);
    CHECK(largest(e.torque - (JointTorque<6>::constant(without_gravity) + held)) < 1e-12 * 100);
    JointTorque<6> sum;
    for (const auto& share : e.shares) sum += share;
    CHECK(largest(sum - e.torque) < 1e-12);
  };
  const auto sum = 0.5 * a + 1.5 * b + gravity;
  expect(sum, 0.25 * 32 + 0.75 * 54, G);
  expect(weighted(sum), 0.5 * 2 + 1.5 * 4 + 0.25 * 30 + 0.75 * 50, G);
  expect(plain(sum), 0.5 * 32 + 1.5 * 54, G);
  // without a gravity law the convex mean holds it, once
  expect(0.5 * a + 1.5 * b, 0.25 * 32 + 0.75 * 54, G);
  expect(weighted(0.5 * a + 1.5 * b), 0.5 * 2 + 1.5 * 4 + 0.25 * 30 + 0.75 * 50, G);
}

TEST_CASE("Fused: the skin keeps its own weight, whatever the tracking laws are") {
  const Told a{2, 30};
  const auto touch = touch_of(3, -4, 5);
  const JointAngles<Arm, double> angles(model, pose.q);
  const auto tau_skin = skin_torque(model, angles, touch);
  CHECK(largest(tau_skin) > 0.5);
  const SkinJointControl skin;
  const GravityControl gravity;
  const auto e = evaluated(0.6 * skin + 0.4 * a + gravity, touch);
  CHECK(largest(e.shares[0] - 0.6 * tau_skin) < 1e-14);
  CHECK(largest(e.shares[1] - JointTorque<6>::constant(32)) < 1e-12);
  CHECK(largest(evaluated(plain(0.6 * skin + 0.4 * a + gravity), touch).shares[0] - 0.6 * tau_skin) < 1e-14);
}

TEST_CASE_TEMPLATE("Fused: gravity is held exactly once, with and without a gravity law", T,
                   SKINCTL_SCALARS) {
  const SplineJoint<6, T> reach({.dt = 2ms});
  const JointControl<6, T> follow({.dt = 2ms});
  const GravityControl gravity;
  const SkinJointControl skin;
  Seeded rng(100);
  const Skinned<T> untouched;
  for (int k = 0; k < 20; ++k) {
    const State<6, T> x{0ns, rng.vector<JointPosition<6, T>>(3), {}};
    const auto G = gravity_torque(model, x.q);
    const auto check = [&](const auto& law) {
      const KnownTo<std::remove_cvref_t<decltype(law)>, T> known(model, x, T(0.002), untouched);
      const auto memory = law.start(known);
      CHECK(largest(law.torque(memory, known) - G) <= T(100) * epsilon<T>() * largest(G));
    };
    check(reach + gravity);
    check(0.3 * reach + 0.9 * follow);
    check(0.5 * skin + weighted(0.3 * reach + 0.9 * follow));
    check(0.5 * skin + gravity);
  }
}

TEST_CASE("Fused: freezes and releases its tracking laws, and says so") {
  const GravityControl gravity;
  const SkinJointControl skin;
  const Skinned<double> untouched;
  const auto touch = touch_of(30, 20, 0);  // across the joints' axes
  const auto tau_skin = skin_torque(model, JointAngles<Arm, double>(model, pose.q), touch);
  REQUIRE(largest(tau_skin) > 100 * OppositionSettings{}.on);
  const double side = power(tau_skin, JointVelocity<6>::constant(1)) > 0 ? -1 : 1;
  const auto run = [&](const auto& law) {
    using L = std::remove_cvref_t<decltype(law)>;
    const KnownTo<L> free(model, pose, 0.002, untouched), touched(model, pose, 0.002, touch);
    auto memory = law.start(free);
    const auto cycles = [&](const KnownTo<L>& known, int n) {
      Status seen;
      for (int i = 0; i < n; ++i) {
        const auto e = evaluate(law, memory, known, 0.002);
        memory = e.memory;
        seen |= e.status;
      }
      return seen;
    };
    CHECK_FALSE(cycles(free, 10).has(Reason::opposed));
    CHECK(cycles(touched, 40).has(Reason::opposed));
    const auto during = law.template memory<1>(memory);
    CHECK(during.held == 40);
    cycles(free, 100);
    const auto after = law.template memory<1>(memory);
    CHECK(after.released == 1);
    CHECK(after.held == 40 + 25);  // 50 ms
  };
  run(1.0 * skin + Told{side * 5, 0} + gravity);
  // Without a gravity law tracking holds G as well; that is not what works against the skin.
  run(1.0 * skin + Told{side * 5, 0});

  // A law that goes with the skin is left alone, gravity or not.
  const auto agree = [&](const auto& law) {
    const KnownTo<std::remove_cvref_t<decltype(law)>> touched(model, pose, 0.002, touch);
    return !evaluate(law, law.start(touched), touched, 0.002).status.has(Reason::opposed);
  };
  CHECK(agree(1.0 * skin + Told{-side * 5, 0} + gravity));
  CHECK(agree(1.0 * skin + Told{-side * 5, 0}));
}

TEST_CASE("Fused: a goal reaches the law that takes it") {
  const SplineJoint<6> reach({.dt = 2ms});
  const JointControl<6> follow({.dt = 2ms});
  const GravityControl gravity;
  const auto law = reach + 0.5 * follow + gravity;
  using L = std::remove_const_t<decltype(law)>;
  const Skinned<double> untouched;
  const KnownTo<L> known(model, pose, 0.002, untouched);
  const auto memory = law.start(known);
  const auto one = law.receive(memory, known, JointGoal<6>{JointPosition<6>::constant(1), 5s});
  CHECK(law.memory<0>(one.memory).plan.spline.tf == 5);
  CHECK(law.memory<1>(one.memory).plan.target.q_d == pose.q);
  const auto other = law.receive(memory, known, JointReference<6>{JointPosition<6>::constant(0.1), {}, {}});
  CHECK(law.memory<1>(other.memory).plan.target.q_d == JointPosition<6>::constant(0.1));
  const auto first = law.receive<0>(memory, known, JointGoal<6>{JointPosition<6>::constant(1), 1ns});
  CHECK(first.status.has(Reason::goal_stretched));
}

TEST_CASE("Fused: after 60 random touches no joint swings beyond its target, and no torque jumps") {
  // With the small weight a touch next to an axis is too weak to stop the arm, and winds the integrals up.
  for (const auto& row : {std::array{125.0, 3.0, 8.0}, {500.0, 3.0, 8.0}, {125.0, 1.0, 4.0}}) {
    const double rate = row[0], weight = row[1], K_c = row[2];
    const SplineJoint<6> reach({.dt = nanoseconds(1 / rate), .K_c = K_c});
    const auto law = weight * SkinJointControl{} + reach + GravityControl{};
    const auto result = touch_and_release(
        law, [&](const auto& m) { return law.memory<1>(m).plan.at(0, reach.settings()).q_d; }, rate, 60);
    CAPTURE(rate);
    CAPTURE(weight);
    CAPTURE(result.fastest);
    CHECK(result.counted > 5);
    CHECK(result.overshoot < 0.05);
  }
}

TEST_CASE("Fused: nothing of it allocates") {
  const SplineJoint<6> reach({.dt = 2ms});
  const SkinJointControl skin;
  const GravityControl gravity;
  const auto law = 0.6 * skin + 0.4 * reach + gravity;
  using K = KnownTo<std::remove_const_t<decltype(law)>>;
  const Skinned<double> untouched;
  const auto touch = touch_of(5, 30, 5);
  State<6> x = pose;
  auto memory = law.start(K(model, x, 0.002, untouched));
  const AllocationGuard guard;
  {
    const RealTimeScope loop;
    for (int i = 0; i < 2000; ++i) {
      const K known(model, x, 0.002, i % 500 > 300 ? touch : untouched);
      if (i % 400 == 0)
        memory = law.receive(memory, known, JointGoal<6>{JointPosition<6>::constant(i * 1e-3), {}}).memory;
      const auto e = evaluate(law, memory, known, 0.002);
      memory = e.memory;
      x = simulate(model, x, e.torque, 0.002, 1);
    }
  }
  const auto count = guard.count();
  CHECK(count == 0);
}
