// Promise: what a skin file says is used
// Tried: a masked cell neither pushes nor counts as usable, and a trusted skin fills it in within 2 %;
// ports are the neighbours; a region that is pressed harder than its `force_limit` stops the robot (19.8
// N: no, 20.2 N: yes, of 20), the main job refuses one; covariances bound how far off a cell may be.
// Also: `examples/compliant_ur5/tests/main_job_test.cpp`
//
// Promise: a skin from a file is where its links' frames put it, or is refused
// Tried: UR5 built in and by URDF: 1e-8 m (the description's quarter turns), 1e-12 m; a description with
// equal names and other axes is refused

#include "skinctl/io/skin_placement.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "skinctl/io/skin_export.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/tactile/contact_skin.hpp"
#include "skinctl/tactile/trusted_skin.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/urdf_robots.hpp"
#include "tests/support/wrong_text.hpp"

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

/// The largest difference of any number of any cell's pose in the base from where the description of the
/// robot and the file put it.
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
      CHECK_FALSE((a.gains || a.gate[0] || a.gate[1]));
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
  CHECK(complaint_of([&] { static_cast<void>(place_skin(file, ros1)); })
            .find("patch \"upper arm\", link \"upper_arm_link\": the joint's axis is (0, 1, 0) in the "
                  "robot's frame of that "
                  "name and (0, 0, 1) in the file's: another description") != std::string::npos);
  SkinFile other = file;
  other.links[5].name = other.patches[5].link = "wrist_4_link";
  CHECK(complaint_of([&] { static_cast<void>(place_skin<ur5::Ros2Links>(other)); })
            .find("patch \"wrist 3\", link \"wrist_4_link\": the robot has no such link; there are "
                  "\"shoulder_link\"") != std::string::npos);
  const Urdf urdf = parse_urdf(file_text(ros2_ur5()), "ur5.urdf");
  CHECK(complaint_of([&] { static_cast<void>(place_skin(other, urdf)); }).find("ur5.urdf has no such link") !=
        std::string::npos);
  other.links[5].name = other.patches[5].link = "base_link_inertia";
  CHECK(complaint_of([&] { static_cast<void>(place_skin(other, urdf)); }).find("no joint moves it") !=
        std::string::npos);
  CHECK(complaint_of([&] {
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

TEST_CASE("Skin on a robot: a masked cell is no part of what feels, and is filled in by its neighbours") {
  SkinFile file = ur5_skin_file<60>(gains);
  auto& cells = file.patches[2].cells;
  const auto placed = place_skin<ur5::Ros2Links>(file);
  using Skin = SkinOf<ur5::Model, double, 64>;
  // All cells are heard; those around the masked one are pressed alike, so that it counts as they do.
  const auto heard = [&](const auto& skin, auto memory, typename Skin::Wrenches& w) {
    for (int k = 1; k <= 100; ++k) {
      std::vector<CellSample> samples;
      for (const auto& patch : file.patches)
        for (const auto& cell : patch.cells) {
          const float f = &patch == &file.patches[2] && k > 50 ? 0.1f : 0.0f;
          samples.push_back({.time = k * 4ms, .cell = cell.id, .force = {f, f, f}});
          samples.back().acceleration[0] = float(k % 7);
        }
      skin.receive(memory, samples, (k - 1) * 4ms, k * 4ms, 1, &w);
    }
    return memory;
  };
  TrustSettings trust;
  trust.lone_force = {std::numeric_limits<double>::infinity()};
  trust.follow_rest = trust.find_faults = false;
  typename Skin::Wrenches all, left, filled;
  {
    const Skin skin(skin_patches(file, placed));
    const auto m = heard(skin, skin.start(0ns), all);
    CHECK(skin.coverage(m).usable == 60);
    CHECK(skin.coverage(m).blind_patches == 0);
    CHECK(skin.noticed(m, skin.index(cells[1].id)) < 0.2);
  }
  cells[1].masked = "dead since May";
  const Skin skin(skin_patches(file, placed));
  const auto m = heard(skin, skin.start(0ns), left);
  CHECK(skin.silent(m) == 0);
  CHECK(skin.coverage(m).usable == 59);
  CHECK(skin.coverage(m).cells == 60);
  CHECK(skin.noticed(m, skin.index(cells[1].id)) > 1e300);
  const TrustedSkin trusted(skin, trust, FillIn(cell_graph(file, placed), skin.places()));
  const auto t = heard(trusted, trusted.start(0ns), filled);
  CHECK(trusted.coverage(t).usable == 59);
  CHECK(trusted.mask(t, trusted.index(cells[1].id)) == 1);
  double without = 0, difference = 0;
  for (std::size_t r = 0; r < 6; ++r) {
    without += std::abs(all.data[2][r] - left.data[2][r]);
    difference += std::abs(all.data[2][r] - filled.data[2][r]);
  }
  CHECK(without > 5);
  CHECK(difference <= 0.02 * without);
  std::size_t pressed = 0;
  double push = 0;
  trusted.each_pressed(t, [&](std::size_t, double f) { ++pressed, push += f; });
  CHECK(pressed == cells.size());
  CHECK(push == doctest::Approx(double(cells.size()) * 50 * (0.3 - 0.08)).epsilon(0.01));
}

TEST_CASE("Skin on a robot: neighbours are those at the ports of the file, or those near by") {
  SkinFile file = ur5_skin_file<60>(gains);
  const auto placed = place_skin<ur5::Ros2Links>(file);
  const CellGraph by_port = cell_graph(file, placed);
  std::map<std::uint32_t, std::size_t> index;
  std::vector<const SkinFile::Cell*> cells;
  for (const auto& patch : file.patches)
    for (const auto& cell : patch.cells) index[cell.id] = cells.size(), cells.push_back(&cell);
  REQUIRE(by_port.size() == cells.size());
  std::size_t named = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::size_t n = 0;
    for (const std::uint32_t id : cells[i]->neighbours)
      if (id != SkinFile::nobody) {
        ++n;
        CHECK(by_port.joined(i, index[id]));
      }
    CHECK(by_port.neighbours(i).size() == n);
    named += n;
  }
  CHECK(named > 40);
  // A cut cable: two cells that lie side by side are no neighbours, because the file says so.
  auto& a = file.patches[2].cells[0];
  const auto port = std::find_if(a.neighbours.begin(), a.neighbours.end(),
                                 [](std::uint32_t id) { return id != SkinFile::nobody; });
  REQUIRE(port != a.neighbours.end());
  const std::uint32_t other = *port;
  *port = SkinFile::nobody;
  for (auto& cell : file.patches[2].cells)
    if (cell.id == other)
      std::replace(cell.neighbours.begin(), cell.neighbours.end(), a.id, SkinFile::nobody);
  CHECK_FALSE(cell_graph(file, placed).joined(index[a.id], index[other]));
  // A patch of its own, of whose neighbours the file says nothing: those near by, whatever theirs say.
  SkinFile apart = file;
  auto& rest = apart.patches[2].cells;
  for (auto& cell : rest)
    std::replace(cell.neighbours.begin(), cell.neighbours.end(), a.id, SkinFile::nobody);
  SkinFile::Patch later = apart.patches[2];
  later.name = "glued on later", later.cells.resize(1), later.cells[0].neighbours.clear();
  rest.erase(rest.begin());
  apart.patches.push_back(later);
  const auto near_by = place_skin<ur5::Ros2Links>(apart);
  index.clear();
  for (const auto& patch : apart.patches)
    for (const auto& cell : patch.cells) index.emplace(cell.id, index.size());
  CHECK(cell_graph(apart, near_by).joined(index[a.id], index[other]));
  for (auto& patch : file.patches)
    for (auto& cell : patch.cells) cell.neighbours.clear();
  const SkinOf<ur5::Model, double, 64> skin(skin_patches(file, placed));
  CHECK(cell_graph(file, placed) == CellGraph(skin.places()));
}

TEST_CASE("Skin on a robot: a region that is pressed harder than its force_limit stops the robot") {
  SkinFile file = ur5_skin_file<60>(gains);
  auto& cells = file.patches[2].cells;  // forearm: 50 N
  // Each counts half in the law; the limit is of newtons all the same.
  file.regions = {{"elbow", {cells[0].id, cells[1].id}, 0.5, 20, 0}};
  const auto placed = place_skin<ur5::Ros2Links>(file);
  const SkinOf<ur5::Model, double, 64> skin(skin_patches(file, placed));
  TrustSettings trust;
  trust.lone_force = {std::numeric_limits<double>::infinity()};
  trust.follow_rest = false;
  const TrustedSkin trusted(skin, trust, FillIn(cell_graph(file, placed)));
  const auto stops = [&](const auto& felt, std::size_t cell, double newtons) {
    auto m = std::make_unique<typename std::remove_cvref_t<decltype(felt)>::Memory>(felt.start(0ns));
    const auto f = static_cast<float>((newtons / 50 + 0.08) / 3);
    const CellSample sample{.time = 2ms, .cell = cells[cell].id, .force = {f, f, f}};
    SkinOf<ur5::Model, double, 64>::Wrenches mean;
    felt.receive(*m, {&sample, 1}, 0ns, 4ms, 1, &mean);
    return felt.receive(*m, {}, 4ms, 8ms, 1, &mean).has(Reason::contact_force);
  };
  const ContactSkin plain(skin, cell_graph(file, placed), regions_of(file));
  const ContactSkin judged(trusted, cell_graph(file, placed), regions_of(file));
  for (const bool both : {false, true})
    for (const std::size_t cell : {std::size_t(0), std::size_t(1)}) {
      CHECK_FALSE((both ? stops(judged, cell, 19.8) : stops(plain, cell, 19.8)));
      CHECK((both ? stops(judged, cell, 20.2) : stops(plain, cell, 20.2)));
    }
  CHECK_FALSE(stops(plain, 2, 45));  // beside it
  file.regions[0].weight = 0;
  CHECK(complaint_of([&] { static_cast<void>(regions_of(file)); }).find("region \"elbow\" of weight 0") !=
        std::string::npos);
}

TEST_CASE("Skin on a robot: how far off a cell may be, from the covariances of its file") {
  SkinFile::Patch patch;
  SkinFile::Cell cell;
  cell.X_RootCell.p = {0.0, 0.2, 0.0};
  const auto exact = place_deviation(patch, cell);
  CHECK(exact.place == 0);
  CHECK(exact.direction == 0);
  const auto diagonal = [](std::array<double, 6> sigma) {
    std::vector<double> C;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = i; j < 6; ++j) C.push_back(i == j ? sigma[i] * sigma[i] : 0);
    return C;
  };
  patch.covariance = diagonal({0.001, 0.003, 0.002, 0.01, 0.0, 0.0});
  cell.covariance = diagonal({0.0, 0.0, 0.004, 0.0, 0.02, 0.0});
  const auto off = place_deviation(patch, cell);
  CHECK(off.place == doctest::Approx(std::hypot(0.003 + 0.2 * 0.01, 0.004)));
  CHECK(off.direction == doctest::Approx(std::hypot(0.01, 0.02)));
}
