#include "tests/support/robot_table.hpp"

#include <doctest/doctest.h>

#include <numbers>

#include "tests/oracles/agreement.hpp"

using namespace oracle;

namespace {

constexpr double half_turn = std::numbers::pi, quarter = half_turn / 2;

std::array<double, 9> about_x(double a) {
  return {1, 0, 0, 0, std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a)};
}
std::array<double, 9> about_y(double a) {
  return {std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)};
}
std::array<double, 9> about_z(double a) {
  return {std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1};
}

struct Frame {
  std::array<double, 9> R = about_z(0);
  std::array<double, 3> p{};

  Frame then(const std::array<double, 9>& turn, const std::array<double, 3>& step) const {
    Frame next{table_detail::product(R, turn), table_detail::product(R, step)};
    for (std::size_t k = 0; k < 3; ++k) next.p[k] += p[k];
    return next;
  }
};

/// The cross-checked numbers as the URDF's printed digits allow.
constexpr double printed = 2e-9;

}  // namespace

TEST_CASE("Robot table: UR5 stands where the maker's Denavit-Hartenberg rows put it") {
  const double a[6] = {0, -0.425, -0.39225, 0, 0, 0}, d[6] = {0.089159, 0, 0, 0.10915, 0.09465, 0.0823};
  const double alpha[6] = {quarter, 0, 0, quarter, -quarter, 0};
  const double com[6][3] = {{0, -0.02561, 0.00193}, {0.2125, 0, 0.11336}, {0.15, 0, 0.0265},
                            {0, -0.0018, 0.01634},  {0, 0.0018, 0.01634}, {0, 0, -0.001159}};
  const EulerLagrange<double> table(ur5());
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const auto q = random.vector(6, 6);
    const auto X = table.poses(q);
    Frame row;
    for (std::size_t i = 0; i < 6; ++i) {
      const Frame turned = row.then(about_z(q[i]), {0, 0, 0});
      CHECK(difference(X[i].R, turned.R) < 1e-15 * 10);
      CHECK(difference(X[i].p, turned.p) < 1e-15 * 10);
      row = turned.then(about_x(alpha[i]), {a[i], 0, d[i]});
      const auto c = row.then(about_z(0), {com[i][0], com[i][1], com[i][2]}).p;
      const auto c_table = Frame{X[i].R, X[i].p}.then(about_z(0), table.robot().bodies[i].com).p;
      for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(c[k] - c_table[k]) < 1e-15);
    }
    const auto tip = Frame{X[5].R, X[5].p}.then(about_z(0), ur5_flange).p;
    for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(tip[k] - row.p[k]) < 1e-15);
  }
}

TEST_CASE("Robot table: UR5 agrees with the maker's ROS description in frames and centres of mass") {
  // Universal_Robots_ROS2_Description, config/ur5/default_kinematics.yaml (x y z roll pitch yaw) and
  // physical_parameters.yaml (centres of mass). Its wrist frames are shifted along their joint axes.
  const double rows[6][6] = {{0, 0, 0.089159, 0, 0, 0},
                             {0, 0, 0, 1.570796327, 0, 0},
                             {-0.425, 0, 0, 0, 0, 0},
                             {-0.39225, 0, 0.10915, 0, 0, 0},
                             {0, -0.09465, -1.941303950897609e-11, 1.570796327, 0, 0},
                             {0, 0.0823, -1.688001216681175e-11, 1.570796326589793, half_turn, half_turn}};
  const double com[6][3] = {{0, -0.00193, -0.02561}, {-0.2125, 0, 0.11336}, {-0.24225, 0, 0.0265},
                            {0, -0.01634, -0.0018},  {0, 0.01634, -0.0018}, {0, 0, -0.001159}};
  const EulerLagrange<double> table(ur5());
  Random random(2);
  for (int round = 0; round < 20; ++round) {
    const auto q = random.vector(6, 3);
    const auto X = table.poses(q);
    Frame link;
    for (std::size_t i = 0; i < 6; ++i) {
      const double* r = rows[i];
      const auto turn =
          table_detail::product(table_detail::product(about_z(r[5]), about_y(r[4])), about_x(r[3]));
      link = link.then(turn, {r[0], r[1], r[2]}).then(about_z(q[i]), {0, 0, 0});
      CHECK(difference(X[i].R, link.R) < printed);
      const auto c = link.then(about_z(0), {com[i][0], com[i][1], com[i][2]}).p;
      const auto c_table = Frame{X[i].R, X[i].p}.then(about_z(0), table.robot().bodies[i].com).p;
      for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(c[k] - c_table[k]) < printed);
    }
  }
}

TEST_CASE("Robot table: the Allegro hand turns about the URDF's axes through the URDF's points") {
  struct Row {
    int parent;
    char axis;
    std::array<double, 3> rpy, xyz;
  };
  const double tilt = 0.08726646255;
  std::vector<Row> rows;
  for (int f = 0; f < 3; ++f) {
    const std::array<double, 3> at[3] = {{0, 0.0435, -0.001542}, {0, 0, 0.0007}, {0, -0.0435, -0.001542}};
    rows.push_back({-1, 'z', {(f - 1) * tilt, 0, 0}, at[f]});
    rows.push_back({4 * f, 'y', {}, {0, 0, 0.0164}});
    rows.push_back({4 * f + 1, 'y', {}, {0, 0, 0.054}});
    rows.push_back({4 * f + 2, 'y', {}, {0, 0, 0.0384}});
  }
  rows.push_back({-1, 'x', {0, -1.65806278845, -1.5707963259}, {-0.0182, 0.019333, -0.045987}});
  rows.push_back({12, 'z', {}, {-0.027, 0.005, 0.0399}});
  rows.push_back({13, 'y', {}, {0, 0, 0.0177}});
  rows.push_back({14, 'y', {}, {0, 0, 0.0514}});
  for (int f = 0; f < 4; ++f) rows.push_back({4 * f + 3, '-', {}, {0, 0, f < 3 ? 0.0267 : 0.0423}});
  const EulerLagrange<double> table(allegro_right());
  REQUIRE(table.joint_count() == 16);
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const auto q = random.vector(16, 2);
    const auto X = table.poses(q);
    std::vector<Frame> links;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Row& r = rows[i];
      const Frame up = r.parent < 0 ? Frame{} : links[static_cast<std::size_t>(r.parent)];
      const auto turn = table_detail::product(table_detail::product(about_z(r.rpy[2]), about_y(r.rpy[1])),
                                              about_x(r.rpy[0]));
      Frame link = up.then(turn, r.xyz);
      std::array<double, 3> axis{0, 1, 0};
      if (r.axis == 'z') link = link.then(about_z(q[i]), {}), axis = {0, 0, 1};
      if (r.axis == 'y') link = link.then(about_y(q[i]), {});
      if (r.axis == 'x') link = link.then(about_x(-q[i]), {}), axis = {-1, 0, 0};  // about -x
      links.push_back(link);
      CHECK(difference(X[i].p, link.p) < 1e-14);
      const auto z = table_detail::product(link.R, axis);
      const std::array<double, 3> z_table{X[i].R[2], X[i].R[5], X[i].R[8]};
      CHECK(difference(z_table, z) < 1e-14);
    }
  }
}

TEST_CASE("Robot table: melting fixed bodies changes neither mass, energy nor torque") {
  for (const Robot& robot : {allegro_right(), random_tree(8, 20), random_tree(9, 25)}) {
    const Definition whole(robot), melted(without_fixed(exact<Digits50>(robot)));
    REQUIRE(melted.robot().body_count() == robot.joint_count());
    for (const State& s : states(4, robot.joint_count())) {
      CAPTURE(s.name);
      const auto q = widened(s.q), dq = widened(s.dq), ddq = widened(s.ddq);
      CHECK(difference(melted.inverse_dynamics(q, dq, ddq), whole.inverse_dynamics(q, dq, ddq)) < 1e-30);
      CHECK(difference(melted.mass_matrix(q), whole.mass_matrix(q)) < 1e-30);
    }
  }
}

TEST_CASE("Robot table: exact rotations are orthonormal to 50 digits, zeros and ones untouched") {
  for (const NamedRobot& each : robots()) {
    const std::string& name = each.name;
    const Robot& robot = each.robot;
    CAPTURE(name);
    const auto fine = exact<Digits50>(robot);
    for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
      const auto RR = table_detail::product(table_detail::transposed(fine.bodies[i].R), fine.bodies[i].R);
      for (std::size_t k = 0; k < 9; ++k) {
        CHECK(std::abs(static_cast<double>(RR[k] - (k % 4 == 0 ? 1 : 0))) < 1e-48);
        const double was = robot.bodies[i].R[k];
        CHECK(std::abs(static_cast<double>(fine.bodies[i].R[k] - was)) < 1e-15);
        if (name == "UR5") CHECK(fine.bodies[i].R[k] == was);
      }
    }
  }
}
