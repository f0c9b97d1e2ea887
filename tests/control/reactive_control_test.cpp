#include "skinctl/control/reactive_control.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <type_traits>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/plant.hpp"
#include "tests/support/largest.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;
const JointPosition<6> home{0.3, -1.2, 1.4, -1.8, -1.4, 0.3};
template <class L>
using KnownFor = Quantities<Arm, L::needs>;
using Joint = ReactiveJoint<6>;
using Operational = ReactiveOperational<6, 5>;
static_assert(Law<Joint, KnownFor<Joint>> && Law<Operational, KnownFor<Operational>>);
static_assert(std::is_trivially_copyable_v<Operational::Memory>);
}  // namespace

TEST_CASE("ReactivePlan: a joint target that jumps at any rate gives a smooth torque and bounded joints") {
  for (const int every : {1, 7, 60}) {  // samples at 500, 71 and 8 Hz
    const double dt = 0.002;
    JointControlSettings<6> s{.dt = nanoseconds(dt), .tb = 0s, .target_age = 500ms};
    const Joint law(s);
    using K = KnownFor<Joint>;
    Seeded rng(40);
    State<6> x{0ns, home, {}};
    auto memory = law.start(K(model, x, dt, none));
    JointTorque<6> last = law.torque(memory, K(model, x, dt, none));
    double steepest = 0, fastest = 0;
    JointReference<6> target{home, {}, {}};
    for (int i = 0; i < 3000; ++i) {
      const K known(model, x, dt, none);
      if (i % 250 == 0)
        for (double& q : target.q_d) q += 0.5 * rng();
      if (i > 2000) target.q_d = home;
      auto sample = target;
      if (i % 50 == 49) sample.q_d[2] = std::nan("");
      if (i % every == 0) {
        const auto got = i % 2 == 0 ? law.follow(memory, known, sample) : law.receive(memory, known, sample);
        CHECK(got.status.has(Reason::goal_refused) == (i % 50 == 49));
        memory = got.memory;
      }
      const auto out = evaluate(law, memory, known, dt);
      memory = out.memory;
      steepest = std::max(steepest, largest(out.torque - last));
      last = out.torque;
      x = simulate(model, x, out.torque, dt, 1);
      for (const double v : x.dq) fastest = std::max(fastest, std::abs(v));
    }
    CAPTURE(every);
    CHECK(fastest < 1.01);  // max_velocity is 1
    CHECK(steepest < 1.5);  // [N m] in 2 ms
    for (std::size_t j = 0; j < 6; ++j) CHECK(x.q[j] == doctest::Approx(home[j]).epsilon(5e-3));
  }
}

TEST_CASE("ReactivePlan: a pose that jumps moves the tool smoothly, and a silent source leaves it standing") {
  const double dt = 0.004;
  OperationalSettings<6> s{.tracking = {.dt = nanoseconds(dt), .tb = 0s}};
  s.tracking.max_velocity = JointVelocity<6>::constant(3);
  const Operational law(OperationalSpace<6, 5>(Transform<Link<5>, Tool>::translation_xyz(0, 0, 0.15), s), s);
  using K = KnownFor<Operational>;
  Seeded rng(41);
  State<6> x{0ns, home, {}};
  auto memory = law.start(K(model, x, dt, none));
  const auto X0 = law.space().site(K(model, x, dt, none)).X_BP;
  double fastest = 0, off = 0;
  Transform<Base, Tool> X = X0;
  for (int i = 0; i < 2500; ++i) {
    const K known(model, x, dt, none);
    if (i % 200 == 0 && i < 2001)
      X = {exp_so3(Xyz<double>{0.3 * rng(), 0.3 * rng(), 0.3 * rng()}) * X0.axes(),
           X0.origin() + Xyz<double>{0.1 * rng(), 0.1 * rng(), 0.1 * rng()}};
    const Twist<Tool, Base, Tool, Base> V{{0, 0, i >= 2000 ? 0.05 : 0.0}, {}};
    if (i < 2010 && i % 5 == 0) memory = law.follow(memory, known, {X, V, {}}).memory;
    const auto site = law.space().site(known);
    fastest = std::max(fastest, std::sqrt(dot(site.V.linear, site.V.linear)));
    const auto e = site.X_BP.origin() - memory.plan.reference.X_BP.origin();
    off = std::max(off, std::sqrt(dot(e, e)));
    const auto out = evaluate(law, memory, known, dt);
    memory = out.memory;
    x = simulate(model, x, out.torque, dt, 1);
  }
  CHECK(fastest < 0.51);
  CHECK(off < 2e-4);
  // It went on for `target_age` after the last sample and stopped there.
  const auto d = memory.plan.reference.X_BP.origin() - (X.origin() + Xyz<double>{0, 0, 0.05 * 0.1});
  CHECK(std::sqrt(dot(d, d)) < 1e-4);
  CHECK(as_eigen(x.dq).norm() < 5e-3);
  memory.plan.reference.V.linear = {0.2, 0, 0};
  auto held = law.advance(memory, K(model, x, dt, none), dt, Opposition::lasting);
  for (int i = 0; i < 500; ++i) held = law.advance(held, K(model, x, dt, none), dt, Opposition::lasting);
  CHECK(std::abs(held.plan.reference.V.linear.x) < 1e-3);
}
