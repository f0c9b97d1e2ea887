// The memory of a resolver.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/detail/plain_tuple.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/passivity/passivity.hpp"
#include "skinctl/resolver/detail/running_sum.hpp"
#include "skinctl/resolver/detail/torque_rate.hpp"
#include "skinctl/resolver/interval.hpp"
#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The state of motion of the virtual robot.
enum class ResolverMode : unsigned char {
  following,  ///< the laws move it
  blocked,    ///< returns to the real robot and waits there
  displaced,  ///< holds until the user's consent: the real robot stands beside its commands
  braking     ///< brakes and holds: a stop, or no measurement of the real robot
};

/// The observation of a joint whose residual is outside of the dead band.
template <Real T>
struct ResidualWatch {
  T size = T(0);   ///< largest residual since it left the dead band [rad]; zero inside
  T side = T(0);   ///< sign of the residual, +1 or -1
  T most = T(0);   ///< largest speed of a correction [rad/s]
  T robot = T(0);  ///< measured position then
  T told = T(0);   ///< H(commands) then
  T joint = T(0);  ///< q^ then
  T slack =
      T(0);  ///< by which the dead band is wider: the robot moved with commands that far ahead of it [rad]
};

/// The virtual robot's joints, the commands under way, the last good measurement. Trivially copyable; a
/// default value has not been started and gives no valid command.
/// @tparam UnderWay  memory of their servo.
template <std::size_t N, Real T, std::size_t History, class UnderWay = CommandsUnderWay<N, T, History>>
struct VirtualJointsMemory {
  bool started = false;
  bool stop = false;  ///< a stop was requested
  ResolverMode mode = ResolverMode::following;
  Nanoseconds time{};                  ///< of the virtual state
  detail::RunningPosition<N, T> q;     ///< q^
  JointVelocity<N, T> v;               ///< the virtual robot's velocity, which laws read
  JointVelocity<N, T> rate;            ///< dq^/dt: v, with the correction where that is sent
  JointAcceleration<N, T> last;        ///< dv/dt of the last sub-step
  State<N, T> measured;                ///< the last good measurement, less the gap and what contacts deflect
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
  UnderWay under_way;
  JointCommand<N, T> command;  ///< the last one
};

namespace detail {

/// The virtual joints of each group, in a plain tuple.
template <Real T, std::size_t History, class Groups>
struct VirtualGroups;
template <Real T, std::size_t History, class... Groups>
struct VirtualGroups<T, History, std::tuple<Groups...>> {
  template <class Group>
  using UnderWay = typename Group::template Servo<History>::Memory;
  using Memory = PlainTuple<VirtualJointsMemory<Groups::count, T, History, UnderWay<Groups>>...>;
};

/// What joints by torque remember beside their measurement.
template <std::size_t N, Real T, bool HasTank>
struct DrivenMemory {
  struct NoTank {};
  OwnTorque<N, T> own;       ///< the laws' torque in the last cycle [N m]
  JointTorque<N, T> torque;  ///< the torque that was sent last [N m]
  [[no_unique_address]] std::conditional_t<HasTank, typename EnergyTank<T>::template Held<N>, NoTank> tank;
};
template <Real T, bool HasTank>
struct DrivenMemory<0, T, HasTank> {};

/// State and command of all joints, where no group of virtual joints holds those of the whole robot.
template <std::size_t N, Real T>
struct WholeRobot {
  State<N, T> measured;          ///< the last good measurement
  JointCommand<N, T> command{};  ///< the last command
};
struct HeldByGroup {};

}  // namespace detail

/// A resolver's memory: virtual joints of each group, joints by torque, and the memory of its `Passivity` parts.
/// Trivially copyable; a default value has not been started and gives no valid command.
/// @tparam Sets  `JointGroups`.
template <std::size_t N, Real T, class Sets, std::size_t History = 32, class PassivityParts = Passivity<>>
struct ResolverMemory {
  static constexpr std::size_t joints = N;
  using Groups = typename Sets::StiffGroups;
  /// Whether one group of virtual joints is the whole robot.
  static constexpr bool one_group = std::tuple_size_v<Groups> == 1 && Sets::Driven::count == 0;
  bool started = false;
  bool stop = false;                  ///< a stop was requested
  Nanoseconds time{};                 ///< the end of the last interval
  Nanoseconds odd = detail::no_time;  ///< the last cycle's time, if the clock had gone back
  typename detail::VirtualGroups<T, History, Groups>::Memory stiff;
  [[no_unique_address]] detail::DrivenMemory<Sets::Driven::count, T,
                                             PassivityParts::template has<EnergyTank<T>>> driven;
  detail::OwnTorque<Sets::Stiff::count, T> own;  ///< the laws' torque in the last sub-step [N m]
  [[no_unique_address]] std::conditional_t<one_group, detail::HeldByGroup, detail::WholeRobot<N, T>> whole;
  [[no_unique_address]] typename PassivityParts::template Memory<N> passivity;

  /// The virtual joints of the stiff group `K`.
  template <std::size_t K = 0>
  [[nodiscard]] SKINCTL_INLINE auto& group() noexcept {
    return detail::element<K>(stiff);
  }
  template <std::size_t K = 0>
  [[nodiscard]] SKINCTL_INLINE const auto& group() const noexcept {
    return detail::element<K>(stiff);
  }
  /// The last command.
  [[nodiscard]] SKINCTL_INLINE const JointCommand<N, T>& command() const noexcept {
    if constexpr (one_group) {
      return group().command;
    } else {
      return whole.command;
    }
  }
  /// The last good measurement; of a robot that is one group of virtual joints less its gap and what contacts
  /// deflect.
  [[nodiscard]] SKINCTL_INLINE const State<N, T>& measured() const noexcept {
    if constexpr (one_group) {
      return group().measured;
    } else {
      return whole.measured;
    }
  }
};

SKINCTL_END_NAMESPACE
