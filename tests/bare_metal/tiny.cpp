// The preset `tiny` on a Cortex-M4 with a floating-point unit for float: a UR5 with 260 cells that gives way
// to touch, at 125 Hz. Prints what a cycle costs in instructions (the emulator gives each of them a
// nanosecond of its clock), the memory, and what the start needs for tables. After the start nothing is
// allocated: the program fails if it is.
//
// Promise: a cycle of the preset `tiny` (UR5, 260 cells, float, one sub-step) takes at most 16 000
// instructions on a Cortex-M4, 22 000 while the leash holds a joint back, and nothing is allocated after the
// start
// Tried: seven cells pressed and released by an arm that follows, then pressed while it is held fast; an
// emulator that counts: 13 080 at the mean and at most 14 960, on the leash 20 480 and 20 840; 121 KB of
// heap at the start, 7 KB of memory
//
// Promise: it needs no operating system, exceptions or run-time types
// Tried: a whole cycle with 260 cells in float on an emulated Cortex-M7. Also: `bare_metal/`

#include <malloc.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/resolver/resolver_of.hpp"
#include "skinctl/robot/preset.hpp"
#include "skinctl/robots/ur5_skin.hpp"

using namespace skinctl;
using Chosen = preset::Tiny;
using Real32 = Chosen::scalar;

namespace {

bool running = false;
int asked_while_running = 0;

auto make_cycle() {
  const auto arm = by_position<Real32>(ur5::Model{},
                                       {.limits = limits_of<ur5::Description, Real32>(15.0f),
                                        .period = 8ms,
                                        .delay = 8ms,
                                        .virtual_damping = 4,
                                        .substep = Chosen::substep},
                                       CommandHistory<Chosen::commands>{});
  return Cycle(arm, ur5_skin<260, Real32>({.force = 20}), SkinJointControl{} + GravityControl{});
}
using Scene = decltype(make_cycle());
Scene::Memory memory;

#if defined(__arm__)
// The processor's own timer, at 25 MHz: 40 instructions a tick.
volatile std::uint32_t* const systick = reinterpret_cast<volatile std::uint32_t*>(0xE000E010);
void start_clock() {
  systick[1] = 0xFFFFFF;
  systick[2] = 0;
  systick[0] = 5;
}
std::uint32_t ticks() {
  return 0xFFFFFF - systick[2];
}
#else
void start_clock() {}
std::uint32_t ticks() {
  return 0;
}
#endif

}  // namespace

void* operator new(std::size_t bytes) {
  if (running) ++asked_while_running;
  void* const at = std::malloc(bytes);
  if (at == nullptr) std::abort();
  return at;
}
void operator delete(void* at) noexcept {
  std::free(at);
}
void operator delete(void* at, std::size_t) noexcept {
  std::free(at);
}

int main() {
  const auto cycle = make_cycle();
  State<6, Real32> measured;
  measured.q = {0.0f, -1.2f, 1.4f, -1.8f, -1.57f, 0.0f};
  cycle.start(memory, measured);
  auto under_way = measured.q;
  JointVelocity<6, Real32> speed_under_way;
  const auto at_start = mallinfo().arena;
  running = true;
  float farthest = 0;
  int bad = 0;
  // Of cycles in which no joint is on the leash, and of those in which one is: it is then taken out of the
  // virtual robot, by a mass matrix and a solution of six equations more.
  struct Spent {
    std::uint32_t all = 0, most = 0;
    int cycles = 0, most_at = 0;
    void add(std::uint32_t ticks, int k) {
      all += ticks, ++cycles;
      if (ticks > most) most = ticks, most_at = k;
    }
    void print(const char* what) const {
      std::printf("%s: mean %u, most %u (cycle %d)\n", what,
                  unsigned(cycles > 0 ? 40u * (all / unsigned(cycles)) : 0u), unsigned(40u * most), most_at);
    }
  } usual, leashed;
  constexpr int free_cycles = 250, cycles = 350;
  for (int k = 1; k <= cycles; ++k) {
    measured.time = k * 8ms;
    const bool holds = k > free_cycles;
    const float f = (k > 50 && k < 120) || holds ? 0.15f : 0.0f;
    CellSample samples[7];
    for (std::uint32_t i = 0; i < 7; ++i)
      samples[i] = {.time = measured.time - 2ms, .cell = 150 + i, .force = {f, f, f}};
    Scene::Input input;
    input.now = measured.time;
    input.measured = measured;
    input.samples = samples;
    start_clock();
    const auto out = cycle.step(memory, input);
    const std::uint32_t spent = ticks();
    (out.status.has(Reason::lead_limited) ? leashed : usual).add(spent, k);
    if (!out.command.valid) ++bad;
    for (std::size_t i = 0; i < 6; ++i)
      if (!(out.command.position[i] - out.command.position[i] == 0.0f)) ++bad;
    // As declared: what is sent now is reached a delay and a period from now.
    if (!holds) measured.q = under_way, measured.dq = speed_under_way;
    if (holds) measured.dq = {};
    under_way = out.command.position, speed_under_way = out.planned.velocity;
    const float moved = measured.q[0] < 0 ? -measured.q[0] : measured.q[0];
    if (moved > farthest) farthest = moved;
    if (k % 50 == 0)
      std::printf("%3d %7.4f %7.4f %7.4f\n", k, double(measured.q[0]), double(measured.q[1]),
                  double(measured.q[2]));
  }
  usual.print("instructions a cycle");
  leashed.print("on the leash");
  std::printf("bytes: memory %u, configuration %u, most at the start %u\n", unsigned(sizeof memory),
              unsigned(sizeof cycle), unsigned(at_start));
  std::printf("bad %d, asked for memory in the loop %d, farthest %.3f rad\n", bad, asked_while_running,
              double(farthest));
  const bool as_meant = usual.cycles > 150 && leashed.cycles > 50;
  return bad == 0 && asked_while_running == 0 && farthest > 0.001f && as_meant ? 0 : 1;
}
