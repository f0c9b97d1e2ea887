#include "skinctl/robots/allegro.hpp"

#include <doctest/doctest.h>

#include "skinctl/kinematics/poses.hpp"

using namespace skinctl;

TEST_CASE("Allegro: every finger keeps what the type of a finger promises") {
  for (std::size_t f = 0; f < 4; ++f) {
    CHECK_NOTHROW(static_cast<void>(allegro::right_fingers<1>(f)));
    CHECK_NOTHROW(static_cast<void>(allegro::left_fingers<1>(f)));
  }
}

TEST_CASE("Allegro: no density makes the maker's products of inertia, but kinetic energy stays positive") {
  double worst = 0;
  for (const auto side : {allegro::Side::right, allegro::Side::left}) {
    const auto hand = allegro::hand(side);
    for (std::size_t i = 0; i < 16; ++i) {
      worst = std::max(worst, density_defect(hand.link(i)));
      CHECK_NOTHROW(check_link(hand.link(i), makers_density));
    }
  }
  CHECK(worst == doctest::Approx(0.164).epsilon(0.01));
  CHECK(worst <= makers_density);
}

TEST_CASE("Allegro: one finger alone is the same finger of the hand") {
  const auto hand = allegro::right_hand();
  JointPosition<16> q;
  for (std::size_t i = 0; i < 16; ++i) q[i] = 0.1 * static_cast<double>(i) - 0.6;
  const auto poses = link_poses(hand, q);
  const auto check = [&](auto f, const auto& X_BT) {
    const auto finger = allegro::right_fingers<1>(f.value);
    const JointPosition<4> own{q[4 * f.value], q[4 * f.value + 1], q[4 * f.value + 2], q[4 * f.value + 3]};
    const auto tip = link_poses(finger, own).template get<3>();
    CHECK(tip.origin().x == doctest::Approx(X_BT.origin().x).epsilon(1e-14));
    CHECK(tip.origin().y == doctest::Approx(X_BT.origin().y).epsilon(1e-14));
    CHECK(tip.origin().z == doctest::Approx(X_BT.origin().z).epsilon(1e-14));
  };
  check(std::integral_constant<std::size_t, 0>{}, poses.get<3>());
  check(std::integral_constant<std::size_t, 3>{}, poses.get<15>());
}

TEST_CASE("Allegro: the tip belongs to the last link") {
  const auto finger = allegro::right_fingers<1>(0);
  CHECK(finger.link(3)[LinkParameter::mass] == doctest::Approx(0.0096 + 0.0168));
  const auto thumb = allegro::right_fingers<1>(3);
  CHECK(thumb.link(3)[LinkParameter::mass] == doctest::Approx(0.0388 + 0.0168));
}

TEST_CASE("Allegro: the left hand's tips are the right's mirrored, first joints of the fingers negated") {
  const auto right = allegro::right_hand(), left = allegro::left_hand();
  for (double x : {0.0, 0.3, -0.8}) {
    JointPosition<16> q, mirrored;
    for (std::size_t i = 0; i < 16; ++i) {
      q[i] = x + 0.05 * static_cast<double>(i);
      mirrored[i] = i % 4 == 0 && i < 12 ? -q[i] : q[i];
    }
    const auto X = link_poses(right, q), Y = link_poses(left, mirrored);
    const auto check = [](const auto& r, const auto& l) {
      CHECK(r.origin().x == doctest::Approx(l.origin().x).epsilon(1e-13));
      CHECK(r.origin().y == doctest::Approx(-l.origin().y).epsilon(1e-13));
      CHECK(r.origin().z == doctest::Approx(l.origin().z).epsilon(1e-13));
    };
    check(X.get<3>(), Y.get<3>());
    check(X.get<7>(), Y.get<7>());
    check(X.get<11>(), Y.get<11>());
    check(X.get<15>(), Y.get<15>());
  }
}
