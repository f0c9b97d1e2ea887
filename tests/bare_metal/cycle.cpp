// A whole cycle without operating system, exceptions and run-time types, in float: 260 cells, a push, a
// position command.
#include "skinctl/cycle/cycle.hpp"

#include <cstdio>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5_skin.hpp"

using namespace skinctl;

namespace {

auto make_cycle() {
  const auto arm = by_position<float>(ur5::Model{}, {.limits = limits_of<ur5::Description, float>(15.0f),
                                                     .period = 8ms,
                                                     .delay = 8ms,
                                                     .virtual_damping = 4});
  return Cycle(arm, ur5_skin<260, float>({.force = 20}),
               SplineJoint(arm) + SkinJointControl{} + GravityControl{});
}
using Scene = decltype(make_cycle());
Scene::Memory memory;  // too large for a small stack

}  // namespace

int main() {
  const auto cycle = make_cycle();
  State<6, float> measured;
  measured.q = {0.0f, -1.2f, 1.4f, -1.8f, -1.57f, 0.0f};
  cycle.start(memory, measured);
  const std::uint32_t cell = 150;
  float farthest = 0;
  int bad = 0;
  for (int k = 1; k <= 250; ++k) {
    measured.time = k * 8ms;
    const float f = k > 50 && k < 120 ? 0.15f : 0.0f;
    const CellSample sample{.time = measured.time - 2ms, .cell = cell, .force = {f, f, f}};
    Scene::Input input;
    input.now = measured.time;
    input.measured = measured;
    input.samples = {&sample, 1};
    const auto out = cycle.step(memory, input);
    if (!out.command.valid) ++bad;
    for (std::size_t i = 0; i < 6; ++i) {
      const float x = out.command.position[i];
      if (!(x - x == 0.0f)) ++bad;
    }
    measured.q = out.command.position;
    const float moved = measured.q[0] < 0 ? -measured.q[0] : measured.q[0];
    if (moved > farthest) farthest = moved;
    if (k % 50 == 0)
      std::printf("%3d %7.4f %7.4f %7.4f\n", k, double(measured.q[0]), double(measured.q[1]),
                  double(measured.q[2]));
  }
  std::printf("bad %d, farthest %.3f rad\n", bad, double(farthest));
  return bad == 0 && farthest > 0.001f ? 0 : 1;
}
