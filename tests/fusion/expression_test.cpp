#include <doctest/doctest.h>

#include <Eigen/Core>
#include <limits>
#include <type_traits>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

namespace {
using Spline = SplineJoint<6>;
using Follow = JointControl<6>;
static_assert(LawMembers<Spline> && LawMembers<SkinJointControl> && LawMembers<GravityControl>);
// An Eigen vector can be called; it is no law for that.
static_assert(!LawMembers<Eigen::Vector3d> && !LawMembers<JointTorque<6>> && !LawMembers<double>);

}  // namespace

TEST_CASE("Expression: keeps laws and weights in their order") {
  const Spline reach({.dt = 2ms});
  const Follow follow({.dt = 2ms});
  const SkinJointControl skin;
  const GravityControl gravity;
  const auto law = 0.6 * skin + reach * 0.3 + 2 * follow + gravity;
  using L = std::remove_const_t<decltype(law)>;
  static_assert(std::is_same_v<L, Fused<Sum::normalised, SkinJointControl, Spline, Follow, GravityControl>>);
  static_assert(L::terms == 4 && L::tracking_laws == 2 && L::reactive_laws == 1 && L::gravity_laws == 1);
  static_assert(L::gravity_term == GravityTerm::left_out && L::watches);
  CHECK(law.weights() == std::array<double, 4>{0.6, 0.3, 2.0, 1.0});

  const auto twice = 0.5 * (0.6 * skin + 2.0 * reach);
  CHECK(twice.weights() == std::array<double, 2>{0.3, 1.0});
  static_assert(std::is_same_v<std::remove_const_t<decltype(plain(law))>,
                               Fused<Sum::plain, SkinJointControl, Spline, Follow, GravityControl>>);
  static_assert(std::is_same_v<decltype(weighted(reach + follow)), Fused<Sum::weighted, Spline, Follow>>);
  CHECK(plain(law.opposed_by({.on = 7, .off = 3})).detector().settings().on == 7);
}

TEST_CASE("Expression: weights that are not positive and finite are refused, with the number") {
  const Spline reach({.dt = 2ms});
  for (const double bad :
       {0.0, -0.5, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(static_cast<void>(bad * reach), ConfigurationError);
  CHECK_THROWS_WITH_AS(static_cast<void>(-0.5 * reach),
                       "skinctl: weight of a law = -0.5, allowed: > 0: leave out what has none",
                       ConfigurationError);
}
