// not sanitized: it compares the definition and other libraries; nothing of skinctl runs
#include "tests/support/euler_lagrange.hpp"

#include <doctest/doctest.h>

#include "tests/oracles/agreement.hpp"

using namespace oracle;

namespace {
using Vector = std::vector<Digits50>;

/// What second-order difference quotients leave of 50 digits.
constexpr double quotient = 1e-30;
}  // namespace

TEST_CASE("Euler-Lagrange: the double pendulum of the textbooks") {
  // Two rods in the vertical xz plane of the base, joints about -y: angles grow from "hanging along -z".
  const double m1 = 1.3, m2 = 0.7, l1 = 0.9, c1 = 0.4, c2 = 0.35, I1 = 0.11, I2 = 0.05, g = 9.81;
  Robot robot;
  Body rod;
  rod.R = {0, 1, 0, 0, 0, -1, -1, 0, 0};  // x down, y along base x, z along -y
  rod.mass = m1, rod.com = {c1, 0, 0}, rod.inertia = {0.01, 0, 0, 0, 0.2, 0, 0, 0, I1};
  robot.bodies.push_back(rod);
  rod = {};
  rod.parent = 0, rod.p = {l1, 0, 0};
  rod.mass = m2, rod.com = {c2, 0, 0}, rod.inertia = {0.01, 0, 0, 0, 0.2, 0, 0, 0, I2};
  robot.bodies.push_back(rod);
  const Definition model(robot);
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const auto q = random.vector(2, 4), dq = random.vector(2, 3);
    const double k = m2 * l1 * c2, s2 = std::sin(q[1]), cos2 = std::cos(q[1]);
    const double m22 = I2 + m2 * c2 * c2, m12 = m22 + k * cos2;
    const std::vector<double> M{I1 + m1 * c1 * c1 + m2 * l1 * l1 + 2 * k * cos2 + m22, m12, m12, m22};
    const std::vector<double> C{-k * s2 * dq[1], -k * s2 * (dq[0] + dq[1]), k * s2 * dq[0], 0};
    const double g2 = m2 * g * c2 * std::sin(q[0] + q[1]);
    const std::vector<double> G{(m1 * c1 + m2 * l1) * g * std::sin(q[0]) + g2, g2};
    const double V = -g * ((m1 * c1 + m2 * l1) * std::cos(q[0]) + m2 * c2 * std::cos(q[0] + q[1]));
    const auto Q = widened(q), dQ = widened(dq);
    CHECK(difference(model.mass_matrix(Q), M) < 1e-15);
    CHECK(difference(model.christoffel_matrix(Q, dQ), C) < 1e-15);
    CHECK(difference(model.gravity(Q), G) < 1e-15);
    CHECK(std::abs(static_cast<double>(model.potential_energy(Q)) - V) < 1e-14);
  }
}

TEST_CASE("Euler-Lagrange: gravity is the slope of the potential, power the change of energy") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    const Robot& robot = each.robot;
    CAPTURE(name);
    const Definition model(robot);
    for (const State& s : states(2, robot.joint_count())) {
      CAPTURE(s.name);
      const auto q = widened(s.q), dq = widened(s.dq), ddq = widened(s.ddq);
      CHECK(difference(model.gravity_by_difference(q), model.gravity(q)) < quotient);
      // d/dt (dq' M dq / 2 + V) = dq' M ddq + dq' dM dq / 2 + dq' G = dq' tau
      const Vector tau = model.inverse_dynamics(q, dq, ddq), Ma = model.product(model.mass_matrix(q), ddq);
      const Vector dMv = model.product(model.mass_matrix_rate(q, dq), dq), G = model.gravity(q);
      Digits50 power = 0, change = 0, scale = 0;
      for (std::size_t i = 0; i < q.size(); ++i) {
        power += dq[i] * tau[i];
        change += dq[i] * (Ma[i] + dMv[i] / 2 + G[i]);
        scale += abs(dq[i] * tau[i]);
      }
      CHECK(abs(power - change) <= quotient * scale);
    }
  }
}

TEST_CASE("Euler-Lagrange: Christoffel's C makes dM - 2C skew and its product needs no matrix") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    const Robot& robot = each.robot;
    if (robot.joint_count() > 8) continue;
    CAPTURE(name);
    const Definition model(robot);
    const std::size_t n = model.joint_count();
    for (const State& s : states(3, robot.joint_count())) {
      CAPTURE(s.name);
      const auto q = widened(s.q), dq = widened(s.dq), dq_r = widened(s.dq_r);
      const Vector C = model.christoffel_matrix(q, dq), dM = model.mass_matrix_rate(q, dq);
      Vector twice(n * n), N(n * n);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) {
          twice[i * n + j] = C[i * n + j] + C[j * n + i];
          N[i * n + j] = dM[i * n + j];
        }
      CHECK(difference(twice, N) < quotient);
      CHECK(difference(model.coriolis(q, dq, dq_r), model.product(C, dq_r)) < quotient);
    }
  }
}

TEST_CASE("Euler-Lagrange: D'Alembert's principle gives the same torques") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    CAPTURE(name);
    const Definition model(each.robot);
    for (const State& s : states(6, each.robot.joint_count())) {
      CAPTURE(s.name);
      const auto q = widened(s.q), dq = widened(s.dq), ddq = widened(s.ddq);
      Vector magnitude;
      const Vector tau = model.dalembert(q, dq, ddq, &magnitude);
      CHECK(difference(tau, model.inverse_dynamics(q, dq, ddq)) < quotient);
      for (std::size_t i = 0; i < tau.size(); ++i) CHECK(magnitude[i] >= abs(tau[i]));
    }
  }
}

TEST_CASE("Euler-Lagrange: forward dynamics undoes inverse dynamics") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    const Robot& robot = each.robot;
    CAPTURE(name);
    const Definition model(robot);
    const State s = states(4, robot.joint_count()).front();
    const auto q = widened(s.q), dq = widened(s.dq), ddq = widened(s.ddq);
    CHECK(difference(model.forward_dynamics(q, dq, model.inverse_dynamics(q, dq, ddq)), ddq) < 1e-30);
  }
}

TEST_CASE("Euler-Lagrange: Jacobians are the velocities of points") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    const Robot& robot = each.robot;
    CAPTURE(name);
    const Definition model(robot);
    const std::size_t n = model.joint_count();
    const State s = states(5, robot.joint_count()).front();
    const auto q = widened(s.q), dq = widened(s.dq);
    const Definition::Vec3 point{Digits50(0.1), Digits50(-0.3), Digits50(0.2)};
    const Digits50 h("1e-17");
    Vector ahead = q, behind = q;
    for (std::size_t i = 0; i < n; ++i) ahead[i] += h * dq[i], behind[i] -= h * dq[i];
    for (int b = 0; b < robot.body_count(); ++b) {
      const auto X = model.pose(b, q), A = model.pose(b, ahead), B = model.pose(b, behind);
      const Vector V = model.product(model.jacobian(b, point, q), dq);
      Vector moved(6), expected(6);
      for (std::size_t k = 0; k < 3; ++k) {
        moved[k] = (A.p[k] - B.p[k]) / (2 * h);
        for (std::size_t j = 0; j < 3; ++j)
          moved[k] += (A.R[3 * k + j] - B.R[3 * k + j]) * point[j] / (2 * h);
      }
      Definition::Mat3 dR{};
      for (std::size_t k = 0; k < 9; ++k) dR[k] = (A.R[k] - B.R[k]) / (2 * h);
      const auto W = table_detail::product(dR, table_detail::transposed(X.R));  // [omega]x
      moved[3] = W[7], moved[4] = W[2], moved[5] = W[3];
      CHECK(difference(V, moved) < quotient);
    }
  }
}
