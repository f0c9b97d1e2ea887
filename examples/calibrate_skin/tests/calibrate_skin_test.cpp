// Promise: a robot somewhere else moves only when somebody agreed to what was announced
// Tried: a UR5 in another process: without consent nothing moves, no file
//
// Promise: a skin without names becomes a skin file that the main job runs on, and what is not known is
// not written
// Tried: 200 cells on six links of a UR5 that moves over its protocol, within its limits and announced; a
// run that was stopped goes on; recordings cut short, not numbers, ids twice, connectors to nowhere,
// files of others: refused in words, no skin file; behind a joint that never moves no patch is written;
// force and way of the main job within 5 % of the run with the true file (0.6 % at most;
// `calibrate_skin_study`, over seeds), and back at its task after each touch.
// Also: `examples/calibrate_skin/calibrate_skin`

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "examples/calibrate_skin/images.hpp"
#include "examples/calibrate_skin/judge.hpp"
#include "examples/calibrate_skin/report.hpp"
#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/wire.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "examples/support/run_program.hpp"
#include "skinctl/io/skin_file.hpp"

#ifdef CALIBRATE_SKIN_HAS_CAMERA
#include "examples/calibrate_skin/wire_camera.hpp"
#endif

using namespace calibrate_skin;

namespace {

// A folder that is gone with the object.
struct Folder {
  fs::path path;
  explicit Folder(const std::string& name = {})
      : path(fs::temp_directory_path() / ("calibrate_skin_" + std::to_string(getpid()) + name)) {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  [[nodiscard]] bool has(const char* file) const { return fs::exists(path / file); }
};

// One calibration, whose files all cases take.
struct Calibrated {
  Folder folder;
  World world{3};
  Options options;
  std::vector<std::string> said;
  Calibrated() {
    options.folder = folder.path;
    options.say = [this](const std::string& line) { said.push_back(line); };
    run_steps(options, world);
    write_results(options);
  }
  // A copy of the files whose `file` is another one; the files behind it are gone.
  struct Spoilt {
    Folder folder;
    Options options;
  };
  std::string error_with(const char* file, const Json& value, const std::string& plain = {},
                         bool masses = false) {
    const fs::path copy = folder.path / "spoilt";
    fs::remove_all(copy);
    fs::create_directories(copy);
    for (const char* f : {"network.json", "rest.json", "shape.json", "motion.json"})
      fs::copy_file(folder.path / f, copy / f);
    if (masses)
      for (const char* f : {"lines.json", "camera.json", "result.json"})
        fs::copy_file(folder.path / f, copy / f);
    write_text(copy / file, plain.empty() ? value.dump() : plain);
    if (file != std::string("motion.json") && !masses) fs::remove(copy / "shape.json");
    Options o = options;
    o.folder = copy;
    o.camera = masses, o.masses = masses;
    try {
      run_steps(o, world);
      write_results(o);
    } catch (const std::exception& e) {
      CHECK(!fs::exists(copy / "skin.json"));
      return e.what();
    }
    return "no error";
  }
};
Calibrated& calibrated() {
  static Calibrated all;
  return all;
}

}  // namespace

TEST_CASE("Calibrate skin: from cells without names to a skin file whose cells are where they truly are") {
  Calibrated& c = calibrated();
  const auto file = skinctl::read_skin_file((c.folder.path / "skin.json").string());
  const SkinError e = skin_error(file, c.world);
  MESSAGE(e.cells << " cells of " << e.of << ", " << 1e3 * e.place_rms << " mm, worst "
                  << 1e3 * e.place_worst);
  CHECK(e.cells >= 170);
  CHECK(e.wrong_link == 0);
  CHECK(e.place_worst < 1.5e-3);
  CHECK(e.turn_worst < 0.035);
  // The shoulder's patch turns about gravity only: it is not guessed.
  for (const auto& patch : file.patches)
    if (patch.link == "shoulder_link")
      for (const auto& cell : patch.cells) CHECK(!cell.masked.empty());
  for (const char* written : {"skin.json", "model.urdf", "dh.txt", "report.html"})
    CHECK(c.folder.has(written));
  const std::string report = report_of(c.folder.path);
  CHECK(report.find("What was not observable") != std::string::npos);

  // A run that was stopped goes on: nothing is done twice.
  c.said.clear();
  run_steps(c.options, c.world);
  CHECK(c.said.size() == 9);
  CHECK(std::all_of(c.said.begin(), c.said.end(),
                    [](const auto& line) { return line.find("kept") != std::string::npos; }));
}

TEST_CASE(
    "Calibrate skin: masses and friction from currents, in the model that is written; the arm follows by "
    "them") {
  Calibrated& c = calibrated();
  const MassError e = mass_error(c.folder.path, c.world);
  const Json masses = read_json(c.folder.path / "masses.json"), &following = masses.at("following");
  const auto found = following.at("found").get<double>(), maker = following.at("maker").get<double>();
  MESSAGE("M off by " << 100 * e.found << " %, the maker's by " << 100 * e.maker << " %; follows to "
                      << 1e3 * found << " mrad, by the maker's bodies to " << 1e3 * maker
                      << "; currents come " << 1e3 * masses.at("lateness").get<double>() << " ms late");
  CHECK(e.found < 0.02);
  CHECK(e.maker > 0.1);
  CHECK(e.not_positive == 0);
  CHECK(found < 0.3 * maker);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(masses.at("viscous").at(i).get<double>() ==
          doctest::Approx(c.world.robot().viscous[i]).epsilon(0.15));
    CHECK(masses.at("coulomb").at(i).get<double>() ==
          doctest::Approx(c.world.robot().coulomb[i]).epsilon(0.15));
  }
  std::ifstream in(c.folder.path / "model.urdf");
  const std::string urdf{std::istreambuf_iterator<char>(in), {}};
  std::size_t links = 0;
  for (std::size_t at = 0; (at = urdf.find("<inertial>", at + 1)) != std::string::npos;) ++links;
  CHECK(links == 6);
  CHECK(report_of(c.folder.path).find("Masses and friction") != std::string::npos);

  // Recordings that are short, damaged, or of a joint that stood still.
  const Json recording = read_json(c.folder.path / "torques.json");
  const auto error = [&](const Json& spoilt) { return c.error_with("torques.json", spoilt, {}, true); };
  Json cut = recording;
  for (const char* rows : {"time", "joints", "torques"}) cut[rows].get_ref<Json::array_t&>().resize(150);
  CHECK(error(cut).find("torques of a recording") != std::string::npos);
  Json hole = recording;
  hole["torques"][700][1] = nullptr;
  CHECK(error(hole).find("torques that are not finite") != std::string::npos);
  Json still = recording;
  for (auto& row : still["joints"]) row[4] = 1.0;
  CHECK(error(still).find("its friction is not known otherwise") != std::string::npos);
}

TEST_CASE(
    "Calibrate skin: a robot that is another process moves only when somebody agreed, and as announced") {
  simulated_ur5::Config config;
  config.controller.powered = true;
  config.ports = {0, 0, 0, 0, 0};
  config.speed = 0;
  simulated_ur5::SimulatedUr5 robot(std::move(config));
  robot.start();
  const auto ports = robot.ports();
  const Folder folder("_robot");
  const std::string arguments = "--robot 127.0.0.1 --own-clock --until rest --folder " +
                                folder.path.string() + " --rtde-port " + std::to_string(ports.rtde) +
                                " --script-port " + std::to_string(ports.secondary) + " --dashboard-port " +
                                std::to_string(ports.dashboard);
  const auto stood = robot.snapshot().true_q;
  const std::string nobody = examples::run_program(CALIBRATE_SKIN_PROGRAM, arguments + " < /dev/null", 2);
  CHECK(nobody.find("the robot at 127.0.0.1 MOVES") != std::string::npos);
  CHECK(nobody.find("nobody can be asked: --yes says that the robot may move") != std::string::npos);
  CHECK(robot.snapshot().true_q == stood);
  CHECK(!folder.has("rest.json"));

  const std::string agreed =
      examples::run_program(CALIBRATE_SKIN_PROGRAM, arguments + " --yes < /dev/null", 0);
  CHECK(agreed.find("through 8 poses and back to home") != std::string::npos);
  REQUIRE(folder.has("rest.json"));
  CHECK(read_json(folder.path / "rest.json").at("poses").size() == 8);
  const auto now = robot.snapshot().true_q;
  for (std::size_t i = 0; i < 6; ++i) CHECK(now[i] == doctest::Approx(home[i]).epsilon(0.01).scale(1));
  CHECK(!folder.has("shape.json"));
}

// Of the point that was touched [m]: by position the main job's own touches leave 1.8 mm at most.
constexpr double back_at_task = 2e-3;

TEST_CASE("Calibrate skin: the main job on the files presses and gives way as on the true ones, to 5 %") {
  Calibrated& c = calibrated();
  const auto touches = main_job_on(c.folder.path, c.world);
  CHECK(touches.size() == 3);
  for (const JobTouch& t : touches) {
    CAPTURE(t.link);
    MESSAGE("force " << t.force[0] << " N, true " << t.force[1] << "; way " << 1e3 * t.deflection[0]
                     << " mm, true " << 1e3 * t.deflection[1] << "; left " << 1e3 * t.left[0] << " mm");
    CHECK(t.force[0] == doctest::Approx(t.force[1]).epsilon(0.05));
    CHECK(t.deflection[0] == doctest::Approx(t.deflection[1]).epsilon(0.05));
    // Else the next touch meets an arm that stands elsewhere with each file.
    for (const double left : t.left) CHECK(left < back_at_task);
  }
}

TEST_CASE(
    "Calibrate skin: accelerations of another one's skin, over a socket that loses a twentieth, give the "
    "same places") {
  const Folder folder("_wire");
  const SkinError e = over_wire(folder.path, 3, 0.05);
  MESSAGE(e.cells << " cells of " << e.of << ", " << 1e3 * e.place_rms << " mm, worst " << 1e3 * e.place_worst
                  << "; " << 57.3 * e.turn_rms << " deg");
  CHECK(e.cells >= 150);
  CHECK(e.wrong_link == 0);
  CHECK(e.place_rms < 2e-3);
  CHECK(e.turn_rms < 0.0175);
  CHECK(read_json(folder.path / "rest.json").at("said").get<std::string>().find(" 0 lost") ==
        std::string::npos);

  // A cell that says nothing is named; of a skin that says nothing at all, how much came.
  WireSkin silent({});
  CHECK_THROWS_WITH(static_cast<void>(silent.mean(7, 20)),
                    doctest::Contains("cell 7 sent 0 accelerations of the 20 that are needed"));
  CHECK_THROWS_WITH(static_cast<void>(silent.mean(7, 20)), doctest::Contains("0 datagrams of the skin"));
}

#ifdef CALIBRATE_SKIN_HAS_CAMERA
TEST_CASE(
    "Calibrate skin: another one's skin is told over a socket which lights are on, and a camera places it") {
  const Folder folder("_lights");
  const SkinError by_motion = over_wire(folder.path, 3, 0), seen = seen_over_wire(folder.path, 3);
  const Json camera = read_json(folder.path / "camera.json");
  MESSAGE(camera.at("said").get<std::string>());
  MESSAGE("by motion " << 1e3 * by_motion.place_rms << " mm, worst " << 1e3 * by_motion.place_worst
                       << "; by lights " << 1e3 * seen.place_rms << " mm, worst " << 1e3 * seen.place_worst
                       << ", " << seen.cells << " cells");
  CHECK(camera.at("by") == "camera");
  CHECK(camera.at("residual").get<double>() < 0.5);
  CHECK(seen.cells >= 150);
  CHECK(seen.wrong_link == 0);
  CHECK(seen.place_rms < 1e-3);
  CHECK(seen.turn_rms < 0.0175);
  std::size_t by_lights = 0;
  for (const auto& patch : camera.at("patches")) by_lights += patch.value("agreeing", 0) >= 50;
  CHECK(by_lights >= 3);
}

TEST_CASE("Calibrate skin: a lens is read, and what no lens is is refused; a device that is none, too") {
  const Folder folder("_lens");
  const fs::path file = folder.path / "lens.json";
  write_json(file, {{"fx", 900}, {"fy", 910}, {"cx", 640}, {"cy", 480}});
  const Lens plain = Lens::read(file);
  CHECK(plain.camera.fy == 910);
  CHECK(plain.straight({3, 4}) == Eigen::Vector2d(3, 4));
  write_json(file,
             {{"fx", 900}, {"fy", 910}, {"cx", 640}, {"cy", 480}, {"distortion", {-0.2, 0.05, 0, 0, 0}}});
  const Lens bent = Lens::read(file);
  for (const double x : {-0.5, 0.1, 0.6}) {
    const double y = 0.3, r2 = x * x + y * y, b = 1 - 0.2 * r2 + 0.05 * r2 * r2;
    const Eigen::Vector2d at = bent.straight({900 * b * x + 640, 910 * b * y + 480});
    CHECK((at - Eigen::Vector2d(900 * x + 640, 910 * y + 480)).norm() < 0.05);
  }
  write_json(file, {{"fx", 900}, {"cx", 640}, {"cy", 480}});
  CHECK_THROWS_WITH(static_cast<void>(Lens::read(file)), doctest::Contains("a lens needs fx, fy, cx, cy"));
  write_json(file, {{"fx", -900}, {"fy", 910}, {"cx", 640}, {"cy", 480}});
  CHECK_THROWS_WITH(static_cast<void>(Lens::read(file)), doctest::Contains("lens: fx, fy"));
  write_json(file, {{"fx", 900}, {"fy", 910}, {"cx", 640}, {"cy", 480}, {"distortion", {1, 2}}});
  CHECK_THROWS_WITH(static_cast<void>(Lens::read(file)), doctest::Contains("none or 5"));
  CHECK_THROWS_WITH(VideoImages((folder.path / "no_such.png").string()),
                    doctest::Contains("cannot be opened"));
}
#endif

TEST_CASE("Calibrate skin: currents that say nothing cost the masses, not the skin") {
  Calibrated& c = calibrated();
  const Folder folder("_last");
  for (const char* f : {"network.json", "rest.json", "shape.json", "motion.json", "lines.json", "camera.json",
                        "result.json", "torques.json"})
    fs::copy_file(c.folder.path / f, folder.path / f);
  Json still = read_json(c.folder.path / "torques.json");
  for (auto& row : still["joints"]) row[4] = 1.0;
  write_json(folder.path / "torques.json", still);
  Options o = c.options;
  o.folder = folder.path;
  CHECK_THROWS_WITH(static_cast<void>(calibrate(o, 3, {}, {}, {})), doctest::Contains("step masses"));
  REQUIRE(folder.has("skin.json"));
  CHECK(skinctl::read_skin_file((folder.path / "skin.json").string()).cells() ==
        skinctl::read_skin_file((c.folder.path / "skin.json").string()).cells());
  CHECK(folder.has("model.urdf"));
  CHECK(folder.has("report.html"));
}

TEST_CASE("Calibrate skin: damaged files are refused in words, and nothing wrong is written") {
  Calibrated& c = calibrated();
  const auto has = [](const std::string& text, const char* part) {
    INFO(text);
    CHECK(text.find(part) != std::string::npos);
  };
  has(c.error_with("motion.json", {}, "{\"time\": [0, 0.008"), "no JSON; remove it, and its step runs again");
  has(c.error_with("motion.json", Json::object()), "not as the step before wrote it");

  const Json recording = read_json(c.folder.path / "motion.json");
  Json cut = recording;  // after five seconds
  for (const char* rows : {"time", "joints", "torques"}) cut[rows].get_ref<Json::array_t&>().resize(625);
  has(c.error_with("motion.json", cut), "step ");
  Json hole = recording;
  hole["joints"][1000][2] = nullptr;
  has(c.error_with("motion.json", hole), "not finite");
  Json other = recording;
  other["cells"][1]["id"] = 9999;
  has(c.error_with("motion.json", other), "another one than that of shape.json");
  Json shorter = recording;
  shorter["cells"].erase(3);
  has(c.error_with("motion.json", shorter), "other cells than those of shape.json");

  Json lost = read_json(c.folder.path / "rest.json");
  lost["readings"].erase(0);
  has(c.error_with("rest.json", lost), "rest.json is of another network");

  Json twice = read_json(c.folder.path / "network.json");
  twice["patches"][0]["ids"][1] = twice["patches"][0]["ids"][0];
  has(c.error_with("network.json", twice), "occurs twice in a patch");
  Json nowhere = read_json(c.folder.path / "network.json");
  nowhere["patches"][0]["joints"][0][1] = 4000;
  has(c.error_with("network.json", nowhere), "names a cell or a port that is not there");

  Options nobody = c.options;
  nobody.agreed = [](const auto&) { return false; };
  nobody.folder = c.folder.path / "nobody";
  fs::create_directories(nobody.folder);
  CHECK_THROWS_WITH(run_steps(nobody, c.world), doctest::Contains("nobody agreed to the motion"));
  CHECK(!fs::exists(nobody.folder / "rest.json"));
}

TEST_CASE("Calibrate skin: behind a joint that never moved alone no patch has a link, before it each has") {
  Calibrated& c = calibrated();
  const auto cut_after = [&](std::size_t rows_of_8_ms) {
    Json still = read_json(c.folder.path / "motion.json");
    for (const char* rows : {"time", "joints", "torques"})
      still[rows].get_ref<Json::array_t&>().resize(rows_of_8_ms);
    return c.error_with("motion.json", still);
  };
  CHECK(cut_after(2500) == "no error");  // 20 s: joint 5 has not moved yet
  const fs::path folder = c.folder.path / "spoilt";
  const Json found = read_json(folder / "lines.json");
  for (std::size_t k = 0; k < found.at("links").size(); ++k) CHECK(found["links"][k]["link"].get<int>() < 4);
  CHECK(found.at("unobservable").dump().find("joint 5 never moved alone") != std::string::npos);
  CHECK(read_json(c.folder.path / "lines.json").at("links").dump().find("\"link\":5") != std::string::npos);
  const auto file = skinctl::read_skin_file((folder / "skin.json").string());
  REQUIRE(file.links.size() == 3);
  CHECK(file.links.back().name == "wrist_1_link");
  const SkinError e = skin_error(file, c.world);
  MESSAGE(e.cells << " cells of " << e.of << ", " << 1e3 * e.place_rms << " mm, worst " << 1e3 * e.place_worst
                  << "; worst turn " << 57.3 * e.turn_worst << " deg");
  CHECK(e.wrong_link == 0);
  CHECK(e.place_worst < 1.5e-3);
  CHECK(e.turn_worst < 0.035);
  CHECK(!fs::exists(folder / "model.urdf"));

  // 8 s: the upper arm's may as well be those of a joint behind, and gravity does not show the shoulder's.
  const std::string error = cut_after(1000);
  INFO(error);
  CHECK(error.find("no patch has both a shape and a link") != std::string::npos);
}

TEST_CASE("Calibrate skin: the camera starts from where somebody placed the first cells on the page") {
  Calibrated& c = calibrated();
  const Json shapes = read_json(c.folder.path / "shape.json"),
             moved = read_json(c.folder.path / "lines.json");
  skinctl::SkinFile page = skin_file_of(ur5_robot(), read_json(c.folder.path / "result.json"));
  for (auto& patch : page.patches) patch.X_LinkRoot.p.x += 0.02;  // as a hand would
  Json placed = {{"patches", Json::object()}};
  place_by(ur5_robot(), page, shapes, moved, placed);
  CHECK(placed["patches"].size() == page.patches.size());
  for (const auto& p : read_json(c.folder.path / "result.json").at("patches")) {
    const skinctl::FitPose found = pose_of(p.at("pose")),
                           start = pose_of(placed["patches"].at(p.at("cells").at(0).at("id").dump()));
    CHECK((start.p - found.p - Eigen::Vector3d(0.02, 0, 0)).norm() < 1e-12);
    CHECK((start.R - found.R).norm() < 1e-12);
  }
  page.patches.front().link = page.patches.front().link == "forearm_link" ? "wrist_1_link" : "forearm_link";
  CHECK_THROWS_WITH(place_by(ur5_robot(), page, shapes, moved, placed), doctest::Contains("but moves with"));
}

#ifdef CALIBRATE_SKIN_HAS_CAMERA
TEST_CASE("Calibrate skin: lights are found in images where they are") {
  Calibrated& c = calibrated();
  const std::vector<JointAngles> poses = {ur5_robot().camera_poses(3)[0]};
  const CameraReport shown = c.world.seen(poses, false);
  std::string said;
  const CameraReport found = seen_in_images(c.world, poses, said);
  std::size_t right = 0, wrong = 0;
  for (const auto& light : found.lights) {
    const auto at = std::find_if(shown.lights.begin(), shown.lights.end(),
                                 [&](const auto& l) { return l.id == light.id; });
    const bool same = at != shown.lights.end() && (at->pixel - light.pixel).norm() < 0.5;
    right += same, wrong += !same;
  }
  MESSAGE(said << "; " << shown.lights.size() << " shown, " << right << " right, " << wrong << " wrong");
  CHECK(right > 20);
  CHECK(10 * wrong < right);
}
#endif

TEST_CASE("Calibrate skin: the program says what it wants") {
  const std::string help = examples::run_program(CALIBRATE_SKIN_PROGRAM, "--help", 0);
  CHECK(help.find("Exit codes") != std::string::npos);
  examples::run_program(CALIBRATE_SKIN_PROGRAM, "--seed 0", 2);
  const Folder folder;
  const std::string path = folder.path.string();
  write_json(folder.path / "which.json", {{"seed", 9}});
  const std::string other = examples::run_program(CALIBRATE_SKIN_PROGRAM, "--quiet --folder " + path, 2);
  CHECK(other.find("holds a calibration with other options") != std::string::npos);
}
