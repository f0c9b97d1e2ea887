// The concept of a law: a configuration that turns what is known into torque, with its changing part outside.
#pragma once

#include <concepts>
#include <type_traits>

#include "skinctl/core/needs.hpp"
#include "skinctl/core/state.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The operators of law expressions (`0.6 * skin + gravity`) live in this namespace, and a law finds them by
/// deriving from `Composable`. Whoever mistypes an expression of other things does not meet them in the
/// error.
namespace expression {
struct Composable {};
}  // namespace expression
using expression::Composable;

/// How a law enters a sum, eq. (23).
enum class Role : unsigned char {
  tracking,  ///< follows a target: feedback is weighted, feed-forwards enter as one convex mean
  reactive,  ///< answers the skin: its weight is not normalised
  gravity    ///< compensates gravity: weight 1, at most once in an expression
};

/// Whether a torque holds G(q). It must not where a gravity law is loaded beside it.
enum class GravityTerm : bool { left_out, included };

/// What a tracking law multiplies its two parts by: `tau = feedback * (-K_d S_q) + feed_forward * (Y_r
/// Theta)`.
template <Scalar T>
struct Share {
  T feedback = T(1);
  T feed_forward = T(1);
};

/// Whether the skin pushes against the tracking laws just now (end of the paper's section 4.2.1): on entry
/// and while it lasts, integrals and clocks stand still; at the release they are reset without a jump.
enum class Opposition : unsigned char { none, lasting, released };

/// A law for a robot of `K`'s size: an immutable value with
/// - `Memory`: what changes from cycle to cycle, trivially copyable;
/// - `needs`, `role`: compile-time values;
/// - `start(known)`: the memory with which it takes over at that state;
/// - `torque(memory, known)`: the joint torque [N m], pure and noexcept;
/// - `advance(memory, known, dt, opposition)`: the memory after `dt` seconds, pure and noexcept.
/// `known` is a `Quantities`: the state, what was computed from it, and the interval for which the torque
/// will be held. A law that derives from `Composable` can be written in expressions.
template <class L, class K>
concept Law =
    requires(const L& law, const typename L::Memory& memory, const K& known, typename K::scalar dt) {
      requires std::is_trivially_copyable_v<typename L::Memory>;
      { L::needs } -> std::convertible_to<Needs>;
      { L::role } -> std::convertible_to<Role>;
      { law.start(known) } -> std::same_as<typename L::Memory>;
      { law.torque(memory, known) } -> std::same_as<JointTorque<K::joints, typename K::scalar>>;
      { law.advance(memory, known, dt, Opposition::none) } -> std::same_as<typename L::Memory>;
    };

SKINCTL_END_NAMESPACE
