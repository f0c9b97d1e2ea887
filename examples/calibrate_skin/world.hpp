// A simulated UR5 with a skin that was glued on this morning: what its network, its accelerometers and a
// camera report.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "examples/calibrate_skin/arm.hpp"
#include "skinctl/calibration/accelerometer.hpp"
#include "skinctl/calibration/sighting_types.hpp"
#include "skinctl/skin_network/patch_graph.hpp"

SKINCTL_BEGIN_NAMESPACE
struct MotionRecording;
SKINCTL_END_NAMESPACE

namespace calibrate_skin {

/// Where a UR5 stands before each motion.
inline constexpr JointAngles6 home = {0.2, -1.6, 0.9, -0.9, -1.4, 0.3};
/// What the network reports; `parents` by id, 0: the PC.
struct NetworkReport {
  std::vector<skinctl::CellNames> cells;
  std::vector<std::uint16_t> parents, hops;
  double seconds = 0;
  std::uint32_t epoch = 0;
};

struct CameraReport {
  skinctl::PinholeCamera camera;
  struct Light {
    std::size_t view;
    std::uint16_t id;
    Eigen::Vector2d pixel;
  };
  std::vector<Light> lights;
};

class World {
 public:
  struct Cell {
    std::uint16_t id = 0;  ///< as the network gave it
    std::size_t link = 0;
    skinctl::FitPose X_LinkCell;
    skinctl::AccelerometerErrors errors;
    Eigen::Matrix3d cross_axis;
  };
  explicit World(std::uint64_t seed);
  /// These cells, on any robot: their network and their truth only.
  World(std::uint64_t seed, std::vector<Cell> cells);
  [[nodiscard]] std::uint64_t seed() const noexcept { return seed_; }

  /// For judging the result only.
  [[nodiscard]] const std::vector<Cell>& truth() const noexcept { return cells_; }
  [[nodiscard]] const Cell* find(std::uint16_t id) const noexcept;

  [[nodiscard]] NetworkReport run_network() const;
  /// What the simulated robot weighs, unlike what its maker says.
  [[nodiscard]] const RobotMasses& robot() const noexcept { return robot_; }
  /// Mean readings of a hundred samples where the robot stood [g]. `by_hand`: the cell's patch was turned by
  /// hand before it was glued on.
  [[nodiscard]] std::vector<Eigen::Vector3d> at_rest(std::uint16_t id, const std::vector<JointAngles>& poses,
                                                     bool by_hand) const;
  /// What the cells of these ids felt of a motion.
  [[nodiscard]] skinctl::MotionRecording moved(const std::vector<std::uint16_t>& ids, const Ride& ride) const;
  /// The lights of cells that show in the camera, but a seventh; with `errors` half a pixel off, a tenth read
  /// as other cells and a tenth anywhere.
  [[nodiscard]] CameraReport seen(const std::vector<JointAngles>& stood, bool errors = true) const;
  /// As a person would put the marker: 30 mm and 15 deg off.
  [[nodiscard]] skinctl::FitPose placed_by_hand(std::uint16_t root) const;
  [[nodiscard]] skinctl::FitPose camera_by_hand() const;

 private:
  void name_cells();

  std::uint64_t seed_;
  std::vector<Cell> cells_;
  skinctl::FitPose X_BaseCam_;
  RobotMasses robot_;
};

}  // namespace calibrate_skin
