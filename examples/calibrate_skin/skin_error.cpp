// A calibrated skin against the truth; and a calibration whose skin is another one's, over a socket.
#include <Eigen/Geometry>
#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cmath>

#include "examples/calibrate_skin/judge.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/simulated_ur5/scenario.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "skinctl/calibration/turn.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/robots/ur5_links.hpp"

namespace calibrate_skin {

using namespace skinctl;

std::size_t link_of(const SkinFile::Patch& patch) {
  for (std::size_t l = 0; l < 6; ++l)
    if (ur5::Ros2Links::named_links[l].name == patch.link) return l;
  throw std::runtime_error("no link " + patch.link);
}
namespace {

FitPose fit_pose(const SkinPose& X) {
  return {Eigen::Quaterniond(X.q[3], X.q[0], X.q[1], X.q[2]).normalized().toRotationMatrix(),
          {X.p.x, X.p.y, X.p.z}};
}

}  // namespace

SkinError skin_error(const SkinFile& file, const World& world) {
  SkinError out;
  for (const auto& patch : file.patches) {
    const std::size_t link = link_of(patch);
    FitPose X_LinkRoot = fit_pose(patch.X_LinkRoot);
    const auto& p = ur5::Ros2Links::named_links[link].p;
    X_LinkRoot.p += Eigen::Vector3d(p.x, p.y, p.z);
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

}  // namespace

SkinError over_wire(const fs::path& folder, std::uint64_t seed, double loss) {
  fs::remove_all(folder);
  write_worn(folder / "peer", seed);
  Options options;
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
  simulated_ur5::SimulatedUr5 robot(std::move(config));
  robot.start();
  const auto ports = robot.ports();
  options.arm.host = "127.0.0.1", options.arm.own_clock = true;
  options.arm.rtde_port = ports.rtde, options.arm.script_port = ports.secondary;
  options.arm.dashboard_port = ports.dashboard;
  const World world(seed);
  run_steps(options, world);
  write_results(options);
  return skin_error(read_skin_file((folder / "skin.json").string()), world);
}

}  // namespace calibrate_skin
