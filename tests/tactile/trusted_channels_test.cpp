// runs long: minutes of cells
// Skins of other kinds than the hexagon that trust their cells: rest levels of channels, masks of cells,
// filling in.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/sensor_kinds.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t side = 4, cells = side * side;
template <class Kind>
Patch<2, cells, Kind> square(const GainsOf<Kind>& gains = {}) {
  std::vector<PlacedCell<2>> all;
  for (std::size_t i = 0; i < cells; ++i)
    all.push_back(
        {static_cast<std::uint32_t>(i + 1), Transform<Link<2>, Cell>::translation_xyz(
                                                0.005 * double(i % side), 0.005 * double(i / side), 0.02)});
  return Patch<2, cells, Kind>(all, gains);
}
template <class Kind>
using Square = Skin<ur5::Model, double, Patch<2, cells, Kind>>;

/// A square of cells of a kind, which read what `reading(cell, t)` says, with noise, at 250 Hz.
template <class Kind>
struct Run {
  using S = TrustedSkin<Square<Kind>>;
  explicit Run(const TrustSettings& settings)
      : patch(square<Kind>()), skin(Square<Kind>(patch), settings), memory(new auto(skin.start(0ns))) {}

  template <class F>
  typename S::Wrenches until(Nanoseconds end, const F& reading) {
    typename S::Wrenches mean;
    for (; now < end; now += 4ms) {
      std::vector<SensorSample<Kind>> samples;
      for (std::size_t i = 0; i < cells; ++i) {
        SensorSample<Kind> sample{now + 2ms + Nanoseconds(i), static_cast<std::uint32_t>(i + 1),
                                  reading(i, now)};
        for (float& x : sample.readings) x += noise * static_cast<float>(uniform(rng, 0.0, 1.0));
        samples.push_back(sample);
      }
      KindInput<Kind> sensed;
      sensed.taxels = samples;
      const State<6> state;
      const AllocationGuard guard;
      skin.receive(*memory, std::span<const CellSample>(), sensed, state, now, now + 4ms, 1, &mean);
      allocations += guard.count();
    }
    CHECK(allocations == 0);
    CHECK(skin.recomputed(*memory).sums == memory->sums);
    return mean;
  }
  Patch<2, cells, Kind> patch;
  S skin;
  std::unique_ptr<typename S::Memory> memory;
  Nanoseconds now{};
  float noise = 0.005f;
  Random rng = seeded(2);
  std::uint64_t allocations = 0;
};
/// Steps of 1/4096 of the range.
TrustSettings settings(double lone = std::numeric_limits<double>::infinity()) {
  TrustSettings t;
  t.lone_force = {lone};
  t.health.step = 1.0 / 4096;
  t.noise = {{.force = 1.0f, .repeats = true}};
  return t;
}
using Taxels = std::array<float, 4>;

}  // namespace

TEST_CASE("TrustedSkin of taxels: an offset of pressure and shear is taken off, a touch on it is not") {
  auto t = settings();
  t.noise = {{.force = 1.0f, .rest = 10, .repeats = true}};  // 0.05 N
  Run<Uskin> run(t);
  const auto offset = [](std::size_t, Nanoseconds) { return Taxels{1.5f, -1, 0.05f, 20}; };
  auto w = run.until(12s, offset);
  CHECK(std::abs(w.data[0][2]) < 0.01);
  // All are pressed with 2 N and sheared with 1 N: what they read beyond their rest.
  const auto pressed = [](std::size_t, Nanoseconds) { return Taxels{2.5f, -1, 2.05f, 20}; };
  w = run.until(13s, pressed);
  const double z = w.data[0][2], x = w.data[0][0];
  CHECK(z == doctest::Approx(-16 * (2 - 0.2)).epsilon(0.02));
  CHECK(x == doctest::Approx(16 * 1.0).epsilon(0.02));
  CHECK(std::abs(w.data[0][1]) < 0.2);
  // Held for 20 s it does not fade, neither along nor across.
  w = run.until(33s, pressed);
  CHECK(w.data[0][2] == doctest::Approx(z).epsilon(0.01));
  CHECK(w.data[0][0] == doctest::Approx(x).epsilon(0.01));
  w = run.until(34s, offset);
  CHECK(std::abs(w.data[0][0]) + std::abs(w.data[0][2]) < 0.01);
}

TEST_CASE(
    "TrustedSkin of taxels: a shear sensor stuck at 15 N pushes nothing without pressure, wherever it "
    "began") {
  Run<Uskin> run(settings());
  const auto stuck = [](float pressure) {
    return [pressure](std::size_t i, Nanoseconds t) {
      return Taxels{i == 5 && t > 2s ? 15.0f : 0.0f, 0, pressure, 20};
    };
  };
  auto w = run.until(4s, stuck(0));
  CHECK(w.data[0][0] == 0);
  w = run.until(4s + 100ms, stuck(2));
  CHECK(w.data[0][0] <= 0.8 * 1.9);  // one cell's cone at most
}

TEST_CASE("TrustedSkin of taxels: one that is stuck is masked, and filled in along and across") {
  auto t = settings();
  t.noise = {{.force = 1.0f}};
  Run<Uskin> run(t);
  // Cell 5 sends one message again and again.
  const auto reading = [](std::size_t i, Nanoseconds time) {
    const float more = i == 5 ? 0.0f : 1e-3f * static_cast<float>((time / 4ms) % 7);
    const bool pressed = time > 5s;
    return i == 5 ? Taxels{0, 0, 9, 20} : Taxels{pressed ? 1.0f : 0.0f, 0, pressed ? 2.0f + more : more, 20};
  };
  run.noise = 0.02f;
  // Without noise on the stuck one.
  typename Run<Uskin>::S::Wrenches mean;
  for (; run.now < 6s; run.now += 4ms) {
    std::vector<SensorSample<Uskin>> samples;
    for (std::size_t i = 0; i < cells; ++i) {
      SensorSample<Uskin> sample{run.now + 2ms, static_cast<std::uint32_t>(i + 1), reading(i, run.now)};
      if (i != 5)
        for (float& x : sample.readings) x += 0.02f * static_cast<float>(uniform(run.rng, 0.0, 1.0));
      samples.push_back(sample);
    }
    run.skin.take(*run.memory,
                  TouchGiven{std::span<const CellSample>(), KindInput<Uskin>{samples}, State<6>{}, run.now,
                             run.now + 4ms, 1},
                  &mean);
  }
  CHECK(run.skin.faults(*run.memory, 5).has(CellFault::stuck));
  CHECK(run.skin.mask(*run.memory, 5) == 1);
  CHECK(run.skin.coverage(*run.memory).usable == cells - 1);
  CHECK(mean.data[0][2] == doctest::Approx(-16 * (2 - 0.2)).epsilon(0.05));
  CHECK(mean.data[0][0] == doctest::Approx(16 * 1.0).epsilon(0.05));
}

TEST_CASE(
    "TrustedSkin of taxels: one alone counts up to its lone force, and its shear within the cone of that") {
  Run<Uskin> run(settings(3));
  const auto lone = [](std::size_t i, Nanoseconds t) {
    const bool on = i == 5 && t > 2s;
    const float up = on ? static_cast<float>(std::min(10.0, 40 * seconds<double>(t - 2s))) : 0.0f;
    return Taxels{on ? up : 0.0f, 0, up, 20};
  };
  const auto w = run.until(3s, lone);
  CHECK(w.data[0][2] >= -3.001);
  CHECK(w.data[0][2] <= -2.9);
  CHECK(std::abs(w.data[0][0]) <= 0.8 * 3.001);
  CHECK(run.skin.max_proximity<2>(*run.memory) == 1);
}

TEST_CASE("TrustedSkin of hexagons with their forces apart: each force has its own rest level") {
  auto t = settings();
  Run<HexagonApart> run(t);
  run.noise = 0.0003f;
  const auto drifted = [](std::size_t, Nanoseconds time) {
    const float drift = 0.06f * static_cast<float>(std::min(1.0, seconds<double>(time) / 60));
    return std::array<float, 4>{drift, 0, 0, 0};
  };
  auto w = run.until(62s, drifted);
  CHECK(std::abs(w.data[0][2]) < 1e-6);
  CHECK(run.skin.rest(*run.memory, 3, 0) > 0.03);
  CHECK(std::abs(run.skin.rest(*run.memory, 3, 1)) < 0.002);
  CHECK(std::abs(run.skin.rest(*run.memory, 3, 2)) < 0.002);
  const auto pressed = [](std::size_t, Nanoseconds) { return std::array<float, 4>{0.06f, 0, 0.5f, 0.6f}; };
  w = run.until(63s, pressed);
  CHECK(w.data[0][2] == doctest::Approx(-16 * 0.49).epsilon(0.02));
}

TEST_CASE("TrustedSkin of several pressures: cells that were never heard keep their rest levels") {
  auto t = settings();
  t.noise = {{.force = 1.0f, .rest = 20}};
  const Run<HexagonApart> run(t);
  typename Run<HexagonApart>::S::Wrenches mean;
  const double before = run.skin.rest(*run.memory, 3);
  for (Nanoseconds now = 0ns; now < 60s; now += 4ms)
    run.skin.receive(*run.memory, std::span<const CellSample>(), KindInput<HexagonApart>{}, State<6>{}, now,
                     now + 4ms, 1, &mean);
  CHECK(before > 0);
  CHECK(run.skin.rest(*run.memory, 3) == before);
}
