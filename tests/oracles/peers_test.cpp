// not sanitized: it compares the definition and other libraries; nothing of skinctl runs
#include <doctest/doctest.h>

#include "tests/oracles/agreement.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"

using namespace oracle;

TEST_CASE("Peers: KDL and MuJoCo agree to 1e-12 at 1000 random states of the makers' robots") {
  for (const Robot& robot : {ur5(), allegro_right()}) {
    const int joints = robot.joint_count();
    CAPTURE(joints);
    const std::size_t n = static_cast<std::size_t>(joints);
    KdlOracle kdl(robot);
    MujocoOracle mujoco(robot);
    Random random(31);
    std::vector<double> a(n), b(n), A(n * n), B(n * n), J(6 * n), K(6 * n), R(9), S(9), p(3), r(3);
    double worst = 0;
    const auto compare = [&](const auto& x, const auto& y) { worst = std::max(worst, difference(x, y)); };
    for (int round = 0; round < 1000; ++round) {
      const auto q = random.vector(joints, 3.2), dq = random.vector(joints, 3),
                 ddq = random.vector(joints, 10);
      const int body = random.index(robot.body_count());
      const double point[3] = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      kdl.inverse_dynamics(q.data(), dq.data(), ddq.data(), a.data());
      mujoco.inverse_dynamics(q.data(), dq.data(), ddq.data(), b.data());
      compare(a, b);
      kdl.gravity(q.data(), a.data());
      mujoco.gravity(q.data(), b.data());
      compare(a, b);
      kdl.mass_matrix(q.data(), A.data());
      mujoco.mass_matrix(q.data(), B.data());
      compare(A, B);
      kdl.jacobian(body, point, q.data(), J.data());
      mujoco.jacobian(body, point, q.data(), K.data());
      compare(J, K);
      kdl.pose(body, q.data(), R.data(), p.data());
      mujoco.pose(body, q.data(), S.data(), r.data());
      compare(R, S);
      compare(p, r);
    }
    CHECK(worst < 1e-12);
  }
}
