// An arm with three-axis taxels that is dragged: shear moves it as pressure does, by each interface.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/contact_skin.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "skinctl/testing/random.hpp"
#include "tests/support/sensor_kinds.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace shear_moves {
namespace {

using Arm = ur5::Model;
constexpr std::size_t link = 2, each = 4, cells = 3 * each;
const Xyz<double> middle{-0.25, 0, 0};
const JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};

/// Three patches of four around a point of the forearm: two look along y and -y of the link, the third
/// along -z. A hand that takes hold of the first two drags along z by their x axes; on the third it pushes
/// along z.
Patch<link, cells, Uskin> around() {
  std::vector<PlacedCell<link>> placed;
  for (std::size_t i = 0; i < cells; ++i) {
    const double along = i % 2 == 0 ? -0.003 : 0.003, across = i / 2 % 2 == 0 ? -0.003 : 0.003;
    const std::size_t patch = i / each;
    const double side = patch == 0 ? 1 : -1;
    const Rotation<double> R = patch < 2 ? Rotation<double>{{0, 0, 1}, {side, 0, 0}, {0, side, 0}}
                                         : Rotation<double>{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    const Xyz<double> at =
        patch < 2 ? Xyz<double>{along, 0.05 * side, across} : Xyz<double>{along, across, -0.05};
    placed.push_back({static_cast<std::uint32_t>(i + 1), {R, middle + at}});
  }
  return Patch<link, cells, Uskin>(placed);
}
using Cells = Skin<Arm, double, Patch<link, cells, Uskin>>;

/// What the hand does: it drags with `force` of shear and grips with `grip` on either side, or it pushes.
struct Hand {
  double force = 0, grip = 0;
  bool pushes = false;
  float stuck = 0;  ///< what the shear channels of the first patch read whatever the hand does [N]
};

template <Interface I>
auto robot() {
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0), .period = 4ms, .delay = 8ms};
  if constexpr (I == Interface::torque) {
    c.viscous_friction = JointTorque<6>{40, 40, 30, 8, 8, 8};
    return by_torque(Arm{}, c, RobotHoldsGravity{}, RobotCompensatesFriction{});
  } else {
    c.virtual_damping = 8;
    if constexpr (I == Interface::velocity)
      return by_velocity(Arm{}, c);
    else
      return by_position(Arm{}, c);
  }
}

/// The way along the hand's force of the middle of its grip within 0.8 s [m].
template <Interface I, class S>
double way(const S& skin, const Hand& hand) {
  const auto law = [] {
    if constexpr (I == Interface::torque)
      return SkinJointControl{};
    else
      return SkinJointControl{} + GravityControl{};
  }();
  const Cycle scene(robot<I>(), skin, law);
  using Scene = std::remove_const_t<decltype(scene)>;
  State<6> real{0ns, home, {}};
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, real);
  const Arm arm;
  const auto X_LC = Transform<Link<link>, Cell>::translation_xyz(middle.x, middle.y, middle.z);
  const auto place = [&] { return link_poses(arm, real.q).template get<link>() * X_LC; };
  Random rng = seeded(5);
  const auto noise = [&] { return static_cast<float>(uniform(rng, -0.02, 0.02)); };
  double gone = 0;
  for (int k = 1; k <= 950; ++k) {
    real.time += 4ms;
    const double t = 0.004 * k;
    // 3 s at rest, as a skin that watches its rest level wants it; then the hand, which trembles by 2 %.
    const double now = t < 3 ? 0 : std::min(1.0, (t - 3) / 0.1) * (1 + 0.02 * std::sin(50.0 * t));
    const double F = hand.force * now, grip = hand.grip * now;
    std::vector<SensorSample<Uskin>> samples;
    for (std::size_t i = 0; i < cells; ++i) {
      const bool holds = i < 2 * each;
      const double x = !hand.pushes && holds ? F / (2 * each) : 0, z = hand.pushes && !holds ? F / each
                                                                       : holds               ? grip / each
                                                                                             : 0;
      const float shear = i < each && hand.stuck != 0 ? hand.stuck : static_cast<float>(x) + noise();
      samples.push_back({real.time,
                         static_cast<std::uint32_t>(i + 1),
                         {shear, noise(), std::max(0.0f, static_cast<float>(z) + noise()), 20}});
    }
    typename Scene::Input input;
    input.now = real.time;
    input.measured = real;
    input.sensed.taxels = samples;
    const auto out = scene.step(*memory, input);
    REQUIRE(out.command.valid);
    const auto before = place();
    if constexpr (I == Interface::torque) {
      const auto push = transpose(jacobian<link>(link_poses(arm, real.q), X_LC)) *
                        Wrench<Cell, Cell, Base>{F * before.axis_z(), {0, 0, 0}};
      const auto tau = out.command.torque + gravity_torque(arm, real.q) + push;
      const auto ddq = forward_dynamics(arm, real.q, real.dq, tau).acceleration;
      real.dq = integrate(real.dq, ddq, 0.004);
    } else if constexpr (I == Interface::velocity) {
      real.dq = out.command.velocity;
    } else {
      for (std::size_t i = 0; i < 6; ++i) real.dq[i] = (out.command.position[i] - real.q[i]) / 0.004;
    }
    real.q = integrate(real.q, real.dq, 0.004);
    if (t > 3) gone += dot(Xyz<double>(place().origin() - before.origin()), before.axis_z());
  }
  return gone;
}

TrustSettings trust() {
  TrustSettings t;
  t.lone_force = {3};
  t.health.step = 1.0 / 4096;
  t.noise = {{.force = 3.0f, .rest = 10, .repeats = true}};
  return t;
}

template <Interface I, class S>
void compare(std::string name, const S& skin) {
  const double pushed = way<I>(skin, {.force = 20, .pushes = true}),
               dragged = way<I>(skin, {.force = 20, .grip = 20}), held = way<I>(skin, {.grip = 20}),
               stuck = way<I>(skin, {.stuck = 15});
  MESSAGE(name << ": 20 N move it by " << 1e3 * pushed << " mm as pressure, " << 1e3 * dragged
               << " mm as shear; " << 1e3 * held << " mm gripped, " << 1e3 * stuck << " mm with stuck shear");
  CHECK(pushed > 0.02);
  CHECK(dragged == doctest::Approx(pushed).epsilon(0.1));
  CHECK(std::abs(held) < 0.02 * pushed);
  CHECK(std::abs(stuck) < 1e-6);
}

}  // namespace

TEST_CASE("Shear: a drag moves an arm as far as a push of the same force; stuck shear moves nothing") {
  const Cells plain(around());
  compare<Interface::position>("by position", plain);
#if !defined(SKINCTL_GATE)
  compare<Interface::velocity>("by velocity", plain);
  compare<Interface::torque>("by torque", plain);
#endif
}

TEST_CASE("Shear: so with contacts, and with cells that have to be trusted") {
  const Cells plain(around());
  compare<Interface::velocity>("contacts, by velocity", ContactSkin(plain));
  const TrustedSkin<Cells> trusted(plain, trust());
#if !defined(SKINCTL_GATE)
  compare<Interface::position>("trusted, by position", trusted);
#endif
  compare<Interface::torque>("trusted, by torque", trusted);
}

}  // namespace shear_moves
