#include "examples/calibrate_skin/world.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "examples/worlds/moved_skin.hpp"
#include "examples/worlds/other_bodies.hpp"
#include "examples/worlds/skin_network.hpp"
#include "skinctl/calibration/joint_lines_types.hpp"
#include "skinctl/dynamics/regressor.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/skin_at_rest.hpp"

namespace calibrate_skin {

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double deg = 0.0174532925;

template <std::size_t... I>
void for_links(std::index_sequence<I...>, const auto& f) {
  (f(std::integral_constant<std::size_t, I>{}), ...);
}

SkinTopology topology_of(const std::vector<World::Cell>& cells) {
  SkinTopology t(cells.size(), 0);
  const auto ports = hexagonal_ports();
  std::vector<std::size_t> piece(cells.size()), size(cells.size(), 1);
  for (std::size_t i = 0; i < cells.size(); ++i) piece[i] = i;
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t j = i + 1; j < cells.size(); ++j) {
      const auto &a = cells[i], &b = cells[j];
      if (a.link != b.link || (a.X_LinkCell.p - b.X_LinkCell.p).norm() > 0.032) continue;
      for (std::size_t p = 0; p < 4; ++p)
        for (std::size_t q = 0; q < 4; ++q)
          if ((a.X_LinkCell * ports[p] - b.X_LinkCell * ports[q]).norm() < 5e-4) {
            t.join(i + 1, p, j + 1, q);
            const std::size_t from = piece[j], to = piece[i];
            if (from == to) continue;
            for (std::size_t& k : piece) k = k == from ? to : k;
            size[to] += size[from];
          }
    }
  // A wire from the box to the first free port of each piece; single cells are left over, but for the last
  // link's.
  std::vector<bool> wired(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (std::size_t p = 0; p < 4; ++p) {
      if (wired[piece[i]] || t.ports[i + 1][p].joined || (size[piece[i]] < 3 && cells[i].link < 5)) continue;
      wired[piece[i]] = true;
      t.ports[0].emplace_back();
      t.join(0, t.ports[0].size() - 1, i + 1, p);
    }
  return t;
}

}  // namespace

World::World(std::uint64_t seed) : seed_(seed) {
  auto rng = seeded(seed);
  SimulatedAccelerometer sensor;
  sensor.prior.misalignment = 0.2 * deg;
  const auto patches = ur5::skin_patches<200>(std::array<CellGains, 6>{});
  for_links(std::make_index_sequence<6>{}, [&](auto i) {
    // Glued on by hand: up to a few centimetres and degrees from where it was meant to be.
    const auto& tube = ur5::tubes[i];
    const FitPose middle{Eigen::Matrix3d::Identity(), as_eigen(Xyz<double>(0.5 * (tube.from + tube.to)))};
    Eigen::Vector3d along = as_eigen(Xyz<double>(tube.to - tube.from)).normalized();
    const FitPose glued = middle *
                          FitPose{turn(uniform<double>(rng, -0.6, 0.6) * along) * turn(normal3(rng, 2 * deg)),
                                  uniform<double>(rng, -0.01, 0.01) * along} *
                          middle.inverse();
    for (const auto& cell : std::get<i.value>(patches).any()) {
      CellAtRest made;
      sensor.draw(rng, made);
      const FitPose X{as_eigen(cell.X_LC.axes()), as_eigen(cell.X_LC.origin()) + normal3(rng, 5e-5)};
      cells_.push_back({0, i.value, glued * X, made.errors, made.cross_axis});
    }
  });
  const Eigen::Vector3d eye = Eigen::Vector3d(1.5, 0.4, 0.6) + normal3(rng, 0.1), at(0, 0, 0.4);
  const Eigen::Vector3d z = (at - eye).normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  X_BaseCam_.R << x, z.cross(x), z;
  X_BaseCam_.p = eye;

  auto other = seeded(seed + 20);
  const auto maker = inertial_parameters(ur5::Model{});
  constexpr JointAngles6 viscous = {7, 7, 5, 1.5, 1.5, 1.5}, coulomb = {6, 6, 4, 1.5, 1.5, 1.5},
                         rotor = {0.5, 0.5, 0.5, 0.1, 0.1, 0.1};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto body = other_body(Eigen::Map<const Eigen::Matrix<double, 10, 1>>(maker.data + 10 * i), other);
    for (std::size_t k = 0; k < 10; ++k) robot_.bodies[i][k] = body(Eigen::Index(k));
    robot_.viscous[i] = uniform<double>(other, 0.7, 1.3) * viscous[i];
    robot_.coulomb[i] = uniform<double>(other, 0.7, 1.3) * coulomb[i];
    robot_.rotor[i] = uniform<double>(other, 0.7, 1.3) * rotor[i];
  }

  name_cells();
}

World::World(std::uint64_t seed, std::vector<Cell> cells) : seed_(seed), cells_(std::move(cells)) {
  name_cells();
}

void World::name_cells() {
  SkinNetwork net(topology_of(cells_), {.loss = 0.05, .flipped = 0.02}, seed_);
  net.run(std::chrono::milliseconds(300), [] { return false; });
  net.run_until_organised(std::chrono::seconds(10));
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i].id = net.cell(i + 1).id;
}

const World::Cell* World::find(std::uint16_t id) const noexcept {
  for (const Cell& c : cells_)
    if (c.id == id) return &c;
  return nullptr;
}

NetworkReport World::run_network() const {
  SkinNetwork net(topology_of(cells_), {.loss = 0.05, .flipped = 0.02}, seed_);
  net.run(std::chrono::milliseconds(300), [] { return false; });
  net.run_until_organised(std::chrono::seconds(10));
  NetworkReport out{net.root().reports(), {}, {}, seconds<double>(net.now()), net.root().epoch()};
  for (const CellNames& names : out.cells)
    for (std::size_t n = 1; n <= cells_.size(); ++n) {
      if (net.cell(n).id != names.id) continue;
      const auto& up = net.topology().ports[n][net.cell(n).parent & 3];
      out.parents.push_back(up.node == 0 ? std::uint16_t(0) : net.cell(up.node).id);
      out.hops.push_back(net.cell(n).hops);
    }
  return out;
}

std::vector<Eigen::Vector3d> World::at_rest(std::uint16_t id, const std::vector<JointAngles>& poses,
                                            bool by_hand) const {
  const Cell& cell = *find(id);
  auto rng = seeded(seed_ * 1000 + id);
  auto hand = seeded(seed_ + 7);
  const auto turned = cube_corners(hand);
  CellAtRest sensor{cell.X_LinkCell.R, {}, cell.errors, cell.cross_axis};
  std::vector<Eigen::Vector3d> out;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Vector3d up =
        by_hand ? turned[k % 8]
                : Eigen::Vector3d(ur5_robot().link_poses(poses[k])[cell.link].R.row(2).transpose());
    out.push_back(SimulatedAccelerometer{}.rest(rng, sensor, up));
  }
  return out;
}

MotionRecording World::moved(const std::vector<std::uint16_t>& ids, const Ride& ride) const {
  std::vector<TrueCell> cells;
  for (const std::uint16_t id : ids) {
    const Cell& c = *find(id);
    TrueCell t;
    t.link = int(c.link), t.R = c.X_LinkCell.R, t.p = c.X_LinkCell.p;
    t.sensor = t.R * turn(c.errors.misalignment);
    t.bias = c.errors.bias, t.scale = c.errors.scale;
    t.cross_axis = c.cross_axis - Eigen::Matrix3d::Identity();
    cells.push_back(t);
  }
  // The joints as they went: the recorder wants them 0.4 s before and after what it records.
  const MeasuredMotion went(ride.truth, 0.04);
  constexpr double edge = 0.6;
  MotionRecording out = record_motion(
      ur5::Model{}, [&](double t) { return went.at(t + edge); }, ride.truth.time.back() - 2 * edge, cells, {},
      seed_);
  for (auto& cell : out.cells)
    for (double& t : cell.time) t += edge;
  // Encoders are the robot's own; the torques that it predicts, at their stamps.
  Eigen::MatrixXd torque(ride.measured.q.rows(), 6);
  const auto last = double(out.joints.time.size() - 1);
  for (std::size_t k = 0; k < ride.measured.time.size(); ++k) {
    const double at = (ride.measured.time[k] - edge - out.joints.time.front()) * 125;
    torque.row(Eigen::Index(k)) = out.torque.row(Eigen::Index(std::clamp(std::round(at), 0.0, last)));
  }
  out.joints = ride.measured, out.torque = torque;
  return out;
}

CameraReport World::seen(const std::vector<JointAngles>& stood, bool errors) const {
  auto rng = seeded(seed_ + 4);
  CameraReport out;
  for (std::size_t v = 0; v < stood.size(); ++v) {
    const auto X = ur5_robot().link_poses(stood[v]);
    for (const Cell& c : cells_) {
      const FitPose X_CamCell = X_BaseCam_.inverse() * X[c.link] * c.X_LinkCell;
      if (X_CamCell.R.col(2).dot(X_CamCell.p.normalized()) > -0.25 || uniform<double>(rng, 0.0, 1.0) < 0.15)
        continue;
      const double off = errors ? 0.5 : 0.0;
      CameraReport::Light light{
          v,
          c.id,
          {out.camera.fx * X_CamCell.p.x() / X_CamCell.p.z() + out.camera.cx + off * normal(rng),
           out.camera.fy * X_CamCell.p.y() / X_CamCell.p.z() + out.camera.cy + off * normal(rng)}};
      const double luck = uniform<double>(rng, 0.0, 1.0);
      if (errors && luck < 0.1) light.id = cells_[rng() % cells_.size()].id;
      if (errors && luck > 0.9)
        light.pixel = {uniform<double>(rng, 0.0, 1280.0), uniform<double>(rng, 0.0, 960.0)};
      out.lights.push_back(light);
    }
  }
  return out;
}

FitPose World::placed_by_hand(std::uint16_t root) const {
  auto rng = seeded(seed_ * 77 + root);
  const FitPose& X = find(root)->X_LinkCell;
  return {X.R * turn(15 * deg * normal3(rng, 1).normalized()), X.p + 0.03 * normal3(rng, 1).normalized()};
}

FitPose World::camera_by_hand() const {
  auto rng = seeded(seed_ + 5);
  return {X_BaseCam_.R * turn(6 * deg * normal3(rng, 1).normalized()),
          X_BaseCam_.p + 0.08 * normal3(rng, 1).normalized()};
}

}  // namespace calibrate_skin
