#include "skinctl/tactile/touch_motion.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "skinctl/model/ur5.hpp"
#include "skinctl/testing/sanitized.hpp"
#include "skinctl/testing/shaken_cell.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("proper_acceleration: is the second difference of the cell's place, and g upwards at rest") {
  const ur5::Model model{};
  auto rng = seeded(3);
  const Transform<Link<4>, Cell> X_LC({{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {0.03, -0.02, 0.09});
  double worst = 0;
  for (int k = 0; k < 50; ++k) {
    State<6> s;
    JointAcceleration<6> ddq;
    for (std::size_t i = 0; i < 6; ++i)
      s.q[i] = uniform(rng, -3.0, 3.0), s.dq[i] = uniform(rng, -2.0, 2.0), ddq[i] = uniform(rng, -5.0, 5.0);
    const auto at = [&](double t) {
      JointPosition<6> q;
      for (std::size_t i = 0; i < 6; ++i) q[i] = s.q[i] + t * s.dq[i] + 0.5 * t * t * ddq[i];
      return link_poses(model, q).get<4>() * X_LC;
    };
    const double h = 1e-4;
    const Xyz<double> a = (1 / (h * h)) * (at(h).origin() + at(-h).origin() - 2.0 * at(0).origin()) +
                          Xyz<double>{0.0, 0.0, 9.80665};
    const auto X = at(0);
    const auto p = proper_acceleration<4>(model, s, ddq, X_LC);
    for (const double e : {p.x - dot(X.axis_x(), a), p.y - dot(X.axis_y(), a), p.z - dot(X.axis_z(), a)})
      worst = std::max(worst, std::abs(e));
    s.dq = {};
    const auto rest = proper_acceleration<4>(model, s, JointAcceleration<6>{}, X_LC);
    CHECK(std::abs(std::sqrt(dot(rest, rest)) - 9.80665) < 1e-9);
    CHECK(std::abs(rest.z - 9.80665 * Xyz<double>(X.axis_z()).z) < 1e-9);
  }
  CHECK(worst < 1e-4);
}

TEST_CASE("TouchMotion: a slip of 0.2 m/s^2 is heard soon, and a moving arm is not taken for one") {
  const TouchMotion<> motion;
  const Xyz<double> none{0.0, 0.0, 0.0};
  // False ones: cell-hours of motion.
  const double hours = sanitized ? 0.05 : 8;
  int slips = 0, impacts = 0;
  for (int cell = 0; cell < 4; ++cell) {
    ShakenCell shaken(std::uint64_t(10 + cell));
    TouchMotion<>::Memory m;
    bool before = false;
    for (int n = 0; n < int(hours / 4 * 3600 * 250); ++n) {
      const auto a = shaken.next();
      const auto felt = motion.take(m, shaken.time(), a, none);
      slips += felt.slip && !before;
      before = felt.slip;
      impacts += felt.impact;
    }
  }
  // Slips and impacts that are there.
  std::vector<double> after;
  int missed = 0, hit = 0;
  for (std::uint64_t k = 0; k < (sanitized ? 20 : 400); ++k) {
    ShakenCell shaken(1000 + k);
    TouchMotion<>::Memory m;
    for (int n = 0; n < 500; ++n) {
      const auto a = shaken.next();
      motion.take(m, shaken.time(), a, none);
    }
    const double began = seconds<double>(shaken.time());
    double heard = -1;
    for (int n = 0; n < 100 && heard < 0; ++n) {
      const auto a = shaken.next(0.2);
      if (motion.take(m, shaken.time(), a, none).slip) heard = seconds<double>(shaken.time()) - began;
    }
    heard < 0 ? void(++missed) : after.push_back(1e3 * heard);
    for (int n = 0; n < 100; ++n) {
      const auto a = shaken.next();
      motion.take(m, shaken.time(), a, none);
    }
    const auto a = shaken.next(0, 2);
    hit += motion.take(m, shaken.time(), a, none).impact;
  }
  std::sort(after.begin(), after.end());
  MESSAGE(hours << " cell-hours: " << slips << " false slips, " << impacts
                << " false impacts; a slip heard after " << after[after.size() / 2]
                << " ms (95 %: " << after[after.size() * 95 / 100] << "), " << missed << " missed");
  CHECK(slips <= 2);
  CHECK(impacts == 0);
  CHECK(missed == 0);
  CHECK(after[after.size() / 2] <= 25);
  CHECK(after[after.size() * 95 / 100] <= 50);
  CHECK(hit == (sanitized ? 20 : 400));
}

TEST_CASE("TouchMotion: a slip that lasts is not forgotten, ends soon, and what is not finite is ignored") {
  const TouchMotion<> motion;
  const Xyz<double> none{0.0, 0.0, 0.0};
  ShakenCell shaken(7);
  TouchMotion<>::Memory m;
  const auto run = [&](double slip, int n) {
    bool felt = false;
    for (int k = 0; k < n; ++k) {
      const auto a = shaken.next(slip);
      felt = motion.take(m, shaken.time(), a, none).slip;
    }
    return felt;
  };
  CHECK_FALSE(run(0, 1000));
  CHECK(run(0.3, 25 * 250));
  CHECK_FALSE(run(0, 75));
  const auto before = m.energy;
  CHECK_FALSE(motion.take(m, shaken.time() + 1ms, {NAN, 0.0, 0.0}, none).impact);
  CHECK_FALSE(motion.take(m, shaken.time(), {50.0, 0.0, 0.0}, none).impact);  // not later
  CHECK(m.energy == before);
  CHECK_THROWS_AS(TouchMotion<>({.slip = 1}), ConfigurationError);
  CHECK_THROWS_AS(TouchMotion<>({.window = 0ms}), ConfigurationError);
}
