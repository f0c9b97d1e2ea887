#include <doctest/doctest.h>

#include <limits>
#include <type_traits>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/largest.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
using Touch = LinkWrenches<Arm, 0b110110, double>;
template <class L>
using KnownTo = Quantities<Arm, L::needs, double, Touch>;
const Arm model;
const GravityControl gravity;
const SkinJointControl skin;
const State<6> pose{0ns, JointPosition<6>{0.3, -1.2, 1.0, 0.1, 0.4, 0.2}, {}};
const Touch untouched;

/// A law that gives known torques for its feedback and its feed-forward, counts, and holds gravity if it may.
struct Told : Composable {
  using Goal = int;
  struct Memory {
    int steps = 0, goal = 0;
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
  template <class K>
  Received<Memory> receive(const Memory& m, const K&, int goal) const noexcept {
    return {{m.steps, goal}, {}};
  }
  template <GravityTerm G = GravityTerm::included, class K>
  JointTorque<6> torque(const Memory&, const K& known, const LawShare<double>& share = {}) const noexcept {
    auto tau = JointTorque<6>::constant(share.feedback * feedback + share.feed_forward * feed_forward);
    if (G == GravityTerm::included) tau += share.feed_forward * gravity_torque(known.model(), known.q());
    return tau;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return {m.steps + 1, m.goal};
  }
};
struct Other : Told {
  using Goal = char;
  using Told::Told;
};

Touch touch_of(double size) {
  Touch touch;
  touch.set<2>({{size, -size, size}, {0.05 * size, -0.1 * size, 0.1 * size}});
  return touch;
}

/// A law that runs at one pose.
template <class L>
struct Run {
  const L& law;
  double dt = 0.002;
  typename L::Memory memory = law.start(KnownTo<L>(model, pose, 0.0, untouched));
  JointTorque<6> last{}, before_last{};
  Status status{};
  double jump = 0;  ///< largest second difference of the torque
  int steps = 0;

  auto step(const Touch& touch = untouched) {
    const KnownTo<L> known(model, pose, 0.0, touch);
    const auto e = evaluate(law, memory, known, dt);
    memory = e.memory;
    status = e.status;
    JointTorque<6> sum;
    for (const auto& share : e.shares) sum += share;
    if constexpr (!L::holds_gravity) CHECK(largest(sum - e.torque) < 1e-12);
    if (steps++ > 1) jump = std::max(jump, largest(e.torque - 2.0 * last + before_last));
    before_last = last;
    last = e.torque;
    return e;
  }
  template <class G>
  Status ask(const G& goal) {
    const auto r = law.receive(memory, KnownTo<L>(model, pose, 0.0, untouched), goal);
    memory = r.memory;
    return r.status;
  }
};
}  // namespace

TEST_CASE("Blended: is a law that does what its sum does, until other weights are asked for") {
  const SplineJoint<6> reach({.dt = 2ms});
  const auto sum = 0.6 * skin + 0.4 * reach + gravity;
  const auto law = blended(sum);
  using L = std::remove_const_t<decltype(law)>;
  using S = std::remove_const_t<decltype(sum)>;
  static_assert(Law<L, KnownTo<L>> && std::is_trivially_copyable_v<L::Memory>);
  static_assert(terms_of<L> == 3 && L::role == LawRole::tracking && L::needs == S::needs);
  static_assert(std::is_same_v<L::Goal, BlendGoal<JointGoal<6>, 3>>);
  State<6> x = pose;
  Touch touch;
  auto a = sum.start(KnownTo<S>(model, x, 0.002, touch));
  auto b = law.start(KnownTo<L>(model, x, 0.002, touch));
  for (int k = 0; k < 600; ++k) {
    touch = touch_of(k > 100 && k < 300 ? 8 : 0);
    const KnownTo<S> known(model, x, 0.002, touch);
    const KnownTo<L> to_blend(model, x, 0.002, touch);
    if (k == 50) {
      const JointGoal<6> goal{JointPosition<6>::constant(0.1), 2s};
      a = sum.receive(a, known, goal).memory;
      b = law.receive(b, to_blend, BlendGoal<JointGoal<6>, 3>{.goal = goal}).memory;
    }
    const auto one = evaluate(sum, a, known, 0.002);
    const auto other = evaluate(law, b, to_blend, 0.002);
    REQUIRE(largest(one.torque - other.torque) <= 1e-12 * (1 + largest(one.torque)));
    REQUIRE(one.status == other.status);
    a = one.memory;
    b = other.memory;
    x = simulate(model, x, one.torque, 0.002, 1);
  }
}

TEST_CASE("Blended: weights change by request, smoothly, and what fades out is no longer computed") {
  const auto law = blended(1.0 * Told{2, 30} + 1.0 * Other{4, 50} + gravity);
  using L = std::remove_const_t<decltype(law)>;
  const auto G = gravity_torque(model, pose.q);
  Run<L> run{law};
  run.step();
  CHECK(largest(run.last - (JointTorque<6>::constant(43) + G)) < 1e-12);
  CHECK(run.ask(BlendWeights<3>{{1, 0, 1}}) == Status{});
  const auto before = run.last;
  run.step();
  CHECK(run.last == before);  // at its begin the ramp has changed nothing
  CHECK(run.status.has(Reason::bumpless_transfer));
  for (int k = 0; k < 49; ++k) {
    run.step();
    const double x = run.last[0] - G[0];
    CHECK((x <= 43 + 1e-12 && x >= 32));
  }
  run.step();
  CHECK(largest(run.last - (JointTorque<6>::constant(32) + G)) < 1e-12);
  CHECK_FALSE(run.status.has(Reason::bumpless_transfer));
  CHECK(run.jump < 11 * 5.78 / (50 * 50) * 1.01);  // the quintic's bend
  const int computed = law.memory<1>(run.memory).steps;
  for (int k = 0; k < 10; ++k) run.step();
  CHECK(law.memory<1>(run.memory).steps == computed);
  CHECK(run.ask('x') == Status{Reason::goal_refused});  // to a law that is not loaded
  CHECK(run.ask(7) == Status{});
  CHECK(law.memory<0>(run.memory).goal == 7);

  // The same request in every cycle is one request.
  for (int k = 0; k < 60; ++k) {
    CHECK(run.ask(BlendWeights<3>{{1, 0, 1}}) == Status{});
    run.step();
  }
  CHECK_FALSE(run.status.has(Reason::bumpless_transfer));

  // Back again, and of two requests meanwhile the last one counts.
  CHECK(run.ask(BlendWeights<3>{{0, 1, 1}}) == Status{});
  for (int k = 0; k < 20; ++k) run.step();
  run.ask(BlendWeights<3>{{5, 1, 1}});
  run.ask(BlendWeights<3>{{3, 1, 1}});
  for (int k = 0; k < 250; ++k) run.step();
  CHECK(largest(run.last - (JointTorque<6>::constant(0.75 * 32 + 0.25 * 54) + G)) < 1e-12);
  CHECK(run.jump < 22 * 5.78 / (50 * 50) * 1.01);
  CHECK(law.memory<1>(run.memory).steps == 221);  // it began anew, in every cycle of the ramp
}

TEST_CASE("Blended: refuses weights that mean nothing, and all tracking may fade where gravity is held") {
  const double inf = std::numeric_limits<double>::infinity();
  const auto held = blended(1.0 * Told{2, 30} + 0.5 * skin + gravity);
  Run<std::remove_const_t<decltype(held)>> run{held};
  for (const BlendWeights<3>& bad :
       {BlendWeights<3>{{-1, 1, 1}}, BlendWeights<3>{{1, std::nan(""), 1}}, BlendWeights<3>{{1, inf, 1}},
        BlendWeights<3>{{1, 1, 0}}, BlendWeights<3>{{1, 1, 2}}})
    CHECK(run.ask(bad) == Status{Reason::goal_refused});
  const auto G = gravity_torque(model, pose.q);
  run.ask(BlendWeights<3>{{0, 0.5, 1}});
  for (int k = 0; k < 60; ++k) run.step();
  CHECK(largest(run.last - G) < 1e-12);

  // Without a gravity law tracking holds G; what it leaves of it the sum holds.
  const auto own = blended(1.0 * Told{2, 30} + 0.5 * skin);
  Run<std::remove_const_t<decltype(own)>> alone{own};
  alone.ask(BlendWeights<2>{{0, 0.5}});
  for (int k = 0; k < 60; ++k) {
    alone.step();
    const double part = (alone.last - G)[3] / 32;
    CHECK(largest(alone.last - (G + JointTorque<6>::constant(32 * part))) < 1e-12 * 100);
  }
  CHECK(largest(alone.last - G) < 1e-12 * 100);
  CHECK_THROWS_AS(static_cast<void>(blended(own.sum(), {.ramp = 0ns})), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(blended(own.sum(), {.contact = {.on = 1, .off = 2}})),
                  ConfigurationError);
  using Own = std::remove_const_t<decltype(own)>;
  CHECK_THROWS_AS(Own(own.sum(), std::array<double, 2>{-1, 1}), ConfigurationError);
}

TEST_CASE("Blended: gates open and shut with contact, smoothly") {
  const auto law = blended(0.0001 * skin + when_untouched(Told{2, 30}) + when_touched(Other{4, 50}) + gravity,
                           {.contact = {.on = 1e-4 * 1, .off = 1e-4 * 0.5}});
  using L = std::remove_const_t<decltype(law)>;
  static_assert(L::gated);
  const auto G = gravity_torque(model, pose.q);
  const auto touch = touch_of(30);
  Run<L> run{law};
  const auto own = [&] { return largest(run.last - G); };
  for (int k = 0; k < 100; ++k) run.step();
  CHECK(own() == doctest::Approx(32).epsilon(1e-9));
  CHECK(law.memory<2>(run.memory).steps == 0);
  for (int k = 0; k < 110; ++k) run.step(touch);
  CHECK(own() == doctest::Approx(54).epsilon(1e-3));
  CHECK(law.memory<1>(run.memory).steps == 151);  // shut, and no longer computed
  for (int k = 0; k < 49; ++k) run.step();
  CHECK(own() == doctest::Approx(54).epsilon(1e-9));  // not before release_after
  for (int k = 0; k < 110; ++k) run.step();
  CHECK(own() == doctest::Approx(32).epsilon(1e-9));
  CHECK(run.jump < 0.01 + 22 * 5.78 / (50 * 50) * 1.01);
  // A contact that comes and goes every 10 ms counts as one.
  for (int k = 0; k < 500; ++k) run.step(k % 10 < 5 ? touch : untouched);
  CHECK(own() == doctest::Approx(54).epsilon(1e-3));
  CHECK(run.jump < 0.01 + 22 * 5.78 / (50 * 50) * 1.01);
}

TEST_CASE("Blended: nothing of it allocates") {
  const SplineJoint<6> reach({.dt = 2ms});
  const JointControl<6> follow({.dt = 2ms});
  const auto law = blended(0.6 * skin + 0.4 * reach + when_untouched(follow) + gravity);
  using L = std::remove_const_t<decltype(law)>;
  State<6> x = pose;
  auto memory = law.start(KnownTo<L>(model, x, 0.002, untouched));
  const auto touch = touch_of(10);
  const AllocationGuard guard;
  {
    const RealTimeScope loop;
    for (int i = 0; i < 1000; ++i) {
      const KnownTo<L> known(model, x, 0.002, i % 500 > 300 ? touch : untouched);
      if (i % 400 == 0)
        memory = law.change(memory, known, BlendWeights<4>{{0.6, i == 400 ? 0.0 : 0.4, 0.5, 1}}).memory;
      if (i % 170 == 0)
        memory = law.receive(memory, known, JointGoal<6>{JointPosition<6>::constant(i * 1e-3), {}}).memory;
      const auto e = evaluate(law, memory, known, 0.002);
      memory = e.memory;
      x = simulate(model, x, e.torque, 0.002, 1);
    }
  }
  const auto count = guard.count();
  CHECK(count == 0);
}
