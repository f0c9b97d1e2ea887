#include "examples/simulated_ur5/contact.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "skinctl/core/contract.hpp"

using namespace simulated_ur5;

namespace {

constexpr double h = 0.0005;

/// A strip of cells on the upper side of the forearm.
std::vector<SkinCell> strip() {
  std::vector<SkinCell> cells(9);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i].id = static_cast<std::uint32_t>(i + 1);
    cells[i].link = 2;
    cells[i].position = {-0.10 - 0.0278 * static_cast<double>(i), 0, 0.06};
    cells[i].normal = {0, 0, 1};
    complete(cells[i]);
  }
  return cells;
}

Touch press(std::uint32_t cell) {
  Touch t;
  t.cell = cell;
  t.stiffness = 8000;
  t.damping = 0;
  t.gap = 0.05;
  t.approach_speed = 0.1;
  t.travel = 0.01;
  t.hold = 0.5;
  return t;
}

/// Runs a world over `duration` while joint 0 moves by `yield(t)`; calls `look(t, world)`.
template <class Yield, class Look>
void run(ContactWorld& world, double duration, Yield&& yield, Look&& look) {
  for (int k = 1; k * h <= duration; ++k) {
    Joints q = ArmConfig{}.home;
    q[0] += yield(k * h);
    world.advance(k * h, h, forward_kinematics(q));
    look(k * h, world);
  }
}

const auto stands = [](double) { return 0.0; };

}  // namespace

TEST_CASE("Touch: a rigid arm feels stiffness times travel, along the inward normal") {
  ContactWorld world({press(5)}, strip(), 0.01);
  double peak = 0;
  run(world, 3, stands, [&](double t, const ContactWorld& w) {
    peak = std::max(peak, w.largest_force());
    if (w.largest_force() <= 0) return;
    CHECK(t > 0.5);
    const Links links = forward_kinematics(ArmConfig{}.home);
    const Vec3 inward = -links.link[2].z;
    CHECK(norm(w.force() - w.largest_force() * inward) < 1e-9);
    const Vec3 at = links.link[2].point(strip()[4].position);
    const Joints torque = torque_of_force(links, 2, at, w.force());
    for (std::size_t i = 0; i < joint_count; ++i) CHECK(w.load()[i] == doctest::Approx(torque[i]).scale(1));
    CHECK(norm(w.moment_about(at)) < 1e-9);
  });
  CHECK(peak == doctest::Approx(8000 * 0.01).epsilon(1e-6));
  const TouchResult& r = world.results()[0];
  CHECK(r.ended);
  CHECK(r.cell == 5);
  CHECK(r.link == 2);
  CHECK(r.first_contact == doctest::Approx(0.5).epsilon(0.01));
  CHECK(r.last_contact == doctest::Approx(0.6 + 0.5 + 0.05).epsilon(0.01));
  CHECK(r.peak_force == doctest::Approx(80));
  CHECK(r.impulse == doctest::Approx(80 * 0.5 + 0.5 * 80 * 0.1 + 0.5 * 80 * 0.05).epsilon(0.01));
  CHECK(r.peak_deflection == doctest::Approx(0).scale(1));
}

TEST_CASE("Touch: an arm that gives way feels less, one that comes feels more") {
  // At home the forearm's z axis is horizontal, and joint 0 moves the strip along it.
  const Links links = forward_kinematics(ArmConfig{}.home);
  const Vec3 at = links.link[2].point(strip()[4].position);
  const double along = dot(point_velocity(links, 2, at, {1, 0, 0, 0, 0, 0}), links.link[2].z);
  REQUIRE(std::abs(along) > 0.1);
  const auto peak = [&](double way) {
    ContactWorld world({press(5)}, strip(), 0.01);
    run(
        world, 3, [&](double t) { return std::clamp((t - 0.5) / 0.1, 0.0, 1.0) * way / along; },
        [](double, const ContactWorld&) {});
    return world.results()[0];
  };
  CHECK(peak(0).peak_force == doctest::Approx(80).epsilon(1e-6));
  CHECK(peak(-0.005).peak_force == doctest::Approx(40).epsilon(0.1));
  CHECK(peak(-0.005).peak_deflection == doctest::Approx(0.005).epsilon(0.1));
  CHECK(peak(-0.02).peak_force < 5);
  CHECK(peak(0.002).peak_force == doctest::Approx(96).epsilon(0.05));
}

TEST_CASE("Touch: damping adds to the force on the way in and never pulls") {
  Touch t = press(5);
  t.damping = 200;
  ContactWorld world({t}, strip(), 0.01);
  double peak = 0;
  run(world, 3, stands, [&](double, const ContactWorld& w) {
    CHECK(w.largest_force() >= 0);
    peak = std::max(peak, w.largest_force());
  });
  CHECK(peak == doctest::Approx(8000 * 0.01 + 200 * 0.1).epsilon(0.01));
}

TEST_CASE("Touch: the cells share the force by distance, and feel the finger coming") {
  ContactWorld world({press(5)}, strip(), 0.01);
  double near_before = 0;
  bool pressed = false;
  run(world, 1, stands, [&](double t, const ContactWorld& w) {
    const auto& s = w.stimulus();
    const double sum = std::accumulate(s.force.begin(), s.force.end(), 0.0);
    CHECK(sum == doctest::Approx(w.largest_force()).scale(1));
    if (w.largest_force() > 10) {
      pressed = true;
      CHECK(s.force[4] > 4 * s.force[3]);
      CHECK(s.force[3] == doctest::Approx(s.force[5]).epsilon(1e-6));
      CHECK(s.force[3] > 50 * s.force[1]);
      CHECK(s.proximity[4] > 0.9);
    }
    if (t < 0.5) {
      CHECK(s.proximity[4] >= near_before);
      near_before = s.proximity[4];
      for (const double p : s.proximity) CHECK(p <= s.proximity[4] + 1e-12);
      if (t > 0.1) CHECK(s.proximity[4] > 0.04);
    }
  });
  CHECK(pressed);
  // Beside the cells' middle the two neighbours share.
  Touch between = press(5);
  between.cell.reset();
  between.link = 2;
  between.point = {-0.10 - 0.0278 * 4.5, 0, 0.06};
  between.normal = {0, 0, 1};
  ContactWorld shared({between}, strip(), 0.01);
  run(shared, 0.8, stands, [](double, const ContactWorld&) {});
  CHECK(shared.stimulus().force[4] == doctest::Approx(shared.stimulus().force[5]));
  CHECK(shared.stimulus().force[4] > 20);
}

TEST_CASE("Touch: after it ends nothing is left, and another run is the same") {
  std::vector<Touch> touches{press(3), press(7)};
  touches[1].start = 2;
  ContactWorld world(touches, strip(), 0.01);
  std::vector<double> first, second;
  run(world, 5, stands, [&](double, const ContactWorld& w) { first.push_back(w.largest_force()); });
  CHECK(world.active() == -1);
  CHECK(norm(world.force()) == 0);
  for (const double f : world.stimulus().force) CHECK(f == 0);
  for (const double p : world.stimulus().proximity) CHECK(p == 0);
  CHECK(world.results()[0].cell == 3);
  CHECK(world.results()[1].cell == 7);
  CHECK(world.results()[1].first_contact > 2);
  world.restart();
  CHECK_FALSE(world.results()[0].began);
  run(world, 5, stands, [&](double, const ContactWorld& w) { second.push_back(w.largest_force()); });
  CHECK(first == second);
}

TEST_CASE("Touch: a finger whose link has moved away beside it slips off") {
  const auto force_at = [&](double turn) {
    ContactWorld world({press(5)}, strip(), 0.01);
    double last = 0;
    // The forearm turns about its own axis' neighbour: joint 2 swings it across the finger.
    for (int k = 1; k * h <= 0.9; ++k) {
      Joints q = ArmConfig{}.home;
      q[2] += std::clamp((k * h - 0.6) / 0.2, 0.0, 1.0) * turn;
      world.advance(k * h, h, forward_kinematics(q));
      last = world.largest_force();
    }
    return last;
  };
  CHECK(force_at(0) == doctest::Approx(80).epsilon(1e-3));
  CHECK(force_at(0.02) > 70);
  CHECK(force_at(0.6) == 0);
}

TEST_CASE("Touch: following fingers meet a moving link where it is then") {
  const auto sway = [](double t) { return 0.1 * t; };
  Touch fixed = press(5), follows = press(5);
  follows.follow = true;
  ContactWorld a({fixed}, strip(), 0.01), b({follows}, strip(), 0.01);
  run(a, 0.45, sway, [](double, const ContactWorld&) {});
  run(b, 0.45, sway, [](double, const ContactWorld&) {});
  // The finger is 5 mm away from the surface at that time, or the surface has come or gone by then.
  CHECK(b.largest_force() == 0);
  CHECK(b.stimulus().proximity[4] == doctest::Approx(1e-4 / (1e-4 + 25e-6)).epsilon(0.05));
  CHECK(a.stimulus().proximity[4] != doctest::Approx(b.stimulus().proximity[4]).epsilon(0.05));
}

TEST_CASE(
    "Profile: a recorded press is felt as recorded by an arm that stands, and less by one that yields") {
  ForceProfile profile;
  for (int i = 0; i <= 100; ++i) {
    profile.time.push_back(0.01 * i);
    profile.force.push_back(12 * std::pow(std::sin(0.01 * i * pi), 2));
  }
  const Links links = forward_kinematics(ArmConfig{}.home);
  const double along =
      dot(point_velocity(links, 2, links.link[2].point(strip()[4].position), {1, 0, 0, 0, 0, 0}),
          links.link[2].z);
  for (const bool impose : {false, true}) {
    for (const double way : {0.0, -0.001}) {
      CAPTURE(impose);
      CAPTURE(way);
      Touch t = press(5);
      t.profile = profile;
      t.profile_scale = 2;
      t.impose_force = impose;
      t.damping = 30;
      ContactWorld world({t}, strip(), 0.01);
      double worst = 0;
      const bool yields = way != 0;
      run(
          world, 2.5, [&](double s) { return s > 0.4 ? way / along : 0; },
          [&](double s, const ContactWorld& w) {
            const double recorded = 2 * profile.at(s - 0.5);
            worst = std::max(worst, std::abs(w.largest_force() - recorded));
          });
      if (!yields || impose) CHECK(worst < 0.05);
      if (yields && !impose) CHECK(world.results()[0].peak_force == doctest::Approx(24 - 8).epsilon(0.02));
    }
  }
}

TEST_CASE("Profile: CSV is read, and what cannot be a recording is refused with its line") {
  const auto read = [](const std::string& text) {
    std::istringstream in(text);
    return read_profile(in, "p.csv");
  };
  const auto refusal = [&](const std::string& text) -> std::string {
    try {
      read(text);
    } catch (const skinctl::ConfigurationError& e) {
      return e.what();
    }
    return {};
  };
  const ForceProfile p = read("time,force\n# comment\n10.0, 0\n10.5,4\r\n\n11.0 ; 2\n");
  REQUIRE(p.time.size() == 3);
  CHECK(p.time[0] == 0);
  CHECK(p.duration() == 1.0);
  CHECK(p.at(0.25) == doctest::Approx(2));
  CHECK(p.at(0.75) == doctest::Approx(3));
  CHECK(p.at(-0.1) == 0);
  CHECK(p.at(1.1) == 0);
  CHECK(p.at(1.0) == 2);
  CHECK(refusal("0,1\n0,2\n").find("p.csv:2: time does not ascend") != std::string::npos);
  CHECK(refusal("0,1\n1,-2\n").find("p.csv:2: a number out of range") != std::string::npos);
  CHECK(refusal("0,1\n1,nan\n").find("p.csv:2") != std::string::npos);
  CHECK(refusal("0,1\nfoo,1\n").find("p.csv:2: no number") != std::string::npos);
  CHECK(refusal("0 1\n1 2\n").find("one column") != std::string::npos);
  CHECK(refusal("0,1,2\n").find("more than two columns") != std::string::npos);
  CHECK(refusal("time,force\n").find("two rows") != std::string::npos);
}

TEST_CASE("Touch: refuses what cannot be") {
  const auto refused = [](auto&& change) {
    Touch t = press(5);
    change(t);
    CHECK_THROWS_AS(ContactWorld({t}, strip(), 0.01), skinctl::ConfigurationError);
  };
  refused([](Touch& t) { t.cell = 99; });
  refused([](Touch& t) { t.stiffness = 0; });
  refused([](Touch& t) { t.approach_speed = 0; });
  refused([](Touch& t) { t.travel = -1; });
  refused([](Touch& t) { t.tremor = -0.1; });
  refused([](Touch& t) { t.start = std::nan(""); });
}
