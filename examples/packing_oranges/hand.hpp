// An Allegro hand as a gripper: its own cycle by torque, 333 times a second, between what an arm's cycle asks of a gripper
// and the 16 joints.
#pragma once

#include <memory>

#include "examples/packing_oranges/arm_body.hpp"
#include "skinctl/core/gripper.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"

namespace packing {

inline constexpr std::size_t hand_joints = 16;

/// What a hand does as a gripper. The opening is the diameter of the ball that its fingertips would touch.
inline constexpr skinctl::GripperRange hand_range{0.11, 0.3, 4, 0.005, 0.15};

/// Which fingertips hold an object, and where they stand around it.
struct Grasp {
  const char* name = "";
  std::array<double, 4> takes_part{};    ///< weights of index, middle, ring and thumb, 0 to 1
  skinctl::Xyz<double> centre{0, 0, 0};  ///< between the fingertips, in the hand's frame [m]
  /// Each fingertip is `far * away + beside` from the centre, ...
  std::array<skinctl::Xyz<double>, 4> away{}, beside{};
  std::array<double, hand_joints> posture{};  ///< of the fingers that take no part [rad]
  double least = 0.03, most = 0.067;          ///< ... and `far` goes from the closed to the open grasp [m]
  /// All phalanges take part instead: from `posture`, the open hand, the joints go towards `curled`, each until its finger
  /// touches what lies in the palm; then they press on it from all sides. `centre` is its middle.
  bool wraps = false;
  std::array<double, hand_joints> curled{};  ///< [rad]
};
/// Index, ring and thumb around a ball, a third of a circle apart, the palm above it.
[[nodiscard]] Grasp around_a_ball();

/// The right hand as bodies; the middle of the grasp is `reach` beyond the flange, on the axis of the last link. The palm
/// faces along that axis, the fingers point along the link's x axis.
[[nodiscard]] HandBody hand_body(const Grasp& grasp, double flange, double reach);
/// A direction of such a hand in the axes of the arm's tool.
[[nodiscard]] constexpr skinctl::Xyz<double> in_tool(const skinctl::Xyz<double>& way) {
  return {way.z, -way.y, way.x};
}
/// Gravity in the axes of such a hand, from the pose of the arm's tool [m/s^2].
template <class Pose>
[[nodiscard]] skinctl::Xyz<double> gravity_in_hand(const Pose& X_WT) {
  return {-9.81 * X_WT.axis_z().z, 9.81 * X_WT.axis_y().z, -9.81 * X_WT.axis_x().z};
}

/// Where the fingers are in the hand's frame: the origins of each finger's links, and its tip.
[[nodiscard]] std::array<std::array<skinctl::Xyz<double>, 5>, 4> skeleton(
    const skinctl::JointPosition<hand_joints>& q);

class Hand {
 public:
  static constexpr auto period = skinctl::Nanoseconds(3'000'000);

  /// Throws `ConfigurationError` for a grasp that the fingers do not reach.
  Hand(const Grasp& grasp, const skinctl::State<hand_joints>& measured);
  ~Hand();
  Hand(Hand&&) noexcept;

  struct Input {
    skinctl::State<hand_joints> measured;
    std::array<double, 4> tips{};              ///< forces that the fingertips feel [N]
    skinctl::Xyz<double> gravity{9.81, 0, 0};  ///< in the hand's frame, from the pose of the arm [m/s^2]
    skinctl::GripperCommand command;
    /// A person leads the fingers: they give way, keep what two of them hold with the force with which the person pressed,
    /// and let it go when it is pulled out of them. No command counts.
    bool led = false;
  };
  /// A cycle: the torques of the joints.
  skinctl::JointTorque<hand_joints> step(const Input& input);
  /// What it reports as a gripper.
  [[nodiscard]] const skinctl::GripperState& state() const;
  [[nodiscard]] skinctl::Status status() const;  ///< of the last cycle
  /// The middle of the ball that three fingertips hold, beside the grasp's, in the axes of the arm's tool
  /// [m]; 0 where they hold none.
  [[nodiscard]] skinctl::Xyz<double> between() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace packing
