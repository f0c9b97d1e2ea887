// Evaluates one scene of a UR5 so many times: what `instructions` runs under callgrind.
//
//     scenes            prints the names of the scenes, one a line
//     scenes I N        evaluates the I-th scene N times
//     scenes I time     prints what the I-th scene requires, its bytes, and its times: hot, and cold with code and data flushed
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "bench/support/cold.hpp"
#include "skinctl/skinctl.hpp"
#include "skinctl/testing/needs_read.hpp"

using namespace skinctl;
using skinctl::testing::in_words;

namespace {

using Arm = ur5::Model;
constexpr Arm arm;

/// The compiler must have the value in memory, and cannot know it afterwards.
template <class V>
void keep(V& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

/// What a scene requires, its data, and its times.
struct Found {
  std::string terms;
  std::size_t bytes = 0;
  double hot = 0, cold = 0;  ///< [us]
};
Found found;
bool timed = false;

/// Runs `once` so many times, or times it; `data` is what it reads and writes.
template <class F>
void repeat(int times, const void* data, std::size_t bytes, const std::string& terms, F&& once) {
  if (!timed) {
    for (int i = 0; i < times; ++i) once();
    return;
  }
  found = {terms, bytes, bench::hot(once), bench::cold(once, data, bytes)};
}

/// What a law that asks for `Asked` costs, and nothing else.
template <Needs Asked>
void known(int times) {
  State<6> state{1ms, {0.3, -1.2, 1.4, -1.8, -1.57, 0.3}, {0.1, 0.2, -0.3, 0.1, 0.2, -0.1}};
  const NoTouch touch;
  repeat(times, &state, sizeof state, in_words(complete<Arm>(Asked)), [&] {
    keep(state);
    const Quantities<Arm, Asked> all(arm, state, 0.002, touch);
    keep(all);
  });
}
template <class F>
void each(int times, F&& f) {
  State<6> state{1ms, {0.3, -1.2, 1.4, -1.8, -1.57, 0.3}, {0.1, 0.2, -0.3, 0.1, 0.2, -0.1}};
  repeat(times, &state, sizeof state, "angles", [&] {
    keep(state);
    const auto result = f(state);
    keep(result);
  });
}

/// Cycles at 500 Hz without a new sample: one evaluation of the laws, one sub-step, the guard.
template <class L, class Skin, class... Parts>
void cycles(int times, const L& law, const Skin& skin, const Parts&... parts) {
  const auto robot = by_position(
      arm, {.limits = limits_of<ur5::Description>(15.0), .period = 2ms, .delay = 8ms, .virtual_damping = 0});
  const auto cycle = [&] {
    if constexpr (sizeof...(parts) > 0) {
      return Cycle(robot, skin, law).with(parts...);
    } else {
      return Cycle(robot, skin, law);
    }
  }();
  using Scene = decltype(cycle);
  struct Both {
    Scene cycle;
    typename Scene::Memory memory;
  };
  const auto both = std::make_unique<Both>(Both{cycle, {}});
  State<6> state{1ms, {0.3, -1.2, 1.4, -1.8, -1.57, 0.3}, {}};
  cycle.start(both->memory, state);
  typename Scene::Input input{};
  repeat(times, both.get(), sizeof(Both), in_words(Scene::Known::needs), [&] {
    state.time += 2ms;
    input.now = state.time;
    input.measured = state;
    const auto out = both->cycle.step(both->memory, input);
    keep(out);
  });
}

struct Scene {
  const char* name;
  void (*run)(int);
};
constexpr LinkMask first_three = link_bit<0> | link_bit<1> | link_bit<2>;
constexpr LinkMask all_six = first_three | link_bit<3> | link_bit<4> | link_bit<5>;
const Scene scenes[] = {
    {"poses of links 1 to 3", [](int n) { known<Needs{.poses = first_three}>(n); }},
    {"poses of all links", [](int n) { known<Needs{.poses = all_six}>(n); }},
    {"Jacobian of link 6 (its links' poses)", [](int n) { known<Needs{.jacobians = link_bit<5>}>(n); }},
    {"gravity", [](int n) { known<Needs{.gravity = true}>(n); }},
    {"gravity, and poses of links 1 to 3",
     [](int n) { known<Needs{.poses = first_three, .gravity = true}>(n); }},
    {"mass matrix", [](int n) { known<Needs{.mass = true}>(n); }},
    {"C dq", [](int n) { known<Needs{.coriolis = true}>(n); }},
    {"all poses, gravity, mass matrix, C dq",
     [](int n) { known<Needs{.poses = all_six, .gravity = true, .mass = true, .coriolis = true}>(n); }},
    {"inverse dynamics",
     [](int n) {
       each(n, [](const State<6>& s) {
         return inverse_dynamics(arm, s.q, s.dq, JointAcceleration<6>{0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
       });
     }},
    {"forward dynamics",
     [](int n) {
       each(n, [](const State<6>& s) { return forward_dynamics(arm, s.q, s.dq, JointTorque<6>{}); });
     }},
    {"cycle: gravity", [](int n) { cycles(n, GravityControl{}, NoSkin{}); }},
    {"cycle: spline joint + gravity",
     [](int n) { cycles(n, SplineJoint<6>() + GravityControl{}, NoSkin{}); }},
    {"cycle: skin joint + gravity, 260 cells at rest",
     [](int n) { cycles(n, SkinJointControl{} + GravityControl{}, ur5_skin<260>({.force = 20})); }},
    {"cycle: spline joint + skin joint + gravity, 260 cells at rest",
     [](int n) {
       cycles(n, SplineJoint<6>() + SkinJointControl{} + GravityControl{}, ur5_skin<260>({.force = 20}));
     }},
    {"cycle: the same, with a watch over the cells that only reports",
     [](int n) {
       constexpr SkinReaction report = SkinReaction::report;
       cycles(n, SplineJoint<6>() + SkinJointControl{} + GravityControl{}, ur5_skin<260>({.force = 20}),
              SkinWatch{.unheard = report, .blind = report, .incomplete = report});
     }},
    {"cycle: spline joint + skin joint + gravity, 1260 cells at rest",
     [](int n) {
       cycles(n, SplineJoint<6>() + SkinJointControl{} + GravityControl{}, ur5_skin<1260>({.force = 20}));
     }},
    {"cycle: the same, with a watch over the cells that only reports",
     [](int n) {
       constexpr SkinReaction report = SkinReaction::report;
       cycles(n, SplineJoint<6>() + SkinJointControl{} + GravityControl{}, ur5_skin<1260>({.force = 20}),
              SkinWatch{.unheard = report, .blind = report, .incomplete = report});
     }},
};

}  // namespace

int main(int count, char** words) {
  if (count == 1) {
    for (const Scene& scene : scenes) std::puts(scene.name);
    return 0;
  }
  const auto i = count == 3 ? std::strtoul(words[1], nullptr, 10) : std::size(scenes);
  timed = count == 3 && std::strcmp(words[2], "time") == 0;
  const auto times = count == 3 ? std::strtol(words[2], nullptr, 10) : 0;
  if (i >= std::size(scenes) || times < 0 || times > 1000000) {
    std::fprintf(stderr, "scenes [I N]: the I-th of %zu scenes, N <= 1000000 times\n", std::size(scenes));
    return 2;
  }
  scenes[i].run(static_cast<int>(times));
  if (timed) std::printf("%s|%zu|%.3f|%.2f\n", found.terms.c_str(), found.bytes, found.hot, found.cold);
  return 0;
}
