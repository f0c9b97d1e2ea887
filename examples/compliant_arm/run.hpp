// An arm whose controller is the clock gives way at its tool: one run.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "examples/adapters/egm/egm.hpp"
#include "examples/adapters/franka/franka.hpp"
#include "examples/adapters/fri/fri.hpp"
#include "examples/adapters/rsi/rsi.hpp"
#include "examples/adapters/stream_motion/stream_motion.hpp"
#include "examples/simulated_arm/egm.hpp"
#include "examples/simulated_arm/franka.hpp"
#include "examples/simulated_arm/fri.hpp"
#include "examples/simulated_arm/rsi.hpp"
#include "examples/simulated_arm/stream_motion.hpp"
#include "examples/support/job.hpp"

namespace compliant_arm {

enum class Robot : unsigned char { rsi, egm, fri, stream_motion, franka };
/// Arms on springs, with seven joints.
[[nodiscard]] constexpr bool on_springs(Robot robot) {
  return robot == Robot::fri || robot == Robot::franka;
}

struct Settings {
  Robot robot = Robot::rsi;
  bool simulate = true;
  adapters::rsi::Options rsi;
  adapters::egm::Options egm;
  adapters::fri::Options fri;
  adapters::stream_motion::Options stream_motion;
  adapters::franka::Options franka;
  std::string urdf{};        ///< file of the arm; empty: of examples/data, six joints, on springs seven
  double delay = 0.012;      ///< from an answer until the arm begins to move, with the age of a state [s]
  double lag = 0.03;         ///< time constant of the arm's servo [s]
  double speed_share = 0.5;  ///< of the limits of velocity, acceleration and jerk that URDF and robot state
  double acceleration = 4;   ///< at most [rad/s^2]
  double jerk = 80;          ///< at most [rad/s^3]
  double threshold = 3;      ///< force that is no touch [N]
  double torque_threshold = 2;  ///< torque at a joint that is no touch, on springs [N m]
  double stiffness = 500;       ///< of the springs by which an iiwa or an FR3 holds its joints [N m/rad]
  double damping_ratio = 0.7;   ///< of the same
  double stiffest_hand = 1e4;   ///< that pushes the tool [N/m]
  double heaviest_hand = 10;    ///< [kg]
  double duration = 8;          ///< [s]
  bool identify = false;        ///< the arm moves gently, and is pushed by hand, in place of the job
  bool quiet = false;
  std::string json;  ///< file for a summary; empty: none
  simulated_arm::Config simulation;
  simulated_arm::RsiConfig rsi_controller;
  simulated_arm::EgmConfig egm_controller;
  simulated_arm::FriConfig fri_controller;
  simulated_arm::StreamMotionConfig stream_motion_controller;
  simulated_arm::FrankaConfig franka_controller;
};
/// Delays of the simulated arm, and two pushes.
void simulate_by_default(Settings& settings);

/// What an identification found.
struct Found {
  bool known = false;
  double delay = 0, lag = 0;        ///< [s]
  double both = 0, deviation = 0;   ///< their sum, known better than each, and its standard deviation [s]
  std::vector<double> stiffness{};  ///< of each joint on a spring that was pushed [N m/rad]; 0: not known
};
struct PushSummary {
  double start = 0, force = 0;  ///< [s], [N]
  double moved = 0;             ///< way of the flange [m]
  double left = 0;              ///< distance from where it was, 2 s after the push [m]
};
struct RunLog {
  std::vector<PushSummary> pushes;
  adapters::ClockFault fault = adapters::ClockFault::none;
  adapters::ClockCounts counts;
  std::string reason;            ///< in words; empty: it ended as asked
  double felt_mass = 0;          ///< of the tool [kg]
  std::array<double, 3> peak{};  ///< velocity, acceleration, jerk of the commands over their limits
  Found found;
  double bent = 0;  ///< of the springs: largest distance of a joint from its command [rad]
  std::uint64_t cycles = 0, silent = 0;
  double cycle_us = 0, cycle_max_us = 0, load_max_us = 0;
  simulated_arm::Standing last;  ///< of the simulated arm
};

/// Throws `ConfigurationError` for what is refused, `ConnectionError` for a controller that cannot be
/// reached.
examples::job::Exit run(const Settings& settings, const std::atomic<bool>& stop, RunLog& log);

}  // namespace compliant_arm
