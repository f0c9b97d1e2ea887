// How many of many random scenes give more energy than they have, bare and with tank and ledger: `energy
// [scenes]`.
//
// A scene: a UR5 by position or velocity at 125, 250 or 500 Hz, 0 to 5 cycles of delay, skills and weights
// that jump, one or two walls or hands. Each starts with 1 J at the measured port and 3 J in the tank.
#include <cstdio>
#include <cstdlib>

#include "tests/resolver/contact_scene.hpp"

using namespace skinctl;
using namespace skinctl::test;

namespace {

struct Row {
  const char* name;
  int broken = 0, faded = 0, held = 0;
  double worst = 0, path = 0;

  void add(const RandomScene& scene, const Energies& e) {
    broken += e.extracted > scene.energy;
    faded += e.status.has(Reason::tank_empty);
    held += e.status.has(Reason::energy_held);
    worst = std::max(worst, e.extracted);
    path += e.path;
  }
};

template <Interface I>
void study(const char* interface, std::uint64_t scenes) {
  Row rows[4] = {{"nothing"}, {"tank"}, {"ledger"}, {"tank and ledger"}};
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    const RandomScene scene(seed);
    const auto keeper = scene.keeper();
    const auto tank = keeper.template get<EnergyTank<>>();
    const auto ledger = keeper.template get<PortLedger<>>();
    rows[0].add(scene, run<I>(scene, Passivity<>()));
    rows[1].add(scene, run<I>(scene, Passivity(tank)));
    rows[2].add(scene, run<I>(scene, Passivity(ledger)));
    rows[3].add(scene, run<I>(scene, keeper));
  }
  for (const Row& r : rows)
    std::printf("| %s | %s | %d | %.3f | %d | %d | %.2f |\n", interface, r.name, r.broken, r.worst, r.faded,
                r.held, r.path / static_cast<double>(scenes));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t scenes = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10000;
  std::printf("%llu scenes, 1 J at the port\n\n", static_cast<unsigned long long>(scenes));
  std::printf(
      "| interface | kept by | scenes that gave more | most given [J] | tank empty | held | way of joint 0 "
      "[rad] |\n"
      "|---|---|---|---|---|---|---|\n");
  study<Interface::position>("position", scenes);
  study<Interface::velocity>("velocity", scenes);
}
