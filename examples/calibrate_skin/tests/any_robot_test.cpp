// Promise: a robot that is no UR5 is calibrated from its URDF, by the protocol that moves it
// Tried: an FR3 by FCI, an iiwa by FRI, six joints by stream motion, RSI and EGM, each with two patches whose
// datagrams come over a socket; every robot of examples/data within the limits of its file; a branch, three
// joints, a home beyond a limit, ways beyond the correction of RSI: refused in a sentence. Also:
// `examples/calibrate_skin/any_robot`

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "examples/adapters/skin/sender.hpp"
#include "examples/calibrate_skin/arm.hpp"
#include "examples/calibrate_skin/judge.hpp"
#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/simulated_arm/egm.hpp"
#include "examples/simulated_arm/franka.hpp"
#include "examples/simulated_arm/fri.hpp"
#include "examples/simulated_arm/rsi.hpp"
#include "examples/simulated_arm/stream_motion.hpp"
#include "examples/simulated_ur5/skin.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/skin_at_rest.hpp"

using namespace calibrate_skin;
using skinctl::FitPose;

namespace {

const JointAngles ready = {0, -0.785, 0, -2.356, 0, 1.571, 0.785};
const JointAngles home_of_six = {0, 0.3, 0.2, 0, 1.0, 0};

simulated_ur5::Vec3 vec(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

// The forearm's and the second wrist's skin of a UR5, glued askew onto two links of another robot.
World two_patches(std::uint64_t seed, std::size_t first, std::size_t second) {
  auto rng = skinctl::testing::seeded(seed);
  const auto worn = skinctl::ur5::skin_patches<200>();
  std::vector<World::Cell> cells;
  const auto glue = [&](const auto& patch, std::size_t link) {
    const FitPose glued{skinctl::turn(skinctl::testing::normal3(rng, 0.5)),
                        skinctl::testing::normal3(rng, 0.03)};
    for (const auto& cell : patch.any())
      cells.push_back({0,
                       link,
                       glued * FitPose{as_eigen(cell.X_LC.axes()), as_eigen(cell.X_LC.origin())},
                       {},
                       Eigen::Matrix3d::Identity()});
  };
  glue(std::get<2>(worn), first), glue(std::get<4>(worn), second);
  return World(seed, std::move(cells));
}

// What its cells feel of a robot goes to a port as datagrams, each `period` [ms], of whole cycles.
class Worn {
 public:
  Worn(const World& world, const Robot& robot, std::uint16_t port, std::int64_t period)
      : period_(period),
        robot_(robot),
        skin_(cells_of(world), config(period), world.seed()),
        sender_("127.0.0.1", port) {}
  void feel(double time, std::span<const double> q) {
    const auto tick = std::llround(1e3 * time);
    if (tick % period_ != 0) return;
    const auto at = robot_.link_poses({q.begin(), q.end()});
    simulated_ur5::Links links;
    for (std::size_t l = 0; l < links.link.size(); ++l)
      links.link[l] = {vec(at[l].R.col(0)), vec(at[l].R.col(1)), vec(at[l].R.col(2)), vec(at[l].p)};
    const simulated_ur5::Nanoseconds now = tick * 1'000'000;
    sender_.send(skin_.sample(now, links, {}), std::chrono::nanoseconds(now));
  }

 private:
  static simulated_ur5::SkinConfig config(std::int64_t period) {
    simulated_ur5::SkinConfig out;
    out.period = period * 1'000'000;
    err_as_cheap_ones(out);
    return out;
  }
  static std::vector<simulated_ur5::SkinCell> cells_of(const World& world) {
    std::vector<simulated_ur5::SkinCell> out;
    for (const World::Cell& c : world.truth())
      out.push_back(
          {c.id, c.link, vec(c.X_LinkCell.p), vec(c.X_LinkCell.R.col(2)), vec(c.X_LinkCell.R.col(0))});
    return out;
  }
  std::int64_t period_;
  const Robot& robot_;
  simulated_ur5::Skin skin_;
  adapters::skin::Sender sender_;
};

struct Folder {
  fs::path path = fs::temp_directory_path() / ("calibrate_any_" + std::to_string(getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

// Six or fewer turning joints in a row, the last of them on another link than the one before.
std::string urdf_of(int joints, int last_on) {
  std::string out = "<robot name='r'><link name='l0'/>";
  for (int j = 1; j <= joints; ++j) {
    const std::string own = std::to_string(j), on = std::to_string(j == joints ? last_on : j - 1);
    out += "<link name='l" + own +
           "'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>" +
           "</link><joint name='j" + own + "' type='revolute'><parent link='l" + on + "'/><child link='l" +
           own + "'/><origin xyz='0 0 0.2'/><axis xyz='" + (j % 2 == 0 ? "0 1 0" : "0 0 1") +
           "'/><limit lower='-2' upper='2' velocity='2' effort='90'/></joint>";
  }
  return out + "</robot>";
}

// Two patches on the links `first` and `second`. `begin` is a person at the controller, who begins its
// program before each of the two motions.
template <class Begin>
void calibrate_by(const char* protocol, const Robot& robot, std::size_t first, std::size_t second,
                  double worst, Begin begin) {
  CAPTURE(std::string(protocol));
  const Folder folder;
  Options options;
  options.folder = folder.path;
  options.camera = options.masses = false;
  options.arm.robot = robot;
  options.arm.host = "127.0.0.1", options.arm.protocol = protocol, options.arm.own_clock = true;
  options.arm.port = adapters::UdpSocket::at("127.0.0.1", 0).port();
  options.wire.port = adapters::UdpSocket::at("127.0.0.1", 0).port();
  options.wire.network = folder.path / "told.json";
  const World world = two_patches(3, first, second);
  write_json(options.wire.network, network_step(world, {}));
  std::string said;
  options.say = [&](const std::string& line) { said += line + "\n"; };
  for (const char* until : {"rest", ""}) {
    Worn worn(world, robot, options.wire.port, options.arm.protocol == "stream_motion" ? 8 : 4);
    simulated_arm::Config config;
    config.speed = 0;
    if (robot.joints() == 6) std::copy(robot.home.begin(), robot.home.end(), config.home.begin());
    config.watched = [&](double t, std::span<const double> q) { worn.feel(t, q); };
    const auto peer = begin(config, options.arm.port);
    if (options.arm.protocol == "franka") options.arm.port = peer->port();
    try {
      run_steps(options, world, {}, until);
    } catch (const std::exception& e) {
      FAIL(std::string(e.what()) << "; the controller: " << peer->snapshot().ended << "\n" << said);
    }
  }
  INFO(said);
  write_results(options);
  const auto file = skinctl::read_skin_file((folder.path / "skin.json").string());
  const SkinError e = skin_error(file, world, robot);
  MESSAGE(std::string(protocol) << ": " << e.cells << " cells of " << e.of << ", " << 1e3 * e.place_rms
                                << " mm, worst " << 1e3 * e.place_worst << "; " << 57.3 * e.turn_rms
                                << " deg");
  CHECK(e.of == world.truth().size());
  CHECK(10 * e.cells >= 9 * e.of);
  CHECK(e.wrong_link == 0);
  CHECK(e.place_worst < worst);
  CHECK(e.turn_worst < 0.035);
  REQUIRE(file.links.size() == 2);
  CHECK(file.links[0].name == robot.links[first].name);
  CHECK(file.links[1].name == robot.links[second].name);
  CHECK(fs::exists(folder.path / "report.html"));
}

using Seven = skinctl::CalibratedModel<skinctl::Chain<7>>;
Seven body_of(const char* urdf) {
  return skinctl::calibrated_from<skinctl::Chain<7>>(skinctl::read_urdf(urdf));
}

}  // namespace

TEST_CASE("Calibrate any robot: an FR3 with two patches, by its URDF and its own protocol") {
  const Robot robot = robot_of({.file = SIMULATED_ARM_FR3, .home = ready});
  CHECK(robot.links[2].name == "link3");
  calibrate_by("franka", robot, 2, 4, 2e-3, [](const auto& config, std::uint16_t) {
    return simulated_arm::franka_controller(body_of(SIMULATED_ARM_FR3), config, {}, 0);
  });
}

TEST_CASE("Calibrate any robot: an iiwa by FRI, whose program begins anew for each motion") {
  const Robot robot = robot_of({.file = SIMULATED_ARM_IIWA, .home = {0, 0.5, 0, -1.3, 0, 1.3, 0}});
  calibrate_by("fri", robot, 2, 4, 2e-3, [](const auto& config, std::uint16_t port) {
    simulated_arm::FriConfig stiff;
    stiff.arm.stiffness = 4000;  // soft springs bend where another joint is to move alone
    return simulated_arm::fri_controller(body_of(SIMULATED_ARM_IIWA), config, stiff, "127.0.0.1", port);
  });
}

TEST_CASE("Calibrate any robot: six joints by the makers' protocols for positions") {
  // Less than the limits of the simulated FANUC, whose cycle of 8 ms shows half as many readings, and than 90
  // degrees of correction.
  const Robot robot = robot_of(
      {.file = CALIBRATE_SKIN_ARM6, .home = home_of_six, .reach = 1.5, .acceleration = 4, .jerk = 30});
  calibrate_by("stream_motion", robot, 2, 4, 8e-3, [](const auto& config, std::uint16_t port) {
    return simulated_arm::stream_motion_controller(config, {}, "127.0.0.1", port);
  });
  calibrate_by("rsi", robot, 2, 4, 4e-3, [](const auto& config, std::uint16_t port) {
    return simulated_arm::rsi_controller(config, {}, "127.0.0.1", port);
  });
  calibrate_by("egm", robot, 2, 4, 4e-3, [](const auto& config, std::uint16_t port) {
    return simulated_arm::egm_controller(config, {}, "127.0.0.1", port);
  });
}

TEST_CASE("Calibrate any robot: ways beyond the correction of RSI are refused before the arm moves") {
  ArmOptions options;
  options.robot = robot_of({.file = CALIBRATE_SKIN_ARM6, .home = home_of_six});  // 1.6 rad from home
  options.host = "127.0.0.1", options.protocol = "rsi", options.own_clock = true;
  options.port = adapters::UdpSocket::at("127.0.0.1", 0).port();
  simulated_arm::Config config;
  config.speed = 0;
  std::copy(home_of_six.begin(), home_of_six.end(), config.home.begin());
  const auto connect = [&] {
    const auto peer = simulated_arm::rsi_controller(config, {}, "127.0.0.1", options.port);
    try {
      Arm arm(options, {});
    } catch (...) {
      CHECK(peer->snapshot().moved_at == 0);
      throw;
    }
    return true;
  };
  CHECK_THROWS_WITH_AS(connect(), doctest::Contains("1.60 rad from where it stands"),
                       skinctl::ConfigurationError);
  options.max_correction = 100;
  CHECK(connect());
  config.home[1] += 0.3;  // 0.2 rad beyond it
  CHECK_THROWS_WITH_AS(connect(), doctest::Contains("joint 1"), skinctl::ConfigurationError);
}

TEST_CASE("Calibrate any robot: motions stay within the limits of the file and above the foot") {
  const auto check = [](const Robot& robot, const JointAngles& velocity) {
    const PlannedMotion planned = robot.excitation();
    for (double t = 0; t < planned.duration; t += 0.01) {
      const skinctl::JointPoint p = planned.path(t);
      for (std::size_t i = 0; i < robot.joints(); ++i) {
        REQUIRE(p.q(Eigen::Index(i)) > robot.lower[i]);
        REQUIRE(p.q(Eigen::Index(i)) < robot.upper[i]);
        REQUIRE(std::abs(p.dq(Eigen::Index(i))) < velocity[i]);
      }
    }
    CHECK(robot.lowest_point(planned, 0.05) >= clearance);
    for (const JointAngles& q : robot.rest_poses(1)) {
      CHECK(robot.lowest_point(q) >= clearance);
      for (std::size_t i = 0; i < q.size(); ++i) CHECK((q[i] >= robot.lower[i] && q[i] <= robot.upper[i]));
    }
    CHECK(robot.camera_poses(1).size() == 16);
  };
  check(robot_of({.file = SIMULATED_ARM_FR3, .home = ready}), {2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26});
  check(robot_of({.file = SIMULATED_ARM_IIWA, .home = {0, 0.5, 0, -1.3, 0, 1.3, 0}}), JointAngles(7, 2.6));
  check(ur5_robot(), JointAngles(6, 3.14));
}

TEST_CASE(
    "Calibrate any robot: a URDF that is none of six or seven joints in a chain is refused in a sentence") {
  const Folder folder;
  const std::string file = (folder.path / "robot.urdf").string();
  const auto refused = [&](const std::string& text, const JointAngles& at, const char* words) {
    std::ofstream(file) << text;
    CHECK_THROWS_WITH_AS(static_cast<void>(robot_of({.file = file, .home = at})), doctest::Contains(words),
                         skinctl::ConfigurationError);
  };
  refused(urdf_of(3, 2), {}, "3 joints move; a chain of six or seven is calibrated");
  refused(urdf_of(6, 3), {}, "it is joint 5 and the program expects it on");
  refused(urdf_of(6, 5), {0, 0, 0, 0, 0}, "--home: joints = 5");
  refused(urdf_of(6, 5), {0, 0, 0, 0, 0, 2}, "--home: j6 = 2");
  refused("<robot", {}, "robot.urdf");
  const Robot fine = [&] {
    std::ofstream(file) << urdf_of(6, 5);
    return robot_of({.file = file});
  }();
  CHECK(fine.joints() == 6);
  Options options;
  options.arm.robot = fine, options.arm.protocol = "franka", options.arm.host = "127.0.0.1";
  CHECK_THROWS_WITH(Arm(options.arm, {}), doctest::Contains("joints of the robot = 6"));
}
