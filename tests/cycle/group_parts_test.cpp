// Robots whose joints have several interfaces, with all their parts at once.
#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "tests/support/grouped_scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("Groups: with all parts at once, whatever comes in, commands stay finite and within their steps") {
  const std::vector<PlacedCell<2>> cells{{1, {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {0.05, 0, 0}}}};
  const Skin<Model3, double, Patch<2, 1>> skin{Patch<2, 1>(cells, {.force = 100})};
  const auto scene =
      Cycle(robot(EnergyTank{}, PassivityObserver{}), skin, Pull{{5, 3, 0.1}, {}, {}})
          .with(MaxToolSpeed<2>{0.5, {tip[0], tip[1], tip[2]}, 0.7}, MaxJerk{JointJerk<3>::constant(2000)});
  static_assert(std::is_trivially_copyable_v<decltype(scene)::Memory>);
  std::mt19937_64 rng(5);
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  const double wrong[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                          -1e300, 1e-310, 7};
  Run run{scene};
  JointCommand<3> last = run.memory.robot.command();
  std::uint64_t allocated = 0;
  bool good = true;
  for (int k = 0; k < 20000; ++k) {
    run.plant.run(2e-3, 4, [](const auto&, const auto&) { return JointTorque<3>{}; });
    decltype(run.scene)::Input input;
    input.measured = {run.measured.time += 2ms, run.plant.q(), run.plant.dq()};
    input.now = run.measured.time;
    const bool bad = k > 10 && k % 1000 < 200;  // a bad first state has no command at all
    if (bad && rng() % 4 == 0) input.measured.q[rng() % 3] = wrong[rng() % 5];
    if (bad && rng() % 4 == 0) input.measured.dq[rng() % 3] = wrong[rng() % 5];
    if (bad && rng() % 16 == 0) input.now += Nanoseconds(std::int64_t(roll(-1e8, 1e8)));
    if (k % 1000 == 300) input.request = CycleRequest::resume;
    const float f = bad && rng() % 8 == 0 ? float(wrong[rng() % 5]) : float(roll(0, 0.1));
    const CellSample sample{.time = input.now - 1ms, .cell = 1, .force = {f, f, f}};
    input.samples = std::span(&sample, 1);
    const AllocationGuard guard;
    const auto out = run.scene.step(run.memory, input);
    allocated += guard.count();
    for (std::size_t i = 0; i < 3; ++i) {
      good = good && out.command.valid && std::isfinite(out.command.position[i]) &&
             std::isfinite(out.command.velocity[i]) && std::isfinite(out.command.torque[i]);
      // The longest interval is five periods.
      if (i < 2)
        good = good && std::abs(out.command.velocity[i] - last.velocity[i]) <= 40 * 0.01 * (1 + 1e-9) &&
               std::abs(out.command.velocity[i]) <= 3 * (1 + 1e-9);
      if (i == 2)
        good = good && std::abs(out.command.torque[i] - last.torque[i]) <= 50 * 0.7 * 0.01 * (1 + 1e-9) &&
               std::abs(out.command.torque[i]) <= 0.7;
    }
    if (!good) {
      CAPTURE(k);
      CHECK(good);
      break;
    }
    if (k % 1000 == 999) CHECK_FALSE(out.status.has(Reason::consent_awaited));  // it goes on again
    last = out.planned;
    run.plant.command(out.planned);
  }
  CHECK(allocated == 0);
  // A robot by torque has the tank too.
  const auto whole = by_torque(Model3{}, RobotConfiguration<3>{.limits = limits<3>(50), .period = 2ms},
                               RobotCompensatesFriction{}, EnergyTank{});
  Run torques{Cycle(whole, skin, Pull{{1, 1, 0}, {}, {}})};
  torques.cycle();
  CHECK(torques.out.command.valid);
}
