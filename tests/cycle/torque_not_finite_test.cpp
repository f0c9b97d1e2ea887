// The torque beside the commanded motion, which robots may take as feed-forward, while a law gives no number.
#include <doctest/doctest.h>

#include "tests/support/grouped_scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Holds the arm; from 0.1 s on for five cycles one joint's torque is no number.
struct Fails : Pull {
  double wrong = 0;
  std::size_t joint = 0;
  template <class K>
  JointTorque<3> torque(const Pull::Memory& m, const K& known) const noexcept {
    auto out = Pull::torque(m, known);
    const double t = seconds<double>(known.time());
    if (t > 0.1 && t < 0.1099) out[joint] = wrong;
    return out;
  }
};

// The largest change of the torque beside the motion of the joints 0 to `moved` in one cycle [N m], of a
// robot that follows at once; the loop observes `fault` for ten cycles.
template <class Scene>
double torque_step(const Scene& scene, std::size_t moved, Reason expected, Status fault = {}) {
  State<3> state{0ns, {0.2, 0.3, 0.5}, {}};
  auto memory = scene.start(state);
  double most = 0;
  Status seen;
  JointTorque<3> last;
  for (int k = 1; k < 100; ++k) {
    typename Scene::Input input;
    input.now = state.time = k * 2ms;
    input.measured = state;
    if (k > 50 && k <= 60) input.observed = fault;
    const auto out = scene.step(memory, input);
    REQUIRE(out.command.valid);
    seen |= out.status;
    for (std::size_t i = 0; i < moved; ++i) {
      if (k > 1) most = std::max(most, std::abs(out.planned.torque[i] - last[i]));
      state.q[i] = out.planned.position[i];
      state.dq[i] = out.planned.velocity[i];
    }
    last = out.planned.torque;
  }
  CHECK(seen.has(expected));
  CHECK(std::abs(last[0]) > 1);  // it says something
  return most;
}

RobotConfiguration<3> all_stiff() {
  RobotConfiguration<3> c{.limits = limits<3>(150), .period = 2ms};
  c.virtual_damping = 5;
  return c;
}

}  // namespace

TEST_CASE("torque beside the motion: a law that gives no number leaves the last finite one") {
  for (const double wrong : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (const std::size_t joint : {0u, 1u, 2u}) {
      CAPTURE(wrong);
      CAPTURE(joint);
      const Fails law{{{4, -3, 0}, {}, {}}, wrong, joint};
      const auto steps = [&](const auto& arm, std::size_t moved) {
        return torque_step(Cycle(arm, law), moved, Reason::torque_not_finite);
      };
      CHECK(steps(by_position(Model3{}, all_stiff()), 3) < 0.5);
      CHECK(steps(by_velocity(Model3{}, all_stiff()), 3) < 0.5);
      CHECK(steps(robot(), 2) < 0.5);
    }
}

TEST_CASE("torque beside the motion: a guard that brakes leaves it, too") {
  const Pull law{{4, -3, 0}, {}, {}};
  const auto steps = [&](const auto& arm, std::size_t moved) {
    const Reason late = Reason::work_skipped;
    return torque_step(Cycle(arm, law).with(GuardSettings<3>{.brakes_on = late}), moved, late, late);
  };
  CHECK(steps(by_position(Model3{}, all_stiff()), 3) < 0.5);
  CHECK(steps(by_velocity(Model3{}, all_stiff()), 3) < 0.5);
  CHECK(steps(robot(), 2) < 0.5);
}
