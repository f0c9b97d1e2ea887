#include "skinctl/model/link.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::complaint_of;
using P = LinkParameter;

namespace {
LinkParameters<double> box() {
  return make_link({}, {2, {0.1, 0, 0}, 0.02, 0.03, 0.04, 0, 0, 0});
}
std::string refusal(const LinkParameters<double>& l) {
  return complaint_of([&] { check_link(l); });
}
}  // namespace

TEST_CASE("link: second moments are those of the inertia, S = tr(I)/2 1 - I") {
  constexpr auto l = make_link({}, {2, {0, 0, 0}, 0.02, 0.03, 0.04, 0.001, -0.002, 0.003});
  CHECK(l[P::s_yy] + l[P::s_zz] == doctest::Approx(0.02));
  CHECK(l[P::s_xx] + l[P::s_zz] == doctest::Approx(0.03));
  CHECK(l[P::s_xx] + l[P::s_yy] == doctest::Approx(0.04));
  CHECK(l[P::s_xy] == -0.001);
  CHECK(l[P::s_xz] == 0.002);
  CHECK(l[P::s_yz] == -0.003);
}

TEST_CASE("link: right angles are exact") {
  static_assert(Angle::quarter(1).cos == 0 && Angle::quarter(1).sin == 1);
  static_assert(Angle::quarter(-1).cos == 0 && Angle::quarter(-1).sin == -1);
  static_assert(Angle::quarter(2).cos == -1 && Angle::quarter(2).sin == 0);
  CHECK(Angle::radians(0.3).cos == std::cos(0.3));
}

TEST_CASE("link: what cannot exist is refused with its number") {
  CHECK(refusal(box()).empty());
  auto l = box();
  l[P::mass] = -1;
  CHECK(refusal(l).find("-1, allowed: >= 0 kg") != std::string::npos);
  l = box();
  l[P::p_y] = std::numeric_limits<double>::quiet_NaN();
  CHECK(refusal(l).find("finite") != std::string::npos);
  l = box();
  l[P::cos_alpha] = 0.9;
  CHECK(refusal(l).find("0.81") != std::string::npos);
  CHECK(refusal(make_link({}, {1, {0, 0, 0}, 1, 1, 3})).find("triangle") != std::string::npos);
  CHECK(refusal(make_link({}, {1, {0, 0, 0}, -1, 1, 1})).find("principal moment") != std::string::npos);
}

TEST_CASE("link: the principal moments count, not those along the axes") {
  // I_1, I_2, I_3 = 1, 2, 3.2 about axes halfway between x and z: the diagonal alone looks healthy.
  const LinkInertia hidden{1, {0, 0, 0}, 2.1, 2, 2.1, 0, -1.1, 0};
  const auto l = make_link({}, hidden);
  CHECK(density_defect(l) == doctest::Approx(0.1 / 3.1));
  CHECK(refusal(l).find("triangle") != std::string::npos);
  CHECK_NOTHROW(check_link(l, makers_density));
  CHECK(density_defect(make_link({}, {1, {0, 0, 0}, 2, 2, 2, 0, -1, 0})) == 0);
  // On the edge: a flat body (0.1, 0.2, 0.3) turned by 0.7 about y; what float rounds is forgiven.
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto flat = make_link(
      {}, {1, {0, 0, 0}, 0.1 * c * c + 0.3 * s * s, 0.2, 0.1 * s * s + 0.3 * c * c, 0, 0.2 * s * c, 0});
  CHECK_NOTHROW(check_link(flat));
  CHECK_NOTHROW(check_link(flat.cast<float>()));
  // Moments below zero are refused whatever is allowed: kinetic energy would be negative.
  CHECK_THROWS_AS(check_link(make_link({}, {1, {0, 0, 0}, 1, 1, 1, 0, 1.2, 0}), 10), ConfigurationError);
  auto nothing = make_link({}, {});
  CHECK(density_defect(nothing) == 0);
  CHECK_NOTHROW(check_link(nothing));
  nothing[P::s_xy] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(check_link(nothing, 10), ConfigurationError);
}

TEST_CASE("link: two bodies fixed to each other weigh and turn like both") {
  const LinkInertia a{2, {0.1, 0.2, -0.3}, 0.02, 0.03, 0.04, 0.001, 0.002, -0.001};
  const LinkInertia b{3, {-0.2, 0.1, 0.4}, 0.01, 0.02, 0.02, 0, 0.001, 0};
  const LinkInertia s = combined(a, b);
  CHECK(s.mass == 5);
  CHECK(s.c[0] == doctest::Approx((2 * 0.1 - 3 * 0.2) / 5));
  // Moment of inertia about the frame's z axis adds up.
  const auto about_z = [](const LinkInertia& i) {
    return i.zz + i.mass * (i.c[0] * i.c[0] + i.c[1] * i.c[1]);
  };
  const auto product_yz = [](const LinkInertia& i) { return i.yz - i.mass * i.c[1] * i.c[2]; };
  CHECK(about_z(s) == doctest::Approx(about_z(a) + about_z(b)));
  CHECK(product_yz(s) == doctest::Approx(product_yz(a) + product_yz(b)));
  CHECK(combined(a, LinkInertia{}).xx == a.xx);
  CHECK(combined(LinkInertia{}, LinkInertia{}).mass == 0);
}

TEST_CASE("link: a link gives back the inertia that it was made with") {
  const LinkInertia in{2, {0.1, -0.2, 0.3}, 0.5, 0.6, 0.7, 0.01, -0.02, 0.03};
  const LinkInertia out = inertia_of(make_link({}, in));
  CHECK(out.mass == in.mass);
  CHECK(out.c[1] == in.c[1]);
  CHECK(out.xx == doctest::Approx(in.xx).epsilon(1e-15));
  CHECK(out.yy == doctest::Approx(in.yy).epsilon(1e-15));
  CHECK(out.zz == doctest::Approx(in.zz).epsilon(1e-15));
  CHECK(out.xy == in.xy);
  CHECK(out.xz == in.xz);
  CHECK(out.yz == in.yz);
}
