// Robots as tables of plain numbers, from which the oracles are built. Independent of skinctl.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "tests/support/random_robots.hpp"
#include "tests/support/robot_table_types.hpp"

namespace oracle {

/// UR5. Kinematics, masses and centres of mass: Universal Robots, "DH parameters for calculations of
/// kinematics and dynamics"; inertias: the cylinder approximation of Universal_Robots_ROS2_Description,
/// config/ur5/physical_parameters.yaml. Body i is the frame right after Rz(q_i) of the maker's DH row i.
inline Robot ur5() {
  constexpr std::array<double, 9> one{1, 0, 0, 0, 1, 0, 0, 0, 1};
  constexpr std::array<double, 9> turned{1, 0, 0, 0, 0, -1, 0, 1, 0};  // Rx(pi/2)
  constexpr std::array<double, 9> back{1, 0, 0, 0, 0, 1, 0, -1, 0};    // Rx(-pi/2)
  const auto diagonal = [](double x, double y, double z) {
    return std::array<double, 9>{x, 0, 0, 0, y, 0, 0, 0, z};
  };
  using enum Motion;
  Robot robot;
  const auto body = [&](const std::array<double, 9>& R, const std::array<double, 3>& p, double mass,
                        const std::array<double, 3>& com, const std::array<double, 9>& I) {
    robot.bodies.push_back({robot.body_count() - 1, revolute, R, p, mass, com, I});
  };
  constexpr double I1 = 0.014972358333333331, I2 = 0.13388583541666665, I3 = 0.031216803515624995;
  constexpr double I4 = 0.002013889583333333, I5 = 0.0018310395833333333, I6 = 8.062475833333332e-05;
  body(one, {0, 0, 0}, 3.7, {0, -0.00193, 0.063549}, diagonal(I1, I1, 0.01040625));
  body(turned, {0, 0, 0.089159}, 8.393, {-0.2125, 0, 0.11336}, diagonal(0.0151074, I2, I2));
  body(one, {-0.425, 0, 0}, 2.33, {-0.24225, 0, 0.0265}, diagonal(0.004095, I3, I3));
  body(one, {-0.39225, 0, 0}, 1.219, {0, -0.01634, 0.10735}, diagonal(I4, I4, 0.0021942));
  body(turned, {0, 0, 0.10915}, 1.219, {0, 0.01634, 0.09285}, diagonal(I5, I5, 0.0021942));
  body(back, {0, 0, 0.09465}, 0.1879, {0, 0, 0.081141}, diagonal(I6, I6, 0.0001321171875));
  return robot;
}

/// Position of the tool flange of `ur5()` on the last body (its axes are the same) [m].
inline constexpr std::array<double, 3> ur5_flange{0, 0, 0.0823};

/// Allegro hand on its palm: allegro_{right,left}_hand.urdf of Gepetto/example-robot-data (masses, inertias
/// and joint origins to the digit). Bodies 4f .. 4f+3 are finger f (0 index, 1 middle, 2 ring, 3 thumb),
/// bodies 16 + f their tips, which are fixed. The URDF turns about y or -x in many places: those frames are
/// turned so that the joint is z: y by Rx(-pi/2), -x by Ry(-pi/2). The URDF puts every centre of mass at the
/// origin of its link.
inline Robot allegro(bool left) {
  using namespace table_detail;
  using enum Motion;
  using Rotation = std::array<double, 9>;
  constexpr Rotation one{1, 0, 0, 0, 1, 0, 0, 0, 1};
  constexpr Rotation y_to_z{1, 0, 0, 0, 0, 1, 0, -1, 0};
  constexpr Rotation minus_x_to_z{0, 0, -1, 0, 1, 0, 1, 0, 0}, x_to_z{0, 0, 1, 0, 1, 0, -1, 0, 0};
  constexpr Rotation minus_z_to_z{1, 0, 0, 0, -1, 0, 0, 0, -1};
  const double side = left ? -1 : 1;
  struct Row {  // as the URDF prints it, with the turn that makes its axis z
    int parent;
    Motion motion;
    Rotation turn, R;
    std::array<double, 3> xyz;
    double mass;
    std::array<double, 6> I;  // xx, xy, xz, yy, yz, zz
  };
  std::vector<Row> rows;
  const auto joint = [&](int parent, const Rotation& turn, const Rotation& R,
                         const std::array<double, 3>& xyz, double mass, const std::array<double, 6>& I) {
    rows.push_back({parent, revolute, turn, R, xyz, mass, I});
  };
  constexpr double tilt = 0.08726646255;
  for (int f = 0; f < 3; ++f) {
    const double a = side * (f - 1) * tilt, y = side * (1 - f) * 0.0435, z = f == 1 ? 0.0007 : -0.001542;
    const double s = std::sin(a), c = std::cos(a);
    joint(-1, one, {1, 0, 0, 0, c, -s, 0, s, c}, {0, y, z}, 0.0119,
          {1.01666658333e-06, 0, 0, 6.47677333333e-07, 0, 1.01666658333e-06});
    joint(4 * f, y_to_z, one, {0, 0, 0.0164}, 0.065,
          {7.95654166667e-05, 1.7199e-05, 8.75875e-06, 2.47088833333e-05, 2.413125e-05, 7.95654166667e-05});
    joint(4 * f + 1, y_to_z, one, {0, 0, 0.054}, 0.0355,
          {2.63979183333e-05, 6.67968e-06, 4.783625e-06, 1.34948516667e-05, 9.372e-06, 2.63979183333e-05});
    joint(4 * f + 2, y_to_z, one, {0, 0, 0.0384}, 0.0096,
          {4.701248e-06, 1.255968e-06, 1.2936e-06, 3.649312e-06, 1.7622e-06, 4.701248e-06});
  }
  // rpy = 0 -1.65806278845 -+1.5707963259
  const double sz = std::sin(-side * 1.5707963259), cz = std::cos(-side * 1.5707963259);
  const double sy = std::sin(-1.65806278845), cy = std::cos(-1.65806278845);
  const Rotation R =
      product(Rotation{cz, -sz, 0, sz, cz, 0, 0, 0, 1}, Rotation{cy, 0, sy, 0, 1, 0, -sy, 0, cy});
  joint(-1, left ? x_to_z : minus_x_to_z, R, {-0.0182, side * 0.019333, -0.045987}, 0.0176,
        {1.89273333333e-5, 7.16716e-06, 5.35568e-06, 1.43008213333e-05, 6.8068e-06, 1.89273333333e-05});
  joint(
      12, left ? minus_z_to_z : one, one, {-0.027, side * 0.005, 0.0399}, 0.0119,
      {4.24250866667e-06, 1.032087e-06, 1.603525e-06, 4.52362633333e-06, 1.44808125e-06, 4.24250866667e-06});
  joint(13, y_to_z, one, {0, 0, 0.0177}, 0.038,
        {4.30439933333e-05, 9.57068e-06, 5.1205e-06, 1.44451933333e-05, 1.342825e-05, 4.30439933333e-05});
  joint(14, y_to_z, one, {0, 0, 0.0514}, 0.0388,
        {3.29223173333e-05, 8.042076e-06, 5.2283e-06, 1.47493026667e-5, 1.1283525e-5, 3.29223173333e-05});
  for (int f = 0; f < 4; ++f)
    rows.push_back({4 * f + 3,
                    fixed,
                    y_to_z,
                    one,
                    {0, 0, f < 3 ? 0.0267 : 0.0423},
                    0.0168,
                    {9.68e-07, 0, 0, 9.68e-07, 0, 9.68e-07}});
  Robot robot;
  for (const Row& row : rows) {
    const Rotation up = row.parent < 0 ? one : transposed(rows[static_cast<std::size_t>(row.parent)].turn);
    const auto& [xx, xy, xz, yy, yz, zz] = row.I;
    const Rotation I{xx, xy, xz, xy, yy, yz, xz, yz, zz};
    robot.bodies.push_back({row.parent,
                            row.motion,
                            product(product(up, row.R), row.turn),
                            product(up, row.xyz),
                            row.mass,
                            {0, 0, 0},
                            product(product(transposed(row.turn), I), row.turn)});
  }
  return robot;
}
inline Robot allegro_right() {
  return allegro(false);
}

/// `b` with its base fixed to body `at` of `a` (-1: its base) at `R`, `p`.
inline Robot joined(Robot a, int at, const Robot& b, const std::array<double, 9>& R,
                    const std::array<double, 3>& p) {
  const int first = a.body_count();
  for (Body body : b.bodies) {
    if (body.parent < 0) {
      body.parent = at;
      body.R = table_detail::product(R, body.R);
      body.p = table_detail::product(R, body.p);
      for (std::size_t k = 0; k < 3; ++k) body.p[k] += p[k];
    } else {
      body.parent += first;
    }
    a.bodies.push_back(body);
  }
  return a;
}

}  // namespace oracle
