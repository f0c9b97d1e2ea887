#include "skinctl/limits/body_region.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "tests/support/wrong_text.hpp"

using namespace skinctl;

namespace {

// Numbers of the test, nobody's recommendation.
BodyRegion region() {
  return {.force = 100, .blow = 200, .first = 500ms, .stiffness = 5e4, .mass = 4, .power = 30};
}
Separation separation() {
  return {.body_speed = 1.6, .reaction_time = 100ms, .deceleration = 3, .margin = 0.15};
}
template <class Limits, class Change>
std::string refusal(Limits limits, Change&& change) {
  change(limits);
  return skinctl::testing::complaint_of([&] { limits.check(); });
}
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("BodyRegion: no number is shipped") {
  CHECK(refusal(region(), [](auto&) {}).empty());
  CHECK(refusal(separation(), [](auto&) {}).empty());
  double BodyRegion::* const own[] = {&BodyRegion::force, &BodyRegion::blow, &BodyRegion::stiffness,
                                      &BodyRegion::mass};
  for (const auto field : own) {
    CHECK(!(BodyRegion{}.*field == BodyRegion{}.*field));
    CHECK_FALSE(refusal(region(), [&](auto& r) { r.*field = missing; }).empty());
  }
  double Separation::* const distances[] = {&Separation::body_speed, &Separation::deceleration,
                                            &Separation::margin};
  for (const auto field : distances) {
    CHECK(!(Separation{}.*field == Separation{}.*field));
    CHECK_FALSE(refusal(separation(), [&](auto& s) { s.*field = missing; }).empty());
  }
  CHECK_FALSE(refusal(region(), [](auto& r) { r.first = BodyRegion{}.first; }).empty());
  CHECK_FALSE(refusal(separation(), [](auto& s) { s.reaction_time = Separation{}.reaction_time; }).empty());
}

TEST_CASE("BodyRegion: what cannot be is refused, with the number and the range") {
  CHECK(refusal(region(), [](auto& r) { r.blow = 99; }) ==
        "skinctl: BodyRegion: blow = 99, allowed: >= force N, finite: your own number");
  CHECK(refusal(region(), [](auto& r) { r.force = 0; }).find("force = 0") != std::string::npos);
  CHECK(refusal(region(), [](auto& r) { r.first = -1s; }).find("first = -1") != std::string::npos);
  CHECK(refusal(region(), [](auto& r) { r.stiffness = 2e9; }).find("stiffness") != std::string::npos);
  CHECK(refusal(region(), [](auto& r) { r.mass = 0; }).find("mass = 0") != std::string::npos);
  CHECK(refusal(region(), [](auto& r) { r.power = 0; }).find("power = 0") != std::string::npos);
  CHECK(
      refusal(region(), [](auto& r) { r.mass = r.power = std::numeric_limits<double>::infinity(); }).empty());
  CHECK(refusal(separation(), [](auto& s) { s.deceleration = 0; }).find("deceleration = 0") !=
        std::string::npos);
  CHECK(refusal(separation(), [](auto& s) { s.margin = -0.1; }).find("margin = -0.1") != std::string::npos);
}

TEST_CASE_TEMPLATE("reduced_mass: as of one body where the other cannot give way", T, float, double) {
  CHECK(reduced_mass(T(2), T(2)) == T(1));
  CHECK(reduced_mass(std::numeric_limits<T>::infinity(), T(3)) == doctest::Approx(3));
}

TEST_CASE_TEMPLATE("speed_of_blow: two masses and a spring meet at it, and the force peaks at the limit", T,
                   float, double) {
  for (const double body : {0.6, 4.0, 40.0, std::numeric_limits<double>::infinity()})
    for (const double robot : {0.5, 5.0, 50.0}) {
      auto r = region();
      r.mass = body;
      const double v = double(speed_of_blow(r, T(robot)));
      double x = 0, dx = v, peak = 0;  // compression; both masses feel the spring
      for (int k = 0; k < 400000 && x >= 0; ++k) {
        dx -= 1e-6 * r.stiffness * x * (1 / body + 1 / robot);
        x += 1e-6 * dx;
        peak = std::max(peak, r.stiffness * x);
      }
      CHECK(peak == doctest::Approx(200).epsilon(1e-3));
    }
}

TEST_CASE_TEMPLATE("speed_of_separation: who comes near meets a robot at rest", T, float, double) {
  for (const double S : {0.0, 0.2, 0.32, 0.5, 1.0, 3.0}) {
    const auto s = separation();
    const double v = double(speed_of_separation(s, T(S)));
    if (S <= s.margin + s.body_speed * seconds<double>(s.reaction_time)) CHECK(v == 0);
    double apart = S, u = v;
    for (double t = 0; u > 0; t += 1e-5) {
      apart -= 1e-5 * (s.body_speed + u);
      if (t >= seconds<double>(s.reaction_time)) u -= 1e-5 * s.deceleration;
    }
    if (v > 0) CHECK(apart == doctest::Approx(s.margin).epsilon(1e-2));
  }
  CHECK(speed_of_separation(separation(), std::numeric_limits<T>::quiet_NaN()) == T(0));
}
