// Promise: sums of events differ from the exact ones by 0, in any order
// Tried: 20 300 cells, 1.8e6 samples: late, ahead, stale, damaged, unknown, of cells that fade, end and
// are heard again. Also: 1e9 in the study `skin_exact`
//
// Promise: a skin that is known at run time is a `Skin` to the bit; each cell has its threshold and gain
// Tried: 260 cells, any samples, one or two parts; gains of a cell to 2^-16 of the patch's largest

#include "skinctl/tactile/skin_of.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// The same patches without their types.
template <class Patches>
std::vector<SkinPatch> untyped(const Patches& patches) {
  std::vector<SkinPatch> all;
  std::apply(
      [&](const auto&... p) {
        const auto one = [&](const auto& patch) {
          SkinPatch& to = all.emplace_back(SkinPatch{patch.link, patch.gains(), {}});
          for (const auto& cell : patch.any()) to.cells.push_back({.id = cell.id, .X_LC = cell.X_LC});
        };
        (one(p), ...);
      },
      patches);
  return all;
}

SkinPatch some_patch(Random& rng, std::size_t link, std::size_t cells, std::uint32_t first_id,
                     const CellGains& gains = {12, 3}) {
  SkinPatch patch{link, gains, {}};
  for (std::size_t i = 0; i < cells; ++i)
    patch.cells.push_back(
        {.id = first_id + static_cast<std::uint32_t>(i),
         .X_LC = Transform<SomeLink, Cell>(random_rotation<double>(rng), random_xyz(rng, 0.3))});
  return patch;
}
/// Whatever may come: cells unknown, readings out of range, stamps late, ahead, swapped, and silences.
std::vector<CellSample> some_samples(Random& rng, std::size_t count, std::uint32_t ids, Nanoseconds to) {
  std::vector<CellSample> samples(count);
  for (CellSample& s : samples) {
    s.cell = static_cast<std::uint32_t>(rng() % ids);
    s.time = to - Nanoseconds(rng() % 4000000u) - (rng() % 16 == 0 ? Nanoseconds(rng() % 400000000u) : 0ns) +
             (rng() % 16 == 0 ? 3ms : 0ns);
    for (float& f : s.force) f = rng() % 4 == 0 ? 0.0f : float(rng() % 1030) / 1024;
    s.proximity = float(rng() % 65537) / 65536;
  }
  return samples;
}

}  // namespace

TEST_CASE_TEMPLATE("SkinOf: bit for bit what a Skin of the same cells makes of any samples", T, float,
                   double) {
  const auto patches = ur5::skin_patches<260>({10, 3});
  const auto fixed = ur5_skin<260, T>({10, 3});
  const SkinOf<ur5::Model, T, 300> loose(untyped(patches));
  CHECK(loose.size() == 260);
  CHECK(loose.index(260) == 259);
  CHECK(loose.index(0) == 260);
  auto a = fixed.start(0ns);
  auto b = loose.start(0ns);
  Random rng = seeded(1);
  bool means = true, held = true, sums = true, statuses = true, near = true;
  Nanoseconds from{};
  for (int k = 0; k < 1500; ++k) {
    const Nanoseconds to = from + (rng() % 50 == 0 ? 260ms : rng() % 9 == 0 ? 0ns : 2ms);
    const auto samples = some_samples(rng, rng() % 30, 265, to);
    const std::size_t parts = 1 + rng() % 2;
    typename decltype(fixed)::Touch u[2];
    typename decltype(loose)::Touch v[2];
    statuses = statuses &&
               fixed.receive(a, samples, from, to, parts, u) == loose.receive(b, samples, from, to, parts, v);
    for (std::size_t j = 0; j < parts; ++j) means = means && u[j] == v[j];
    for (std::size_t i = 0; i < 260; ++i) held = held && fixed.held(a, i) == loose.held(b, i);
    sums = sums && fixed.touch(a) == loose.touch(b) && fixed.wrenches(a) == loose.wrenches(b);
    near = near && fixed.template max_proximity<2>(a) == loose.template max_proximity<2>(b);
    from = to;
  }
  CHECK((means && held && sums && statuses && near));
  CHECK(loose.recomputed(b) == b);
  CHECK(fixed.silent(a) == loose.silent(b));
  CHECK(fixed.pressed(a).size() == loose.pressed(b).size());
}

TEST_CASE_TEMPLATE("SkinOf: each cell has its threshold and its gain", T, float, double) {
  Random rng = seeded(2);
  const auto patch = random_patch<3, 40>(rng, 1);
  std::vector<SkinPatch> patches = untyped(std::tuple{patch});
  patches[0].gains = {8, 2};
  std::vector<double> force_gain(40, 8), proximity_gain(40, 2), threshold(40, 0.08);
  for (std::size_t i = 1; i < 40; ++i) {
    SkinCell& cell = patches[0].cells[i];
    cell.gains =
        CellGains{force_gain[i] = double(rng() % 1000) / 50, proximity_gain[i] = double(rng() % 1000) / 500};
    if (i % 2 == 0) cell.gate[0] = EventGate<>::dead_band(threshold[i] = double(rng() % 1000) / 1000);
  }
  SkinSettings settings;
  settings.proximity = EventGate<>();
  const SkinOf<ur5::Model, T, 64, 2, link_bit<3>> skin(patches, settings);
  auto memory = skin.start(0ns);
  Nanoseconds t{};
  double worst = 0, most = 0;
  for (int k = 0; k < 200; ++k) {
    std::vector<CellSample> samples(40);
    double expected[6] = {}, allowed = 0;
    t += 10ms;
    for (std::size_t i = 0; i < 40; ++i) {
      CellSample& s = samples[i];
      s.cell = patch.any()[i].id;
      s.time = t;
      for (float& f : s.force) f = float(rng() % 1025) / 1024;
      s.proximity = float(rng() % 65536) / 65536;
      const double sum = double(s.force[0]) + double(s.force[1]) + double(s.force[2]);
      // The threshold is counted in steps of 2^-14.
      const double excess = std::max(0.0, sum - std::round(threshold[i] * 16384) / 16384);
      const double push = force_gain[i] * excess + proximity_gain[i] * double(s.proximity);
      const auto u = unit_wrench(patch.any()[i].X_LC);
      const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
      for (std::size_t r = 0; r < 6; ++r) expected[r] += row[r] * push;
      // Shares of the largest gain, 19.98 N or below, to 2^-16; half a count of what is shared.
      allowed += 20 * (excess / 65536 + 0.5 / 16384) + 2 * (double(s.proximity) / 65536 + 0.5 / 65536);
    }
    typename decltype(skin)::Wrenches mean;
    skin.receive(memory, samples, t - 10ms, t, 1, &mean);
    const auto w = skin.wrenches(memory);
    for (std::size_t r = 0; r < 6; ++r) {
      const double error = std::abs(double(w.data[0][r]) - expected[r]);
      worst = std::max(worst, error / allowed);
      most = std::max(most, std::abs(expected[r]));
    }
  }
  CHECK(skin.recomputed(memory) == memory);
  CHECK(worst <= 1);
  CHECK(worst > 1e-4);  // shares are rounded
  CHECK(most > 10);
  // The cell without gains passes nothing, and one of gain 0 does not push.
  patches[0].cells[0].gains = CellGains{0, 0};
  const SkinOf<ur5::Model, T, 64, 2, link_bit<3>> numb(patches, settings);
  auto m = numb.start(0ns);
  CellSample s;
  s.cell = patch.any()[0].id;
  s.time = 5ms;
  s.force = {1, 1, 1};
  typename decltype(numb)::Wrenches mean;
  numb.receive(m, {&s, 1}, 0ns, 10ms, 1, &mean);
  CHECK(mean == typename decltype(numb)::Wrenches{});
  CHECK(numb.pressed(m).size() == 0);
  // Neither of them feels, nor one that is masked, also in a patch that does not see.
  SkinPatch blind{3, {10, 0}, patches[0].cells};
  for (SkinCell& cell : blind.cells) cell.gains.reset();
  blind.cells[0].gains = CellGains{0, 0}, blind.cells[1].masked = true;
  const SkinOf<ur5::Model, T, 64, 2, link_bit<3>> deaf({blind}, settings);
  auto heard = deaf.start(0ns);
  for (const SkinCell& cell : blind.cells) {
    s.cell = cell.id;
    deaf.receive(heard, {&s, 1}, 0ns, 10ms, 1, &mean);
  }
  CHECK(deaf.silent(heard) == 0);
  CHECK(deaf.coverage(heard).usable == blind.cells.size() - 2);
  // What each cell passes bounds what is near it.
  patches[0].cells[5].gate[1] = EventGate<>::dead_band(0.75);
  const SkinOf<ur5::Model, T, 64, 2, link_bit<3>> dim(patches, settings);
  auto d = dim.start(0ns);
  CHECK(dim.template max_proximity<3>(d) == 1);
  std::vector<CellSample> all(40);
  for (std::size_t i = 0; i < 40; ++i) all[i].cell = patch.any()[i].id, all[i].time = 5ms;
  dim.receive(d, all, 0ns, 10ms, 1, &mean);
  CHECK(dim.template max_proximity<3>(d) == T(0.75));
}

TEST_CASE("SkinOf: a scene takes it in place of a Skin") {
  const auto robot = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 2ms, .delay = 8ms, .virtual_damping = 4});
  const Cycle fixed(robot, ur5_skin<260>({20, 0}), SkinJointControl{} + GravityControl{});
  const Cycle loose(robot, SkinOf<ur5::Model, double, 1000>(untyped(ur5::skin_patches<260>({20, 0}))),
                    SkinJointControl{} + GravityControl{});
  const auto a = std::make_unique<decltype(fixed)::Memory>();
  const auto b = std::make_unique<decltype(loose)::Memory>();
  State<6> state{1ms, {0.3, -1.2, 1.4, -1.8, -1.57, 0.3}, {}};
  fixed.start(*a, state);
  loose.start(*b, state);
  Random rng = seeded(3);
  bool equal = true;
  double moved = 0;
  for (int k = 0; k < 500; ++k) {
    state.time += 2ms;
    const auto samples = some_samples(rng, 17, 260, state.time);
    decltype(fixed)::Input input{};
    input.now = state.time;
    input.measured = state;
    input.samples = samples;
    decltype(loose)::Input other{};
    other.now = state.time;
    other.measured = state;
    other.samples = samples;
    const auto out = fixed.step(*a, input);
    const auto same_out = loose.step(*b, other);
    for (std::size_t j = 0; j < 6; ++j) {
      equal = equal && out.command.position[j] == same_out.command.position[j];
      moved = std::max(moved, std::abs(out.planned.velocity[j]));
    }
    state.q = out.command.position;
    state.dq = out.planned.velocity;
  }
  CHECK(equal);
  CHECK(moved > 1e-4);
}

TEST_CASE("SkinOf: what does not fit is refused") {
  Random rng = seeded(4);
  std::vector<SkinPatch> two = untyped(std::tuple{random_patch<1, 3>(rng, 1), random_patch<4, 2>(rng, 11)});
  using Five = SkinOf<ur5::Model, double, 5, 2>;
  CHECK_NOTHROW(Five{two});
  using Four = SkinOf<ur5::Model, double, 4, 2>;
  CHECK_THROWS_WITH_AS(Four{two}, "skinctl: SkinOf: cells = 5, allowed: at most its capacity of 4",
                       ConfigurationError);
  using OnePatch = SkinOf<ur5::Model, double, 5, 1>;
  CHECK_THROWS_WITH_AS(OnePatch{two}, "skinctl: SkinOf: patches = 2, allowed: at most 1", ConfigurationError);
  using OtherLinks = SkinOf<ur5::Model, double, 5, 2, link_bit<1>>;
  CHECK_THROWS_AS(OtherLinks{two}, ConfigurationError);
  const auto with = [&](auto change) {
    std::vector<SkinPatch> changed = two;
    change(changed);
    return changed;
  };
  CHECK_THROWS_AS(Five{std::vector<SkinPatch>{}}, ConfigurationError);
  CHECK_THROWS_AS(Five{with([](auto& p) { p[1].cells.clear(); })}, ConfigurationError);
  CHECK_THROWS_AS(Five{with([](auto& p) { p[1].link = 6; })}, ConfigurationError);
  CHECK_THROWS_AS(Five{with([](auto& p) { p[1].link = 99; })}, ConfigurationError);
  CHECK_THROWS_AS(Five{with([](auto& p) { p[0].cells[1].gains = CellGains{-1, 0}; })}, ConfigurationError);
  CHECK_THROWS_AS(Five{with([](auto& p) { p[0].gains.force = -1; })}, ConfigurationError);
  CHECK_THROWS_AS(Five{with([](auto& p) { p[1].cells[0].id = 1; })}, ConfigurationError);
}

TEST_CASE("SkinOf: its sums differ from the exact ones by 0, with 20 000 cells a patch") {
  Random rng = seeded(1);
  const std::vector<SkinPatch> patches = {some_patch(rng, 1, 20000, 1, {4096, 8192}),
                                          some_patch(rng, 4, 300, 30000, {4096, 8192})};
  using Large = SkinOf<ur5::Model, double, 20300>;
  const Large skin(patches);
  const auto memory = std::make_unique<Large::Memory>(skin.start(0ns));
  const std::size_t count = sanitized ? 60 : 600;
  Nanoseconds now{};
  for (std::size_t k = 0; k < count; ++k) {
    const Nanoseconds from = now;
    now += k % 100 == 99 ? 270ms : 2ms;
    const auto samples = some_samples(rng, 3000, 30305, now);
    Large::Touch mean;
    const AllocationGuard guard;
    static_cast<void>(skin.receive(*memory, samples, from, now, 1, &mean));
    CHECK(guard.count() == 0);
  }
  CHECK(skin.recomputed(*memory) == *memory);
  CHECK(skin.silent(*memory) < skin.size());
  // The exact sums in whole steps, of 2^-24 for forces and of 2^-24 times the next power of two of the
  // largest moment of the patch. Gains make one count 1/4 and 1/8 N, so that nothing is rounded.
  std::size_t i = 0;
  const auto touch = skin.touch(*memory);
  for (const SkinPatch& patch : patches) {
    double most = 0;
    for (const SkinCell& cell : patch.cells) {
      const auto m = unit_wrench(cell.X_LC).moment;
      most = std::max({most, std::abs(m.x), std::abs(m.y), std::abs(m.z)});
    }
    const int reach = static_cast<int>(std::ceil(std::log2(most)));
    __extension__ __int128 steps[2][6] = {};
    for (const SkinCell& cell : patch.cells) {
      const CellCounts held = skin.held(*memory, i++);
      const auto u = unit_wrench(cell.X_LC);
      const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
      for (std::size_t r = 0; r < 6; ++r) {
        const long unit = static_cast<long>(std::round(std::ldexp(row[r], 24 - (r < 3 ? 0 : reach))));
        steps[0][r] += unit * long{held.force};
        steps[1][r] += unit * long{held.proximity};
      }
    }
    const auto exact = [&](std::size_t kind, std::size_t r) {
      return std::ldexp(static_cast<double>(steps[kind][r]), (r < 3 ? 0 : reach) - 24 - (kind == 0 ? 2 : 3));
    };
    for (std::size_t r = 0; r < 6; ++r) {
      CHECK(exact(0, r) != 0);
      CHECK(touch.force.data[patch.link][r] - exact(0, r) == 0);
      CHECK(touch.proximity.data[patch.link][r] - exact(1, r) == 0);
    }
  }
}
