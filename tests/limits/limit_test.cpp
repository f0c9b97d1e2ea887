// A limit of a user's own, with an input, in scenes of every kind.
//
// Promise: a limit of a user's own is one struct: it acts alone, beside others, in configurations, with
// an input of its own; a part is taken out by its kind
// Tried: by position with jerk, clearance, two configurations; the input of other scenes does not grow.
// Also: `cycle/scene_parts_test.cpp`

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/support/ur5_clearance.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// What a scanner of the room adds to the input.
struct Scanned {
  double nearest = 10;  ///< distance of the nearest person [m]
};
/// No joint is faster than `rate` times the distance of the nearest person; nearer than `stop` the robot
/// holds.
struct NearPeople {
  using Kind = NearPeople;
  using Input = Scanned;
  struct Memory {
    double nearest = 10;
  };
  static constexpr Precedence precedence = Precedence::free;
  double rate = 0.5, stop = 0.5;

  template <class In, class Q>
  void see(Memory& m, const In& input, const Q&, Nanoseconds) const noexcept {
    m.nearest = input.nearest;
  }
  [[nodiscard]] bool stays(const Memory& m) const noexcept { return m.nearest < stop; }
  template <class Going, class Seen, class U>
  [[nodiscard]] SpeedShare<double> share(Memory& m, const Going&, const Seen&, const U& u) const noexcept {
    double fastest = 0;
    for (const double v : u) fastest = std::max(fastest, std::abs(v));
    const double most = rate * m.nearest;
    return {fastest > most ? most / fastest : 1.0, {}};
  }
};

/// The same by what the skin of the forearm sees; its types are deduced.
struct NearSkin {
  using Kind = NearSkin;
  struct Memory {};
  static constexpr Precedence precedence = Precedence::free;

  template <class Going, class Seen, class U>
  [[nodiscard]] auto share(Memory&, const Going&, const Seen& seen, const U& u) const noexcept {
    double fastest = 0;
    for (const double v : u) fastest = std::max(fastest, std::abs(v));
    const bool near = seen.template max_proximity<2>() > 0.5 && seen.now > 0ns;
    return SpeedShare<double>{near && fastest > 0.1 ? 0.1 / fastest : 1.0, {}};
  }
};

const RobotConfiguration<6> numbers{
    .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4};
auto plain() {
  const auto arm = by_position(ur5::Model{}, numbers);
  return Cycle(arm, SplineJoint<6>(tracking_settings(arm)) + GravityControl{});
}

/// The largest speed of the commands on the way to a goal, and of the last one, with a person at `nearest`.
template <class Scene>
std::pair<double, double> run(const Scene& scene, double nearest) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> at{.time = 0ns, .q = {0.0, -1.2, 1.4, -1.8, -1.57, 0.3}, .dq = {}};
  scene.start(*memory, at);
  double fastest = 0, last = 0;
  for (int k = 1; k <= 125; ++k) {
    typename Scene::Input input;
    input.now = at.time = k * 8ms;
    input.measured = at;
    if (k == 1) input.goal = {JointGoal<6>{{1.0, -1.2, 1.4, -1.8, -1.57, 0.3}, 1s}};
    if constexpr (requires { input.around; }) input.around.time = input.now;
    input.nearest = nearest;
    const auto out = scene.step(*memory, input);
    at.q = out.planned.position, at.dq = out.planned.velocity;
    last = std::abs(out.planned.velocity[0]);
    fastest = std::max(fastest, last);
  }
  return {fastest, last};
}

template <class Scene>
void slows(const Scene& scene) {
  const auto free = run(scene, 10).first, near = run(scene, 0.6).first, held = run(scene, 0.4).second;
  CHECK(free > 0.9);
  CHECK(near <= 0.31);  // a smooth motion overshoots a little
  CHECK(near > 0.28);
  CHECK(held < 1e-6);
}

}  // namespace

TEST_CASE("A limit of a user's own is one struct: it acts alone, beside others and in configurations") {
  slows(plain().with(NearPeople{}));
  slows(plain().with(MaxJerk{JointJerk<6>::constant(800)}).with(NearPeople{}));
  slows(plain().with(NearPeople{}, ur5_clearance<4>()));
  slows(Configurations(plain().with(NearPeople{}), plain().with(NearPeople{})));
  slows(Configurations(plain().with(NearPeople{}, ur5_clearance<4>()),
                       plain().with(NearPeople{}, ur5_clearance<4>())));
}

TEST_CASE("A limit sees by the skin, whether its types are written or deduced") {
  const auto arm = by_position(ur5::Model{}, numbers);
  const auto scene =
      Cycle(arm, ur5_skin<260>({.force = 20}), SplineJoint<6>(tracking_settings(arm)) + GravityControl{})
          .with(NearSkin{});
  const auto fastest = [&](float proximity) {
    const auto memory = std::make_unique<typename std::remove_const_t<decltype(scene)>::Memory>();
    State<6> at{.time = 0ns, .q = {0.0, -1.2, 1.4, -1.8, -1.57, 0.3}, .dq = {}};
    scene.start(*memory, at);
    double most = 0;
    for (int k = 1; k <= 100; ++k) {
      std::vector<CellSample> samples;
      for (std::uint32_t cell = 0; cell < 260; ++cell)
        samples.push_back({.time = k * 8ms - 1ms, .cell = cell, .force = {}, .proximity = proximity});
      typename std::remove_const_t<decltype(scene)>::Input input;
      input.now = at.time = k * 8ms;
      input.measured = at;
      input.samples = samples;
      if (k == 1) input.goal = {JointGoal<6>{{1.0, -1.2, 1.4, -1.8, -1.57, 0.3}, 1s}};
      const auto out = scene.step(*memory, input);
      at.q = out.planned.position, at.dq = out.planned.velocity;
      most = std::max(most, std::abs(out.planned.velocity[0]));
    }
    return most;
  };
  CHECK(fastest(0) > 0.9);
  CHECK(fastest(0.8F) < 0.11);
}

TEST_CASE("A limit adds its input to a scene, and to no other; taken out, it is gone") {
  using With = decltype(plain().with(NearPeople{}));
  CHECK(std::is_base_of_v<Scanned, With::Input>);
  CHECK_FALSE(std::is_base_of_v<Scanned, decltype(plain())::Input>);
  CHECK(std::is_same_v<decltype(plain().with(NearPeople{}).without<NearPeople>()), decltype(plain())>);
  CHECK(std::is_trivially_copyable_v<With::Memory>);
}
