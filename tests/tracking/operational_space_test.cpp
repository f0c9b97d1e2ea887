// Promise: no surprise at a singularity: no joint above its limit, no sticking
// Tried: 1000 straight lines through a UR5's singularities: the fastest joint at 2.97 rad/s of 3.0; none
// sticks; 998 keep a tenth of their speed within 1 s, the other two wait longer, for half a turn of the
// wrist. Also: `tracking/singular_escape_test.cpp`, study `singularities`

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <type_traits>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/digits.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
template <class L, class T = double>
using KnownFor = Quantities<Arm, L::needs, T>;

template <class T>
Transform<Link<5>, Tool, T> tool() {
  return Transform<Link<5>, Tool>(exp_so3(Xyz<double>{0.2, -0.1, 0.3}), {0.01, 0.02, 0.15})
      .template cast<T>();
}
template <class L>
L make(const typename L::Settings& settings) {
  using Space = std::remove_cvref_t<decltype(std::declval<L>().space())>;
  return L(Space(tool<typename L::T>(), settings), settings);
}
OperationalSettings<6> settings_at(double dt) {
  OperationalSettings<6> s{.tracking = {.dt = nanoseconds(dt), .tb = 0s}};
  s.tracking.max_velocity = JointVelocity<6>::constant(3);
  return s;
}
/// Away from all singularities.
const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};

template <std::size_t N, class T>
double size_of(const T (&x)[N], std::size_t first, std::size_t count) {
  double sum = 0;
  for (std::size_t i = first; i < first + count; ++i) sum += static_cast<double>(x[i] * x[i]);
  return std::sqrt(sum);
}

static_assert(Law<SplineOperational<6, 5>, KnownFor<SplineOperational<6, 5>>>);
static_assert(Law<OperationalControl<6, 5, Tool, float>, KnownFor<SplineOperational<6, 5>, float>>);
static_assert(std::is_trivially_copyable_v<SplineOperational<6, 5>::Memory>);
static_assert(SplineOperational<6, 5>::role == LawRole::tracking);

/// Runs a law on a robot with exactly the model's parameters; returns where the tool's error ends and its
/// largest value on the way.
struct Run {
  double position = 0, angle = 0, worst = 0;
  State<6> state;
};
template <class L>
Run run(const L& law, State<6> x, const typename L::Goal& goal, double dt, double duration) {
  using K = KnownFor<L>;
  auto memory = law.start(K(model, x, dt, none));
  const auto received = law.receive(memory, K(model, x, dt, none), goal);
  CHECK_FALSE(received.status.has(Reason::goal_refused));
  memory = received.memory;
  Run r;
  const auto look = [&] {
    const K known(model, x, dt, none);
    const auto target = memory.plan.at(0, law.settings());
    const auto d = goal.X_BP.origin() - law.space().site(known).X_BP.origin();
    r.position = std::sqrt(dot(d, d));
    const auto phi = log_so3(goal.X_BP.axes() * law.space().site(known).X_BP.axes().transpose());
    r.angle = std::sqrt(dot(phi, phi));
    const auto e = law.space().errors(target, law.space().site(known), memory.space);
    r.worst = std::max(r.worst, size_of(e.e, 0, L::coordinates));
  };
  for (int i = 0; i < static_cast<int>(duration / dt); ++i) {
    look();
    const auto out = evaluate(law, memory, K(model, x, dt, none), dt);
    memory = out.memory;
    x = simulate(model, x, out.torque, dt, 1);
  }
  look();
  r.state = x;
  return r;
}
/// Home, and a goal somewhat away from it.
template <class L>
PoseGoal<Tool> goal_near(const L& law, const State<6>& x, double turn) {
  const KnownFor<L> known(model, x, 0.002, none);
  const auto X = law.space().site(known).X_BP;
  return {Transform<Base, Tool>(exp_so3(Xyz<double>{0.3 * turn, -0.5 * turn, 0.4 * turn}) * X.axes(),
                                X.origin() + Xyz<double>{-0.1, 0.15, 0.1}),
          2s};
}

/// A smooth motion that has nothing to do with the law, near `q`.
State<6> swinging(const JointPosition<6>& q, double t) {
  State<6> x;
  for (std::size_t i = 0; i < 6; ++i) {
    const double w = 1 + 0.5 * static_cast<double>(i);
    x.q[i] = q[i] + 0.2 * std::sin(w * t);
    x.dq[i] = 0.2 * w * std::cos(w * t);
  }
  return x;
}

/// ddq_r against the central difference of dq_r while the state swings, in an operational law.
/// Returns the slowest pace of its plan.
template <class L>
double check_rate(const L& law, const JointPosition<6>& q, double tolerance) {
  using K = KnownFor<L>;
  const double dt = 0.004, h = 2e-6;
  const auto x0 = swinging(q, 0);
  auto memory = law.start(K(model, x0, dt, none));
  memory = law.receive(memory, K(model, x0, dt, none), goal_near(law, x0, 1.0)).memory;
  double worst = 0, largest = 0, slowest = 1;
  int compared = 0;
  for (int k = 0; k < 260; ++k) {
    const double t = k * dt;
    const auto x = swinging(q, t);
    const K known(model, x, dt, none);
    const auto now = law.now(memory, known);
    // Half a step of h each to either side: what the law would be then, its memory carried along.
    const auto at = [&](double d) {
      const auto moved = swinging(q, t + d);
      auto m = memory;
      m.plan.clock.own += nanoseconds(m.plan.clock.at(d, 1s).t) - nanoseconds(m.plan.clock.at(0.0, 1s).t);
      m.plan.clock.pace += d * m.plan.clock.pace_rate;
      m.since_reset += nanoseconds(d);
      m.bias.elapsed += nanoseconds(d);
      for (double& s : m.bias.decaying) s *= std::exp(-law.settings().tracking.kappa * d);
      for (std::size_t i = 0; i < L::coordinates; ++i) {
        m.I1.sum[i] += d * now.dI1[i];
        m.I2.sum[i] += d * now.dI2[i];
      }
      for (double& v : m.space.drift) v *= std::exp(-law.settings().tracking.kappa * d);
      for (std::size_t i = 0; i < 6; ++i) m.space.escape.v[i] += d * memory.space.escape.a[i];
      return law.now(m, K(model, moved, dt, none));
    };
    const auto ahead = at(h), behind = at(-h);
    // At rest at a goal next to a singularity the turning of the singular directions is left out.
    const bool resting = memory.space.rest.r > 0 || now.rests;
    compared += !resting;
    for (std::size_t i = 0; !resting && i < 6; ++i) {
      const double slope = (ahead.dq_r[i] - behind.dq_r[i]) / (2 * h);
      worst = std::max(worst, std::abs(slope - now.ddq_r[i]));
      largest = std::max(largest, std::abs(now.ddq_r[i]));
    }
    memory = law.advance(memory, known, dt, Opposition::none);
    slowest = std::min(slowest, memory.plan.clock.pace);
  }
  CAPTURE(largest);
  CHECK(compared > 100);
  CHECK(worst <= tolerance * (1 + largest));
  return slowest;
}
}  // namespace

TEST_CASE("OperationalSpace: the tool follows its spline, and arrives, at every rate") {
  for (const double rate : {125.0, 500.0}) {
    const auto law = make<SplineOperational<6, 5>>(settings_at(1 / rate));
    const auto r = run(law, {0ns, home, {}}, goal_near(law, {0ns, home, {}}, 1.0), 1 / rate, 2.5);
    CAPTURE(rate);
    CHECK(r.worst < 5e-5);
    CHECK(r.position < 1e-6);
    CHECK(r.angle < 1e-6);
  }
}

#if SKINCTL_MANY_DIGITS  // under the sanitizers every further law takes the compiler long
TEST_CASE("OperationalSpace: ZYZ errors lead to the same pose") {
  const auto settings = settings_at(0.004);
  const auto by_angles = make<SplineOperational<6, 5, Tool, double, TaskSpace::pose, ZyzError>>(settings);
  const State<6> x{0ns, home, {}};
  const auto goal = goal_near(by_angles, x, 1.0);
  const auto r = run(by_angles, x, goal, 0.004, 2.5);
  CHECK(r.position < 1e-5);
  CHECK(r.angle < 1e-5);
}

TEST_CASE("OperationalSpace: of a position, the null space rests or goes on") {
  const auto settings = settings_at(0.004);
  using Damped = SplineOperational<6, 5, Tool, double, TaskSpace::position>;
  using Free = SplineOperational<6, 5, Tool, double, TaskSpace::position, RotationVectorError, FreeNullSpace>;
  const State<6> x{0ns, home, JointVelocity<6>{0, 0, 0, 0.3, 0.2, -0.5}};
  const auto damped = make<Damped>(settings);
  const auto goal = goal_near(damped, {0ns, home, {}}, 1.0);
  const auto rest = run(damped, x, goal, 0.004, 3), on = run(make<Free>(settings), x, goal, 0.004, 3);
  CHECK(rest.position < 1e-5);
  CHECK(on.position < 1e-4);
  CHECK(as_eigen(rest.state.dq).norm() < 1e-3);
  CHECK(as_eigen(on.state.dq).norm() > 0.2);
}

#endif

TEST_CASE("OperationalSpace: ddq_r is the derivative of dq_r, in every form, next to singularities too") {
  const auto settings = settings_at(0.004);
  const JointPosition<6> wrist{0.3, -1.2, 1.4, -1.8, 0.04, 0.3}, elbow{0.3, -1.2, 0.05, -1.8, 1.2, 0.3};
  for (const auto& q : {home, wrist, elbow}) {
    CHECK(check_rate(make<SplineOperational<6, 5>>(settings), q, 2e-5) == 1);
  }
  // A plan that waits for the swinging robot.
  auto waiting = settings;
  waiting.tracking.waits = 0.5;
  CHECK(check_rate(make<SplineOperational<6, 5>>(waiting), home, 2e-5) < 0.9);
#if SKINCTL_MANY_DIGITS
  check_rate(make<SplineOperational<6, 5, Tool, double, TaskSpace::pose, ZyzError>>(settings), home, 2e-5);
  check_rate(make<SplineOperational<6, 5, Tool, double, TaskSpace::position>>(settings), home, 2e-5);
#endif
}

#if SKINCTL_MANY_DIGITS
// J^+ inverts J'J, so that J J^+ is 1 to within the condition of J, up to 140 outside the zone of damping:
// half of the allowed 64 epsilon is that. Inside the zone it is not 1.
TEST_CASE_TEMPLATE("OperationalSpace: J S_q is S_xdelta + K_i1 I1 + K_i2 I2, computed either way", T, float,
                   double) {
  using L = OperationalControl<6, 5, Tool, T>;
  OperationalSettings<6, T> s{.tracking = {.dt = 4ms, .K_i1 = T(2), .K_i2 = T(0.4)}};
  s.tracking.max_velocity = JointVelocity<6, T>::constant(T(100));
  const auto law = make<L>(s);
  Seeded rng(11);
  int checked = 0;
  double most = 0;
  for (int k = 0; k < 500; ++k) {
    State<6, T> x{0ns, rng.vector<JointPosition<6, T>>(3), rng.vector<JointVelocity<6, T>>(0.5)};
    const KnownFor<L, T> known(model, x, T(0.004), none);
    const auto J = known.template jacobian<5>(tool<T>());
    if (damped_inverse(J, s.singularities).nearness() > T(0)) continue;
    auto memory = law.start(known);
    const State<6> near{0ns, x.q.template cast<double>(), {}};
    const auto X = goal_near(make<SplineOperational<6, 5>>(settings_at(0.004)), near, 1.0).X_BP;
    memory = law.receive(memory, known, {X.template cast<T>(), {}, {}}).memory;
    for (int i = 0; i < 20; ++i) memory = law.advance(memory, known, T(0.004), Opposition::none);
    const auto now = law.now(memory, known);
    const auto site = law.space().site(known);
    T rows[6][6];
    law.space().rows(site, rows);
    const auto V = J * now.S_q;
    const T J_S[6] = {V.linear.x, V.linear.y, V.linear.z, V.angular.x, V.angular.y, V.angular.z};
    const T place[6] = {
        site.X_BP.origin().x, site.X_BP.origin().y, site.X_BP.origin().z, T(1.5), T(1.5), T(1.5)};
    for (std::size_t i = 0; i < 6; ++i) {
      const T integrals[2] = {s.tracking.K_i1 * memory.I1.sum[i], s.tracking.K_i2 * memory.I2.sum[i]};
      const T sum = now.S_delta[i] + integrals[0] + integrals[1];
      T magnitudes = magnitude(now.S_delta[i]) + magnitude(integrals[0]) + magnitude(integrals[1]) +
                     magnitude(memory.bias.decaying[i]) + T(2) * s.tracking.K_c * magnitude(place[i]);
      for (std::size_t j = 0; j < 6; ++j)
        magnitudes = magnitudes + magnitude(rows[i][j]) * (magnitude(x.dq[j]) + magnitude(now.dq_r[j]));
      const T error = magnitude(T(J_S[i] - sum));
      CHECK(error <= T(64) * epsilon<T>() * magnitudes);
      most = std::max(most, static_cast<double>(error / (epsilon<T>() * magnitudes)));
    }
    ++checked;
  }
  CHECK(checked > 200);
  MESSAGE(checked << " poses, at most " << most << " epsilon of the magnitudes");
}
#endif

TEST_CASE("OperationalSpace: the branch is kept across half a turn, and a reset takes the shortest way") {
  const RotationReference<double> target{{}, {0, 0, 0}, {0, 0, 0}};
  Xyz<double> near{0, 0, 0};
  double last = 0;
  for (double angle = 0; angle < 4; angle += 0.01) {
    const auto e = RotationVectorError::errors(exp_so3(Xyz<double>{0, 0, angle}), {0, 0, 1.0}, target, near);
    CHECK(e.e.z == doctest::Approx(angle));
    CHECK(e.slope.z == doctest::Approx(1.0));
    CHECK(e.e.z - last < 0.011);
    last = e.e.z, near = e.branch;
  }
  CHECK(RotationVectorError::errors(exp_so3(Xyz<double>{0, 0, 4}), {}, target, {0, 0, 0}).e.z < 0);
}

TEST_CASE("OperationalSpace: goals and contacts at any moment do not jump") {
  const double dt = 0.002;
  const auto law = make<SplineOperational<6, 5>>(settings_at(dt));
  using K = KnownFor<SplineOperational<6, 5>>;
  Seeded rng(12);
  State<6> x{0ns, home, {}};
  auto memory = law.start(K(model, x, dt, none));
  double worst = 0, from_rest = 0;
  const auto largest = [](const auto& joints) {
    double highest = 0;
    for (const double j : joints) highest = std::max(highest, std::abs(j));
    return highest;
  };
  for (int i = 0; i < 3000; ++i) {
    const K known(model, x, dt, none);
    const auto before = law.torque(memory, known);
    auto next = memory;
    if (i % 137 == 0) {
      auto q = home;
      for (double& a : q) a += 0.3 * rng();
      const auto X = law.space().site(K(model, State<6>{0ns, q, {}}, dt, none)).X_BP;
      next = law.receive(memory, known, {X, {}}).memory;
    } else if (i % 211 == 0) {
      next = law.advance(memory, known, 0.0, i % 422 == 0 ? Opposition::lasting : Opposition::none);
    }
    double& most = largest(x.dq) < 1e-2 ? from_rest : worst;
    most = std::max(most, largest(law.torque(next, known) - before));
    memory = law.advance(next, known, dt, next.held ? Opposition::lasting : Opposition::none);
    x = simulate(model, x, law.torque(next, known), dt, 1);
  }
  MESSAGE("largest jump " << worst << " N m, from rest " << from_rest << " N m");
  CHECK(worst < 0.005);
  CHECK(from_rest < 0.1);  // a plan that begins at rest: its own jerk, half an interval ahead
}

TEST_CASE("OperationalSpace: numbers that are not finite do not enter the memory, nor refuse for ever") {
  const auto law = make<SplineOperational<6, 5>>(settings_at(0.004));
  using K = KnownFor<SplineOperational<6, 5>>;
  const State<6> good{0ns, home, {}};
  const auto fresh = law.start(K(model, good, 0.004, none));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t place = 0; place < 12; ++place) {
    State<6> x = good;
    (place < 6 ? x.q[place] : x.dq[place - 6]) = nan;
    const K known(model, x, 0.004, none);
    auto memory = law.advance(fresh, known, 0.004, Opposition::none);
    memory = law.advance(memory, known, 0.004, Opposition::lasting);
    memory = law.advance(memory, known, 0.004, Opposition::none);
    const auto tau = law.torque(memory, K(model, good, 0.004, none));
    for (const double t : tau) CHECK(std::isfinite(t));
  }
  PoseGoal<Tool> bad{Transform<Base, Tool>::translation_xyz(nan, 0, 0), 0ns};
  CHECK(law.receive(fresh, K(model, good, 0.004, none), bad).status.has(Reason::goal_refused));
}

TEST_CASE(
    "OperationalSpace: straight through wrist and elbow singularities no joint is too fast, and it gets "
    "away") {
  const double dt = 0.004;
  const auto settings = settings_at(dt);
  const auto law = make<SplineOperational<6, 5>>(settings);
  using K = KnownFor<SplineOperational<6, 5>>;
  const JointPosition<6> wrist{0.3, -1.2, 1.4, -1.8, 0, 0.3}, elbow{0.3, -1.2, 0, -1.8, 1.2, 0.3};
  const JointPosition<6> wrist_from{0.5, -1.4, 1.2, -1.7, 0.3, 0.1},
      elbow_from{0.3, -1.4, 0.9, -1.6, 1.0, 0.1};
  const auto pose = [&](const JointPosition<6>& q) {
    return law.space().site(K(model, State<6>{0ns, q, {}}, dt, none)).X_BP;
  };
  double fastest = 0;
  const auto travel = [&](const JointPosition<6>& from, const JointPosition<6>& to) {
    State<6> x{0ns, from, {}};
    auto memory = law.start(K(model, x, dt, none));
    memory = law.receive(memory, K(model, x, dt, none), {pose(to), 2s}).memory;
    for (int i = 0; i < 1000; ++i) {
      const auto out = evaluate(law, memory, K(model, x, dt, none), dt);
      memory = out.memory;
      x = simulate(model, x, out.torque, dt, 1);
      for (const double v : x.dq) fastest = std::max(fastest, std::abs(v));
    }
    const auto d = law.space().site(K(model, x, dt, none)).X_BP.origin() - pose(to).origin();
    return std::sqrt(dot(d, d));
  };
  // To a singularity, from it (where J^+ knows no way), and to the other side of the wrist.
  CHECK(travel(wrist_from, wrist) < 2e-3);
  CHECK(travel(wrist, wrist_from) < 2e-3);
  CHECK(travel(elbow_from, elbow) < 2e-3);
  CHECK(travel(elbow, elbow_from) < 2e-3);
  CHECK(fastest < 3.1);  // asked for: at most 3
  MESSAGE("fastest joint " << fastest << " rad/s");
}

TEST_CASE("OperationalSpace: nothing of it allocates, next to a singularity either") {
  const auto law = make<SplineOperational<6, 5>>(settings_at(0.002));
  using K = KnownFor<SplineOperational<6, 5>>;
  State<6> x{0ns, {0.3, -1.2, 1.4, -1.8, 0.05, 0.3}, {}};
  auto memory = law.start(K(model, x, 0.002, none));
  const auto goal = goal_near(law, x, 0.3);
  const AllocationGuard guard;
  {
    const RealTimeScope loop;
    for (int i = 0; i < 200; ++i) {
      const K known(model, x, 0.002, none);
      if (i == 10) memory = law.receive(memory, known, goal).memory;
      const auto e = evaluate(law, memory, known, 0.002);
      memory = e.memory;
      x = simulate(model, x, e.torque, 0.002, 1);
    }
  }
  const auto count = guard.count();
  CHECK(count == 0);
}
