// A law of one's own that sees its scene: alone, in sums, behind gates and other laws, in skills, in several
// configurations.
#include <doctest/doctest.h>

#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/posture.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/cycle/configurations.hpp"
#include "skinctl/fusion/blended.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/fusion/null_space.hpp"
#include "skinctl/law/wrapped_law.hpp"
#include "skinctl/recording/recording.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/skills/library.hpp"

using namespace skinctl;

namespace {
/// What it adds to the input: a light that is on or off.
struct Light {
  bool on = false;

  template <class F>
  friend void each_number(Light& light, F&& f) {
    f(light.on);
  }
};
/// And to the output: how often it has seen the light.
struct Seen {
  int often = 0;
};
struct SeenToo {
  int too = 0;
};
/// Pushes the first joint while the light is on.
template <int Number>
struct Follows : Composable {
  using Input = Light;
  using Output = std::conditional_t<Number == 0, Seen, SeenToo>;
  struct Memory {
    bool on = false;
    int often = 0;
  };
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class Seen>
  Status see(Memory& m, const Light& light, const Seen&) const noexcept {
    m.on = light.on;
    m.often += light.on;
    return light.on ? Status(Reason::slowed) : Status();
  }
  Output output(const Memory& m) const noexcept { return {m.often}; }
  template <class K>
  JointTorque<6> torque(const Memory& m, const K&) const noexcept {
    JointTorque<6> tau;
    tau[0] = m.on ? 1.0 : 0.0;
    return tau;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};
template <class L>
struct Wrapper : WrappedLaw<Wrapper<L>, L> {
  struct Memory : L::Memory {};
  explicit Wrapper(const L& law) : WrappedLaw<Wrapper, L>(law) {}
};
const RobotConfiguration<6> configuration{
    .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 6};
const auto arm = by_position(ur5::Model{}, configuration);

struct Rest {
  static constexpr const char* name = "rest";
};
struct Following {
  static constexpr const char* name = "following";
};

/// What the joint has done with the light on in cycles 10 to 19, and what the output says.
struct Ran {
  double moved = 0;
  int often = 0, told = 0;
  std::size_t different = 1;
};
template <class Scene>
Ran run(const Scene& scene) {
  const auto m = std::make_unique<typename Scene::Memory>();
  State<6> state;
  state.q = {0.1, -1.2, 1.4, -1.0, -1.5, 0.2};
  scene.start(*m, state);
  Recording<Scene> recording(1 << 20);
  recording.start(state);
  Ran ran;
  for (int k = 1; k <= 40; ++k) {
    typename Scene::Input input;
    input.now = k * 8ms, input.measured = state, input.measured.time = input.now;
    input.on = k >= 10 && k < 20;
    const auto out = scene.step(*m, input);
    recording.add(input, out.planned);
    state.q = out.planned.position, state.dq = out.planned.velocity;
    ran.often = out.often;
    ran.told += out.status.has(Reason::slowed);
  }
  ran.moved = state.q[0] - 0.1;
  ran.different = replay(scene, recording).different;
  return ran;
}
template <class Law>
Ran run_law(const Law& law) {
  return run(Cycle(arm, law));
}
}  // namespace

TEST_CASE("A law sees its scene wherever it stands, and what it saw is recorded") {
  const Follows<0> law;
  const auto lone = run_law(law + GravityControl{});
  CHECK(lone.moved > 1e-4);
  CHECK(lone.often == 10);
  CHECK(lone.told == 10);
  const SplineJoint<6> reach(arm);
  const auto skills = skill_set<Following>(
      boost::hana::make_map(skill<Rest>(recipe(load<controller::Gravity>())),
                            skill<Following>(recipe(load<controller::Gravity>(), load<Following>()))),
      {}, skill_controller<controller::Gravity>(GravityControl{}), skill_controller<Following>(law));
  const auto sum = law + GravityControl{};
  int kind = 0;
  for (const Ran& ran :
       {lone, run_law(Wrapper(law) + GravityControl{}), run_law(blended(sum)), run_law(skills),
        run_law(Wrapper(sum)), run(Configurations(Cycle(arm, sum), Cycle(arm, sum))),
        run(Configurations(Cycle(arm, skills), Cycle(arm, skills)))}) {
    CAPTURE(kind++);
    CHECK(ran.often == 10);
    CHECK(ran.told >= 10);
    CHECK(ran.moved == lone.moved);
    CHECK(ran.different == 0);
  }
  for (const Ran& ran : {run_law(reach + law), run_law(task_priority<5>(reach, law)),
                         run_law(blended(reach + law + GravityControl{}))}) {
    CAPTURE(kind++);
    CHECK(ran.often == 10);
    CHECK(ran.told >= 10);
    CHECK(ran.different == 0);
  }
}

TEST_CASE("Two laws that add the same to the input read the same") {
  const auto both = run_law(Follows<0>{} + Follows<1>{} + GravityControl{});
  const auto lone = run_law(2 * Follows<0>{} + GravityControl{});
  CHECK(both.moved == doctest::Approx(lone.moved));
  CHECK(both.different == 0);
  using Both = decltype(Cycle(arm, Follows<0>{} + Follows<1>{} + GravityControl{}))::Output;
  static_assert(std::is_base_of_v<Seen, Both> && std::is_base_of_v<SeenToo, Both>);
}
