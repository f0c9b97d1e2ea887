// The arm: from a program's motion command to where the joints are, through limits, a pure delay and a lag.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "examples/simulated_ur5/geometry.hpp"
#include "examples/simulated_ur5/joint_dynamics.hpp"
#include "examples/simulated_ur5/random.hpp"

namespace simulated_ur5 {

/// Time in nanoseconds since the controller started.
using Nanoseconds = std::int64_t;

/// One plant step. Both controllers' cycles and the skin's period are multiples of it.
inline constexpr Nanoseconds plant_step = 500'000;

constexpr Nanoseconds nanoseconds(double seconds) {
  return static_cast<Nanoseconds>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
}
constexpr double seconds(Nanoseconds t) {
  return static_cast<double>(t) * 1e-9;
}

inline constexpr double rigid = std::numeric_limits<double>::infinity();

struct ArmConfig {
  /// Pure delay from a command to the drive [s], 0 to 0.5.
  double delay = 0.008;
  /// Time constant of the drive's first-order lag [s], 0 to 0.5, for speedj, movej and `servoj(gain=2000)`;
  /// of softer gains lag * 2000 / gain. servoj comes behind a lag of its own besides, `lookahead_time`.
  double lag = 0.008;
  Joints velocity_limit = {pi, pi, pi, pi, pi, pi};                   ///< [rad/s]
  Joints acceleration_limit = {40, 40, 40, 40, 40, 40};               ///< of the target [rad/s^2]
  Joints lower = {-2 * pi, -2 * pi, -pi, -2 * pi, -2 * pi, -2 * pi};  ///< [rad]
  Joints upper = {2 * pi, 2 * pi, pi, 2 * pi, 2 * pi, 2 * pi};
  /// A servoj step that needs more than this times the velocity limit, or a speedj above it, is a protective
  /// stop.
  double step_tolerance = 2;
  /// Of each joint's position loop [N m/rad], 100 to infinite: a load bends it by load / stiffness (droop).
  Joints stiffness = {rigid, rigid, rigid, rigid, rigid, rigid};
  /// The loop's integral takes the droop back with this time constant [s], 0.01 to infinite (none).
  double integral_time = rigid;
  /// Mass at the flange that the controller does not know of [kg], 0 to 20: the arm droops by its weight, or
  /// under torque sinks, until a program tells it (`set_payload`).
  double unknown_payload = 0;
  Vec3 payload_centre{};            ///< its centre of mass in the flange's frame [m]
  JointDrives drives;               ///< the position loop overcomes it; its currents show it
  Bodies bodies = makers_bodies();  ///< what the arm weighs
  Joints torque_noise = {1.2, 1.2, 1.2, 0.3, 0.3, 0.3};  ///< of torques by currents, standard deviation [N m]
  Joints torque_bias{},
      torque_creep{};                 ///< of torques by currents [N m], and its change [N m/s] from boot on
  double warming = 0;                 ///< of the motors, in the end [K]
  double warming_time = 600;          ///< until 63 % of it [s]
  double friction_per_kelvin = 0.01;  ///< share of friction that a warmer gear has lost
  Joints torque_limit = {150, 150, 150, 28, 28, 28};        ///< of the motors at the joints [N m]
  double position_noise = 2e-5;                             ///< standard deviation of the encoders [rad]
  double velocity_noise = 5e-4;                             ///< of the measured velocity [rad/s]
  double protective_deceleration = 20;                      ///< of a protective stop [rad/s^2]
  Joints home = {0, -pi / 2, -pi / 2, -pi / 2, pi / 2, 0};  ///< where the arm stands at the start [rad]
};

/// Throws `skinctl::ConfigurationError` for numbers outside their ranges.
void check(const ArmConfig& config);

/// Why an arm refuses a command.
enum class Violation { none, position_step, speed, joint_limit, not_a_number };

/// The motion of a UR5 without sockets, modes or contact.
///
/// Each control cycle calls `plan` once, which turns the active command into the target of the cycle's end,
/// then `advance` in plant steps. The target obeys velocity and acceleration limits exactly; a command that
/// obeys them is the target, of servoj behind a first-order lag of `lookahead_time`. The joints follow the
/// target (linear between cycles) after the delay, through the drive's lag, and give way to load.
class Arm {
 public:
  /// @param cycle  control period, a multiple of `plant_step`.
  Arm(const ArmConfig& config, Nanoseconds cycle);

  /// servoj: reach `q` [rad] within one cycle. Lookahead in [0.03, 0.2] s, gain in [100, 2000], clamped.
  void servo(const Joints& q, double lookahead, double gain);
  /// speedj: bring the joints to `dq` [rad/s] with `acceleration` [rad/s^2] on the leading axis.
  void speed(const Joints& dq, double acceleration);
  /// stopj: bring the leading axis to rest with `deceleration` [rad/s^2], the others in proportion.
  void stop(double deceleration);
  /// movej: straight in joint space, trapezoidal speed with the leading axis at `acceleration` and
  /// `velocity`; a `duration` > 0 [s] replaces them.
  void move(const Joints& q, double acceleration, double velocity, double duration);

  /// direct_torque: the joints move freely under `tau` [N m] for one cycle. The controller adds what holds
  /// the arm's weight, and of the friction these shares (0 to 1), by the measured speed. Without a new
  /// command in the next cycle the arm comes to rest under position control.
  void torque(const Joints& tau, const Joints& viscous_scale, const Joints& coulomb_scale);

  /// Target of the end of the coming cycle. A speed fraction below 1 slows every motion but stops.
  Violation plan(double speed_fraction);
  /// Moves the joints by one plant step; call `cycle / plant_step` times after each `plan`.
  /// @param load  torque that the world exerts on the joints [N m].
  void advance(const Joints& load);

  /// True if neither target nor joints move: a stop or move has ended.
  bool at_rest() const;
  /// True under commands that come cycle by cycle: servoj, speedj, direct_torque.
  bool streamed() const { return mode_ == Mode::servo || mode_ == Mode::speed || mode_ == Mode::torque; }
  bool under_torque() const { return mode_ == Mode::torque; }
  /// What the motors gave without load, the mean of the last cycle, without its noise; under direct torque
  /// what they give, compensation included [N m].
  const Joints& motor_torque() const { return motor_torque_; }
  /// Noise, bias and creep of the measured torque, new with each `measure` [N m].
  const Joints& torque_noise() const { return torque_noise_; }
  /// How much warmer the motors are than at boot [K].
  double warmer() const;
  /// True while a movej is under way.
  bool moving() const { return mode_ == Mode::move; }
  /// Draws new noise, and finds what the motors gave; call once per cycle.
  void measure();
  void reseed(std::uint64_t seed) { random_ = Random(seed), torque_random_ = Random(seed + 1); }

  const Joints& target_q() const { return target_q_; }
  const Joints& target_dq() const { return target_dq_; }
  const Joints& target_ddq() const { return target_ddq_; }
  const Joints& q() const { return q_; }    ///< true joint positions
  const Joints& dq() const { return dq_; }  ///< true joint velocities
  const Joints& measured_q() const { return measured_q_; }
  const Joints& measured_dq() const { return measured_dq_; }
  const ArmConfig& config() const { return config_; }

 private:
  enum class Mode { stop, servo, speed, move, torque };
  struct Path {
    Joints from{}, to{};
    double length = 0;   ///< of the leading axis [rad]
    double peak = 0;     ///< speed of the leading axis [rad/s]
    double ramp = 0;     ///< time to reach it [s]
    double total = 0;    ///< [s]
    double elapsed = 0;  ///< [s] of path time
  };
  void apply_speeds(const Joints& next);
  Violation plan_servo(double fraction);
  Violation plan_speed(double fraction);
  void plan_stop();
  void plan_move(double fraction);
  Violation plan_torque();
  void advance_under_torque(const Joints& load);
  void back_to_position_control();
  Joints delayed_target(Nanoseconds t) const;

  ArmConfig config_;
  Nanoseconds cycle_;
  double dt_;
  JointDrives drives_;  ///< as warm as they are
  Mode mode_ = Mode::stop;
  Joints command_{};       ///< servo: position; speed: velocity; torque: torque
  Joints last_command_{};  ///< servo: the command of the cycle before
  Joints ahead_{};         ///< servo: the command behind its lookahead
  double lookahead_ = 0;   ///< [s]
  double deceleration_ = 4;
  double acceleration_ = 40;
  double lag_;
  bool torque_is_fresh_ = false;
  Joints viscous_scale_{}, coulomb_scale_{}, motor_torque_{}, dry_friction_{};
  Path path_;
  Joints target_q_, target_dq_{}, target_ddq_{};
  Joints q_, dq_{}, measured_q_, measured_dq_{};
  Joints q_before_, dq_before_{},
      friction_side_{};  ///< at the end of the cycle before; friction between -1 and 1
  Joints torque_noise_{};
  Joints deflection_{}, integral_{};  ///< droop, and what the integral has taken of it [rad]
  Joints driven_;                     ///< output of the lag, before deflection
  std::vector<Joints> history_;       ///< ring of targets at cycle ends
  std::int64_t planned_ = 0;          ///< cycles planned; history_[planned_ % size] is the newest
  Nanoseconds now_{};
  Random random_, torque_random_{1};
};

}  // namespace simulated_ur5
