// SPDX-License-Identifier: BSD-3-Clause
// What a limit of a scene is: a part of its governor.
#pragma once

#include <concepts>
#include <type_traits>

#include "skinctl/core/joint.hpp"
#include "skinctl/core/link_mask.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The motion that a limit judges in one cycle.
///
/// @tparam Motion, Torque  whether some joints take positions or velocities, and whether some take torques.
template <std::size_t N, Real T, bool Motion, bool Torque>
struct Going {
  static constexpr std::size_t joints = N;
  static constexpr bool by_motion = Motion, by_torque = Torque;
  JointPosition<N, T>
      q;  ///< the position that was commanded last; of joints by torque the measured one [rad]
  JointVelocity<N, T>
      from;  ///< the velocity that was commanded last; of joints by torque the measured one [rad/s]
  JointRoom<N, T> room;         ///< distances from `q` to the position limits of the joints [rad]
  const State<N, T>& measured;  ///< the last good state of the robot
  T dt;                         ///< duration of the command [s], > 0
  T passed;                     ///< time since the last cycle [s], > 0
  T ahead;                      ///< time of prediction, in which joints by torque brake [s]
  bool slides;                  ///< true: motion may slide along a limit; false: a stop was requested

  /// The displacement while the velocity changes steadily from `from` to `to` in `dt` seconds [rad].
  [[nodiscard]] SKINCTL_INLINE JointPosition<N, T> half_way(const JointVelocity<N, T>& to) const noexcept {
    return integrate(JointPosition<N, T>(), from + to, T(T(0.5) * dt));
  }
};

/// The factor in [0, 1] by which a limit scales all joint velocities, and the reasons.
template <Real T>
struct SpeedShare {
  T scale = T(1);
  Status status;
};

/// The joint velocity [rad/s] that a limit leaves of the one asked for, and whether the limit acted.
template <std::size_t N, Real T>
struct KeptVelocity {
  JointVelocity<N, T> velocity;
  bool limited = false;
};

/// The order in which the limits of a scene act; where they conflict, the later one wins.
enum class Precedence : unsigned char {
  moves,       ///< motion of the joints within limits of jerk: it gives way to all others
  contact,     ///< force and power of contacts
  coverage,    ///< reaction to cells of the skin that do not report
  places,      ///< speed of places on the skin: lower where only a larger force is felt
  free,        ///< limits of the user's own
  tool_speed,  ///< speed of a point of the robot
  clearance,   ///< distance from bodies
  torque       ///< position and speed of joints by torque
};

/// The `Input` of a limit that adds nothing to the input of a cycle.
struct NoInput {};

// A limit is made of its settings, an argument of `Cycle::with`, by `part_for(model, limits, settings)`
// beside them. A member that is named and has another signature than here does not compile
// (`limits/detail/limit_fault.hpp`).
//
// | member of a limit                        |                                                              | without it |
// | `Kind`                                   | a type: a scene has one part of each kind; its settings have the same | - |
// | `Memory`                                 | trivially copyable; `Memory{}` at the start                  | -         |
// | `precedence`                             | a `Precedence`                                               | -         |
// | `share(m, going, seen, u) -> SpeedShare` | slows all joints alike from the velocity `u`: give the share that leads to a speed, a constant one compounds; or: | - |
// | `within(m, going, u, also) -> KeptVelocity` | another velocity, reached from `going.from`; `also(v)`: whether earlier limits keep v | - |
// | `reason`                                 | status where `within` acts                                   | -         |
// | `keeps(m, going, v, moved) -> bool`      | whether a motion that ends at v, by `moved`, keeps it: else a smooth motion gives way | true |
// | `of_the_drive`                           | by torque it judges motion by the motors, not by external forces | false |
// | `look(m, seen, dt) -> Status`            | before the laws, `dt` seconds since the last cycle           | nothing   |
// | `stays(m) -> bool`                       | whether the robot is to brake and hold                       | false     |
// | `Input`, `see(m, input, q, now)`         | what it adds to the input of a cycle, and takes from it      | nothing   |
// | `stand_off(m, off)`                      | learns `off`: measured less expected positions               | nothing   |
// | `links`                                  | links whose touch it reads: the scene's skin covers them     | none      |
// | `reads_coverage`                         | whether it asks what cells feel: how much, and how well      | false     |
// | `check(resolver)`                        | throws for a robot that it does not suit                     | nothing   |
// | `decides_motion`, `set<S>()`             | it decides how the joints of S move: `move`, `brake`, `exceeded` of `JerkLimits` | limits of the joints alone |
// | `limits_torque`                          | it limits torques: `observe`, `forget`, `resistance`, `box`, `within` of `MotionLimits` | nothing |
namespace detail {

template <class L>
concept LimitWithKind = requires { typename L::Kind; };
template <class L>
concept LimitWithMemory = requires { typename L::Memory; };
template <class L>
concept LimitWithPrecedence = requires {
  { L::precedence } -> std::convertible_to<Precedence>;
};
template <class L>
concept DecidesMotion = requires { requires L::decides_motion; };
template <class L>
concept LimitsTorque = requires { requires L::limits_torque; };
template <class L>
concept OfTheDrive = requires { requires L::of_the_drive; };
template <class L, class Q>
concept StandsOff =
    requires(const L& limit, typename L::Memory& m, const Q& off) { limit.stand_off(m, off); };
template <class L>
concept NamesInput = requires { typename L::Input; };
template <class L>
concept LimitWithInput = NamesInput<L> && !std::is_same_v<typename L::Input, NoInput>;
template <class L, class Q>
concept Sees = requires(const L& limit, typename L::Memory& m, const typename L::Input& input, const Q& q,
                        Nanoseconds now) { limit.see(m, input, q, now); };
template <class L>
concept ReadsTouch = requires {
  { L::links } -> std::convertible_to<LinkMask>;
};
template <class L>
concept ReadsCoverage = requires { requires L::reads_coverage; };
template <class L, class Robot>
concept ChecksRobot = requires(const L& limit, const Robot& robot) { limit.check(robot); };
template <class L>
concept Stays = requires(const L& limit, const typename L::Memory& m) {
  { limit.stays(m) } -> std::convertible_to<bool>;
};
template <class L, class Seen, class T>
concept Looks = requires(const L& limit, typename L::Memory& m, const Seen& seen, const T& dt) {
  { limit.look(m, seen, dt) } -> std::convertible_to<Status>;
};
template <class L, class Going, class Seen, class U>
concept Shares = requires(const L& limit, typename L::Memory& m, const Going& going, const Seen& seen,
                          const U& u) { limit.share(m, going, seen, u).scale; };
struct AllKeep {
  template <class U>
  constexpr bool operator()(const U&) const noexcept {
    return true;
  }
};
template <class L, class Going, class U>
concept Turns = requires(const L& limit, const typename L::Memory& m, const Going& going, const U& u) {
  limit.within(m, going, u, AllKeep{}).velocity;
  { L::reason } -> std::convertible_to<Reason>;
};
template <class L, class Going, class U, class Q>
concept Keeps =
    requires(const L& limit, const typename L::Memory& m, const Going& going, const U& u, const Q& moved) {
      { limit.keeps(m, going, u, moved) } -> std::convertible_to<bool>;
      { L::reason } -> std::convertible_to<Reason>;
    };

}  // namespace detail
SKINCTL_END_NAMESPACE
