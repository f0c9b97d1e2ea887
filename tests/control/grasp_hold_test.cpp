// An Allegro hand whose fingertips feel shear holds a cup while it is filled and pulled, no harder than it must.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "skinctl/control/grasp_control.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/robots/allegro.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/slip.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/sensor_kinds.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace grasp_hold {
namespace {

using Hand = std::remove_cvref_t<decltype(allegro::right_hand())>;
using Law = GraspControl<16, double, 3, 7, 15>;  // index, middle, thumb
using K = Quantities<Hand, Law::needs | Needs{.gravity = true}, double>;
constexpr std::size_t fingers = 3, each = 4;
template <std::size_t L>
using Tip = Patch<L, each, Uskin>;
using Fingertips = Skin<Hand, double, Tip<3>, Tip<7>, Tip<15>>;
const std::array<Xyz<double>, fingers> tips = {Xyz<double>{0.03, 0, 0}, Xyz<double>{0.03, 0, 0},
                                               Xyz<double>{0.03, 0.01, 0}};
constexpr double dt = 0.001, stiffness = 5000;

/// The contact of one fingertip with the cup: a spring along its normal, bristles across as those of `RubbedBlock`.
struct Contact {
  Xyz<double> place, normal;  ///< on the cup, into the cup
  Xyz<double> z{0, 0, 0};     ///< bend of the bristles [m]
  Xyz<double> slid{0, 0, 0};  ///< [m]

  /// The force on the fingertip after `h` seconds.
  Xyz<double> force(double h, double mu, const Xyz<double>& deep, const Xyz<double>& v) {
    const double f_n = std::max(0.0, stiffness * dot(deep, normal) + 3 * dot(v, normal));
    const Xyz<double> across = v - dot(v, normal) * normal;
    const double speed = norm(across), g = mu * (0.8 + 0.2 * std::exp(-speed * speed / 2.5e-5));
    const Xyz<double> before = z;
    const double along = dot(z, across) < 0 ? 0 : std::clamp((500 * norm(z) / g - 0.7) / 0.3, 0.0, 1.0);
    z = (1 / (1 + h * along * 500 * speed / g)) * Xyz<double>(z + h * across);
    const Xyz<double> rate = (1 / h) * Xyz<double>(z - before);
    slid = slid + h * Xyz<double>(across - rate);
    return -f_n * normal - f_n * Xyz<double>(500.0 * z + 0.5 * rate);
  }
};

struct Run {
  double mean = 0, last = 0;  ///< force of the grip: mean over the time that it carries, at the end [N]
  double slid = 0;            ///< farthest that a fingertip has slid [m]
  int slips = 0;
  bool held = false;
};

/// Carries a cup of 0.2 kg, filled to 0.5 kg from 4 to 12 s, pulled by 2 N from 14 to 16 s.
/// @param fixed  force of a grip that does not feel [N]; 0: it holds with what the fingertips ask for.
Run carry(double mu, double fixed) {
  const auto hand = allegro::right_hand();
  const Law law(tips, {.damping = 20, .max_rate = 100, .max_force = 15});
  State<16> x;
  x.q = {0.0, 0.6, 0.6, 0.4, 0.0, 0.6, 0.6, 0.4, 0.0, 0.2, 0.2, 0.2, 1.2, 0.4, 0.3, 0.4};
  const auto posture = x.q;
  const K first(hand, x, dt, NoTouch{});
  const auto shape = law.shape(first);
  Law::Memory grip = Law::start(first);

  // The cup hangs across the plane of the fingertips.
  std::array<Contact, fingers> contacts;
  std::array<Xyz<double>, fingers> outward;  // of each fingertip's skin, in its link
  for (std::size_t k = 0; k < fingers; ++k) {
    const Xyz<double> to = shape.centroid - shape.p[k];
    contacts[k] = {shape.p[k], (1 / norm(to)) * to};
  }
  Xyz<double> down = cross(Xyz<double>(shape.p[1] - shape.p[0]), Xyz<double>(shape.p[2] - shape.p[0]));
  down = (1 / norm(down)) * down;
  const auto patch = [&]<std::size_t L>(std::size_t k) {
    const auto R = first.pose<L>().axes();
    const Xyz<double> z = turn_back(R, contacts[k].normal), y = turn_back(R, down);
    outward[k] = z;
    std::vector<PlacedCell<L>> cells;
    for (std::size_t i = 0; i < each; ++i)
      cells.push_back({static_cast<std::uint32_t>(each * k + i),
                       {Rotation<double>{cross(y, z), y, z}, tips[k] + (i % 2 == 0 ? 0.002 : -0.002) * y}});
    return Tip<L>(cells);
  };
  const Tip<3> index = patch.template operator()<3>(0);
  const Tip<7> middle = patch.template operator()<7>(1);
  const Tip<15> thumb = patch.template operator()<15>(2);
  ChannelSettings<Uskin> settings;
  settings.gate.fill(EventGate<>());
  const Fingertips skin(index, middle, thumb, settings);
  const auto memory = std::make_unique<Fingertips::Memory>(skin.start(0ns));
  const Slip<> slip({.noise = 0.06});
  std::array<Slip<>::Memory, fingers> felt{};

  Random rng = seeded(4);
  std::normal_distribution<double> normal;
  Xyz<double> p{0, 0, 0}, v{0, 0, 0};  // of the cup, from where it was taken
  Run out;
  double carried = 0;
  bool was = false;
  for (int k = 1; k <= 18000; ++k) {
    const double t = dt * k;
    const double mass = 0.2 + 0.3 * std::clamp((t - 4) / 8, 0.0, 1.0);
    const double borne = std::clamp((t - 1) / 0.5, 0.0, 1.0);  // a table bears it before
    const double pull = t > 14 && t < 16 ? 2 * std::min(1.0, std::min(t - 14, 16 - t) / 0.1) : 0;
    const K known(hand, x, dt, NoTouch{});
    const auto s = law.shape(known);
    const std::tuple J{known.jacobian<3>(Transform<Link<3>, Tool>(Rotation<double>{}, tips[0])),
                       known.jacobian<7>(Transform<Link<7>, Tool>(Rotation<double>{}, tips[1])),
                       known.jacobian<15>(Transform<Link<15>, Tool>(Rotation<double>{}, tips[2]))};
    auto own = law.torque(grip, known) + known.gravity();
    const auto bear = [&](std::size_t f, const auto& J_f) {  // what hangs on it, by a spring across the grip
      const double below = dot(Xyz<double>(s.p[f] - shape.p[f]), down),
                   falls = dot((J_f * x.dq).linear, down);
      typename std::remove_cvref_t<decltype(J_f)>::Load load;
      load.force = (-2000 * below - 5 * falls) * down, load.moment = {0, 0, 0};
      own += transpose(J_f) * load;
    };
    bear(0, std::get<0>(J)), bear(1, std::get<1>(J)), bear(2, std::get<2>(J));
    std::array<Xyz<double>, fingers> at{s.p[0], s.p[1], s.p[2]}, F;
    constexpr int steps = 10;  // of a contact that is stiff
    for (int step = 0; step < steps; ++step) {
      constexpr double h = dt / steps;
      auto tau = own;
      for (std::size_t i = 0; i < 16; ++i) tau[i] += 1.0 * (posture[i] - x.q[i]) - 0.05 * x.dq[i];
      Xyz<double> on_cup = (mass * 9.81 * borne + pull) * down - (borne < 1 ? 40 * mass : 0.0) * v;
      const auto touch = [&](std::size_t f, const auto& J_f) {
        const Xyz<double> u = (J_f * x.dq).linear;
        F[f] = contacts[f].force(h, mu, at[f] - contacts[f].place - p, u - v);
        typename std::remove_cvref_t<decltype(J_f)>::Load load;
        load.force = F[f], load.moment = {0, 0, 0};
        tau += transpose(J_f) * load;
        on_cup = on_cup - F[f];
      };
      touch(0, std::get<0>(J)), touch(1, std::get<1>(J)), touch(2, std::get<2>(J));
      x.dq = integrate(x.dq, forward_dynamics(hand, x.q, x.dq, tau).acceleration, h);
      x.q = integrate(x.q, x.dq, h);
      v = v + (h / mass) * on_cup, p = p + h * v;
      at[0] = at[0] + h * (std::get<0>(J) * x.dq).linear;
      at[1] = at[1] + h * (std::get<1>(J) * x.dq).linear;
      at[2] = at[2] + h * (std::get<2>(J) * x.dq).linear;
    }

    std::vector<SensorSample<Uskin>> samples;
    const auto feel = [&]<std::size_t L>(std::size_t f) {
      const Xyz<double> z = outward[f], y = turn_back(first.template pose<L>().axes(), down),
                        in_link = turn_back(known.template pose<L>().axes(), F[f]);
      const auto read = [&](double force) { return static_cast<float>(force / each + 0.03 * normal(rng)); };
      for (std::size_t i = 0; i < each; ++i)
        samples.push_back({nanoseconds(t),
                           static_cast<std::uint32_t>(each * f + i),
                           {read(dot(in_link, cross(y, z))), read(dot(in_link, y)),
                            std::max(0.0f, read(-dot(in_link, z))), 20}});
    };
    feel.template operator()<3>(0), feel.template operator()<7>(1), feel.template operator()<15>(2);
    Fingertips::Wrenches mean;
    skin.receive(*memory, samples, nanoseconds(t - dt), nanoseconds(t), 1, &mean);
    const auto w = skin.wrenches(*memory);
    GraspGoal<double> goal{fixed > 0 ? fixed : 2};
    bool slips = false;
    for (std::size_t f = 0; f < fingers; ++f) {
      const auto said = slip.take(felt[f], dt, {w.data[f][0], w.data[f][1], w.data[f][2]}, -1.0 * outward[f]);
      if (fixed == 0) goal.hold = std::max(goal.hold, law.force_for(s, f, said.hold));
      slips = slips || said.slipping;
    }
    grip = law.receive(grip, known, goal).memory;
    grip = law.advance(grip, known, dt, Opposition::none);
    out.slips += slips && !was, was = slips;

    if (t > 1.5) out.mean += grip.force, ++carried;
    for (const Contact& c : contacts) out.slid = std::max(out.slid, norm(c.slid));
    if (out.slid > 0.05) return out;  // dropped
  }
  out.mean /= carried, out.last = grip.force, out.held = true;
  return out;
}

}  // namespace

TEST_CASE("GraspControl: a cup that is filled and pulled is held with what its fingertips ask for") {
  // A fixed grip knows no friction: it is the least one that holds the full, pulled cup at the smaller of the two.
  double fixed = 6;
  while (!carry(0.3, fixed).held && fixed < 15) fixed += 0.5;
  CHECK(fixed > 6);
  CHECK(fixed < 15);
  for (const double mu : {0.3, 0.6}) {
    const Run feels = carry(mu, 0);
    MESSAGE("friction " << mu << ": " << feels.mean << " N on average, " << feels.last
                        << " N at the end, slid by " << 1e3 * feels.slid << " mm in " << feels.slips
                        << " slips; a fixed grip: " << fixed << " N");
    CHECK(feels.held);
    CHECK(feels.slid < 0.005);
    CHECK(feels.mean < (mu < 0.5 ? 0.95 : 0.7) * fixed);
  }
}

TEST_CASE("GraspControl: a hold raises the force at once, up to the largest, and lets it fall slowly") {
  const auto hand = allegro::right_hand();
  const Law law(tips, {.max_rate = 100, .max_force = 15, .lowering = 2});
  const K known(hand, State<16>{}, dt, NoTouch{});
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
