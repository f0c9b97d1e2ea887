#include "skinctl/model/dh.hpp"

#include <doctest/doctest.h>

#include "skinctl/kinematics/poses.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using skinctl::testing::Digits50;
using testing::Digits50;

namespace {

using Pose = std::array<Digits50, 12>;  // rows of R, then p

Pose product(const Pose& A, const Pose& B) {
  Pose C;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c)
      C[3 * r + c] = A[3 * r] * B[c] + A[3 * r + 1] * B[3 + c] + A[3 * r + 2] * B[6 + c];
    C[9 + r] = A[9 + r] + A[3 * r] * B[9] + A[3 * r + 1] * B[10] + A[3 * r + 2] * B[11];
  }
  return C;
}
Pose along(const Digits50& x, const Digits50& y, const Digits50& z) {
  return {1, 0, 0, 0, 1, 0, 0, 0, 1, x, y, z};
}
Pose about_z(const Digits50& a) {
  return {cos(a), -sin(a), 0, sin(a), cos(a), 0, 0, 0, 1, 0, 0, 0};
}
Pose about_x(const Digits50& a) {
  return {1, 0, 0, 0, cos(a), -sin(a), 0, sin(a), cos(a), 0, 0, 0};
}

template <class X>
double difference(const X& X_BL, const Pose& at) {
  const auto x = X_BL.axis_x(), y = X_BL.axis_y(), z = X_BL.axis_z(), o = X_BL.origin();
  const double mine[12] = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z, o.x, o.y, o.z};
  double worst = 0;
  for (std::size_t k = 0; k < 12; ++k)
    worst = std::max(worst, std::abs(static_cast<double>(Digits50(mine[k]) - at[k])));
  return worst;
}

struct Slider {
  static constexpr std::size_t joints = 3;
  static constexpr auto parents = chain_parents<3>();
  static constexpr std::array<JointKind, 3> kinds = {JointKind::revolute, JointKind::prismatic,
                                                     JointKind::revolute};
};
const LinkInertia some{2, {0.1, -0.2, 0.3}, 0.5, 0.6, 0.7, 0.01, -0.02, 0.03};
const double angles[3] = {0.4, -1.1, 2.0};
const std::array<DhRow, 3> rows = {DhRow{0.3, 0.2, 0.5, Angle::radians(angles[0])},
                                   DhRow{-0.7, 0.4, 0.1, Angle::radians(angles[1])},
                                   DhRow{1.2, -0.3, 0.2, Angle::radians(angles[2])}};

constexpr Angle up = Angle::quarter(1), down = Angle::quarter(-1);

}  // namespace

TEST_CASE("DH: standard rows are the products of their matrices, sliding joints included") {
  const std::array<LinkInertia, 3> inertias = {some, some, some};
  const CalibratedModel<Slider> standard(links_from_standard_dh<3>(rows, inertias, Slider::kinds));
  oracle::Random random(1);
  for (int k = 0; k < 100; ++k) {
    const JointPosition<3> q{random.uniform(-3, 3), random.uniform(-1, 1), random.uniform(-3, 3)};
    Pose S = along(0, 0, 0), at_joint = S;
    for (std::size_t i = 0; i < 3; ++i) {
      const bool turns = Slider::kinds[i] == JointKind::revolute;
      const Pose motion = product(about_z(Digits50(rows[i].theta) + (turns ? Digits50(q[i]) : Digits50(0))),
                                  along(0, 0, Digits50(rows[i].d) + (turns ? Digits50(0) : Digits50(q[i]))));
      const Digits50 alpha = atan2(Digits50(rows[i].alpha.sin), Digits50(rows[i].alpha.cos));
      const Pose a = along(Digits50(rows[i].a), 0, 0);
      at_joint = product(S, turns ? about_z(Digits50(rows[i].theta) + Digits50(q[i])) : motion);
      S = product(product(product(S, motion), a), about_x(alpha));
    }
    CHECK(difference(link_poses(standard, q).get<2>(), at_joint) <= 2e-15);
  }
}

TEST_CASE("DH: a standard row's inertia is that of the same body seen from the row's begin") {
  const auto link = links_from_standard_dh<1>({rows[0]}, {some})[0];
  const double c = rows[0].alpha.cos, s = rows[0].alpha.sin;
  CHECK(link[LinkParameter::c_x] == doctest::Approx(0.5 + 0.1));
  CHECK(link[LinkParameter::c_y] == doctest::Approx(c * -0.2 - s * 0.3));
  CHECK(link[LinkParameter::c_z] == doctest::Approx(0.2 + s * -0.2 + c * 0.3));
  // A vector in the link's axes, its moment of inertia by both tensors.
  const double w[3] = {0.3, -0.5, 0.8}, v[3] = {w[0], c * w[1] + s * w[2], c * w[2] - s * w[1]};
  const auto moment = [](const double* u, double xx, double yy, double zz, double xy, double xz, double yz) {
    return xx * u[0] * u[0] + yy * u[1] * u[1] + zz * u[2] * u[2] +
           2 * (xy * u[0] * u[1] + xz * u[0] * u[2] + yz * u[1] * u[2]);
  };
  using P = LinkParameter;
  CHECK(moment(w, link[P::s_yy] + link[P::s_zz], link[P::s_xx] + link[P::s_zz], link[P::s_xx] + link[P::s_yy],
               -link[P::s_xy], -link[P::s_xz], -link[P::s_yz]) ==
        doctest::Approx(moment(v, some.xx, some.yy, some.zz, some.xy, some.xz, some.yz)).epsilon(1e-14));
}

TEST_CASE("DH: the UR5 from the maker's rows is the shipped one, its right angles exact") {
  constexpr double I2 = 0.13388583541666665, I3 = 0.031216803515624995;
  constexpr auto links = links_from_standard_dh<6>(
      {DhRow{0, 0.089159, 0, up}, DhRow{0, 0, -0.425, {}}, DhRow{0, 0, -0.39225, {}},
       DhRow{0, 0.10915, 0, up}, DhRow{0, 0.09465, 0, down}, DhRow{0, 0.0823, 0, {}}},
      {LinkInertia{3.7, {0, -0.02561, 0.00193}, 0.014972358333333331, 0.01040625, 0.014972358333333331},
       LinkInertia{8.393, {0.2125, 0, 0.11336}, 0.0151074, I2, I2},
       LinkInertia{2.33, {0.15, 0, 0.0265}, 0.004095, I3, I3},
       LinkInertia{1.219, {0, -0.0018, 0.01634}, 0.002013889583333333, 0.0021942, 0.002013889583333333},
       LinkInertia{1.219, {0, 0.0018, 0.01634}, 0.0018310395833333333, 0.0021942, 0.0018310395833333333},
       LinkInertia{
           0.1879, {0, 0, -0.001159}, 8.062475833333332e-05, 8.062475833333332e-05, 0.0001321171875}});
  static_assert(links[1][LinkParameter::cos_alpha] == 0 && links[5][LinkParameter::sin_alpha] == -1);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t p = 0; p < std::size_t(LinkParameter::count); ++p) {
      CAPTURE(i);
      CAPTURE(p);
      const double expected = ur5::Description::links[i].numbers[p];
      CHECK(std::abs(links[i].numbers[p] - expected) <= 1e-16 * std::max(1.0, std::abs(expected)));
      CHECK((links[i].numbers[p] == 0) == (expected == 0));
    }
}
