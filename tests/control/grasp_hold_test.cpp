// An Allegro hand whose fingertips feel shear holds a cup that is filled and pulled, no harder than it must.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "examples/worlds/held_cup.hpp"
#include "skinctl/control/grasp_control.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/slip.hpp"
#include "skinctl/testing/random.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/sensor_kinds.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace grasp_hold {
namespace {

using Law = GraspControl<16, double, 3, 7, 15>;  // index, middle, thumb
using K = Quantities<HeldCup::Hand, Law::needs, double>;
constexpr std::size_t fingers = HeldCup::fingers, each = HeldCup::cells;
template <std::size_t L>
using Tip = Patch<L, each, Uskin>;
using Fingertips = Skin<HeldCup::Hand, double, Tip<3>, Tip<7>, Tip<15>>;
constexpr double dt = 0.001;
constexpr bool shorter = by_day || sanitized;

struct Run {
  double mean = 0, last = 0;  ///< force of the grip: mean over the time that it carries, at the end [N]
  double slid = 0;            ///< farthest that a fingertip has slid [m]
  int slips = 0;
  bool held = false;
};

/// Carries a cup of 0.2 kg, filled to 0.5 kg from 4 to 12 s, pulled by 2 N from 14 to 16 s.
/// @param fixed  force of a grip that does not feel [N]; 0: it holds with what the fingertips ask for.
/// @param probe  growth of the friction that is reckoned with [1/s].
Run carry(double mu, double fixed, double probe = 0) {
  HeldCup cup(mu);
  const Law law(HeldCup::tips, {.damping = 20, .max_rate = 100, .max_force = 15});
  Law::Memory grip = Law::start(K(cup.hand(), cup.state(), dt, NoTouch{}));
  ChannelSettings<Uskin> settings;
  settings.gate.fill(EventGate<>());
  const Fingertips skin(Tip<3>(cup.skin<3>(0)), Tip<7>(cup.skin<7>(1)), Tip<15>(cup.skin<15>(2)), settings);
  const auto memory = std::make_unique<Fingertips::Memory>(skin.start(0ns));
  const Slip<> slip({.probe = probe, .noise = 0.06});
  std::array<Slip<>::Memory, fingers> felt{};
  std::array<Xyz<double>, fingers> inward;
  for (std::size_t f = 0; f < fingers; ++f) inward[f] = -1.0 * cup.axes(f).z;

  Random rng = seeded(4);
  std::normal_distribution<double> normal;
  Run out;
  double carried = 0;
  bool was = false;
  for (int k = 1; k <= 18000; ++k) {
    const double t = dt * k;
    const double mass = 0.2 + 0.3 * std::clamp((t - 4) / 8, 0.0, 1.0);
    const double borne = std::clamp((t - 1) / 0.5, 0.0, 1.0);  // a table bears it before
    const double pull = t > 14 && t < 16 ? 2 * std::min(1.0, std::min(t - 14, 16 - t) / 0.1) : 0;
    const K known(cup.hand(), cup.state(), dt, NoTouch{});
    const auto shape = law.shape(known);
    cup.advance(dt, law.torque(grip, known), mass, borne, pull);

    std::vector<SensorSample<Uskin>> samples;
    const auto noisy = [&](double force) { return static_cast<float>(force + 0.03 * normal(rng)); };
    for (std::size_t i = 0; i < fingers * each; ++i) {
      const Xyz<double> F = cup.felt(i / each);
      samples.push_back({nanoseconds(t),
                         static_cast<std::uint32_t>(i),
                         {noisy(F.x), noisy(F.y), std::max(0.0f, noisy(F.z)), 20}});
    }
    Fingertips::Wrenches mean;
    skin.receive(*memory, samples, nanoseconds(t - dt), nanoseconds(t), 1, &mean);
    const auto w = skin.wrenches(*memory);
    GraspGoal<double> goal{fixed > 0 ? fixed : 2};
    bool slips = false;
    for (std::size_t f = 0; f < fingers; ++f) {
      const auto said = slip.take(felt[f], dt, {w.data[f][0], w.data[f][1], w.data[f][2]}, inward[f]);
      if (fixed == 0) goal.hold = std::max(goal.hold, law.force_for(shape, f, said.hold));
      slips = slips || said.slipping;
    }
    grip = law.receive(grip, known, goal).memory;
    grip = law.advance(grip, known, dt, Opposition::none);
    out.slips += slips && !was, was = slips;
    if (t > 1.5) out.mean += grip.force, ++carried;
    out.slid = cup.slid();
    if (out.slid > 0.05) return out;  // dropped
  }
  out.mean /= carried, out.last = grip.force, out.held = true;
  return out;
}

}  // namespace

TEST_CASE("GraspControl: a cup that is filled and pulled is held with what its fingertips ask for") {
  // A fixed grip knows no friction: it is the least that holds the full, pulled cup at the smaller one.
  double fixed = shorter ? 9.5 : 6;
  while (!carry(0.3, fixed).held && fixed < 15) fixed += 0.5;
  CHECK(fixed > 6);
  CHECK(fixed < 15);
  for (const double mu : {0.25, 0.3, 0.4, 0.6}) {  // all from the friction on that it reckons with
    if (shorter && mu != 0.3) continue;
    const Run safe = carry(mu, 0);
    CAPTURE(mu);
    MESSAGE("friction " << mu << ", not tried: " << safe.mean << " N on average, " << safe.last
                        << " N at the end, slid by " << 1e3 * safe.slid << " mm; a fixed grip: " << fixed
                        << " N");
    CHECK(safe.held);
    CHECK(safe.slid < 0.001);
    CHECK(safe.mean < 0.95 * fixed);
  }
  for (const double mu : {0.3, 0.6}) {
    const Run feels = carry(mu, 0, 0.05);
    MESSAGE("friction " << mu << ", tried: " << feels.mean << " N on average, " << feels.last
                        << " N at the end, slid by " << 1e3 * feels.slid << " mm in " << feels.slips
                        << " slips; a fixed grip: " << fixed << " N");
    CHECK(feels.held);
    CHECK(feels.slid < 0.005);
    CHECK(feels.mean < (mu < 0.5 ? 0.95 : 0.7) * fixed);
  }
}

TEST_CASE("GraspControl: a hold raises the force at once, up to the largest, and lets it fall slowly") {
  const auto hand = allegro::right_hand();
  const Law law(HeldCup::tips, {.max_rate = 100, .max_force = 15, .lowering = 2});
  const State<16> rest;
  const K known(hand, rest, dt, NoTouch{});
  Law::Memory m{4, 4};
  const auto run = [&](const GraspGoal<double>& goal, double seconds) {
    m = law.receive(m, known, goal).memory;
    for (double t = 0; t < seconds - 1e-9; t += dt) m = law.advance(m, known, dt, Opposition::none);
    return m.force;
  };
  CHECK(run({4}, 0.1) == 4);
  CHECK(run({4, 9}, 0.02) == doctest::Approx(6));
  CHECK(run({4, 9}, 0.1) == 9);
  CHECK(run({4, 99}, 0.2) == 15);
  CHECK(run({4, 6}, 1) == doctest::Approx(13));
  CHECK(run({4, 1}, 10) == 4);  // never below the goal
  CHECK(run({4, 9}, 0.1) == 9);
  CHECK(run({4}, 0.02) == doctest::Approx(7));  // without a hold as ever
  CHECK(run({-2, 9}, 0.2) == -2);               // what is to open opens
  CHECK(run({4, -3}, 0.2) == 4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(law.receive(m, known, {4, nan}).status.has(Reason::goal_refused));
  CHECK(law.receive(m, known, {4, nan}).memory.goal == 4);
  // The shares of the fingertips: their mean is the force.
  const auto shape = law.shape(known);
  double sum = 0;
  for (std::size_t k = 0; k < fingers; ++k) sum += 1 / law.force_for(shape, k, 1);
  CHECK(sum == doctest::Approx(fingers));
}

}  // namespace grasp_hold
