#include <doctest/doctest.h>

#include <type_traits>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/plant.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
using Arm = ur5::Model;
const Arm model;
const NoTouch none;

/// A law that asks for a torque, whatever happens.
template <int Name>
struct Push : Composable {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::tracking;
  JointTorque<6> tau;
  explicit Push(const JointTorque<6>& t) : tau(t) {}
  template <class K>
  Memory start(const K&) const noexcept {
    return {};
  }
  template <GravityTerm G = GravityTerm::included, class K>
  JointTorque<6> torque(const Memory&, const K& known, const LawShare<double>& share = {}) const noexcept {
    auto out = share.feedback * tau;
    if (G == GravityTerm::included) out += share.feed_forward * gravity_torque(known.model(), known.q());
    return out;
  }
  template <class K>
  Memory advance(const Memory& m, const K&, double, Opposition) const noexcept {
    return m;
  }
};
using First = Push<1>;
using Second = Push<2>;
using Pair = NullSpace<5, First, Second>;
using KnownHere = Quantities<Arm, Pair::needs, double>;
static_assert(Law<Pair, KnownHere> && Pair::role == LawRole::tracking);

Transform<Base, Link<5>> tool(const JointPosition<6>& q) {
  return Poses<Arm, all_links(6), double>(model, JointAngles<Arm, double>(model, q)).get<5>();
}
JointTorque<6> random_torque(Random& random) {
  JointTorque<6> tau;
  for (double& x : tau) x = uniform(random, -20.0, 20.0);
  return tau;
}
/// Kinetic energy that an impulse gives to the robot at rest: `tau' M^-1 tau`.
double energy(const JointPosition<6>& q, const JointTorque<6>& tau) {
  const auto mass = mass_matrix(model, q);
  JointTorque<6> x;
  math::Ldlt<6>(mass.data).solve(tau.data, x.data);
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += x[i] * tau[i];
  return sum;
}
}  // namespace

TEST_CASE("NullSpace: the second law does not move the first one's link, and moves the rest") {
  auto random = seeded(11);
  const JointTorque<6> zero;
  for (int k = 0; k < 40; ++k) {
    JointPosition<6> q;
    for (double& x : q) x = uniform(random, -2.5, 2.5);
    if (std::abs(std::sin(q[2])) < 0.3 || std::abs(std::sin(q[4])) < 0.3) continue;
    const State<6> rest{0ns, q, {}};
    const Pair law(First(zero), Second(random_torque(random)),
                   {.keeps = Keeps::point, .heaviest = 1e4, .zone = 1});
    const KnownHere known(model, rest, 0.0, none);
    const auto tau = law.torque(law.start(known), known);
    const auto free = law.first().torque({}, known) + law.second().tau;
    // Held for so short a time that velocities do not matter.
    const auto moved = simulate(model, rest, tau, 1e-4), pushed = simulate(model, rest, free, 1e-4);
    const auto way = [&](const State<6>& x) {
      const auto d = tool(x.q).origin() - tool(q).origin();
      return std::sqrt(dot(d, d));
    };
    CHECK(way(pushed) > 1e-9);
    CHECK(way(moved) < 1e-3 * way(pushed));
    double turned = 0;
    for (std::size_t i = 0; i < 6; ++i) turned = std::max(turned, magnitude(moved.q[i] - q[i]));
    CHECK(turned > 1e-9);
    CHECK(energy(q, tau - gravity_torque(model, q)) <= energy(q, law.second().tau) * 1.0001);
  }
}

TEST_CASE(
    "NullSpace: of a pose nothing is left away from singularities; at one, what cannot move it anyway") {
  auto random = seeded(12);
  const JointTorque<6> zero;
  const Pair law(First(zero), Second(random_torque(random)));
  const auto left = [&](const JointPosition<6>& q) {
    const State<6> rest{0ns, q, {}};
    const KnownHere known(model, rest, 0.0, none);
    return law.projected<double>(known, law.second().tau);
  };
  const JointPosition<6> regular{0.3, -1.2, 1.4, 0.1, 1.2, 0.2};
  CHECK(energy(regular, left(regular)) < 1e-12 * energy(regular, law.second().tau));
  // At the wrist's singularity one motion is left: joints 3 and 5 against each other.
  JointPosition<6> singular = regular;
  singular[4] = 0;
  CHECK(energy(singular, left(singular)) > 1e-3 * energy(singular, law.second().tau));
}

TEST_CASE(
    "NullSpace: smooth through the singularities of wrist, elbow and shoulder, for a point and a pose") {
  auto random = seeded(13);
  const JointTorque<6> zero;
  const auto tau = random_torque(random);
  for (const Keeps keeps : {Keeps::point, Keeps::pose}) {
    const Pair law(First(zero), Second(tau), {.keeps = keeps});
    for (const std::size_t joint : {4u, 2u, 1u}) {
      const auto left = [&](double angle) {
        JointPosition<6> q{0.3, -1.2, 1.4, 0.1, 1.2, 0.2};
        q[joint] = angle;
        const State<6> rest{0ns, q, {}};
        const KnownHere known(model, rest, 0.0, none);
        const auto out = law.projected<double>(known, tau);
        CHECK(energy(q, out) <= energy(q, tau) * (1 + 1e-9));
        return out;
      };
      double coarse = 0, fine = 0;  // largest steps of 1e-3 rad, and of a tenth of that at the same places
      JointTorque<6> last = left(-2);
      for (double angle = -2 + 1e-3; angle < 2; angle += 1e-3) {
        const auto now = left(angle), next = left(angle + 1e-4);
        for (std::size_t i = 0; i < 6; ++i) {
          coarse = std::max(coarse, magnitude(now[i] - last[i]));
          fine = std::max(fine, magnitude(next[i] - now[i]));
        }
        last = now;
      }
      CAPTURE(joint);
      CAPTURE(coarse);
      CHECK(fine < 0.25 * coarse + 1e-9);  // a jump would be as large in both
    }
  }
}

TEST_CASE("NullSpace: holds gravity once, takes goals for either law, and is part of a sum") {
  const SplineJoint<6> reach({.dt = 2ms});
  const JointControl<6> follow({.dt = 2ms});
  const SkinJointControl skin;
  const State<6> pose{0ns, JointPosition<6>{0.3, -1.2, 1.0, 0.1, 0.4, 0.2}, {}};
  const auto G = gravity_torque(model, pose.q);
  const auto check = [&](const auto& law) {
    using L = std::remove_cvref_t<decltype(law)>;
    const Quantities<Arm, L::needs, double> known(model, pose, 0.002, none);
    const auto tau = law.torque(law.start(known), known);
    for (std::size_t i = 0; i < 6; ++i) CHECK(magnitude(tau[i] - G[i]) < 1e-11);
  };
  check(task_priority<5>(reach, follow));
  check(task_priority<5>(reach, skin));
  check(0.5 * skin + task_priority<5>(reach, follow) + GravityControl{});
  check(0.5 * skin + task_priority<5>(reach, follow));
  const auto law = task_priority<5>(reach, follow);
  const Quantities<Arm, decltype(law)::needs, double> known(model, pose, 0.002, none);
  const auto memory = law.start(known);
  CHECK(law.receive(memory, known, JointGoal<6>{pose.q, 5s}).memory.first.plan.spline.tf == 5);
  const auto target = JointPosition<6>::constant(0.1);
  CHECK(law.receive(memory, known, JointReference<6>{target, {}, {}}).memory.second.plan.target.q_d ==
        target);
  using Bad = NullSpaceSettings;
  CHECK_THROWS_AS(static_cast<void>(task_priority<5>(reach, follow, Bad{.heaviest = 0})), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(task_priority<5>(reach, follow, Bad{.zone = -1})), ConfigurationError);
}
