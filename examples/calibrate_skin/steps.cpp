#include "examples/calibrate_skin/steps.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "examples/calibrate_skin/fits.hpp"
#include "examples/calibrate_skin/masses.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"
#include "skinctl/calibration/patch_graph.hpp"
#include "skinctl/calibration/pose_uncertainty.hpp"

namespace calibrate_skin {

using examples::text;

using namespace skinctl;

// Beside the public ones, so that they overload.
static Json json_of(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
// The upper triangle by rows, as in a skin file.
static Json json_of(const Matrix6d& C) {
  Json out = Json::array();
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) out.push_back(C(i, j));
  return out;
}
static Json json_of(const std::vector<Unobservable>& all) {
  Json out = Json::array();
  for (const auto& u : all)
    out.push_back({{"what", u.name},
                   {"deviation", std::isfinite(u.deviation) ? Json(u.deviation) : Json()},
                   {"unit", u.unit},
                   {"remedy", u.remedy}});
  return out;
}

namespace {

// JSON has no NaN: null.
double number(const Json& v) {
  return v.is_null() ? std::nan("") : v.get<double>();
}
Eigen::Vector3d vector_of(const Json& v) {
  return {number(v.at(0)), number(v.at(1)), number(v.at(2))};
}
Matrix6d matrix_of(const Json& C) {
  Matrix6d out;
  std::size_t k = 0;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) out(i, j) = out(j, i) = C.at(k++).get<double>();
  return out;
}
void add(Json& to, const Json& more) {
  for (const auto& x : more) to.push_back(x);
}

Json network(const World& world) {
  const NetworkReport report = world.run_network();
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

// The robot stands in each pose; where it stood.
std::vector<Arm::Stand> stands(Arm& arm, const std::vector<JointAngles6>& poses, const Options& options) {
  std::vector<Arm::Stand> out;
  for (const auto& q : poses) {
    out.push_back(arm.go(q));
    options.say(text("  pose %zu of %zu", out.size(), poses.size()));
  }
  static_cast<void>(arm.go(home));
  return out;
}
std::vector<JointAngles6> truths(const std::vector<Arm::Stand>& stands) {
  std::vector<JointAngles6> out;
  for (const auto& s : stands) out.push_back(s.truth);
  return out;
}
void ask(const Options& options, std::vector<std::string> announcement) {
  announcement.insert(announcement.begin(), options.arm.host.empty()
                                                ? std::string("the simulated robot moves:")
                                                : "the robot at " + options.arm.host + " MOVES:");
  if (!options.agreed(announcement)) throw ConfigurationError("nobody agreed to the motion; nothing moved");
}
std::string announced(const std::vector<JointAngles6>& poses, double seconds) {
  double low = 1e9;
  for (const auto& q : poses) low = std::min(low, lowest_point(q));
  return text(
      "from where it stands to home, through %zu poses and back to home, %.1f s in each, no joint faster "
      "than 46 degrees/s; in the poses, elbow, wrists and flange stay %.2f m above the robot's foot",
      poses.size(), seconds, low);
}

Json rest(const World& world, const Options& options) {
  const Json net = read_json(options.folder / "network.json");
  const auto poses = world.rest_poses();
  ask(options, {announced(poses, 0.6)});
  Arm arm(options.arm, world.robot());
  static_cast<void>(arm.go(home));
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

Json shape(const Options& options) {
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

// Five cells of each patch: more do not show more of the axes.
struct Recorded {
  std::vector<std::uint16_t> ids;
  std::vector<std::size_t> patch;
  std::vector<CellInPatch> places;
};
Recorded recorded(const Json& shapes) {
  Recorded out;
  for (std::size_t k = 0; k < shapes.at("patches").size(); ++k) {
    const Json& cells = shapes.at("patches").at(k).at("cells");
    std::size_t taken = 0;
    for (std::size_t i = 0; i < cells.size() && taken < 5; i += std::max<std::size_t>(1, cells.size() / 5)) {
      out.ids.push_back(cells.at(i).at("id").get<std::uint16_t>());
      out.patch.push_back(k);
      const FitPose X = pose_of(cells.at(i).at("pose"));
      const bool known = cells.at(i).at("unknown").get<std::string>().empty();
      out.places.push_back({known ? int(k) : -1, X.R, X.p});
      ++taken;
    }
  }
  return out;
}

Json rows_of(const Eigen::MatrixXd& m) {
  Json out = Json::array();
  for (Eigen::Index k = 0; k < m.rows(); ++k) {
    Json row = Json::array();
    for (Eigen::Index i = 0; i < m.cols(); ++i) row.push_back(m(k, i));
    out.push_back(std::move(row));
  }
  return out;
}
Eigen::MatrixXd matrix_of_rows(const Json& rows) {
  Eigen::MatrixXd out(Eigen::Index(rows.size()), 6);
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t i = 0; i < 6; ++i) out(Eigen::Index(k), Eigen::Index(i)) = number(rows.at(k).at(i));
  return out;
}
constexpr double step_of_readings = 1.0 / 256;  // [g]

Json motion(const World& world, const Options& options) {
  const Recorded which = recorded(read_json(options.folder / "shape.json"));
  const PlannedMotion planned = excitation();
  double low = 1e9;
  for (double t = 0; t < planned.duration; t += 0.05) {
    JointAngles6 q{};
    const Eigen::VectorXd p = planned.path(t).q;
    for (std::size_t i = 0; i < 6; ++i) q[i] = p(Eigen::Index(i));
    low = std::min(low, lowest_point(q));
  }
  require(low >= clearance, "height of elbow, wrists and flange in the motion", low, ">= 0.1 m");
  std::vector<std::string> announcement = planned.announcements;
  announcement.push_back(text("elbow, wrists and flange come as low as %.2f m above the robot's foot", low));
  ask(options, announcement);
  Arm arm(options.arm, world.robot());
  static_cast<void>(arm.go(home));
  const Ride ride = arm.follow(planned.path, planned.duration);
  const MotionRecording felt = world.moved(which.ids, ride);
  Json cells = Json::array();
  for (std::size_t c = 0; c < felt.cells.size(); ++c) {
    Json t = Json::array(), y = Json::array();
    for (std::size_t k = 0; k < felt.cells[c].time.size(); ++k) {
      t.push_back(std::llround(1e6 * felt.cells[c].time[k]));
      for (int i = 0; i < 3; ++i)
        y.push_back(std::lround(felt.cells[c].y(i, Eigen::Index(k)) / step_of_readings));
    }
    cells.push_back({{"id", which.ids[c]}, {"microseconds", std::move(t)}, {"steps", std::move(y)}});
  }
  return {{"time", felt.joints.time},
          {"joints", rows_of(felt.joints.q)},
          {"torques", rows_of(felt.torque)},
          {"cells", cells},
          {"said", text("%zu cells, %.0f s", which.ids.size(), felt.joints.time.back())}};
}

MotionRecording recording_of(const Json& j, const Recorded& which) {
  MotionRecording out;
  out.joints.time = j.at("time").get<std::vector<double>>();
  out.joints.q = matrix_of_rows(j.at("joints"));
  out.torque = matrix_of_rows(j.at("torques"));
  if (j.at("cells").size() != which.ids.size())
    throw std::runtime_error("the recording is of other cells than those of shape.json");
  for (std::size_t c = 0; c < which.ids.size(); ++c) {
    const Json& cell = j.at("cells").at(c);
    const Json &t = cell.at("microseconds"), &y = cell.at("steps");
    if (cell.at("id") != which.ids[c] || y.size() != 3 * t.size())
      throw std::runtime_error("the recording's cell " + cell.at("id").dump() +
                               " is another one than that of shape.json, or was cut");
    CellReadings& to = out.cells.emplace_back();
    to.y.resize(3, Eigen::Index(t.size()));
    for (std::size_t k = 0; k < t.size(); ++k) {
      to.time.push_back(1e-6 * number(t[k]));
      for (std::size_t i = 0; i < 3; ++i)
        to.y(Eigen::Index(i), Eigen::Index(k)) = step_of_readings * number(y[3 * k + i]);
    }
  }
  out.places = which.places;
  return out;
}

// The gauge of lines: turned about the vertical and moved so that they lie on the maker's.
FitPose onto_maker(const std::vector<CalibratedLine>& lines) {
  const auto X = link_poses_of(home);
  double s = 0, c = 0;
  for (std::size_t j = 0; j < 6; ++j) {
    if (!lines[j].known) continue;
    const Eigen::Vector3d d = lines[j].line.direction, z = X[j].R.col(2);
    s += d.x() * z.y() - d.y() * z.x(), c += d.x() * z.x() + d.y() * z.y();
  }
  FitPose out;
  out.R = turn(std::atan2(s, c) * Eigen::Vector3d::UnitZ());
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < 6; ++j) {
    if (!lines[j].known) continue;
    const Eigen::Vector3d z = X[j].R.col(2);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - z * z.transpose();
    A += across, b += across * (X[j].p - out.R * lines[j].line.point);
  }
  out.p = skinctl::detail::solve_symmetric(A, b);
  return out;
}

// Where a patch sits on its link by the motion of its cells: the mean of what each of them says.
Json placed_by_motion(const JointLines& found, const Recorded& which, std::size_t patch, std::size_t link) {
  const FitPose on_link = link_poses_of(home)[link].inverse() * onto_maker(found.lines);
  std::vector<FitPose> all;
  Matrix6d covariance = Matrix6d::Zero();
  for (std::size_t i = 0; i < which.ids.size(); ++i) {
    const auto& cell = found.cells[i];
    if (which.patch[i] != patch || which.places[i].patch < 0 || !cell.known) continue;
    const FitPose X_RootCell{which.places[i].R, which.places[i].p};
    all.push_back(on_link * FitPose{cell.R, cell.p} * X_RootCell.inverse());
    Matrix6d axes = Matrix6d::Zero();
    axes.topLeftCorner<3, 3>() = on_link.R, axes.bottomRightCorner<3, 3>() = X_RootCell.R;
    covariance += axes * cell.covariance * axes.transpose();
  }
  if (all.empty()) return {};
  FitPose mean = all.front();
  for (int round = 0; round < 3; ++round) {
    Eigen::Vector3d off = Eigen::Vector3d::Zero(), place = Eigen::Vector3d::Zero();
    for (const FitPose& X : all) {
      off += turn_vector(mean.R.transpose() * X.R) / double(all.size());
      place += X.p / double(all.size());
    }
    mean = {mean.R * turn(off), place};
  }
  return {{"pose", json_of(mean)},
          {"covariance", json_of(Matrix6d(covariance / double(all.size())))},
          {"cells", all.size()}};
}

Json lines(const Options& options) {
  const Json shapes = read_json(options.folder / "shape.json");
  const Recorded which = recorded(shapes);
  const JointLines found = fit_lines(recording_of(read_json(options.folder / "motion.json"), which));
  Json links = Json::array(), axes = Json::array(), unknown = json_of(found.unobservable);
  const bool all_known =
      found.joints.size() == 6 &&
      std::all_of(found.lines.begin(), found.lines.end(), [](const CalibratedLine& l) { return l.known; });
  for (std::size_t k = 0; k < shapes.at("patches").size(); ++k) {
    std::map<int, int> votes;
    for (std::size_t i = 0; i < which.ids.size(); ++i)
      if (which.patch[i] == k) ++votes[found.activation.link(i)];
    int link = -1, most = 0, cells = 0;
    for (const auto& [l, n] : votes) {
      cells += n;
      if (n > most) most = n, link = l;
    }
    // Cells of one patch that move with different links lie, or a cable joins two patches.
    if (2 * most <= cells) link = -1;
    // Of a joint that never moved nobody knows what is behind it.
    if (const auto next = std::size_t(link + 1); next < 6 && !found.activation.alone[next]) {
      unknown.push_back(
          {{"what", text("link of the patch of cell %d: joint %zu never moved alone",
                         shapes.at("patches").at(k).at("cells").at(0).at("id").get<int>(), next)},
           {"deviation", Json()},
           {"unit", ""},
           {"remedy", text("move joint %zu alone for a second or more", next)}});
      link = -1;
    }
    links.push_back(
        {{"link", link},
         {"agree", most},
         {"of", cells},
         {"placed", link >= 0 && all_known ? placed_by_motion(found, which, k, std::size_t(link)) : Json()}});
  }
  for (const auto& l : found.lines)
    axes.push_back(
        {{"direction", json_of(l.line.direction)},
         {"point", json_of(l.line.point)},
         {"direction_deviation", std::isfinite(l.direction_deviation) ? Json(l.direction_deviation) : Json()},
         {"position_deviation", std::isfinite(l.position_deviation) ? Json(l.position_deviation) : Json()},
         {"known", l.known}});
  Json home_of_lines = Json::array();
  for (Eigen::Index j = 0; j < found.home.size(); ++j) home_of_lines.push_back(found.home(j));
  return {{"links", links},
          {"lines", axes},
          {"home", home_of_lines},
          {"complete", all_known},
          {"lateness", found.lateness.value},
          {"residual", found.residual},
          {"unobservable", unknown},
          {"said", text("%zu axes found, readings come %.2f ms late, residual %.1f mg", found.joints.size(),
                        1e3 * found.lateness.value, 1e3 * found.residual)}};
}

// Where patches are said to be before the camera looks: by motion, else by hand.
Json placed_before(const World& world, const Options& options, const Json& shapes, const Json& moved) {
  const fs::path by_hand = options.folder / "placed.json";
  if (!fs::exists(by_hand)) {
    Json placed;
    placed["camera"] = json_of(world.camera_by_hand());
    for (const auto& p : shapes.at("patches")) {
      const auto root = p.at("cells").at(0).at("id").get<std::uint16_t>();
      placed["patches"][std::to_string(root)] = json_of(world.placed_by_hand(root));
    }
    write_json(by_hand, placed);
  }
  Json placed = read_json(by_hand);
  for (std::size_t k = 0; k < shapes.at("patches").size(); ++k) {
    const Json& by_motion = moved.at("links").at(k).at("placed");
    const auto root = std::to_string(shapes.at("patches").at(k).at("cells").at(0).at("id").get<int>());
    if (!by_motion.is_null()) placed["patches"][root] = by_motion.at("pose");
  }
  return placed;
}

// How far two poses of a patch are apart: at the middle of its cells, and turned.
std::pair<double, double> apart(const FitPose& a, const FitPose& b,
                                const std::vector<Eigen::Vector3d>& cells) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& p : cells) middle += p / double(cells.size());
  return {(a * middle - b * middle).norm(), turn_vector(a.R.transpose() * b.R).norm()};
}

Json camera(const World& world, const Options& options) {
  const Json shapes = read_json(options.folder / "shape.json"),
             moved = read_json(options.folder / "lines.json");
  std::vector<std::vector<Eigen::Vector3d>> cells;
  std::vector<std::string> names;
  std::vector<std::size_t> links, which;
  std::map<std::uint16_t, std::pair<std::size_t, std::size_t>> index;
  for (std::size_t k = 0; k < shapes.at("patches").size(); ++k) {
    const Json& patch = shapes.at("patches").at(k).at("cells");
    const int link = moved.at("links").at(k).at("link").get<int>();
    std::vector<Eigen::Vector3d> known;
    if (link < 0) continue;
    for (const auto& c : patch)
      if (c.at("unknown").get<std::string>().empty()) {
        index[c.at("id").get<std::uint16_t>()] = {cells.size(), known.size()};
        known.push_back(pose_of(c.at("pose")).p);
      }
    if (known.empty()) continue;
    cells.push_back(std::move(known));
    names.push_back("the patch of cell " + patch.at(0).at("id").dump());
    links.push_back(std::size_t(link)), which.push_back(k);
  }
  if (cells.empty()) throw std::runtime_error("no patch has both a shape and a link");
  Json patches = Json::array(), unknown = Json::array();
  if (!options.camera) {
    std::size_t placed = 0;
    for (std::size_t i = 0; i < which.size(); ++i) {
      const Json& by_motion = moved.at("links").at(which[i]).at("placed");
      if (by_motion.is_null()) {
        unknown.push_back({{"what", "place of " + names[i]},
                           {"deviation", Json()},
                           {"unit", "m"},
                           {"remedy", "a camera, or a base that is tilted"}});
        continue;
      }
      patches.push_back({{"patch", which[i]},
                         {"pose", by_motion.at("pose")},
                         {"covariance", by_motion.at("covariance")},
                         {"cells", by_motion.at("cells")},
                         {"known", true}});
      ++placed;
    }
    return {{"patches", patches},
            {"by", "motion"},
            {"unobservable", unknown},
            {"said", text("%zu patches placed by motion, without a camera", placed)}};
  }

  const Json before = placed_before(world, options, shapes, moved);
  std::vector<FitPose> start;
  for (const std::size_t k : which) {
    const auto root = shapes.at("patches").at(k).at("cells").at(0).at("id").dump();
    if (!before.at("patches").contains(root))
      throw std::runtime_error("placed.json has no pose of the patch of cell " + root +
                               ", and motion did not place it");
    start.push_back(pose_of(before.at("patches").at(root)));
  }
  const auto poses = world.camera_poses();
  ask(options, {announced(poses, 0.6)});
  std::vector<Arm::Stand> stood;
  {
    Arm arm(options.arm, world.robot());
    static_cast<void>(arm.go(home));
    stood = stands(arm, poses, options);
  }
  const CameraReport report = world.seen(truths(stood));
  std::vector<CameraView> views(stood.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto X = link_poses_of(stood[v].measured);
    for (const std::size_t l : links) views[v].X_BaseLink.push_back(X[l]);
  }
  std::size_t used = 0;
  for (const auto& light : report.lights)
    if (const auto at = index.find(light.id); at != index.end())
      views[light.view].seen.push_back({at->second.first, at->second.second, light.pixel}), ++used;
  options.say(text("  %zu views, %zu lights of known cells", views.size(), used));
  const SightingFit found =
      fit_lights(report.camera, cells, names, views, start, {pose_of(before.at("camera"))});
  unknown = json_of(found.X_BaseCam.unobservable);
  double farthest = 0;
  std::size_t placed = 0, both = 0, alone = 0;
  for (std::size_t i = 0; i < which.size(); ++i) {
    const auto& X = found.X_LinkRoot[i];
    const Json& by_motion = moved.at("links").at(which[i]).at("placed");
    Json patch = {{"patch", which[i]}, {"agreeing", found.agreeing[i]}, {"known", X.known()}};
    if (X.known() || by_motion.is_null()) {
      patch["pose"] = json_of(X.value), patch["covariance"] = json_of(Matrix6d(X.covariance));
      add(unknown, json_of(X.unobservable));
      if (X.known() && !by_motion.is_null()) {
        const auto [place, angle] = apart(X.value, pose_of(by_motion.at("pose")), cells[i]);
        patch["motion_off"] = {place, angle};
        farthest = std::max(farthest, place), ++both;
      }
    } else {  // too few lights, of a single cell for instance: as motion says
      patch["pose"] = by_motion.at("pose"), patch["covariance"] = by_motion.at("covariance");
      patch["known"] = true, ++alone;
    }
    if (patch.at("known").get<bool>()) ++placed;
    patches.push_back(std::move(patch));
  }
  return {
      {"patches", patches},
      {"by", "camera"},
      {"residual", found.residual},
      {"disagreeing", found.disagreeing},
      {"unobservable", unknown},
      {"said", text("%zu of %zu patches placed, %zu of them by motion alone; residual %.2f pixels, %zu "
                    "sightings disagree; motion says of %zu the same to %.1f mm",
                    placed, which.size(), alone, found.residual, found.disagreeing, both, 1e3 * farthest)}};
}

Json torques(const World& world, const Options& options) {
  if (!read_json(options.folder / "lines.json").at("complete").get<bool>())
    return {{"time", Json::array()}, {"said", "not all axes are known: nothing moved"}};
  const PlannedMotion planned = masses_motion();
  ask(options, planned.announcements);
  Arm arm(options.arm, world.robot());
  static_cast<void>(arm.go(home));
  const Ride ride = arm.follow(planned.path, planned.duration);
  return {{"time", ride.measured.time},
          {"joints", rows_of(ride.measured.q)},
          {"torques", rows_of(ride.torque)},
          {"said", text("%zu readings of six currents, %.0f s", ride.measured.time.size(),
                        ride.measured.time.back())}};
}

Json masses(const World& world, const Options& options) {
  const FoundAxes axes = axes_of(read_json(options.folder / "lines.json"));
  const Json recording = read_json(options.folder / "torques.json");
  if (!axes.model) return {{"unobservable", Json::array()}, {"said", "not all axes are known: no masses"}};
  JointRecording joints{recording.at("time").get<std::vector<double>>(),
                        matrix_of_rows(recording.at("joints"))};
  const FoundMasses found = fit_masses(*axes.model, joints, matrix_of_rows(recording.at("torques")));
  if (!found.converged) throw std::runtime_error("the fit of masses did not end at its minimum");
  const auto [least, most] = std::minmax_element(found.predicted.begin(), found.predicted.end());
  Json out = {
      {"bodies", found.masses.bodies},
      {"viscous", found.masses.viscous},
      {"coulomb", found.masses.coulomb},
      {"rotor", found.masses.rotor},
      {"presliding", found.presliding},
      {"noise", found.noise},
      {"lateness", found.lateness},
      {"base", {{"values", found.values}, {"deviations", found.deviations}, {"of", 60}}},
      {"predicted", found.predicted},
      {"predicted_by_maker", found.predicted_by_maker},
      {"unobservable",
       {{{"what",
          text("%d of 60 numbers of the bodies: they take part in no torque, and are what a body that "
               "has the others may have",
               60 - found.base)},
         {"deviation", Json()},
         {"unit", ""},
         {"remedy", ""}},
        {{"what", "scale of all masses and of friction: torque per ampere is taken from elsewhere"},
         {"deviation", Json()},
         {"unit", ""},
         {"remedy", "a known mass at the flange, in another recording"}}}}};
  std::string said = text(
      "%d base parameters and friction of six joints; currents come %.1f ms late; torques that the fit has "
      "not seen: R^2 %.3f to %.3f",
      found.base, 1e3 * found.lateness, *least, *most);
  if (options.arm.host.empty()) {
    ask(options,
        {"another simulated robot follows a motion of 10 s by torque, with what was found and with the "
         "maker's bodies"});
    const FoundModel model = with_bodies(*axes.model, found.masses);
    RobotMasses no_rotors = found.masses;  // the maker gives none
    no_rotors.rotor = {};
    const double by_found = following_error(world.robot(), &model, found.masses),
                 by_maker = following_error(world.robot(), nullptr, no_rotors),
                 with_rotors = following_error(world.robot(), nullptr, found.masses);
    out["following"] = {{"found", by_found}, {"maker", by_maker}, {"maker_with_rotors", with_rotors}};
    said += text(
        "; by torque the arm follows to %.1f mrad, with the maker's bodies to %.1f, and with the rotors that "
        "were "
        "found to %.1f",
        1e3 * by_found, 1e3 * by_maker, 1e3 * with_rotors);
  }
  out["said"] = said;
  return out;
}

Json result(const World& world, const Options& options) {
  const Json net = read_json(options.folder / "network.json"),
             shapes = read_json(options.folder / "shape.json"),
             moved = read_json(options.folder / "lines.json"),
             seen = read_json(options.folder / "camera.json");
  std::map<int, Json> neighbours;
  for (const auto& names : net.at("cells")) neighbours[names.at("id").get<int>()] = names.at("neighbours");
  Json patches = Json::array();
  std::size_t masked = 0, all = 0;
  for (const auto& placed : seen.at("patches")) {
    if (!placed.at("known").get<bool>()) continue;
    const auto k = placed.at("patch").get<std::size_t>();
    const auto link = moved.at("links").at(k).at("link").get<std::size_t>();
    std::vector<Eigen::MatrixXd> configurations;
    for (const auto& q : world.rest_poses()) configurations.push_back(transposed_jacobian(link, q));
    UncertainPatch patch{pose_of(placed.at("pose")), matrix_of(placed.at("covariance")), {}};
    const Json& cells = shapes.at("patches").at(k).at("cells");
    for (const auto& c : cells)
      patch.cells.push_back({pose_of(c.at("pose")), c.at("covariance").is_null()
                                                        ? Matrix6d(Matrix6d::Zero())
                                                        : matrix_of(c.at("covariance"))});
    Json out = Json::array();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto why = cells.at(i).at("unknown").get<std::string>();
      const std::string mask =
          why.empty() ? mask_reason(configurations, patch, i) : std::string("pose unknown");
      ++all, masked += !mask.empty();
      out.push_back({{"id", cells.at(i).at("id")},
                     {"pose", cells.at(i).at("pose")},
                     {"covariance", cells.at(i).at("covariance")},
                     {"neighbours", neighbours[cells.at(i).at("id").get<int>()]},
                     {"masked", mask}});
    }
    patches.push_back({{"link", link},
                       {"pose", placed.at("pose")},
                       {"covariance", placed.at("covariance")},
                       {"cells", out}});
  }
  return {{"patches", patches},
          {"said", text("%zu cells in %zu patches, %zu of them masked", all, patches.size(), masked)}};
}

}  // namespace

Json json_of(const FitPose& X) {
  const Eigen::Quaterniond q(X.R);
  return {{"p", {X.p.x(), X.p.y(), X.p.z()}}, {"q", {q.x(), q.y(), q.z(), q.w()}}};
}
FitPose pose_of(const Json& X) {
  const Json& q = X.at("q");
  return {Eigen::Quaterniond(number(q.at(3)), number(q.at(0)), number(q.at(1)), number(q.at(2)))
              .normalized()
              .toRotationMatrix(),
          vector_of(X.at("p"))};
}

Json read_json(const fs::path& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path.string() + ": is not there");
  Json value = Json::parse(in, nullptr, false);
  if (value.is_discarded())
    throw std::runtime_error(path.string() + ": no JSON; remove it, and its step runs again");
  return value;
}
void write_text(const fs::path& path, const std::string& text) {
  const fs::path part = path.string() + ".part";
  {
    std::ofstream out(part, std::ios::binary);
    out << text << std::flush;
    if (!out) throw std::runtime_error(part.string() + ": cannot be written");
  }
  fs::rename(part, path);
}
void write_json(const fs::path& path, const Json& value) {
  write_text(path, value.dump());
}

std::vector<Step> steps_of(const Options& options, const World& world) {
  std::vector<Step> all = {
      {"network", "network.json", "cells find their ids, their neighbours and their tree",
       [&] { return network(world); }},
      {"rest", "rest.json", "the robot rests in eight poses", [&] { return rest(world, options); }},
      {"shape", "shape.json", "patches are reconstructed from gravity", [&] { return shape(options); }},
      {"motion", "motion.json", "the robot moves for a minute: each joint alone, then all",
       [&] { return motion(world, options); }},
      {"lines", "lines.json", "links, axes and places are found from the motion",
       [&] { return lines(options); }},
      {"camera", "camera.json", "patches are placed on their links", [&] { return camera(world, options); }},
      {"torques", "torques.json", "the robot moves for forty seconds: its currents are recorded",
       [&] { return torques(world, options); }},
      {"masses", "masses.json", "masses, friction and rotors are found from the currents",
       [&] { return masses(world, options); }},
      {"result", "result.json", "what is not known well enough is masked",
       [&] { return result(world, options); }},
  };
  if (!options.masses)
    std::erase_if(all, [](const Step& s) { return s.name == "torques" || s.name == "masses"; });
  return all;
}

bool run_steps(const Options& options, const World& world, const std::string& again,
               const std::string& until) {
  const auto steps = steps_of(options, world);
  bool anew = false;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (k > 0 && steps[k - 1].name == until) return true;
    const Step& step = steps[k];
    const std::string head = text("[%zu/%zu] ", k + 1, steps.size()) + step.name + ": ";
    const fs::path file = options.folder / step.file;
    anew = anew || step.name == again;
    try {
      if (!anew && fs::exists(file)) {
        options.say(head + "kept: " + read_json(file).at("said").get<std::string>());
        continue;
      }
      if (options.arm.stop != nullptr && *options.arm.stop) throw Interrupted{};
      if (!anew || step.name == again) {
        for (std::size_t later = k; later < steps.size(); ++later)
          fs::remove(options.folder / steps[later].file);
        for (const char* result : {"skin.json", "model.urdf", "dh.txt", "report.html"})
          fs::remove(options.folder / result);
      }
      anew = true;
      options.say(head + step.purpose);
      const auto from = std::chrono::steady_clock::now();
      const Json found = step.run();
      write_json(file, found);
      options.say(
          "  " + found.at("said").get<std::string>() +
          text(" (%.1f s)", std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count()));
    } catch (const Json::exception& e) {
      throw std::runtime_error("step " + step.name + ": a file is not as the step before wrote it (" +
                               e.what() + "); --again with that step's name makes it anew");
    } catch (const ConfigurationError& e) {
      throw ConfigurationError("step " + step.name + ": " + e.what());
    } catch (const std::runtime_error& e) {
      throw std::runtime_error("step " + step.name + ": " + e.what());
    }
  }
  return false;
}

}  // namespace calibrate_skin
