// The body of a simulated Allegro hand: dynamics, friction, stops, a ball to close on, fingers that push.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "skinctl/robots/allegro.hpp"

namespace simulated_allegro {

using Joints = std::array<double, 16>;
using Side = skinctl::allegro::Side;

/// A ball in the frame of the hand that stays where it is.
struct Ball {
  std::array<double, 3> centre{0.08, 0.0, 0.03};  ///< [m]; of a left hand's y is mirrored
  double radius = 0.035;                          ///< [m]
  double stiffness = 1000;                        ///< [N/m]
  double damping = 2;                             ///< [N s/m]
};

/// A finger that pushes on a cell along its inward normal: `force` [N], ramped up and down within 0.1 s.
struct Touch {
  std::size_t cell =
      3;  ///< on the wire: 0 to 15 (the palm, 0, feels it and stays: what carries it gives way)
  double start = 1, duration = 1;  ///< [s]
  double force = 1;
};

/// Numbers of the body. Those that the maker does not publish are guesses of a plausible size: rotor inertia,
/// friction.
struct PlantConfig {
  Side side = Side::right;
  double rotor_inertia = 2e-4;  ///< at each joint, through its gear [kg m^2]
  double viscous = 0.01;        ///< [N m s/rad]
  double coulomb = 0.015;       ///< [N m]
  double delay = 0.001;         ///< from a torque's arrival until it acts [s]
  Joints start{0, 0.2, 0.2, 0.2, 0, 0.2, 0.2, 0.2, 0, 0.2, 0.2, 0.2, 0.8, 0.2, 0.2, 0.2};  ///< [rad]
  std::optional<Ball> ball;
  std::vector<Touch> touches;
  double newtons_of_full_scale = 5;  ///< force on a cell that reads 1020
};

class Plant {
 public:
  explicit Plant(const PlantConfig& config);
  ~Plant();
  Plant(Plant&&) noexcept;

  /// From now on, after the delay, these torques act [N m].
  void command(const Joints& torque);
  /// Runs to time `t` [s].
  void advance(double t);

  [[nodiscard]] double time() const noexcept { return time_; }
  [[nodiscard]] const Joints& q() const noexcept { return q_; }
  [[nodiscard]] const Joints& dq() const noexcept { return dq_; }
  [[nodiscard]] const Joints& torque() const noexcept { return torque_; }
  /// Force on each cell along its inward normal [N], of touches and of the ball.
  [[nodiscard]] const Joints& cell_force() const noexcept { return cell_force_; }
  /// Of the ball alone.
  [[nodiscard]] const Joints& ball_force() const noexcept { return ball_force_; }

 private:
  void substep(double h);

  struct World;
  PlantConfig config_;
  std::unique_ptr<World> world_;
  double time_ = 0;
  Joints q_{}, dq_{}, torque_{}, cell_force_{}, ball_force_{};
  struct UnderWay {
    double time;
    Joints torque;
  };
  std::deque<UnderWay> under_way_;
};

}  // namespace simulated_allegro
