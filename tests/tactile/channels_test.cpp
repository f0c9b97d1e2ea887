// Kinds of cells besides the hexagon: channels, cones, calibrations, against sums in double from scratch.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/skin_of.hpp"
#include "skinctl/tactile/told_skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/random_skin.hpp"
#include "tests/support/sensor_kinds.hpp"
#include "tests/tactile/skin_oracle.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Model = ur5::Model;
template <class Kind>
using One = Skin<Model, double, Patch<2, 1, Kind>>;
const Transform<Link<2>, Cell> at = Transform<Link<2>, Cell>::translation_xyz(0.1, 0, 0.2);

template <class Kind>
ChannelSettings<Kind> open_gates() {
  ChannelSettings<Kind> s;
  s.gate.fill(EventGate<>());
  return s;
}
SensorSample<Uskin> taxel(std::uint32_t id, Nanoseconds t, float x, float y, float z,
                          float temperature = 20) {
  return {t, id, {x, y, z, temperature}};
}
/// Force and moment on the link of one cell at `at`, whose reading is held.
std::array<double, 6> held(const SensorSample<Uskin>& sample,
                           const ChannelSettings<Uskin>& s = open_gates<Uskin>()) {
  const One<Uskin> skin(Patch<2, 1, Uskin>({{7, at}}), s);
  auto memory = skin.start(0ns);
  One<Uskin>::Wrenches mean;
  skin.receive(memory, std::span(&sample, 1), 0ns, 10ms, 1, &mean);
  const auto w = skin.wrenches(memory);
  return {w.data[0][0], w.data[0][1], w.data[0][2], w.data[0][3], w.data[0][4], w.data[0][5]};
}

}  // namespace

static_assert(KindTable<Hexagon>::pushing == 2 && KindTable<Hexagon>::lines == 1 &&
              KindTable<Hexagon>::channels == 6);
static_assert(KindTable<Hexagon>::step(0) == CellCounts::force_unit &&
              KindTable<Hexagon>::step(1) == CellCounts::proximity_unit);
static_assert(KindTable<Uskin>::pushing == 3 && KindTable<Uskin>::lines == 3 && !KindTable<Uskin>::sees);
static_assert(KindTable<Uskin>::limit(0) == 40960 && KindTable<Uskin>::limit(1) == 20480);
static_assert(KindTable<HexagonApart>::lines == 4);
static_assert(KindTable<Uskin>::fingerprint() != KindTable<Hexagon>::fingerprint() &&
              KindTable<HexagonApart>::fingerprint() != KindTable<Hexagon>::fingerprint());
static_assert(sizeof(detail::CellRecord<Hexagon>) == 16 && sizeof(detail::CellRecord<Uskin>) == 16);
static_assert(!std::is_invocable_v<
              decltype([](auto& s, auto& m, auto x, auto* w) -> decltype(s.receive(m, x, 0ns, 1ms, 1, w)) {}),
              One<Uskin>&, One<Uskin>::Memory&, std::span<const CellSample>, One<Uskin>::Wrenches*>);

TEST_CASE("Channels: a three-axis taxel pushes along its axes, and a bare edge gives its moment") {
  const auto w = held(taxel(7, 5ms, 1, -0.5f, 6));
  CHECK(w[0] == doctest::Approx(1).epsilon(1e-4));
  CHECK(w[1] == doctest::Approx(-0.5).epsilon(1e-4));
  CHECK(w[2] == doctest::Approx(-6).epsilon(1e-4));
  const Xyz<double> m = cross(Xyz<double>{0.1, 0, 0.2}, Xyz<double>{w[0], w[1], w[2]});
  CHECK(w[3] == doctest::Approx(m.x).epsilon(1e-6));
  CHECK(w[4] == doctest::Approx(m.y).epsilon(1e-6));
  CHECK(w[5] == doctest::Approx(m.z).epsilon(1e-6));

  // Three forces of a hexagon apart: 10 N on one of them, 10 mm off the centre, have 0.1 N m about it.
  using Patch1 = Patch<2, 1, HexagonApart>;
  const One<HexagonApart> skin(
      Patch1({{7, Transform<Link<2>, Cell>::translation_xyz(0, 0, 0)}}, {{10, 10, 10, 0}}),
      open_gates<HexagonApart>());
  auto memory = skin.start(0ns);
  const SensorSample<HexagonApart> edge{5ms, 7, {1, 0, 0, 0}};
  One<HexagonApart>::Wrenches mean;
  skin.receive(memory, std::span(&edge, 1), 0ns, 10ms, 1, &mean);
  const auto f = skin.wrenches(memory);
  CHECK(f.data[0][2] == doctest::Approx(-10).epsilon(1e-4));
  CHECK(f.data[0][4] == doctest::Approx(0.1).epsilon(1e-4));
}

TEST_CASE(
    "Channels: shear counts within the cone of its own pressure: stuck at 15 N it is nothing without, 1.6 N "
    "at 2") {
  const auto shear = [](float x, float y, float z) {
    const auto w = held(taxel(7, 5ms, x, y, z));
    return std::hypot(w[0], w[1]);
  };
  CHECK(shear(15, 0, 0) == 0);
  CHECK(shear(15, 0, 2) == doctest::Approx(1.6).epsilon(1e-3));
  CHECK(shear(-20, 20, 2) == doctest::Approx(1.6).epsilon(1e-3));
  CHECK(shear(0.9f, 1.2f, 2) == doctest::Approx(1.5).epsilon(1e-3));  // within it as it is
  const auto w = held(taxel(7, 5ms, -9, -12, 2));
  CHECK(w[0] == doctest::Approx(-0.96).epsilon(1e-3));
  CHECK(w[1] == doctest::Approx(-1.28).epsilon(1e-3));
  // A gate that takes 0.5 N off the pressure narrows the cone.
  auto s = open_gates<Uskin>();
  s.gate[0] = EventGate<>::dead_band(0.5);
  CHECK(held(taxel(7, 5ms, 15, 0, 2), s)[0] == doctest::Approx(1.2).epsilon(1e-3));
  CHECK(held(taxel(7, 5ms, 15, 0, 0.5f), s)[0] == 0);
  // Beyond its greatest amount a reading is cut off, not refused, as far as its range goes.
  CHECK(held(taxel(7, 5ms, 0, 0, 20))[2] == doctest::Approx(-20).epsilon(1e-4));
}

TEST_CASE(
    "Channels: any sequence of samples equals a sum from scratch bit for bit, and the readings in double") {
  Random rng = seeded(3);
  constexpr std::size_t n = 40;
  std::vector<ChannelPatch<Uskin>> patches;
  std::vector<Transform<SomeLink, Cell>> places;
  for (std::size_t k = 0; k < 2 * n; ++k) {
    if (k % n == 0) patches.push_back({k / n == 0 ? 1u : 4u, {{1.5, 1, 2}}, {}});
    places.push_back(Transform<SomeLink, Cell>(random_rotation<double>(rng), random_xyz(rng, 0.3)));
    patches.back().cells.push_back({.id = static_cast<std::uint32_t>(10 + k), .X_LC = places.back()});
  }
  using S = SkinOf<Model, double, 2 * n, 2, all_links(6), Uskin>;
  const S skin(patches, open_gates<Uskin>());
  const auto memory = std::make_unique<S::Memory>(skin.start(0ns));
  std::vector<std::array<float, 3>> newest(2 * n);
  std::uint64_t allocations = 0;
  for (Nanoseconds t{}; t < 2s; t += 2ms) {
    std::vector<SensorSample<Uskin>> samples;
    for (int k = 0; k < 100; ++k) {
      const std::size_t i = rng() % (2 * n);
      const auto some = [&] { return static_cast<float>(uniform(rng, -20.0, 20.0)); };
      const float z = rng() % 4 == 0 ? 0.0f : std::abs(some());
      samples.push_back(taxel(static_cast<std::uint32_t>(10 + i), t + 1ms + k * 1us, some(), some(), z));
      newest[i] = {samples.back().readings[0], samples.back().readings[1], z};
    }
    S::Wrenches means[2];
    const AllocationGuard guard;
    skin.receive(*memory, samples, t, t + 2ms, static_cast<std::size_t>(1 + (t / 2ms) % 2), means);
    allocations += guard.count();
    if ((t / 2ms) % 50 == 0) CHECK(skin.recomputed(*memory) == *memory);
  }
  CHECK(allocations == 0);
  CHECK(skin.recomputed(*memory) == *memory);
  CHECK(skin.silent(*memory) == 0);
  // From the readings, in double, without counts.
  double wrench[2][6] = {};
  for (std::size_t i = 0; i < 2 * n; ++i) {
    const double pressure = 1.5 * double(newest[i][2]);
    double x = 1.0 * double(newest[i][0]), y = 2.0 * double(newest[i][1]);
    const double size = std::hypot(x, y), most = 0.8 * pressure;
    if (size > most) x *= most / size, y *= most / size;
    const auto axes = places[i].axes();
    const Xyz<double> f = x * axes.x + y * axes.y - pressure * axes.z, m = cross(places[i].origin(), f);
    const double row[6] = {f.x, f.y, f.z, m.x, m.y, m.z};
    for (std::size_t r = 0; r < 6; ++r) wrench[i / n][r] += row[r];
  }
  const auto w = skin.wrenches(*memory);
  double off = 0;
  for (std::size_t r = 0; r < 6; ++r)
    off = std::max({off, std::abs(w.data[1][r] - wrench[0][r]), std::abs(w.data[4][r] - wrench[1][r])});
  MESSAGE("80 taxels, 700 N: off by " << off << " N, N m");
  CHECK(off < 0.02);
}

TEST_CASE(
    "Channels: each is linear through its samples, fades and is made up for, as a hexagon's reading is") {
  Random rng = seeded(9);
  const ChannelSettings<HexagonApart> s = open_gates<HexagonApart>();
  using P = Patch<2, 1, HexagonApart>;
  const One<HexagonApart> skin(P({{7, Transform<Link<2>, Cell>::translation_xyz(0, 0, 0)}}, {{3, 5, 7, 2}}),
                               s);
  auto memory = skin.start(0ns);
  std::vector<Knot> knots[4];
  const double gain[4] = {3, 5, 7, 2};
  double impulse[3] = {};
  Nanoseconds next = 3ms;
  const Nanoseconds end = 3s;
  for (Nanoseconds from{}; from < end; from += 5ms) {
    std::vector<SensorSample<HexagonApart>> samples;
    while (next <= from + 5ms) {
      SensorSample<HexagonApart> sample{next, 7, {}};
      for (std::size_t c = 0; c < 4; ++c) {
        sample.readings[c] = static_cast<float>(rng() % 1025) / 1024;
        knots[c].push_back({next, gain[c] * double(sample.readings[c])});
      }
      samples.push_back(sample);
      next += rng() % 20 == 0 ? 400ms : Nanoseconds(rng() % 30000000 + 100000);
    }
    One<HexagonApart>::Touch means[3];
    skin.receive(memory, samples, from, from + 5ms, 3, means);
    for (const auto& mean : means) {
      impulse[0] -= mean.force.data[0][2] * 5e-3 / 3;
      impulse[1] -= mean.proximity.data[0][2] * 5e-3 / 3;
      impulse[2] += mean.force.data[0][4] * 5e-3 / 3;
    }
  }
  long double expected[4];
  for (std::size_t c = 0; c < 4; ++c)
    expected[c] = CellSignal(knots[c], s.max_age, s.fade, s.ramp).impulse(0ns, end);
  CHECK(impulse[0] == doctest::Approx(double(expected[0] + expected[1] + expected[2])).epsilon(2e-3));
  CHECK(impulse[1] == doctest::Approx(double(expected[3])).epsilon(2e-3));
  CHECK(impulse[2] ==
        doctest::Approx(double(0.01L * expected[0] - 0.005L * (expected[1] + expected[2]))).epsilon(2e-3));
}

TEST_CASE("Channels: damaged, foreign and stale samples do not push, and say why") {
  const One<Uskin> skin(Patch<2, 1, Uskin>({{7, at}}), open_gates<Uskin>());
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto status = [&](const SensorSample<Uskin>& sample) {
    auto memory = skin.start(0ns);
    One<Uskin>::Wrenches mean;
    const auto good = taxel(7, 1ms, 0, 0, 0);
    skin.receive(memory, std::span(&good, 1), 0ns, 2ms, 1, &mean);
    const Status s = skin.receive(memory, std::span(&sample, 1), 2ms, 10ms, 1, &mean);
    if (s.any()) CHECK(skin.wrenches(memory) == One<Uskin>::Wrenches{});
    return s;
  };
  for (const float bad : {nan, inf, -inf}) {
    CHECK(status(taxel(7, 5ms, bad, 0, 5)) == Status(Reason::sample_not_finite));
    CHECK(status(taxel(7, 5ms, 0, 0, 5, bad)) == Status(Reason::sample_not_finite));  // a told one, too
  }
  CHECK(status(taxel(7, 5ms, 20.001f, 0, 5)) == Status(Reason::sample_out_of_range));
  CHECK(status(taxel(7, 5ms, 0, 0, -0.1f)) == Status(Reason::sample_out_of_range));
  CHECK(status(taxel(7, 5ms, 0, 0, 5, 121)) == Status(Reason::sample_out_of_range));
  CHECK(status(taxel(8, 5ms, 0, 0, 5)) == Status(Reason::sample_unknown));
  CHECK(status(taxel(7, 1ms, 0, 0, 5)) == Status(Reason::time_backwards));
  CHECK(status(taxel(7, 20ms, 0, 0, 5)) == Status(Reason::sample_out_of_range));
  CHECK_FALSE(status(taxel(7, 5ms, 20, -20, 20)).any());
  CHECK(skin.max_proximity<2>(skin.start(0ns)) == 1);
}

TEST_CASE("Channels: what is seen is no contact, and bounds what is near as a share of its range") {
  const One<Nearness> skin(Patch<2, 1, Nearness>({{7, at}}, {{4}}), open_gates<Nearness>());
  auto memory = skin.start(0ns);
  const SensorSample<Nearness> sample{5ms, 7, {0.05f}};
  One<Nearness>::Touch mean;
  skin.receive(memory, std::span(&sample, 1), 0ns, 10ms, 1, &mean);
  CHECK(skin.touch(memory).force == One<Nearness>::Wrenches{});
  CHECK(skin.touch(memory).proximity.data[0][2] == doctest::Approx(-0.2).epsilon(1e-4));
  CHECK(skin.max_proximity<2>(memory) == doctest::Approx(0.25).epsilon(1e-4));
  CHECK(skin.pressed(memory).size() == 0);
}

TEST_CASE("Channels: the areas that are pressed have the shear, too, and sum to the contacts of the link") {
  const One<Uskin> skin(Patch<2, 1, Uskin>({{7, at}}), open_gates<Uskin>());
  auto memory = skin.start(0ns);
  const auto sample = taxel(7, 5ms, 1, 2, 6);
  One<Uskin>::Wrenches mean;
  skin.receive(memory, std::span(&sample, 1), 0ns, 10ms, 1, &mean);
  const auto areas = skin.pressed(memory);
  REQUIRE(areas.size() == 1);
  const auto w = skin.wrenches(memory);
  CHECK(areas[0].force.x == doctest::Approx(w.data[0][0]));
  CHECK(areas[0].force.z == doctest::Approx(w.data[0][2]));
  CHECK(areas[0].moment.y == doctest::Approx(w.data[0][4]));
  int pressed = 0, contacts = 0;
  skin.each_pressed(memory, [&](std::size_t, double push) {
    ++pressed;
    CHECK(push == doctest::Approx(6).epsilon(1e-4));
  });
  skin.each_cell([&](std::size_t link, const auto& f, const auto&, double gain) {
    ++contacts;
    CHECK(link == 2);
    CHECK(gain == doctest::Approx(1));
    CHECK(dot(f, f) == doctest::Approx(1));
  });
  CHECK(pressed == 1);
  CHECK(contacts == 3);
}

TEST_CASE(
    "ChannelCalibration: y = A x + b stands before the gates, and what it makes of magnets is cut off, not "
    "wrapped") {
  const One<Uskin> plain(Patch<2, 1, Uskin>({{7, at}}), open_gates<Uskin>());
  auto own = ChannelCalibration<Uskin>::identity();
  const auto held_by = [&](const ChannelCalibration<Uskin>& c, const SensorSample<Uskin>& sample) {
    const auto skin = calibrated(plain, {c});
    auto memory = skin.start(0ns);
    One<Uskin>::Wrenches mean;
    skin.receive(memory, std::span(&sample, 1), 0ns, 10ms, 1, &mean);
    CHECK(skin.recomputed(memory) == memory);
    return skin.wrenches(memory);
  };
  const auto sample = taxel(7, 5ms, 1, 2, 6, 30);
  CHECK(held_by(own, sample) == [&] {
    auto memory = plain.start(0ns);
    One<Uskin>::Wrenches mean;
    plain.receive(memory, std::span(&sample, 1), 0ns, 10ms, 1, &mean);
    return plain.wrenches(memory);
  }());
  own.A[0] = {0.1f, 0, 0.5f, 0.02f}, own.b[0] = -1;  // cross-talk of x, and a drift by temperature
  CHECK(held_by(own, sample).data[0][2] == doctest::Approx(-(0.1 + 3 + 0.6 - 1)).epsilon(1e-4));
  own.A[0] = {0, 0, 1e6f, 0};
  CHECK(held_by(own, sample).data[0][2] == doctest::Approx(-20).epsilon(1e-4));
  own.A[0] = {0, 0, -1e6f, 0};
  CHECK(held_by(own, sample) == One<Uskin>::Wrenches{});
  own.b[1] = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_AS(static_cast<void>(calibrated(plain, {own})), ConfigurationError);
  CHECK_THROWS_WITH_AS(static_cast<void>(calibrated(plain, {})),
                       doctest::Contains("one for all cells, or one a cell"), ConfigurationError);
}

TEST_CASE("ToldSkin: keeps what cells tell, of samples that count, and pushes by none of it") {
  using S = One<Uskin>;
  const ToldSkin skin(S(Patch<2, 1, Uskin>({{7, at}}), open_gates<Uskin>()));
  auto memory = skin.start(0ns);
  KindInput<Uskin> sensed;
  const State<6> state;
  const auto give = [&](std::vector<SensorSample<Uskin>> samples, Nanoseconds from) {
    sensed.taxels = samples;
    S::Wrenches mean;
    return skin.receive(memory, std::span<const CellSample>(), sensed, state, from, from + 10ms, 1, &mean);
  };
  CHECK(skin.told(memory, 0, 3) == 0);
  give({taxel(7, 5ms, 0, 0, 0, 36.5f), taxel(8, 6ms, 0, 0, 0, 50)}, 0ms);
  CHECK(skin.told(memory, 0, 3) == 36.5f);
  CHECK(skin.told_at(memory, 0) == 5ms);
  CHECK(skin.wrenches(memory) == S::Wrenches{});
  give({taxel(7, 15ms, 0, 0, 21, 99)}, 10ms);  // a force out of range: nothing of it is believed
  CHECK(skin.told(memory, 0, 3) == 36.5f);
  CHECK(amount<Uskin>(taxel(7, 5ms, 0, 0, 0, 36.5f), 3) == 36.5f);
}

TEST_CASE("Channels: wrong configurations are refused") {
  using P = Patch<2, 1, Uskin>;
  CHECK_THROWS_WITH_AS(P({{7, at}}, {{1, -1, 1}}),
                       "skinctl: Patch: gain of shear x = -1, allowed: 0 to 1e4 N", ConfigurationError);
  ChannelSettings<Uskin> s;
  s.fade = 0ns;
  CHECK_THROWS_AS(One<Uskin>(P({{7, at}}), s), ConfigurationError);
}
