// Links of real robots stand where their files put them, and a skin placed in them is where it was placed.
//
// Promise: a skin placed on a link of a URDF is on that link, and a press pushes the arm away
// Tried: joint frames of UR5, Z1, Jaco, Go2, TALOS, a Panda with its hand; by velocity and by torque.
// Also: `io/urdf_test.cpp`

#include <doctest/doctest.h>

#include "skinctl/io/urdf.hpp"
#include "skinctl/skinctl.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"
#include "tests/support/urdf_robots.hpp"
#include "tests/support/worst_torque.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

struct Legs {
  static constexpr std::size_t joints = 12;
  static constexpr std::array<int, 12> parents = {-1, 0, 1, -1, 3, 4, -1, 6, 7, -1, 9, 10};
  static constexpr auto kinds = all_of_kind<12>(JointKind::revolute);
};

template <class M>
std::vector<Eigen::Isometry3d> poses_of(const M& model, const JointPosition<M::joints>& q) {
  std::vector<Eigen::Isometry3d> X;
  const auto poses = link_poses(model, q);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (X.push_back(as_eigen(poses.template get<I>())), ...);
  }(std::make_index_sequence<M::joints>{});
  return X;
}
Eigen::Isometry3d pose_of(const UrdfFrame& frame) {
  return as_eigen(Transform<Base, NamedFrame<"any">>(frame.R, frame.p));
}
std::map<std::string, double> positions(const Urdf& urdf, const double* q) {
  std::map<std::string, double> at;
  for (std::size_t i = 0; i < urdf.joints.size(); ++i) at[urdf.joints[i].name] = q[i];
  return at;
}

/// The largest difference of any number of any link's pose from the file's, over random states.
template <class Tree>
double worst_frame(const FileRobot& robot, const std::map<std::string, double>& standing = {}) {
  UrdfOptions options;
  for (const auto& [joint, position] : standing) options.locked[joint] = position;
  const Urdf urdf = parse_urdf(file_text(robot), robot.name, options);
  CHECK(urdf.warnings.empty());
  CHECK(urdf.frames.size() == robot.joints.size() + 1);
  const auto model = calibrated_from<Tree>(urdf);
  oracle::Random random(7);
  double worst = 0;
  for (int k = 0; k < 50; ++k) {
    JointPosition<Tree::joints> q;
    for (double& x : q) x = random.uniform(-3, 3);
    auto at = positions(urdf, q.data);
    at.insert(standing.begin(), standing.end());
    const auto expected = file_poses(robot, at);
    const auto links = poses_of(model, q);
    for (const UrdfFrame& f : urdf.frames) {
      const Eigen::Isometry3d X =
          f.joint < 0 ? pose_of(f) : Eigen::Isometry3d(links[std::size_t(f.joint)] * pose_of(f));
      const double error = (X.matrix() - expected.at(f.name).matrix()).cwiseAbs().maxCoeff();
      worst = error <= worst ? worst : error;
    }
  }
  CHECK(worst_torque(model, oracle::without_fixed(file_table(robot, standing)), 20, 3) <= 1e-12);
  return worst;
}

/// What a press of 10 N on a cell does to the point of the file's link where it was placed.
struct Pressed {
  double distance;      ///< of the cell from that point [m]
  double acceleration;  ///< of that point along the outward normal there [m/s^2]
};
template <class M, std::size_t I>
Pressed press(const M& model, const JointPosition<M::joints>& q, const Patch<I, 1>& patch,
              const FileRobot& file, const std::map<std::string, Eigen::Isometry3d>& at,
              const Eigen::Isometry3d& X_BC) {
  const Eigen::Isometry3d cell = poses_of(model, q)[I] * as_eigen(patch.placed()[0].X_LC);

  const Skin<M, double, Patch<I, 1>> skin(patch);
  auto memory = skin.start(0ms);
  const CellSample sample{.time = 2ms, .cell = 1, .force = {0.3f, 0.3f, 0.3f}};
  typename Skin<M, double, Patch<I, 1>>::Wrenches wrenches;
  skin.receive(memory, {&sample, 1}, 2ms, 4ms, 1, &wrenches);
  const auto ddq = forward_dynamics(model, q, JointVelocity<M::joints>{},
                                    skin_torque(model, q, wrenches) + gravity_torque(model, q))
                       .acceleration;
  // By definition, from the file: the joints are revolute, and all of them carry the link.
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  std::size_t i = 0;
  for (const FileJoint& j : file.joints) {
    if (j.type == "fixed") continue;
    const Eigen::Isometry3d& X = at.at(j.child);
    a += (X.linear() * Eigen::Vector3d(j.axis.data())).cross(X_BC.translation() - X.translation()) * ddq[i++];
  }
  return {(cell.translation() - X_BC.translation()).norm(), a.dot(X_BC.linear().col(2))};
}

}  // namespace

TEST_CASE("URDF frames: UR5, Z1, Jaco, Go2, TALOS and Panda stand where their files put them") {
  CHECK(worst_frame<Chain<6>>(ur5_file()) <= 1e-12);
  CHECK(worst_frame<Chain<6>>(z1_file()) <= 1e-12);
  CHECK(worst_frame<Chain<6>>(jaco_file()) <= 1e-12);
  CHECK(worst_frame<Legs>(go2_file()) <= 1e-12);
  CHECK(worst_frame<Chain<6>>(talos_file()) <= 1e-12);
  CHECK(worst_frame<Chain<7>>(panda_file(), {{"panda_finger_joint1", 0.03}}) <= 1e-12);
}

TEST_CASE("URDF frames: a cell placed in a link of the file is there, and the arm gives way to the finger") {
  const FileRobot file = ur5_file();
  const Urdf urdf = parse_urdf(file_text(file), "ur5.urdf");
  const auto arm = calibrated_from<Chain<6>>(urdf);
  // A face of the wrist's housing that looks along the z of wrist_3_link.
  const auto X_NC = Transform<NamedFrame<"wrist_3_link">, Cell>::translation_xyz(0, 0.08, 0.06);
  const auto by_name = patch_on<5, "wrist_3_link">(urdf, {{1, X_NC}}, {.force = 10});
  // The same numbers taken for a pose in the model's own frame: what the types do not let happen.
  const Patch<5, 1> by_number({{1, X_NC.renamed<Link<5>, Cell>()}}, {.force = 10});

  oracle::Random random(5);
  int into_the_finger = 0;
  for (int k = 0; k < 200; ++k) {
    JointPosition<6> q;
    for (double& x : q) x = random.uniform(-3, 3);
    const auto at = file_poses(file, positions(urdf, q.data));
    const Eigen::Isometry3d X_BC = at.at("wrist_3_link") * as_eigen(X_NC);
    const Pressed right_one = press(arm, q, by_name, file, at, X_BC);
    CAPTURE(k);
    CHECK(right_one.distance <= 1e-14);
    CHECK(right_one.acceleration < 0);
    const Pressed wrong_one = press(arm, q, by_number, file, at, X_BC);
    CHECK(wrong_one.distance == doctest::Approx(0.1 * std::sqrt(2.0)));
    into_the_finger += wrong_one.acceleration > 0;
  }
  CHECK(into_the_finger > 20);
}

TEST_CASE("URDF frames: links by name, behind fixed joints and on the base too") {
  const Urdf urdf = parse_urdf(file_text(ur5_file()), "ur5.urdf");
  const auto tool = named_link_pose<5, "tool0">(urdf);
  static_assert(std::same_as<decltype(tool), const Transform<Link<5>, NamedFrame<"tool0">>>);
  const auto wrist = named_link_pose<5, "wrist_3_link">(urdf);
  CHECK((as_eigen(tool.origin()) - wrist.rotation() * Eigen::Vector3d(0, 0.0823, 0) - wrist.translation())
            .norm() <= 1e-15);
  const auto base = named_link_pose<"base">(urdf);
  static_assert(std::same_as<decltype(base), const Transform<Base, NamedFrame<"base">>>);
  CHECK(base.axis_x().x == doctest::Approx(-1));
  const auto cells = patch_on<2, "forearm_link">(
      urdf, {{7, Transform<NamedFrame<"forearm_link">, Cell>::translation_xyz(0, 0, 0.1)},
             {8, Transform<NamedFrame<"forearm_link">, Cell>::translation_xyz(0, 0, 0.2)}});
  CHECK(cells.placed().size() == 2);
  CHECK(cells.placed()[1].id == 8);
  CHECK(named_link_pose<2, "forearm_link", float>(urdf).origin().x == 0.0f);

  using Name = NamedFrame<"unterarm größe">;
  static_assert(Name::name == "unterarm größe");
  static_assert(!std::same_as<NamedFrame<"class">, NamedFrame<"Class">>);
}

TEST_CASE("URDF frames: a link that is not there, or on another joint, is refused by its name") {
  const Urdf urdf = parse_urdf(file_text(ur5_file()), "ur5.urdf");
  CHECK_THROWS_WITH_AS(
      static_cast<void>(named_link_pose<5, "wrist_3">(urdf)),
      "skinctl: ur5.urdf: no link \"wrist_3\" below the base \"world\"; there are \"world\", \"base_link\", "
      "\"shoulder_link\", \"upper_arm_link\", \"forearm_link\", \"wrist_1_link\", \"wrist_2_link\", "
      "\"wrist_3_link\", \"ee_link\" and 2 more",
      ConfigurationError);
  CHECK_THROWS_WITH_AS(static_cast<void>(named_link_pose<4, "wrist_3_link">(urdf)),
                       "skinctl: ur5.urdf: link \"wrist_3_link\" is carried by joint 5 (\"wrist_3_joint\"), "
                       "the program expects it on joint 4",
                       ConfigurationError);
  CHECK_THROWS_WITH_AS(static_cast<void>(named_link_pose<0, "base">(urdf)),
                       "skinctl: ur5.urdf: link \"base\" is carried by no joint, the program expects it on "
                       "joint 0",
                       ConfigurationError);
  CHECK_THROWS_WITH_AS(static_cast<void>(named_link_pose<"tool0">(urdf)),
                       "skinctl: ur5.urdf: link \"tool0\" is carried by joint 5 (\"wrist_3_joint\"), the "
                       "program expects it fixed to the base",
                       ConfigurationError);
}
