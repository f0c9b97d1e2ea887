// The memory of a resolver.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/passivity/passivity.hpp"
#include "skinctl/resolver/detail/running_sum.hpp"
#include "skinctl/resolver/detail/torque_rate.hpp"
#include "skinctl/resolver/interval.hpp"
#include "skinctl/resolver/servo.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The state of motion of the virtual robot.
enum class ResolverMode : unsigned char {
  following,  ///< the laws move it
  blocked,    ///< it returns to the real robot and waits there
  displaced,  ///< it holds until the user's consent: the real robot stands beside its commands
  braking     ///< it brakes and holds: a stop, or no measurement of the real robot
};

/// The observation of a joint whose residual is outside of the dead band.
template <Real T>
struct ResidualWatch {
  T size = T(0);   ///< largest residual since it left the dead band [rad]; zero inside
  T side = T(0);   ///< its sign
  T most = T(0);   ///< largest speed of a correction [rad/s]
  T robot = T(0);  ///< measured position then
  T told = T(0);   ///< H(commands) then
  T joint = T(0);  ///< q^ then
  T slack =
      T(0);  ///< by which the dead band is wider: the robot moved with commands that far ahead of it [rad]
};

/// The virtual robot's joints, the commands under way, the last good measurement. Trivially copyable; a
/// default value has not been started and gives no valid command.
template <std::size_t N, Real T, std::size_t History>
struct VirtualJointsMemory {
  bool started = false;
  bool stop = false;  ///< a stop was requested
  ResolverMode mode = ResolverMode::following;
  Nanoseconds time{};                  ///< of the virtual state
  Nanoseconds odd = detail::no_time;   ///< the last cycle's time, if the clock had gone back
  detail::RunningPosition<N, T> q;     ///< q^
  JointVelocity<N, T> v;               ///< the virtual robot's velocity, which laws read
  JointVelocity<N, T> rate;            ///< dq^/dt: v, with the correction where that is sent
  JointAcceleration<N, T> last;        ///< dv/dt of the last sub-step
  State<N, T> measured;                ///< the last good measurement, less the gap
  JointPosition<N, T> residual;        ///< r: measured position minus that brought by the commands
  JointPosition<N, T> gap;             ///< g: a residual to which the user has agreed; taken off measurements
  bool gap_told = false;               ///< g began as the gap to where the robot says that it was told to be
  ResidualWatch<T> watch[N];           ///< of joints that are off
  T off_for[N] = {};                   ///< how long r has been beyond the dead band [s]
  T mode_for = T(0);                   ///< how long the present mode has lasted [s]
  T settles_for = T(0);                ///< how long r is still that of commands that never moved [s]
  T command_span = T(0);               ///< time in which a position command is to be reached [s]
  bool watched = false;                ///< a residual has left the dead band
  bool behind = false;                 ///< the sent position has yet to catch up with q^
  JointPosition<N, T> slow_residual;   ///< r, smoothed over 10 T
  JointPosition<N, T> told;            ///< way of the commands in the last 10 T
  JointPosition<N, T> back;            ///< where a blocked robot stood, to which q^ returns
  signed char pushed[N] = {};          ///< the direction in which a blocked robot did not follow
  detail::RunningPosition<N, T> sent;  ///< the sent position, or the integral of the sent velocities
  detail::RunningPosition<N, T> offset;  ///< corrections of r without motion (velocity interface)
  CommandsUnderWay<N, T, History> under_way;
  detail::OwnTorque<N, T> own;  ///< of the laws in the last sub-step
  JointCommand<N, T> command;   ///< the last one
};

/// A resolver's memory: the virtual robot, and the memory of its `Passivity` parts.
template <std::size_t N, Real T, std::size_t History, class Keeper = Passivity<>>
struct ResolverMemory : VirtualJointsMemory<N, T, History> {
  [[no_unique_address]] typename Keeper::template Memory<N> keeper;
};

SKINCTL_END_NAMESPACE
