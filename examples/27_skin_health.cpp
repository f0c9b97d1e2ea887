// 27 Watching a skin's health: faulty cells neither move the arm nor make it numb.
//
//   faults   one after the other: a stuck cell, a noisy one, a blinking one, cross-talk, a dead cable of nine cells
//   skin     TrustedSkin: what one cell alone may count up to is what the arm's dry friction holds (lone_forces)
//   drawn    the torque of the skin about the shoulder, believed and trusted; cells that do not count; way of the arm
//   written  the report in words; with an argument also the cells as a picture and as JSON
#include <cstdio>
#include <fstream>

#include "skinctl/io/skin_report.hpp"
#include "skinctl/tactile/lone_cell.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/testing/skin_faults.hpp"
#include "skinctl/testing/skin_signals.hpp"
#include "support/arm.hpp"
#include "support/skin_health_picture.hpp"

using namespace examples;

namespace {

constexpr CellGains gains{.force = newtons_per_reading};

auto arm_with_friction() {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 0};
  c.viscous_friction = {60, 60, 40, 6, 6, 6};
  c.coulomb_friction = {7.5, 7.5, 7.5, 1.4, 1.4, 1.4};
  return by_position(ur5::Model{}, c);
}
std::vector<testing::FaultyCell> faulty_cells() {
  using testing::FaultyCell;
  std::vector<FaultyCell> all = {
      {.cell = 140, .fault = CellFault::stuck, .from = 1s},
      {.cell = 101, .fault = CellFault::noisy, .from = 2s},
      {.cell = 155, .fault = CellFault::blinking, .from = 3s},
      {.cell = 60, .fault = CellFault::cross_talk, .from = 5s, .level = 0.8, .source = 172},
  };
  for (std::uint32_t k = 0; k < 9; ++k)
    all.push_back({.cell = 205 + k, .fault = CellFault::unheard, .from = 4s});
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  const auto patches = ur5::skin_patches<260>(gains);
  const auto places = cell_places(patches);
  const auto believed = ur5_skin<260>(gains);
  testing::SkinSignals signals(places);
  TrustSettings trust;
  trust.lone_force = lone_forces(arm_with_friction(), places);
  trust.noise = {{.force = 0.7f, .proximity = 0.7f, .rest = 20.5f}};
  const TrustedSkin skin(believed, trust);
  const Cycle scene(arm_with_friction(), skin, SkinJointControl{} + GravityControl{});

  // A hand on the forearm, from 6 s on.
  signals.touches.push_back({.link = places[171].link,
                             .place = places[171].place,
                             .radius = 0.05,
                             .reading = 0.25,
                             .from = 6s,
                             .until = 8s});
  testing::SkinFaults spoil(faulty_cells());
  auto memory = std::make_unique<decltype(scene)::Memory>();
  auto naive = std::make_unique<decltype(believed)::Memory>(believed.start(0ns));
  State<6> measured{0ns, home, {}};
  scene.start(*memory, measured);

  Curve plain{"believed"}, trusted{"trusted"}, left_out{"cells that do not count"}, way{"way of the wrist"},
      hand{"hand"};
  std::vector<CellSample> samples;
  const auto start = tool_at(home).origin();
  double moved_before = 0, moved = 0;
  std::string words, json, picture;
  while (measured.time < 9s) {
    const Nanoseconds from = measured.time;
    measured.time += 8ms;
    signals.samples(measured.time, samples);
    spoil.apply(samples, measured.time);
    decltype(scene)::Input input;
    input.now = measured.time, input.measured = measured, input.samples = samples;
    measured.q = scene.step(*memory, input).command.position;
    decltype(believed)::Wrenches w;
    believed.receive(*naive, samples, from, measured.time, 1, &w);

    const double t = seconds<double>(measured.time);
    const Xyz<double> off = tool_at(measured.q).origin() - start;
    moved = 1e3 * norm(off);
    if (measured.time < 6s) moved_before = std::max(moved_before, moved);
    plain.add(t, skin_torque(ur5::Model{}, measured.q, w)[1]);
    trusted.add(t, skin_torque(ur5::Model{}, measured.q, skin.wrenches(memory->skin))[1]);
    left_out.add(t, 260 - double(skin.coverage(memory->skin).usable));
    way.add(t, moved);
    hand.add(t, t > 6 && t < 8 ? 1 : 0);
    if (measured.time == 6800ms) {
      const SkinHealthReport report = report_of(skin, memory->skin);
      words = in_words(report), json = as_json(report), picture = as_svg(report);
    }
  }
  std::printf("%s\nmoved by %.2f mm by five faults, by %.0f mm by a hand\n", words.c_str(), moved_before,
              moved);
  if (argc > 1) {
    const std::string path(argv[1]), stem = path.substr(0, path.rfind('.'));
    std::ofstream(stem + "_cells.svg") << picture;
    std::ofstream(stem + "_cells.json") << json;
  }
  return draw(argc, argv, "27_skin_health.svg", "Faulty cells neither move the arm nor make it numb",
              {Panel("torque about the shoulder [N m]", {plain, trusted}),
               Panel("cells that do not count", {left_out}), Panel("arm moved by [mm]", {way})},
              while_above_zero(hand, "a hand pushes")) ||
         moved_before > 0 || moved < 20;
}
