// Random scenes that declare what may touch them, gripped, pressed and led by just that. The sister of
// `attack`.
//
//     attack_contacts [CYCLES = 500000] [SEED = 1]   that many cycles
//     attack_contacts run SEED                       one scene, each twentieth of a second of it
//
// The arm is a UR5 by position or velocity in any pose, with delay, lag and period as they come. It declares
// a body under a cover (`StiffestContact`) and is made as heavy as that asks for; limits, tank, observer and
// a law that holds its place are in or out. Then a hand as heavy as declared or a lighter one touches a cell
// or holds the forearm, two hands grip it from both sides, or a thing is moved into a cell and held still.
// Judged, when nothing has moved for seconds: how far the force still swings, and the speed of the joints.
// Beside it the same arm without what it declared. Returns 1 if a scene is not at rest.
#include <Eigen/Eigenvalues>
#include <memory>
#include <optional>
#include <random>

#include "bench/studies/attack/common.hpp"
#include "skinctl/testing/hand.hpp"
#include "tests/support/simulated_joints.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using namespace attacks;

namespace {

constexpr double rings = 3;        ///< swing of a force at rest that somebody feels [N]
constexpr double rests = 0.02;     ///< speed of a joint at rest [rad/s]
constexpr double moves_until = 2;  ///< time in which hands move [s]
constexpr double watched_from = 8, half_time = 14, ends = 20;  ///< times in which nothing may swing [s]
/// Part of a swing that may be left after `half_time`: a heavy arm on a person's muscles sways for a while.
constexpr double dies_out = 0.8;
constexpr double plant_step = 2.5e-4;  ///< [s]
/// Cosine of the angle by which an arm turns its cell out from under a hand, which pushes along one line.
constexpr double slips_off = 0.5;

struct Findings {
  Found ring{"swing of the force that does not die [N]", rings};
  Found speed{"speed of a joint between two turns of such a swing [rad/s]", rests};
  Found bare{"the same of the arm as it was, which declares nothing [N]", rings, false};
  std::uint64_t cycles = 0, scenes = 0, refused = 0;
  auto all() { return std::array{&ring, &speed, &bare}; }
};

/// The largest swing of a signal that happens twice: the least of two turns one after the other.
class Turns {
 public:
  void take(double x) {
    if (!started_) low_ = high_ = x, started_ = true;
    low_ = std::min(low_, x), high_ = std::max(high_, x);
    const double back = rising_ ? high_ - x : x - low_;
    if (back > 0.1) {
      const double swing = high_ - low_;
      worst_ = std::max(worst_, std::min(swing, last_));
      last_ = swing;
      rising_ = !rising_;
      (rising_ ? high_ : low_) = x;
    }
  }
  [[nodiscard]] double worst() const { return worst_; }

 private:
  double low_ = 0, high_ = 0, last_ = 0, worst_ = 0;
  bool started_ = false, rising_ = true;
};

/// Parts of a scene.
template <Interface By, bool Jerk, bool Tool, bool Tank, bool Observer, bool Stays>
struct Parts {
  static constexpr Interface by = By;
  static constexpr bool jerk = Jerk, tool = Tool, tank = Tank, observer = Observer, stays = Stays;
};
enum class Visitor { hand, light_hand, two_hands, thing };

struct Drawn {
  RobotConfiguration<6> arm{.limits = limits_of<ur5::Description>(15.0), .period = 2ms};
  StiffestContact declared;
  JointPosition<6> pose;
  MaxJerk<6> jerk{};
  MaxToolSpeed<5> tool{.speed = 0.5, .reach = 1.3};
  Visitor visitor = Visitor::hand;
  HandSettings hand;
  std::size_t cell = 0;
  double deep = 0.05;  ///< way of the visitor into the arm [m]
  double push = 0;     ///< of each of two hands [N]

  explicit Drawn(std::uint64_t seed) {
    std::mt19937_64 rng(seed);
    const auto roll = [&](double a, double b) { return std::uniform_real_distribution<>(a, b)(rng); };
    const auto log_roll = [&](double a, double b) { return a * std::pow(b / a, roll(0, 1)); };
    arm.period = nanoseconds(1e-3 * log_roll(1, 8));
    arm.delay = rng() % 4 == 0 ? 0ns : nanoseconds(roll(0, 0.02));
    arm.lag = nanoseconds(roll(0.004, 0.04));
    arm.virtual_damping = roll(2, 8);
    arm.virtual_inertia = JointTorque<6>::constant(log_roll(0.05, 1));
    arm.limits = limits_of<ur5::Description>(roll(5, 30));
    jerk.jerk = JointJerk<6>::constant(log_roll(200, 20000));
    tool.speed = roll(0.1, 1);
    visitor = static_cast<Visitor>(rng() % 4);
    const double mass = roll(2, 10), cover = log_roll(2e3, 2e4);
    declared = {
        .stiffness = cover, .body = visitor == Visitor::thing ? 0 : mass, .newtons = newtons_per_unit};
    for (std::size_t i = 0; i < 6; ++i) pose[i] = roll(-3, 3);
    hand.mass = visitor == Visitor::light_hand ? roll(0.3, 1) * mass : mass;
    hand.stiffness = log_roll(100, 2000);
    // A person's arm: damped by 0.5 to 1, at its own mass.
    hand.damping = 2 * roll(0.5, 1) * std::sqrt(hand.stiffness * hand.mass);
    hand.cover_stiffness = cover;
    // A loss factor of 0.1, of rubber and foam, at the frequency of the body on its cover.
    hand.cover_damping = 0.1 * std::sqrt(cover * hand.mass);
    if (visitor == Visitor::thing) hand = stiff_wall(cover);
    hand.holds = visitor != Visitor::thing && rng() % 2 == 0;
    cell = visitor == Visitor::two_hands || hand.holds ? 0 : rng() % cells;
    deep = roll(0.005, visitor == Visitor::thing ? 0.02 : 0.1);
    push = roll(2, 30);
  }
};

/// The cells, with a force that counts a share of what acts.
auto skin_of(double share) {
  CellGains gains = open_gains;
  gains.force *= share;
  return open_skin(skinctl::Patch<2, 3>(forearm(), gains), skinctl::Patch<5, 3>(hand(), gains));
}
template <class P, class... More>
auto robot_of(const RobotConfiguration<6>& c, const More&... more) {
  if constexpr (P::by == Interface::position) {
    return by_position(ur5::Model{}, c, more...);
  } else {
    return by_velocity(ur5::Model{}, c, more...);
  }
}
/// `heavier` times as heavy as the arm, with the friction that it has.
template <class P, class... More>
auto scene_of(const Drawn& d, double heavier, const More&... more) {
  auto c = d.arm;
  c.virtual_damping = *c.virtual_damping / heavier;
  const EnergyTank<> tank({.start = 4, .max = 5});
  const PassivityObserver<> observer({.start = 1, .max = 5, .stiffness = d.declared.stiffness});
  const auto robot = [&] {
    if constexpr (P::tank && P::observer) {
      return robot_of<P>(c, tank, observer, more...);
    } else if constexpr (P::tank) {
      return robot_of<P>(c, tank, more...);
    } else if constexpr (P::observer) {
      return robot_of<P>(c, observer, more...);
    } else {
      return robot_of<P>(c, more...);
    }
  }();
  const auto plain = [&] {
    if constexpr (P::stays) {
      auto gains = P::jerk ? tracking_settings(robot, d.jerk.jerk) : tracking_settings(robot);
      gains.lambda /= heavier, gains.K_c /= heavier, gains.K_i1 /= heavier, gains.K_i2 /= heavier * heavier;
      return Cycle(robot, skin_of(1 / heavier),
                   SplineJoint<6>(gains) + SkinJointControl{} + GravityControl{});
    } else {
      return Cycle(robot, skin_of(1 / heavier), SkinJointControl{} + GravityControl{});
    }
  }();
  return with_limits<P>(plain, d.jerk, d.tool);
}

struct End {
  double ring = 0, speed = 0;
  std::uint64_t cycles = 0;
};
template <class P, class Scene>
End visited(const Scene& scene, const Drawn& d, bool trace) {
  using Joints = SimulatedJoints<6>;
  const auto memory = std::make_unique<typename Scene::Memory>();
  State<6> x{0ns, d.pose, {}};
  scene.start(*memory, x);
  typename Joints::Row row{};
  for (std::size_t i = 0; i < 6; ++i) row[i] = d.pose[i];
  Joints joints(P::by == Interface::position ? Joints::Kind::position : Joints::Kind::velocity,
                seconds<double>(d.arm.delay), seconds<double>(d.arm.lag), row);
  struct Place {
    Xyz<double> p, n;
  };
  const auto place = [&](const JointPosition<6>& q) -> Place {
    const Poses<ur5::Model, closure<ur5::Model>(link_bit<5>)> poses(ur5::Model{}, q);
    const auto of = [&](const auto& X_BL, const auto& cell) {
      const auto X_BC = X_BL * cell.X_LC;
      return Place{X_BC.origin(), X_BC.axis_z()};
    };
    return d.cell < 3 ? of(poses.template get<2>(), forearm()[d.cell])
                      : of(poses.template get<5>(), attacks::hand()[d.cell - 3]);
  };
  const Place first = place(d.pose);
  // Along the line into the cell; the force of the first visitor, and of the one on the other side.
  const auto in = [&](const JointPosition<6>& q) { return -dot(first.n, place(q).p - first.p); };
  std::optional<Grip> grip;
  Hand alone(d.hand);
  if (d.visitor == Visitor::two_hands) grip.emplace(d.hand, d.push);
  Forces force{};
  End end;
  Turns early, late;
  Swings swings(rests);
  double t = 0, printed = 0;
  bool gone = false;
  const double dt = seconds<double>(d.arm.period);
  JointPosition<6> q = d.pose;
  for (Nanoseconds now = d.arm.period; seconds<double>(now) < ends; now += d.arm.period) {
    const JointPosition<6> before = q;
    while (t < seconds<double>(now) - 1e-9) {
      const double h = std::min(plant_step, seconds<double>(now) - t);
      t += h;
      joints.advance(t);
      for (std::size_t i = 0; i < 6; ++i) q[i] = joints.q()[i];
      const double goal = d.deep * std::min(t / moves_until, 1.0), here = in(q);
      if (grip) {
        grip->advance(h, goal, here);
        force[0] = grip->hand(0).force(), force[1] = grip->hand(1).force();
      } else {
        const double F = alone.advance(h, goal, here);
        force[d.cell] = std::max(F, 0.0);
        if (d.hand.holds) force[1] = std::max(-F, 0.0);  // around the forearm: the cell on the other side
      }
    }
    gone = gone || dot(place(q).n, first.n) < slips_off;
    if (gone) force = {};
    for (std::size_t i = 0; i < 6; ++i) x.dq[i] = (q[i] - before[i]) / dt;
    x.q = q, x.time = now;
    typename Scene::Input input;
    input.now = now, input.measured = x;
    const auto sent = samples(force, now);
    input.samples = sent;
    const auto out = scene.step(*memory, input);
    if constexpr (P::by == Interface::position) {
      for (std::size_t i = 0; i < 6; ++i) row[i] = out.planned.position[i];
    } else {
      for (std::size_t i = 0; i < 6; ++i) row[i] = out.planned.velocity[i];
    }
    joints.command(t, row);
    ++end.cycles;
    double fastest = 0;
    for (std::size_t i = 0; i < 6; ++i) fastest = std::max(fastest, std::abs(x.dq[i]));
    if (t > watched_from) (t < half_time ? early : late).take(force[d.cell] - (d.cell == 0 ? force[1] : 0));
    if (t > half_time) swings.take(x.dq);
    if (trace && t >= printed) {
      std::printf("%6.2f s  %6.1f N  in %6.1f mm  fastest %.2g rad/s ", t, force[d.cell], 1e3 * in(q),
                  fastest);
      print_reasons(out.status);
      std::printf("\n");
      printed += 0.05;
    }
  }
  if (late.worst() > dies_out * early.worst()) end.ring = late.worst(), end.speed = swings.worst();
  return end;
}

template <class P>
void run(std::uint64_t seed, Findings& found, bool trace) {
  const Drawn d(seed);
  const auto bare = robot_of<P>(d.arm);
  const double heavier = std::max(1.0, 1.05 * d.declared.heavier(bare, skin_of(1)));
  const auto scene = unless_refused(trace, [&] { return scene_of<P>(d, heavier, d.declared); });
  if (!scene) {
    ++found.refused;
    return;
  }
  if (trace)
    std::printf(
        "period %.1f, delay %.1f, lag %.1f ms; body %.1f kg under %.0f N/m; %.2f times heavier: %.1f kg\n",
        1e3 * seconds<double>(d.arm.period), 1e3 * seconds<double>(d.arm.delay),
        1e3 * seconds<double>(d.arm.lag), d.declared.body, d.declared.stiffness, heavier,
        heavier * d.declared.min_felt_mass(bare, skin_of(1)));
  const End end = visited<P>(*scene, d, trace), as_it_was = visited<P>(scene_of<P>(d, 1), d, false);
  found.ring.take(end.ring, seed), found.speed.take(end.speed, seed);
  found.bare.take(as_it_was.ring, seed);
  found.cycles += end.cycles;
  ++found.scenes;
  if (trace) std::printf("swings by %.2f N, as it was by %.2f\n", end.ring, as_it_was.ring);
}

void run(std::uint64_t seed, Findings& found, bool trace) {
  constexpr auto p = Interface::position, v = Interface::velocity;
  switch (seed % 8) {
    case 0:
      return run<Parts<p, false, false, false, false, false>>(seed, found, trace);
    case 1:
      return run<Parts<v, false, false, false, false, false>>(seed, found, trace);
    case 2:
      return run<Parts<p, true, false, false, false, true>>(seed, found, trace);
    case 3:
      return run<Parts<v, true, true, false, false, false>>(seed, found, trace);
    case 4:
      return run<Parts<p, false, true, true, false, true>>(seed, found, trace);
    case 5:
      return run<Parts<v, false, false, true, true, true>>(seed, found, trace);
    case 6:
      return run<Parts<p, true, true, true, true, true>>(seed, found, trace);
    default:
      return run<Parts<p, false, false, false, true, false>>(seed, found, trace);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return attack_main<Findings>(argc, argv, run);
}
