// A day of a robot at 1 kHz in float: random skills, goals and touches; every ten minutes it goes home, is
// left alone, and must stand still. Beside it another that only holds its pose.
//
//     nightly [HOURS = 24] [SEED = 1]
//
// Returns 1 if an integral leaves its bounds, the arm at rest drifts by more than 1e-6 rad, or a command is
// bad.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "bench/studies/worlds/skilled_scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

int main(int argc, char** argv) {
  const double hours = argc > 1 ? std::atof(argv[1]) : 24;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const auto scene = skilled_scene<float>(1ms);
  using Scene = std::remove_const_t<decltype(scene)>;
  SkilledDay<Scene> day(scene, 1ms, seed), holding(scene, 1ms, seed);
  const auto began = std::chrono::steady_clock::now();
  const auto far = [](const auto& a, const auto& b) {
    double most = 0;
    for (std::size_t i = 0; i < 6; ++i)
      most = std::max(most, static_cast<double>(detail::magnitude(a[i] - b[i])));
    return most;
  };

  double drift = 0, held = 0, integrals = 0, astray = 0;
  std::uint64_t bad = 0, changes = 0, touched = 0;
  std::uint8_t skill = 0;
  JointPosition<6, float> rest, first;
  const auto cycles = static_cast<std::uint64_t>(hours * 3600e3);
  for (std::uint64_t k = 0; k < cycles; ++k) {
    const std::uint64_t in_part = k % 600'000;  // ten minutes
    if (in_part < 540'000) day.happen();
    if (in_part == 540'000) day.release_all(), day.go_home();
    const auto out = day.step();
    if (in_part == 580'000) {
      rest = out.command.position;
      astray = std::max(astray, far(rest, home_position<float>()));
    }
    if (in_part > 580'000) drift = std::max(drift, far(out.command.position, rest));
    bad += !out.command.valid;
    for (const float q : out.command.position) bad += !(q - q == 0.0f);
    integrals = std::max(integrals, k % 16 == 0 ? day.integrals() : 0.0);
    changes += day.memory().law.skill != skill;
    skill = day.memory().law.skill;
    touched += day.memory().law.touch > 1;

    if (k == 0) holding.go_home();
    const auto hold = holding.step();
    if (k == 30'000) first = hold.command.position;
    if (k > 30'000) held = std::max(held, far(hold.command.position, first));

    if ((k + 1) % 3'600'000 == 0 || k + 1 == cycles) {
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
      std::printf(
          "%7.3f h: %llu changes, touched %.1f %% of the time; integrals %.3f of their limit; at rest: drift "
          "%.2g, "
          "from home %.2g rad; holding all the time: drift %.2g rad; bad commands %llu; %.0f s\n",
          static_cast<double>(k + 1) / 3600e3, static_cast<unsigned long long>(changes),
          100.0 * static_cast<double>(touched) / static_cast<double>(k + 1), integrals, drift, astray, held,
          static_cast<unsigned long long>(bad), took.count());
      std::fflush(stdout);
    }
  }
  return bad == 0 && drift <= 1e-6 && held <= 1e-6 && integrals <= 1.001 ? 0 : 1;
}
