#include "skinctl/io/skin_placement.hpp"

#include <doctest/doctest.h>

#include "skinctl/io/skin_export.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/testing/robot_table.hpp"
#include "tests/support/urdf_robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::array<CellGains, 6> gains = {{{60, 1}, {70, 2}, {50, 3}, {25, 4}, {15, 5}, {10, 6}}};

/// UR ROS 2 description, config/ur5/default_kinematics.yaml.
FileRobot ros2_ur5() {
  constexpr double quarter = 1.570796327, half = 3.141592653589793;
  const std::array<double, 3> z = {0, 0, 1};
  return {
      "ur5",
      "base_link_inertia",
      {{"shoulder_pan_joint", "revolute", "base_link_inertia", "shoulder_link", {0, 0, 0.089159}, {}, z},
       {"shoulder_lift_joint", "revolute", "shoulder_link", "upper_arm_link", {}, {quarter, 0, 0}, z},
       {"elbow_joint", "revolute", "upper_arm_link", "forearm_link", {-0.425, 0, 0}, {}, z},
       {"wrist_1_joint", "revolute", "forearm_link", "wrist_1_link", {-0.39225, 0, 0.10915}, {}, z},
       {"wrist_2_joint", "revolute", "wrist_1_link", "wrist_2_link", {0, -0.09465, 0}, {quarter, 0, 0}, z},
       {"wrist_3_joint",
        "revolute",
        "wrist_2_link",
        "wrist_3_link",
        {0, 0.0823, 0},
        {quarter, half, half},
        z},
       {"wrist_3-flange", "fixed", "wrist_3_link", "flange", {}, {0, -quarter, -quarter}},
       {"flange-tool0", "fixed", "flange", "tool0", {}, {quarter, 0, quarter}}}};
}

Eigen::Isometry3d isometry(const SkinPose& X) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = Eigen::Quaterniond(X.q[3], X.q[0], X.q[1], X.q[2]).normalized().toRotationMatrix();
  out.translation() = Eigen::Vector3d(X.p.x, X.p.y, X.p.z);
  return out;
}

/// The largest difference of any number of any cell's pose in the base from where the description of the robot
/// and the file put it.
template <class M>
double worst_cell(const SkinFile& file, const std::vector<PlacedSkinPatch>& placed, const M& model,
                  const FileRobot& robot) {
  oracle::Random random(7);
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    JointPosition<6> q;
    std::map<std::string, double> at;
    for (std::size_t i = 0; i < 6; ++i) at[robot.joints[i].name] = q[i] = random.uniform(-3, 3);
    const auto expected = file_poses(robot, at);
    std::vector<Eigen::Isometry3d> links;
    const auto poses = link_poses(model, q);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (links.push_back(as_eigen(poses.template get<I>())), ...);
    }(std::make_index_sequence<6>{});
    for (const PlacedSkinPatch& p : placed) {
      const SkinFile::Patch& patch = file.patches[p.patch];
      for (std::size_t c = 0; c < patch.cells.size(); ++c) {
        CHECK(p.cells[c].id == patch.cells[c].id);
        const Eigen::Isometry3d X = links[p.link] * as_eigen(p.cells[c].X_LC);
        const Eigen::Isometry3d Y =
            expected.at(patch.link) * isometry(patch.X_LinkRoot) * isometry(patch.cells[c].X_RootCell);
        const double error = (X.matrix() - Y.matrix()).cwiseAbs().maxCoeff();
        worst = error <= worst ? worst : error;
      }
    }
  }
  return worst;
}

template <class F>
std::string complaint(const F& f) {
  try {
    f();
  } catch (const ConfigurationError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE(
    "Skin on a robot: a file's cells are where its frames put them, in the built-in UR5 and in one from a "
    "URDF") {
  const SkinFile file = parse_skin_file(skin_file_text(ur5_skin_file<60>(gains)), "ur5.json");
  const FileRobot robot = ros2_ur5();
  CHECK(worst_cell(file, place_skin<ur5::Ros2Links>(file), ur5::Model{}, robot) <=
        1e-8);  // of the quarter turns
  const Urdf urdf = parse_urdf(file_text(robot), "ur5.urdf");
  CHECK(worst_cell(file, place_skin(file, urdf), calibrated_from<Chain<6>>(urdf), robot) <= 1e-12);
}

TEST_CASE("Skin on a robot: the UR5's skin comes out of its file as it went in, to a nanometre") {
  const SkinFile file = parse_skin_file(skin_file_text(ur5_skin_file<260>(gains)));
  CHECK(file.cells() == 260);
  const auto placed = place_skin<ur5::Ros2Links>(file);
  const auto patches = ur5::skin_patches<260>(gains);
  double place = 0, axes = 0;
  const auto made = skin_patches(file, placed);
  const auto compare = [&](const auto& expected, const SkinPatch& patch) {
    CHECK(patch.link == expected.link);
    CHECK(patch.gains.force == expected.gains().force);
    CHECK(patch.gains.proximity == expected.gains().proximity);
    REQUIRE(patch.cells.size() == expected.cells);
    for (std::size_t c = 0; c < expected.cells; ++c) {
      const auto& a = patch.cells[c];
      const auto& b = expected.any()[c];
      CHECK(a.id == b.id);
      CHECK_FALSE((a.gains || a.force || a.proximity));
      const Xyz<double> off = a.X_LC.origin() - b.X_LC.origin();
      place = std::max(place, std::sqrt(dot(off, off)));
      axes = std::max(axes, (as_eigen(a.X_LC.axes()) - as_eigen(b.X_LC.axes())).cwiseAbs().maxCoeff());
    }
  };
  std::size_t k = 0;
  std::apply([&](const auto&... patch) { (compare(patch, made[k++]), ...); }, patches);
  CHECK(place <= 2e-9);
  CHECK(axes <= 5e-9);
}

TEST_CASE("Skin on a robot: neighbours of a written file are one pitch away, half of the cells have four") {
  const SkinFile file = ur5_skin_file<260>(gains);
  std::map<std::uint32_t, Xyz<double>> place;
  for (const auto& patch : file.patches)
    for (const auto& cell : patch.cells) place[cell.id] = cell.X_RootCell.p;
  std::size_t four = 0;
  for (const auto& patch : file.patches)
    for (const auto& cell : patch.cells) {
      std::size_t n = 0;
      for (const std::uint32_t id : cell.neighbours) {
        if (id == SkinFile::nobody) continue;
        ++n;
        const Xyz<double> d = place[id] - place[cell.id];
        CHECK(std::sqrt(dot(d, d)) < 1.001 * HexagonalCell::flat_pitch);
        CHECK(std::sqrt(dot(d, d)) > 0.9 * HexagonalCell::flat_pitch);
      }
      four += n == 4;
    }
  CHECK(four > 120);
}

TEST_CASE("Skin on a robot: it cannot land elsewhere") {
  const SkinFile file = ur5_skin_file<60>(gains);
  // Links of the same names, whose frames have other axes.
  const Urdf ros1 = parse_urdf(file_text(ur5_file()), "ros1.urdf");
  CHECK(complaint([&] { static_cast<void>(place_skin(file, ros1)); })
            .find("patch \"upper arm\", link \"upper_arm_link\": the joint's axis is (0, 1, 0) in the "
                  "robot's frame of that "
                  "name and (0, 0, 1) in the file's: another description") != std::string::npos);
  SkinFile other = file;
  other.links[5].name = other.patches[5].link = "wrist_4_link";
  CHECK(complaint([&] { static_cast<void>(place_skin<ur5::Ros2Links>(other)); })
            .find("patch \"wrist 3\", link \"wrist_4_link\": the robot has no such link; there are "
                  "\"shoulder_link\"") != std::string::npos);
  const Urdf urdf = parse_urdf(file_text(ros2_ur5()), "ur5.urdf");
  CHECK(complaint([&] { static_cast<void>(place_skin(other, urdf)); }).find("ur5.urdf has no such link") !=
        std::string::npos);
  other.links[5].name = other.patches[5].link = "base_link_inertia";
  CHECK(complaint([&] { static_cast<void>(place_skin(other, urdf)); }).find("no joint moves it") !=
        std::string::npos);
  CHECK(complaint([&] {
          SkinFile f;
          add_patch<ur5::Ros2Links>(f, "x", "forearm_link", std::get<3>(ur5::skin_patches<60>()));
        }).find("\"forearm_link\" is not the name of link 3") != std::string::npos);
}

TEST_CASE(
    "Skin on a robot: gains, thresholds, regions and masks of a file are those of the skin that it fills") {
  SkinFile file = ur5_skin_file<60>(gains);
  auto& cells = file.patches[2].cells;  // forearm: 50 N and 3 N
  cells[0].gain = 0.5;
  cells[1].threshold = 0.2;
  cells[2].masked = "dead";
  file.regions = {{"soft", {cells[0].id, cells[3].id}, 0.5, 65, 0}, {"softer", {cells[0].id}, 0.5, 65, 0}};
  using Skin = SkinOf<ur5::Model, double, 64>;
  const Skin skin(skin_patches(file, place_skin<ur5::Ros2Links>(file)));
  // The force of each on a press of 0.3 in all: the reading above its threshold, times its gain.
  const double expected[5] = {50 * 0.125 * (0.3 - 0.08), 50 * (0.3 - 0.2), 0, 50 * 0.5 * (0.3 - 0.08),
                              50 * (0.3 - 0.08)};
  for (std::size_t c = 0; c < 5; ++c) {
    auto memory = skin.start(0ns);
    const CellSample sample{.time = 2ms, .cell = cells[c].id, .force = {0.1f, 0.1f, 0.1f}};
    Skin::Wrenches mean;
    skin.receive(memory, {&sample, 1}, 2ms, 4ms, 1, &mean);
    const auto wrenches = skin.wrenches(memory);
    const auto* w = wrenches.data[2];
    CHECK(std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) == doctest::Approx(expected[c]).epsilon(1e-3));
  }
}
