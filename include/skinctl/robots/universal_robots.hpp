// SPDX-License-Identifier: BSD-3-Clause
// Universal Robots' arms besides the UR5: kinematics, inertias and limits as the maker publishes them.
#pragma once

#include "skinctl/model/dh.hpp"
#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// An arm from a table: the maker's standard Denavit-Hartenberg rows, and each link's mass, centre of mass
/// and inertia in the frame at the end of its row, as Universal Robots publishes them. The frames of the
/// links are those of `ur5::Description`: directly after the rotation by theta; at q = 0 the arm is stretched
/// along -x of the base.
///
/// Sources:
/// - a, d, alpha, masses and centres of mass: universal-robots.com, "DH Parameters for calculations of
///   kinematics and dynamics".
/// - Inertia tensors and joint limits: Universal_Robots_ROS2_Description (BSD-3),
///   config/ROBOT/physical_parameters.yaml (whose centres of mass agree with the maker's page) and
///   joint_limits.yaml (user manuals; "Max. joint torques"). There the elbow is limited to half its range to
///   avoid self-collision.
template <class Table>
struct UniversalRobot : Chain<6> {
  static constexpr double gravity[3] = {0, 0, -9.81};
  static constexpr std::array<LinkParameters<double>, 6> links =
      links_from_standard_dh<6>(Table::rows, Table::inertias);
  /// Origin of the flange in link 5's frame, axes alike [m].
  static constexpr double flange[3] = {0, 0, Table::rows[5].d};

  static constexpr std::array<double, 6> lower = {-6.283185307179586, -6.283185307179586, -3.141592653589793,
                                                  -6.283185307179586, -6.283185307179586, -6.283185307179586};
  static constexpr std::array<double, 6> upper = {6.283185307179586, 6.283185307179586, 3.141592653589793,
                                                  6.283185307179586, 6.283185307179586, 6.283185307179586};
  static constexpr std::array<double, 6> max_velocity = Table::max_velocity;  ///< largest speeds [rad/s]
  static constexpr std::array<double, 6> max_torque = Table::max_torque;      ///< largest torques [N m]

  static constexpr const std::array<DhRow, 6>& rows = Table::rows;
  static constexpr const std::array<LinkInertia, 6>& inertias = Table::inertias;
};

namespace detail {
inline constexpr double turn_per_second = 6.283185307179586;  // 360 degrees/s
/// The rows of all these arms, which differ in six lengths only.
constexpr std::array<DhRow, 6> universal_rows(double d1, double a2, double a3, double d4, double d5,
                                              double d6) noexcept {
  return {DhRow{0, d1, 0, Angle::quarter(1)},
          DhRow{0, 0, a2, {}},
          DhRow{0, 0, a3, {}},
          DhRow{0, d4, 0, Angle::quarter(1)},
          DhRow{0, d5, 0, Angle::quarter(-1)},
          DhRow{0, d6, 0, {}}};
}
constexpr std::array<double, 6> three_and_wrist(double first, double second, double elbow,
                                                double wrist) noexcept {
  return {first, second, elbow, wrist, wrist, wrist};
}

struct Ur3Table {
  static constexpr auto rows = universal_rows(0.1519, -0.24365, -0.21325, 0.11235, 0.08535, 0.0819);
  // Tensors: cylinder approximations with the long axes of the source, here in the axes of the row's end.
  static constexpr std::array<LinkInertia, 6> inertias = {
      LinkInertia{2.0, {0, -0.02, 0}, 0.008093166666666665, 0.005625, 0.008093166666666665},
      LinkInertia{3.42, {0.13, 0, 0.1157}, 0.00961875, 0.021728491912499998, 0.021728491912499998},
      LinkInertia{1.26, {0.05, 0, 0.0238}, 0.00354375, 0.0065468090625, 0.0065468090625},
      LinkInertia{0.8, {0, 0, 0.01}, 0.0016106414999999998, 0.00225, 0.0016106414999999998},
      LinkInertia{0.8, {0, 0, 0.01}, 0.0015721739999999998, 0.00225, 0.0015721739999999998},
      LinkInertia{0.35, {0, 0, -0.02}, 0.00013626666666666665, 0.00013626666666666665, 0.0001792}};
  static constexpr auto max_velocity =
      three_and_wrist(turn_per_second / 2, turn_per_second / 2, turn_per_second / 2, turn_per_second);
  static constexpr auto max_torque = three_and_wrist(56, 56, 28, 12);
};

struct Ur3eTable {
  static constexpr auto rows = universal_rows(0.15185, -0.24355, -0.2132, 0.13105, 0.08535, 0.0921);
  static constexpr std::array<LinkInertia, 6> inertias = {
      LinkInertia{1.98, {0, -0.02, 0}, 0.0027657, 0.0021501, 0.0025626, 0.0000096, -0.0000149, 0.0001873},
      LinkInertia{
          3.4445, {0.13, 0, 0.1157}, 0.0042623, 0.0460284, 0.0448947, -0.0000409, -0.0014960, -0.0000129},
      LinkInertia{1.437, {0.05, 0, 0.0238}, 0.0010511, 0.0113396, 0.0110895, 0, -0.0000331, 0.0000022},
      LinkInertia{0.871, {0, 0, 0.01}, 0.0008174, 0.0006844, 0.0005497, -0.0000005, 0.0000021, 0.0000617},
      LinkInertia{0.805, {0, 0, 0.01}, 0.0006059, 0.0005837, 0.0003831, -0.0000006, -0.0000006, -0.0000271},
      LinkInertia{0.261, {0, 0, -0.02}, 0.0001080, 0.0001086, 0.0001371, -0.0000001, -0.0000001, -0.0000002}};
  static constexpr auto max_velocity = Ur3Table::max_velocity;
  static constexpr auto max_torque = Ur3Table::max_torque;
};

struct Ur5eTable {
  static constexpr auto rows = universal_rows(0.1625, -0.425, -0.3922, 0.1333, 0.0997, 0.0996);
  static constexpr std::array<LinkInertia, 6> inertias = {
      LinkInertia{3.761,
                  {0, -0.02561, 0.00193},
                  0.00700210,
                  0.00648091,
                  0.00657286,
                  0.00000073,
                  -0.00001053,
                  0.00049994},
      LinkInertia{8.058,
                  {0.2125, 0, 0.11336},
                  0.01505885,
                  0.33388086,
                  0.33247207,
                  -0.00005400,
                  0.00000563,
                  -0.00000181},
      LinkInertia{
          2.846, {0.15, 0, 0.0265}, 0.00399632, 0.07879254, 0.07848510, -0.00001365, 0.00137272, -0.00000660},
      LinkInertia{1.37,
                  {0, -0.0018, 0.01634},
                  0.00165491,
                  0.00135962,
                  0.00126279,
                  -0.00000282,
                  -0.00000438,
                  0.00010157},
      LinkInertia{1.3,
                  {0, 0.0018, 0.01634},
                  0.00135617,
                  0.00127827,
                  0.00096614,
                  -0.00000274,
                  0.00000444,
                  -0.00005048},
      LinkInertia{0.365,
                  {0, 0, -0.001159},
                  0.00018694,
                  0.00018908,
                  0.00025756,
                  0.00000006,
                  -0.00000017,
                  -0.00000092}};
  static constexpr auto max_velocity =
      three_and_wrist(turn_per_second / 2, turn_per_second / 2, turn_per_second / 2, turn_per_second / 2);
  static constexpr auto max_torque = three_and_wrist(150, 150, 150, 28);
};

// UR10 and UR10e share their tensors in the source ("extracted from URSim").
constexpr std::array<LinkInertia, 6> ur10_inertias(const std::array<double, 6>& mass,
                                                   const std::array<double, 6>& along_x) noexcept {
  return {LinkInertia{mass[0], {along_x[0], 0, 0.027}, 0.03408, 0.03529, 0.02156, 0.00002, -0.00425, 0.00008},
          LinkInertia{mass[1], {along_x[1], 0, 0.158}, 0.02814, 0.77068, 0.76943, 0.00005, -0.01561, 0.00002},
          LinkInertia{mass[2], {along_x[2], 0, 0.068}, 0.01014, 0.30928, 0.30646, 0.00008, 0.00916, 0},
          LinkInertia{mass[3], {0, 0.007, 0.018}, 0.00296, 0.00222, 0.00258, -0.00001, 0, -0.00024},
          LinkInertia{mass[4], {0, 0.007, 0.018}, 0.00296, 0.00222, 0.00258, -0.00001, 0, -0.00024},
          LinkInertia{mass[5], {0, 0, -0.026}, 0.00040, 0.00041, 0.00034}};
}

struct Ur10Table {
  static constexpr auto rows = universal_rows(0.1273, -0.612, -0.5723, 0.163941, 0.1157, 0.0922);
  static constexpr auto inertias =
      ur10_inertias({7.1, 12.7, 4.27, 2.0, 2.0, 0.365}, {0.021, 0.38, 0.24, 0, 0, 0});
  static constexpr auto max_velocity =
      three_and_wrist(turn_per_second / 3, turn_per_second / 3, turn_per_second / 2, turn_per_second / 2);
  static constexpr auto max_torque = three_and_wrist(330, 330, 150, 56);
};

struct Ur10eTable {
  static constexpr auto rows = universal_rows(0.1807, -0.6127, -0.57155, 0.17415, 0.11985, 0.11655);
  static constexpr auto inertias =
      ur10_inertias({7.369, 13.051, 3.989, 2.1, 1.98, 0.615}, {0.021, 0.38, 0.24, 0, 0, 0});
  static constexpr auto max_velocity = Ur10Table::max_velocity;
  static constexpr auto max_torque = Ur10Table::max_torque;
};
}  // namespace detail

/// Universal Robots' UR3 (CB3).
namespace ur3 {
using Description = UniversalRobot<detail::Ur3Table>;
using Model = StaticModel<Description>;
template <Scalar T = double>
using Calibrated = CalibratedModel<Description, T>;
}  // namespace ur3

/// Universal Robots' UR10 (CB3).
namespace ur10 {
using Description = UniversalRobot<detail::Ur10Table>;
using Model = StaticModel<Description>;
template <Scalar T = double>
using Calibrated = CalibratedModel<Description, T>;
}  // namespace ur10

/// Universal Robots' UR3e.
namespace ur3e {
using Description = UniversalRobot<detail::Ur3eTable>;
using Model = StaticModel<Description>;
template <Scalar T = double>
using Calibrated = CalibratedModel<Description, T>;
}  // namespace ur3e

/// Universal Robots' UR5e.
namespace ur5e {
using Description = UniversalRobot<detail::Ur5eTable>;
using Model = StaticModel<Description>;
template <Scalar T = double>
using Calibrated = CalibratedModel<Description, T>;
}  // namespace ur5e

/// Universal Robots' UR10e.
namespace ur10e {
using Description = UniversalRobot<detail::Ur10eTable>;
using Model = StaticModel<Description>;
template <Scalar T = double>
using Calibrated = CalibratedModel<Description, T>;
}  // namespace ur10e

SKINCTL_END_NAMESPACE
