#include "skinctl/sensing/cell_health.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>

#include "skinctl/sensing/send_on_delta.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "skinctl/testing/skin_signals.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using skinctl::SensorNoise;

namespace {

using Health = CellHealth<20>;
constexpr auto nobody = [](std::size_t) { return Health::Witness{}; };

/// A cell that reads `force` steps with each sensor, noise apart.
struct Sensed {
  explicit Sensed(double sigma, std::uint64_t seed = 1) : noise(sigma), normal(seed) {}
  double noise;
  Normal normal;
  double force = 20, scatter = 0;
  bool frozen = false, whole = false;
  CellSample last{};

  CellSample at(Nanoseconds t) {
    CellSample s;
    const auto steps = [&](double x) {
      return static_cast<float>(std::clamp(std::round(x + noise * normal()), 0.0, 1024.0) / 1024);
    };
    const double off = scatter * normal();
    for (float& f : s.force) f = frozen ? last.force[0] : steps(force + off);
    s.proximity = steps(50);
    for (float& a : s.acceleration) a = static_cast<float>(normal());
    s.temperature = 25;
    if (whole) s = last;
    last = s;
    s.time = t;
    return s;
  }
};

/// Time from `begin(cell)` until the mask is up by half; 0: never within 3 s.
template <class Begin, class Ask>
double found_after(double sigma, Nanoseconds period, std::uint64_t seed, CellFault fault, const Begin& begin,
                   const Ask& ask, const CellHealthSettings& settings = {}) {
  const SensorNoise noise{.force = float(sigma), .proximity = float(sigma), .rest = 20};
  const Health health(settings, std::span(&noise, 1));
  auto m = std::make_unique<Health::Memory>();
  Sensed cell(sigma, seed);
  for (Nanoseconds t = period; t <= 4s; t += period) {
    if (t >= 1s) begin(cell, t - 1s);
    health.take(*m, 17, cell.at(t));
    health.scan(*m, t, ask);
    if (t < 1s) REQUIRE_FALSE(Health::faults(*m, 17).any());
    if (Health::mask(*m, 17) > 0.5f) {
      CHECK(Health::faults(*m, 17).has(fault));
      return seconds<double>(t - 1s);
    }
  }
  return 0;
}

}  // namespace

TEST_CASE("CellHealth: each rule finds its fault in the time that it states, at any rate of the sensor") {
  for (const Nanoseconds period : {1ms, 4ms, 8ms}) {
    CAPTURE(period.count());
    const double t = seconds<double>(period);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const double stuck = found_after(
          0.7, period, seed, CellFault::stuck, [](Sensed& c, Nanoseconds) { c.frozen = true; }, nobody);
      CHECK(stuck > 30 * t);
      CHECK(stuck <= 36 * t + 0.05);
      const double message = found_after(
          0.7, period, seed, CellFault::stuck, [](Sensed& c, Nanoseconds) { c.whole = true; }, nobody);
      CHECK(message <= 5 * t + 0.05);
      const double top = found_after(
          2, period, seed, CellFault::saturated, [](Sensed& c, Nanoseconds) { c.force = 1010; }, nobody);
      CHECK(top > 0.2);
      CHECK(top <= 0.25 + 2 * t);
      const double noisy = found_after(
          0.7, period, seed, CellFault::noisy, [](Sensed& c, Nanoseconds) { c.scatter = 5; }, nobody);
      CHECK(noisy > 0);
      CHECK(noisy <= 0.25);
      const double blinking = found_after(
          0.7, period, seed, CellFault::blinking,
          [](Sensed& c, Nanoseconds since) { c.force = since.count() / 50'000'000 % 2 == 0 ? 500 : 20; },
          nobody);
      CHECK(blinking > 0.1);
      CHECK(blinking <= 0.3);
    }
  }
}

TEST_CASE(
    "CellHealth: witnesses clear a cell at its top and one that jumps; equal zeros and smooth pushes are no "
    "fault") {
  const auto touched = [](std::size_t) { return Health::Witness{.moved = true, .touched = true}; };
  CHECK(found_after(
            2, 4ms, 1, CellFault::saturated, [](Sensed& c, Nanoseconds) { c.force = 1010; }, touched) == 0);
  CHECK(found_after(2, 4ms, 1, CellFault::stuck, [](Sensed& c, Nanoseconds) { c.force = 2000; }, touched,
                    {.equal_messages = 0}) == 0);
  CHECK(found_after(
            2, 4ms, 1, CellFault::blinking,
            [](Sensed& c, Nanoseconds since) { c.force = since.count() / 100'000'000 % 2 == 0 ? 500 : 20; },
            touched) == 0);
  CHECK(found_after(
            0.7, 4ms, 1, CellFault::noisy,
            [](Sensed& c, Nanoseconds since) {
              c.force = 20 + 300 * (1 - std::cos(10 * seconds<double>(since)));
            },
            nobody) == 0);
  // A tap that nobody else feels, each of whose two edges takes two samples, jumps twice.
  CHECK(found_after(
            0.7, 4ms, 1, CellFault::blinking,
            [](Sensed& c, Nanoseconds since) {
              c.force = since < 4ms ? 58 : since < 48ms ? 220 : since < 52ms ? 182 : 20;
            },
            nobody) == 0);
  // A sensor whose rest is 0 sends exact zeros while it is healthy.
  const SensorNoise clipped{.force = 0.4f, .rest = 0};
  const Health health({}, std::span(&clipped, 1));
  Health::Memory m;
  Sensed cell(0.4);
  cell.force = -5;
  for (Nanoseconds t = 4ms; t <= 2s; t += 4ms) health.take(m, 3, cell.at(t)), health.scan(m, t, nobody);
  CHECK_FALSE(Health::faults(m, 3).any());
}

TEST_CASE(
    "CellHealth: of a cell whose readings may repeat, equal ones are no fault, and equal messages are") {
  for (const bool repeats : {false, true}) {
    CAPTURE(repeats);
    const SensorNoise noise{.force = 20,
                            .repeats = repeats};  // much: the more, the fewer equal ones make a fault
    const Health health({}, std::span(&noise, 1));
    const auto m = std::make_unique<Health::Memory>();
    Sensed cell(0);
    const auto run = [&](Nanoseconds from, Nanoseconds until) {
      for (Nanoseconds t = from + 4ms; t <= until; t += 4ms) {
        health.take(*m, 17, cell.at(t));
        health.scan(*m, t, nobody);
      }
    };
    run(0ms, 1s);
    cell.force = 500;  // a press of one second, without a change
    run(1s, 2s);
    CHECK(Health::faults(*m, 17).any() != repeats);
    if (!repeats) continue;
    cell.whole = true;
    run(2s, 2500ms);
    CHECK(Health::faults(*m, 17).has(CellFault::stuck));
  }
}

TEST_CASE(
    "CellHealth: a cell that says its unrest is frozen without any, and else healthy whatever it repeats") {
  const Unrest unrest;
  // Each 100 ms one message, at rest or pressed; returns when the cell is masked by half, 0: never in 20 s.
  const auto masked_at = [&](double sigma, double declared, double force, Nanoseconds freezes,
                             bool constant) {
    const SensorNoise noise{.force = float(declared), .rest = 20};
    const Health health({.delta = 2}, std::span(&noise, 1));
    const auto m = std::make_unique<Health::Memory>();
    Unrest<>::Memory meter;
    Sensed cell(sigma);
    for (Nanoseconds t = 4ms; t <= 20s; t += 4ms) {
      cell.force = force, cell.frozen = t >= freezes;
      CellSample s = cell.at(t);
      unrest.measure(meter, s);
      if (t % 100ms == 0ns) {
        unrest.tell(meter, s);
        if (constant) s.force = {0.1f, 0.1f, 0.1f}, s.acceleration = {}, s.proximity = 0;  // filtered, say
        health.take(*m, 17, s);
      }
      health.scan(*m, t, nobody);
      if (Health::mask(*m, 17) > 0.5f) {
        CHECK(Health::faults(*m, 17).has(CellFault::stuck));
        return seconds<double>(t - (freezes < 20s ? freezes : 0ns));
      }
    }
    return 0.0;
  };
  for (const double sigma : {0.31, 0.4, 0.7, 2.0})
    for (const double force : {20.0, 20.5, 300.0}) {
      CAPTURE(sigma);
      CAPTURE(force);
      CHECK(masked_at(sigma, sigma, force, 60s, false) == 0);
      CHECK(masked_at(sigma, sigma, force, 60s, true) == 0);
      const double found = masked_at(sigma, sigma, force, 2s, false);
      CHECK(found > 0);
      CHECK(found <= 0.004 * Stillness::frozen_after(sigma, 3) + 0.2);
    }
  CHECK(masked_at(0.31, 0.4, 20, 60s, false) == 0);  // quieter by a quarter than declared
  CHECK(masked_at(0, 0.3, 20, 60s, false) == 0);     // a sensor that may stand still
}

TEST_CASE(
    "Unrest: measurements since the last message, and 512 sigma^2; rounded up, and never what says nothing") {
  const Unrest unrest;
  Unrest<>::Memory m;
  const auto told = [&] {
    CellSample s;
    unrest.tell(m, s);
    return std::pair(s.measured, s.unrest);
  };
  CellSample s;
  CHECK(told() == std::pair(std::uint16_t(0), unsaid));
  unrest.measure(m, s);
  CHECK(told() == std::pair(std::uint16_t(1), unsaid));  // nothing to compare with
  unrest.measure(m, s);
  CHECK(told() == std::pair(std::uint16_t(1), std::uint16_t(0)));
  for (int k = 0; k < 70000; ++k) unrest.measure(m, s);
  s.force[1] = 1.0f / 1024;
  unrest.measure(m, s);
  CHECK(told() == std::pair(Unrest<>::most, std::uint16_t(1)));  // one step in 70 001
  s.force = {1, 1, 1};
  unrest.measure(m, s);
  CHECK(told() == std::pair(std::uint16_t(1), Unrest<>::most));
  s.force[0] = std::numeric_limits<float>::quiet_NaN();
  unrest.measure(m, s);
  CHECK(told() == std::pair(std::uint16_t(1), Unrest<>::most));
  Sensed cell(0.7);
  m = {};
  for (Nanoseconds t = 0ns; t < 40s; t += 4ms) unrest.measure(m, cell.at(t));
  CHECK(told().second == doctest::Approx(512 * (0.49 + 1.0 / 12)).epsilon(0.05));
  CHECK_THROWS_AS(Unrest<>(0), ConfigurationError);

  Stillness still;
  s = {};
  still.take(s);
  CHECK(still.measurements == 0);  // does not say
  s.measured = 60000, s.unrest = 0;
  still.take(s), still.take(s);
  CHECK(still.measurements == 65534);
  s.unrest = 1;
  still.take(s);
  CHECK(still.measurements == 0);
}

TEST_CASE("CellHealth: a cell that sends changes only is not noisy because of their steps") {
  const SensorNoise noise{.force = 0.31f, .rest = 20};
  const SendOnDelta sends({});
  const auto noisy = [&](double delta, double sigma, double size) {
    CellHealthSettings settings;
    settings.delta = delta;
    const Health health(settings, std::span(&noise, 1));
    Health::Memory m;
    SendOnDelta::Memory sender;
    Sensed cell(sigma);
    int found = 0;
    for (Nanoseconds t = 4ms; t <= 20s; t += 4ms) {
      // It trembles by a few steps.
      const double x = seconds<double>(t);
      cell.force = 20 + size * (1 + std::sin(6.2832 * 15 * x));
      CellSample s = cell.at(t);
      for (float& a : s.acceleration) a *= 0.02f;
      if (sends.send(sender, s)) health.take(m, 3, s);
      health.scan(m, t, nobody);
      found += Health::faults(m, 3).has(CellFault::noisy) ? 1 : 0;
    }
    return found;
  };
  CHECK(noisy(0, 0.31, 6) > 4000);
  for (const double size : {1.0, 3.0, 6.0, 12.0, 100.0}) CHECK(noisy(2, 0.31, size) == 0);
  CHECK(noisy(2, 40, 6) > 4000);
}

TEST_CASE("CellHealth: a cell that is let go, and then sends keep-alives only, is not noisy") {
  const SensorNoise noise{.force = 1.5f, .rest = 20};
  for (const double size : {10.0, 30.0, 100.0, 500.0})
    for (const Nanoseconds alive : {20ms, 40ms, 100ms, 200ms})
      for (const double falls : {1.0, 3.0, 10.0}) {  // samples until it is let go
        const Health health({.equal_messages = 0}, std::span(&noise, 1));
        auto m = std::make_unique<Health::Memory>();
        Sensed cell(1.5);
        Nanoseconds sent{};
        int found = 0;
        for (Nanoseconds t = 4ms; t <= 12s; t += 4ms) {
          const std::int64_t tick = t / 4ms, of = tick % 300;  // pressed for 0.6 s of each 1.2 s
          cell.force =
              20 + size * std::clamp(std::min(double(of) / 10, (150 - double(of)) / falls), 0.0, 1.0);
          const CellSample s = cell.at(t);
          if (of < 150 + 3 || t - sent >= alive) {
            health.take(*m, 5, s);
            sent = t;
          }
          health.scan(*m, t, [](std::size_t) { return Health::Witness{.moved = true, .touched = true}; });
          found += Health::faults(*m, 5).has(CellFault::noisy) ? 1 : 0;
        }
        CAPTURE(size);
        CAPTURE(alive.count());
        CAPTURE(falls);
        CHECK(found == 0);
      }
}

TEST_CASE(
    "CellHealth: masks fade in within 50 ms, out within 250 after 2 s without finding, 10 s if it blinked") {
  for (const bool blinks : {false, true}) {
    const SensorNoise noise{.force = 0.7f, .rest = 20};
    const Health health({}, std::span(&noise, 1));
    Health::Memory m;
    Sensed cell(0.7);
    double up = 0, full = 0, down = 0, gone = 0;
    for (Nanoseconds t = 4ms; t <= 16s; t += 4ms) {
      const bool faulty = t >= 1s && t < 2s;
      cell.whole = faulty && !blinks;
      cell.force = faulty && blinks && t.count() / 60'000'000 % 2 == 0 ? 500 : 20;
      health.take(m, 0, cell.at(t));
      health.scan(m, t, nobody);
      const float mask = Health::mask(m, 0);
      const double now = seconds<double>(t);
      if (mask > 0 && up == 0) up = now;
      if (mask == 1) full = full == 0 ? now : full, down = now;
      if (mask > 0) gone = now;
    }
    CAPTURE(blinks);
    CHECK(full - up <= 0.05);
    CHECK(full - up >= 0.04);
    CHECK(gone - down == doctest::Approx(0.25).epsilon(0.05));
    CHECK(down - 2 >= (blinks ? 10 : 2) - 0.01);
    CHECK(down - 2 <= (blinks ? 12 : 2.1));
  }
}

TEST_CASE("CellHealth: the scan's statistics are those of a cell alone, computed in double") {
  Normal normal(7);
  const SensorNoise noise{.force = 1.5f};
  const Health health({}, std::span(&noise, 1));
  const double per = 1 / std::sqrt(3 * (2.25 + 1.0 / 12));
  auto m = std::make_unique<Health::Memory>();
  struct Known {
    double x = 0, d = 0, gap = 0, first = 0, second = 0, capped = 0, still = 0;
    bool heard = false;
  };
  std::vector<Known> known(20);
  Nanoseconds t{};
  double worst = 0;
  for (int frame = 0; frame < 2000; ++frame) {
    const Nanoseconds dt = 1ms * (1 + frame % 9);
    t += dt;
    const double s = frame == 0 ? 0 : seconds<double>(dt);
    for (std::size_t i = 0; i < 20; ++i) {
      Known& k = known[i];
      k.gap += s, k.still += s;
      if (normal.between(0.0, 1.0) < 0.3) continue;
      CellSample sample;
      const double level = frame % 400 < 200 ? 40 : 90;
      for (float& f : sample.force) f = static_cast<float>(std::round(level + 1.5 * normal()) / 1024);
      sample.proximity = static_cast<float>(normal.between(0.0, 1.0));
      sample.acceleration[0] = static_cast<float>(frame);
      health.take(*m, i, sample);
      double x = 0;
      for (const float f : sample.force) x += 1024.0 * double(f);
      if (!k.heard) k.x = x, k.heard = true, k.gap = s;  // the first sample has no predecessor
      const bool silent = k.gap > std::max(0.03, 3 * s);
      const double d = x - k.x, dd = silent ? 2 * std::min(std::abs(d), std::abs(k.d)) : d - k.d;
      const double a = d * per, b = dd * per, share = std::min(k.gap / 0.2, 1.0);
      k.first += share * (a * a - k.first), k.second += share * (b * b - k.second);
      k.capped += share * ((d * k.d < 0 ? std::min(b * b, 256.0) : 0.0) - k.capped);
      if (std::abs(a) > 6) k.still = 0;
      k.x = x, k.d = d, k.gap = 0;
    }
    health.scan(*m, t, nobody);
    for (std::size_t i = 0; i < 20; ++i) {
      const auto& row = m->row[i / 16];
      const auto compare = [&](float have, double want) {
        worst = std::max(worst, std::abs(double(have) - want) / (1 + std::abs(want)));
      };
      compare(row.first[i % 16], known[i].first), compare(row.second[i % 16], known[i].second);
      compare(row.capped[i % 16], known[i].capped);
      if (known[i].heard && known[i].still < 50) compare(row.still[i % 16], known[i].still);
    }
  }
  CHECK(worst <= 2e-5);
}

TEST_CASE("CellHealth: healthy noise masks nobody; settings out of range are refused") {
  for (const double sigma : {0.4, 0.7, 2.0, 8.0}) {
    const SensorNoise noise{.force = float(sigma), .proximity = 1, .rest = 60};
    const Health health({.equal_messages = 0}, std::span(&noise, 1));
    auto m = std::make_unique<Health::Memory>();
    Normal normal(11);
    int found = 0;
    for (Nanoseconds t = 4ms; t <= (sanitized ? 10s : 100s); t += 4ms) {
      for (std::size_t i = 0; i < 20; ++i) {
        CellSample s;
        for (float& f : s.force)
          f = static_cast<float>(std::clamp(std::round(60.3 + sigma * normal()), 0.0, 1024.0) / 1024);
        health.take(*m, i, s);
      }
      health.scan(*m, t, nobody);
      for (std::size_t i = 0; i < 20; ++i) found += Health::faults(*m, i).any();
    }
    CAPTURE(sigma);
    CHECK(found == 0);
  }
  const auto refused = [](const CellHealthSettings& s, const SensorNoise& n) {
    CHECK_THROWS_AS(Health(s, std::span(&n, 1)), ConfigurationError);
  };
  refused({.step = 0}, {}), refused({.equal_messages = 1}, {}), refused({.top = 1.1}, {});
  refused({.fade_in = 0ns}, {}), refused({.hold = -1s}, {}), refused({}, {.force = -1}),
      refused({}, {.rest = 2000});
  const std::vector<SensorNoise> three(3);
  CHECK_THROWS_AS(Health({}, three), ConfigurationError);
}

TEST_CASE("CellHealth: memories are equal only if all that they remember is") {
  const auto differs = [](auto&& change) {
    const auto a = std::make_unique<Health::Memory>(), b = std::make_unique<Health::Memory>();
    CHECK(*a == *b);
    change(*b);
    CHECK_FALSE(*a == *b);
    CHECK_FALSE(*b == *a);
  };
  differs([](auto& m) { m.time = 1ns; });
  differs([](auto& m) { m.record[17].known = true; });
  differs([](auto& m) { m.record[17].faults |= CellFault::stuck; });
  differs([](auto& m) { m.suspect[1] = 2; });
  differs([](auto& m) { m.fresh[1] = 2; });
  differs([](auto& m) { m.at_top[1] = 2; });
  differs([](auto& m) { m.jumped[1] = 2; });
  differs([](auto& m) { m.row[1].mask[1] = 1; });
}

TEST_CASE("CellHealth: a cell that blinks faster than its witnesses have time is found as well") {
  for (const std::int64_t half : {6, 10})
    for (const Nanoseconds period : {1ms, 2ms}) {
      CAPTURE(half);
      CAPTURE(period.count());
      const double blinking = found_after(
          0.7, period, 1, CellFault::blinking,
          [&](Sensed& c, Nanoseconds since) {
            c.force = since.count() / 1'000'000 / half % 2 == 0 ? 500 : 20;
          },
          nobody);
      CHECK(blinking > 0);
      CHECK(blinking <= 0.3);
    }
}
