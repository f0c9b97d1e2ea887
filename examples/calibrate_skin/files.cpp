// The results of a calibration as files: a skin, a robot, a report.
#include <array>
#include <exception>
#include <map>
#include <stdexcept>

#include "examples/calibrate_skin/json_values.hpp"
#include "examples/calibrate_skin/masses.hpp"
#include "examples/calibrate_skin/report.hpp"
#include "examples/calibrate_skin/steps.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "skinctl/calibration/line_model.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf_writer.hpp"

namespace calibrate_skin {

using namespace skinctl;

namespace {

SkinPose skin_pose(const FitPose& X) {
  const Json j = json_of(X);
  const Json &p = j.at("p"), &q = j.at("q");
  return {{p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>()},
          {q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>()}};
}

/// Pose of a patch on the link as files name it.
SkinPose named_pose(const Robot::Link& link, const FitPose& X_LinkRoot) {
  return skin_pose(link.X_LinkNamed.inverse() * X_LinkRoot);
}
SkinFile::Link file_link(const Robot::Link& link) {
  const Eigen::Vector3d z = link.X_LinkNamed.R.row(2).transpose();
  return {link.name, link.radius, link.length, {z.x(), z.y(), z.z()}, 0};
}

/// Leaves the neighbours of a patch to places if no port of its cells is joined to another: ports say then
/// how it is wired, not who lies beside it and witnesses its touches.
void leave_open_if_alone(SkinFile::Patch& patch) {
  for (const auto& cell : patch.cells)
    for (const std::uint32_t id : cell.neighbours)
      if (id != SkinFile::nobody) return;
  for (auto& cell : patch.cells) cell.neighbours.clear();
}

}  // namespace

SkinFile skin_file_of(const Robot& robot, const Json& found) {
  SkinFile file;
  file.source = "calibrate_skin";
  std::map<std::uint32_t, bool> known;
  for (const auto& p : found.at("patches"))
    for (const auto& c : p.at("cells")) known[c.at("id").get<std::uint32_t>()] = true;
  for (const auto& p : found.at("patches")) {
    const auto l = p.at("link").get<std::size_t>();
    require(l < robot.links.size(), "link of a patch", double(l), "one of the robot's");
    const Robot::Link& link = robot.links[l];
    bool listed = false;
    for (const auto& other : file.links) listed = listed || other.name == link.name;
    if (!listed) file.links.push_back(file_link(link));
    SkinFile::Patch patch;
    patch.name = "patch of cell " + p.at("cells").at(0).at("id").dump();
    patch.link = link.name;
    patch.gains = {.force = link.gain, .proximity = 0};
    patch.X_LinkRoot = named_pose(link, pose_of(p.at("pose")));
    Matrix6d axes = Matrix6d::Identity();  // of places; turns are about the patch's own
    axes.topLeftCorner<3, 3>() = link.X_LinkNamed.R.transpose();
    patch.covariance =
        json_of(Matrix6d(axes * matrix_of(p.at("covariance")) * axes.transpose())).get<std::vector<double>>();
    for (const auto& c : p.at("cells")) {
      SkinFile::Cell cell;
      cell.id = c.at("id").get<std::uint32_t>();
      cell.X_RootCell = skin_pose(pose_of(c.at("pose")));
      if (!c.at("covariance").is_null()) cell.covariance = c.at("covariance").get<std::vector<double>>();
      for (const auto& n : c.at("neighbours")) {
        const auto id = n.at(0).get<std::uint32_t>();
        cell.neighbours.push_back(id == 0 || !known[id] ? SkinFile::nobody : id);
      }
      cell.masked = c.at("masked").get<std::string>();
      patch.cells.push_back(std::move(cell));
    }
    leave_open_if_alone(patch);
    file.patches.push_back(std::move(patch));
  }
  if (!file.patches.empty()) file.check();
  return file;
}

SkinFile true_skin_file(SkinFile file, const World& world) {
  file.source = "the truth";
  for (auto& patch : file.patches) {
    const World::Cell* root = world.find(std::uint16_t(patch.cells.front().id));
    if (root == nullptr)
      throw std::runtime_error("no cell answers to id " + std::to_string(patch.cells[0].id));
    const Robot::Link& link = ur5_robot().links[root->link];
    patch.link = link.name;
    patch.X_LinkRoot = named_pose(link, root->X_LinkCell);
    patch.covariance.clear();
    for (auto& cell : patch.cells) {
      cell.X_RootCell =
          skin_pose(root->X_LinkCell.inverse() * world.find(std::uint16_t(cell.id))->X_LinkCell);
      cell.covariance.clear(), cell.masked.clear();
    }
  }
  file.check();
  return file;
}

SkinFile worn_skin_file(const World& world) {
  SkinFile file;
  file.source = "the simulated skin";
  const auto& links = ur5_robot().links;
  for (std::size_t l = 0; l < links.size(); ++l) {
    const Robot::Link& link = links[l];
    SkinFile::Patch patch;
    patch.name = "skin of " + link.name;
    patch.link = link.name;
    patch.gains = {.force = link.gain, .proximity = 0};
    patch.X_LinkRoot = named_pose(link, {});
    for (const World::Cell& c : world.truth()) {
      if (c.link != l) continue;
      auto& cell = patch.cells.emplace_back();
      cell.id = c.id;
      cell.X_RootCell = skin_pose(c.X_LinkCell);
    }
    if (patch.cells.empty()) continue;
    file.links.push_back(file_link(link));
    file.patches.push_back(std::move(patch));
  }
  file.check();
  return file;
}

template <std::size_t N>
FoundAxes<N> axes_of(const Json& moved) {
  if (!moved.at("complete").get<bool>()) return {{}, "not all axes are known: no table, and no model\n"};
  std::array<AxisLine, N> lines;
  std::array<double, N> at{};
  for (std::size_t j = 0; j < N; ++j) {
    const Json &l = moved.at("lines").at(j), &d = l.at("direction"), &c = l.at("point");
    for (int i = 0; i < 3; ++i) {
      lines[j].direction(i) = d.at(std::size_t(i)).get<double>();
      lines[j].point(i) = c.at(std::size_t(i)).get<double>();
    }
    lines[j].direction.normalize();
    at[j] = moved.at("home").at(j).get<double>();
  }
  const auto found = line_model<N>(lines, at);
  return {found.template model<Chain<N>>(), found.text()};
}
template FoundAxes<6> axes_of<6>(const Json&);

namespace {

template <std::size_t N>
void write_axes(const Options& options, const Json& moved) {
  const auto axes = axes_of<N>(moved);
  write_text(options.folder / "dh.txt", axes.table);
  if (!axes.model) return;
  auto model = *axes.model;
  if constexpr (N == 6)
    if (fs::exists(options.folder / "masses.json")) {
      const Json masses = read_json(options.folder / "masses.json");
      if (masses.contains("bodies"))
        model = with_bodies(model, {.bodies = masses.at("bodies").get<decltype(RobotMasses::bodies)>()});
    }
  UrdfDress dress{.name = "calibrated_" + options.arm.robot.name};
  for (const auto& link : options.arm.robot.links) dress.links.push_back(link.name);
  write_text(options.folder / "model.urdf", urdf_text(model, dress));
}

}  // namespace

void write_results(const Options& options) {
  std::exception_ptr failed;
  // Each for itself: what cannot be written takes nothing else with it.
  const auto attempt = [&](const auto& write) {
    try {
      write();
    } catch (...) {
      if (!failed) failed = std::current_exception();
    }
  };
  attempt([&] {
    const SkinFile file = skin_file_of(options.arm.robot, read_json(options.folder / "result.json"));
    if (file.patches.empty())
      throw std::runtime_error("no patch is known well enough: no skin file was written; see report.html");
    write_text(options.folder / "skin.json", skin_file_text(file));
  });
  attempt([&] {
    const Json moved = read_json(options.folder / "lines.json");
    moved.at("home").size() == 7 ? write_axes<7>(options, moved) : write_axes<6>(options, moved);
  });
  attempt([&] { write_text(options.folder / "report.html", report_of(options.folder)); });
  if (failed) std::rethrow_exception(failed);
}

}  // namespace calibrate_skin
