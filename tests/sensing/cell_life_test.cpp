#include "skinctl/sensing/detail/cell_life.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "skinctl/sensing/cell_health.hpp"
#include "skinctl/sensing/send_on_delta.hpp"
#include "skinctl/testing/skin_signals.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t cells = 20;
using Health = CellHealth<cells>;
using Life = detail::CellLife<cells>;
constexpr double rest = 20, pressed_from = 100;  // [steps], of a sensor and of three

/// Cells 3 and 17, which are neighbours, at 250 Hz: what each sensor reads above its rest, by the time [s].
struct Skin {
  std::vector<std::function<double(double)>> reads;
  bool changes = false;
  LifeSettings settings{};
  SensorNoise noise{.force = 0.7f, .proximity = 0.7f, .rest = float(rest), .repeats = false};
  std::unique_ptr<Health::Memory> health = std::make_unique<Health::Memory>();
  std::unique_ptr<Life::Memory> life = std::make_unique<Life::Memory>();
  double first[2] = {-1, -1}, lived[2] = {0, 0},
         rim[2] = {0, 0};  ///< of each cell: begin of its life, all of it [s]

  /// What happens until `end` [s]; `give` [m/s] is the speed inwards of both places while they are pressed.
  void run(double end, double give = 0) {
    const Health judge({.delta = changes ? 2.0 : 0.0, .equal_messages = 0}, std::span(&noise, 1));
    const Life looks(settings);
    Normal normal(5);
    const std::size_t index[2] = {3, 17};
    SendOnDelta::Memory sent[2];
    const SendOnDelta sender({});
    for (Nanoseconds t = 4ms; seconds<double>(t) <= end; t += 4ms) {
      Life::Bits pressed{};
      for (std::size_t c = 0; c < reads.size(); ++c) {
        CellSample s;
        s.time = t, s.cell = std::uint32_t(index[c]);
        for (float& x : s.force) {
          const double steps = std::round(rest + reads[c](seconds<double>(t)) + 0.7 * normal());
          x = static_cast<float>(std::clamp(steps / 1024, 0.0, 1.0));
        }
        if (!changes || sender.send(sent[c], s)) judge.take(*health, index[c], s);
        Life::set(pressed, index[c],
                  health->row[index[c] / 16].force[index[c] % 16] - 3 * rest > pressed_from);
      }
      judge.scan(*health, t, [](std::size_t) { return Health::Witness{}; }, false);
      if (!Life::is_due(*life, t)) continue;
      looks.tick(
          *life, t, *health, [&](std::size_t b) -> const detail::HealthLimitsRow& { return judge.limits(b); },
          pressed, [&](std::size_t i) { return std::array{i == 3 ? std::size_t(17) : std::size_t(3)}; });
      for (std::size_t c = 0; c < reads.size(); ++c) {
        const bool lives = Life::in(life->lives, index[c]);
        if (lives && first[c] < 0) first[c] = seconds<double>(t);
        lived[c] += lives ? 0.008 : 0, rim[c] += Life::in(life->rim_lives, index[c]) ? 0.008 : 0;
        if (lives) Life::forgive(*life, index[c]);
        if (!lives && Life::in(life->pressed, index[c]))
          looks.give(*life, index[c], static_cast<float>(0.008 * give), static_cast<float>(give));
      }
    }
  }
};
double step(double t) {
  return t < 1 ? 0 : 500;
}

}  // namespace

TEST_CASE("CellLife: what sticks, creeps, dithers within its noise, or blinks shows no life") {
  const std::vector<std::function<double(double)>> quiet = {
      step, [](double t) { return t < 1 ? 0 : 40 + 7 * (t - 1); },  // 0.02 a second
      [](double t) { return t < 1                       ? 0
                            : std::fmod(t, 0.16) < 0.08 ? 500.0
                                                        : 0.0; },  // jumps from nothing
      [](double t) {
        return t < 1 ? 0 : std::fmod(t, 0.16) < 0.08 ? 500.0 : 200.0;
      }  // jumps while it is pressed
  };
  for (const bool changes : {false, true})
    for (const auto& reads : quiet) {
      Skin skin{{reads}, changes};
      skin.run(5);
      CAPTURE(changes);
      CAPTURE(&reads - quiet.data());
      CHECK(skin.lived[0] == 0);
    }
}

TEST_CASE("CellLife: a hand lives from 24 ms on as it comes, and as long as it trembles") {
  for (const bool changes : {false, true}) {
    CAPTURE(changes);
    Skin comes{{[](double t) { return t < 1 ? 0 : std::min(500.0, 5000 * (t - 1)); }}, changes};
    comes.run(3);
    CHECK(comes.first[0] > 1);
    CHECK(comes.first[0] < 1.04);
    CHECK(comes.lived[0] > 0.3);
    CHECK(comes.lived[0] < 0.9);
    Skin trembles{{[](double t) { return t < 1 ? 0 : 500 + 10 * std::sin(50 * t); }}, changes};
    trembles.run(3);
    CHECK(trembles.first[0] < 1.3);
    CHECK(trembles.lived[0] > 1.6);
  }
}

TEST_CASE(
    "CellLife: a cell without life counts less with its way, is quiet from 7.2 mm on, and until it rests for "
    "10 s") {
  Skin skin{{[](double t) { return t < 1 || t > 3 ? 0.0 : 500.0; }}};
  skin.run(1.09, 0.05);
  const Life looks(skin.settings);
  CHECK(looks.share(*skin.life, 3) < 0.6);
  CHECK(looks.share(*skin.life, 3) > 0.4);
  CHECK_FALSE(Life::in(skin.life->quiet, 3));
  // Damping leaves nothing at its speed for this force, and all at rest.
  CHECK(looks.braked(*skin.life, 3, 10) < 0.6f);
  CHECK(looks.braked(*skin.life, 4, 10) == 1);
  const auto ends = [&](double end) {
    Skin again{{[](double t) { return t < 1 || t > 3 ? 0.0 : 500.0; }}};
    again.run(end, 0.05);
    return std::pair(Life::in(again.life->quiet, 3), again.life->row[0].way[3]);
  };
  CHECK(ends(1.3).first);
  CHECK(ends(1.3).second > 0.0072f);
  CHECK(ends(12.5).first);
  CHECK_FALSE(ends(13.5).first);
  CHECK(ends(13.5).second == 0);
}

TEST_CASE("CellLife: the sum of a cell and its neighbour lives when neither of them shows it") {
  const auto rim = [](double t) { return t < 1 ? 0 : std::min(60.0, 30 * (t - 1)) + 0.9 * std::sin(50 * t); };
  Skin skin{{rim, rim}};
  skin.run(6);
  CHECK(skin.rim[0] > skin.lived[0] + 0.5);
  Skin stuck{{step, step}};
  stuck.run(4);
  CHECK(stuck.rim[0] == 0);
}

TEST_CASE(
    "CellLife: neighbours that creep alike do not live by their sum, which creeps faster than it scatters") {
  const auto creeps = [](double t) { return t < 1 ? 0 : 30 * (t - 1); };
  Skin skin{{creeps, creeps}};
  skin.run(5);
  CHECK(skin.lived[0] == 0);
  CHECK(skin.rim[0] == 0);
}

TEST_CASE("CellLife: a sensor at its top shows nothing, and lives if its neighbour does") {
  const auto top = [](double t) { return t < 1 ? 0 : 1000 + 8 * std::sin(60 * t); };
  Skin alone{{top}};
  alone.run(3);
  CHECK(alone.lived[0] == 0);
  Skin beside{{top, [](double t) { return t < 1 ? 0 : 500 + 20 * std::sin(50 * t); }}};
  beside.run(3);
  CHECK(beside.lived[0] > 1.5);
  Skin both{{top, top}};
  both.run(3);
  CHECK(both.lived[0] == 0);
}
