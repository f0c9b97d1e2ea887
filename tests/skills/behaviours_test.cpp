#include "skinctl/skills/behaviours.hpp"

#include <doctest/doctest.h>

#include <boost/hana/at_key.hpp>
#include <boost/hana/size.hpp>
#include <boost/hana/union.hpp>
#include <cmath>
#include <string>

using namespace skinctl;
namespace hana = boost::hana;

namespace {
template <class C, class Next, class... L>
constexpr bool loads(const SkillRecipe<Next, L...>&) {
  return (std::is_same_v<C, L> || ...);
}
struct Wave {
  static constexpr const char* name = "wave";
};
/// A row of the paper's table: Joint, Spline Joint, Cartesian, Spline Cartesian, Skin Joint, Skin Cartesian,
/// G.
template <class B, class Library>
constexpr unsigned row(const Library& library) {
  const auto& r = hana::at_key(library, hana::type_c<B>);
  return (loads<controller::Joint>(r) ? 0b1000000u : 0) |
         (loads<controller::SplineJoint>(r) ? 0b0100000u : 0) |
         (loads<controller::Operational>(r) ? 0b0010000u : 0) |
         (loads<controller::SplineOperational>(r) ? 0b0001000u : 0) |
         (loads<controller::SkinJoint>(r) ? 0b0000100u : 0) |
         (loads<controller::SkinCartesian>(r) ? 0b0000010u : 0) |
         (loads<controller::Gravity>(r) ? 0b0000001u : 0);
}
}  // namespace

// Fig. 7, check mark by check mark.
static_assert(row<behaviour::ReachJoint>(figure_7) == 0b1000101);
static_assert(row<behaviour::ReachJointGoal>(figure_7) == 0b0100101);
static_assert(row<behaviour::ReachCartesian>(figure_7) == 0b0010101);
static_assert(row<behaviour::ReachCartesianGoal>(figure_7) == 0b0001011);
static_assert(row<behaviour::KinestheticJoint>(figure_7) == 0b0000101);
static_assert(row<behaviour::KinestheticCartesian>(figure_7) == 0b0000011);
static_assert(decltype(hana::size(figure_7))::value == 6);
// Section 6.
static_assert(row<behaviour::Reaching>(section_6) == 0b0001101);
static_assert(row<behaviour::Putting>(section_6) == 0b0001101);
static_assert(loads<controller::Force>(section_6[hana::type_c<behaviour::ForceCartesian>]));
static_assert(section_6[hana::type_c<behaviour::Squeezing>].switches == closed());
static_assert(section_6[hana::type_c<behaviour::ForceCartesian>].conditions.needs == closed());

TEST_CASE("Library: own behaviours join it, with weights, conditions and followers of their own") {
  const auto mine = hana::union_(
      figure_7,
      hana::make_map(skill<Wave>(recipe(load<controller::Gravity>(), load<controller::SplineJoint>(0.5))
                                     .when({.timeout = 2s})
                                     .switching(opened(1))
                                     .then<behaviour::KinestheticJoint>())));
  const auto& wave = mine[hana::type_c<Wave>];
  CHECK(std::string(Wave::name) == "wave");
  // A SkillRecipe carries any weight: the set that is made of it refuses one that is no number.
  CHECK(std::isnan(recipe(load<controller::Gravity>(std::nan(""))).weights[0]));
  CHECK(wave.weights == std::array<double, 2>{1.0, 0.5});
  CHECK(wave.conditions.timeout == 2s);
  CHECK(wave.switches == opened(1));
  static_assert(
      std::is_same_v<std::remove_cvref_t<decltype(wave)>,
                     SkillRecipe<behaviour::KinestheticJoint, controller::Gravity, controller::SplineJoint>>);
}
