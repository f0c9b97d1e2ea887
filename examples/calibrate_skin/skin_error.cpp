// A calibrated skin against the truth; and a calibration whose skin is another one's, over a socket.
#include <Eigen/Geometry>
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cmath>
#include <memory>

#include "examples/calibrate_skin/judge.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/simulated_ur5/scenario.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "skinctl/calibration/turn.hpp"
#include "skinctl/io/skin_file.hpp"

namespace calibrate_skin {

using namespace skinctl;

std::size_t link_of(const SkinFile::Patch& patch, const Robot& robot) {
  for (std::size_t l = 0; l < robot.links.size(); ++l)
    if (robot.links[l].name == patch.link) return l;
  throw std::runtime_error("no link " + patch.link);
}
namespace {

FitPose fit_pose(const SkinPose& X) {
  return {Eigen::Quaterniond(X.q[3], X.q[0], X.q[1], X.q[2]).normalized().toRotationMatrix(),
          {X.p.x, X.p.y, X.p.z}};
}

}  // namespace

SkinError skin_error(const SkinFile& file, const World& world, const Robot& robot) {
  SkinError out;
  for (const auto& patch : file.patches) {
    const std::size_t link = link_of(patch, robot);
    const FitPose X_LinkRoot = robot.links[link].X_LinkNamed * fit_pose(patch.X_LinkRoot);
    for (const auto& cell : patch.cells) {
      ++out.of;
      if (!cell.masked.empty()) continue;
      ++out.cells;
      const World::Cell* truth = world.find(std::uint16_t(cell.id));
      if (truth == nullptr || truth->link != link) {
        ++out.wrong_link;
        continue;
      }
      const FitPose X = X_LinkRoot * fit_pose(cell.X_RootCell);
      const double place = (X.p - truth->X_LinkCell.p).norm(),
                   angle = turn_vector(truth->X_LinkCell.R.transpose() * X.R).norm();
      out.place_rms += place * place, out.turn_rms += angle * angle;
      out.place_worst = std::max(out.place_worst, place), out.turn_worst = std::max(out.turn_worst, angle);
    }
  }
  const double n = std::max(1.0, double(out.cells - out.wrong_link));
  out.place_rms = std::sqrt(out.place_rms / n), out.turn_rms = std::sqrt(out.turn_rms / n);
  return out;
}

namespace {

std::uint16_t free_udp_port() {
  boost::asio::io_context io;
  return boost::asio::ip::udp::socket(io, {boost::asio::ip::address_v4::loopback(), 0})
      .local_endpoint()
      .port();
}

/// A simulated robot that wears the skin of a folder's `peer`, and the options to calibrate it.
struct Peer {
  Options options;
  std::unique_ptr<simulated_ur5::SimulatedUr5> robot;

  Peer(const fs::path& folder, std::uint64_t seed, double loss) {
    options.folder = folder;
    options.camera = options.masses = false;
    options.wire.port = free_udp_port();
    options.wire.network = folder / "peer" / "network.json";
    simulated_ur5::Config config;
    config.ports = {0, 0, 0, 0, 0};
    config.speed = 0, config.patience = 2;
    auto& controller = config.controller;
    controller.powered = true, controller.arm.home = home, controller.seed = seed;
    controller.cells = simulated_ur5::read_skin_cells((folder / "peer" / "worn.json").string());
    simulated_ur5::err_as_cheap_ones(controller.skin);
    config.skin_port = options.wire.port, config.skin_loss = loss;
    robot = std::make_unique<simulated_ur5::SimulatedUr5>(std::move(config));
    robot->start();
    const auto ports = robot->ports();
    options.arm.host = "127.0.0.1", options.arm.own_clock = true;
    options.arm.rtde_port = ports.rtde, options.arm.script_port = ports.secondary;
    options.arm.dashboard_port = ports.dashboard;
  }
  SkinError calibrate(const World& world) {
    run_steps(options, world);
    write_results(options);
    return skin_error(read_skin_file((options.folder / "skin.json").string()), world);
  }
};

/// A camera beside the robot that sees the lights that are on now.
class Camera {
 public:
  static constexpr int width = 1280, height = 960;
  static constexpr double f = 1010, cx = 655, cy = 470, k1 = -0.12, k2 = 0.03;

  Camera(const World& world, simulated_ur5::SimulatedUr5& robot) : world_(world), robot_(robot) {
    const Eigen::Vector3d eye(1.45, 0.5, 0.65), at(0, 0, 0.4),
        z = (at - eye).normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    X_BaseCam_.R << x, z.cross(x), z;
    X_BaseCam_.p = eye;
  }
  GreyImage operator()() {
    GreyImage out{width, height, std::vector<std::uint8_t>(std::size_t(width) * height)};
    for (std::uint8_t& pixel : out.pixels) {  // a room in the dusk
      noise_ = noise_ * 6364136223846793005u + 1442695040888963407u;
      pixel = static_cast<std::uint8_t>(34 + (noise_ >> 40) % 13);
    }
    const auto lit = robot_.lights();
    const auto q = robot_.snapshot().true_q;
    const auto X = ur5_robot().link_poses(JointAngles(q.begin(), q.end()));
    for (const World::Cell& cell : world_.truth()) {
      const FitPose X_CamCell = X_BaseCam_.inverse() * X[cell.link] * cell.X_LinkCell;
      if (!lit.on(cell.id) || X_CamCell.R.col(2).dot(X_CamCell.p.normalized()) > -0.25) continue;
      const double x = X_CamCell.p.x() / X_CamCell.p.z(), y = X_CamCell.p.y() / X_CamCell.p.z(),
                   r2 = x * x + y * y, bent = 1 + k1 * r2 + k2 * r2 * r2;
      spot(out, f * bent * x + cx, f * bent * y + cy);
    }
    spot(out, 200, 150), spot(out, 1000, 90);  // lamps
    return out;
  }

 private:
  static void spot(GreyImage& image, double x, double y) {
    constexpr double radius = 1.6;
    const int u = int(std::lround(x)), v = int(std::lround(y));
    for (int j = std::max(0, v - 7); j <= std::min(height - 1, v + 7); ++j)
      for (int i = std::max(0, u - 7); i <= std::min(width - 1, u + 7); ++i) {
        std::uint8_t& pixel = image.pixels[std::size_t(j) * width + std::size_t(i)];
        const double light = 160 * std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / (2 * radius * radius));
        pixel = static_cast<std::uint8_t>(std::min(255.0, pixel + light));
      }
  }
  const World& world_;
  simulated_ur5::SimulatedUr5& robot_;
  FitPose X_BaseCam_;
  std::uint64_t noise_ = 1;
};

}  // namespace

SkinError over_wire(const fs::path& folder, std::uint64_t seed, double loss) {
  fs::remove_all(folder);
  write_worn(folder / "peer", seed);
  Peer peer(folder, seed, loss);
  return peer.calibrate(World(seed));
}

SkinError seen_over_wire(const fs::path& folder, std::uint64_t seed) {
  Peer peer(folder, seed, 0.02);
  const World world(seed);
  Options& o = peer.options;
  o.camera = true;
  o.camera_device.lens = folder / "peer" / "lens.json";
  write_json(o.camera_device.lens, {{"fx", Camera::f},
                                    {"fy", Camera::f},
                                    {"cx", Camera::cx},
                                    {"cy", Camera::cy},
                                    {"distortion", {Camera::k1, Camera::k2, 0, 0, 0}}});
  o.camera_device.settle = 0;  // it has no buffer
  o.camera_device.take = [camera = std::make_shared<Camera>(world, *peer.robot)] { return (*camera)(); };
  fs::remove(folder / "camera.json");
  return peer.calibrate(world);
}

}  // namespace calibrate_skin
