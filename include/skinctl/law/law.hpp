// The protocol of a law: an immutable configuration that computes joint torque from the known state; its
// memory is kept outside.
#pragma once

#include <concepts>
#include <type_traits>

#include "skinctl/core/needs.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The operators of law expressions (`0.6 * skin + gravity`) live in this namespace, and a law finds them by
/// deriving from `Composable`. Errors in expressions of other types do not list them.
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

/// Whether a torque includes G(q). It must not where a gravity law is loaded beside it.
enum class GravityTerm : bool { left_out, included };

/// The factors with which a sum multiplies the two parts of a tracking law.
template <Scalar T>
struct LawShare {
  T feedback = T(1);
  T feed_forward = T(1);
};

/// The two parts of a tracking law's torque [N m], both without G(q), which the sum adds.
template <std::size_t N, Scalar T = double>
struct TorqueParts {
  JointTorque<N, T> feedback;      ///< the reaction to the error, `-K_d S_q`
  JointTorque<N, T> feed_forward;  ///< the torque of the planned motion, `Y_r Theta - G`
};

/// Whether the skin pushes against the tracking laws (end of the paper's section 4.2.1). While it lasts,
/// integrals and clocks stand still; at the release they are reset without a jump.
enum class Opposition : unsigned char { none, lasting, released };

/// A memory after a request (a new goal), and the status of that request.
template <class M>
struct Received {
  M memory;
  Status status;
};

/// Base of a law without memory: `Own` defines `torque(known)`, and `needs` and `role` where they differ from
/// the defaults.
///
///     struct Damper : StatelessLaw<Damper> {
///       JointTorque<6> torque(const auto& known) const noexcept {
///         return JointTorque<6>::generate([&](std::size_t i) { return -2.0 * known.dq()[i]; });
///       }
///     };
///
/// @tparam Own  the law that derives from this base. The memories of different laws are then different empty
///              types, which take no space side by side.
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
// Traits, not requires-expressions in generic lambdas: Clang 14 evaluates the latter to false.
template <class L, class K>
inline constexpr bool has_torque =
    requires(const L& law, const typename L::Memory& m, const K& known) { law.torque(m, known); };
/// The arguments of a law's functions; a law without memory may leave the memory out.
template <class L, class K>
inline constexpr bool has_stateless_torque =
    std::is_empty_v<typename L::Memory> && requires(const L& law, const K& known) { law.torque(known); };
template <class L, class K>
inline constexpr bool has_parts =
    requires(const L& law, const typename L::Memory& m, const K& known) { law.parts(m, known); };
template <class L, class K>
inline constexpr bool has_stateless_parts =
    std::is_empty_v<typename L::Memory> && requires(const L& law, const K& known) { law.parts(known); };
/// The memory with which a law begins is the same in every state: there is none, or the law says so.
template <class L>
concept StartsBlank = std::is_empty_v<typename L::Memory> || requires { requires L::starts_blank; };
template <class L, class K>
inline constexpr bool has_weighted_torque = requires(
    const L& law, const typename L::Memory& m, const K& known, const LawShare<typename K::scalar>& share) {
  law.template torque<GravityTerm::left_out>(m, known, share);
};
}  // namespace detail

/// A law for a robot of `K`'s size: an immutable value. `known` is a `Quantities`: the state, the quantities
/// computed from it, and the interval for which the torque will be held. All functions are const, pure and
/// `noexcept`. The library uses no other members of a law.
///
/// Every law has
/// - `Memory`: the data that change from cycle to cycle, trivially copyable. Only the law itself reads or
///   writes its members;
/// - `needs`, `role`: compile-time values;
/// - `start(known)`: the memory with which the law begins at that state;
/// - `torque(memory, known)`: the joint torque [N m]; `torque(known)` if `Memory` is empty. A tracking law
///   has `parts` instead, see `TrackingLaw`;
/// - `advance(memory, known, dt, opposition)`: the memory after `dt` seconds.
///
/// `StatelessLaw` derives all but the torque. A law that derives from `Composable` can be written in sums.
///
/// Optional members, with the default where a law has none:
///
/// | member | meaning | default |
/// |---|---|---|
/// | `status(memory)` | the reasons for what it limits, holds or ramps out in this cycle | none |
/// | `settled(memory, known, still)` | whether it is at rest at its goal | no joint is faster than `still` |
/// | `presses` | a tracking law that presses against a contact: the skin does not oppose it | false |
/// | `joints`, `scalar` | the robots for which it is made: compared where a scene is built | any |
/// | `compensates_friction` | its torque includes friction, so the robot must not add it | false |
/// | `check_for(terms)` | throws if its settings differ from the robot's (`LawTerms`) | any |
/// | `name` | for `describe` | "law" |
/// | `terms` | number of shares in its own `evaluate` | 1 |
/// | `Laws` | a law made of others: a `std::tuple` of their types, each checked on its own | - |
/// | `gravity_laws`, `complete_sum`, `gate` | for sums, blends and gates: fusion/ | - |
///
/// Optional, for speed alone; the results are the same:
/// - `evaluate(memory, known, dt)`: torque, next memory, shares and status at once (`Evaluation`). Used in
///   place of `torque`, `advance` and `status` where the law is the only one of a scene.
/// - `now(memory, known)`: the common terms of torque and next memory, computed once in a sum. The law then
///   takes them as the last argument of `torque<G>(memory, known, share, now)` and of
///   `advance(..., opposition, now)`.
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

/// A law of role `tracking`. It gives the parts of its torque separately, because a sum weights them
/// differently:
/// - `parts(memory, known)`: a `TorqueParts`; `parts(known)` if `Memory` is empty. The sum adds G(q) unless
///   it holds a gravity law. Where the law is the only one of a scene, the scene adds G(q), so `needs` must
///   include `gravity`.
///
/// Optional, for speed: `torque<G>(memory, known, share)`, the weighted sum of both parts,
/// `feedback * (-K_d S_q) + feed_forward * (Y_r Theta)`, with `feed_forward * G(q)` if G is
/// `GravityTerm::included`, its default. A law that has it needs no `parts`. One recursion then computes both
/// parts and gravity.
template <class L, class K>
concept TrackingLaw =
    Law<L, K> && L::role == LawRole::tracking &&
    (detail::has_parts<L, K> || detail::has_stateless_parts<L, K> || detail::has_weighted_torque<L, K>);

/// A law that takes goals:
/// - `Goal`: their type;
/// - `receive(memory, known, goal)`: a `Received<Memory>`. A refused goal leaves the memory unchanged and
///   gives `Reason::goal_refused`.
///
/// A law for moving targets adds `follow(memory, known, goal)` for the next sample of a target. Where it
/// exists it is called in place of `receive`, and distinguishes a sample from a new goal.
template <class L, class K>
concept GoalLaw = Law<L, K> && requires(const L& law, const typename L::Memory& memory, const K& known,
                                        const typename L::Goal& goal) {
  { law.receive(memory, known, goal) } -> std::same_as<Received<typename L::Memory>>;
};

SKINCTL_END_NAMESPACE
