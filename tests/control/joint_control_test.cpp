#include "skinctl/control/joint_control.hpp"

#include <doctest/doctest.h>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
template <class T>
using KnownAt = Quantities<Arm, Needs{}, T>;
const Arm model;
const NoTouch none;

/// Error at tb over the error at the start, less the closed form, relative to it, in the norm of all joints.
template <class T>
double error_at_tb(const JointControl<6, T>& law, Seeded& rng, double size) {
  const T dt = seconds<T>(law.settings().dt), tb = seconds<T>(law.settings().tb);
  State<6, T> x{0ns, rng.vector<JointPosition<6, T>>(3.1), {}};
  JointReference<6, T> goal{x.q, {}, {}};
  for (T& q : goal.q_d) q += T(size * rng());
  const auto x0 = x.q - goal.q_d;
  auto memory = law.start(KnownAt<T>(model, x, dt, none));
  const auto received = law.receive(memory, KnownAt<T>(model, x, dt, none), goal);
  CHECK_FALSE(received.status.any());
  memory = received.memory;
  const int cycles = static_cast<int>(static_cast<double>(tb / dt) + 0.5);
  for (int i = 0; i < cycles; ++i) {
    const auto e = law.evaluate(memory, KnownAt<T>(model, x, dt, none), dt);
    memory = e.memory;
    x = simulate(model, x, e.torque, dt, 2);
  }
  const TimeBase<double> base;
  const double t_p = base.peak_time();
  const double closed = std::pow((quintic(t_p).rest + base.delta()) / (1 + base.delta()), 1 + base.eps()) *
                        std::exp(-base.peak_gain() * (1 - t_p));
  double off = 0, all = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double start = static_cast<double>(x0[i]);
    const double end = static_cast<double>(x.q[i] - goal.q_d[i]);
    off += (end - closed * start) * (end - closed * start);
    all += closed * start * closed * start;
  }
  return std::sqrt(off / all);
}
}  // namespace

TEST_CASE("JointControl: the UR5 in sampled time ends at the closed form of the time base") {
  // Exact parameters, weight 1, from rest, x0 <= dq_max tb / 1.886, tb rate >= 125.
  struct Place {
    double rate, tb;
    int trials;
  };
  double worst_of_all = 0;
  for (const Place& p : {Place{125, 1, 20},
                         {125, 2, 10},
                         {125, 5, 5},
                         {125, 10, 3},
                         {500, 0.25, 20},
                         {500, 1, 10},
                         {500, 2, 5},
                         {500, 10, 1},
                         {1000, 0.125, 20},
                         {1000, 1, 5},
                         {1000, 10, 1}}) {
    for (const double K_i1 : {0.0, 1.0}) {
      const double dt = 1 / p.rate;
      const double K_c = std::min(10.0, 8 / p.tb);
      JointControlSettings<6> settings{
          .dt = nanoseconds(dt), .K_i1 = K_i1, .K_i2 = 0.1 * K_i1, .tb = nanoseconds(p.tb), .K_c = K_c};
      settings.max_velocity = JointVelocity<6>::constant(ur5::Description::max_velocity);
      settings.reach = GoalPolicy::refuse;
      const JointControl<6> law(settings);
      Seeded rng(80);
      const double size = std::min(6.0, 0.999 * ur5::Description::max_velocity * p.tb / 1.886);
      double worst = 0;
      for (int i = 0; i < p.trials; ++i) worst = std::max(worst, error_at_tb(law, rng, size));
      MESSAGE(p.rate << " Hz, tb " << p.tb << " s, K_i1 " << K_i1 << ": " << 100 * worst << " %");
      CHECK(worst < 0.01);
      worst_of_all = std::max(worst_of_all, worst);
    }
  }
  CHECK(worst_of_all > 1e-5);  // sampled time is seen
}

TEST_CASE("JointControl: so it does in float, as far as its positions resolve the end") {
  JointControlSettings<6, float> settings{.dt = 2ms, .tb = 1s};
  settings.max_velocity = JointVelocity<6, float>::constant(3.14f);
  const JointControl<6, float> law(settings);
  Seeded rng(81);
  for (int i = 0; i < 5; ++i) CHECK(error_at_tb(law, rng, 1.6) < 0.02);
}

TEST_CASE("JointControl: a goal too far for its time is stretched or refused") {
  JointControlSettings<6> settings{.dt = 2ms, .tb = 1s};
  settings.max_velocity = JointVelocity<6>::constant(0.5);
  const State<6> x{};
  const KnownAt<double> known(model, x, 0.002, none);
  const JointReference<6> far{JointPosition<6>::constant(-0.8), {}, {}},
      near{JointPosition<6>::constant(0.26), {}, {}};
  {
    const JointControl<6> law(settings);
    const auto answer = law.receive(law.start(known), known, far);
    CHECK(answer.status == Status(Reason::goal_stretched));
    CHECK(answer.memory.tb == doctest::Approx(1.886 * 0.8 / 0.5).epsilon(1e-3));
    CHECK_FALSE(law.receive(law.start(known), known, near).status.any());
    // and indeed keeps below the limit
    State<6> moving = x;
    auto memory = answer.memory;
    double fastest = 0;
    for (int i = 0; i < 2500; ++i) {
      const auto e = law.evaluate(memory, KnownAt<double>(model, moving, 0.002, none), 0.002);
      memory = e.memory;
      moving = simulate(model, moving, e.torque, 0.002, 1);
      for (const double v : moving.dq) fastest = std::max(fastest, magnitude(v));
    }
    CHECK(fastest == doctest::Approx(0.5).epsilon(5e-3));
  }
  settings.reach = GoalPolicy::refuse;
  const JointControl<6> strict(settings);
  const auto before = strict.start(known);
  const auto answer = strict.receive(before, known, far);
  CHECK(answer.status == Status(Reason::goal_refused));
  CHECK(answer.memory.plan.at(0, settings).q_d == before.plan.at(0, settings).q_d);
  CHECK(answer.memory.tb == before.tb);
}

TEST_CASE("JointControl: follows a target that is sampled in every cycle") {
  for (const double rate : {125.0, 500.0}) {
    const double dt = 1 / rate;
    const JointControl<6> law({.dt = nanoseconds(dt), .tb = 1s});
    const auto target = [](double t) {
      JointReference<6> r;
      for (std::size_t i = 0; i < 6; ++i) {
        const double w = 1 + 0.2 * static_cast<double>(i);
        r.q_d[i] = 0.3 * std::sin(w * t);
        r.dq_d[i] = 0.3 * w * std::cos(w * t);
        r.ddq_d[i] = -0.3 * w * w * std::sin(w * t);
      }
      return r;
    };
    State<6> x{0ns, target(0).q_d, target(0).dq_d};
    auto memory = law.start(KnownAt<double>(model, x, dt, none));
    double off = 0;
    for (int i = 0; i < static_cast<int>(6 * rate); ++i) {
      const KnownAt<double> known(model, x, dt, none);
      const auto answer = law.follow(memory, known, target(i * dt));
      CHECK_FALSE(answer.status.any());
      const auto e = law.evaluate(answer.memory, known, dt);
      memory = e.memory;
      x = simulate(model, x, e.torque, dt, 2);
      if (i * dt > 3)
        for (std::size_t j = 0; j < 6; ++j)
          off = std::max(off, magnitude(x.q[j] - target((i + 1) * dt).q_d[j]));
    }
    MESSAGE("off by " << off << " rad at " << rate << " Hz");
    CHECK(off < 200 * dt * dt);
    CHECK(off < 2e-3);
    // a sample far off is a new goal: no jump
    const KnownAt<double> known(model, x, dt, none);
    const auto leap = law.follow(memory, known, {JointPosition<6>::constant(1), {}, {}});
    CHECK(leap.memory.since_reset == 0ns);
    double jump = 0;
    const auto step = law.torque(leap.memory, known) - law.torque(memory, known);
    for (const double tau : step) jump = std::max(jump, magnitude(tau));
    CHECK(jump < 0.5);
  }
}

TEST_CASE("JointControl: with a constant gain a large step is slow enough from the start") {
  JointControlSettings<6> settings{.dt = 2ms, .tb = 0s, .K_c = 12};
  settings.max_velocity = JointVelocity<6>::constant(0.6);
  const JointControl<6> law(settings);
  State<6> x{0ns, JointPosition<6>{0.3, -1.2, 1.0, 0.1, 0.4, 0.0}, {}};
  const JointPosition<6> goal{1.0, -0.6, 0.3, -0.5, 1.1, 0.7};
  auto memory = law.start(KnownAt<double>(model, x, 0.002, none));
  memory = law.receive(memory, KnownAt<double>(model, x, 0.002, none), {goal, {}, {}}).memory;
  double fastest = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto e = law.evaluate(memory, KnownAt<double>(model, x, 0.002, none), 0.002);
    memory = e.memory;
    x = simulate(model, x, e.torque, 0.002, 1);
    for (const double v : x.dq) fastest = std::max(fastest, magnitude(v));
  }
  MESSAGE("fastest " << fastest << " of 0.6 rad/s");
  CHECK(fastest < 0.6 * 1.34);
  for (std::size_t i = 0; i < 6; ++i) CHECK(x.q[i] == doctest::Approx(goal[i]).epsilon(1e-3));
}

TEST_CASE("JointControl: a wrong payload is worked against, without chattering") {
  const double dt = 0.002;
  JointControlSettings<6> s{.dt = nanoseconds(dt), .K_i1 = 5, .K_i2 = 0.5, .tb = 0s};
  const JointControl<6> law(s);
  State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, -1.4, 0.3}, {}};
  auto memory = law.start(KnownAt<double>(model, x, dt, none));
  const auto home = x.q;
  double rough = 0;
  JointTorque<6> last, before;
  for (int i = 0; i < 3000; ++i) {
    const auto out = evaluate(law, memory, KnownAt<double>(model, x, dt, none), dt);
    memory = out.memory;
    if (i > 2500)
      for (std::size_t j = 0; j < 6; ++j)
        rough = std::max(rough, std::abs(out.torque[j] - 2 * last[j] + before[j]));
    before = last, last = out.torque;
    x = simulate(model, x, out.torque + mass_matrix(model, x.q) * JointAcceleration<6>{2, -3, 1, 4, 2, -2},
                 dt, 1);
  }
  double e = 0;
  for (std::size_t j = 0; j < 6; ++j) e = std::max(e, std::abs(x.q[j] - home[j]));
  CHECK(e < 0.004);
  CHECK(rough < 1e-3);
}
