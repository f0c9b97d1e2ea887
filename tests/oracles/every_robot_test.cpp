// by night: many models in 50 digits; other tests sample their states
// not sanitized: the compiler takes minutes for so many models and digits
// Every robot that ships against KDL and MuJoCo at 10 000 random states each. The sanitizers need minutes to
// compile so many models; what runs here runs there in the tests of each function.
//
// Promise: poses, Jacobians, inverse dynamics, G, M agree with KDL and MuJoCo
// Tried: 10 000 random states of every robot shipped, 22 and 44 joints too: poses and Jacobians to 1e-14
// of their scale, torques to 1e-13 (22 and 44 joints: 1e-12), M to 2e-14. Also:
// `robots/ur5_allegro_test.cpp`

#include "tests/support/digits.hpp"
#if SKINCTL_MANY_DIGITS

#include <doctest/doctest.h>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robots/universal_robots.hpp"
#include "skinctl/robots/ur5_allegro.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/table_of.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr int states = 10000;

/// Largest difference relative to the largest number of `b`; NaN is infinitely wrong.
double apart(const double* a, const double* b, std::size_t n) {
  double error = 0, scale = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(std::abs(a[i] - b[i]) <= error)) error = std::abs(a[i] - b[i]);
    scale = std::max(scale, std::abs(b[i]));
  }
  return error == error ? error / scale : std::numeric_limits<double>::infinity();
}

struct Worst {
  double pose = 0, jacobian = 0, torque = 0, gravity = 0, mass = 0, acceleration = 0;
};

template <RobotModel M>
Worst worst(const M& model) {
  constexpr std::size_t N = M::joints, last = N - 1;
  const oracle::Robot table = table_of(model);
  oracle::KdlOracle kdl(table);
  oracle::MujocoOracle mujoco(table);
  oracle::Random random(1);
  Worst w;
  const auto note = [](double& most, double error) { most = std::max(most, error); };
  for (int k = 0; k < states; ++k) {
    const testing::Motion<N> at(random);
    double expected[N * N > 6 * N ? N * N : 6 * N], R[9], p[3];
    const auto poses = link_poses<ancestors<M>(last)>(model, at.q);
    const auto X = poses.template get<last>();
    const auto x = X.axis_x(), y = X.axis_y(), z = X.axis_z(), o = X.origin();
    const double axes[9] = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}, origin[3] = {o.x, o.y, o.z};
    kdl.pose(int(last), at.q.data, R, p);
    note(w.pose, std::max(apart(axes, R, 9), apart(origin, p, 3)));
    mujoco.pose(int(last), at.q.data, R, p);
    note(w.pose, std::max(apart(axes, R, 9), apart(origin, p, 3)));

    const double point[3] = {0.1, -0.2, 0.05};
    const auto J = jacobian<last>(poses, Transform<Link<last>, Cell>::translation_xyz(0.1, -0.2, 0.05));
    double rows[6 * N] = {};
    J.for_each([&](auto j, const auto& c) {
      const double six[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
      for (std::size_t r = 0; r < 6; ++r) rows[r * N + j.value] = six[r];
    });
    kdl.jacobian(int(last), point, at.q.data, expected);
    note(w.jacobian, apart(rows, expected, 6 * N));
    mujoco.jacobian(int(last), point, at.q.data, expected);
    note(w.jacobian, apart(rows, expected, 6 * N));

    const auto G = gravity_torque(model, at.q);
    kdl.gravity(at.q.data, expected);
    note(w.gravity, apart(G.data, expected, N));
    mujoco.gravity(at.q.data, expected);
    note(w.gravity, apart(G.data, expected, N));
    const auto M_q = mass_matrix(model, at.q);
    if (k % (N > 6 ? 100 : 1) == 0) {  // KDL has M of chains; trees cost one inverse dynamics a column
      kdl.mass_matrix(at.q.data, expected);
      note(w.mass, apart(M_q.data, expected, N * N));
    }
    mujoco.mass_matrix(at.q.data, expected);
    note(w.mass, apart(M_q.data, expected, N * N));
    if constexpr (N <= 16) {  // the torques of arms with hands have a test of their own
      const auto tau = inverse_dynamics(model, at.q, at.dq, at.ddq);
      kdl.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
      note(w.torque, apart(tau.data, expected, N));
      mujoco.inverse_dynamics(at.q.data, at.dq.data, at.ddq.data, expected);
      note(w.torque, apart(tau.data, expected, N));
      mujoco.forward_dynamics(at.q.data, at.dq.data, tau.data, expected);
      note(w.acceleration, apart(forward_dynamics(model, at.q, at.dq, tau).acceleration.data, expected, N));
    }
  }
  return w;
}

template <RobotModel M>
void check(const std::string& name, const M& model) {
  CAPTURE(name);
  const Worst w = worst(model);
  CHECK(w.pose <= 1e-14);
  CHECK(w.jacobian <= 1e-14);
  CHECK(w.torque <= 1e-13);
  CHECK(w.gravity <= 1e-13);
  CHECK(w.mass <= 2e-14);
  CHECK(w.acceleration <= 1e-10);  // both divide by M, whose condition reaches 1e5
}

/// The maker's arm as numbers at run time: one type for all six, which their own tests check as static ones.
template <class Description>
CalibratedModel<Chain<6>> arm() {
  return CalibratedModel<Chain<6>>(Description::links);
}

}  // namespace

TEST_CASE("every robot: Universal Robots' arms, KDL and MuJoCo agree at 10 000 states") {
  check("UR3", arm<ur3::Description>());
  check("UR5", arm<ur5::Description>());
  check("UR10", arm<ur10::Description>());
  check("UR3e", arm<ur3e::Description>());
  check("UR5e", arm<ur5e::Description>());
  check("UR10e", arm<ur10e::Description>());
}

TEST_CASE("every robot: Allegro hands, KDL and MuJoCo agree at 10 000 states") {
  check("Allegro, right", allegro::right_hand());
  check("Allegro, left", allegro::left_hand());
}

TEST_CASE("every robot: a UR5 with an Allegro hand, KDL and MuJoCo agree at 10 000 states") {
  check("UR5 and Allegro", ur5_allegro::arm_with_hand());
}

TEST_CASE("every robot: two UR5 with hands on one base, KDL and MuJoCo agree at 10 000 states") {
  const double s = std::sin(0.3), c = std::cos(0.3);
  const Stand right{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, {0, -0.2, 1.1}};
  const Stand left{{{c, s, 0}, {0, 0, 1}, {s, -c, 0}}, {0, 0.2, 1.1}};
  check("two UR5 and two Allegro", ur5_allegro::two_arms_with_hands(right, left));
}

#endif
