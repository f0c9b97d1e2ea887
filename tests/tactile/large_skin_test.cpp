#include "skinctl/tactile/large_skin.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random_skin.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

SkinPatch some_patch(Random& rng, std::size_t link, std::size_t cells, std::uint32_t first_id,
                     const CellGains& gains = {12, 3}) {
  SkinPatch patch{link, gains, {}};
  for (std::size_t i = 0; i < cells; ++i)
    patch.cells.push_back(
        {.id = first_id + static_cast<std::uint32_t>(i),
         .X_LC = Transform<SomeLink, Cell>(random_rotation<double>(rng), random_xyz(rng, 0.3))});
  return patch;
}
/// Unknown cells, damaged readings, stamps late, ahead, swapped; a cell may fall silent and be heard again.
CellSample some_sample(Random& rng, std::uint32_t ids, Nanoseconds to) {
  CellSample s;
  s.cell = static_cast<std::uint32_t>(rng() % ids);
  s.time = to - Nanoseconds(rng() % 3000000u) - (rng() % 16 == 0 ? Nanoseconds(rng() % 400000000u) : 0ns) +
           (rng() % 16 == 0 ? 4ms : 0ns);
  for (float& f : s.force) f = rng() % 4 == 0 ? 0.0f : float(rng() % 1028) / 1024;
  s.proximity = float(rng() % 65537) / 65536;
  return s;
}

}  // namespace

TEST_CASE("LargeSkin: its sums differ from the exact ones by 0, with more than 8192 cells a patch") {
  Random rng = seeded(1);
  const std::vector<SkinPatch> patches = {some_patch(rng, 1, 20000, 1, {16384, 65536}),
                                          some_patch(rng, 4, 300, 30000, {16384, 65536})};
  LargeSkin<ur5::Model> skin(patches);
  const auto& cells = skin.cells();
  skin.start(0ns);
  const std::size_t count = sanitized ? 60 : 600;
  Nanoseconds now{};
  std::vector<CellSample> samples(3000);
  for (std::size_t k = 0; k < count; ++k) {
    now += k % 100 == 99 ? 270ms : 2ms;
    for (CellSample& s : samples) s = some_sample(rng, 30305, now);
    const AllocationGuard guard;
    static_cast<void>(skin.take(samples, now));
    CHECK(guard.count() == 0);
  }
  CHECK(cells.recomputed(skin.memory()) == skin.memory());
  CHECK(cells.silent(skin.memory()) < cells.size());
  // The exact sums in whole steps, of 2^-24 for forces and of 2^-24 times the next power of two of the largest
  // moment among 8192 cells. Gains make one count 1 N, so that nothing is rounded.
  std::size_t i = 0;
  const auto touch = cells.touch(skin.memory());
  for (const SkinPatch& patch : patches) {
    double exact[2][6] = {};
    for (std::size_t from = 0; from < patch.cells.size(); from += 8192) {
      const std::size_t to = std::min(from + 8192, patch.cells.size());
      double most = 0;
      for (std::size_t k = from; k < to; ++k) {
        const auto m = unit_wrench(patch.cells[k].X_LC).moment;
        most = std::max({most, std::abs(m.x), std::abs(m.y), std::abs(m.z)});
      }
      const int reach = static_cast<int>(std::ceil(std::log2(most)));
      __extension__ __int128 steps[2][6] = {};
      for (std::size_t k = from; k < to; ++k) {
        const CellCounts held = cells.held(skin.memory(), i++);
        const auto u = unit_wrench(patch.cells[k].X_LC);
        const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
        for (std::size_t r = 0; r < 6; ++r) {
          const long unit = static_cast<long>(std::round(std::ldexp(row[r], 24 - (r < 3 ? 0 : reach))));
          steps[0][r] += unit * long{held.force};
          steps[1][r] += unit * long{held.proximity};
        }
      }
      for (std::size_t kind = 0; kind < 2; ++kind)
        for (std::size_t r = 0; r < 6; ++r)
          exact[kind][r] += std::ldexp(static_cast<double>(steps[kind][r]), (r < 3 ? 0 : reach) - 24);
    }
    for (std::size_t r = 0; r < 6; ++r) {
      CHECK(exact[0][r] != 0);
      CHECK(touch.force.data[patch.link][r] - exact[0][r] == 0);
      CHECK(touch.proximity.data[patch.link][r] - exact[1][r] == 0);
    }
  }
}

TEST_CASE_TEMPLATE("LargeSkin: a cycle gets the whole impulse, whatever the intervals of reports", T, float,
                   double) {
  Random rng = seeded(2);
  LargeSkin<ur5::Model, T, link_bit<2>> skin({some_patch(rng, 2, 12000, 1)});
  const LargeSkinTouch<ur5::Model, T, link_bit<2>> touch;
  using Touch = typename LargeSkinTouch<ur5::Model, T, link_bit<2>>::Touch;
  skin.start(0ns);
  auto memory = touch.start(0ns);
  Nanoseconds from{}, now{};
  double given[12] = {}, most = 0;
  typename LargeSkin<ur5::Model, T, link_bit<2>>::Report report;
  const auto add = [](double* to, const Touch& t, double factor) {
    for (std::size_t r = 0; r < 6; ++r) {
      to[r] += factor * double(t.force.data[0][r]);
      to[6 + r] += factor * double(t.proximity.data[0][r]);
    }
  };
  for (int k = 0; k < 300; ++k) {
    now += 1ms + Nanoseconds(rng() % 3000000u);
    const bool last = k == 299;
    if (rng() % 3 != 0 || last) {  // else the report is late
      std::vector<CellSample> samples(200);
      for (CellSample& s : samples) s = some_sample(rng, 12003, now);
      report = skin.take(samples, now);
    }
    if (rng() % 8 == 0 && !last) continue;  // a cycle is missed
    Touch means[2];
    touch.receive(memory, {}, report, 0, from, now, 2, means);
    for (const Touch& mean : means) add(given, mean, 0.5 * seconds<double>(now - from));
    from = now;
  }
  const auto& impulse = report.impulse;
  for (std::size_t r = 0; r < 6; ++r)
    most = std::max({most, std::abs(impulse.force.data[0][r]), std::abs(impulse.proximity.data[0][r])});
  CHECK(most > 1);
  for (std::size_t r = 0; r < 12; ++r)
    CHECK(std::abs(given[r] - (r < 6 ? impulse.force : impulse.proximity).data[0][r % 6]) <=
          (std::is_same_v<T, double> ? 1e-12 : 2e-5) * most);
  // Reports end: what is held goes on for 50 ms, then nothing.
  Touch mean;
  CHECK_FALSE(touch.receive(memory, {}, report, 0, now, now + 49ms, 1, &mean).any());
  CHECK(mean == report.held);
  CHECK(touch.receive(memory, {}, report, 0, now + 49ms, now + 50ms, 1, &mean) ==
        Status(Reason::sample_stale));
  CHECK(mean == Touch{});
  // One that is no number is refused.
  report = skin.take({}, now + 60ms);
  report.impulse.force.data[0][4] = std::numeric_limits<T>::quiet_NaN();
  CHECK(touch.receive(memory, {}, report, 0, now + 50ms, now + 60ms, 1, &mean) ==
        Status(Reason::sample_not_finite));
  CHECK(mean == Touch{});
}

TEST_CASE("LargeSkin: a scene with it moves as one with a SkinOf") {
  Random rng = seeded(3);
  const std::vector<SkinPatch> patches = {some_patch(rng, 2, 500, 1)};
  const auto robot =
      by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms, .delay = 8ms});
  const auto law = SkinJointControl{} + GravityControl{};
  const Cycle direct(robot, SkinOf<ur5::Model, double, 500>(patches), law);
  const Cycle beside(robot, LargeSkinTouch<ur5::Model>(), law);
  LargeSkin<ur5::Model> skin(patches);
  const auto a = std::make_unique<decltype(direct)::Memory>();
  const auto b = std::make_unique<decltype(beside)::Memory>();
  State<6> state{1ms, {0.3, -1.2, 1.4, -1.8, -1.57, 0.3}, {}};
  direct.start(*a, state);
  beside.start(*b, state);
  skin.start(state.time);
  double apart = 0, moved = 0;
  for (int k = 0; k < 500; ++k) {
    state.time += 2ms;
    std::vector<CellSample> samples(3);
    for (CellSample& s : samples) s = some_sample(rng, 200, state.time);
    decltype(direct)::Input input{};
    input.now = state.time;
    input.measured = state;
    input.samples = samples;
    decltype(beside)::Input other{};
    other.now = state.time;
    other.measured = state;
    other.sensed = skin.take(samples, state.time);
    const auto out = direct.step(*a, input);
    const auto same = beside.step(*b, other);
    for (std::size_t j = 0; j < 6; ++j) {
      apart = std::max(apart, std::abs(out.command.position[j] - same.command.position[j]));
      moved = std::max(moved, std::abs(out.command.velocity[j]));
    }
    state.q = out.command.position;
    state.dq = out.command.velocity;
  }
  CHECK(apart <= 1e-12);
  CHECK(moved > 1e-3);
}

TEST_CASE("LargeSkin: wrong configurations are refused") {
  Random rng = seeded(4);
  auto patch = some_patch(rng, 1, 3, 1);
  patch.cells[1].gains = CellGains{1, 0};
  CHECK_THROWS_AS((LargeSkin<ur5::Model>{{patch}}), ConfigurationError);
  CHECK_NOTHROW((LargeSkin<ur5::Model, double, all_links(6), true>{{patch}}));
  CHECK_THROWS_AS((LargeSkin<ur5::Model>{std::vector<SkinPatch>{}}), ConfigurationError);
  CHECK_THROWS_AS((LargeSkin<ur5::Model, double, link_bit<2>>{{some_patch(rng, 1, 3, 1)}}),
                  ConfigurationError);
  CHECK_THROWS_AS(LargeSkinTouch<ur5::Model>{0ns}, ConfigurationError);
}
