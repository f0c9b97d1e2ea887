// Arms of the playground, run for some seconds.
#pragma once

#include <algorithm>
#include <cmath>

#include "examples/playground/playground.hpp"
#include "skinctl/testing/allocation_guard.hpp"

namespace playground {

inline const Scenario& scenario() {
  static const Scenario s = read_scenarios(WITH_SKIN, WITHOUT_SKIN);
  return s;
}

/// Arms that run, and what they did.
struct Run {
  explicit Run(const Choice& choice) : arms(make_arms(scenario(), choice, scenario().places.back())) {
    run(1);
  }
  Run(const Choice& choice, const Robot& robot) : arms(make_arms(scenario(), choice, robot)) { run(1); }
  /// Cycles for so many seconds; their largest force of this arm, and of the rigid one, is kept.
  void run(double seconds) {
    const double end = view.time + seconds;
    const skinctl::testing::AllocationGuard guard;
    do {
      arms->cycle(view);
      away = std::max(away, view.away);
    } while (view.time < end);
    allocations += guard.count();
  }
  void press(std::size_t cell) {
    const auto c = arms->cell(cell);
    const skinctl::testing::AllocationGuard guard;
    arms->press(static_cast<std::size_t>(c[0]), &c[1], &c[4]);
    allocations += guard.count();
  }
  std::unique_ptr<Arms> arms;
  View view;
  double away = 0;
  std::uint64_t allocations = 0;
};

}  // namespace playground
