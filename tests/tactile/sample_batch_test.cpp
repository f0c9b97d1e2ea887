// Samples taken side by side are those taken one by one: memories to the bit, means within rounding. Compiled once more for
// AVX-512 (tests/CMakeLists.txt): other targets take them one by one, and compare a path with itself.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/model/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/testing/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

#if defined(SKINCTL_TEST_LANES)
static_assert(detail::batch_lanes == SKINCTL_TEST_LANES);
#endif

namespace {

/// Judges nothing. A skin with a front end takes samples one by one.
struct OneByOne {
  CellCounts reading(std::size_t, const CellSample& s) const noexcept { return counts(s); }
  void settle(const auto&) const noexcept {}
};

/// Two patches on one link, a gap in the ids, a link of few cells.
template <class T>
using TestedSkin = Skin<ur5::Model, T, Patch<1, 90>, Patch<1, 20>, Patch<3, 70>, Patch<4, 5>>;
constexpr std::uint32_t first_ids[] = {1, 100, 120, 300};
constexpr std::uint32_t sizes[] = {90, 20, 70, 5};
template <class T>
TestedSkin<T> tested_skin(Random& rng, bool hysteresis) {
  SkinSettings settings;
  if (hysteresis) {
    settings.force = EventGate<>::hysteresis(0.3, 0.05);
    settings.proximity = EventGate<>::hysteresis(0.2, 0.04);
  }
  return TestedSkin<T>{random_patch<1, 90>(rng, first_ids[0], {10, 3}),
                       random_patch<1, 20>(rng, first_ids[1], {7, 2}),
                       random_patch<3, 70>(rng, first_ids[2], {5, 1}),
                       random_patch<4, 5>(rng, first_ids[3], {3, 4}), settings};
}
std::vector<std::uint32_t> all_ids() {
  std::vector<std::uint32_t> ids;
  for (std::size_t p = 0; p < 4; ++p)
    for (std::uint32_t i = 0; i < sizes[p]; ++i) ids.push_back(first_ids[p] + i);
  return ids;
}

float some_reading(Random& rng) {
  switch (rng() % 6) {
    case 0:
      return 0.0f;
    case 1:
      return 1.0f;
    case 2:
      return 0.04f + 0.02f * float(rng() % 64) / 64;  // about the thresholds
    default:
      return float(rng() % 65537) / 65536;
  }
}
CellSample good_sample(Random& rng, std::uint32_t id, Nanoseconds from, Nanoseconds to) {
  CellSample s;
  s.cell = id;
  s.time =
      to - Nanoseconds(static_cast<std::int64_t>(rng() % static_cast<std::uint64_t>((to - from).count())));
  if (rng() % 3 != 0) {
    for (float& f : s.force) f = rng() % 2 == 0 ? 0.0f : some_reading(rng);
    s.proximity = some_reading(rng);
  }
  for (float& a : s.acceleration) a = float(rng() % 4000) / 100 - 20;
  s.temperature = 30;
  return s;
}
constexpr const char* troubles[] = {"unknown below", "unknown between", "unknown beyond", "not finite",
                                    "infinite",      "above range",     "below range",    "minus zero",
                                    "late",          "stale",           "ahead",          "far ahead",
                                    "backwards",     "repeated",        "other time"};
/// What is not usual happens to sample `k`.
void spoil(Random& rng, std::vector<CellSample>& samples, std::size_t k, std::size_t trouble,
           Nanoseconds to) {
  CellSample& s = samples[k];
  float* numbers[] = {&s.force[0],        &s.force[1],        &s.force[2],        &s.proximity,
                      &s.acceleration[0], &s.acceleration[1], &s.acceleration[2], &s.temperature};
  switch (trouble) {
    case 0:
      s.cell = 0;
      break;
    case 1:
      s.cell = 95;
      break;
    case 2:
      s.cell = 305 + static_cast<std::uint32_t>(rng() % 2 == 0 ? rng() : 0u) / 2;
      break;
    case 3:
      *numbers[rng() % 8] = std::numeric_limits<float>::quiet_NaN();
      break;
    case 4:
      *numbers[rng() % 8] = (rng() % 2 == 0 ? 1.0f : -1.0f) * std::numeric_limits<float>::infinity();
      break;
    case 5:
      *numbers[rng() % 4] = rng() % 2 == 0 ? 1.001f : 1e30f;
      break;
    case 6:
      *numbers[rng() % 4] = rng() % 2 == 0 ? -0.001f : -1e30f;
      break;
    case 7:
      *numbers[rng() % 4] = -0.0f;
      break;
    case 8:
      s.time = to - 12ms - Nanoseconds(rng() % 30000000u);
      break;
    case 9:
      s.time = to - 250ms - Nanoseconds(rng() % 3u);
      break;
    case 10:
      s.time = to + Nanoseconds(1 + rng() % 2000000u);
      break;
    case 11:
      s.time = to + 1s;
      break;
    case 12:
      s.time = rng() % 2 == 0 ? Nanoseconds::min() : to - 100s;
      break;
    case 13:
      s.cell = samples[rng() % samples.size()].cell;
      break;
    default: {
      const std::size_t other = rng() % samples.size();
      s.cell = samples[other].cell;
      s.time = samples[other].time;
    }
  }
}

template <class T>
bool close(const LinkWrenches<ur5::Model, 0b011010, T>& a, const LinkWrenches<ur5::Model, 0b011010, T>& b) {
  bool all = true;
  for (std::size_t l = 0; l < 3; ++l)
    for (std::size_t r = 0; r < 6; ++r)
      all = all &&
            std::abs(a.data[l][r] - b.data[l][r]) <= T(200) * epsilon<T>() * (T(10) + std::abs(a.data[l][r]));
  return all;
}
template <class W>
bool close(const TouchWrenches<W>& a, const TouchWrenches<W>& b) {
  return close(a.force, b.force) && close(a.proximity, b.proximity);
}

/// Two memories of one skin, which receive the same.
template <class T, class Means>
class Twins {
 public:
  Twins(Random& rng, bool hysteresis)
      : skin_(tested_skin<T>(rng, hysteresis)), batched_(skin_.start(0ns)), single_(batched_) {}
  void receive(std::span<const CellSample> samples, Nanoseconds from, Nanoseconds to, std::size_t parts) {
    Means means[4], expected[4];
    const Status status = skin_.receive(batched_, samples, from, to, parts, means);
    const Status said = skin_.receive(single_, samples, from, to, parts, expected, OneByOne{});
    CHECK(status.bits() == said.bits());
    CHECK(batched_ == single_);
    CHECK(skin_.recomputed(batched_) == batched_);
    for (std::size_t j = 0; j < parts; ++j) CHECK(close(means[j], expected[j]));
  }
  /// All cells are heard, pressed or not.
  void hear_all(Random& rng, Nanoseconds from, Nanoseconds to) {
    std::vector<CellSample> samples;
    for (const std::uint32_t id : all_ids()) samples.push_back(good_sample(rng, id, from, to));
    receive(samples, from, to, 1);
  }

 private:
  TestedSkin<T> skin_;
  typename TestedSkin<T>::Memory batched_, single_;
};

/// Each trouble in each place of some batches.
template <class T, class Means>
void check_places(bool hysteresis) {
  Random rng = seeded(11);
  Twins<T, Means> twins(rng, hysteresis);
  std::vector<std::uint32_t> ids = all_ids();
  Nanoseconds now = 1s;
  twins.hear_all(rng, now - 2ms, now);
  for (std::size_t trouble = 0; trouble < std::size(troubles); ++trouble)
    for (std::size_t place = 0; place < 40; ++place) {
      CAPTURE(std::string(troubles[trouble]));
      CAPTURE(place);
      now += 2ms;
      std::shuffle(ids.begin(), ids.end(), rng);
      std::vector<CellSample> samples;
      for (std::size_t k = 0; k < 40; ++k) samples.push_back(good_sample(rng, ids[k], now - 2ms, now));
      spoil(rng, samples, place, trouble, now);
      twins.receive(samples, now - 2ms, now, 1);
    }
}

/// Any number of samples, from streams without trouble to such as are full of it; at times cells are silent.
template <class T, class Means>
void check_streams(std::size_t parts, bool hysteresis) {
  Random rng = seeded(12);
  Twins<T, Means> twins(rng, hysteresis);
  std::vector<std::uint32_t> ids = all_ids();
  Nanoseconds now = 1s;
  for (int cycle = 0; cycle < 600; ++cycle) {
    CAPTURE(cycle);
    // Cells fade and are silent, also such as spoke a moment ago by a clock that was set back.
    if (rng() % 40 == 0) {
      twins.receive({}, now, now + 300ms, parts);
      now += rng() % 2 == 0 ? 1ms : 300ms;
    }
    const Nanoseconds from = now;
    now += rng() % 10 == 0 ? 60ms : 2ms;
    std::shuffle(ids.begin(), ids.end(), rng);
    std::vector<CellSample> samples;
    const std::size_t count = rng() % 201;
    for (std::size_t k = 0; k < count; ++k)
      samples.push_back(good_sample(rng, ids[k % ids.size()], now - 2ms, now));
    const std::size_t spoilt = count == 0 || cycle % 3 == 0 ? 0 : cycle % 3 == 1 ? rng() % 4 : rng() % count;
    for (std::size_t k = 0; k < spoilt; ++k)
      spoil(rng, samples, rng() % count, rng() % std::size(troubles), now);
    twins.receive(samples, from, now, parts);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("Samples side by side: whatever is unusual in whatever place, as one by one", T, float,
                   double) {
  check_places<T, typename TestedSkin<T>::Wrenches>(false);
  check_places<T, typename TestedSkin<T>::Touch>(true);
}

TEST_CASE_TEMPLATE("Samples side by side: streams of 0 to 200, clean and damaged, are those one by one", T,
                   float, double) {
  for (const std::size_t parts : {std::size_t(1), std::size_t(3)}) {
    check_streams<T, typename TestedSkin<T>::Wrenches>(parts, true);
    check_streams<T, typename TestedSkin<T>::Touch>(parts, false);
  }
}
