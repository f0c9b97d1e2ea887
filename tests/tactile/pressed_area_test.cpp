#include "skinctl/tactile/pressed_area.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/contact.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/random_skin.hpp"
#include "tests/support/touched_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

using Areas = PressedAreas<ur5::Model, link_bit<2> | link_bit<4>>;
static_assert(Areas::most == 8);
static_assert(PressedAreas<ur5::Model, all_links(6)>::most == 12);
static_assert(PressedAreas<ur5::Model, 0>::most == 1);
static_assert(PressedAreas<ur5::Model, all_links(6)>::most <= max_contacts<6>);

void press(Areas& areas, std::size_t link, const Xyz<double>& p, const Xyz<double>& normal, double push) {
  const auto m = cross(p, normal);
  const float unit[6] = {float(-normal.x), float(-normal.y), float(-normal.z),
                         float(-m.x),      float(-m.y),      float(-m.z)};
  areas.add(link, p, unit, push);
}

/// All samples of a skin at once.
template <class S>
typename S::Memory felt(const S& skin, const std::vector<CellSample>& samples) {
  auto memory = skin.start(0ns);
  typename S::Wrenches mean;
  skin.receive(memory, samples, 0ns, 8ms, 1, &mean);
  return memory;
}
CellSample pressed_cell(std::uint32_t id, float force, float proximity = 0) {
  CellSample s;
  s.cell = id;
  s.time = 4ms;
  s.force = {force, 0, 0};
  s.proximity = proximity;
  return s;
}

}  // namespace

TEST_CASE("PressedAreas: cells of one side and place are one area, its place their centre of pressure") {
  Areas areas;
  press(areas, 2, {0.0, 0, 0.05}, {0, 0, 1}, 1);
  press(areas, 2, {0.02, 0, 0.05}, {0, 0.6, 0.8}, 3);
  REQUIRE(areas.size() == 1);
  CHECK(areas[0].link == 2);
  CHECK(areas[0].pushed == doctest::Approx(4));
  CHECK(areas[0].place.x == doctest::Approx(0.015));
  CHECK(areas[0].force.y == doctest::Approx(-1.8));
  CHECK(areas[0].force.z == doctest::Approx(-3.4));
  CHECK(areas[0].moment.y == doctest::Approx(0.02 * 3 * 0.8));
  // Another link, another side, another place: each its own.
  press(areas, 4, {0.0, 0, 0.05}, {0, 0, 1}, 1);
  press(areas, 2, {0.0, 0, -0.05}, {0, 0, -1}, 1);
  press(areas, 2, {0.3, 0, 0.05}, {0, 0, 1}, 1);
  CHECK(areas.size() == 4);
  // To either side of the limits: 60 degrees, 0.1 m.
  for (const double degrees : {55.0, 65.0}) {
    Areas turned;
    press(turned, 2, {0, 0, 0}, {0, 0, 1}, 1);
    const double a = degrees * M_PI / 180;
    press(turned, 2, {0, 0, 0}, {0, std::sin(a), std::cos(a)}, 1);
    CHECK(turned.size() == (degrees < 60 ? 1 : 2));
  }
  for (const double far : {0.095, 0.105}) {
    Areas moved;
    press(moved, 2, {0, 0, 0}, {0, 0, 1}, 1);
    press(moved, 2, {far, 0, 0}, {0, 0, 1}, 1);
    CHECK(moved.size() == (far < 0.1 ? 1 : 2));
  }
}

TEST_CASE("PressedAreas: never more than their room, and together always the wrench of all cells") {
  Random rng = seeded(7);
  std::uniform_real_distribution<double> u(-1, 1);
  bool full = false;
  for (int k = 0; k < 500; ++k) {
    Areas areas;
    Xyz<double> force[6] = {}, moment[6] = {};
    double farthest[6] = {};
    for (int cell = 0; cell < 40; ++cell) {
      const std::size_t link = cell % 2 == 0 ? 2 : 4;
      Xyz<double> n{u(rng), u(rng), u(rng)};
      n = (1 / std::sqrt(dot(n, n))) * n;
      const Xyz<double> p{0.3 * u(rng), 0.3 * u(rng), 0.3 * u(rng)};
      const double push = 10 * std::abs(u(rng)) + 1e-3;
      press(areas, link, p, n, push);
      force[link] = force[link] - push * n;
      moment[link] = moment[link] - push * cross(p, n);
      farthest[link] = std::max(farthest[link], std::sqrt(dot(p, p)));
    }
    std::size_t count[6] = {};
    for (const auto& a : areas) {
      ++count[a.link];
      force[a.link] = force[a.link] - a.force;
      moment[a.link] = moment[a.link] - a.moment;
      CHECK(std::sqrt(dot(a.place, a.place)) <= farthest[a.link]);
      CHECK(std::sqrt(dot(a.force, a.force)) <= a.pushed * (1 + 1e-6));
    }
    for (const std::size_t link : {2u, 4u}) {
      CHECK(count[link] >= 1);
      CHECK(count[link] <= Areas::max_per_link);
      full = full || count[link] == Areas::max_per_link;
      CHECK(std::sqrt(dot(force[link], force[link])) < 1e-4);
      CHECK(std::sqrt(dot(moment[link], moment[link])) < 1e-4);
    }
    // Levers are bounded by the link's size, whatever was joined.
    JointPosition<6> q;
    for (double& x : q) x = 3 * u(rng);
    for (const auto& c : contacts_of(ur5::Model{}, q, areas)) {
      CHECK(std::abs(c.row[c.link]) <= 2 * farthest[c.link] * (1 + 1e-6));  // about its own joint
    }
  }
  CHECK(full);
}

TEST_CASE_TEMPLATE("Skin: what is pressed is what holds a force; what is seen or silent is not", T, float,
                   double) {
  const std::vector<PlacedCell<2>> arm{cell_at<2>(1, {-0.05, 0.05, 0}, {0, 1, 0}),
                                       cell_at<2>(2, {-0.35, -0.05, 0}, {0, -1, 0})};
  const std::vector<PlacedCell<4>> hand{cell_at<4>(3, {0, 0, 0.05}, {0, 0, 1})};
  SkinSettings settings;
  settings.force = EventGate<>();
  settings.proximity = EventGate<>();
  const Skin<ur5::Model, T, Patch<2, 2>, Patch<4, 1>> skin(Patch<2, 2>(arm, {.force = 10, .proximity = 5}),
                                                           Patch<4, 1>(hand, {.force = 10, .proximity = 5}),
                                                           settings);
  auto memory = felt(skin, {pressed_cell(1, 0.5f), pressed_cell(2, 0, 0.9f), pressed_cell(3, 0.25f, 0.5f)});
  auto areas = skin.pressed(memory);
  REQUIRE(areas.size() == 2);
  CHECK(areas[0].link == 2);
  CHECK(areas[0].pushed == doctest::Approx(5).epsilon(1e-3));
  CHECK(areas[0].place.x == doctest::Approx(-0.05));
  CHECK(areas[0].force.y == doctest::Approx(-5).epsilon(1e-3));
  CHECK(areas[1].link == 4);
  // The areas' wrenches are the force wrenches.
  const auto w = skin.touch(memory).force.template wrench<2>();
  CHECK(static_cast<double>(areas[0].moment.z) == doctest::Approx(double(w.moment.z)).epsilon(1e-5));
  // Silent cells press nothing.
  LinkWrenches<ur5::Model, link_bit<2> | link_bit<4>, T> mean;
  skin.receive(memory, {}, 8ms, 2s, 1, &mean);
  CHECK(skin.pressed(memory).size() == 0);
}

TEST_CASE("Skin: a finger on each of 260 cells is one area, at that cell, and costs no allocation") {
  const auto skin = ur5_skin<260>({.force = 20});
  const AllocationGuard guard;
  for (std::size_t cell = 0; cell < 260; cell += 7) {
    auto memory = skin.start(0ns);
    CellSample s = pressed_cell(0, 0.5f);
    decltype(skin.wrenches(memory)) mean;
    for (std::uint32_t id = 0; id < 400; ++id)
      if (skin.index(id) == cell) s.cell = id;
    skin.receive(memory, {&s, 1}, 0ns, 8ms, 1, &mean);
    const auto areas = skin.pressed(memory);
    REQUIRE(areas.size() == 1);
    const auto contacts = contacts_of(ur5::Model{}, JointPosition<6>{}, areas);
    const auto of_wrench = contacts_of(ur5::Model{}, JointPosition<6>{}, skin.touch(memory).force);
    REQUIRE(contacts.count == 1);
    REQUIRE(of_wrench.count == 1);
    CHECK(contacts.list[0].link == of_wrench.list[0].link);
    CHECK(contacts.list[0].force == doctest::Approx(of_wrench.list[0].force));
    for (std::size_t j = 0; j < 6; ++j)
      CHECK(contacts.list[0].row[j] == doctest::Approx(of_wrench.list[0].row[j]).epsilon(1e-4));
  }
  CHECK(guard.count() == 0);
}
