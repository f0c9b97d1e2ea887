// The results of a calibration as files: a skin, a robot, a report.
#include <array>
#include <exception>
#include <map>
#include <stdexcept>

#include "examples/calibrate_skin/masses.hpp"
#include "examples/calibrate_skin/report.hpp"
#include "examples/calibrate_skin/steps.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "skinctl/calibration/line_model.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf_writer.hpp"
#include "skinctl/robots/ur5_links.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace calibrate_skin {

using namespace skinctl;

namespace {

/// Force gains of each link's skin: those of the main job's scenario.
constexpr std::array<double, 6> gains = {60, 70, 50, 25, 15, 15};

SkinPose skin_pose(const FitPose& X) {
  const Json j = json_of(X);
  const Json &p = j.at("p"), &q = j.at("q");
  return {{p.at(0).get<double>(), p.at(1).get<double>(), p.at(2).get<double>()},
          {q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>()}};
}

}  // namespace

SkinFile skin_file_of(const Json& found) {
  SkinFile file;
  file.source = "calibrate_skin";
  std::map<std::uint32_t, bool> known;
  for (const auto& p : found.at("patches"))
    for (const auto& c : p.at("cells")) known[c.at("id").get<std::uint32_t>()] = true;
  for (const auto& p : found.at("patches")) {
    const auto l = p.at("link").get<std::size_t>();
    require(l < 6, "link of a patch", double(l), "0 to 5");
    const NamedLink& link = ur5::Ros2Links::named_links[l];
    bool listed = false;
    for (const auto& other : file.links) listed = listed || other.name == link.name;
    const ur5::Tube& tube = ur5::tubes[l];
    if (!listed)
      file.links.push_back({std::string(link.name), tube.radius, norm(tube.to - tube.from), {0, 0, 1}, 0});
    SkinFile::Patch patch;
    patch.name = "patch of cell " + p.at("cells").at(0).at("id").dump();
    patch.link = link.name;
    patch.gains = {.force = gains[l], .proximity = 0};
    patch.X_LinkRoot = skin_pose(pose_of(p.at("pose")));
    patch.X_LinkRoot.p = patch.X_LinkRoot.p - link.p;
    patch.covariance = p.at("covariance").get<std::vector<double>>();
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
    const NamedLink& link = ur5::Ros2Links::named_links[root->link];
    patch.link = link.name;
    patch.X_LinkRoot = skin_pose(root->X_LinkCell);
    patch.X_LinkRoot.p = patch.X_LinkRoot.p - link.p;
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
  for (std::size_t l = 0; l < ur5::tubes.size(); ++l) {
    const NamedLink& link = ur5::Ros2Links::named_links[l];
    const ur5::Tube& tube = ur5::tubes[l];
    SkinFile::Patch patch;
    patch.name = "skin of " + std::string(link.name);
    patch.link = link.name;
    patch.gains = {.force = gains[l], .proximity = 0};
    patch.X_LinkRoot.p = patch.X_LinkRoot.p - link.p;
    for (const World::Cell& c : world.truth()) {
      if (c.link != l) continue;
      auto& cell = patch.cells.emplace_back();
      cell.id = c.id;
      cell.X_RootCell = skin_pose(c.X_LinkCell);
    }
    if (patch.cells.empty()) continue;
    file.links.push_back({std::string(link.name), tube.radius, norm(tube.to - tube.from), {0, 0, 1}, 0});
    file.patches.push_back(std::move(patch));
  }
  file.check();
  return file;
}

FoundAxes axes_of(const Json& moved) {
  if (!moved.at("complete").get<bool>()) return {{}, "not all axes are known: no table, and no model\n"};
  std::array<AxisLine, 6> lines;
  std::array<double, 6> at{};
  for (std::size_t j = 0; j < 6; ++j) {
    const Json &l = moved.at("lines").at(j), &d = l.at("direction"), &c = l.at("point");
    for (int i = 0; i < 3; ++i) {
      lines[j].direction(i) = d.at(std::size_t(i)).get<double>();
      lines[j].point(i) = c.at(std::size_t(i)).get<double>();
    }
    lines[j].direction.normalize();
    at[j] = moved.at("home").at(j).get<double>();
  }
  const auto found = line_model<6>(lines, at);
  return {found.model<Chain<6>>(), found.text()};
}

namespace {

std::string urdf_of(const fs::path& folder, const FoundAxes& axes) {
  FoundModel model = *axes.model;
  if (fs::exists(folder / "masses.json")) {
    const Json masses = read_json(folder / "masses.json");
    if (masses.contains("bodies"))
      model = with_bodies(model, {.bodies = masses.at("bodies").get<decltype(RobotMasses::bodies)>()});
  }
  UrdfDress dress{.name = "calibrated_ur5"};
  for (std::size_t i = 0; i < 6; ++i) dress.links.emplace_back(ur5::Ros2Links::named_links[i].name);
  return urdf_text(model, dress);
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
    const SkinFile file = skin_file_of(read_json(options.folder / "result.json"));
    if (file.patches.empty())
      throw std::runtime_error("no patch is known well enough: no skin file was written; see report.html");
    write_text(options.folder / "skin.json", skin_file_text(file));
  });
  attempt([&] {
    const FoundAxes axes = axes_of(read_json(options.folder / "lines.json"));
    write_text(options.folder / "dh.txt", axes.table);
    if (axes.model) write_text(options.folder / "model.urdf", urdf_of(options.folder, axes));
  });
  attempt([&] { write_text(options.folder / "report.html", report_of(options.folder)); });
  if (failed) std::rethrow_exception(failed);
}

}  // namespace calibrate_skin
