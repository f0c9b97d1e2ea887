#include "skinctl/limits/contact_limits.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>
#include <string>

#include "skinctl/dynamics/operational_inertia.hpp"
#include "skinctl/model/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"

using namespace skinctl;

namespace {

using Touched = LinkWrenches<ur5::Model, link_bit<2> | link_bit<4>>;

// Numbers of the test, nobody's recommendation.
BodyRegion region() {
  return {.force = 100, .blow = 200, .first = 500ms, .stiffness = 5e4, .mass = 4, .power = 30};
}
Separation separation() {
  return {.body_speed = 1.6, .reaction = 100ms, .deceleration = 3, .margin = 0.15};
}
template <std::size_t I>
LinkContact<I> contact() {
  return {.region = region(), .reach = 0.45, .reaction = 20ms};
}

struct Scene {
  ur5::Model model{};
  ContactLimits<ur5::Model, double, 2, 4> limits{ur5::Model{}, contact<2>(), contact<4>()};
  ContactMemory<2, double> memory{};
  State<6> at;
  JointVelocity<6> u{};
  Touched touch{};
  std::array<double, 2> distance{0, 0};
  Scene() { at.q = JointPosition<6>{0.3, -1.2, 1.4, -1.8, -1.57, 0.3}; }
  auto look() { return limits.look(memory, at, u, touch, distance, 0.002); }
};

std::string refusal(const LinkContact<2>& c) {
  try {
    static_cast<void>(ContactLimits(ur5::Model{}, c));
  } catch (const ConfigurationError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("LinkContact: what cannot be is refused, with the number") {
  CHECK(refusal(contact<2>()).empty());
  CHECK(refusal({}).find("BodyRegion: force = nan") != std::string::npos);
  const auto changed = [](auto&& change) {
    auto c = contact<2>();
    change(c);
    return refusal(c);
  };
  CHECK(changed([](auto& c) { c.region.blow = 99; }).find("BodyRegion: blow = 99") != std::string::npos);
  CHECK(changed([](auto& c) { c.region.stiffness = 0; }).find("stiffness") != std::string::npos);
  CHECK(changed([](auto& c) { c.region.mass = -1; }).find("mass") != std::string::npos);
  CHECK(changed([](auto& c) { c.region.power = 0; }).find("power") != std::string::npos);
  CHECK(changed([](auto& c) { c.reach = std::nan(""); }).find("reach") != std::string::npos);
  CHECK(changed([](auto& c) { c.reaction = 0s; }).find("reaction") != std::string::npos);
  CHECK(changed([](auto& c) { c.separation = Separation{}; }).find("Separation") != std::string::npos);
  CHECK(changed([](auto& c) { c.separation = separation(); }).find("range") != std::string::npos);
}

TEST_CASE("ContactLimits: no point of a link hits harder than they say, in any direction") {
  // The oracle: effective mass and speed at the point, along the direction, by operational space.
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  Scene scene;
  double nearest = 0;
  for (int k = 0; k < 2000; ++k) {
    for (auto& q : scene.at.q) q = 2 * unit(rng);
    for (auto& u : scene.u) u = 3 * unit(rng);
    if (k % 3 == 0) scene.u = JointVelocity<6>{3 * unit(rng), 0.0, 0.0, 0.0, 0.0, 0.0};
    const auto verdict = scene.look();
    const auto poses = link_poses(scene.model, scene.at.q);
    const MassFactors<ur5::Model> mass(mass_matrix(scene.model, scene.at.q));
    for (int j = 0; j < 10; ++j) {
      Xyz<double> p{unit(rng), unit(rng), unit(rng)}, n{unit(rng), unit(rng), unit(rng)};
      p = (0.45 / std::sqrt(dot(p, p))) * p;
      const auto J = jacobian<2>(poses, Transform<Link<2>, Cell>({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, p));
      const auto V = J * scene.u;
      if (j < 5) n = V.linear;
      n = (1 / std::sqrt(dot(n, n))) * n;
      const double m = effective_mass(operational_mobility(J, mass), n, 1e6);
      const double hits = std::abs(dot(n, V.linear)) / speed_of_blow(region(), m) * 200;
      REQUIRE(hits <= verdict.blow * (1 + 1e-9));
      REQUIRE(hits * verdict.scale <= 200 * (1 + 1e-9));
      nearest = std::max(nearest, hits / verdict.blow);
    }
  }
  CHECK(nearest > 0.9);  // not much is given away
}

TEST_CASE("ContactLimits: the allowed speed falls with what is touched, and only into the contact") {
  Scene scene;
  scene.u[0] = 0.2;
  const auto push = [&](double newton, double into) {
    // A force against the motion of link 4's origin.
    const auto poses = link_poses(scene.model, scene.at.q);
    const auto J = jacobian<4>(poses);
    const auto V = J * scene.u;
    const auto R = poses.get<4>().inverse();
    const auto f = R.axes() * ((-into * newton / std::sqrt(dot(V.linear, V.linear))) * V.linear);
    scene.touch.set<4>({f, {0, 0, 0}});
    return std::sqrt(dot(V.linear, V.linear));
  };
  const double v = push(50, 1);
  auto verdict = scene.look();
  CHECK(verdict.force == doctest::Approx(50));
  CHECK(verdict.scale * v == doctest::Approx(50 / (5e4 * 0.02)).epsilon(1e-9));  // (F_q - F)/(k reaction)
  CHECK(verdict.status == Reason::contact_slowed);
  push(90, 1);
  CHECK(scene.look().scale * v == doctest::Approx(10 / (5e4 * 0.02)).epsilon(1e-9));
  push(90, -1);
  verdict = scene.look();
  CHECK(verdict.scale == 1);
  CHECK_FALSE(verdict.status.any());
  push(150, 1);  // above the lasting limit: no further in, and a stop once the first moments are over
  verdict = scene.look();
  CHECK(verdict.scale == 0);
  CHECK_FALSE(verdict.status.has(Reason::contact_force));
  for (int k = 0; k < 260; ++k) verdict = scene.look();
  CHECK(verdict.status.has(Reason::contact_force));
  push(0, 1);
  CHECK_FALSE(scene.look().status.has(Reason::contact_force));
  push(201, 1);
  CHECK(scene.look().status.has(Reason::contact_force));
  push(50, 1);
  scene.at.dq[0] = 4;  // 50 N at some 2 m/s is more than 30 W
  CHECK(scene.look().status.has(Reason::contact_power));
  scene.touch.set<4>({{std::nan(""), 0, 0}, {0, 0, 0}});
  CHECK(scene.look().status.has(Reason::contact_force));
}

TEST_CASE("ContactLimits: a skin that sees nobody lets the arm be faster") {
  Scene scene;
  auto far = contact<4>();
  far.separation = separation();
  far.range = 2;
  const ContactLimits limits(scene.model, far);
  scene.u[0] = 2.5;
  ContactMemory<1, double> memory;
  LinkWrenches<ur5::Model, link_bit<4>> nothing;
  double last = 0;
  for (const double proximity : {1.0, 0.8, 0.5, 0.2, 0.0}) {
    const auto verdict =
        limits.look(memory, scene.at, scene.u, nothing, limits.distances({proximity}), 0.002);
    CHECK(verdict.scale >= last);
    last = verdict.scale;
    if (proximity == 1.0) CHECK(verdict.scale * verdict.blow == doctest::Approx(200));
  }
  CHECK(last > 0.5);
  scene.u[0] = std::nan("");
  CHECK(limits.look(memory, scene.at, scene.u, nothing, {0.0}, 0.002).scale == 0);
}

TEST_CASE("ContactLimits: a look allocates nothing") {
  Scene scene;
  scene.u[1] = 1;
  const testing::AllocationGuard guard;
  for (int k = 0; k < 100; ++k) static_cast<void>(scene.look());
  CHECK(guard.count() == 0);
}
