// Whole cycles whose inputs hold any bits: no command that is not finite or beyond a limit, whatever comes.
//
// Promise: no bits in a cycle's input give a command that is not finite or above a limit
// Tried: 9000 cycles, every third attacked: states, stamps from INT64's ends, samples, goals, requests;
// with skin and gravity in float and double, and with goals and every limit; three joints in groups.
// Also: `cycle/group_cycle_test.cpp`

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "skinctl/recording/cycle_bytes.hpp"
#include "skinctl/recording/each_number.hpp"
#include "skinctl/skinctl.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Makes numbers hostile: one of all kinds, or any bits.
class Hostile {
 public:
  explicit Hostile(unsigned seed) : random_(seed) {}
  [[nodiscard]] bool one_in(unsigned n) { return random_() % n == 0; }
  template <class X>
  void operator()(X& x) {
    if (!one_in(8)) return;
    if constexpr (std::is_floating_point_v<X>) {
      using L = std::numeric_limits<X>;
      const X kinds[] = {L::quiet_NaN(), L::infinity(),   -L::infinity(), L::max(),
                         -L::max(),      L::denorm_min(), X(0),           X(1e30)};
      x = kinds[random_() % std::size(kinds)];
    } else if constexpr (std::is_same_v<X, Nanoseconds>) {
      const Nanoseconds kinds[] = {
          Nanoseconds::min(), Nanoseconds::max(), -x, x - 1h, x + 1h, Nanoseconds(0), x - 8ms};
      x = kinds[random_() % std::size(kinds)];
    } else if constexpr (!std::is_same_v<X, bool>) {
      std::uint64_t bits = random_();
      std::memcpy(&x, &bits, sizeof x < sizeof bits ? sizeof x : sizeof bits);
    }
  }

 private:
  std::mt19937_64 random_;
};

/// The robot follows, cycle by cycle, and every so often all that it says is wrong.
template <class Scene, class T>
void attack(const Scene& scene, const JointLimits<6, T>& limits, int cycles, unsigned seed) {
  Hostile hostile(seed);
  State<6, T> state;
  state.q = home_position<T>();
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, state);
  const auto input = std::make_unique<typename Scene::Input>();
  JointPosition<6, T> last = state.q;
  int wrong = 0, valid = 0;
  for (int k = 1; k <= cycles; ++k) {
    CAPTURE(k);
    const Nanoseconds truth = k * 8ms;
    state.time = truth;
    CellSample samples[4];
    for (std::size_t i = 0; i < 4; ++i)
      samples[i] = {
          .time = truth - 1ms, .cell = static_cast<std::uint32_t>(20 + 60 * i), .force = {0.3f, 0.2f, 0.1f}};
    *input = {};
    input->now = truth;
    input->measured = state;
    if constexpr (requires { input->goal->q_g; }) {
      if (hostile.one_in(20)) input->goal = {JointPosition<6, T>::constant(T(0.3)), 2s};
    }
    const bool attacked = hostile.one_in(3);
    if (attacked) {
      ++wrong;
      if (hostile.one_in(2)) each_number(input->measured, hostile);
      if (hostile.one_in(2)) each_number(input->now, hostile);
      if (hostile.one_in(2))
        for (CellSample& s : samples) each_number(s, hostile);
      if constexpr (requires { input->goal->q_g; })
        if (input->goal) each_number(input->goal->q_g, hostile), each_number(input->goal->duration, hostile);
      hostile(input->request);
    }
    input->samples = samples;
    CHECK(CycleBytes<Scene>::max_size(*input) >= CycleBytes<Scene>::fixed_size);
    const auto out = scene.step(*memory, *input);
    if (out.command.valid) {
      ++valid;
      for (std::size_t i = 0; i < 6; ++i) {
        const T q = out.planned.position[i], dq = out.planned.velocity[i];
        REQUIRE(std::isfinite(q));
        REQUIRE(std::isfinite(dq));
        CHECK(std::abs(dq) <= limits.velocity()[i] * T(1.0001));
        CHECK((q >= limits.lower()[i] && q <= limits.upper()[i]));
        CHECK(std::abs(q - last[i]) <= limits.velocity()[i] * T(0.04 * 1.001));  // five periods at most
      }
      last = out.command.position;
      state.q = out.planned.position, state.dq = out.planned.velocity;
    }
    for (const auto& share : out.shares)
      for (const T tau : share) REQUIRE_FALSE(std::isnan(tau));
  }
  CHECK(wrong > cycles / 5);
  CHECK(valid > cycles / 2);
}

}  // namespace

TEST_CASE("extremes: without a skin every sample is of an unknown cell, whatever it says") {
  NoSkin none;
  auto memory = none.start(Nanoseconds::max());
  const CellSample sample{.time = Nanoseconds::min(), .force = {std::nanf(""), 0, 0}};
  CHECK(none.receive(memory, std::span(&sample, 1), Nanoseconds::min(), Nanoseconds::max(), 1, nullptr) ==
        Status(Reason::sample_unknown));
}

TEST_CASE_TEMPLATE("extremes: cycles of an arm led by hand, with any bits in their input", T,
                   SKINCTL_EXTREME_SCALARS) {
  attack(kinesthetic_scene<Interface::position, 260, T>(), ur5_test_limits<T>(), sanitized ? 200 : 3000, 1);
}

TEST_CASE(
    "extremes: Resolver, Resolved, CycleOutput, Governor and its limits in cycles with goals, with any bits "
    "in their "
    "input") {
  const auto limits = ur5_test_limits<double>();
  const LinkContact<2> contact{
      .region = {.force = 100, .blow = 150, .first = 100ms, .stiffness = 3e4, .mass = 4, .power = 50},
      .reach = 0.5,
      .reaction_time = 20ms};
  JointControlSettings<6> settings;
  settings.dt = 2500us, settings.lambda = 25, settings.K_c = 5, settings.tb = 4s;
  settings.virtual_dynamics = shape<double>({});
  const Cycle scene(test_robot<Interface::position, double>({}),
                    ur5_skin<260>({.force = 40}, SkinSettings{.max_age = 10s}),
                    SplineJoint<6>(settings) + SkinJointControl{} + GravityControl{});
  attack(scene.with(contact, MaxToolSpeed<5>{.speed = 0.5, .reach = 1.3},
                    MaxJerk{JointJerk<6>::constant(400)}, SkinWatch{}),
         limits, sanitized ? 200 : 3000, 2);
}
