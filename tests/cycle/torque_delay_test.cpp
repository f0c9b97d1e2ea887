// Promise: a robot by torque that is told to stop brakes and stands, without friction as well, at any delay
// it declares
// Tried: UR5, 1 to 8 ms, delay 0 to 20 ms, friction 0 to 40 N m s/rad added to joints whose motors have 0.1
// kg m^2, by request and by a fault of the loop: at rest within 3 s and never faster than at the request,
// where it glided for ever, or was shaken by its own friction
//
// Promise: an arm by torque that was stopped stays where it stands against 15 N, as stiffly as its delay
// allows, and a person can lead it away
// Tried: UR5, 1 to 8 ms, delay 0 to 20 ms, 10 s: 0.2 mm where the torque answers in 1.5 ms, 7 mm in 10, 68 in
// 20, where it crept on as long as it was pushed. 1 kg that it was not told of: 2, 24 and 90 mm in 3, 10 and
// 19 ms. Led by 0.1 m with 150 N and let go it comes back by 1 mm, 66 mm, or all of it, at 0.6 m/s at most
//
// Promise: limits of a robot by torque hold beside the delay it declares
// Tried: UR5, 1 to 5 ms, delay 0 to 20 ms, there and back within 0.2 m/s at the tool: at most 5 % faster,
// where a delay of 14 ms let it swing at 86 rad/s. Also: `bench/studies/attack_torque`
//
// Promise: an arm by torque whose energy tank is empty comes to rest, though nothing rubs
// Tried: UR5, 1 to 8 ms, delay 0 to 20 ms, 0.1 to 1 J, driven by goals: at rest 15 s after the last one in
// all of 40 scenes, of which 6 swung on for a minute. Their kinetic energy is up to 1.7 J more than the tank
// held, 3.7 J in all: gravity is held late, too. Without a delay in the account 7.3 J. Also:
// `bench/studies/attack_torque`

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "skinctl/dynamics/energy.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/torque_loop.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double rotors = 0.1;  ///< at each joint [kg m^2]

auto arm(const Loop& loop, double friction) {
  return by_torque(ur5::Model{},
                   {.limits = limits_of<ur5::Description>(15.0),
                    .period = loop.period,
                    .delay = loop.delay,
                    .viscous_friction = JointTorque<6>::constant(friction),
                    .virtual_inertia = JointTorque<6>::constant(rotors)},
                   FrictionUncompensated{});
}
/// A scene with the real arm: `before(now, input)`, and `after(now, state, output)`, which ends it by false.
template <class Arm, class Scene, class Before, class After, class Pushed>
void run(const Arm& real, const Scene& scene, const Loop& loop, Nanoseconds end, Before&& before,
         After&& after, Pushed&& pushed) {
  State<6> x{0ns, Ur5::home, {}};
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, x);
  JointTorque<6> tau = memory->robot.command().torque;
  std::deque<std::pair<Nanoseconds, JointTorque<6>>> under_way;
  constexpr Nanoseconds step = 100us;
  for (Nanoseconds now = loop.period; now <= end; now += loop.period) {
    for (; x.time < now; x.time += step) {
      for (; !under_way.empty() && under_way.front().first <= x.time; under_way.pop_front())
        tau = under_way.front().second;
      const auto given = acceleration(real, x, tau + pushed(x), JointTorque<6>::constant(rotors));
      x.dq = integrate(x.dq, given, seconds<double>(step));
      x.q = integrate(x.q, x.dq, seconds<double>(step));
    }
    typename Scene::Input input;
    input.now = now;
    input.measured = x;
    before(now, input);
    const auto out = scene.step(*memory, input);
    under_way.push_back({now + loop.delay, out.command.torque});
    if (!after(now, x, out)) return;
  }
}
template <class Scene, class Before, class After>
void run(const Scene& scene, const Loop& loop, Nanoseconds end, Before&& before, After&& after) {
  run(ur5::Model{}, scene, loop, end, before, after, [](const State<6>&) { return JointTorque<6>(); });
}
/// Of links and motors [J].
double kinetic(const State<6>& x) {
  double sum = kinetic_energy(ur5::Model{}, JointAngles<ur5::Model, double>(ur5::Model{}, x.q), x.dq);
  for (const double v : x.dq) sum += 0.5 * rotors * v * v;
  return sum;
}
double fastest(const State<6>& x) {
  double most = 0;
  for (const double v : x.dq) most = std::max(most, std::abs(v));
  return most;
}

struct AfterStop {
  double before = 0, peak = 0, late = 0;  ///< largest speed of a joint, before, after and at the end [rad/s]
  Status status;
};
/// A goal, and a stop in the middle of the way: by a fault of the loop, or by request.
AfterStop stopped(const Loop& loop, double friction, bool by_fault) {
  const auto robot = arm(loop, friction);
  const Cycle scene(robot, SplineJoint<6>(tracking_settings(robot)) + GravityControl{});
  AfterStop seen;
  constexpr Nanoseconds stop = 1s;
  run(
      scene, loop, 5s,
      [&](Nanoseconds now, auto& input) {
        if (now <= loop.period)
          input.goal = {Ur5::home + JointPosition<6>{0.6, 0.3, -0.3, 0.4, 0.4, 0.4}, 2s};
        if (by_fault && now > stop) input.observed = Reason::packets_lost;
        if (!by_fault && now > stop && now <= stop + loop.period) input.request = CycleRequest::stop;
      },
      [&](Nanoseconds now, const State<6>& x, const auto& out) {
        const double v = fastest(x);
        (now > stop ? seen.peak : seen.before) = std::max(now > stop ? seen.peak : seen.before, v);
        if (now > stop) seen.status |= out.status;
        if (now > stop + 3s) seen.late = std::max(seen.late, v);
        return v < 100;
      });
  return seen;
}

Eigen::Vector3d tool_of(const State<6>& x) {
  const auto p = link_poses(ur5::Model{}, x.q).get<5>().origin();
  return {p.x, p.y, p.z};
}
/// The joint torque of the force `f` at the tool's origin [N], by differences.
JointTorque<6> torque_of_push(const State<6>& x, const Eigen::Vector3d& f) {
  constexpr double h = 1e-6;
  JointTorque<6> tau;
  for (std::size_t i = 0; i < 6; ++i) {
    State<6> a = x, b = x;
    a.q[i] -= h, b.q[i] += h;
    tau[i] = f.dot(tool_of(b) - tool_of(a)) / (2 * h);
  }
  return tau;
}
struct Held {
  double sank = 0;       ///< motion of the tool under a payload that nobody told [m]
  double crept = 0;      ///< largest motion of the tool from there under 15 N [m]
  double led = 0;        ///< motion of the tool under 150 N, until it was let go [m]
  double back = 0;       ///< motion of the tool after that [m]
  double fast_back = 0;  ///< largest speed of the tool after that [m/s]
};
/// An arm that is stopped and carries `payload` [kg] that it was not told of. It is pushed along `way` by 15 N
/// from 2 to 12 s, and from 13 s on by 150 N until the tool has moved by 0.1 m.
Held held(const Loop& loop, double payload, const Eigen::Vector3d& way) {
  const auto robot = arm(loop, 0);
  const Cycle scene(robot, SplineJoint<6>(tracking_settings(robot)) + GravityControl{});
  Held seen;
  double force = 0;
  bool let_go = false;
  Eigen::Vector3d begun = tool_of({0ns, Ur5::home, {}}), last = begun;
  run(
      Ur5::with(gripped(payload)), scene, loop, 18s,
      [&](Nanoseconds now, auto& input) {
        if (now > 500ms && now <= 500ms + loop.period) input.request = CycleRequest::stop;
        force = now > 2s && now <= 12s ? 15 : now > 13s && !let_go ? 150 : 0;
      },
      [&](Nanoseconds now, const State<6>& x, const auto&) {
        const Eigen::Vector3d p = tool_of(x);
        const double moved = (p - begun).norm();
        if (now <= 2s) seen.sank = moved;
        if (now > 2s && now <= 12s) seen.crept = std::max(seen.crept, moved);
        if (now > 13s && !let_go) seen.led = moved;
        if (let_go) {
          seen.back = std::max(seen.back, moved);
          seen.fast_back = std::max(seen.fast_back, -way.dot(p - last) / seconds<double>(loop.period));
        }
        const bool goes_now = now > 13s && !let_go && moved > 0.1;
        if (now == 2s || (now > 12s && now <= 13s) || goes_now) begun = p;
        let_go = let_go || goes_now;
        last = p;
        return true;
      },
      [&](const State<6>& x) { return torque_of_push(x, force * way); });
  return seen;
}

}  // namespace

TEST_CASE("Cycle by torque: a stop, or a fault that brakes, ends at rest") {
  std::mt19937 random(3);
  for (int k = 0; k < (sanitized ? 6 : rounds(60)); ++k) {
    const Loop loop{(1 + k % 8) * 1ms, (k * 5 % 21) * 1ms};
    const double friction = k % 3 == 0 ? 0.0 : std::uniform_real_distribution<>(0, 40)(random);
    const bool by_fault = k % 2 == 0;
    CAPTURE(loop.period.count());
    CAPTURE(loop.delay.count());
    CAPTURE(friction);
    CAPTURE(by_fault);
    const AfterStop seen = stopped(loop, friction, by_fault);
    CHECK(seen.status.has(by_fault ? Reason::packets_lost : Reason::stopping));
    CHECK(seen.before > 0.1);
    CHECK(seen.before < 1);
    CHECK(seen.peak < 1.1 * seen.before);
    CHECK(seen.late < 1e-3);
  }
}

TEST_CASE("Cycle by torque: a stopped arm stays against 15 N, and a person can lead it away") {
  for (int k = 0; k < (sanitized ? 2 : rounds(24)); ++k) {
    const Loop loop{(1 << k % 4) * 1ms, (k * 7 % 21) * 1ms};
    const double payload = k % 2;
    Eigen::Vector3d way = Eigen::Vector3d::Zero();
    way[k / 2 % 3] = k % 5 < 3 ? 1 : -1;
    CAPTURE(loop.period.count());
    CAPTURE(loop.delay.count());
    CAPTURE(payload);
    const Held seen = held(loop, payload, way);
    // What holds is as stiff as the delay allows: its give goes with the square of it.
    const double late = seconds<double>(loop.delay + 3 * loop.period / 2) / 0.02;
    CHECK(seen.sank < 0.001 + 0.3 * payload * late * late);
    CHECK(seen.crept < 0.001 + 0.2 * late * late);
    CHECK(seen.led > 0.1);
    CHECK(seen.fast_back < 0.7);
    CHECK(seen.back < 0.01 + 0.2 * late);
  }
}

TEST_CASE("Cycle by torque: the tool keeps its speed, at any delay") {
  constexpr double most = 0.2;
  for (int k = 0; k < (sanitized ? 3 : rounds(20)); ++k) {
    const Loop loop{(1 + k % 5) * 1ms, (k * 7 % 21) * 1ms};
    CAPTURE(loop.period.count());
    CAPTURE(loop.delay.count());
    const auto robot = arm(loop, 0);
    const auto scene = Cycle(robot, SplineJoint<6>(tracking_settings(robot)) + GravityControl{})
                           .with(MaxToolSpeed<5>{.speed = most, .reach = 1.3});
    double tool = 0, joint = 0, last = 0;
    Status status;
    run(
        scene, loop, 10s,
        [&](Nanoseconds now, auto& input) {
          JointPosition<6> away = Ur5::home;
          away[0] += 0.6, away[1] += 0.4;
          if (now <= loop.period) input.goal = {away, 300ms};
          if (now > 4s && now <= 4s + loop.period) input.goal = {Ur5::home, 300ms};
        },
        [&](Nanoseconds now, const State<6>& x, const auto& out) {
          status |= out.status;
          joint = std::max(joint, fastest(x));
          if (now > 9s) last = std::max(last, fastest(x));
          const auto at = [&](double h) {
            return link_poses<link_bit<5>>(ur5::Model{}, integrate(x.q, x.dq, h)).template get<5>().origin();
          };
          const Xyz<double> v = (1 / 2e-6) * (at(1e-6) - at(-1e-6));
          tool = std::max(tool, std::sqrt(dot(v, v)));
          return joint < 100;
        });
    CHECK(status.has(Reason::tool_speed_limited));
    CHECK(tool < 1.05 * most);
    CHECK(tool > 0.5 * most);
    CHECK(joint < 1);
    CHECK(last < 0.15);  // it comes back slowly, and does not swing
  }
}

TEST_CASE("Cycle by torque: with a tank that is empty an arm comes to rest, though nothing rubs") {
  int empty = 0, swing = 0;
  double over = 0, worst = 0;  // kinetic energy beyond the tank, which nobody gave [J]
  for (int k = 0; k < (sanitized ? 4 : rounds(40)); ++k) {
    std::mt19937 random(static_cast<unsigned>(k));
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(random); };
    const Loop loop{(1 + k % 8) * 1ms, (k * 7 % 21) * 1ms};
    const double energy = roll(0.1, 1);
    CAPTURE(k);
    const auto robot = by_torque(ur5::Model{},
                                 {.limits = limits_of<ur5::Description>(15.0),
                                  .period = loop.period,
                                  .delay = loop.delay,
                                  .virtual_inertia = JointTorque<6>::constant(rotors)},
                                 FrictionUncompensated{}, EnergyTank<>({.start = energy, .max = energy}));
    auto settings = tracking_settings(robot);
    const double softer = roll(0.3, 1);
    settings.lambda *= softer, settings.K_c *= softer, settings.K_i1 *= softer, settings.K_i2 *= softer;
    const Cycle scene(robot, SplineJoint<6>(settings) + GravityControl{});
    double late = 0, most = 0;  // speed at the end [rad/s], kinetic energy [J]
    run(
        scene, loop, 25s,
        [&](Nanoseconds now, auto& input) {
          const bool turn = (now / loop.period) % 400 == 1 && now < 8s;
          if (!turn) return;
          JointPosition<6> goal = Ur5::home;
          for (std::size_t i = 0; i < 6; ++i) goal[i] += roll(-0.6, 0.6);
          input.goal = {goal, nanoseconds(roll(0.3, 1))};
        },
        [&](Nanoseconds now, const State<6>& x, const auto& out) {
          empty += now < 10s && out.status.has(Reason::tank_empty);
          if (now > 23s) late = std::max(late, fastest(x));
          most = std::max(most, kinetic(x));
          return fastest(x) < 100;
        });
    if (late > 0.05) std::printf("%d: %g rad/s\n", k, late);
    swing += late > 0.05;
    over += std::max(0.0, most - energy), worst = std::max(worst, most - energy);
  }
  std::printf("%d swing; beyond the tank %.2f J at most, %.2f J in all\n", swing, worst, over);
  CHECK(empty > 0);
  CHECK(swing == 0);
  CHECK(over < 5);
}
