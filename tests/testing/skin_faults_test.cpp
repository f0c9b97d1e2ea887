#include "skinctl/testing/skin_faults.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/skin_signals.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// What cell 120 of a UR5 sends over 4 s, touched from 1 s on or not, with a fault from 2 s on; cell 40 is
/// touched.
struct Heard {
  std::vector<CellSample> before, after;
  int others_changed = 0, refused = 0;
};
Heard hear(FaultyCell fault, bool touched) {
  const auto places = cell_places(ur5::skin_patches<260>());
  SkinSignals signals(places, {}, 3);
  const auto touch = [&](std::size_t i) {
    signals.touches.push_back({.link = places[i].link, .place = places[i].place, .from = 1s, .until = 10s});
  };
  touch(39);
  if (touched) touch(119);
  fault.cell = 120, fault.source = 40, fault.from = 2s;
  SkinFaults faults({fault});
  Heard heard;
  std::vector<CellSample> samples;
  for (Nanoseconds to = 8ms; to <= 4s; to += 8ms) {
    signals.samples(to, samples);
    const std::vector<CellSample> sent = samples;
    faults.apply(samples, to);
    std::size_t k = 0;
    for (const CellSample& s : samples) {
      heard.refused += check(s).any();
      if (s.cell == 120) {
        (s.time < 2s ? heard.before : heard.after).push_back(s);
        continue;
      }
      while (sent[k].cell == 120) ++k;
      const CellSample& was = sent[k++];
      heard.others_changed += was.cell != s.cell || was.force != s.force || was.proximity != s.proximity;
    }
  }
  return heard;
}
double mean(const std::vector<CellSample>& all) {
  double sum = 0;
  for (const CellSample& s : all) sum += double(s.force[0]) / static_cast<double>(all.size());
  return sum;
}
double deviation(const std::vector<CellSample>& all) {
  double sum = 0;
  for (const CellSample& s : all)
    sum += std::pow(double(s.force[0]) - mean(all), 2) / static_cast<double>(all.size());
  return std::sqrt(sum);
}

}  // namespace

TEST_CASE("SkinFaults: each fault does to its cell what it says, to no other, and nothing before its time") {
  for (const bool touched : {false, true}) {
    CAPTURE(touched);
    const double rest = touched ? 0.32 : 0.02;
    const auto one = [&](FaultyCell f) {
      CAPTURE(name(f.fault));
      const Heard heard = hear(f, touched);
      CHECK(heard.others_changed == 0);
      CHECK(heard.refused == 0);
      CHECK(heard.before.size() == 500);
      const std::vector<CellSample> untouched(heard.before.begin(), heard.before.begin() + 150);
      CHECK(mean(untouched) == doctest::Approx(0.02).epsilon(0.05));
      CHECK(deviation(untouched) == doctest::Approx(0.7 / 1024).epsilon(0.2));
      if (f.fault != CellFault::unheard) CHECK(heard.after.size() == 500);
      return heard;
    };
    const auto stuck = one({.fault = CellFault::stuck});
    CHECK(mean(stuck.after) == doctest::Approx(0.9).epsilon(1e-3));
    CHECK(deviation(stuck.after) < 1e-9);
    CHECK(stuck.after[9].acceleration != stuck.after[10].acceleration);
    const auto dead = one({.fault = CellFault::stuck, .level = 0, .whole = true});
    CHECK(mean(dead.after) == 0);
    CHECK(std::all_of(dead.after.begin(), dead.after.end(), [&](const CellSample& s) {
      return s.proximity == dead.before.back().proximity && s.acceleration == dead.before.back().acceleration;
    }));
    const auto held = one({.fault = CellFault::stuck, .level = -1});
    CHECK(held.after.back().force == held.before.back().force);
    const auto saturated = one({.fault = CellFault::saturated});
    CHECK(mean(saturated.after) > 0.985);
    CHECK(deviation(saturated.after) > 1e-3);
    const auto blinking = one({.fault = CellFault::blinking});
    int jumps = 0;
    for (std::size_t k = 1; k < blinking.after.size(); ++k)
      jumps += std::abs(blinking.after[k].force[0] - blinking.after[k - 1].force[0]) > 0.3f;
    CHECK(jumps > 10);
    CHECK(jumps < 40);
    const auto noisy = one({.fault = CellFault::noisy, .level = 0.02});
    CHECK(mean(noisy.after) == doctest::Approx(rest).epsilon(0.15));
    CHECK(deviation(noisy.after) > 0.012);
    const auto crossed = one({.fault = CellFault::cross_talk});
    CHECK(mean(crossed.after) == doctest::Approx(rest + 0.5 * 0.32).epsilon(0.02));
    const auto discharge = one({.fault = CellFault::discharge, .level = 0.1});
    CHECK(discharge.after[0].force[0] - discharge.before.back().force[0] ==
          doctest::Approx(0.1).epsilon(0.2));
    CHECK(mean(discharge.after) < rest + 0.1);
    const auto lost = one({.fault = CellFault::unheard});
    CHECK(lost.after.empty());
    const auto late = one({.fault = CellFault::unheard, .level = 0});
    CHECK(late.after.size() >= 398);
    CHECK(late.after.size() <= 402);
  }
}

TEST_CASE("SkinFaults: a share of the cells, each once, each with its fault only while it lasts") {
  std::vector<std::uint32_t> ids(260);
  for (std::uint32_t i = 0; i < 260; ++i) ids[i] = i + 1;
  const auto list = SkinFaults::of_share(0.3, ids, {.fault = CellFault::noisy, .from = 1s, .until = 2s}, 5);
  CHECK(list.size() == 78);
  std::set<std::uint32_t> once;
  for (const FaultyCell& f : list) {
    once.insert(f.cell);
    CHECK(f.source != f.cell);
  }
  CHECK(once.size() == 78);
  const SkinFaults faults(list);
  CHECK_FALSE(faults.faulty(list[0].cell, 1s - 1ns));
  CHECK(faults.faulty(list[0].cell, 1s));
  CHECK_FALSE(faults.faulty(list[0].cell, 2s));
}
