// A stop in the middle of a motion, or a gap in its states, and what the laws do when it ends.
//
// Promise: after a stop a motion goes on from where the robot stands: it neither leaps back to where its plan
// was, nor runs past its goal, however slowly the robot brakes
// Tried: UR5 by position and velocity, splines of joints and of the tool, a reactive target, in sums and
// skills; accelerations from 0.3 to 15 rad/s^2, a stop at each tenth of the way, resumed at rest, while it
// still brakes, twice, with the goal sent once more: back and past the goal by at most 1.1 mrad (up to 2 rad
// where the plan goes on where it was). A resume without a stop changes nothing
//
// Promise: so does a motion whose robot braked by itself, for states that are too old or lost packets
// Tried: UR5 by position and velocity, gaps of 0.1 to 2 s at each fifth of the way, once and twice: back and
// past the goal by 2.6 mrad (up to 2.9 rad where the plan goes on where it was; by velocity such a gap was
// taken for a displacement, too); 2 or 6 cycles without a new state every 0.2 or 0.5 s: arrives; by torque,
// where it coasts, gaps up to 0.4 s: back by at most 5 mrad (0.3 rad)
//
// Promise: a spline asks for no more acceleration than the robot has: it takes longer, and says so
// Tried: UR5, goals that would take up to 87 times the limits' acceleration, joints and tool, 0.1 to 15
// rad/s^2: past the goal by at most 4 mrad (by 0.5 to 2 rad with accelerations beyond the limits)
//
// Promise: a joint by velocity that is beyond its end comes back
// Tried: by 1e-6 to 1e-3 rad, with and without a limit of jerk (with it, it stayed where it was for ever)

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/reactive_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/spline_operational.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/by_day.hpp"

using namespace skinctl;

namespace {
const JointPosition<6> home{0, -1.2, 1.4, -1.7, -1.57, 0};
const Transform<Link<5>, Tool> tool = Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.1);

RobotConfiguration<6> configuration(double acceleration) {
  return {.limits = limits_of<ur5::Description>(acceleration),
          .period = 8ms,
          .delay = 8ms,
          .lag = 2ms,
          .virtual_damping = 4};
}
JointPosition<6> turned(double by) {
  auto q = home;
  q[0] += by;
  return q;
}
PoseGoal<Tool> pose_at(const JointPosition<6>& q, Nanoseconds duration) {
  return {link_poses(ur5::Model{}, q).get<5>() * tool, duration};
}

struct Course {
  double back = 0;      ///< largest way back of the first joint [rad]
  double furthest = 0;  ///< largest angle [rad]
  double end = 0;       ///< angle in the end [rad]
  Status said;
};
/// Cycles in which something is asked for: `ask(k, input)`. The robot does what it is told.
template <class Scene, class Ask>
Course run(const Scene& scene, int cycles, const Ask& ask) {
  const auto memory = std::make_unique<typename Scene::Memory>();
  typename Scene::Input input;
  State<6> x;
  x.time = 0ns;
  x.q = home;
  scene.start(*memory, x);
  Course out;
  for (int k = 1; k <= cycles; ++k) {
    input.now = x.time = k * 8ms;
    input.measured = x;
    ask(k, input);
    const auto sent = scene.step(*memory, input);
    clear_requests(input);
    out.said |= sent.status;
    if constexpr (requires { sent.command.position; })
      for (std::size_t i = 0; i < 6; ++i)
        x.dq[i] = (sent.command.position[i] - x.q[i]) / 0.008, x.q[i] = sent.command.position[i];
    else
      for (std::size_t i = 0; i < 6; ++i)
        x.dq[i] = sent.command.velocity[i], x.q[i] += 0.008 * sent.command.velocity[i];
    out.furthest = std::max(out.furthest, x.q[0]);
    out.back = std::max(out.back, out.furthest - x.q[0]);
  }
  out.end = x.q[0];
  return out;
}

constexpr double far = 1.5;
constexpr int begins = 10;
/// The motion, a stop at `share` of `time`, and `resume` after `rest` cycles.
auto stopped(const auto& goal, double time, double share, int rest, bool twice = false, bool again = false) {
  const int stop = begins + static_cast<int>(share * time / 0.008);
  return [=](int k, auto& input) {
    if (k == begins) input.goal = goal;
    if (k == stop || (twice && k == stop + rest + 5)) input.request = CycleRequest::stop;
    if (k == stop + rest || (twice && (k == stop + rest + 2 || k == stop + 2 * rest + 5)))
      input.request = CycleRequest::resume;
    if (again && k == stop + rest) input.goal = goal;
  };
}
int cycles_for(double acceleration, double time) {
  return static_cast<int>((3 * time + 6 * std::sqrt(6 * far / acceleration) + 4) / 0.008);
}
/// Of the courses of a table the gate runs one in seven: no column has seven values, so it meets each of them.
constexpr int each = testing::by_day ? 7 : 1;
}  // namespace

TEST_CASE("resume: a motion goes on from where the robot stands, not back to where its plan was") {
  double worst_back = 0, worst_past = 0;
  int course = 0;
  const auto all = [&](const auto& scene, const auto& goal, double acceleration) {
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9})
      for (const int rest : {3, 60, 250})
        for (const bool twice : {false, true})
          for (const bool again : {false, true}) {
            CAPTURE(acceleration);
            CAPTURE(share);
            CAPTURE(rest);
            CAPTURE(twice);
            CAPTURE(again);
            if (course++ % each != 0) continue;
            const Course c = run(scene, cycles_for(acceleration, 2) + 2 * rest,
                                 stopped(goal, 2, share, rest, twice, again));
            CHECK(c.back < 0.003);
            CHECK(c.furthest < far + 0.003);
            CHECK(std::abs(c.end - far) < 0.005);
            worst_back = std::max(worst_back, c.back), worst_past = std::max(worst_past, c.furthest - far);
          }
  };
  for (const double a : {0.3, 1.0, 2.0, 15.0}) {
    const auto arm = by_position(ur5::Model{}, configuration(a));
    const auto fast = by_velocity(ur5::Model{}, configuration(a));
    const JointGoal<6> goal{turned(far), 2s};
    all(Cycle(arm, SplineJoint(arm) + GravityControl{}), goal, a);
    all(Cycle(fast, SplineJoint(fast) + GravityControl{}), goal, a);
  }
  MESSAGE("back by ", worst_back, ", past the goal by ", worst_past);
}

TEST_CASE("resume: of the tool's splines, reactive targets and skills") {
  for (const double a : {0.5, 2.0, 15.0}) {
    CAPTURE(a);
    const auto arm = by_position(ur5::Model{}, configuration(a));
    const Cycle pose(arm, SplineOperational(tool, operational_settings(arm)) + GravityControl{});
    const Cycle follows(arm, ReactiveJoint(arm) + GravityControl{});
    for (const double share : {0.2, 0.5, 0.8})
      for (const int rest : {3, 120}) {
        CAPTURE(share);
        CAPTURE(rest);
        const Course c = run(pose, cycles_for(a, 3), stopped(pose_at(turned(far), 3s), 3, share, rest));
        CHECK(c.back < 0.006);
        CHECK(c.furthest < far + 0.006);
        CHECK(std::abs(c.end - far) < 0.005);
        const JointReference<6> target{turned(far), {}, {}};
        const Course r = run(follows, cycles_for(a, 3), stopped(target, 2, share, rest));
        CHECK(r.back < 0.006);
        CHECK(r.furthest < far + 0.006);
        CHECK(std::abs(r.end - far) < 0.005);
      }
  }
}

TEST_CASE("gap: a motion goes on from where the robot stands once it is followed again") {
  double worst_back = 0, worst_past = 0;
  int course = 0;
  const auto all = [&](const std::string& name, const auto& scene, double acceleration, const auto& fault) {
    CAPTURE(name);
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9})
      for (const int lasts : {12, 30, 90, 250})
        for (const bool twice : {false, true}) {
          CAPTURE(acceleration);
          CAPTURE(share);
          CAPTURE(lasts);
          CAPTURE(twice);
          if (course++ % each != 0) continue;
          const int from = begins + static_cast<int>(share * 2 / 0.008), again = from + lasts + 7;
          State<6> old;
          const Course c = run(scene, cycles_for(acceleration, 2) + 2 * lasts, [&](int k, auto& input) {
            if (k == begins) input.goal = JointGoal<6>{turned(far), 2s};
            const bool gap = (k >= from && k < from + lasts) || (twice && k >= again && k < again + lasts);
            if (!gap) old = input.measured;
            fault(input, gap, old);
          });
          CHECK(c.back < 0.003);
          CHECK(c.furthest < far + 0.003);
          CHECK(std::abs(c.end - far) < 0.005);
          worst_back = std::max(worst_back, c.back), worst_past = std::max(worst_past, c.furthest - far);
        }
  };
  const auto stale = [](auto& input, bool gap, const State<6>& old) {
    if (gap) input.measured = old;
  };
  const auto lost = [](auto& input, bool gap, const State<6>&) {
    input.observed = gap ? Status(Reason::packets_lost) : Status();
  };
  for (const double a : {0.3, 1.0, 2.0, 15.0}) {
    const auto arm = by_position(ur5::Model{}, configuration(a));
    const auto fast = by_velocity(ur5::Model{}, configuration(a));
    const Cycle stiff(arm, SplineJoint(arm) + GravityControl{});
    const Cycle velocity(fast, SplineJoint(fast) + GravityControl{});
    all("states, by position", stiff, a, stale);
    all("states, by velocity", velocity, a, stale);
    all("packets, by position", stiff, a, lost);
    all("packets, by velocity", velocity, a, lost);
  }
  MESSAGE("back by ", worst_back, ", past the goal by ", worst_past);
}

TEST_CASE("gap: states that are too old now and then do not keep a motion from arriving") {
  const auto all = [&](const auto& scene, double acceleration) {
    for (const int lasts : {12, 16})  // of which 2 and 6 cycles brake
      for (const int every : {25, 60}) {
        CAPTURE(acceleration);
        CAPTURE(lasts);
        CAPTURE(every);
        State<6> old;
        const Course c = run(scene, cycles_for(acceleration, 2) + 250, [&](int k, auto& input) {
          if (k == begins) input.goal = JointGoal<6>{turned(far), 2s};
          if (k < begins + 20 || k % every >= lasts) old = input.measured;
          input.measured = old;
        });
        CHECK(c.back < 0.003);
        CHECK(c.furthest < far + 0.003);
        CHECK(std::abs(c.end - far) < 0.005);
      }
  };
  for (const double a : {1.0, 2.0, 15.0}) {
    const auto arm = by_position(ur5::Model{}, configuration(a));
    const auto fast = by_velocity(ur5::Model{}, configuration(a));
    all(Cycle(arm, SplineJoint(arm) + GravityControl{}), a);
    all(Cycle(fast, SplineJoint(fast) + GravityControl{}), a);
  }
}

TEST_CASE("gap: an arm by torque that coasts without states goes on from where it is") {
  RobotConfiguration<6> c = configuration(5);
  c.period = c.delay = 2ms, c.lag = 0ms, c.virtual_damping = 0;
  const ur5::Model model;
  const auto arm = by_torque(model, c, RobotCompensatesFriction{});
  const Cycle scene(arm, SplineJoint(arm) + GravityControl{});
  using Scene = decltype(scene);
  for (const double share : {0.1, 0.3, 0.5, 0.7})
    for (const int lasts : {40, 100, 200}) {
      CAPTURE(share);
      CAPTURE(lasts);
      const auto memory = std::make_unique<Scene::Memory>();
      Scene::Input input;
      State<6> x, old;
      x.q = home;
      scene.start(*memory, x);
      auto held = gravity_torque(model, home);
      double furthest = 0, back = 0;
      const int from = begins + static_cast<int>(share * 1000);
      for (int k = 1; k < 3000; ++k) {
        input.now = x.time = k * 2ms;
        if (k < from || k >= from + lasts) old = x;
        input.measured = old;
        if (k == begins) input.goal = JointGoal<6>{turned(far), 2s};
        const JointTorque<6> sent = scene.step(*memory, input).command.torque;
        clear_requests(input);
        for (int part = 0; part < 4; ++part) {
          const auto a = forward_dynamics(model, x.q, x.dq, held).acceleration;
          for (std::size_t i = 0; i < 6; ++i) x.dq[i] += 0.0005 * a[i], x.q[i] += 0.0005 * x.dq[i];
        }
        held = sent;  // it acts a period later
        furthest = std::max(furthest, x.q[0]), back = std::max(back, furthest - x.q[0]);
      }
      CHECK(back < 0.005);
      CHECK(std::abs(x.q[0] - far) < 0.005);
    }
}

TEST_CASE("resume: without a stop nothing changes") {
  const auto arm = by_position(ur5::Model{}, configuration(5));
  const Cycle scene(arm, SplineJoint(arm) + GravityControl{});
  const JointGoal<6> goal{turned(far), 2s};
  const Course as_before = run(scene, 200, [&](int k, auto& input) {
    if (k == begins) input.goal = goal;
  });
  const Course asked = run(scene, 200, [&](int k, auto& input) {
    if (k == begins) input.goal = goal;
    if (k > begins && k % 7 == 0) input.request = CycleRequest::resume;
  });
  CHECK(asked.end == as_before.end);
  CHECK(asked.furthest == as_before.furthest);
}

TEST_CASE("acceleration: a spline takes the time that the robot needs, and says so") {
  for (const double a : {0.1, 0.3, 0.5, 1.0, 2.0, 5.0, 15.0}) {
    CAPTURE(a);
    const auto arm = by_position(ur5::Model{}, configuration(a));
    const int cycles = cycles_for(a, 1);
    const auto goes = [&](const auto& scene, const auto& goal) {
      return run(scene, cycles, [&](int k, auto& input) {
        if (k == begins) input.goal = goal;
      });
    };
    for (const Nanoseconds duration : {Nanoseconds(0), Nanoseconds(1s)}) {
      const Course c =
          goes(Cycle(arm, SplineJoint(arm) + GravityControl{}), JointGoal<6>{turned(far), duration});
      CHECK(c.back < 0.001);
      CHECK(c.furthest < far + 0.001);
      CHECK(std::abs(c.end - far) < 0.003);
      CHECK(c.said.has(Reason::goal_stretched) == (duration > 0ns));
      const Course p = goes(Cycle(arm, SplineOperational(tool, operational_settings(arm)) + GravityControl{}),
                            pose_at(turned(0.8), duration));
      CHECK(p.back < 0.004);
      CHECK(p.furthest < 0.8 + 0.004);
      CHECK(std::abs(p.end - 0.8) < 0.003);
    }
  }
  // The time: 0.8 of the limit at the quintic's peak.
  const auto s = tracking_settings(by_position(ur5::Model{}, configuration(0.5)));
  CHECK(s.joint_acceleration[0] == doctest::Approx(0.4));
  using Space = JointSpace<6>;
  const double least = Space::shortest_time(home, JointGoal<6>{turned(far), 0ns}, s);
  CHECK(least == doctest::Approx(std::sqrt(10 / std::sqrt(3.0) * far / 0.4)));
  auto unbounded = s;
  unbounded.joint_acceleration = JointAcceleration<6>::constant(std::numeric_limits<double>::infinity());
  CHECK(Space::shortest_time(home, JointGoal<6>{turned(far), 0ns}, unbounded) ==
        doctest::Approx(1.875 * far / s.max_velocity[0]));
  unbounded.joint_acceleration[2] = 0;
  CHECK_THROWS_AS(SplineJoint<6>{unbounded}, ConfigurationError);
}

TEST_CASE("end: a joint by velocity that is beyond its end comes back, with a limit of jerk too") {
  for (const double beyond : {1e-6, 5e-5, 1e-3}) {
    CAPTURE(beyond);
    auto c = configuration(15);
    auto values = c.limits.values();
    values.upper[0] = home[0] - beyond;
    c.limits = JointLimits<6>(values);
    const auto arm = by_velocity(ur5::Model{}, c);
    const Cycle plain(arm, SplineJoint(arm) + GravityControl{});
    const auto back = [](int k, auto& input) {
      if (k == begins) input.goal = JointGoal<6>{turned(-0.5), 2s};
    };
    CHECK(std::abs(run(plain, 500, back).end + 0.5) < 0.005);
    const MaxJerk<6> jerk{JointJerk<6>::constant(300)};
    const auto smooth =
        Cycle(arm, SplineJoint<6>(tracking_settings(arm, jerk.jerk)) + GravityControl{}).with(jerk);
    CHECK(std::abs(run(smooth, 500, back).end + 0.5) < 0.005);
  }
}

TEST_CASE("resume: of settings that know no accelerations") {
  for (const double a : {1.0, 2.0, 15.0}) {
    CAPTURE(a);
    const auto arm = by_position(ur5::Model{}, configuration(a));
    auto settings = tracking_settings(arm);
    settings.joint_acceleration = JointAcceleration<6>::constant(std::numeric_limits<double>::infinity());
    const Cycle scene(arm, SplineJoint<6>(settings) + GravityControl{});
    const Course c = run(scene, cycles_for(a, 4), stopped(JointGoal<6>{turned(far), 4s}, 4, 0.5, 60));
    CHECK(c.back < 0.01);
    CHECK(c.furthest < far + 0.01);
    CHECK(std::abs(c.end - far) < 0.005);
  }
}
