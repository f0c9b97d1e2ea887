// The camera.
#include <map>
#include <optional>
#include <utility>

#include "examples/calibrate_skin/fits.hpp"
#include "examples/calibrate_skin/images.hpp"
#include "examples/calibrate_skin/json_values.hpp"
#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/wire.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"
#include "skinctl/frames/rotation.hpp"
#include "skinctl/io/skin_file.hpp"

#ifdef CALIBRATE_SKIN_HAS_CAMERA
#include "examples/adapters/camera/blinks.hpp"
#include "examples/calibrate_skin/wire_camera.hpp"
#endif

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

namespace {

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
  if (!options.placed.empty())
    place_by(options.arm.robot, read_skin_file(options.placed.string()), shapes, moved, placed);
  for (std::size_t k = 0; k < shapes.at("patches").size(); ++k) {
    const Json& by_motion = moved.at("links").at(k).at("placed");
    const auto root = std::to_string(shapes.at("patches").at(k).at("cells").at(0).at("id").get<int>());
    if (!by_motion.is_null()) placed["patches"][root] = by_motion.at("pose");
  }
  return placed;
}

CameraReport seen_by(const World& world, const std::vector<JointAngles>& stood, const Options& options) {
#ifdef CALIBRATE_SKIN_HAS_CAMERA
  if (options.images) {
    std::string said;
    CameraReport report = seen_in_images(world, stood, said);
    options.say(said);
    return report;
  }
#endif
  require(!options.images, "images", 1, "0: built without OpenCV");
  return world.seen(stood);
}

FitPose fit_pose(const SkinPose& X) {
  return {as_eigen(X.rotation()), {X.p.x, X.p.y, X.p.z}};
}

// How far two poses of a patch are apart: at the middle of its cells, and turned.
std::pair<double, double> apart(const FitPose& a, const FitPose& b,
                                const std::vector<Eigen::Vector3d>& cells) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& p : cells) middle += p / double(cells.size());
  return {(a * middle - b * middle).norm(), turn_vector(a.R.transpose() * b.R).norm()};
}

/// Patches that have both a shape and a link.
struct Placeable {
  std::vector<std::vector<Eigen::Vector3d>> cells;  ///< places of the known ones in each patch
  std::vector<std::string> names;
  std::vector<std::size_t> links, which;  ///< of each patch: its link, its index in `shape.json`
  std::map<std::uint16_t, std::pair<std::size_t, std::size_t>> index;  ///< patch and cell of an id

  Placeable(const Json& shapes, const Json& moved) {
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
  }
  /// Leaves out the patch at `i`.
  void erase(std::size_t i) {
    const auto at = std::ptrdiff_t(i);
    cells.erase(cells.begin() + at), names.erase(names.begin() + at);
    links.erase(links.begin() + at), which.erase(which.begin() + at);
    std::erase_if(index, [&](const auto& c) { return c.second.first == i; });
    for (auto& [id, place] : index) place.first -= place.first > i;
  }
};

Json by_motion_alone(const Placeable& patches, const Json& moved) {
  Json out = Json::array(), unknown = Json::array();
  for (std::size_t i = 0; i < patches.which.size(); ++i) {
    const Json& by_motion = moved.at("links").at(patches.which[i]).at("placed");
    if (by_motion.is_null()) {
      unknown.push_back({{"what", "place of " + patches.names[i]},
                         {"deviation", Json()},
                         {"unit", "m"},
                         {"remedy", "a camera, or a base that is tilted"}});
      continue;
    }
    out.push_back({{"patch", patches.which[i]},
                   {"pose", by_motion.at("pose")},
                   {"covariance", by_motion.at("covariance")},
                   {"cells", by_motion.at("cells")},
                   {"known", true}});
  }
  const std::string said = text("%zu patches placed by motion, without a camera", out.size());
  return {{"patches", std::move(out)}, {"by", "motion"}, {"unobservable", unknown}, {"said", said}};
}

/// What a camera saw, and from where the fit starts.
struct Looked {
  PinholeCamera camera;
  std::vector<CameraView> views;
  std::vector<FitPose> placed, cameras;
};
std::vector<CameraView> views_of(const CameraReport& report, const std::vector<JointAngles>& stood,
                                 const Placeable& patches, const Options& options) {
  std::vector<CameraView> views(stood.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto X = options.arm.robot.link_poses(stood[v]);
    for (const std::size_t l : patches.links) views[v].X_BaseLink.push_back(X[l]);
  }
  std::size_t used = 0;
  for (const auto& light : report.lights)
    if (const auto at = patches.index.find(light.id); at != patches.index.end())
      views[light.view].seen.push_back({at->second.first, at->second.second, light.pixel}), ++used;
  options.say(text("  %zu views, %zu lights of known cells", views.size(), used));
  return views;
}

Looked look_in_world(const World& world, const Options& options, const Placeable& patches, const Json& shapes,
                     const Json& moved) {
  const Json before = placed_before(world, options, shapes, moved);
  Looked out;
  for (const std::size_t k : patches.which) {
    const auto root = shapes.at("patches").at(k).at("cells").at(0).at("id").dump();
    if (!before.at("patches").contains(root))
      throw std::runtime_error("placed.json has no pose of the patch of cell " + root +
                               ", and motion did not place it");
    out.placed.push_back(pose_of(before.at("patches").at(root)));
  }
  out.cameras = {pose_of(before.at("camera"))};
  const auto poses = options.arm.robot.camera_poses(world.seed());
  ask(options, {announced(options.arm.robot, poses, 0.6)});
  std::vector<Arm::Stand> stood;
  {
    Arm arm(options.arm, world.robot());
    static_cast<void>(arm.go(options.arm.robot.home));
    stood = stands(arm, poses, options);
  }
  const CameraReport report = seen_by(world, truths(stood), options);
  std::vector<JointAngles> measured;
  for (const auto& s : stood) measured.push_back(s.measured);
  out.camera = report.camera, out.views = views_of(report, measured, patches, options);
  return out;
}

#ifdef CALIBRATE_SKIN_HAS_CAMERA
/// Of a skin and a camera that exist. Patches that neither motion nor a person placed are left out: their
/// names go to `unknown`.
Looked look_on_wire(const World& world, const Options& options, Placeable& patches, const Json& shapes,
                    const Json& moved, Json& unknown) {
  Json by_hand = {{"patches", Json::object()}};
  if (!options.placed.empty())
    place_by(options.arm.robot, read_skin_file(options.placed.string()), shapes, moved, by_hand);
  Looked out;
  for (std::size_t i = 0; i < patches.which.size();) {
    const Json& by_motion = moved.at("links").at(patches.which[i]).at("placed");
    const auto root = shapes.at("patches").at(patches.which[i]).at("cells").at(0).at("id").dump();
    if (by_motion.is_null() && !by_hand.at("patches").contains(root)) {
      unknown.push_back(
          {{"what", "place of " + patches.names[i]},
           {"deviation", Json()},
           {"unit", "m"},
           {"remedy", "--placed: a skin file of the placing page in which its first cell lies"}});
      patches.erase(i);
      continue;
    }
    out.placed.push_back(
        pose_of(by_motion.is_null() ? by_hand.at("patches").at(root) : by_motion.at("pose")));
    ++i;
  }
  if (patches.which.empty()) throw std::runtime_error("no patch was placed by motion or by hand");
  const auto poses = options.arm.robot.camera_poses(world.seed());
  const double blinks = double(camera::Blinks::images) * (options.camera_device.settle + 0.05);
  ask(options, {announced(options.arm.robot, poses, 0.6 + blinks)});
  WireSkin skin(options.wire);
  Arm arm(skin.listening(options.arm), {});
  static_cast<void>(arm.go(options.arm.robot.home));
  std::vector<std::uint32_t> ids;
  for (const auto& [id, place] : patches.index) ids.push_back(id);
  std::vector<JointAngles> stood;
  std::string said;
  const CameraReport report = seen_by_camera(options, ids, skin, arm, poses, stood, said);
  options.say(said);
  out.camera = report.camera, out.views = views_of(report, stood, patches, options);
  const std::vector<std::optional<FitPose>> at(out.placed.begin(), out.placed.end());
  out.cameras = cameras_by_views(out.camera, patches.cells, out.views, at);
  if (out.cameras.empty())
    throw std::runtime_error(
        "no view shows six lights of a patch: is the arm in the camera's sight, and dark?");
  return out;
}
#endif

}  // namespace

void place_by(const Robot& robot, const SkinFile& file, const Json& shapes, const Json& moved, Json& placed) {
  for (std::size_t k = 0; k < shapes.at("patches").size(); ++k) {
    const auto root = shapes.at("patches").at(k).at("cells").at(0).at("id").get<std::uint32_t>();
    for (const auto& patch : file.patches)
      for (const auto& cell : patch.cells) {
        if (cell.id != root) continue;
        const int l = moved.at("links").at(k).at("link").get<int>();
        const Robot::Link* link = l >= 0 ? &robot.links.at(std::size_t(l)) : nullptr;
        if (link == nullptr || patch.link != link->name)
          throw std::runtime_error(text("%s: cell %u lies on %s, but moves with %s", file.source.c_str(),
                                        root, patch.link.c_str(), link ? link->name.c_str() : "no link"));
        const FitPose X = link->X_LinkNamed * fit_pose(patch.X_LinkRoot) * fit_pose(cell.X_RootCell);
        placed["patches"][std::to_string(root)] = json_of(X);
      }
  }
}

Json camera_step(const World& world, const Options& options) {
  const Json shapes = read_json(options.folder / "shape.json"),
             moved = read_json(options.folder / "lines.json");
  Placeable patches(shapes, moved);
  if (!options.camera) return by_motion_alone(patches, moved);
  Json out = Json::array(), unknown = Json::array();
#ifdef CALIBRATE_SKIN_HAS_CAMERA
  const Looked looked = options.wire.port != 0 ? look_on_wire(world, options, patches, shapes, moved, unknown)
                                               : look_in_world(world, options, patches, shapes, moved);
#else
  require(options.wire.port == 0, "camera of a skin that exists", 1, "0: built without OpenCV");
  const Looked looked = look_in_world(world, options, patches, shapes, moved);
#endif
  const SightingFit found =
      fit_lights(looked.camera, patches.cells, patches.names, looked.views, looked.placed, looked.cameras);
  add(unknown, json_of(found.X_BaseCam.unobservable));
  double farthest = 0;
  std::size_t placed = 0, both = 0, alone = 0;
  for (std::size_t i = 0; i < patches.which.size(); ++i) {
    const auto& X = found.X_LinkRoot[i];
    const Json& by_motion = moved.at("links").at(patches.which[i]).at("placed");
    Json patch = {{"patch", patches.which[i]}, {"agreeing", found.agreeing[i]}, {"known", X.known()}};
    if (X.known() || by_motion.is_null()) {
      patch["pose"] = json_of(X.value), patch["covariance"] = json_of(Matrix6d(X.covariance));
      add(unknown, json_of(X.unobservable));
      if (X.known() && !by_motion.is_null()) {
        const auto [place, angle] = apart(X.value, pose_of(by_motion.at("pose")), patches.cells[i]);
        patch["motion_off"] = {place, angle};
        farthest = std::max(farthest, place), ++both;
      }
    } else {  // too few lights, of a single cell for instance: as motion says
      patch["pose"] = by_motion.at("pose"), patch["covariance"] = by_motion.at("covariance");
      patch["known"] = true, ++alone;
    }
    if (patch.at("known").get<bool>()) ++placed;
    out.push_back(std::move(patch));
  }
  return {{"patches", out},
          {"by", "camera"},
          {"residual", found.residual},
          {"disagreeing", found.disagreeing},
          {"unobservable", unknown},
          {"said", text("%zu of %zu patches placed, %zu of them by motion alone; residual %.2f pixels, %zu "
                        "sightings disagree; motion says of %zu the same to %.1f mm",
                        placed, patches.which.size(), alone, found.residual, found.disagreeing, both,
                        1e3 * farthest)}};
}

}  // namespace calibrate_skin
