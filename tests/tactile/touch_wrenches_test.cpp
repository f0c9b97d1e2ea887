#include "skinctl/tactile/touch_wrenches.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin.hpp"
#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using W = LinkWrenches<ur5::Model, link_bit<2>>;
static_assert(std::is_same_v<LawTouch<TouchWrenches<W>>, W>);
static_assert(std::is_same_v<LawTouch<W>, W>);
static_assert(std::is_trivially_copyable_v<TouchWrenches<W>>);

template <class T>
double largest_difference(const T& a, const T& b) {
  double most = 0;
  for (std::size_t k = 0; k < T::count; ++k)
    for (std::size_t r = 0; r < 6; ++r) {
      const double d = static_cast<double>(a.data[k][r]) - static_cast<double>(b.data[k][r]);
      most = std::max(most, std::abs(d));
    }
  return most;
}

}  // namespace

TEST_CASE(
    "TouchWrenches: laws see the sum, contacts are the forces; wrenches that are not apart are contacts") {
  W force, proximity;
  force.set<2>({{1, 2, 3}, {4, 5, 6}});
  proximity.set<2>({{10, 20, 30}, {40, 50, 60}});
  const TouchWrenches<W> touch{force, proximity};
  CHECK(total_of(touch) == force + proximity);
  CHECK(contact_part(touch) == force);
  CHECK(&total_of(force) == &force);
  CHECK(&contact_part(force) == &force);
}

// The oracle: the same cells with the gain of one kind at a time, in a skin that does not tell them apart.
TEST_CASE_TEMPLATE("Skin: forces and proximities apart are those of two skins that feel one kind each", T,
                   float, double) {
  Random rng = seeded(5);
  SkinSettings settings;
  settings.proximity = EventGate<>();
  const auto both = random_patch<2, 12>(rng, 1);
  const auto with = [&](double w_f, double w_p) {
    return Skin<ur5::Model, T, Patch<2, 12>>(Patch<2, 12>(both.any(), {.force = w_f, .proximity = w_p}),
                                             settings);
  };
  const auto skin = with(7, 5), forces = with(7, 0), proximities = with(0, 5);
  using S = std::remove_cv_t<decltype(skin)>;
  auto memory = skin.start(0ns), a = skin.start(0ns), b = skin.start(0ns), sum = skin.start(0ns);
  const double tolerance = 1e3 * static_cast<double>(std::numeric_limits<T>::epsilon());
  std::uniform_real_distribution<float> reading(0, 1);
  double furthest = 0;
  bool apart = false;
  Nanoseconds from{};
  for (int cycle = 0; cycle < 300; ++cycle) {
    // Sometimes no time passes, sometimes so much that cells fade and fall silent.
    const Nanoseconds to = from + std::array<Nanoseconds, 5>{8ms, 2ms, 0ns, 50ms, 260ms}[rng() % 5];
    std::vector<CellSample> samples;
    for (std::uint32_t id = 1; id <= 12; ++id) {
      if (rng() % 3 != 0) continue;
      CellSample s;
      s.cell = id;
      s.time = from + Nanoseconds(static_cast<std::int64_t>(rng() % 8000000));
      if (rng() % 2 == 0) s.force = {reading(rng), reading(rng), 0};
      if (rng() % 2 == 0) s.proximity = reading(rng);
      samples.push_back(s);
    }
    typename S::Touch means[3];
    typename S::Wrenches of_force[3], of_proximity[3], of_both[3];
    const Status status = skin.receive(memory, samples, from, to, 3, means);
    CHECK(status == forces.receive(a, samples, from, to, 3, of_force));
    static_cast<void>(proximities.receive(b, samples, from, to, 3, of_proximity));
    static_cast<void>(skin.receive(sum, samples, from, to, 3, of_both));
    for (int j = 0; j < 3; ++j) {
      furthest = std::max({furthest, largest_difference(means[j].force, of_force[j]),
                           largest_difference(means[j].proximity, of_proximity[j]),
                           largest_difference(means[j].total(), of_both[j])});
      apart = apart || (means[j].force.data[0][2] != 0 && means[j].proximity.data[0][2] != 0);
    }
    furthest = std::max(furthest, largest_difference(skin.touch(memory).total(), skin.wrenches(memory)));
    CHECK(skin.touch(memory).force == forces.wrenches(a));
    CHECK(skin.touch(memory).proximity == proximities.wrenches(b));
    CHECK(skin.touch(memory) == skin.touch(skin.recomputed(memory)));
    from = to;
  }
  CHECK(apart);
  CHECK(furthest <= tolerance);
}
