#include "skinctl/limits/contact_limits.hpp"

#include <doctest/doctest.h>

#include <random>
#include <string>

#include "skinctl/dynamics/operational_mobility.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;

namespace {

using Touched = LinkWrenches<ur5::Model, link_bit<2> | link_bit<4>>;

// Numbers of the test, nobody's recommendation.
BodyRegion region() {
  return {.force = 100, .blow = 200, .first = 500ms, .stiffness = 5e4, .mass = 4, .power = 30};
}
Separation separation() {
  return {.body_speed = 1.6, .reaction_time = 100ms, .deceleration = 3, .margin = 0.15};
}
template <std::size_t I>
LinkContact<I> contact() {
  return {.region = region(), .reach = 0.45, .reaction_time = 20ms};
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
  auto look() { return limits.judge(memory, at, u, touch, distance, 0.002); }
};

std::string refusal(const LinkContact<2>& c) {
  return skinctl::testing::complaint_of([&] { static_cast<void>(ContactLimits(ur5::Model{}, c)); });
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
  CHECK(changed([](auto& c) { c.reaction_time = 0s; }).find("reaction") != std::string::npos);
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
      const double m = 1 / std::max(operational_mobility(J, mass).along(n), 1e-6);
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
  CHECK(verdict.status == Status(Reason::contact_slowed));
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
        limits.judge(memory, scene.at, scene.u, nothing, limits.distances({proximity}), 0.002);
    CHECK(verdict.scale >= last);
    last = verdict.scale;
    if (proximity == 1.0) CHECK(verdict.scale * verdict.blow == doctest::Approx(200));
  }
  CHECK(last > 0.5);
  scene.u[0] = std::nan("");
  CHECK(limits.judge(memory, scene.at, scene.u, nothing, {0.0}, 0.002).scale == 0);
}

// Nobody near, so that only the contact slows the arm; the promise is checked by operational space.
TEST_CASE("ContactLimits: into a contact no faster than its energy, its reaction and its power allow") {
  Scene scene;
  scene.u[0] = 2;
  const auto poses = link_poses(scene.model, scene.at.q);
  const auto J = jacobian<4>(poses);
  const auto V = (J * scene.u).linear;
  const double v = std::sqrt(dot(V, V)), F = 50;
  const Xyz<double> n = (1 / v) * V;
  const MassFactors<ur5::Model> mass(mass_matrix(scene.model, scene.at.q));
  const double give = operational_mobility(J, mass).along(n);
  const auto pressed = [&](double reading) {
    LinkWrenches<ur5::Model, link_bit<4>> touch;
    touch.set<4>({poses.get<4>().inverse().axes() * (-reading * n), {0, 0, 0}});
    return touch;
  };
  const auto allowed = [&](auto&& change) {
    auto c = contact<4>();
    c.separation = separation(), c.range = 100, c.reaction_time = 1ms, c.region.power = 200;
    change(c);
    const auto touch = pressed(F / c.newton);
    ContactMemory<1, double> memory;
    return v * ContactLimits(scene.model, c).judge(memory, scene.at, scene.u, touch, {100.0}, 0.002).scale;
  };
  const auto as_expected = [](double x) { return doctest::Approx(x).epsilon(1e-10); };
  const double by_energy = std::sqrt((200 * 200 - F * F) * (1 / 4.0 + give) / 5e4);
  CHECK(allowed([](auto&) {}) == as_expected(by_energy));
  CHECK(allowed([](auto& c) { c.newton = 0.2; }) == as_expected(by_energy));
  CHECK(allowed([](auto& c) { c.reaction_time = 10ms; }) == as_expected((100 - F) / (5e4 * 0.01)));
  CHECK(allowed([](auto& c) { c.region.power = 5; }) == as_expected(5 / F));
  const double reacting = allowed([](auto& c) { c.deceleration = 3; });
  CHECK(reacting * 0.001 + reacting * reacting / 6 == as_expected((100 - F) / 5e4));
}

TEST_CASE("ContactLimits: a robot that reacts is as fast as it can stop before the region bears no more") {
  Scene scene;
  auto c = contact<4>();
  c.deceleration = 3;
  const ContactLimits limits(scene.model, c);
  const LinkWrenches<ur5::Model, link_bit<4>> nothing;
  const auto look = [&](double v) {
    scene.u = {};
    scene.u[0] = 1;
    const auto V = jacobian<4>(link_poses(scene.model, scene.at.q)) * scene.u;
    scene.u[0] = v / (std::sqrt(dot(V.linear, V.linear)) + 0.45 * std::sqrt(dot(V.angular, V.angular)));
    ContactMemory<1, double> memory;
    return limits.judge(memory, scene.at, scene.u, nothing, {0.0}, 0.002);
  };
  const double most = std::sqrt(0.06 * 0.06 + 6 * 200 / 5e4) - 0.06;  // v reaction + v^2 / (2 a) = F_t / k
  CHECK(look(most * (1 - 1e-9)).scale == 1);
  CHECK(look(most).blow == doctest::Approx(200).epsilon(1e-9));
  for (const double v : {1.01 * most, 0.3, 3.0}) {
    CHECK(look(v).scale * v == doctest::Approx(most).epsilon(1e-10));
    CHECK(look(v).status == Status(Reason::contact_slowed));
  }
  CHECK(look(std::nan("")).scale == 0);
}

TEST_CASE("ContactLimits: of several contacts the worst counts, on whichever link and in whatever order") {
  Scene scene;
  scene.u[0] = 0.2;
  scene.at.dq[0] = 0.1;
  const auto poses = link_poses(scene.model, scene.at.q);
  const auto V = jacobian<4>(poses) * scene.u;
  const Xyz<double> n = (1 / std::sqrt(dot(V.linear, V.linear))) * V.linear;
  const auto push = [&](double forearm, double hand) {
    scene.touch = {};
    if (forearm > 0) scene.touch.set<2>({poses.get<2>().inverse().axes() * (-forearm * n), {0, 0, 0}});
    if (hand > 0) scene.touch.set<4>({poses.get<4>().inverse().axes() * (-hand * n), {0, 0, 0}});
    scene.memory = {};
    return scene.look();
  };
  for (const auto& [forearm, hand] : {std::pair{90.0, 20.0}, {20.0, 90.0}}) {
    const auto one = push(forearm, 0), other = push(0, hand), both = push(forearm, hand);
    CHECK(both.force == doctest::Approx(90).epsilon(1e-12));
    CHECK(both.power == std::max(one.power, other.power));
    CHECK(both.scale == std::min(one.scale, other.scale));
  }
  // Pushes on two links from the same side are not one: 60 N each is no 120 N.
  scene.touch.set<2>({{0, 0, 60}, {0, 0, 0}});
  scene.touch.set<4>({{0, 0, 60}, {0, 0, 0}});
  CHECK(scene.look().force == 60);
  // A person holds the forearm from one side and brushes the other: for too long.
  for (const bool strong_first : {true, false}) {
    PressedAreas<ur5::Model, link_bit<2> | link_bit<4>> areas;
    const float up[6] = {0, 0, 1, 0, 0, 0}, down[6] = {0, 0, -1, 0, 0, 0};
    areas.add(2, {0, 0, -0.05}, up, strong_first ? 120 : 5);
    areas.add(2, {0, 0, 0.05}, down, strong_first ? 5 : 120);
    ContactMemory<2, double> memory;
    ContactVerdict<double> verdict;
    for (int k = 0; k < 260; ++k) {
      verdict = scene.limits.judge(memory, scene.at, scene.u, areas, {0, 0}, 0.002);
      CHECK(verdict.force == doctest::Approx(120).epsilon(1e-6));
      if (k < 249) CHECK_FALSE(verdict.status.has(Reason::contact_force));
    }
    CHECK(verdict.status.has(Reason::contact_force));
  }
}

TEST_CASE("ContactLimits: what is felt and is no number, or beyond all numbers, stops the arm") {
  Scene scene;
  for (const double no_number : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (std::size_t link = 0; link < 2; ++link)
      for (std::size_t i = 0; i < 6; ++i) {
        scene.touch = {};
        scene.touch.data[link][i] = no_number;
        CAPTURE(i);
        CHECK(scene.look().status.has(Reason::contact_force));
      }
  PressedAreas<ur5::Model, link_bit<2> | link_bit<4>> areas;
  const float up[6] = {0, 0, 1, 0, 0, 0};
  areas.add(2, {0, 0, -0.05}, up, 1e200);  // its square overflows
  ContactMemory<2, double> memory;
  const auto verdict = scene.limits.judge(memory, scene.at, scene.u, areas, {0, 0}, 0.002);
  CHECK(verdict.status.has(Reason::contact_force));
  // Nor does a velocity that nobody knows say that a contact takes little power.
  scene.touch = {};
  scene.touch.data[0][2] = 50;
  scene.at.dq[0] = std::nan("");
  CHECK(scene.look().status.has(Reason::contact_power));
}

TEST_CASE("ContactLimits: a look allocates nothing") {
  Scene scene;
  scene.u[1] = 1;
  const testing::AllocationGuard guard;
  for (int k = 0; k < 100; ++k) static_cast<void>(scene.look());
  CHECK(guard.count() == 0);
}
