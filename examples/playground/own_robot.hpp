// A robot that a visitor brings: six turning joints of a URDF, with a skin on a tube for each link.
#pragma once

#include <vector>

#include "examples/compliant_ur5/skin.hpp"
#include "examples/playground/body.hpp"
#include "skinctl/model/placement.hpp"
#include "skinctl/model/topology.hpp"
#include "skinctl/robot/joint_limits.hpp"

namespace playground {

class OwnRobot {
 public:
  using Chain = skinctl::Chain<Robot::joints>;
  using Model = skinctl::CalibratedModel<Chain>;
  using Skin = skinctl::SkinOf<Model, double, compliant_ur5::max_cells>;
  using Tube = std::array<double, 7>;  ///< radius, ends in the link's frame [m]; radius 0: the link has none

  /// Of a link whose mass the file does not give, a cylinder as large as its tube [kg/m^3]: motors, metal and
  /// air.
  static constexpr double assumed_density = 2000;
  /// Of the laws at a joint without a limit of its own: more than any of these arms needs [N m].
  static constexpr double assumed_torque = 1000;

  /// Throws `skinctl::ConfigurationError` for numbers of no robot.
  explicit OwnRobot(const Robot& robot);

  [[nodiscard]] const Model& model() const noexcept { return model_; }
  [[nodiscard]] const Tube& tube(std::size_t i) const { return tubes_.at(i); }
  /// Those of the file, and of the settings where these are lower.
  [[nodiscard]] skinctl::JointLimits<6> limits(const compliant_ur5::ControlSettings& control) const;
  [[nodiscard]] simulated_ur5::Links links(const Joints& q) const noexcept;
  /// The cells of all tubes, their gains divided by `heavier`; on a rigid arm all gains are 0.
  [[nodiscard]] std::vector<skinctl::SkinPatch> patches(const compliant_ur5::Settings& settings,
                                                        double heavier = 1) const;
  /// Two places of a task: above the floor and neither stretched nor folded, as far as the limits allow
  /// [rad].
  [[nodiscard]] std::array<Joints, 2> task() const noexcept;
  /// Makes the drives those of this robot.
  void limit(simulated_ur5::ArmConfig& arm) const noexcept;

 private:
  struct Shape;
  OwnRobot(const Robot& robot, const Shape& shape);
  /// A pose with the tip at this height and distance from the first axis, in shares of the reach, as far as
  /// the floor and the limits allow it; of several one like `near`.
  [[nodiscard]] Joints posture(double height, double distance, const Joints* near = nullptr) const noexcept;
  void cover_tubes();

  skinctl::TurnedLinks<Chain> canonical_;
  Model model_;
  Joints lower_{}, upper_{}, velocity_{}, torque_{};
  double reach_;                ///< [m]
  skinctl::Xyz<double> tip_{};  ///< in the frame of the last link [m]
  std::array<Tube, 6> tubes_{};
  std::array<std::vector<skinctl::SkinCell>, 6> cells_;
};

}  // namespace playground
