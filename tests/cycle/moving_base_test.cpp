// Promise: an arm by torque on a base that drives, tilts and turns stays where it is
// Tried: UR5 on a cart of 2 m/s^2, 0.3 rad and 1 rad/s, told every 5 ms: the tool strays by 0.3 mm, of 89 mm
// without; float and double; bad and late news of the base; without news it keeps the last slope

#include "skinctl/model/moving_base.hpp"

#include <doctest/doctest.h>

#include <memory>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/configurations.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/model/loaded.hpp"
#include "skinctl/recording/recording.hpp"
#include "skinctl/robot/spring.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/by_day.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

template <class T>
const JointPosition<6, T> home{T(0.0), T(-1.2), T(1.4), T(-1.8), T(-1.57), T(0.0)};

/// Springs to where the arm stood.
template <class T>
struct Stay : StatelessLaw<Stay<T>> {
  static constexpr const char* name = "stay";
  JointTorque<6, T> torque(const auto& known) const noexcept {
    JointTorque<6, T> tau;
    for (std::size_t i = 0; i < 6; ++i)
      tau[i] = T(i < 3 ? 150 : 20) * (home<T>[i] - known.q()[i]) - T(i < 3 ? 40 : 3) * known.dq()[i];
    return tau;
  }
};
template <class T>
RobotConfiguration<6, T> configuration() {
  RobotConfiguration<6, T> c{.limits = limits_of<ur5::Description, T>(T(40)), .period = 1ms, .delay = 1ms};
  c.virtual_inertia = {T(0.3), T(0.3), T(0.3), T(0.1), T(0.1), T(0.1)};  // of the motors
  return c;
}
template <class T, class M>
auto scene_of(const M& model) {
  return Cycle(by_torque(model, configuration<T>(), FrictionUncompensated{}), Stay<T>{} + GravityControl{});
}

/// A cart: it starts and brakes, climbs, and goes through curves.
struct Cart {
  static Rotation<double> axes(double t) {
    const double yaw = 1.5 * std::sin(0.6 * t), pitch = 0.3 * std::sin(0.9 * t);
    const double c = std::cos(yaw), s = std::sin(yaw), C = std::cos(pitch), S = std::sin(pitch);
    return {{c * C, s * C, -S}, {-s, c, 0}, {c * S, s * S, C}};
  }
  static Xyz<double> place(double t) { return {1.2 * std::sin(1.3 * t), 0.8 * std::cos(1.1 * t) - 0.8, 0}; }

  static BaseState<double> state(double t) {
    const double h = 1e-4;
    const auto R = axes(t), before = axes(t - h), after = axes(t + h);
    const auto rate = [&](const Rotation<double>& a, const Rotation<double>& b, const Rotation<double>& at,
                          double dt) {
      const Rotation<double> d{(1 / dt) * Xyz<double>(b.x - a.x), (1 / dt) * Xyz<double>(b.y - a.y),
                               (1 / dt) * Xyz<double>(b.z - a.z)};
      return Xyz<double>{dot(at.z, d.y), dot(at.x, d.z), dot(at.y, d.x)};  // R' dR = [omega]x
    };
    BaseState<double> out;
    out.time = Nanoseconds(std::llround(1e9 * t));
    out.X_WB = Transform<World, Base>(R, place(t));
    const auto v = (1 / (2 * h)) * Xyz<double>(place(t + h) - place(t - h));
    const auto a = (1 / (h * h)) * Xyz<double>(place(t + h) - 2.0 * place(t) + place(t - h));
    out.V_WB_B = {R.transpose() * v, rate(before, after, R, 2 * h)};
    out.A_WB_B = {R.transpose() * a, (1 / (2 * h)) * Xyz<double>(rate(R, axes(t + 2 * h), after, 2 * h) -
                                                                 rate(axes(t - 2 * h), R, before, 2 * h))};
    return out;
  }
};

template <class T>
BaseState<T> rounded(const BaseState<double>& b) {
  return {b.time,
          b.X_WB.cast<T>(),
          b.V_WB_B.cast<T>(),
          {skinctl::cast<T>(b.A_WB_B.linear), skinctl::cast<T>(b.A_WB_B.angular)},
          T(b.sigma),
          T(b.sigma_turn)};
}
/// Stands on a slope of 0.3 rad.
BaseState<double> slope(double t) {
  BaseState<double> out;
  out.time = Nanoseconds(std::llround(1e9 * t));
  out.X_WB = Transform<World, Base>().rotated_y(0.3);
  return out;
}

/// An arm with motors' inertia on the cart, in double: the truth.
template <class M>
struct ArmOnCart {
  M model;
  State<6> state{0ns, home<double>, {}};

  /// A millisecond from `t` on.
  template <class Place>
  void advance(double t, const Place& place, const JointTorque<6>& tau) {
    const auto motors = configuration<double>().virtual_inertia;
    for (int k = 0; k < 2; ++k) {
      const BaseState<double> base = place(t + 0.00025 + 0.0005 * k);
      const auto& R = base.X_WB.axes();
      const BaseMotion<double> moves{
          base.V_WB_B.angular, base.A_WB_B.angular,
          base.A_WB_B.linear + Xyz<double>(9.81 * Xyz<double>{R.x.z, R.y.z, R.z.z})};
      auto mass = mass_matrix(model, state.q);
      for (std::size_t i = 0; i < 6; ++i) mass(i, i) += motors[i];
      const auto net = tau - inverse_dynamics_on(model, JointAngles<M, double>(model, state.q), state.dq,
                                                 JointAcceleration<6>{}, moves);
      JointAcceleration<6> ddq;
      math::Ldlt<6, double>(mass.data).solve(net.data, ddq.data);
      state.dq = integrate(state.dq, ddq, 0.0005);
      state.q = integrate(state.q, state.dq, 0.0005);
    }
  }
};
Xyz<double> tool_at(const JointPosition<6>& q) {
  return link_poses(ur5::Model{}, q).get<5>().origin();
}

struct Course {
  double strayed = 0, speed = 0, torque = 0;
  Status said;
  std::uint64_t allocated = 0;
};
/// `seconds` on a base that is at `place(t)`, told every 5 ms; `tell(input, cycle)` may spoil what is told.
template <class T, class Scene, class Place, class Tell>
Course ride(const Scene& scene, double seconds, const Place& place, const Tell& tell,
            bool robot_holds = false) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  ArmOnCart<ur5::Model> arm;
  const auto measured = [&] {
    return State<6, T>{arm.state.time, arm.state.q.template cast<T>(), arm.state.dq.template cast<T>()};
  };
  scene.start(*memory, measured());
  Course out;
  JointTorque<6> last = gravity_torque(ur5::Model{}, home<double>);
  for (int k = 1; 0.001 * k <= seconds; ++k) {
    arm.state.time = k * 1ms;
    typename Scene::Input input;
    input.now = arm.state.time;
    input.measured = measured();
    if constexpr (requires { input.base; }) input.base = rounded<T>(place(0.005 * std::floor(k / 5.0)));
    tell(input, k);
    const AllocationGuard guard;
    const auto sent = scene.step(*memory, input);
    out.allocated += guard.count();
    out.said |= sent.status;
    JointTorque<6> tau = sent.command.torque.template cast<double>();
    if (robot_holds) tau += gravity_torque(ur5::Model{}, arm.state.q);
    for (std::size_t i = 0; i < 6; ++i) {
      REQUIRE(std::isfinite(tau[i]));
      if (k > 100) out.torque = std::max(out.torque, std::abs(tau[i] - last[i]));
    }
    arm.advance(0.001 * k, place, last);  // it acts a cycle late
    last = tau;
    out.strayed = std::max(out.strayed, norm(Xyz<double>(tool_at(arm.state.q) - tool_at(home<double>))));
    for (const double v : arm.state.dq) out.speed = std::max(out.speed, std::abs(v));
  }
  return out;
}
template <class Scene>
concept TellsBase = requires(typename Scene::Input input) { input.base.A_WB_B; };
constexpr auto as_it_is = [](auto&, int) {};
template <class T>
auto model() {
  if constexpr (std::is_same_v<T, double>) {
    return ur5::Model{};
  } else {
    return calibrated_from<ur5::Description, T>();
  }
}

}  // namespace

TEST_CASE_TEMPLATE("Moving base: an arm by torque on a cart stays where it is", T, SKINCTL_SCALARS) {
  const auto told = ride<T>(scene_of<T>(OnMovingBase(model<T>())), 12, Cart::state, as_it_is);
  const auto untold = ride<T>(scene_of<T>(model<T>()), 12, Cart::state, as_it_is);
  MESSAGE("the tool strays by ", 1e3 * told.strayed, " mm, without the state of the base by ",
          1e3 * untold.strayed, " mm");
  CHECK(told.strayed < 0.001);
  CHECK(untold.strayed > 0.05);
  CHECK(told.allocated == 0);
  CHECK(told.said == Status(Reason::sample_stale));  // before the first state, of 5 ms
}

TEST_CASE(
    "Moving base: with a tank, and a robot that holds the gravity of a base at rest itself, it stays as "
    "well") {
  const OnMovingBase model(ur5::Model{});
  const auto paid = Cycle(by_torque(model, configuration<double>(), FrictionUncompensated{}, EnergyTank{}),
                          Stay<double>{} + GravityControl{});
  CHECK(ride<double>(paid, 8, Cart::state, as_it_is).strayed < 0.001);
  const auto held =
      Cycle(by_torque(model, configuration<double>(), FrictionUncompensated{}, RobotHoldsGravity{}),
            Stay<double>{});
  CHECK(ride<double>(held, 8, Cart::state, as_it_is, true).strayed < 0.001);
}

TEST_CASE("Moving base: of joints in groups those by torque bear what the base adds") {
  RobotConfiguration<3> stiff{.limits = limits_of<ur5::Description>(15.0).part<JointSubset<6, 0b000111>>(),
                              .period = 1ms,
                              .delay = 2ms,
                              .virtual_damping = 4};
  RobotConfiguration<3> driven{.limits = limits_of<ur5::Description>(15.0).part<JointSubset<6, 0b111000>>(),
                               .period = 1ms,
                               .delay = 1ms};
  const auto scene = Cycle(by_groups(OnMovingBase(ur5::Model{}), position_joints<0b000111>(stiff),
                                     torque_joints<0b111000>(driven)),
                           GravityControl{});
  auto memory = scene.start({0ns, home<double>, {}});
  for (int k = 1; k <= 3000; ++k) {
    decltype(scene)::Input input;
    input.now = input.measured.time = k * 1ms;
    input.measured.q = home<double>;
    input.base = Cart::state(0.001 * k);
    const auto out = scene.step(memory, input);
    const auto& R = input.base.X_WB.axes();
    const BaseMotion<double> moves{
        input.base.V_WB_B.angular, input.base.A_WB_B.angular,
        input.base.A_WB_B.linear + Xyz<double>(9.81 * Xyz<double>{R.x.z, R.y.z, R.z.z})};
    const auto needs =
        inverse_dynamics_on(ur5::Model{}, JointAngles<ur5::Model, double>(ur5::Model{}, home<double>), {},
                            JointAcceleration<6>{}, moves);
    if (k < 10) continue;  // as it is set on the cart
    for (std::size_t i = 3; i < 6; ++i) REQUIRE(std::abs(out.command.torque[i] - needs[i]) < 1e-9);
    for (std::size_t i = 0; i < 3; ++i) REQUIRE(std::abs(out.command.position[i] - home<double>[i]) < 1e-9);
  }
}

TEST_CASE("Moving base: the input holds its state if the robot's base moves, whatever else the scene has") {
  const auto scene = scene_of<double>(OnMovingBase(ur5::Model{}));
  const auto plain = scene_of<double>(ur5::Model{});
  static_assert(TellsBase<decltype(scene)>);
  static_assert(!TellsBase<decltype(plain)>);
  static_assert(sizeof(decltype(plain)::Memory) < sizeof(decltype(scene)::Memory));
  const auto limited = scene.with(MaxToolSpeed<5>{.speed = 0.5, .reach = 1.3});
  static_assert(TellsBase<decltype(limited)>);
  const auto again = limited.without<ToolSpeedLimit>();
  static_assert(std::is_same_v<decltype(again), decltype(scene)>);
  const Configurations both(scene, scene);
  static_assert(TellsBase<decltype(both)>);
  // A stop on a slope holds as the law does, and so does the law behind a limit.
  const auto stops = [](auto& input, int k) {
    if (k == 300) input.request = CycleRequest::stop;
  };
  CHECK(ride<double>(scene, 2, slope, stops).strayed < 0.002);
  CHECK(ride<double>(plain, 2, slope, stops).strayed > 0.02);
  CHECK(ride<double>(limited, 4, Cart::state, as_it_is).strayed < 0.001);
}

TEST_CASE("Moving base: what is no state of a base is refused by name, and the last good one stands") {
  using Base = BaseState<double>;
  const auto scene = scene_of<double>(OnMovingBase(ur5::Model{}));
  const double nan = std::nan(""), inf = HUGE_VAL;
  const auto spoils = [&](Reason reason, double most, const auto& spoil) {
    const auto out = ride<double>(scene, 6, Cart::state, [&](auto& input, int k) {
      if (k % 50 >= 40) spoil(input.base, k);
    });
    CAPTURE(int(reason));
    CHECK(out.said.has(reason));
    CHECK(out.strayed < most);
    CHECK(!out.said.without(Status(Reason::sample_stale) | reason).any());
  };
  spoils(Reason::sample_not_finite, 0.002, [&](Base& b, int) { b.A_WB_B.linear.y = nan; });
  spoils(Reason::sample_not_finite, 0.002, [&](Base& b, int) { b.V_WB_B.angular.z = -inf; });
  spoils(Reason::sample_not_finite, 0.002, [&](Base& b, int) { b.V_WB_B.linear.x = nan; });
  spoils(Reason::sample_not_finite, 0.002, [&](Base& b, int) { b.sigma = inf; });
  spoils(Reason::sample_not_finite, 0.002, [&](Base& b, int) {
    b.X_WB = Transform<World, skinctl::Base>({{nan, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0});
  });
  spoils(Reason::sample_not_finite, 0.002, [&](Base& b, int) { b.time = Nanoseconds::max(); });
  spoils(Reason::sample_out_of_range, 0.002, [&](Base& b, int) { b.A_WB_B.linear.y = 1e300; });
  spoils(Reason::sample_out_of_range, 0.002, [&](Base& b, int) { b.A_WB_B.angular.x = -200; });
  spoils(Reason::sample_out_of_range, 0.002, [&](Base& b, int) { b.V_WB_B.angular.x = 20; });
  spoils(Reason::sample_out_of_range, 0.002, [&](Base& b, int) { b.time += 1s; });
  spoils(Reason::sample_out_of_range, 0.002, [&](Base& b, int) {
    b.X_WB = Transform<World, skinctl::Base>({{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, {0, 0, 0});  // mirrored
  });
  spoils(Reason::sample_out_of_range, 0.002, [&](Base& b, int) {
    b.X_WB = Transform<World, skinctl::Base>({{0, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0});
  });
  // No news: an old stamp, or the same one. The base is taken to go on.
  spoils(Reason::sample_stale, 0.003, [&](Base& b, int) { b.time -= 200ms, b.A_WB_B.linear.z = 9; });
  spoils(Reason::sample_stale, 0.003, [&](Base& b, int k) { b = Cart::state(0.001 * (k - k % 50 + 35)); });
}

TEST_CASE("Moving base: without news the last slope counts, and the motion does not") {
  const auto scene = scene_of<double>(OnMovingBase(ur5::Model{}));
  const auto silent = ride<double>(scene, 5, slope, [](auto& input, int k) {
    if (k > 1000) input.base = slope(1);
  });
  CHECK(silent.said == (Status(Reason::sample_stale) | Reason::step_limited));  // as it is set on the slope
  CHECK(silent.strayed < 0.002);
  // It stands after a start of 2 m/s^2: the last that was told fades within 100 ms.
  const auto stands = ride<double>(scene, 3, slope, [](auto& input, int k) {
    input.base = slope(k < 1000 ? 0.001 * k : 0.999);
    if (k >= 990) input.base.A_WB_B.linear = {2, 0, 0};
  });
  CHECK(stands.strayed < 0.03);
  const auto never = ride<double>(scene, 2, slope, [](auto& input, int) { input.base = {}; });
  CHECK(never.said.has(Reason::sample_stale));
  CHECK(never.strayed ==
        doctest::Approx(ride<double>(scene_of<double>(ur5::Model{}), 2, slope, as_it_is).strayed));
  // The clock is set back by a minute: news count again.
  const auto set_back =
      ride<double>(scene, 3, slope, [](auto& input, int k) { input.base.time += k < 1000 ? 40ms : 0ms; });
  CHECK(set_back.strayed < 0.002);
}

TEST_CASE("Moving base: an acceleration that leaps does not make the torque leap") {
  const auto scene = scene_of<double>(OnMovingBase(ur5::Model{}));
  const auto leaps = ride<double>(scene, 2, slope, [](auto& input, int k) {
    if (k % 100 >= 50) input.base.A_WB_B.linear = {0, 0, 25};
  });
  CHECK(leaps.torque < 0.05 * 150 + 0.5);  // 50 torque limits in a second, and what the springs do
  CHECK(leaps.torque > 3);
}

TEST_CASE("Moving base: a payload that changes on a slope makes no step of torque") {
  const LinkInertia part{2, {0, 0, 0.15}, 0.01, 0.01, 0.01};
  const auto carrying = [&](const LinkInertia& load) {
    return scene_of<double>(OnMovingBase(Loaded<ur5::Model, 5>(ur5::Model{}, load)));
  };
  const Configurations scene(carrying({}), carrying(part));
  const auto out = ride<double>(scene, 2, slope, [](auto& input, int k) { input.configuration = k > 1000; });
  CHECK(out.said.has(Reason::bumpless_transfer));
  CHECK(out.torque < 0.6);  // 6 N m more at the shoulder
}

TEST_CASE("Moving base: a run is recorded with the state of its base, and replays bit for bit") {
  const auto scene = scene_of<double>(OnMovingBase(ur5::Model{}));
  using Scene = std::remove_const_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();
  State<6> state{0ns, home<double>, {}};
  scene.start(*memory, state);
  Recording<Scene> recording(std::size_t(4) << 20);
  recording.start(state);
  for (int k = 1; k <= 500; ++k) {
    Scene::Input input;
    input.now = input.measured.time = k * 1ms;
    input.measured.q = home<double>;
    input.base = Cart::state(0.001 * k);
    recording.add(input, scene.step(*memory, input).planned);
  }
  const auto again = replay(scene, recording);
  CHECK(again.cycles == 500);
  CHECK(again.different == 0);
  using Plain = decltype(scene_of<double>(ur5::Model{}));
  CHECK(CycleBytes<Scene>::kind() != CycleBytes<Plain>::kind());
}

TEST_CASE(
    "Moving base: joints by position hold the arm by themselves; theirs are the commands of a base at rest") {
  const auto by = [](const auto& robot) {
    RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0), .period = 1ms, .delay = 2ms};
    c.virtual_damping = 4, c.virtual_inertia = JointTorque<6>::constant(0.2);
    return Cycle(by_position(robot, c), Stay<double>{} + GravityControl{});
  };
  const auto moving = by(OnMovingBase(ur5::Model{}));
  const auto still = by(ur5::Model{});
  State<6> start{0ns, home<double>, {}};
  start.q[1] += 0.1;
  auto a = moving.start(start);
  auto b = still.start(start);
  for (int k = 1; k <= 1000; ++k) {
    decltype(moving)::Input in;
    decltype(still)::Input other;
    in.base = Cart::state(0.001 * k);
    in.now = other.now = in.measured.time = other.measured.time = k * 1ms;
    in.measured.q = other.measured.q = a.robot.command().position;
    REQUIRE(moving.step(a, in).command.position == still.step(b, other).command.position);
  }
}

TEST_CASE(
    "Moving base: beside positions on springs goes what the base adds to a weight that the robot bears "
    "itself") {
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(15.0), .period = 2ms, .delay = 4ms};
  c.stiffness = JointTorque<6>::constant(300), c.virtual_damping = 2;
  const auto scene = Cycle(by_impedance(OnMovingBase(ur5::Model{}), c), GravityControl{});
  auto memory = scene.start({0ns, home<double>, {}});
  for (int k = 1; k <= 1000; ++k) {
    decltype(scene)::Input input;
    input.now = input.measured.time = k * 2ms;
    input.measured.q = home<double>;
    input.base = Cart::state(0.002 * k);
    const auto& R = input.base.X_WB.axes();
    const BaseMotion<double> moves{
        input.base.V_WB_B.angular, input.base.A_WB_B.angular,
        input.base.A_WB_B.linear + Xyz<double>(9.81 * Xyz<double>{R.x.z, R.y.z, R.z.z})};
    const auto adds = base_torque(ur5::Model{}, home<double>, {}, moves);
    const auto out = scene.step(memory, input);
    if (k < 20) continue;
    for (std::size_t i = 0; i < 6; ++i) REQUIRE(std::abs(out.command.torque[i] - adds[i]) < 1e-6);
  }
}
