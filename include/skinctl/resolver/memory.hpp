// SPDX-License-Identifier: BSD-3-Clause
// The memory of a resolver.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/detail/plain_tuple.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/passivity/passivity.hpp"
#include "skinctl/resolver/detail/believed_base.hpp"
#include "skinctl/resolver/detail/running_sum.hpp"
#include "skinctl/resolver/detail/torque_rate.hpp"
#include "skinctl/resolver/interval.hpp"
#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The virtual robot's joints, the commands under way, the last good measurement. Trivially copyable; a
/// default value has not been started and gives no valid command.
/// @tparam UnderWay  memory of the joints' servo.
template <std::size_t N, Real T, std::size_t History, class UnderWay = CommandsUnderWay<N, T, History>>
struct VirtualJointsMemory {
  bool started = false;
  bool stop = false;          ///< a stop was requested
  bool displaced = false;     ///< a gap beyond the largest one, which waits for consent
  bool brakes = false;        ///< the robot brakes: a stop, no measurement of the real robot, or displaced
  bool seen = false;          ///< the robot has been measured since the first command
  bool gap_told = false;      ///< whether `gap` began as that to the position told to the robot last
  bool late = false;          ///< velocity interface: whether a cycle came late since the joints rested
  std::uint64_t returns = 0;  ///< bit i: the leash pulls joint i back
  std::uint64_t cut = 0;      ///< bit i: the leash held joint i back since the last measurement
  Nanoseconds time{};         ///< time of the virtual state
  detail::RunningPosition<N, T> q;  ///< virtual position q^, by position the last command [rad]
  JointVelocity<N, T> rate;         ///< velocity of q^, which is sent [rad/s]
  JointVelocity<N, T> v;            ///< velocity that laws read: without the speed of a return [rad/s]
  JointAcceleration<N, T> last;     ///< acceleration, last sub-step; under jerk limits at its end [rad/s^2]
  State<N, T> measured;             ///< the last good measurement, less the gap and what contacts deflect
  JointPosition<N, T> residual;  ///< r: measured position less the position that the commands brought [rad]
  JointPosition<N, T> gap;       ///< g: distance that the robot moved away from its commands, by itself [rad]
  JointPosition<N, T> farthest;  ///< farthest measured position: motion beyond it may be a gap [rad]
  T held_for[N] = {};  ///< time for which the leash has held back a joint at rest, up to 5 total delays [s]
  detail::RunningPosition<N, T> sent;    ///< velocity interface: the integral of the sent velocities [rad]
  detail::RunningPosition<N, T> offset;  ///< velocity interface: corrections of q^ without motion [rad]
  UnderWay under_way;
  JointCommand<N, T> command;  ///< last command
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

/// Memory of joints by torque, beside their measurement.
template <std::size_t N, Real T, bool HasTank>
struct DrivenMemory {
  struct NoTank {};
  OwnTorque<N, T> own;        ///< the laws' torque in the last cycle [N m]
  JointTorque<N, T> torque;   ///< the torque that was sent last [N m]
  JointPosition<N, T> stood;  ///< measured position at which a stopped robot is held [rad]
  T stopped = 0;              ///< time since a stop began [s]
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

/// Commands under way for which there is room, unless a scene has a `CommandHistory`: those of a delay of 30
/// periods, 60 ms at 500 Hz.
inline constexpr std::size_t default_history = 32;

/// A resolver's memory: virtual joints of each group, joints by torque, and the memory of its `Passivity`
/// parts. Trivially copyable; a default value has not been started and gives no valid command.
/// @tparam Sets  `JointGroups`.
template <std::size_t N, Real T, class Sets, std::size_t History = default_history,
          class PassivityParts = Passivity<>>
struct ResolverMemory {
  static constexpr std::size_t joints = N;
  using Groups = typename Sets::StiffGroups;
  /// Whether one group of virtual joints is the whole robot.
  static constexpr bool one_group = std::tuple_size_v<Groups> == 1 && Sets::Driven::count == 0;
  bool started = false;
  bool stop = false;                       ///< a stop was requested
  bool left = false;                       ///< the robot did not follow its law in the last cycle
  std::uint8_t short_intervals = 0;        ///< intervals that were too short, in a row, up to 255
  Nanoseconds time{};                      ///< the end of the last interval
  Nanoseconds odd_time = detail::no_time;  ///< the last cycle's time, if the clock had gone back
  Nanoseconds carried{};                   ///< time by which cycles came too soon, up to a period
  typename detail::VirtualGroups<T, History, Groups>::Memory stiff;
  [[no_unique_address]] detail::DrivenMemory<Sets::Driven::count, T,
                                             PassivityParts::template has<EnergyTank<T>>> driven;
  detail::OwnTorque<Sets::Stiff::count, T> own;  ///< the laws' torque in the last sub-step [N m]
  [[no_unique_address]] std::conditional_t<one_group, detail::HeldByGroup, detail::WholeRobot<N, T>> whole;
  [[no_unique_address]] typename PassivityParts::template Memory<N> passivity;

  /// The virtual joints of the stiff group `K`, which takes positions or velocities.
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
