// How many of many random scenes give more energy than they have, bare and with tank and passivity observer:
// `energy [scenes]`.
//
// A scene: a UR5 by position or velocity at 125, 250 or 500 Hz, 0 to 5 cycles of delay, skills and weights
// that jump, one or two walls or hands, half of them seen at 50 mm, and brakes of 1 to 20 rad/s^2. Each
// starts with 1 J at the measured port, and 1 J in the tank at the virtual one. Afterwards a hand leads the
// arm with 20 N: frozen is one that moves less than a twentieth as far as without anything that watches. By
// torque, at 1 kHz, the robot itself has the tank: with a touch that is paid for like all else, and with one
// that is answered for nothing (what it gives then counts twice).
#include <cstdio>
#include <cstdlib>

#include "bench/studies/worlds/torque_passivity.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

struct Row {
  const char* name;
  int broken = 0, broken_virtual = 0, faded = 0, held = 0;
  double worst = 0, worst_virtual = 0, path = 0, least_led = 1e9;
  int frozen = 0;

  void add(const RandomScene& scene, const Energies& e, const Energies& bare) {
    broken += e.extracted > scene.energy;
    broken_virtual += e.virtual_extracted > scene.tank;
    faded += e.status.has(Reason::tank_empty);
    held += e.status.has(Reason::energy_held);
    worst = std::max(worst, e.extracted);
    worst_virtual = std::max(worst_virtual, e.virtual_extracted);
    path += e.path;
    if (!(bare.led > 0.01)) return;
    least_led = std::min(least_led, e.led / bare.led);
    frozen += e.led < 0.05 * bare.led;
  }
  void add(const RandomScene& scene, const TorqueEnergies& e, double times) {
    broken += times * e.extracted > scene.tank;
    faded += e.status.has(Reason::tank_empty);
    worst = std::max(worst, times * e.extracted);
    path += e.path;
  }
};

template <Interface I>
void study(const char* interface, std::uint64_t scenes) {
  Row rows[4] = {{"nothing"}, {"tank"}, {"passivity_observer"}, {"tank and passivity_observer"}};
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    const RandomScene scene(seed);
    const auto passivity = scene.passivity();
    const auto tank = passivity.template get<EnergyTank<>>();
    const auto passivity_observer = passivity.template get<PassivityObserver<>>();
    const Energies bare = run<I>(scene, Passivity<>());
    rows[0].add(scene, bare, bare);
    rows[1].add(scene, run<I>(scene, Passivity(tank)), bare);
    rows[2].add(scene, run<I>(scene, Passivity(passivity_observer)), bare);
    rows[3].add(scene, run<I>(scene, passivity), bare);
  }
  for (const Row& r : rows)
    std::printf("| %s | %s | %d | %.3f | %d | %.3f | %d | %d | %.2f | %d | %.2f |\n", interface, r.name,
                r.broken, r.worst, r.broken_virtual, r.worst_virtual, r.faded, r.held,
                r.path / static_cast<double>(scenes), r.frozen, r.least_led);
}

void study_torque(std::uint64_t scenes) {
  Row rows[3] = {{"nothing"}, {"tank"}, {"tank, touch for nothing"}};
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    const RandomScene scene(seed);
    const auto tank = [&](double port_gain) {
      return Passivity(EnergyTank<>({.start = scene.tank, .max = scene.tank, .port_gain = port_gain}));
    };
    rows[0].add(scene, run_torque(scene, Passivity<>()), 1);
    rows[1].add(scene, run_torque(scene, tank(0)), 1);
    rows[2].add(scene, run_torque(scene, tank(1)), 2);
  }
  for (const Row& r : rows)
    std::printf("| torque | %s | %d | %.3f | - | - | %d | - | %.2f | - | - |\n", r.name, r.broken, r.worst,
                r.faded, r.path / static_cast<double>(scenes));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t scenes = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10000;
  std::printf("%llu scenes, 1 J at each port\n\n", static_cast<unsigned long long>(scenes));
  std::printf(
      "| interface | kept by | scenes that gave more | most given [J] | at the virtual port | most given "
      "there "
      "[J] | tank empty | held | way of joint 0 [rad] | frozen | least led |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  study<Interface::position>("position", scenes);
  study<Interface::velocity>("velocity", scenes);
  study_torque(scenes);
}
