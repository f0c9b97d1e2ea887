// The protocol of a law: a configuration that turns what is known into torque, with its changing part outside.
#pragma once

#include <concepts>
#include <type_traits>

#include "skinctl/core/needs.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The operators of law expressions (`0.6 * skin + gravity`) live in this namespace, and a law finds them by
/// deriving from `Composable`. Whoever mistypes an expression of other things does not meet them in the
/// error.
namespace expression {
struct Composable {};
}  // namespace expression
using expression::Composable;

/// How a law enters a sum, eq. (23).
enum class LawRole : unsigned char {
  tracking,  ///< follows a target: feedback is weighted, feed-forwards enter as one convex mean
  reactive,  ///< answers the skin: its weight is not normalised
  gravity    ///< compensates gravity: weight 1, at most once in an expression
};

/// Whether a torque holds G(q). It must not where a gravity law is loaded beside it.
enum class GravityTerm : bool { left_out, included };

/// What a sum multiplies the two parts of a tracking law by.
template <Scalar T>
struct LawShare {
  T feedback = T(1);
  T feed_forward = T(1);
};

/// The two parts of a tracking law's torque [N m], both without G(q): the sum holds it.
template <std::size_t N, Scalar T = double>
struct TorqueParts {
  JointTorque<N, T> feedback;      ///< what the error asks for, as `-K_d S_q`
  JointTorque<N, T> feed_forward;  ///< what the motion itself asks for, as `Y_r Theta - G`
};

/// Whether the skin pushes against the tracking laws just now (end of the paper's section 4.2.1): on entry
/// and while it lasts, integrals and clocks stand still; at the release they are reset without a jump.
enum class Opposition : unsigned char { none, lasting, released };

/// A memory after something was asked for (a new goal), and what came of it.
template <class M>
struct Received {
  M memory;
  Status status;
};

/// The base of a law without memory: `Own` states `torque(known)`, and `needs` and `role` where they differ.
///
///     struct Damper : StatelessLaw<Damper> {
///       JointTorque<6> torque(const auto& known) const noexcept {
///         return JointTorque<6>::generate([&](std::size_t i) { return -2.0 * known.dq()[i]; });
///       }
///     };
///
/// @tparam Own  the law that derives from it: memories of different laws are different types, which take no
///              room side by side.
template <class Own>
struct StatelessLaw : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;

  template <class K>
  [[nodiscard]] static SKINCTL_INLINE constexpr Memory start(const K&) noexcept {
    return {};
  }
  template <class K>
  [[nodiscard]] static SKINCTL_INLINE constexpr Memory advance(const Memory&, const K&,
                                                               const typename K::scalar&,
                                                               Opposition) noexcept {
    return {};
  }
};

namespace detail {
// Traits, not requires-expressions in generic lambdas: Clang 14 takes those for false.
template <class L, class K>
inline constexpr bool has_torque =
    requires(const L& law, const typename L::Memory& m, const K& known) { law.torque(m, known); };
/// A law without memory may leave it out of its signatures.
template <class L, class K>
inline constexpr bool has_stateless_torque =
    std::is_empty_v<typename L::Memory> && requires(const L& law, const K& known) { law.torque(known); };
template <class L, class K>
inline constexpr bool has_parts =
    requires(const L& law, const typename L::Memory& m, const K& known) { law.parts(m, known); };
template <class L, class K>
inline constexpr bool has_stateless_parts =
    std::is_empty_v<typename L::Memory> && requires(const L& law, const K& known) { law.parts(known); };
template <class L, class K>
inline constexpr bool has_weighted_torque = requires(
    const L& law, const typename L::Memory& m, const K& known, const LawShare<typename K::scalar>& share) {
  law.template torque<GravityTerm::left_out>(m, known, share);
};
}  // namespace detail

/// A law for a robot of `K`'s size: an immutable value. `known` is a `Quantities`: the state, what was
/// computed from it, and the interval for which the torque will be held. All functions are const, pure and
/// `noexcept`. This is all that the library uses of a law.
///
/// Every law has
/// - `Memory`: what changes from cycle to cycle, trivially copyable. Nobody else reads or writes its members;
/// - `needs`, `role`: compile-time values;
/// - `start(known)`: the memory with which it takes over at that state;
/// - `torque(memory, known)`: the joint torque [N m]; `torque(known)` if `Memory` is empty. A tracking law
///   has its parts in place of it, see `TrackingLaw`;
/// - `advance(memory, known, dt, opposition)`: the memory after `dt` seconds.
///
/// `StatelessLaw` derives all but the torque. A law that derives from `Composable` can be written in sums.
///
/// Others may know of a law, and take the default where it says nothing:
///
/// | member | says | default |
/// |---|---|---|
/// | `status(memory)` | what it limits, holds or hands over just now | nothing |
/// | `settled(memory, known, still)` | whether it has come to rest where it was sent | no joint is faster than `still` |
/// | `presses` | a tracking law that presses against what it touches: the skin does not oppose it | false |
/// | `joints`, `scalar` | for which robots it is: compared where a scene is built | any |
/// | `compensates_friction` | its torque holds the joints' friction, so the robot must not | false |
/// | `check_for(terms)` | throws where its settings are not those of the robot (`LawTerms`) | any |
/// | `name` | for `describe` | "law" |
/// | `terms` | number of shares in its own `evaluate` | 1 |
/// | `Laws` | a law made of others: a `std::tuple` of their types, each checked on its own | - |
/// | `gravity_laws`, `complete_sum`, `gate` | of sums, blends and gates: fusion/ | - |
///
/// Optional, for speed alone; what they return is the same:
/// - `evaluate(memory, known, dt)`: torque, next memory, shares and status at once (`Evaluation`). Used in
///   place of `torque`, `advance` and `status` where the law stands alone in a scene.
/// - `now(memory, known)`: what torque and next memory share, computed once in a sum. The law then takes it
///   as the last argument of `torque<G>(memory, known, share, now)` and of `advance(..., opposition, now)`.
template <class L, class K>
concept Law =
    requires(const L& law, const typename L::Memory& memory, const K& known, const typename K::scalar& dt) {
      requires std::is_trivially_copyable_v<typename L::Memory>;
      { L::needs } -> std::convertible_to<Needs>;
      { L::role } -> std::convertible_to<LawRole>;
      { law.start(known) } -> std::same_as<typename L::Memory>;
      { law.advance(memory, known, dt, Opposition::none) } noexcept -> std::same_as<typename L::Memory>;
    } && (requires(const L& law, const typename L::Memory& memory, const K& known) {
      { law.torque(memory, known) } noexcept -> std::same_as<JointTorque<K::joints, typename K::scalar>>;
    } || (detail::has_stateless_torque<L, K> && requires(const L& law, const K& known) {
            { law.torque(known) } noexcept -> std::same_as<JointTorque<K::joints, typename K::scalar>>;
          }) || detail::has_parts<L, K> || detail::has_stateless_parts<L, K>);

/// A law of role `tracking`. It tells a sum its parts, so that they are weighed rightly:
/// - `parts(memory, known)`: a `TorqueParts`; `parts(known)` if `Memory` is empty. Whoever adds them up adds
///   G(q), unless a gravity law is there. A law that stands alone in a scene needs `gravity` for that.
///
/// Optional, for speed: `torque<G>(memory, known, share)`, the weighted sum of both parts,
/// `feedback * (-K_d S_q) + feed_forward * (Y_r Theta)`, with `feed_forward * G(q)` if G is
/// `GravityTerm::included`, its default; where a law has it, `parts` is not asked for. One recursion then
/// serves both parts and gravity.
template <class L, class K>
concept TrackingLaw =
    Law<L, K> && L::role == LawRole::tracking &&
    (detail::has_parts<L, K> || detail::has_stateless_parts<L, K> || detail::has_weighted_torque<L, K>);

/// A law that takes goals:
/// - `Goal`: their type;
/// - `receive(memory, known, goal)`: a `Received<Memory>`. A goal that it refuses leaves the memory as it was
///   and says `Reason::goal_refused`.
///
/// A law of targets that move adds `follow(memory, known, goal)`, the next sample of one: where it has that,
/// it is called in place of `receive`, and tells a sample from a new goal.
template <class L, class K>
concept GoalLaw = Law<L, K> && requires(const L& law, const typename L::Memory& memory, const K& known,
                                        const typename L::Goal& goal) {
  { law.receive(memory, known, goal) } -> std::same_as<Received<typename L::Memory>>;
};

SKINCTL_END_NAMESPACE
