// One cycle of a whole scene with error bounds, at single states.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include "skinctl/math/bound.hpp"
#include "skinctl/testing/scene.hpp"

namespace skinctl::bounds {

struct Touched {
  std::array<float, 6> q;
  std::array<float, 3> force;
};

/// The command of the first cycle of a UR5 whose skin is touched: skin, gravity, four sub-steps, limits, guard.
template <class T>
std::array<T, 6> first_command(const Touched& at) {
  const auto scene = testing::kinesthetic_scene<Interface::position, 260, T>();
  using Scene = std::remove_cvref_t<decltype(scene)>;
  State<6, T> state;
  for (std::size_t i = 0; i < 6; ++i) state.q[i] = T(at.q[i]);
  auto memory = std::make_unique<typename Scene::Memory>(scene.start(state));
  typename Scene::Input input;
  input.now = state.time = 8ms;
  input.measured = state;
  std::array<CellSample, 3> samples;
  for (std::size_t i = 0; i < 3; ++i)
    samples[i] = {
        .time = 7ms, .cell = static_cast<std::uint32_t>(20 + 80 * i), .force = {at.force[i], 0.1f, 0}};
  input.samples = samples;
  const auto out = scene.step(*memory, input);
  std::array<T, 6> q;
  for (std::size_t i = 0; i < 6; ++i) q[i] = out.command.position[i];
  return q;
}

template <class R, class Wide>
void print_one_cycle(const char* name, int states) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> angle(-2.5f, 2.5f), force(0, 0.5f);
  double found = 0, proven = 0;
  std::uint64_t open = 0;
  int bounded = 0;
  for (int k = 0; k < states; ++k) {
    Touched at;
    for (auto& q : at.q) q = angle(rng);
    for (auto& f : at.force) f = force(rng);
    math::undecided() = 0;
    const auto bound = first_command<math::Bound<R>>(at);
    open += math::undecided();
    const auto computed = first_command<R>(at);
    const auto exact = first_command<Wide>(at);
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      found = std::max(found, std::abs(static_cast<double>(static_cast<Wide>(computed[i]) - exact[i])));
      most = std::max(most, bound[i].error());
    }
    if (std::isfinite(most)) ++bounded, proven = std::max(proven, most);
  }
  std::printf("one cycle, %-6s    rad [%.2e, %.2e], %d of %d states, %.1f comparisons a state left open\n",
              name, found, proven, bounded, states, static_cast<double>(open) / states);
}
inline void print_one_cycle() {
  std::printf(
      "\nThe command of one cycle of a UR5 with 260 cells, three of them touched, at random states:\n");
  print_one_cycle<float, double>("float", 200);
  print_one_cycle<double, long double>("double", 200);
}

}  // namespace skinctl::bounds
