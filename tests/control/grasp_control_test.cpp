// Promise: an internal grasp force moves nothing but the fingers, and the object feels it as asked
// Tried: 22 joints, three fingertips, with and without weights, any pose: the arm's torque below 1e-12;
// contact forces of an Allegro hand within 1 %

#include <doctest/doctest.h>

#include <limits>

#include "skinctl/skinctl.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
const std::array<Xyz<double>, 3> tips = {Xyz<double>{0.03, 0, 0}, Xyz<double>{0.03, 0, 0},
                                         Xyz<double>{0.03, 0.01, 0}};
}  // namespace

TEST_CASE("GraspControl: an arm that carries the hand feels nothing of the grasp, in any pose and motion") {
  const auto model = ur5_allegro::arm_with_hand();
  using M = std::remove_const_t<decltype(model)>;
  using Law = GraspControl<22, double, 9, 13, 21>;  // index, middle, thumb
  const Law law(tips), weighed(tips, {}, {1, 0, 0.6});
  using K = Quantities<M, Law::needs, double>;
  static_assert(skinctl::Law<Law, K>);
  auto random = seeded(1);
  for (int run = 0; run < 50; ++run) {
    State<22> x;
    for (double& q : x.q) q = uniform(random, -1.5, 1.5);
    for (double& v : x.dq) v = uniform(random, -1.0, 1.0);
    const K known(model, x, 0.001, NoTouch{});
    const auto tau = law.torque({uniform(random, -5.0, 15.0), 0}, known);
    double arm = 0, hand = 0;
    for (std::size_t i = 0; i < 22; ++i)
      (i < 6 ? arm : hand) = std::max(i < 6 ? arm : hand, std::abs(tau[i]));
    CHECK(arm < 1e-12);
    CHECK(hand > 1e-4);
    // So with weights; a finger without weight is left alone.
    const auto two = weighed.torque({8, 0}, known);
    double moved = 0;
    for (std::size_t i = 0; i < 6; ++i) CHECK(std::abs(two[i]) < 1e-12);
    for (std::size_t i = 10; i < 14; ++i) CHECK(two[i] == 0);
    for (std::size_t i = 6; i < 10; ++i) moved = std::max(moved, std::abs(two[i]));
    CHECK(moved > 1e-4);
    // A hand that moves as one is not damped: the arm moves, the fingers stand.
    for (std::size_t i = 6; i < 22; ++i) x.dq[i] = 0;
    CHECK(std::abs(law.shape(K(model, x, 0.001, NoTouch{})).rate) < 1e-12);
    // The ring finger is not part of it.
    for (std::size_t i = 14; i < 18; ++i) CHECK(tau[i] == 0);
  }
}

TEST_CASE("GraspControl: fingertips that stick to an object press on it with the force of the goal") {
  const auto hand = allegro::right_hand();
  using M = std::remove_const_t<decltype(hand)>;
  using Law = GraspControl<16, double, 3, 7, 15>;
  const Law law(tips, {.damping = 20, .max_rate = 20, .max_force = 12});
  using K = Quantities<M, Law::needs | Needs{.gravity = true}, double>;
  const double dt = 0.0005, stiffness = 2000;
  State<16> x;
  x.q = {0.0, 0.6, 0.6, 0.4, 0.0, 0.6, 0.6, 0.4, 0.0, 0.2, 0.2, 0.2, 1.2, 0.4, 0.3, 0.4};
  const auto anchors = law.shape(K(hand, x, dt, NoTouch{}));
  Law::Memory m = Law::start(K(hand, x, dt, NoTouch{}));
  m = law.receive(m, K(hand, x, dt, NoTouch{}), {8}).memory;
  std::array<Xyz<double>, 3> contact{};
  double fastest_change = 0;
  for (double t = 0; t < 1.5; t += dt) {
    const K known(hand, x, dt, NoTouch{});
    const auto s = law.shape(known);
    const auto index = Transform<Link<3>, Tool>::translation_xyz(0.03, 0, 0);
    const auto middle = Transform<Link<7>, Tool>::translation_xyz(0.03, 0, 0);
    const auto thumb = Transform<Link<15>, Tool>::translation_xyz(0.03, 0.01, 0);
    const std::tuple J{known.jacobian<3>(index), known.jacobian<7>(middle), known.jacobian<15>(thumb)};
    auto tau = law.torque(m, known) + known.gravity();
    const auto push = [&](const auto& J_k, std::size_t k) {
      typename std::remove_cvref_t<decltype(J_k)>::Load F;
      contact[k] = stiffness * Xyz<double>(anchors.p[k] - s.p[k]);
      F.force = contact[k] - 3.0 * (J_k * x.dq).linear;
      F.moment = {0, 0, 0};
      tau += transpose(J_k) * F;
    };
    push(std::get<0>(J), 0), push(std::get<1>(J), 1), push(std::get<2>(J), 2);
    for (std::size_t i = 0; i < 16; ++i) tau[i] -= 0.02 * x.dq[i];
    const auto a = forward_dynamics(hand, x.q, x.dq, tau).acceleration;
    x.dq = integrate(x.dq, a, dt);
    x.q = integrate(x.q, x.dq, dt);
    const double before = m.force;
    m = law.advance(m, known, dt, Opposition::none);
    fastest_change = std::max(fastest_change, (m.force - before) / dt);
  }
  CHECK(m.force == 8);
  CHECK(fastest_change == doctest::Approx(20));
  const auto s = law.shape(K(hand, x, dt, NoTouch{}));
  double mean = 0;
  Xyz<double> sum{0, 0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    mean += norm(contact[k]) / 3;
    sum = sum + contact[k];
    const Xyz<double> away = s.p[k] - s.centroid;
    CHECK(norm(contact[k]) == doctest::Approx(8 * norm(away) / s.size).epsilon(0.01));
    CHECK(dot(contact[k], away) > 0.999 * norm(contact[k]) * norm(away));  // away from the object's middle
  }
  CHECK(mean == doctest::Approx(8).epsilon(0.01));
  CHECK(norm(sum) < 0.05);
  CHECK(law.settled(m, K(hand, x, dt, NoTouch{}), 0.001));
}

TEST_CASE("GraspControl: goals are cut off or refused, fingertips in one place press nothing") {
  const auto hand = allegro::right_hand();
  using M = std::remove_const_t<decltype(hand)>;
  using Law = GraspControl<16, double, 3, 7>;
  const Law law({Xyz<double>{0.03, 0, 0}, Xyz<double>{0.03, 0, 0}}, {.max_force = 5});
  using K = Quantities<M, Law::needs, double>;
  const State<16> rest;
  const K known(hand, rest, 0.001, NoTouch{});
  CHECK(law.receive({}, known, {9}).memory.goal == 5);
  CHECK(law.receive({}, known, {-9}).memory.goal == -5);
  CHECK(law.receive({}, known, {std::numeric_limits<double>::quiet_NaN()}).status.has(Reason::goal_refused));
  using Same = GraspControl<16, double, 3, 2>;
  const Same none({Xyz<double>{0, 0, 0}, Xyz<double>{0, 0, 0}});
  const Quantities<M, Same::needs, double> other(hand, rest, 0.001, NoTouch{});
  const auto s = none.shape(other);
  const Same same({Xyz<double>{0, 0, 0}, turn_back(other.pose<2>().axes(), Xyz<double>(s.p[0] - s.p[1]))});
  for (const double t : same.torque({5, 5}, other)) CHECK(std::abs(t) < 1e-3);
  CHECK_THROWS_AS(Law({Xyz<double>{0.03, 0, 0}, Xyz<double>{2, 0, 0}}), ConfigurationError);
  CHECK_THROWS_AS(Law({Xyz<double>{0.03, 0, 0}, Xyz<double>{0, 0, 0}}, {.max_rate = 0}), ConfigurationError);
  CHECK_THROWS_AS(Law({Xyz<double>{0.03, 0, 0}, Xyz<double>{0, 0, 0}}, {}, {1, 0}), ConfigurationError);
  CHECK_THROWS_AS(Law({Xyz<double>{0.03, 0, 0}, Xyz<double>{0, 0, 0}}, {}, {1, 2}), ConfigurationError);
}
