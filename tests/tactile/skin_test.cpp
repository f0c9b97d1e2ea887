// runs long: a day of contact
#include "skinctl/tactile/skin.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/random_skin.hpp"
#include "tests/support/robots.hpp"
#include "tests/tactile/skin_oracle.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

CellSample sample(std::uint32_t cell, Nanoseconds time, float force, float proximity = 0) {
  CellSample s;
  s.cell = cell;
  s.time = time;
  s.force = {force, force, force};
  s.proximity = proximity;
  return s;
}

/// A skin that lets everything pass: readings are forces, so that closed forms apply.
SkinSettings open_gates() {
  SkinSettings settings;
  settings.force = EventGate<>();
  settings.proximity = EventGate<>();
  return settings;
}

/// One cell on link 2, whose push is along -z of the link: the force's z component tells all.
template <class T = double>
struct OneCell {
  using S = Skin<ur5::Model, T, Patch<2, 1>>;
  S skin;
  typename S::Memory memory;

  explicit OneCell(const SkinSettings& settings = open_gates(), const CellGains& gains = {10, 4})
      : skin(Patch<2, 1>({{7, Transform<Link<2>, Cell>::translation_xyz(0.1, 0.05, 0.02)}}, gains), settings),
        memory(skin.start(0ns)) {}

  /// The mean push [N] over the interval.
  T push(std::vector<CellSample> samples, Nanoseconds from, Nanoseconds to, Status* status = nullptr) {
    typename S::Wrenches mean;
    const Status s = skin.receive(memory, samples, from, to, 1, &mean);
    if (status) *status = s;
    return -mean.data[0][2];
  }
};

/// Random readings of some cells, at their own jittered times, some of which fall silent for a while.
struct Stream {
  std::vector<CellSample> samples;  ///< in the order of their arrival
  std::vector<Nanoseconds> arrivals;
};
Stream random_stream(Random& rng, const std::vector<std::uint32_t>& ids, Nanoseconds begin, Nanoseconds end,
                     Nanoseconds latency) {
  std::vector<std::pair<Nanoseconds, CellSample>> all;
  for (const std::uint32_t id : ids) {
    Nanoseconds t = begin + Nanoseconds(rng() % 4000000u);
    while (t < end) {
      CellSample s = sample(id, t, 0.0f);
      for (float& f : s.force) f = float(rng() % 1025) / 1024.0f;
      s.proximity = float(rng() % 65536) / 65536.0f;
      all.push_back({t + latency, s});
      const bool silent = rng() % 12 == 0;
      t += 3500us + Nanoseconds(rng() % 1000000u) + (silent ? Nanoseconds(rng() % 400000000u) : 0ns);
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  Stream stream;
  for (const auto& [arrival, s] : all) stream.arrivals.push_back(arrival), stream.samples.push_back(s);
  return stream;
}

template <class T, std::size_t N>
T largest(const T (&row)[N]) {
  T most(0);
  for (const T& x : row) most = std::max(most, std::abs(x));
  return most;
}

}  // namespace

using Small = Skin<ur5::Model, double, Patch<1, 3>, Patch<2, 70>, Patch<5, 1>>;
static_assert(std::is_trivially_copyable_v<Small::Memory>);
static_assert(Small::links == 0b100110 && Small::cells == 74 && Small::patches == 3);
static_assert(sizeof(Ur5Skin<10000>::Memory) <= 10000 * 17);

TEST_CASE_TEMPLATE("Skin: held samples are the per-cell Jacobian form", T, SKINCTL_SCALARS) {
  Random rng = seeded(1);
  const CellGains gains{12, 3};
  const auto patches = random_patches(rng, gains, std::index_sequence<0, 1, 2, 2, 4, 5>{},
                                      std::index_sequence<1, 8, 33, 17, 16, 7>{});
  const auto skin = std::apply(
      [](const auto&... p) {
        return Skin<ur5::Model, T, std::remove_cvref_t<decltype(p)>...>(p..., open_gates());
      },
      patches);
  const ur5::Model model;
  double worst = 0, worst_of_rounded = 0;
  for (int k = 0; k < 50; ++k) {
    auto memory = skin.start(0ns);
    const auto q = random_position<6, T>(rng);
    const auto poses = link_poses(model, q.template cast<Digits50>());
    std::vector<CellSample> samples;
    JointTorque<6, Digits50> exact;
    LinkWrenches<ur5::Model, std::remove_cvref_t<decltype(skin)>::links, Digits50> rounded;
    Digits50 magnitude(0);
    for_each_index<6>([&](auto n) {
      const auto& patch = std::get<n.value>(patches);
      constexpr std::size_t I = std::remove_cvref_t<decltype(patch)>::link;
      for (const auto& cell : patch.placed()) {
        samples.push_back(sample(cell.id, 1ms, float(rng() % 1025) / 1024, float(rng() % 65536) / 65536));
        const auto& s = samples.back();
        const Digits50 newton =
            Digits50(gains.force) * (Digits50(s.force[0]) + Digits50(s.force[1]) + Digits50(s.force[2])) +
            Digits50(gains.proximity) * Digits50(s.proximity);
        const auto tau = torque_of_cell<I>(poses, model, cell.X_LC.template cast<Digits50>(), newton);
        exact += tau;
        for (const Digits50& t : tau) magnitude += abs(t);
        // The same with the unit wrench that the skin stores: multiples of 2^-24 (moments here below 0.5 m:
        // finer).
        const auto u = unit_wrench(cell.X_LC);
        auto sum = rounded.template wrench<I>();
        const auto whole = [](double x, double steps) { return Digits50(std::round(x * steps) / steps); };
        const double f = std::ldexp(1.0, 24);
        double most = 0;
        for (const auto& other : patch.placed()) {
          const auto m = unit_wrench(other.X_LC).moment;
          most = std::max({most, std::abs(m.x), std::abs(m.y), std::abs(m.z)});
        }
        const double g = std::ldexp(1.0, 24 - static_cast<int>(std::ceil(std::log2(most))));
        sum.force =
            sum.force + newton * Xyz<Digits50>{whole(u.force.x, f), whole(u.force.y, f), whole(u.force.z, f)};
        sum.moment = sum.moment +
                     newton * Xyz<Digits50>{whole(u.moment.x, g), whole(u.moment.y, g), whole(u.moment.z, g)};
        rounded.template set<I>(sum);
      }
    });
    typename std::remove_cvref_t<decltype(skin)>::Wrenches mean;
    CHECK_FALSE(skin.receive(memory, samples, 0ns, 20ms, 1, &mean).any());
    const auto tau = skin_torque(model, q, skin.wrenches(memory));
    const auto tau_rounded = skin_torque(model, q.template cast<Digits50>(), rounded);
    for (std::size_t j = 0; j < 6; ++j) {
      worst = std::max(worst, static_cast<double>(abs(Digits50(tau[j]) - exact[j]) / magnitude));
      worst_of_rounded =
          std::max(worst_of_rounded, static_cast<double>(abs(Digits50(tau[j]) - tau_rounded[j]) / magnitude));
    }
  }
  CAPTURE(worst);
  CAPTURE(worst_of_rounded);
  CHECK(worst <= 1e-7);
  CHECK(worst_of_rounded <= (std::same_as<T, double> ? 1e-15 : 1e-7));
}

TEST_CASE("Skin: the force on a cell is held, ramps, fades and is over, as stated") {
  OneCell one;  // 10 N per unit of the sum of three, 4 N per unit of proximity
  CHECK(one.push({}, 0ns, 20ms) == 0);
  // The ramp of 6 ms before the sample at 30 ms, then held: 20 to 30 ms hold a mean of 15 N * 3/10.
  CHECK(one.push({sample(7, 30ms, 0.5f)}, 20ms, 30ms) == doctest::Approx(15 * 0.3).epsilon(1e-12));
  CHECK(one.push({}, 30ms, 40ms) == doctest::Approx(15).epsilon(1e-12));
  // Told at 42 ms, seen by the interval that ends at 50 ms: 40 to 42 is made up for; from 36 on it was
  // rising.
  const double missed = 5 * 6e-3 / 2 - 0.0;
  CHECK(one.push({sample(7, 42ms, 2.0f / 3)}, 40ms, 50ms) ==
        doctest::Approx(15 + (missed + 5 * 8e-3) / 10e-3).epsilon(1e-7));
  CHECK(one.push({}, 50ms, 242ms) == doctest::Approx(20).epsilon(1e-6));
  // 200 ms after the sample it begins to fade, 250 ms after it is over.
  CHECK(one.push({}, 242ms, 252ms) == doctest::Approx(20 * 0.9).epsilon(1e-6));
  CHECK(one.push({}, 252ms, 282ms) == doctest::Approx(20 * 0.5).epsilon(1e-6));
  Status status;
  CHECK(one.push({}, 282ms, 300ms, &status) == doctest::Approx(20 * 0.1 * 10 / 18).epsilon(1e-6));
  CHECK(status == Status(Reason::sample_stale));
  CHECK(one.skin.silent(one.memory) == 1);
  CHECK(one.push({}, 300ms, 301ms, &status) == 0);
  CHECK(one.push({}, 301ms, 100s, &status) == 0);
  CHECK(status == Status(Reason::sample_stale));
  // Proximity pushes too; the sign is the same.
  CHECK(one.push({sample(7, 100s + 6ms, 0.0f, 0.5f)}, 100s, 100s + 6ms, &status) ==
        doctest::Approx(1).epsilon(1e-6));
  CHECK_FALSE(status.any());
}

TEST_CASE("Skin: a gate with hysteresis is closed again after a silence") {
  SkinSettings settings = open_gates();
  settings.force = EventGate<>::hysteresis(0.9, 0.3);
  OneCell one(settings);
  CHECK(one.push({sample(7, 10ms, 0.2f)}, 0ns, 20ms) == 0);
  one.push({sample(7, 30ms, 0.4f)}, 20ms, 40ms);
  one.push({sample(7, 50ms, 0.2f)}, 40ms, 60ms);
  CHECK(one.push({}, 60ms, 70ms) == doctest::Approx(6).epsilon(1e-4));
  one.push({}, 70ms, 400ms);
  CHECK(one.push({sample(7, 405ms, 0.2f)}, 400ms, 410ms) == 0);
  CHECK(one.push({}, 410ms, 420ms) == 0);
}

TEST_CASE_TEMPLATE("Skin: a contact held for a day does not fade", T, SKINCTL_SCALARS) {
  OneCell<T> one;
  one.push({sample(7, 0ns, 0.3f)}, 0ns, 100ms);
  const T first = one.push({sample(7, 200ms, 0.3f)}, 100ms, 200ms);
  bool same = first > T(8.9);
  for (Nanoseconds t = 200ms; t < 86400s; t += 100ms)
    same = same && one.push({sample(7, t + 100ms, 0.3f)}, t, t + 100ms) == first;
  CHECK(same);
}

TEST_CASE_TEMPLATE("Skin: the impulse is that of the force, whatever the rate of the cycle", T,
                   SKINCTL_SCALARS) {
  // Cells with a lever each; forces and proximities; silences up to 400 ms; latencies up to 12 ms.
  Random rng = seeded(2);
  const SkinSettings settings = open_gates();
  const CellGains gains{9, 5};
  const auto patch_a = random_patch<1, 3>(rng, 1, gains);
  const auto patch_b = random_patch<4, 2>(rng, 11, gains);
  const Skin<ur5::Model, T, Patch<1, 3>, Patch<4, 2>> skin(patch_a, patch_b, settings);
  using W = typename decltype(skin)::Wrenches;
  const std::vector<std::uint32_t> ids = {1, 2, 3, 11, 12};
  const Nanoseconds end = 4s;
  for (const Nanoseconds latency : {0ms, 3ms, 12ms}) {
    const Stream stream = random_stream(rng, ids, 60ms, end - 100ms, latency);
    long double expected[5];
    for (std::size_t c = 0; c < 5; ++c) {
      std::vector<Knot> knots;
      for (const CellSample& s : stream.samples)
        if (s.cell == ids[c]) {
          const CellCounts n = counts(s);
          knots.push_back({s.time, gains.force * n.force * CellCounts::force_unit +
                                       gains.proximity * n.proximity * CellCounts::proximity_unit});
        }
      expected[c] = CellSignal(knots, settings.max_age, settings.fade, settings.ramp).impulse(0ns, end);
    }
    for (const int rate : {125, 250, 500, 1000, 0, -1}) {
      for (const std::size_t substeps : {std::size_t(1), std::size_t(3)}) {
        // Rates; 0: jittered with skipped cycles; -1: the same with intervals of no length in between, which
        // take what came in the last millisecond.
        Random jitter = seeded(7);
        auto memory = skin.start(0ns);
        long double impulse[2][6] = {};
        std::size_t next = 0;
        for (Nanoseconds from{}; from < end;) {
          Nanoseconds to =
              from + (rate > 0 ? Nanoseconds(1s) / rate : 200us + Nanoseconds(jitter() % 9000000u));
          if (rate <= 0 && jitter() % 20 == 0) to += 17ms;
          if (rate < 0 && jitter() % 3 == 0) to = from;
          to = std::min(to, end);
          const std::size_t first = next;
          const Nanoseconds until = rate < 0 && from < to ? to - 1ms : to;
          while (next < stream.samples.size() && stream.arrivals[next] <= until) ++next;
          W means[3];
          const Status status = skin.receive(memory, std::span(stream.samples).subspan(first, next - first),
                                             from, to, substeps, means);
          REQUIRE_FALSE((status.has(Reason::time_backwards) || status.has(Reason::sample_not_finite)));
          REQUIRE(status.has(Reason::interval_empty) == (from == to));
          const long double h =
              static_cast<long double>((to - from).count()) * 1e-9L / static_cast<long double>(substeps);
          for (std::size_t j = 0; j < substeps; ++j)
            for (std::size_t l = 0; l < 2; ++l)
              for (std::size_t r = 0; r < 6; ++r)
                impulse[l][r] += h * static_cast<long double>(means[j].data[l][r]);
          from = to;
        }
        CHECK(next == stream.samples.size());
        double worst = 0;
        const auto add = [&](const auto& patch, std::size_t l, std::size_t offset) {
          long double total[6] = {}, magnitude = 0;
          for (std::size_t i = 0; i < patch.cells; ++i) {
            const auto u = unit_wrench(patch.placed()[i].X_LC);
            const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
            for (std::size_t r = 0; r < 6; ++r)
              total[r] += static_cast<long double>(static_cast<float>(row[r])) * expected[offset + i];
            magnitude += expected[offset + i];
          }
          for (std::size_t r = 0; r < 6; ++r)
            worst = std::max(worst, static_cast<double>(std::abs(impulse[l][r] - total[r]) / magnitude));
        };
        add(patch_a, 0, 0);
        add(patch_b, 1, 3);
        CAPTURE(latency);
        CAPTURE(rate);
        CAPTURE(substeps);
        CHECK(worst <= (std::same_as<T, double> ? 1e-7 : 3e-6));
      }
    }
  }
}

TEST_CASE("Skin: rates agree with each other to rounding") {
  Random rng = seeded(3);
  const auto patch = random_patch<3, 4>(rng, 1, {9, 5});
  const Skin<ur5::Model, double, Patch<3, 4>> skin(patch, SkinSettings{});
  const Stream stream = random_stream(rng, {1, 2, 3, 4}, 60ms, 2s, 2ms);
  double reference[6] = {};
  for (const int rate : {125, 250, 500, 1000, 333}) {
    auto memory = skin.start(0ns);
    double impulse[6] = {};
    std::size_t next = 0;
    for (Nanoseconds from{}; from < 3s;) {
      const Nanoseconds to = std::min(from + Nanoseconds(1s) / rate, Nanoseconds(3s));
      const std::size_t first = next;
      while (next < stream.samples.size() && stream.arrivals[next] <= to) ++next;
      decltype(skin)::Wrenches mean;
      skin.receive(memory, std::span(stream.samples).subspan(first, next - first), from, to, 1, &mean);
      for (std::size_t r = 0; r < 6; ++r) impulse[r] += seconds<double>(to - from) * mean.data[0][r];
      from = to;
    }
    for (std::size_t r = 0; r < 6; ++r) {
      if (rate == 125) reference[r] = impulse[r];
      CHECK(std::abs(impulse[r] - reference[r]) <= 1e-13 * largest(reference));
    }
  }
  CHECK(largest(reference) > 1);
}

TEST_CASE("Skin: events leave bit for bit what the sum over all cells gives, after 1e7 of them") {
  const auto skin = ur5_skin<260>({10, 3});
  auto memory = skin.start(0ns);
  Random rng = seeded(4);
  decltype(skin)::Wrenches mean;
  std::vector<CellSample> samples(1000);
  Nanoseconds t{};
  long events = 0;
  bool same = true;
  for (int round = 0; round < 10000; ++round) {
    for (CellSample& s : samples) {
      s = sample(1 + static_cast<std::uint32_t>(rng() % 260), t += 1us, 0.0f);
      const std::uint64_t bits = rng();
      s.force = {float(bits % 1025) / 1024, float((bits >> 16) % 1025) / 1024,
                 float((bits >> 32) % 1025) / 1024};
      s.proximity = float((bits >> 44) % 65536) / 65536;
    }
    skin.receive(memory, samples, t - 1ms, t, 1, &mean);
    events += 1000;
    if (round % 100 == 0) same = same && skin.recomputed(memory) == memory;
  }
  CHECK(same);
  CHECK(events == 10000000);
  CHECK(skin.recomputed(memory) == memory);
  // All released: exactly nothing is left.
  for (std::uint32_t id = 1; id <= 260; ++id) samples[id] = sample(id, t + 1us, 0.0f);
  skin.receive(memory, std::span(samples).subspan(1, 260), t, t + 1us, 1, &mean);
  CHECK(skin.wrenches(memory) == decltype(skin)::Wrenches{});
  skin.receive(memory, {}, t + 1us, t + 2us, 1, &mean);
  CHECK(mean == decltype(skin)::Wrenches{});
}

TEST_CASE("Skin: the order of cells within an interval does not matter, to the bit for what is held") {
  const auto skin = ur5_skin<260>({10, 3});
  Random rng = seeded(5);
  std::vector<CellSample> samples;
  for (std::uint32_t id = 1; id <= 260; ++id)
    samples.push_back(sample(id, 5ms, float(rng() % 1025) / 1024, float(rng() % 1025) / 1024));
  auto a = skin.start(0ns), b = skin.start(0ns);
  decltype(skin)::Wrenches mean_a, mean_b;
  skin.receive(a, samples, 0ns, 8ms, 1, &mean_a);
  std::shuffle(samples.begin(), samples.end(), rng);
  skin.receive(b, samples, 0ns, 8ms, 1, &mean_b);
  CHECK(a == b);
  for (std::size_t l = 0; l < 6; ++l)
    for (std::size_t r = 0; r < 6; ++r)
      CHECK(std::abs(mean_a.data[l][r] - mean_b.data[l][r]) <= 1e-13 * (1 + std::abs(mean_a.data[l][r])));
}

TEST_CASE("Skin: stale, duplicate, late, early and unknown samples never push and are reported") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  OneCell one;
  Status status;
  const double held = one.push({sample(7, 5ms, 0.5f)}, 0ns, 10ms), steady = one.push({}, 10ms, 20ms, &status);
  CHECK(held > 0);
  CHECK_FALSE(status.any());
  const auto before = one.memory;
  const auto refused = [&](CellSample s, Reason why) {
    CHECK(one.push({s}, 20ms, 30ms, &status) == steady);
    CHECK(status == Status(why));
    CHECK(one.memory == before);
  };
  refused(sample(7, 5ms, 1.0f), Reason::time_backwards);  // a duplicate stamp
  refused(sample(7, 4ms, 1.0f), Reason::time_backwards);
  refused(sample(7, Nanoseconds::min(), 1.0f), Reason::time_backwards);
  refused(sample(7, 32ms + 1ns, 1.0f), Reason::sample_out_of_range);
  refused(sample(7, Nanoseconds::max(), 1.0f), Reason::sample_out_of_range);
  refused(sample(8, 25ms, 1.0f), Reason::sample_unknown);
  refused(sample(0xFFFFFFFFu, 25ms, 1.0f), Reason::sample_unknown);
  refused(sample(7, 25ms, nan), Reason::sample_not_finite);
  refused(sample(7, 25ms, 0.5f, nan), Reason::sample_not_finite);
  refused(sample(7, 25ms, -0.1f), Reason::sample_out_of_range);
  refused(sample(7, 25ms, 1.1f), Reason::sample_out_of_range);
  CellSample hot = sample(7, 25ms, 1.0f);
  hot.temperature = nan;
  refused(hot, Reason::sample_not_finite);
  // A little ahead counts as the interval's end; then its twin is not later.
  CHECK(one.push({sample(7, 31ms, 0.5f)}, 20ms, 30ms, &status) == steady);
  CHECK_FALSE(status.any());
  one.push({sample(7, 30ms, 1.0f)}, 20ms, 30ms, &status);
  CHECK(status == Status(Reason::time_backwards));
  // A cell that was never heard, and whose sample took longer than max_age.
  OneCell late;
  CHECK(late.push({sample(7, 10ms, 1.0f)}, 255ms, 260ms, &status) == 0);
  CHECK(status == Status(Reason::sample_stale));
}

namespace {
/// A front end that sets readings: those of samples to `read` times theirs, those of heard cells to `set`.
struct Judge {
  float share = 1;
  std::vector<std::pair<std::size_t, CellCounts>> set{};
  mutable int asked = 0, settled = 0;

  CellCounts reading(std::size_t, CellSample s) const {
    ++asked;
    for (float& f : s.force) f *= share;
    return counts(s);
  }
  template <class Revise>
  void settle(const Revise& revise) const {
    ++settled;
    for (const auto& [i, raw] : set) revise(i, raw);
  }
};
}  // namespace

TEST_CASE("Skin: a front end that believes its cells changes no bit") {
  Random rng = seeded(8);
  const auto skin = ur5_skin<260>({10, 3});
  std::vector<std::uint32_t> ids;
  for (std::uint32_t id = 1; id <= 260; id += 3) ids.push_back(id);
  const Stream stream = random_stream(rng, ids, 10ms, 1s, 2ms);
  auto plain = skin.start(0ns), judged = skin.start(0ns);
  const Judge front;
  std::size_t next = 0;
  int cycles = 0;
  bool same = true;
  for (Nanoseconds from{}; from < 1s; from += 8ms, ++cycles) {
    const std::size_t first = next;
    while (next < stream.samples.size() && stream.arrivals[next] <= from + 8ms) ++next;
    const auto samples = std::span(stream.samples).subspan(first, next - first);
    decltype(skin)::Wrenches a[2], b[2];
    same = same && skin.receive(plain, samples, from, from + 8ms, 2, a).bits() ==
                       skin.receive(judged, samples, from, from + 8ms, 2, b, front).bits();
    same = same && a[0] == b[0] && a[1] == b[1] && plain == judged;
  }
  CHECK(same);
  CHECK(front.asked == static_cast<int>(next));
  CHECK(front.settled == cycles);
}

TEST_CASE("Skin: a front end sets what a sample is worth, and revises what is held") {
  OneCell one;  // 10 N per unit of the sum of three, 4 N per unit of proximity
  const auto mean = [&](std::vector<CellSample> samples, Nanoseconds from, Nanoseconds to,
                        const Judge& front) {
    decltype(one)::S::Wrenches w;
    one.skin.receive(one.memory, samples, from, to, 1, &w, front);
    return -w.data[0][2];
  };
  const auto force = [](double x) { return CellCounts{static_cast<std::uint16_t>(x * 16384), 0}; };
  // Half of 15 N, from the sample's ramp on: 20 to 30 ms hold a mean of 7.5 N * 3/10.
  CHECK(mean({sample(7, 30ms, 0.5f)}, 20ms, 30ms, {.share = 0.5f}) ==
        doctest::Approx(7.5 * 0.3).epsilon(1e-12));
  CHECK(one.push({}, 30ms, 40ms) == doctest::Approx(7.5).epsilon(1e-12));
  // To 10 N within the last 6 ms, with a proximity of 0.25 (1 N); held afterwards.
  CHECK(mean({}, 40ms, 50ms, {.set = {{0, {16384, 16384}}}}) ==
        doctest::Approx(7.5 + 3.5 * 0.3).epsilon(1e-12));
  CHECK(one.push({}, 50ms, 51ms) == doctest::Approx(11).epsilon(1e-12));
  // An interval shorter than the ramp is all change: nothing is made up for, nothing is owed.
  CHECK(mean({}, 51ms, 53ms, {.set = {{0, force(0.2)}}}) == doctest::Approx(6.5).epsilon(1e-3));
  CHECK(mean({}, 53ms, 53ms, {.set = {{0, force(0.4)}}}) == doctest::Approx(2).epsilon(1e-3));
  CHECK(one.push({}, 53ms, 60ms) == doctest::Approx(4).epsilon(1e-3));
  CHECK(one.skin.recomputed(one.memory) == one.memory);
  // Its age is that of its sample at 30 ms: it fades from 230 ms on, and is no longer revised.
  const auto held = one.skin.held(one.memory, 0);
  CHECK(mean({}, 60ms, 230ms, {.set = {{0, held}}}) == doctest::Approx(4).epsilon(1e-3));
  CHECK(mean({}, 230ms, 255ms, {.set = {{0, force(1)}}}) == doctest::Approx(4 * 0.75).epsilon(1e-3));
  CHECK(mean({}, 255ms, 280ms, {.set = {{0, force(1)}}}) == doctest::Approx(4 * 0.25).epsilon(1e-3));
  CHECK(mean({}, 280ms, 290ms, {.set = {{0, force(1)}}}) == 0);
  CHECK(one.skin.recomputed(one.memory) == one.memory);
}

TEST_CASE(
    "Skin: a cell that fell silent is in the sums again when it is heard, also after the clock was set "
    "back") {
  OneCell one;
  one.push({sample(7, 100ms, 0.5f)}, 90ms, 100ms);
  one.push({}, 100ms, 400ms);
  CHECK(one.skin.wrenches(one.memory) == decltype(one)::S::Wrenches{});
  one.push({sample(7, 150ms, 0.5f)}, 190ms, 200ms);  // the reading that it had
  CHECK(one.skin.recomputed(one.memory) == one.memory);
  CHECK(one.push({}, 200ms, 210ms) == doctest::Approx(15).epsilon(1e-12));
}

TEST_CASE(
    "Skin: what is pressed is what holds a force, however many cells began or ceased to be in one "
    "reception") {
  for (const Nanoseconds max_age :
       {250ms, 60ms}) {  // 60: held for 10 ms, less than the time that is caught up
    SkinSettings settings;
    settings.max_age = max_age;
    const auto skin = ur5_skin<260>({10, 3}, settings);
    auto memory = skin.start(0ns);
    Random rng = seeded(12);
    Nanoseconds now = 0ns;
    int pressed = 0;
    for (int k = 0; k < 60; ++k) {
      now += 8ms;
      std::vector<CellSample> samples;
      for (int n = 0; n < 500;
           ++n) {  // each cell about twice, every other time across the thresholds; some unknown
        const auto id = static_cast<std::uint32_t>(rng() % 265 + 1);
        const float force = rng() % 2 == 0 ? 0.0f : 0.5f, proximity = rng() % 2 == 0 ? 0.0f : 0.5f;
        samples.push_back(
            {.time = now - 8ms + n * 16us, .cell = id, .force = {force, 0, 0}, .proximity = proximity});
      }
      decltype(skin)::Wrenches mean;
      skin.receive(memory, samples, now - 8ms, now, 1, &mean);
      std::vector<std::size_t> found, holds;
      skin.each_pressed(memory, [&](std::size_t i, double) { found.push_back(i); });
      for (std::size_t i = 0; i < 260; ++i) {
        const CellCounts held = skin.held(memory, i);
        if (held.force != 0) holds.push_back(i);
        const bool seeing = (memory.states[i / 64].seeing >> (i % 64) & 1u) != 0;
        CHECK(seeing == (held.proximity != 0));
      }
      CHECK(found == holds);
      pressed += static_cast<int>(found.size());
    }
    CHECK(pressed > 60 * 100);
    CHECK(skin.recomputed(memory) == memory);
  }
}

TEST_CASE("Skin: an interval that goes backwards is one without length") {
  OneCell one;
  Status status;
  one.push({sample(7, 5ms, 0.5f)}, 0ns, 10ms);
  CHECK(one.push({}, 20ms, 10ms, &status) == doctest::Approx(15));
  CHECK(status == Status(Reason::interval_empty));
  CHECK(std::abs(one.push({}, Nanoseconds::min(), Nanoseconds::max(), &status)) <= 1e-12);
  CHECK(status.has(Reason::sample_stale));
  CHECK(one.push({}, Nanoseconds::max() - 5ns, Nanoseconds::max(), &status) == 0);
}

TEST_CASE("Skin: receives without an allocation") {
  const auto skin = ur5_skin<260>({10, 3});
  auto memory = std::make_unique<decltype(skin)::Memory>(skin.start(0ns));
  Random rng = seeded(6);
  std::vector<CellSample> samples(82);
  decltype(skin)::Wrenches means[4];
  std::uint64_t allocations = 0;
  for (Nanoseconds t{}; t < 2s; t += 2ms) {
    for (CellSample& s : samples)
      s = sample(static_cast<std::uint32_t>(rng() % 300), t + 1ms, float(rng() % 1100) / 1024);
    const AllocationGuard guard;
    skin.receive(*memory, samples, t, t + 2ms, 4, means);
    allocations += guard.count();
  }
  CHECK(allocations == 0);
}

TEST_CASE("Skin: wrong configurations are refused") {
  const Transform<Link<2>, Cell> at = Transform<Link<2>, Cell>::translation_xyz(0.1, 0, 0);
  using P = Patch<2, 2>;
  using S = Skin<ur5::Model, double, P>;
  CHECK_THROWS_WITH_AS(S(P({{5, at}, {5, at}})), "skinctl: Skin: cell id = 5, allowed: ids that occur once",
                       ConfigurationError);
  CHECK_THROWS_AS(S(P({{5, at}, {1u << 20, at}})), ConfigurationError);
  const P two({{5, at}, {6, at}});
  CHECK_NOTHROW(S{two});
  const auto with = [](auto change) {
    SkinSettings settings;
    change(settings);
    return settings;
  };
  CHECK_THROWS_AS(S(two, with([](auto& s) { s.fade = 0ns; })), ConfigurationError);
  CHECK_THROWS_AS(S(two, with([](auto& s) { s.max_age = s.fade - 1ns; })), ConfigurationError);
  CHECK_THROWS_AS(S(two, with([](auto& s) { s.ramp = 0ns; })), ConfigurationError);
  CHECK_THROWS_AS(S(two, with([](auto& s) { s.catch_up = -1ns; })), ConfigurationError);
  CHECK_THROWS_AS(S(two, with([](auto& s) { s.max_ahead = -1ns; })), ConfigurationError);
  CHECK_NOTHROW(S(two, with([](auto& s) { s.max_age = Nanoseconds::max(), s.ramp = 1ns; })));
}
