// Random legal scenes in a world that keeps what was declared and does all else: touches, goals, late cycles,
// joints held fast, stops and resumes in any order, with every limit and passive part in or out.
//
//     attack [CYCLES = 500000] [SEED = 1]     that many cycles by position, by velocity and by impedance
//     attack run SEED                         one scene, each quarter of a second of it
//
// Each scene ends with some time in which nobody does anything, and a stop. Judged in the servo's time, in
// which a command lasts one period: velocity, acceleration and jerk of each joint, the way of the tool in a
// period (by velocity that of the real one, while no joint is held), the ends of the joints (by impedance of
// the commands), torques and their rate; swings that are left at rest, and the speed after the stop. Returns
// 1 if any is passed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <random>
#include <type_traits>

#include "bench/studies/attack/common.hpp"
#include "skinctl/testing/impedance_plant.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using namespace attacks;

namespace {

constexpr double rounding = 1e-4;       ///< share of a limit that is no breach
constexpr double jerk_gives_way = 0.0;  ///< of the tool's way, in cycles in which jerk is the harder limit
constexpr double rests = 1e-3;   ///< speed of a joint at rest, when nothing has happened for long [rad/s]
constexpr double stands = 1e-6;  ///< the same after a stop [rad/s]
/// Nobody does anything for so many time constants of the goal's gain, and for this time [s].
constexpr double constants = 15, quiet = 12;
constexpr double least_gain = 0.1;  ///< K_c of a scene that is run: others take minutes to come to rest [1/s]
constexpr double longest_way = 2;   ///< of a tool back to its goal [m], at its greatest speed
constexpr double let_go = 1;        ///< after which a joint that was held moves as planned [s]
constexpr double watched = 6;       ///< last part of it, in which nothing may swing [s]

struct Findings {
  Found velocity{"velocity over its limit", 1 + rounding};
  Found acceleration{"acceleration over its limit", 1 + rounding};
  Found jerk{"jerk over its limit, unsaid", 1 + rounding};
  Found tool{"way of the tool in a period over its limit", 1 + jerk_gives_way};
  Found ends{"beyond the ends of a joint [rad]", 1e-3};
  Found swing{"swing at rest: speed between two turns of a joint [rad/s]", rests};
  Found stop{"speed after a stop [rad/s]", stands};
  Found torque{"torque over its limit", 1 + rounding};
  Found rate{"change of a torque over the guard's", 1 + rounding};
  Found invalid{"commands that are none", 0};
  std::uint64_t cycles = 0, scenes = 0, refused = 0;
};

/// Which parts a scene has.
template <bool Jerk, bool Tool, bool Tank, bool Observer>
struct Parts {
  static constexpr bool jerk = Jerk, tool = Tool, tank = Tank, observer = Observer;
};

/// Numbers of a scene: anything that is legal.
struct Drawn {
  RobotConfiguration<6> robot;
  double softer = 1;  ///< gain of the law, of the one that fits the robot
  MaxJerk<6> jerk{};
  MaxToolSpeed<5> tool{.speed = 0.2, .reach = 1.3};
  double late = 0;  ///< share of cycles that are late
  ImpedanceTruth<6> springs{};

  explicit Drawn(std::mt19937_64& rng) : robot{.limits = limits_of<ur5::Description>(15.0), .period = 8ms} {
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    auto v = limits_of<ur5::Description>(roll(3, 40)).values();
    for (std::size_t i = 0; i < 6; ++i) {
      v.velocity[i] = roll(0.2, 1) * v.velocity[i];
      v.lower[i] = home[i] - roll(0.1, 3), v.upper[i] = home[i] + roll(0.1, 3);
    }
    robot.limits = JointLimits<6>(v);
    robot.period = nanoseconds(5e-4 * std::pow(40.0, roll(0, 1)));
    robot.delay = rng() % 4 == 0 ? 0ns : nanoseconds(roll(0, 0.06));
    robot.lag = rng() % 4 == 0 ? 0ns : nanoseconds(roll(0, 0.06));
    robot.virtual_damping = roll(2, 8);
    for (std::size_t i = 0; i < 6; ++i) {
      if (rng() % 3 == 0) robot.viscous_friction[i] = roll(0, 20);
      if (rng() % 3 == 0) robot.coulomb_friction[i] = roll(0, 3);
      if (rng() % 3 == 0) robot.virtual_inertia[i] = roll(0, 5);
    }
    for (double& j : jerk.jerk) j = 20 * std::pow(5000.0, roll(0, 1));
    tool.speed = roll(0.05, 1);
    late = rng() % 2 == 0 ? 0.0 : roll(0, 0.2);
    softer = roll(0.2, 1);
  }
  /// Springs as a robot by joint impedance has them, declared as its documentation asks for.
  void draw_springs(std::mt19937_64& rng) {
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    const double stiffness = 200 * std::pow(25.0, roll(0, 1));
    springs.damping_ratio = roll(0.5, 1);
    springs.period = seconds<double>(robot.period);
    springs.delay = rng() % 4 == 0 ? 0 : roll(0, 0.02);
    const auto mass = mass_matrix(ur5::Model{}, home);
    double slowest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      springs.stiffness[i] = i < 3 ? stiffness : 0.5 * stiffness, springs.rotors[i] = i < 3 ? 0.3 : 0.1;
      slowest = std::max(slowest, 2 * springs.damping_ratio *
                                      std::sqrt((mass(i, i) + springs.rotors[i]) / springs.stiffness[i]));
    }
    robot.stiffness = springs.stiffness;
    robot.spring_lag = nanoseconds(slowest);
    robot.delay = nanoseconds(springs.delay) + robot.period / 2;  // it goes to each position within a period
    robot.lag = 0ns;
  }
};

template <class Joints>
std::array<double, 6> row(const Joints& x) {
  return {x[0], x[1], x[2], x[3], x[4], x[5]};
}

/// The real arm: stiff joints, or links on springs.
template <Interface I>
class Arm {
  using Joints = SimulatedJoints<6>;

 public:
  explicit Arm(const Drawn& d)
      : joints_(I == Interface::position ? Joints::Kind::position : Joints::Kind::velocity,
                seconds<double>(d.robot.delay), seconds<double>(d.robot.lag), row(home)) {}
  void advance(double t, const Forces&) { joints_.advance(t); }
  void hold_fast(std::size_t i, bool fast) { joints_.hold_fast(i, fast); }
  template <class Output>
  void command(double t, const Output& out) {
    if constexpr (I == Interface::position) {
      joints_.command(t, row(out.planned.position));
    } else {
      joints_.command(t, row(out.planned.velocity));
    }
  }
  [[nodiscard]] const auto& q() const { return joints_.q(); }
  [[nodiscard]] const auto& dq() const { return joints_.dq(); }

 private:
  Joints joints_;
};
template <>
class Arm<Interface::impedance> {
 public:
  explicit Arm(const Drawn& d) : plant_(ur5::Model{}, d.springs, home) {}
  void advance(double t, const Forces& force) {
    for (; time_ < t; time_ += 1e-3) {
      plant_.push(pushes(plant_.q(), force));
      plant_.run(std::min(1e-3, t - time_));
    }
    time_ = t;
  }
  void hold_fast(std::size_t i, bool fast) { plant_.hold_fast(i, fast); }
  template <class Output>
  void command(double, const Output& out) {
    if (out.command.valid) plant_.command(out.command);
  }
  [[nodiscard]] const auto& q() const { return plant_.q(); }
  [[nodiscard]] const auto& dq() const { return plant_.dq(); }

 private:
  ImpedancePlant<ur5::Model> plant_;
  double time_ = 0;
};

template <Interface I, class... Parts>
auto robot_of(const Drawn& d, const Parts&... parts) {
  if constexpr (I == Interface::position) {
    return by_position(ur5::Model{}, d.robot, parts...);
  } else if constexpr (I == Interface::impedance) {
    return by_impedance(ur5::Model{}, d.robot, parts...);
  } else {
    return by_velocity(ur5::Model{}, d.robot, parts...);
  }
}
template <Interface I, class P>
JointControlSettings<6> tracking_of(const Drawn& d) {
  const auto robot = robot_of<I>(d);
  auto tracking = P::jerk ? tracking_settings(robot, d.jerk.jerk) : tracking_settings(robot);
  tracking.lambda *= d.softer, tracking.K_c *= d.softer;
  return tracking;
}
template <Interface I, class P>
auto scene_of(const Drawn& d) {
  const auto robot = [&](const auto&... parts) { return robot_of<I>(d, parts...); };
  const auto law = SplineJoint<6>(tracking_of<I, P>(d)) + SkinJointControl{} + GravityControl{};
  const EnergyTank<> tank({.start = 1, .max = 1});
  const PassivityObserver<> observer({.start = 1, .max = 1});
  const auto plain = [&] {
    if constexpr (P::tank && P::observer) {
      return Cycle(robot(tank, observer), skin(), law);
    } else if constexpr (P::tank) {
      return Cycle(robot(tank), skin(), law);
    } else if constexpr (P::observer) {
      return Cycle(robot(observer), skin(), law);
    } else {
      return Cycle(robot(), skin(), law);
    }
  }();
  return with_limits<P>(plain, d.jerk, d.tool);
}

template <Interface I, class P>
void run(std::uint64_t seed, Findings& found, bool trace) {
  std::mt19937_64 rng(seed);
  const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
  Drawn d(rng);
  if constexpr (I == Interface::impedance) d.draw_springs(rng);
  if (tracking_of<I, P>(d).K_c < least_gain) {
    ++found.refused;
    return;
  }
  const auto made = unless_refused(trace, [&] { return scene_of<I, P>(d); });
  if (!made) {
    ++found.refused;
    return;
  }
  const auto& scene = *made;
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const double dt = seconds<double>(d.robot.period);
  Arm<I> robot(d);
  State<6> measured;
  const auto measure = [&](Nanoseconds now) {
    measured.time = now;
    for (std::size_t i = 0; i < 6; ++i) measured.q[i] = robot.q()[i], measured.dq[i] = robot.dq()[i];
  };
  measure(0ns);
  const auto memory = std::make_unique<typename Scene::Memory>();
  scene.start(*memory, measured);

  const double busy = roll(3, 8), way_back = P::tool ? longest_way / d.tool.speed : 0,
               ends = busy + quiet + way_back + constants / tracking_of<I, P>(d).K_c;
  double most_jerk_time = 0;
  for (std::size_t i = 0; i < 6; ++i)
    most_jerk_time =
        std::max(most_jerk_time, d.robot.limits.velocity()[i] / d.robot.limits.acceleration()[i] +
                                     2 * d.robot.limits.acceleration()[i] / d.jerk.jerk[i]);
  const double stops_in = 6 * most_jerk_time + 8 * dt;
  Forces force{};
  JointVelocity<6> last;
  JointAcceleration<6> before;
  JointPosition<6> at = measured.q;
  JointTorque<6> last_torque;
  double velocity = 0, acceleration = 0, jerk = 0, tool = 0, beyond = 0, stop = 0, invalid = 0, torque = 0,
         rate = 0;
  Nanoseconds now{}, asked{};
  double held = -let_go;
  std::array<bool, 6> fast{};
  bool stopping = false;
  Swings swings(rests);
  Status all;
  double printed = 0;
  while (seconds<double>(now) < ends + stops_in + 1) {
    const Nanoseconds before_now = now;
    now += d.robot.period * (roll(0, 1) < d.late ? 2 + long(rng() % 4) : 1);
    const double t = seconds<double>(now);
    robot.advance(t, force);
    const State<6> stood = measured;
    measure(now);
    // A joint that is held takes away what cancelled the motion of the others: nobody can know before.
    if (std::find(fast.begin(), fast.end(), true) != fast.end()) held = t;
    if (I == Interface::velocity && P::tool && t > held + let_go) {
      const auto way = tool_at(measured.q) - tool_at(stood.q);
      tool = std::max(tool, std::sqrt(dot(way, way)) / (d.tool.speed * seconds<double>(now - stood.time)));
    }
    typename Scene::Input input;
    input.now = now;
    input.measured = measured;
    // What happens: about three events a second, until it is quiet.
    if (t < busy && roll(0, 1) < 3 * dt) switch (rng() % 8) {
        case 0:
        case 1:
        case 2:
          force[rng() % cells] = roll(0, 60);
          break;
        case 3:
          force = {};
          break;
        case 4: {
          const std::size_t i = rng() % 6;
          robot.hold_fast(i, fast[i] = rng() % 2 == 0);
          break;
        }
        case 5:
          input.request = rng() % 2 == 0 ? CycleRequest::stop : CycleRequest::resume;
          break;
        default: {
          JointPosition<6> goal;
          for (std::size_t i = 0; i < 6; ++i) goal[i] = home[i] + roll(-0.6, 0.6);
          input.goal = {goal, nanoseconds(roll(0.2, 4))};
        }
      }
    if (t >= busy) {
      force = {};
      fast = {};
      for (std::size_t i = 0; i < 6; ++i) robot.hold_fast(i, false);
    }
    if (t >= busy && t < busy + 2 * dt) input.request = CycleRequest::resume;
    if (t >= ends && !stopping) input.request = CycleRequest::stop, stopping = true, asked = now;
    const auto heard = samples(force, now);
    input.samples = heard;
    const auto out = scene.step(*memory, input);
    ++found.cycles;
    all |= out.status;
    invalid += !out.command.valid;
    const auto& v = out.planned.velocity;
    double fastest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      velocity = std::max(velocity, std::abs(v[i]) / d.robot.limits.velocity()[i]);
      acceleration =
          std::max(acceleration, std::abs(v[i] - last[i]) / (d.robot.limits.acceleration()[i] * dt));
      if (P::jerk && !P::tool && !out.status.has(Reason::jerk_exceeded))
        jerk = std::max(jerk,
                        (std::abs(out.planned.acceleration[i] - before[i]) - 1e-9) / (d.jerk.jerk[i] * dt));
      const double place = I == Interface::impedance ? out.planned.position[i] : robot.q()[i];
      beyond = std::max({beyond, place - d.robot.limits.upper()[i], d.robot.limits.lower()[i] - place});
      fastest = std::max(fastest, std::abs(v[i]));
    }
    if (t > ends - watched && !stopping) swings.take(v);
    if (stopping && seconds<double>(now - asked) > stops_in) stop = std::max(stop, fastest);
    if constexpr (I == Interface::impedance) {
      for (std::size_t i = 0; i < 6; ++i) {
        const double tau = out.command.torque[i], most = d.robot.limits.torque()[i];
        torque = std::max(torque, std::abs(tau) / most);
        rate = std::max(rate, std::abs(tau - last_torque[i]) /
                                  (d.robot.torque_rate * most * seconds<double>(now - before_now)));
        fastest = std::max(fastest, std::abs(robot.dq()[i]));
      }
      last_torque = out.command.torque;
    }
    if constexpr (I != Interface::velocity && P::tool) {
      const auto from = tool_at(at), to = tool_at(out.planned.position);
      const double way = std::sqrt(dot(to - from, to - from)) / (d.tool.speed * dt);
      tool = std::max(tool, way);
      if (trace && way > 1 + rounding) {
        std::printf("%7.3f s  tool %.4f ", t, way);
        print_reasons(out.status);
        for (std::size_t i = 0; i < 6; ++i)
          std::printf(" %.3f~%.3f(%.2f)", v[i], (out.planned.position[i] - at[i]) / dt,
                      out.planned.acceleration[i]);
        std::printf("\n");
      }
      at = out.planned.position;
    }
    last = v;
    before = out.planned.acceleration;
    robot.command(t, out);
    if (trace && t >= printed) {
      std::printf("%5.1f s  fastest %.2g rad/s  ", t, fastest);
      print_reasons(out.status);
      std::printf("\n");
      printed += 0.25;
    }
  }
  ++found.scenes;
  found.velocity.take(velocity, seed), found.acceleration.take(acceleration, seed),
      found.jerk.take(jerk, seed);
  found.tool.take(tool, seed), found.ends.take(beyond, seed), found.swing.take(swings.worst(), seed);
  found.stop.take(stop, seed);
  found.torque.take(torque, seed), found.rate.take(rate, seed), found.invalid.take(invalid, seed);
  if (trace)
    std::printf(
        "period %.2f ms, delay %.1f ms, lag %.1f ms, late %.2f: velocity %.4f, acceleration %.4f, jerk %.4f, "
        "tool "
        "%.4f, beyond %.2g rad, swing %.2g, stop %.2g rad/s\n",
        1e3 * dt, 1e3 * seconds<double>(d.robot.delay), 1e3 * seconds<double>(d.robot.lag), d.late, velocity,
        acceleration, jerk, tool, beyond, swings.worst(), stop);
}

/// The scene of a seed: its number says which parts it has.
template <Interface I>
void run(std::uint64_t seed, Findings& found, bool trace) {
  switch (seed % 7) {
    case 0:
      return run<I, Parts<false, false, false, false>>(seed, found, trace);
    case 1:
      return run<I, Parts<true, false, false, false>>(seed, found, trace);
    case 2:
      return run<I, Parts<false, true, false, false>>(seed, found, trace);
    case 3:
      return run<I, Parts<false, false, true, false>>(seed, found, trace);
    case 4:
      return run<I, Parts<true, true, false, false>>(seed, found, trace);
    case 5:
      return run<I, Parts<false, true, false, true>>(seed, found, trace);
    default:
      return run<I, Parts<true, true, true, true>>(seed, found, trace);
  }
}

template <Interface I>
bool attack(const char* name, std::uint64_t cycles, std::uint64_t seed) {
  Findings found;
  while (found.cycles < cycles) run<I>(seed++, found, false);
  std::printf("\n%s: ", name);
  return print_table(std::array{&found.velocity, &found.acceleration, &found.jerk, &found.tool, &found.ends,
                                &found.swing, &found.stop, &found.torque, &found.rate, &found.invalid},
                     found.scenes, found.cycles, found.refused);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 && std::strcmp(argv[1], "run") == 0) {
    Findings found;
    const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
    std::printf("by position\n"), run<Interface::position>(seed, found, true);
    std::printf("by velocity\n"), run<Interface::velocity>(seed, found, true);
    std::printf("by impedance\n"), run<Interface::impedance>(seed, found, true);
    return 0;
  }
  const std::uint64_t cycles = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 500'000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const bool by_position = attack<Interface::position>("By position", cycles, seed);
  const bool by_velocity = attack<Interface::velocity>("By velocity", cycles, seed);
  const bool by_impedance = attack<Interface::impedance>("By impedance", cycles, seed);
  return by_position && by_velocity && by_impedance ? 0 : 1;
}
