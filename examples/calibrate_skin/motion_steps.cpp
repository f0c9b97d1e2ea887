// Motion, and the lines that it shows.
#include <algorithm>
#include <cmath>
#include <map>

#include "examples/calibrate_skin/fits.hpp"
#include "examples/calibrate_skin/json_values.hpp"
#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/wire.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"
#include "skinctl/calibration/detail/symmetric.hpp"

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

namespace {

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

constexpr double step_of_readings = 1.0 / 256;  // [g]

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

// Whether the axes up to a link's are known, and no two of them alone are parallel.
bool carried_by_known(const JointLines& found, int link) {
  double across = 0;
  for (std::size_t j = 0; int(j) <= link; ++j) {
    if (!found.lines[j].known) return false;
    across = std::max(across, found.lines[0].line.direction.cross(found.lines[j].line.direction).norm());
  }
  return across > 0.2;
}

// The gauge of lines: turned about the vertical and moved so that they lie on the maker's.
FitPose onto_maker(const std::vector<CalibratedLine>& lines, const std::vector<FitPose>& X) {
  double s = 0, c = 0;
  for (std::size_t j = 0; j < X.size(); ++j) {
    if (!lines[j].known) continue;
    const Eigen::Vector3d d = lines[j].line.direction, z = X[j].R.col(2);
    s += d.x() * z.y() - d.y() * z.x(), c += d.x() * z.x() + d.y() * z.y();
  }
  FitPose out;
  out.R = turn(std::atan2(s, c) * Eigen::Vector3d::UnitZ());
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < X.size(); ++j) {
    if (!lines[j].known) continue;
    const Eigen::Vector3d z = X[j].R.col(2);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - z * z.transpose();
    A += across, b += across * (X[j].p - out.R * lines[j].line.point);
  }
  out.p = skinctl::detail::solve_symmetric(A, b);
  return out;
}

// Where a patch sits on its link by the motion of its cells: the mean of what each of them says.
Json placed_by_motion(const JointLines& found, const Recorded& which, std::size_t patch, std::size_t link,
                      const Robot& robot) {
  const auto X = robot.link_poses(robot.home);
  const FitPose on_link = X[link].inverse() * onto_maker(found.lines, X);
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
    for (const FitPose& one : all) {
      off += turn_vector(mean.R.transpose() * one.R) / double(all.size());
      place += one.p / double(all.size());
    }
    mean = {mean.R * turn(off), place};
  }
  return {{"pose", json_of(mean)},
          {"covariance", json_of(Matrix6d(covariance / double(all.size())))},
          {"cells", all.size()}};
}

MotionRecording felt_in_world(const World& world, const std::vector<std::uint16_t>& ids,
                              const PlannedMotion& planned, const Options& options) {
  Arm arm(options.arm, world.robot());
  static_cast<void>(arm.go(options.arm.robot.home));
  return world.moved(ids, arm.follow(planned.path, planned.duration));
}

// As the model's masses predict them of a measured motion.
Eigen::MatrixXd predicted_torque(const Robot& robot, const JointRecording& joints) {
  const MeasuredMotion motion(joints);
  Eigen::MatrixXd out(joints.q.rows(), joints.q.cols());
  for (std::size_t k = 0; k < joints.time.size(); ++k)
    out.row(Eigen::Index(k)) = robot.torque(motion.at(joints.time[k])).transpose();
  return out;
}

MotionRecording felt_on_wire(const std::vector<std::uint16_t>& ids, const PlannedMotion& planned,
                             const Options& options, std::string& said) {
  WireSkin skin(options.wire);
  Arm arm(skin.listening(options.arm), {});
  static_cast<void>(arm.go(options.arm.robot.home));
  skin.begin();
  const Ride ride = arm.follow(planned.path, planned.duration);
  MotionRecording out;
  out.joints = ride.measured;
  out.torque = options.arm.robot.torque ? predicted_torque(options.arm.robot, ride.measured) : ride.torque;
  const double duration = ride.measured.time.back();
  const auto least = std::size_t(50 * duration);  // a fifth of what 250 measurements a second give
  for (const std::uint16_t id : ids) out.cells.push_back(skin.readings(id, ride.begin, duration, least));
  said = "; " + skin.said();
  return out;
}

}  // namespace

Json motion_step(const World& world, const Options& options) {
  const Recorded which = recorded(read_json(options.folder / "shape.json"));
  const PlannedMotion planned = options.arm.robot.excitation();
  ask(options, planned.announcements);
  std::string said;
  const MotionRecording felt = options.wire.port != 0 ? felt_on_wire(which.ids, planned, options, said)
                                                      : felt_in_world(world, which.ids, planned, options);
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
          {"said", text("%zu cells, %.0f s", which.ids.size(), felt.joints.time.back()) + said}};
}

Json lines_step(const Options& options) {
  const Json shapes = read_json(options.folder / "shape.json");
  const Recorded which = recorded(shapes);
  const JointLines found = fit_lines(recording_of(read_json(options.folder / "motion.json"), which));
  Json links = Json::array(), axes = Json::array(), unknown = json_of(found.unobservable);
  const Robot& robot = options.arm.robot;
  require(found.lines.size() == robot.joints(), "joints of the recording", double(found.lines.size()),
          "as many as the robot has");
  const bool all_known =
      found.joints.size() == robot.joints() &&
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
    if (const auto next = std::size_t(link + 1);
        next < robot.joints() && !found.activation.moved_alone[next]) {
      unknown.push_back(
          {{"what", text("link of the patch of cell %d: joint %zu never moved alone",
                         shapes.at("patches").at(k).at("cells").at(0).at("id").get<int>(), next)},
           {"deviation", Json()},
           {"unit", ""},
           {"remedy", text("move joint %zu alone for a second or more", next)}});
      link = -1;
    }
    links.push_back({{"link", link},
                     {"agree", most},
                     {"of", cells},
                     {"placed", link >= 0 && carried_by_known(found, link)
                                    ? placed_by_motion(found, which, k, std::size_t(link), robot)
                                    : Json()}});
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

}  // namespace calibrate_skin
