// Every fault of the table, put into running scenes at random instants: `fault_injection [runs]`.
//
// A UR5 with 260 cells, pushed now and then, by position, velocity and torque; the fault lasts 6 to 60
// cycles. Counted: runs in which it was reported with its reason, answered as the table says (with brakes and
// stops checked joint by joint), and ended as the table says; and commands beyond a limit, not finite, or
// further than a cycle may step.
#include "tests/support/fault_injection.hpp"

#include <cstdio>
#include <cstdlib>

using namespace skinctl;
using namespace skinctl::test;

namespace {

template <Interface I>
int study(const char* interface, long runs, std::uint64_t seed) {
  FaultInjection<I> injection;
  oracle::Random random(seed);
  int wrong = 0;
  double worst = 0;
  long done = 0;
  int possible = 0;
  for (const Fault& f : faults) possible += injection.possible(f);
  std::printf("\n%s\n%-48s %-8s %-8s %-10s %6s %9s %8s %9s %7s\n", interface, "fault", "found by", "reaction",
              "way back", "runs", "reported", "reacted", "came back", "broken");
  for (const Fault& f : faults) {
    if (!injection.possible(f)) continue;
    Injected sum;
    for (long k = 0; k < (runs + possible - 1) / possible; ++k) injection.run(f, random, sum);
    const Reaction reaction = I == Interface::torque ? f.torque : f.motion;
    std::printf("%-48.48s %-8s %-8s %-10s %6d %9d %8d %9d %7d %s\n", f.what, name(f.finder), name(reaction),
                name(f.way_back), sum.runs, sum.reported, sum.reacted, sum.came_back, sum.broken,
                sum.first_bad.c_str());
    wrong += 4 * sum.runs - sum.reported - sum.reacted - sum.came_back - sum.runs + sum.broken;
    worst = std::max(worst, sum.worst_step);
    done += sum.runs;
  }
  std::printf("%ld runs, largest step %.9f of what a cycle may change\n", done, worst);
  return wrong;
}

}  // namespace

int main(int argc, char** argv) {
  const long runs = argc > 1 ? std::atol(argv[1]) : 100'000;
  int wrong = study<Interface::position>("position", runs / 3, 11);
  wrong += study<Interface::velocity>("velocity", runs / 3, 12);
  wrong += study<Interface::torque>("torque", runs - 2 * (runs / 3), 13);
  std::printf("\n%d wrong\n", wrong);
  return wrong == 0 ? 0 : 1;
}
