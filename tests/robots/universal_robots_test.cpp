#include "skinctl/robots/universal_robots.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// The arm as the ROS description places it, in the frames of the oracle: after Rz(q), before Tz(d). Centres
/// of mass are the file's (from the origin that is d further along z), tensors in the axes of the file's
/// `rotation`.
struct Source {
  double d1, a2, a3, d4, d5, d6;
  std::array<double, 6> mass;
  std::array<std::array<double, 3>, 6> cog;
  std::array<std::array<double, 6>, 6> tensor;  // xx, yy, zz, xy, xz, yz
  bool cylinders;
};
using Matrix = std::array<double, 9>;
constexpr Matrix one{1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr Matrix about_x{1, 0, 0, 0, 0, -1, 0, 1, 0}, about_minus_x{1, 0, 0, 0, 0, 1, 0, -1, 0};
constexpr Matrix about_y{0, 0, 1, 0, 1, 0, -1, 0, 0};

oracle::Robot table(const Source& s) {
  const std::array<Matrix, 6> R = {one, about_x, one, one, about_x, about_minus_x};
  const std::array<std::array<double, 3>, 6> p = {
      {{0, 0, 0}, {0, 0, s.d1}, {s.a2, 0, 0}, {s.a3, 0, 0}, {0, 0, s.d4}, {0, 0, s.d5}}};
  const double d[6] = {s.d1, 0, 0, s.d4, s.d5, s.d6};
  const std::array<Matrix, 6> cylinder = {one, about_y, about_y, one, one, one};
  const std::array<Matrix, 6> solid = {about_x, one, one, about_x, about_minus_x, one};
  oracle::Robot robot;
  for (std::size_t i = 0; i < 6; ++i) {
    const Matrix& turn = s.cylinders ? cylinder[i] : solid[i];
    const auto& t = s.tensor[i];
    const Matrix I{t[0], t[3], t[4], t[3], t[1], t[5], t[4], t[5], t[2]};
    using namespace oracle::table_detail;
    robot.bodies.push_back({static_cast<int>(i) - 1,
                            oracle::Motion::revolute,
                            R[i],
                            p[i],
                            s.mass[i],
                            {s.cog[i][0], s.cog[i][1], s.cog[i][2] + d[i]},
                            product(product(turn, I), transposed(turn))});
  }
  return robot;
}

template <class Description>
void check(const std::string& name, const Source& source) {
  const oracle::Robot robot = table(source);
  const StaticModel<Description> arm;
  oracle::KdlOracle kdl(robot);
  oracle::MujocoOracle mujoco(robot);
  oracle::Random random(1);
  double worst = 0, away = 0;
  for (int k = 0; k < 1000; ++k) {
    const Motion<6> at(random);
    const auto tau = inverse_dynamics(arm, at.q, at.dq, at.ddq);
    double expected[6], R[9], p[3];
    kdl.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
    worst = std::max(worst, relative_error(tau, expected, 6));
    mujoco.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
    worst = std::max(worst, relative_error(tau, expected, 6));
    kdl.pose(5, at.q.data, R, p);
    const auto o = link_poses<link_bit<5>>(arm, at.q).template get<5>().origin();
    away = std::max({away, std::abs(o.x - p[0]), std::abs(o.y - p[1]), std::abs(o.z - p[2])});
  }
  CAPTURE(name);
  CHECK(worst <= 1e-12);
  CHECK(away <= 1e-14);
  CHECK(Description::flange[2] == source.d6);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK_NOTHROW(check_link(Description::links[i]));
    CHECK(Description::lower[i] < Description::upper[i]);
    CHECK(Description::max_torque[i] > 0);
  }
}

}  // namespace

static_assert(is_zero<decltype(ur3e::Model::number<1, LinkParameter::cos_alpha, double>())>,
              "right angles of a table fold");
static_assert(std::is_empty_v<ur10e::Model>);

TEST_CASE("Universal Robots: KDL and MuJoCo agree on each, built from the ROS description's own frames") {
  check<ur3::Description>("UR3", {0.1519,
                                  -0.24365,
                                  -0.21325,
                                  0.11235,
                                  0.08535,
                                  0.0819,
                                  {2, 3.42, 1.26, 0.8, 0.8, 0.35},
                                  {{{0, 0, -0.02},
                                    {-0.11365, 0, 0.1157},
                                    {-0.16325, 0, 0.0238},
                                    {0, -0.01, 0},
                                    {0, 0.01, 0},
                                    {0, 0, -0.02}}},
                                  {{{0.008093166666666665, 0.008093166666666665, 0.005625},
                                    {0.021728491912499998, 0.021728491912499998, 0.00961875},
                                    {0.0065468090625, 0.0065468090625, 0.00354375},
                                    {0.0016106414999999998, 0.0016106414999999998, 0.00225},
                                    {0.0015721739999999998, 0.0015721739999999998, 0.00225},
                                    {0.00013626666666666665, 0.00013626666666666665, 0.0001792}}},
                                  true});
  check<ur3e::Description>("UR3e", {0.15185,
                                    -0.24355,
                                    -0.2132,
                                    0.13105,
                                    0.08535,
                                    0.0921,
                                    {1.98, 3.4445, 1.437, 0.871, 0.805, 0.261},
                                    {{{0, 0, -0.02},
                                      {-0.11355, 0, 0.1157},
                                      {-0.1632, 0, 0.0238},
                                      {0, -0.01, 0},
                                      {0, 0.01, 0},
                                      {0, 0, -0.02}}},
                                    {{{0.0027657, 0.0021501, 0.0025626, 0.0000096, -0.0000149, 0.0001873},
                                      {0.0042623, 0.0460284, 0.0448947, -0.0000409, -0.0014960, -0.0000129},
                                      {0.0010511, 0.0113396, 0.0110895, 0, -0.0000331, 0.0000022},
                                      {0.0008174, 0.0006844, 0.0005497, -0.0000005, 0.0000021, 0.0000617},
                                      {0.0006059, 0.0005837, 0.0003831, -0.0000006, -0.0000006, -0.0000271},
                                      {0.0001080, 0.0001086, 0.0001371, -0.0000001, -0.0000001, -0.0000002}}},
                                    false});
  check<ur5e::Description>("UR5e",
                           {0.1625,
                            -0.425,
                            -0.3922,
                            0.1333,
                            0.0997,
                            0.0996,
                            {3.761, 8.058, 2.846, 1.37, 1.3, 0.365},
                            {{{0, -0.00193, -0.02561},
                              {-0.2125, 0, 0.11336},
                              {-0.2422, 0, 0.0265},
                              {0, -0.01634, -0.0018},
                              {0, 0.01634, -0.0018},
                              {0, 0, -0.001159}}},
                            {{{0.00700210, 0.00648091, 0.00657286, 0.00000073, -0.00001053, 0.00049994},
                              {0.01505885, 0.33388086, 0.33247207, -0.00005400, 0.00000563, -0.00000181},
                              {0.00399632, 0.07879254, 0.07848510, -0.00001365, 0.00137272, -0.00000660},
                              {0.00165491, 0.00135962, 0.00126279, -0.00000282, -0.00000438, 0.00010157},
                              {0.00135617, 0.00127827, 0.00096614, -0.00000274, 0.00000444, -0.00005048},
                              {0.00018694, 0.00018908, 0.00025756, 0.00000006, -0.00000017, -0.00000092}}},
                            false});
  const std::array<std::array<double, 6>, 6> ten = {{{0.03408, 0.03529, 0.02156, 0.00002, -0.00425, 0.00008},
                                                     {0.02814, 0.77068, 0.76943, 0.00005, -0.01561, 0.00002},
                                                     {0.01014, 0.30928, 0.30646, 0.00008, 0.00916, 0},
                                                     {0.00296, 0.00222, 0.00258, -0.00001, 0, -0.00024},
                                                     {0.00296, 0.00222, 0.00258, -0.00001, 0, -0.00024},
                                                     {0.00040, 0.00041, 0.00034, 0, 0, 0}}};
  check<ur10::Description>("UR10", {0.1273,
                                    -0.612,
                                    -0.5723,
                                    0.163941,
                                    0.1157,
                                    0.0922,
                                    {7.1, 12.7, 4.27, 2, 2, 0.365},
                                    {{{0.021, -0.027, 0},
                                      {-0.232, 0, 0.158},
                                      {-0.3323, 0, 0.068},
                                      {0, -0.018, 0.007},
                                      {0, 0.018, -0.007},
                                      {0, 0, -0.026}}},
                                    ten,
                                    false});
  check<ur10e::Description>("UR10e", {0.1807,
                                      -0.6127,
                                      -0.57155,
                                      0.17415,
                                      0.11985,
                                      0.11655,
                                      {7.369, 13.051, 3.989, 2.1, 1.98, 0.615},
                                      {{{0.021, -0.027, 0},
                                        {-0.2327, 0, 0.158},
                                        {-0.33155, 0, 0.068},
                                        {0, -0.018, 0.007},
                                        {0, 0.018, -0.007},
                                        {0, 0, -0.026}}},
                                      ten,
                                      false});
}
