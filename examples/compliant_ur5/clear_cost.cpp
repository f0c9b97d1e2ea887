// What `--clear` costs: cycles of the main job by position, for `instructions_meter VALGRIND ur5_clear_cost`
// (see bench/report).
//
//     ur5_clear_cost               names of the scenes
//     ur5_clear_cost SCENE CYCLES  runs one of them
//     ur5_clear_cost SCENE time    its data, for the table
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "examples/compliant_ur5/scene.hpp"

using namespace compliant_ur5;
using namespace skinctl;

namespace {

enum class Near { nothing, table, hand };
constexpr int before = 900;  // cycles until the arm stands at the table

template <bool Clear>
void run(Near near, int cycles, bool told) {
  Settings s;
  read_scenario(COMPLIANT_UR5_SCENARIO, s);
  s.keep_clear = Clear;
  s.trust_all_cells = true;  // these cells have no noise
  const auto scene = make_watched_scene<Interface::position, Sense::skin, Clear>(s);
  using Scene = std::remove_cvref_t<decltype(scene)>;
  if (told) {
    std::printf("-|%zu|0|0\n", sizeof(typename Scene::Memory));
    return;
  }
  Sight sight(s);
  std::vector<CellSample> all, some;
  for (const auto& patch : skin_patches(s))
    for (const auto& cell : patch.cells) {
      CellSample sample;
      sample.cell = cell.id;
      sample.proximity = near == Near::hand && patch.link == 2 && all.size() % 12 == 0 ? 0.2f : 0.0f;
      all.push_back(sample);
    }
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> measured{1s, JointPosition<6>(PerJoint{0.0, -1.2, 1.4, -1.8, -1.57, 0.3}), {}};
  scene.start(*memory, measured);
  typename Scene::Input input;
  for (int k = 0; k < before + cycles; ++k) {
    measured.time += 8ms;
    input.now = measured.time;
    input.measured = measured;
    some.clear();  // as many as send in a cycle
    for (std::size_t i = static_cast<std::size_t>(k % 8); i < all.size(); i += 8) {
      all[i].time = measured.time - 1ms;
      if (all[i].proximity > 0)
        all[i].proximity = 0.2f + 0.02f * static_cast<float>(k / 8 % 3);  // it trembles
      some.push_back(all[i]);
    }
    input.samples = some;
    if constexpr (Clear) {
      input.samples = sight.foreign(measured.q, some);
      input.around = sight.around(measured.q, [&](std::size_t i) {
        return scene.skin().held(memory->skin, i).proximity * CellCounts::proximity_unit;
      });
      input.around.time = input.now;
    }
    input.goal.reset();
    if (k == 20 && near == Near::table)
      input.goal = typename Scene::Goal{
          .goal = JointGoal<6>{JointPosition<6>(PerJoint{0.0, -0.3, 1.0, -1.8, -1.57, 0.3}), 3s}};
    const auto out = scene.step(*memory, input);
    measured.q = out.command.position;
    measured.dq = out.planned.velocity;
  }
}

struct Row {
  const char* name;
  void (*run)(int, bool);
};
constexpr Row rows[] = {
    {"main job by position, 125 Hz", [](int n, bool told) { run<false>(Near::nothing, n, told); }},
    {"the same, gone where the table is", [](int n, bool told) { run<false>(Near::table, n, told); }},
    {"with --clear, nothing near", [](int n, bool told) { run<true>(Near::nothing, n, told); }},
    {"with --clear, at the table", [](int n, bool told) { run<true>(Near::table, n, told); }},
    {"with --clear, six cells see a hand", [](int n, bool told) { run<true>(Near::hand, n, told); }},
};

}  // namespace

int main(int count, char** words) {
  if (count < 3) {
    for (const Row& row : rows) std::puts(row.name);
    return 0;
  }
  const auto which = static_cast<std::size_t>(std::atoi(words[1]));
  if (which >= std::size(rows)) return 2;
  rows[which].run(std::atoi(words[2]), std::strcmp(words[2], "time") == 0);
  return 0;
}
