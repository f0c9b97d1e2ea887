// A header made from names that are no identifiers: links are found by their names, and stand where they
// should.
#include "names.hpp"

#include <Eigen/Geometry>
#include <cstdio>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/tactile/named_patch.hpp"

using namespace skinctl;
using Eigen::AngleAxisd, Eigen::Translation3d, Eigen::Vector3d;

static_assert(robot_class::Description::joints == 2);
static_assert(named_link_index<robot_class::Description, "Arm \"ü\"">() == 0);
static_assert(named_link_index<robot_class::Description, "a-b">() == 0);  // locked: it moves with the arm
static_assert(named_link_index<robot_class::Description, "std">() == 1);
static_assert(named_link_index<robot_class::Description, "a_b">() == 1);
static_assert(
    std::same_as<decltype(robot_class::X_LN<"double">), const Transform<Link<1>, NamedFrame<"double">>>);
static_assert(
    std::same_as<decltype(robot_class::X_LN<"2nd floor">), const Transform<Base, NamedFrame<"2nd floor">>>);

int main() {
  const double q0 = 0.4, q1 = -1.3;
  const auto poses = link_poses(robot_class::Model{}, JointPosition<2>{q0, q1});
  const auto finger = as_eigen(poses.get<1>() * robot_class::X_LN<"double">);
  const Eigen::Isometry3d expected = Translation3d(0, 0, 0.5) * AngleAxisd(0.3, Vector3d::UnitZ()) *
                                     AngleAxisd(q0, Vector3d::UnitY()) * Translation3d(0.3, 0, 0) *
                                     AngleAxisd(0.5, Vector3d::UnitZ()) * Translation3d(0.2, 0, 0) *
                                     AngleAxisd(q1, Vector3d::UnitX()) * Translation3d(0.1, -0.02, 0);
  const double error = (finger.matrix() - expected.matrix()).cwiseAbs().maxCoeff();

  const auto X_NC = Transform<NamedFrame<"double">, Cell>::translation_xyz(0, 0, 0.01);
  const auto patch = patch_on<robot_class::Description, "double">({{4, X_NC}}, {.force = 5});
  static_assert(decltype(patch)::link == 1 && decltype(patch)::cells == 1);
  const auto cell = (poses.get<1>() * patch.placed()[0].X_LC).origin();
  const Vector3d place = expected * Vector3d(0, 0, 0.01);
  const double off = (as_eigen(cell) - place).norm();
  std::printf("link off by %.2g, cell by %.2g m\n", error, off);
  return error <= 1e-14 && off <= 1e-14 ? 0 : 1;
}
