// The torque that laws ask for by themselves turns at a bounded rate, what answers touch at once.
//
// Promise: the torque that laws ask for by themselves turns at a bounded rate; what answers touch is not
// delayed
// Tried: by position, velocity, torque: 50 torque limits a second, reported as `torque_limited`

#include "skinctl/resolver/detail/torque_rate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {
using Arm = ur5::Model;

/// 20 N m on the shoulder and 5 on the wrist, to and fro every 40 ms.
template <LawRole R>
struct Jumps : Composable {
  struct Memory {};
  static constexpr Needs needs{.gravity = R == LawRole::tracking};
  static constexpr LawRole role = R;
  static JointTorque<6> own(Nanoseconds time) {
    const double side = time / 40ms % 2 == 0 ? 1 : -1;
    return {0, 20 * side, 0, 0, 5 * side, 0};
  }
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <class K>
  JointTorque<6> torque(const Memory&, const K& known) const noexcept
    requires(R == LawRole::reactive)
  {
    return own(known.time());
  }
  template <class K>
  TorqueParts<6> parts(const Memory&, const K& known) const noexcept
    requires(R == LawRole::tracking)
  {
    return {own(known.time()), {}};
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};

struct TwoParts {
  static constexpr std::size_t terms = 2;
  static constexpr std::array<LawRole, 2> roles{LawRole::tracking, LawRole::reactive};
};

struct Seen {
  double fastest = 0;  ///< change of torque in a cycle over what the limits allow
  int limited = 0;
};
/// 100 cycles of 2 ms on an arm that stays where it is.
template <class Robot, class L>
Seen run(const Robot& arm, const L& law) {
  const Cycle scene(arm, law);
  State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
  auto memory = scene.start(x);
  Seen seen;
  JointTorque<6> last;
  for (int k = 1; k <= 100; ++k) {
    typename decltype(scene)::Input input;
    x.time = input.now = k * 2ms;
    input.measured = x;
    const auto out = scene.step(memory, input);
    seen.limited += out.status.has(Reason::torque_limited);
    for (std::size_t i = 0; k > 1 && i < 6; ++i)
      seen.fastest = std::max(
          seen.fastest, std::abs(out.planned.torque[i] - last[i]) / (50 * 0.002 * arm.limits().torque()[i]));
    last = out.planned.torque;
  }
  return seen;
}
const RobotConfiguration<6> configuration{
    .limits = limits_of<ur5::Description>(), .period = 2ms, .virtual_damping = 0};
template <class F>
void for_each_robot(F&& f) {
  f(by_position(Arm{}, configuration));
  f(by_velocity(Arm{}, configuration));
  f(by_torque(Arm{}, configuration, FrictionUncompensated{}));
}
}  // namespace

TEST_CASE("torque rate: a tracking law that jumps is turned at the rate of the description, and it is said") {
  for_each_robot([](const auto& arm) {
    const Seen seen = run(arm, Jumps<LawRole::tracking>{} + GravityControl{});
    CHECK(seen.fastest <= 1.02);  // gravity of a virtual arm that moves
    CHECK(seen.fastest >= 0.9);
    CHECK(seen.limited >= 3);  // at each jump but the first
    CHECK(seen.limited <= 20);
  });
}

TEST_CASE("torque rate: a reactive law is not delayed") {
  const Seen by_position_ =
      run(by_position(Arm{}, configuration), Jumps<LawRole::reactive>{} + GravityControl{});
  CHECK(by_position_.limited == 0);
  CHECK(by_position_.fastest > 2.5);
}

TEST_CASE("torque rate: the first torque passes, within the rate all pass to the bit") {
  using L = Jumps<LawRole::tracking>;
  detail::OwnTorque<2, double> own;
  const JointTorque<2> step{1, 0.1};
  const auto bound = [&](JointTorque<2> tau, bool acts) {
    JointTorque<2> kept = tau;
    CHECK(own.bound<L>(std::array<JointTorque<2>, 1>{tau}, step, kept) == acts);
    return kept;
  };
  CHECK(bound({50, 50}, false) == JointTorque<2>{50, 50});
  CHECK(bound({50.9, 49.95}, false) == JointTorque<2>{50.9, 49.95});
  CHECK(bound({60, 49.95}, true) == JointTorque<2>{51.9, 49.95});
  CHECK(bound({60, 40}, true)[1] == doctest::Approx(49.85));
  // The law's own part gives way to a reactive one: the whole stays.
  detail::OwnTorque<2, double> beside;
  JointTorque<2> whole{10, 1};
  CHECK_FALSE(beside.bound<TwoParts>(std::array<JointTorque<2>, 2>{whole, {}}, step, whole));
  CHECK_FALSE(beside.bound<TwoParts>(std::array<JointTorque<2>, 2>{{{-20, -2}, {30, 3}}}, step, whole));
  CHECK(whole == JointTorque<2>{10, 1});
  // A touch passes, the law's own jump beside it does not.
  whole = {150, 1};
  CHECK(beside.bound<TwoParts>(std::array<JointTorque<2>, 2>{{{20, -2}, {130, 3}}}, step, whole));
  CHECK(whole == JointTorque<2>{111, 1});
  auto c = configuration;
  c.torque_rate = 0;
  CHECK_THROWS_AS(static_cast<void>(by_position(Arm{}, c)), ConfigurationError);
}
