// Random legal scenes of an arm by torque in a world that keeps what was declared and does all else: pushes,
// goals, late cycles, joints held fast, stops and resumes in any order. The sister of `attack`, which moves
// by itself.
//
//     attack_torque [CYCLES = 500000] [SEED = 1]     that many cycles
//     attack_torque run SEED                         one scene, each quarter of a second of it
//
// The arm is a UR5 that somebody drives by torque: its model, its motors and its delay are as declared, dry
// friction of its joints is not. Each scene ends with some time in which nobody does anything, and a stop.
// Judged: torques within their limits, changes within the guard's rate, speeds and ends of the joints while
// nobody pushes, runaways at any time; swings that are left at rest, and the speed after the stop. Returns 1
// if any is passed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <memory>
#include <random>
#include <type_traits>

#include "bench/studies/attack/common.hpp"
#include "skinctl/dynamics/energy.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using namespace attacks;

namespace {

constexpr double rounding = 1e-4;  ///< share of a limit that is no breach
/// Excess over a limit of speed that a torque may leave, which is held for a delay: of the limit.
constexpr double held_torque = 0.05;
constexpr double beyond_end =
    5e-3;                        ///< the same of an end, of a joint that was inside when nobody pushed [rad]
constexpr double runs_away = 2;  ///< speed, in limits of it, that no push of these gives, and no letting go
constexpr double rests = 0.02;   ///< speed of a joint at rest, when nothing has happened for long [rad/s]
constexpr double quiet = 20;     ///< time in which nobody does anything [s]
constexpr double watched = 5;    ///< last part of it, in which nothing may swing [s]
constexpr double stops_in = 4;   ///< time after which a stopped arm stands [s]
constexpr Nanoseconds plant_step = 100us;
constexpr double tank_start = 1;  ///< energy of the tank [J]
constexpr double port_gain = 1;   ///< with which the law answers pushes
/// The mechanical stops: behind the declared ends [rad], and as stiff as rubber [N m/rad, N m s/rad].
constexpr double behind_end = 0.1, stop_stiffness = 1000, stop_damping = 10;

struct Findings {
  Found torque{"torque over its limit", 1 + rounding};
  Found rate{"change of a torque over the guard's", 1 + rounding};
  Found velocity{"velocity over its limit, nobody pushing", 1 + held_torque};
  Found pushed{"velocity over its limit, pushed", runs_away};
  Found ends{"way beyond the end of a joint, nobody pushing [rad]", beyond_end};
  Found swing{"swing at rest: speed between two turns of a joint [rad/s]", rests};
  Found stop{"speed after a stop [rad/s]", rests};
  Found energy{"energy that neither pushes nor the tank gave [J]", 0.01};
  Found invalid{"commands that are none", 0};
  std::uint64_t cycles = 0, scenes = 0, refused = 0;
  auto all() {
    return std::array{&torque, &rate, &velocity, &pushed, &ends, &swing, &stop, &energy, &invalid};
  }
};

/// Which parts a scene has.
template <bool Tool, bool Tank>
struct Parts {
  static constexpr bool tool = Tool, tank = Tank;
};

/// Numbers of a scene: anything that is legal.
struct Drawn {
  RobotConfiguration<6> robot;
  double softer = 1;  ///< gain of the law, of the one that fits the robot
  MaxToolSpeed<5> tool{.speed = 0.2, .reach = 1.3};
  double late = 0;              ///< share of cycles that are late
  std::array<double, 6> dry{};  ///< friction of the real joints, which nobody knows [N m]

  explicit Drawn(std::mt19937_64& rng) : robot{.limits = limits_of<ur5::Description>(15.0), .period = 2ms} {
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    auto v = limits_of<ur5::Description>(15.0).values();
    for (std::size_t i = 0; i < 6; ++i) {
      v.velocity[i] = roll(0.3, 1) * v.velocity[i];
      v.lower[i] = home[i] - roll(0.3, 3), v.upper[i] = home[i] + roll(0.3, 3);
      robot.virtual_inertia[i] = roll(0.1, 0.5);
      if (rng() % 2 == 0) robot.viscous_friction[i] = roll(0, 20);
      if (rng() % 2 == 0) dry[i] = roll(0, 4);
    }
    robot.limits = JointLimits<6>(v);
    robot.period = nanoseconds(1e-3 * std::pow(8.0, roll(0, 1)));
    robot.delay = rng() % 4 == 0 ? 0ns : nanoseconds(roll(0, 0.02));
    tool.speed = roll(0.1, 1);
    late = rng() % 2 == 0 ? 0.0 : roll(0, 0.1);
    softer = roll(0.3, 1);
  }
};

template <class P>
auto scene_of(const Drawn& d) {
  const auto robot = [&](const auto&... parts) {
    return by_torque(ur5::Model{}, d.robot, FrictionUncompensated{}, parts...);
  };
  auto tracking = tracking_settings(robot());
  tracking.lambda *= d.softer, tracking.K_c *= d.softer, tracking.K_i1 *= d.softer;
  tracking.K_i2 *= d.softer;
  const auto law = SplineJoint<6>(tracking) + SkinJointControl{} + GravityControl{};
  const EnergyTank<> tank({.start = tank_start, .max = tank_start, .port_gain = port_gain});
  const auto plain = [&] {
    if constexpr (P::tank) {
      return Cycle(robot(tank), skin(), law);
    } else {
      return Cycle(robot(), skin(), law);
    }
  }();
  if constexpr (P::tool) {
    return plain.with(d.tool);
  } else {
    return plain;
  }
}

/// The real arm: rigid links, motors, friction as declared; joints may be held fast.
class Arm {
 public:
  State<6> x{0ns, home, {}};
  std::array<bool, 6> fast{};
  Forces force{};
  double given = 0;  ///< work of the pushes [J]

  explicit Arm(const Drawn& d) : declared_(d.robot), dry_(d.dry) {
    for (std::size_t i = 0; i < 6; ++i) {
      lower_[i] = d.robot.limits.lower()[i] - behind_end, upper_[i] = d.robot.limits.upper()[i] + behind_end;
    }
  }
  void start(const JointTorque<6>& tau) { tau_ = tau; }
  void command(const JointTorque<6>& tau) { under_way_.push_back({x.time + declared_.delay, tau}); }
  [[nodiscard]] double kinetic() const {
    double sum = kinetic_energy(ur5::Model{}, JointAngles<ur5::Model, double>(ur5::Model{}, x.q), x.dq);
    for (std::size_t i = 0; i < 6; ++i) sum += 0.5 * declared_.virtual_inertia[i] * x.dq[i] * x.dq[i];
    return sum;
  }
  /// Lets go a joint that was held fast. No controller prevents the speed that this returns [rad/s]: the
  /// torque that it was held against acts for a delay and a period, and turns back at the rate that the guard
  /// allows.
  [[nodiscard]] double let_go(std::size_t i) {
    fast[i] = false;
    const double net = std::abs(tau_[i] - gravity_torque(ur5::Model{}, x.q)[i]);
    auto mass = mass_matrix(ur5::Model{}, x.q);
    for (std::size_t j = 0; j < 6; ++j) mass(j, j) += declared_.virtual_inertia[j] + (fast[j] ? 1e9 : 0);
    JointTorque<6> unit;
    unit[i] = 1;
    JointAcceleration<6> by_unit;
    math::Ldlt<6, double>(mass.data).solve(unit.data, by_unit.data);
    const double turns = net / (declared_.torque_rate * declared_.limits.torque()[i]);
    return by_unit[i] * net * (seconds<double>(declared_.delay + declared_.period) + 0.5 * turns);
  }
  void advance(Nanoseconds now) {
    for (; x.time < now; x.time += plant_step) {
      for (; !under_way_.empty() && under_way_.front().first <= x.time; under_way_.pop_front())
        tau_ = under_way_.front().second;
      auto motors = declared_.virtual_inertia;
      auto tau = tau_;
      for (std::size_t i = 0; i < 6; ++i) {
        tau[i] -= dry_[i] * std::tanh(x.dq[i] / 0.01);
        const double past = std::max(x.q[i] - upper_[i], 0.0) - std::max(lower_[i] - x.q[i], 0.0);
        if (past != 0) tau[i] -= stop_stiffness * past + stop_damping * x.dq[i];
        if (fast[i]) x.dq[i] = 0, motors[i] = 1e9;
      }
      const JointTorque<6> push = pushes(x.q, force);
      tau += push;
      const double h = seconds<double>(plant_step);
      x.dq = integrate(x.dq, acceleration(ur5::Model{}, x, tau, motors), h);
      x.q = integrate(x.q, x.dq, h);
      given += h * power(push, x.dq);
    }
  }

 private:
  RobotConfiguration<6> declared_;
  std::array<double, 6> dry_, lower_, upper_;
  JointTorque<6> tau_;
  std::deque<std::pair<Nanoseconds, JointTorque<6>>> under_way_;
};

template <class P>
void run(std::uint64_t seed, Findings& found, bool trace) {
  std::mt19937_64 rng(seed);
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  const Drawn d(rng);
  const auto made = unless_refused(trace, [&] { return scene_of<P>(d); });
  if (!made) {
    ++found.refused;
    return;
  }
  const auto& scene = *made;
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const double dt = seconds<double>(d.robot.period);
  const auto& limits = d.robot.limits;
  Arm robot(d);
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, robot.x);
  robot.start(memory->robot.command().torque);

  const double busy = roll(3, 8), ends = busy + quiet;
  JointTorque<6> last = memory->robot.command().torque;
  double torque = 0, rate = 0, velocity = 0, pushed = 0, beyond = 0, stop = 0, energy = 0, invalid = 0;
  Nanoseconds now{};
  double last_push = -1, printed = 0;
  bool stopping = false;
  Swings swings(rests);
  std::array<double, 6>
      left{};  // how far pushes have left each joint beyond its end, and it has not come back
  std::array<double, 6> freed{};  // speed that a joint may have as it was let go
  while (seconds<double>(now) < ends + stops_in + 1) {
    const Nanoseconds before = now;
    now += d.robot.period * (roll(0, 1) < d.late ? 2 + long(rng() % 3) : 1);
    const double t = seconds<double>(now);
    robot.advance(now);
    typename Scene::Input input;
    input.now = now;
    input.measured = robot.x;
    // What happens: about two events a second, until it is quiet.
    if (t < busy && roll(0, 1) < 2 * dt) switch (rng() % 8) {
        case 0:
        case 1:
        case 2:
          robot.force[rng() % cells] = roll(0, 60);
          break;
        case 3:
          robot.force = {};
          break;
        case 4: {
          const std::size_t i = rng() % 6;
          if (robot.fast[i])
            freed[i] = robot.let_go(i), last_push = t;
          else
            robot.fast[i] = true;
          break;
        }
        case 5:
          input.request = rng() % 2 == 0 ? CycleRequest::stop : CycleRequest::resume;
          break;
        default: {
          JointPosition<6> goal;
          for (std::size_t i = 0; i < 6; ++i) goal[i] = home[i] + roll(-0.6, 0.6);
          input.goal = {goal, nanoseconds(roll(0.5, 4))};
        }
      }
    if (t >= busy) robot.force = {};
    for (std::size_t i = 0; i < 6; ++i)
      if (t >= busy && robot.fast[i]) freed[i] = robot.let_go(i), last_push = t;
    if (t >= busy && t < busy + 2 * dt) input.request = CycleRequest::resume;
    if (t >= ends && !stopping) input.request = CycleRequest::stop, stopping = true;
    for (const double f : robot.force)
      if (f > 0) last_push = t;
    const auto sent = samples(robot.force, now);
    input.samples = sent;
    const auto out = scene.step(*memory, input);
    ++found.cycles;
    invalid += !out.command.valid;
    if (P::tank) energy = std::max(energy, robot.kinetic() - (1 + port_gain) * robot.given - tank_start);
    const bool alone = t - last_push > 0.5;
    double fastest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const double tau = out.command.torque[i], most = limits.torque()[i];
      torque = std::max(torque, std::abs(tau) / most);
      rate = std::max(rate,
                      std::abs(tau - last[i]) / (d.robot.torque_rate * most * seconds<double>(now - before)));
      const double v = std::abs(robot.x.dq[i]);
      fastest = std::max(fastest, v);
      if (alone) freed[i] = 0;
      (alone ? velocity : pushed) =
          std::max(alone ? velocity : pushed, (v - freed[i]) / limits.velocity()[i]);
      const double past = std::max(robot.x.q[i] - limits.upper()[i], limits.lower()[i] - robot.x.q[i]);
      if (!alone || past < left[i]) left[i] = std::max(past, 0.0);
      if (alone) beyond = std::max(beyond, past - left[i]);
    }
    if (t > ends - watched && !stopping) swings.take(robot.x.dq);
    if (t > ends + stops_in) stop = std::max(stop, fastest);
    last = out.command.torque;
    robot.command(out.command.torque);
    if (!(fastest < 100)) break;
    if (trace && t >= printed) {
      std::printf("%5.1f s  fastest %.2g rad/s  ", t, fastest);
      for (std::size_t c = 0; c < cells; ++c)
        if (robot.force[c] > 0) std::printf(" %.0fN@%zu", robot.force[c], c + 1);
      for (std::size_t i = 0; i < 6; ++i)
        if (robot.fast[i]) std::printf(" held%zu", i);
      print_reasons(out.status);
      std::printf("\n");
      printed += 0.25;
    }
  }
  ++found.scenes;
  found.torque.take(torque, seed), found.rate.take(rate, seed), found.velocity.take(velocity, seed);
  found.pushed.take(pushed, seed), found.ends.take(beyond, seed), found.swing.take(swings.worst(), seed);
  found.stop.take(stop, seed), found.energy.take(energy, seed), found.invalid.take(invalid, seed);
  if (trace)
    std::printf(
        "period %.2f ms, delay %.1f ms, late %.2f: torque %.4f, rate %.4f, velocity %.4f, pushed %.4f, "
        "beyond %.2g rad, swing %.2g, stop %.2g rad/s, energy %.3g J\n",
        1e3 * dt, 1e3 * seconds<double>(d.robot.delay), d.late, torque, rate, velocity, pushed, beyond,
        swings.worst(), stop, energy);
}

/// The scene of a seed: its number says which parts it has.
void run(std::uint64_t seed, Findings& found, bool trace) {
  switch (seed % 4) {
    case 0:
      return run<Parts<false, false>>(seed, found, trace);
    case 1:
      return run<Parts<true, false>>(seed, found, trace);
    case 2:
      return run<Parts<false, true>>(seed, found, trace);
    default:
      return run<Parts<true, true>>(seed, found, trace);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return attack_main<Findings>(argc, argv, run);
}
