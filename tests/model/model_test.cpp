#include "skinctl/model/model.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/support/robots.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::complaint_of;
using P = LinkParameter;

static_assert(RobotModel<ur5::Model> && RobotModel<ur5::Calibrated<>> && RobotModel<ur5::Calibrated<float>>);
static_assert(RobotModel<CalibratedModel<allegro::Finger, Lane<double, native_lanes<double>>>>);
static_assert(std::is_empty_v<ur5::Model>, "a static model has no numbers at run time");
static_assert(std::is_same_v<decltype(ur5::Model::number<1, P::cos_alpha, double>()), TypedConstant<0>>);
static_assert(std::is_same_v<decltype(ur5::Model::number<1, P::sin_alpha, double>()), TypedConstant<1>>);
static_assert(std::is_same_v<decltype(ur5::Model::number<5, P::sin_alpha, double>()), TypedConstant<-1>>);
static_assert(std::is_same_v<decltype(ur5::Model::number<2, P::p_x, float>()), float>);

TEST_CASE("model: the calibrated twin holds the static numbers") {
  const auto twin = calibrated_from<ur5::Description>();
  CHECK(twin.number<2, P::p_x, double>() == ur5::Model::number<2, P::p_x, double>());
  CHECK(twin.number<3, P::mass, double>() == 1.219);
  CHECK(twin.gravity<double>().z == -9.81);
  static_assert(std::is_same_v<decltype(twin.number<3, P::sin_gamma, double>()), TypedConstant<0>>);
  static_assert(std::is_same_v<decltype(twin.number<0, P::sin_gamma, double>()), double>,
                "the base is not turned");
}

TEST_CASE("model: numbers that break what the tree's type promises are refused") {
  CalibratedModel<Chain<3>>::Links links;
  for (auto& l : links) l = make_link({}, {1, {0, 0, 0}, 1, 1, 1});
  CHECK(complaint_of([&] { CalibratedModel<Chain<3>> m(links); }).empty());
  links[1][P::cos_gamma] = 0.8, links[1][P::sin_gamma] = 0.6;
  CHECK(complaint_of([&] { CalibratedModel<Chain<3>> m(links); }).find("first children: gamma = 0") !=
        std::string::npos);
  CalibratedModel<allegro::Finger>::Links finger;
  for (auto& l : finger) l = make_link({}, {1, {0, 0, 0}, 1, 1, 1});
  CHECK(complaint_of([&] { CalibratedModel<allegro::Finger> m(finger); }).find("promised") !=
        std::string::npos);
}
