// Network, rest and shape.
#include <algorithm>

#include "examples/calibrate_skin/fits.hpp"
#include "examples/calibrate_skin/json_values.hpp"
#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/wire.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"
#include "skinctl/skin_network/patch_graph.hpp"

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

namespace {

// What a skin's own boxes have said: each cell's id and, port by port, whose port it is joined to.
NetworkReport told_network(const fs::path& file) {
  NetworkReport out;
  const Json told = read_json(file);
  for (const Json& cell : told.at("cells")) {
    CellNames& names = out.cells.emplace_back();
    names.id = cell.at("id").get<std::uint16_t>();
    names.label = cell.value("label", std::uint16_t(0));
    const Json& neighbours = cell.at("neighbours");
    if (neighbours.size() != names.neighbours.size())
      throw std::runtime_error(file.string() + ": cell " + std::to_string(names.id) + " needs four ports");
    for (std::size_t p = 0; p < names.neighbours.size(); ++p)
      names.neighbours[p] = {neighbours[p].at(0).get<std::uint16_t>(),
                             neighbours[p].at(1).get<std::uint8_t>()};
    out.parents.push_back(cell.value("parent", std::uint16_t(0)));
    out.hops.push_back(cell.value("hops", std::uint16_t(0)));
  }
  require(!out.cells.empty(), "cells of the network that is told", 0, ">= 1");
  return out;
}

}  // namespace

Json network_step(const World& world, const Options& options) {
  const NetworkReport report =
      options.wire.port != 0 ? told_network(options.wire.network) : world.run_network();
  const SkinGraph graph = skin_graph(report.cells);
  Json cells = Json::array(), patches = Json::array();
  for (std::size_t i = 0; i < report.cells.size(); ++i) {
    Json neighbours = Json::array();
    for (const auto& n : report.cells[i].neighbours) neighbours.push_back({n.id, n.port});
    cells.push_back({{"id", report.cells[i].id},
                     {"label", report.cells[i].label},
                     {"parent", report.parents[i]},
                     {"hops", report.hops[i]},
                     {"neighbours", neighbours}});
  }
  for (const auto& p : graph.patches) {
    Json joints = Json::array();
    for (const auto& j : p.joints) joints.push_back({j.a, j.b, j.port_a, j.port_b});
    patches.push_back({{"ids", p.ids}, {"joints", joints}});
  }
  return {{"cells", cells},
          {"patches", patches},
          {"complaints", graph.complaints},
          {"said", text("%zu cells in %zu patches, epoch %u", report.cells.size(), graph.patches.size(),
                        report.epoch)}};
}

namespace {

PatchGraph graph_of(const Json& patch) {
  PatchGraph g;
  g.ids = patch.at("ids").get<std::vector<std::uint16_t>>();
  for (std::size_t i = 0; i < g.ids.size(); ++i)
    if (std::count(g.ids.begin(), g.ids.end(), g.ids[i]) > 1)
      throw std::runtime_error("network.json: id " + std::to_string(g.ids[i]) + " occurs twice in a patch");
  for (const auto& j : patch.at("joints")) {
    const PatchGraph::Joint joint{j.at(0).get<std::size_t>(), j.at(1).get<std::size_t>(),
                                  j.at(2).get<std::uint8_t>(), j.at(3).get<std::uint8_t>()};
    if (joint.a >= g.ids.size() || joint.b >= g.ids.size() || joint.port_a > 3 || joint.port_b > 3)
      throw std::runtime_error("network.json: a connector names a cell or a port that is not there");
    g.joints.push_back(joint);
  }
  return g;
}

}  // namespace

std::vector<Arm::Stand> stands(Arm& arm, const std::vector<JointAngles>& poses, const Options& options) {
  std::vector<Arm::Stand> out;
  for (const auto& q : poses) {
    out.push_back(arm.go(q));
    options.say(text("  pose %zu of %zu", out.size(), poses.size()));
  }
  static_cast<void>(arm.go(options.arm.robot.home));
  return out;
}
std::vector<JointAngles> truths(const std::vector<Arm::Stand>& stands) {
  std::vector<JointAngles> out;
  for (const auto& s : stands) out.push_back(s.truth);
  return out;
}
void ask(const Options& options, std::vector<std::string> announcement) {
  announcement.insert(announcement.begin(), options.arm.host.empty()
                                                ? std::string("the simulated robot moves:")
                                                : "the robot at " + options.arm.host + " MOVES:");
  if (!options.agreed(announcement)) throw ConfigurationError("nobody agreed to the motion; nothing moved");
}
std::string announced(const Robot& robot, const std::vector<JointAngles>& poses, double seconds) {
  double low = 1e9;
  for (const auto& q : poses) low = std::min(low, robot.lowest_point(q));
  return text(
      "from where it stands to home, through %zu poses and back to home, %.1f s in each, no joint faster "
      "than 46 degrees/s; in the poses, elbow, wrists and flange stay %.2f m above the robot's foot",
      poses.size(), seconds, low);
}

namespace {

// In each pose half a second, after the drives have come to rest.
Json rest_on_wire(const Json& net, const std::vector<JointAngles>& poses, const Options& options) {
  constexpr double rest = 0.5;
  constexpr std::size_t least = 20;  // measurements of a cell in a pose
  ask(options, {announced(options.arm.robot, poses, 0.6 + rest)});
  WireSkin skin(options.wire);
  Arm arm(skin.listening(options.arm), {});
  static_cast<void>(arm.go(options.arm.robot.home));
  Json patches = Json::array(), measured = Json::array();
  for (const auto& patch : net.at("patches")) patches.push_back(Json(patch.at("ids").size(), Json::array()));
  for (std::size_t n = 0; n < poses.size(); ++n) {
    measured.push_back(arm.go(poses[n]).measured);
    skin.begin();
    arm.stay(rest);
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const Json& ids = net.at("patches").at(k).at("ids");
      for (std::size_t i = 0; i < ids.size(); ++i)
        patches[k][i].push_back(json_of(skin.mean(ids.at(i).get<std::uint16_t>(), least)));
    }
    options.say(text("  pose %zu of %zu", n + 1, poses.size()));
  }
  static_cast<void>(arm.go(options.arm.robot.home));
  return {
      {"poses", measured}, {"readings", patches}, {"said", text("%zu poses; ", poses.size()) + skin.said()}};
}

}  // namespace

Json rest_step(const World& world, const Options& options) {
  const Json net = read_json(options.folder / "network.json");
  const auto poses = options.arm.robot.rest_poses(world.seed());
  if (options.wire.port != 0) return rest_on_wire(net, poses, options);
  ask(options, {announced(options.arm.robot, poses, 0.6)});
  Arm arm(options.arm, world.robot());
  static_cast<void>(arm.go(options.arm.robot.home));
  const auto stood = stands(arm, poses, options);
  Json patches = Json::array(), measured = Json::array();
  for (const auto& s : stood) measured.push_back(s.measured);
  for (const auto& patch : net.at("patches")) {
    Json readings = Json::array();
    for (const auto& id : patch.at("ids")) {
      const auto cell = id.get<std::uint16_t>();
      const World::Cell* at = world.find(cell);
      if (at == nullptr) throw std::runtime_error("no cell answers to id " + std::to_string(cell));
      const bool by_hand = options.shoulder_by_hand && at->link == 0;
      Json y = Json::array();
      for (const auto& r : world.at_rest(cell, truths(stood), by_hand)) y.push_back(json_of(r));
      readings.push_back(y);
    }
    patches.push_back(readings);
  }
  return {{"poses", measured}, {"readings", patches}, {"said", text("%zu poses", poses.size())}};
}

Json shape_step(const Options& options) {
  const Json net = read_json(options.folder / "network.json"),
             recorded = read_json(options.folder / "rest.json");
  Json patches = Json::array(), unknown = Json::array();
  std::size_t known = 0, all = 0;
  if (recorded.at("readings").size() != net.at("patches").size())
    throw std::runtime_error("rest.json is of another network");
  for (std::size_t k = 0; k < net.at("patches").size(); ++k) {
    const PatchGraph graph = graph_of(net.at("patches").at(k));
    RestReadings y;
    for (const auto& cell : recorded.at("readings").at(k)) {
      auto& own = y.emplace_back();
      for (const auto& r : cell) own.push_back(vector_of(r));
    }
    ReconstructionSettings s;
    s.prior.misalignment = 0.2 * 0.0174532925;
    const Reconstruction found = fit_shape(graph, y, s);
    Json cells = Json::array();
    for (const auto& c : found.cells) {
      ++all, known += c.unknown.empty();
      cells.push_back({{"id", c.id},
                       {"pose", json_of(FitPose{c.R, c.p})},
                       {"covariance", c.covariance.allFinite() ? json_of(c.covariance) : Json()},
                       {"place_deviation", c.place_deviation()},
                       {"turn_deviation", c.turn_deviation()},
                       {"unknown", c.unknown}});
    }
    patches.push_back({{"cells", cells},
                       {"residual", found.residual},
                       {"steps", found.steps},
                       {"end", std::string(name(found.end))}});
    add(unknown, json_of(found.unobservable));
    options.say(text("  patch of cell %d: %zu cells, %zu not known, residual %.1f mg, %d steps",
                     int(graph.ids[0]), found.cells.size(), found.unobservable.size(), 1e3 * found.residual,
                     found.steps));
  }
  return {{"patches", patches},
          {"unobservable", unknown},
          {"said", text("%zu of %zu cells have a pose in their patch", known, all)}};
}

}  // namespace calibrate_skin
