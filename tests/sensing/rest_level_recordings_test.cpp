// The rest level of recorded taxels: grasps held, tapped, at several rates and by events.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>

#include "bench/studies/worlds/recorded_grasps.hpp"
#include "bench/studies/worlds/skin_drifts.hpp"
#include "skinctl/sensing/rest_level.hpp"
#include "skinctl/testing/sanitized.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using skinctl::testing::ReadingNoise;

TEST_CASE("Recorded grasps, held and tapped: no taxel loses its contact, at 20 to 1000 Hz and by events") {
  const char* data = std::getenv("SKINCTL_DATA_DIR");
  if (data == nullptr) {
    MESSAGE("skipped: SKINCTL_DATA_DIR is not set");
    return;
  }
  const auto grasps = read_recorded_grasps(data);
  REQUIRE(grasps.size() == 230);
  RestSettings settings;
  settings.ramp = 50ms;
  const RestLevel sampled(settings), by_change;
  const double until = sanitized ? 20 : 60;
  Seeded rng(3);
  int taxels = 0, held = 0;
  double worst = 0, worst_by_events = 0;
  for (std::size_t g = 0; g < grasps.size(); g += 23)
    for (std::size_t i = g % 5; i < RecordedGrasp::taxels; i += 5) {
      const RecordedGrasp& grasp = grasps[g];
      const double rest = grasp.rest[i];
      // Two taps of 60 steps, one of them on the held taxel.
      const DriftingTouch taps[] = {tap(rng.between(0.2, 0.8), 60), tap(rng.between(5, 15), 60)};
      ReadingNoise noise(0.3, g);
      const auto clean = [&](double t) {
        const double up = std::min(1.0, std::max(0.0, 2 * (t - 1)));
        return rest + up * (grasp.reading(i, t - 1.5) - rest) + taps[0].force(t) + taps[1].force(t);
      };
      const RestLevels levels{float(sampled.freeze_level(0.45, 50ms)), 8};
      CAPTURE(grasp.object);
      CAPTURE(grasp.trial);
      CAPTURE(i);
      double from_250 = 0;
      for (const double rate : {250.0, 20.0, 1000.0, 0.0}) {
        const RestLevel& rule = rate > 0 ? sampled : by_change;
        auto memory = rule.start(float(rest));
        double before = 0;
        const auto take = [&](double t, double x) {
          rule.take(memory, float(x), nanoseconds(t) - nanoseconds(before), 0.0f, levels);
          before = t;
        };
        if (rate > 0)
          at_rate(rate, 0, until, [&](double t) { take(t, noise(clean(t))); });
        else
          by_events([&](double t) { return noise(clean(t)); }, 1000, 1, 0.1, 0, until, take);
        const double b = double(memory.cell.whole + memory.cell.fraction);
        if (rate == 250) from_250 = b;
        double& most = rate > 0 ? worst : worst_by_events;
        most = std::max(most, std::abs(b - from_250));
        // What is held stays: frozen at the first steps, whatever else comes.
        if (grasp.held(i) >= 3) {
          CHECK(std::abs(memory.cell.frozen) > 0);
          CHECK(double(memory.cell.above) > 0.8 * grasp.held(i) - 0.6);
          ++held;
        }
      }
      ++taxels;
    }
  CHECK(taxels == 120);
  CHECK(held > 80);
  // Other samples of the noise, and taps that a slow sensor does not see: still the same to a step.
  CHECK(worst < 1);
  CHECK(worst_by_events < 1);
}
