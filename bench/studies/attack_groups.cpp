// Random legal scenes of an arm whose joints have two interfaces, in a world that keeps what was declared and
// does all else: pushes, goals, late cycles, stops and resumes in any order. The sister of `attack` and
// `attack_torque`.
//
//     attack_groups [CYCLES = 500000] [SEED = 1]     that many cycles
//     attack_groups run SEED                         one scene, each quarter of a second of it
//
// The arm is a UR5, its joints by position, velocity and torque in five mixtures; joints by torque have a
// delay and dry friction that nobody declared, and are pushed along by the others' accelerations. Each scene
// ends with some time in which nobody does anything, and a stop. Judged: velocity and acceleration of joints
// by position and velocity in the servo's time, torques within their limits, runaways at any time, the ends
// of the joints, swings that are left at rest, and the speed after the stop. Returns 1 if any is passed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <memory>
#include <random>
#include <type_traits>

#include "bench/studies/attack/common.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using namespace attacks;

namespace {

constexpr double rounding = 1e-4;  ///< share of a limit that is no breach
constexpr double held_torque =
    0.05;  ///< excess over a limit of speed that a torque may leave, held for a delay
constexpr double beyond_end = 5e-3;  ///< way of a joint beyond its end when nobody pushed [rad]
constexpr double runs_away = 2;      ///< speed, in limits of it, that no push of these gives
constexpr double rests = 0.02;       ///< speed of a joint at rest, when nothing has happened for long [rad/s]
constexpr double quiet = 25;         ///< time in which nobody does anything [s]
constexpr double watched = 5;        ///< last part of it, in which nothing may swing [s]
constexpr double stops_in = 5;       ///< time after which a stopped arm stands [s]
constexpr Nanoseconds plant_step = 250us;
/// The mechanical stops: behind the declared ends [rad], and as stiff as rubber [N m/rad, N m s/rad].
constexpr double behind_end = 0.1, stop_stiffness = 1000, stop_damping = 10;

struct Findings {
  Found velocity{"velocity over its limit, by position and velocity", 1 + rounding};
  Found acceleration{"acceleration over its limit, by position and velocity", 1 + rounding};
  Found torque{"torque over its limit", 1 + rounding};
  Found alone{"velocity over its limit, by torque, nobody pushing", 1 + held_torque};
  Found pushed{"velocity over its limit, by torque, pushed", runs_away};
  Found ends{"way beyond the end of a joint, nobody pushing [rad]", beyond_end};
  Found tool{"speed of the tool over its limit, nobody pushing", 1 + held_torque};
  Found swing{"swing at rest: speed between two turns of a joint [rad/s]", rests};
  Found stop{"speed after a stop [rad/s]", rests};
  Found invalid{"commands that are none", 0};
  std::uint64_t cycles = 0, scenes = 0, refused = 0;
  auto all() {
    return std::array{&velocity, &acceleration, &torque, &alone, &pushed,
                      &ends,     &tool,         &swing,  &stop,  &invalid};
  }
};

/// Joints by velocity and by torque (the others by position), and the parts of a scene.
template <LinkMask ByVelocity, LinkMask ByTorque, bool Tool, bool Tank>
struct Parts {
  static constexpr LinkMask by_velocity = ByVelocity, by_torque = ByTorque,
                            by_position = 0b111111 & ~(ByVelocity | ByTorque);
  static constexpr bool tool = Tool, tank = Tank;
};

/// Numbers of a scene: anything that is legal.
struct Drawn {
  RobotConfiguration<6> stiff, driven;
  double softer = 1;  ///< gain of the law, of the one that fits the robot
  MaxToolSpeed<5> tool{.speed = 0.2, .reach = 1.3};
  double late = 0;              ///< share of cycles that are late
  std::array<double, 6> dry{};  ///< friction of the real joints by torque, which nobody knows [N m]

  explicit Drawn(std::mt19937_64& rng)
      : stiff{.limits = limits_of<ur5::Description>(15.0), .period = 2ms}, driven(stiff) {
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    auto v = limits_of<ur5::Description>(roll(5, 30)).values();
    for (std::size_t i = 0; i < 6; ++i) {
      v.velocity[i] = roll(0.3, 1) * v.velocity[i];
      v.lower[i] = home[i] - roll(0.3, 3), v.upper[i] = home[i] + roll(0.3, 3);
      if (rng() % 2 == 0) driven.viscous_friction[i] = roll(0, 20);
      if (rng() % 3 == 0) stiff.viscous_friction[i] = roll(0, 20);
      if (rng() % 2 == 0) dry[i] = roll(0, 4);
    }
    stiff.limits = driven.limits = JointLimits<6>(v);
    stiff.period = driven.period = nanoseconds(1e-3 * std::pow(8.0, roll(0, 1)));
    stiff.delay = rng() % 4 == 0 ? 0ns : nanoseconds(roll(0, 0.04));
    stiff.lag = nanoseconds(roll(0.004, 0.04));  // without one joints by position would move in steps
    stiff.virtual_damping = roll(2, 8);
    driven.delay = rng() % 4 == 0 ? 0ns : nanoseconds(roll(0, 0.02));
    tool.speed = roll(0.1, 1);
    late = rng() % 2 == 0 ? 0.0 : roll(0, 0.1);
    softer = roll(0.3, 1);
  }
};

/// The configuration of the joints `Set`.
template <LinkMask Set>
auto part(const RobotConfiguration<6>& c) {
  using S = JointSubset<6, Set>;
  constexpr std::size_t n = S::count;
  const auto v = c.limits.values();
  RobotConfiguration<n> out{.limits = JointLimits<n>({.lower = S::of(v.lower),
                                                      .upper = S::of(v.upper),
                                                      .velocity = S::of(v.velocity),
                                                      .acceleration = S::of(v.acceleration),
                                                      .torque = S::of(v.torque)}),
                            .period = c.period,
                            .delay = c.delay,
                            .lag = c.lag,
                            .virtual_damping = c.virtual_damping};
  out.viscous_friction = S::of(c.viscous_friction);
  out.virtual_inertia = S::of(c.virtual_inertia);
  return out;
}
template <class P, class... More>
auto robot_of(const Drawn& d, const More&... more) {
  const ur5::Model model;
  if constexpr (P::by_position != 0 && P::by_velocity != 0 && P::by_torque != 0) {
    return by_groups(model, position_joints<P::by_position>(part<P::by_position>(d.stiff)),
                     velocity_joints<P::by_velocity>(part<P::by_velocity>(d.stiff)),
                     torque_joints<P::by_torque>(part<P::by_torque>(d.driven)), more...);
  } else if constexpr (P::by_torque == 0) {
    return by_groups(model, position_joints<P::by_position>(part<P::by_position>(d.stiff)),
                     velocity_joints<P::by_velocity>(part<P::by_velocity>(d.stiff)), more...);
  } else if constexpr (P::by_velocity == 0) {
    return by_groups(model, position_joints<P::by_position>(part<P::by_position>(d.stiff)),
                     torque_joints<P::by_torque>(part<P::by_torque>(d.driven)), more...);
  } else {
    return by_groups(model, velocity_joints<P::by_velocity>(part<P::by_velocity>(d.stiff)),
                     torque_joints<P::by_torque>(part<P::by_torque>(d.driven)), more...);
  }
}
template <class P>
auto scene_of(const Drawn& d) {
  auto tracking = tracking_settings(robot_of<P>(d));
  tracking.lambda *= d.softer, tracking.K_c *= d.softer, tracking.K_i1 *= d.softer, tracking.K_i2 *= d.softer;
  const auto law = SplineJoint<6>(tracking) + SkinJointControl{} + GravityControl{};
  const auto plain = [&] {
    if constexpr (P::tank) {
      return Cycle(robot_of<P>(d, EnergyTank<>({.start = 1, .max = 1})), skin(), law);
    } else {
      return Cycle(robot_of<P>(d), skin(), law);
    }
  }();
  if constexpr (P::tool) {
    return plain.with(d.tool);
  } else {
    return plain;
  }
}

/// The real arm. Its joints by position and velocity follow whatever pushes; those by torque are moved by
/// their torque, pushes, their own weight and the others' accelerations.
template <class P>
class Arm {
  using Driven = JointSubset<6, P::by_torque>;

 public:
  State<6> x{0ns, home, {}};
  Forces force{};

  explicit Arm(const Drawn& d)
      : dry_(d.dry),
        delay_(d.driven.delay),
        positions_(Joints::Kind::position, seconds<double>(d.stiff.delay), seconds<double>(d.stiff.lag),
                   row(home)),
        velocities_(Joints::Kind::velocity, seconds<double>(d.stiff.delay), seconds<double>(d.stiff.lag),
                    row(home)) {
    for (std::size_t i = 0; i < 6; ++i) {
      lower_[i] = d.driven.limits.lower()[i] - behind_end,
      upper_[i] = d.driven.limits.upper()[i] + behind_end;
    }
  }
  void start(const JointTorque<6>& tau) { tau_ = tau; }
  template <class Planned>
  void command(const Planned& c) {
    const double t = seconds<double>(x.time);
    positions_.command(t, row(c.position));
    velocities_.command(t, row(c.velocity));
    under_way_.push_back({x.time + delay_, c.torque});
  }
  void advance(Nanoseconds now) {
    const double h = seconds<double>(plant_step);
    for (; x.time < now; x.time += plant_step) {
      for (; !under_way_.empty() && under_way_.front().first <= x.time; under_way_.pop_front())
        tau_ = under_way_.front().second;
      const double t = seconds<double>(x.time + plant_step);
      positions_.advance(t), velocities_.advance(t);
      JointAcceleration<6> ddq;
      State<6> next = x;
      for (std::size_t i = 0; i < 6; ++i) {
        if ((P::by_torque >> i) & 1u) continue;
        const auto& of = ((P::by_velocity >> i) & 1u) ? velocities_ : positions_;
        next.q[i] = of.q()[i];
        next.dq[i] = (next.q[i] - x.q[i]) / h;
        ddq[i] = (next.dq[i] - x.dq[i]) / h;
      }
      if constexpr (Driven::count > 0) {
        const JointAngles<ur5::Model, double> angles(ur5::Model{}, x.q);
        const auto mass = mass_matrix(ur5::Model{}, angles);
        const auto bias = bias_torque(ur5::Model{}, angles, x.dq);
        const JointTorque<6> push = pushes(x.q, force);
        JointTorque<Driven::count> net;
        MassMatrix<Driven::count> own;
        for (std::size_t i = 0; i < Driven::count; ++i) {
          const std::size_t I = Driven::index[i];
          net[i] = tau_[I] + push[I] - bias[I];
          // Friction and stops at the end of the step: a wrist of a few grams would be shaken by them
          // otherwise.
          double drag = dry_[I] / std::max(std::abs(x.dq[I]), 0.01), spring = 0;
          const double past = std::max(x.q[I] - upper_[I], 0.0) - std::max(lower_[I] - x.q[I], 0.0);
          if (past != 0) drag += stop_damping, spring = stop_stiffness;
          net[i] -= spring * past + (drag + h * spring) * x.dq[I];
          for (const std::size_t j : Driven::Others::index) net[i] -= mass(I, j) * ddq[j];
          for (std::size_t j = 0; j < Driven::count; ++j) own(i, j) = mass(I, Driven::index[j]);
          own(i, i) += h * (drag + h * spring);
        }
        JointAcceleration<Driven::count> given;
        math::Ldlt<Driven::count, double>(own.data).solve(net.data, given.data);
        for (std::size_t i = 0; i < Driven::count; ++i) {
          const std::size_t I = Driven::index[i];
          next.dq[I] = x.dq[I] + h * given[i];
          next.q[I] = x.q[I] + h * next.dq[I];
        }
      }
      x.q = next.q, x.dq = next.dq;
    }
  }

 private:
  using Joints = SimulatedJoints<6>;
  template <class V>
  static typename Joints::Row row(const V& v) {
    typename Joints::Row r{};
    for (std::size_t i = 0; i < 6; ++i) r[i] = v[i];
    return r;
  }
  std::array<double, 6> dry_, lower_{}, upper_{};
  Nanoseconds delay_;
  Joints positions_, velocities_;
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
  const double dt = seconds<double>(d.stiff.period);
  const auto& limits = d.stiff.limits;
  Arm<P> robot(d);
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, robot.x);
  robot.start(memory->robot.command().torque);

  const double busy = roll(3, 8), ends = busy + quiet;
  JointVelocity<6> last;
  double velocity = 0, acceleration = 0, torque = 0, unpushed = 0, pushed = 0, beyond = 0, tool = 0, stop = 0,
         invalid = 0;
  Nanoseconds now{};
  double last_push = -1, printed = 0;
  bool stopping = false;
  Swings swings(rests);
  std::array<double, 6>
      left{};  // how far pushes have left each joint beyond its end, and it has not come back
  while (seconds<double>(now) < ends + stops_in + 1) {
    now += roll(0, 1) < d.late ? d.stiff.period * (2 + long(rng() % 3)) : d.stiff.period;
    const double t = seconds<double>(now);
    const JointPosition<6> before = robot.x.q;
    const Nanoseconds then = robot.x.time;
    robot.advance(now);
    typename Scene::Input input;
    input.now = now;
    input.measured = robot.x;
    input.measured.time = now;
    // What happens: about two events a second, until it is quiet.
    if (t < busy && roll(0, 1) < 2 * dt) switch (rng() % 7) {
        case 0:
        case 1:
        case 2:
          robot.force[rng() % cells] = roll(0, 60);
          break;
        case 3:
          robot.force = {};
          break;
        case 4:
          input.request = rng() % 2 == 0 ? CycleRequest::stop : CycleRequest::resume;
          break;
        default: {
          JointPosition<6> goal;
          for (std::size_t i = 0; i < 6; ++i) goal[i] = home[i] + roll(-0.6, 0.6);
          input.goal = {goal, nanoseconds(roll(0.5, 4))};
        }
      }
    if (t >= busy) robot.force = {};
    if (t >= busy && t < busy + 2 * dt) input.request = CycleRequest::resume;
    if (t >= ends && !stopping) input.request = CycleRequest::stop, stopping = true;
    for (const double f : robot.force)
      if (f > 0) last_push = t;
    const auto sent = samples(robot.force, now);
    input.samples = sent;
    const auto out = scene.step(*memory, input);
    ++found.cycles;
    invalid += !out.command.valid;
    const bool alone = t - last_push > 0.5;
    double fastest = 0;
    const auto& v = out.planned.velocity;
    for (std::size_t i = 0; i < 6; ++i) {
      const double speed = std::abs(robot.x.dq[i]) / limits.velocity()[i];
      fastest = std::max(fastest, std::abs(robot.x.dq[i]));
      if ((P::by_torque >> i) & 1u) {
        torque = std::max(torque, std::abs(out.planned.torque[i]) / limits.torque()[i]);
        (alone ? unpushed : pushed) = std::max(alone ? unpushed : pushed, speed);
      } else {
        velocity = std::max(velocity, std::abs(v[i]) / limits.velocity()[i]);
        acceleration = std::max(acceleration, std::abs(v[i] - last[i]) / (limits.acceleration()[i] * dt));
      }
      const double past = std::max(robot.x.q[i] - limits.upper()[i], limits.lower()[i] - robot.x.q[i]);
      if (!alone || past < left[i]) left[i] = std::max(past, 0.0);
      if (alone) beyond = std::max(beyond, past - left[i]);
    }
    if (P::tool && alone) {
      const auto way = tool_at(robot.x.q) - tool_at(before);
      tool = std::max(tool, std::sqrt(dot(way, way)) / (d.tool.speed * seconds<double>(robot.x.time - then)));
    }
    if (t > ends - watched && !stopping) swings.take(robot.x.dq);
    if (t > ends + stops_in) stop = std::max(stop, fastest);
    last = v;
    robot.command(out.planned);
    if (!(fastest < 100)) break;
    if (trace && t >= printed) {
      std::printf("%5.1f s  fastest %.2g rad/s  ", t, fastest);
      for (std::size_t c = 0; c < cells; ++c)
        if (robot.force[c] > 0) std::printf(" %.0fN@%zu", robot.force[c], c + 1);
      print_reasons(out.status);
      std::printf("\n");
      printed += 0.25;
    }
  }
  ++found.scenes;
  found.velocity.take(velocity, seed), found.acceleration.take(acceleration, seed),
      found.torque.take(torque, seed);
  found.alone.take(unpushed, seed), found.pushed.take(pushed, seed), found.ends.take(beyond, seed);
  found.tool.take(tool, seed), found.swing.take(swings.worst(), seed), found.stop.take(stop, seed);
  found.invalid.take(invalid, seed);
  if (trace)
    std::printf(
        "period %.2f ms, stiff %.1f + %.1f ms, by torque %.1f ms, late %.2f: velocity %.4f, acceleration "
        "%.4f, torque %.4f, "
        "unpushed %.4f, pushed %.4f, beyond %.2g rad, tool %.3f, swing %.2g, stop %.2g rad/s\n",
        1e3 * dt, 1e3 * seconds<double>(d.stiff.delay), 1e3 * seconds<double>(d.stiff.lag),
        1e3 * seconds<double>(d.driven.delay), d.late, velocity, acceleration, torque, unpushed, pushed,
        beyond, tool, swings.worst(), stop);
}

/// The scene of a seed: its number says which joints have which interface, and which parts it has.
void run(std::uint64_t seed, Findings& found, bool trace) {
  switch (seed % 7) {
    case 0:
      return run<Parts<0b111000, 0, true, false>>(seed, found, trace);
    case 1:
      return run<Parts<0, 0b111000, false, false>>(seed, found, trace);
    case 2:
      return run<Parts<0, 0b111000, true, true>>(seed, found, trace);
    case 3:
      return run<Parts<0b111000, 0b000111, false, false>>(seed, found, trace);
    case 4:
      return run<Parts<0b000111, 0b111000, true, false>>(seed, found, trace);
    case 5:
      return run<Parts<0b010010, 0b100100, false, true>>(seed, found, trace);
    default:
      return run<Parts<0b010010, 0b100100, true, false>>(seed, found, trace);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return attack_main<Findings>(argc, argv, run);
}
