// SPDX-License-Identifier: BSD-3-Clause
// Errors for laws that violate the protocol: one line, at the point where a sum or a scene is built. A faulty
// law is then replaced by one that does nothing, so that no further errors follow.
#pragma once

#include "skinctl/law/evaluate.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The possible faults of a law.
enum class LawFault {
  none,
  no_memory,
  heavy_memory,
  pointer_in_memory,
  mutable_member,
  no_needs,
  no_role,
  no_start,
  no_torque,
  no_advance,
  no_receive,
  no_goal,
  other_joints,
  other_scalar,
  missing_link,
  start_arguments,
  start_result,
  advance_arguments,
  advance_result,
  advance_throws,
  no_parts,
  no_gravity,
  torque_arguments,
  torque_result,
  torque_throws,
  receive_arguments,
  receive_result,
  follow_signature,
  status_signature,
  settled_signature,
  resumed_signature,
  distance_signature,
  now_signature,
  evaluate_signature,
  name_type,
  presses_type,
  friction_type,
  blank_type,
  gravity_laws_type,
  complete_sum_type,
  terms_type,
  see_signature,
  input_unseen,
  output_signature,
  waits_signature
};
/// A law and its fault.
template <LawFault F, class L>
struct Found {
  static constexpr LawFault fault = F;
  using Law = L;
};
/// Raises the error for a fault. Used in a `static_assert` of the function that a user calls, so that the
/// error appears once, with few lines of context. (Reading any member of a class with an error is one more
/// error in Clang.) As the type of a parameter it is raised at the call itself: the least context.
template <LawFault F, class L>
struct Say {
  using enum LawFault;
  constexpr Say() noexcept = default;
  template <class X>
  constexpr Say(const X&) noexcept {}
  static_assert(F != no_memory,
                "this law lacks its Memory: `struct Memory {...};`, or derive from StatelessLaw");
  static_assert(F != heavy_memory,
                "the Memory of this law is not trivially copyable: a cycle copies and records it");
  static_assert(F != pointer_in_memory,
                "the Memory of this law holds a pointer: a copy or a replay would share what it points to");
  static_assert(F != mutable_member,
                "this law has a mutable member: put what changes from cycle to cycle in its Memory");
  static_assert(F != no_needs, "this law lacks its needs: `static constexpr Needs needs = {...};`");
  static_assert(F != no_role,
                "this law lacks its role: `static constexpr LawRole role = LawRole::reactive;`");
  static_assert(F != no_start, "this law lacks start(known), which returns a Memory");
  static_assert(F != no_torque, "this law lacks torque(memory, known), which returns a JointTorque");
  static_assert(F != no_advance, "this law lacks advance(memory, known, dt, opposition)");
  static_assert(F != no_receive, "this law has a Goal, but lacks receive(memory, known, goal)");
  static_assert(F != no_goal, "this law receives goals, but does not name their type: `using Goal = ...;`");
  static_assert(F != other_joints, "this law is for a robot with another number of joints");
  static_assert(F != other_scalar, "this law is for a robot in another scalar");
  static_assert(F != missing_link,
                "this law asks for a link that the robot does not have: links count from 0");
  static_assert(F != start_arguments,
                "start(known) of this law is not const, or does not take what is known");
  static_assert(F != start_result, "start(known) of this law does not return its Memory");
  static_assert(F != advance_arguments,
                "advance(memory, known, dt, opposition) of this law is not const, or does not take these");
  static_assert(F != advance_result,
                "advance(memory, known, dt, opposition) of this law does not return its Memory");
  static_assert(F != advance_throws, "advance(...) of this law may throw in the loop: mark it noexcept");
  static_assert(F != no_parts, "a tracking law in a sum gives its parts(memory, known), a TorqueParts");
  static_assert(F != no_gravity,
                "a tracking law without a gravity law beside it holds G(q): set needs.gravity");
  static_assert(
      F != torque_arguments,
      "torque(memory, known) of this law is not const, or does not take its Memory and what is known");
  static_assert(F != torque_result,
                "the torque of this law is not a JointTorque (its parts: TorqueParts) of the robot's joints "
                "and scalar");
  static_assert(F != torque_throws, "the torque of this law may throw in the loop: mark it noexcept");
  static_assert(F != receive_arguments, "receive(memory, known, goal) of this law does not take its Goal");
  static_assert(F != receive_result,
                "receive(memory, known, goal) of this law does not return a Received<Memory>");
  static_assert(
      F != follow_signature,
      "follow(memory, known, goal) of this law does not take its Goal, or returns no Received<Memory>");
  static_assert(F != status_signature, "status(memory) of this law is not const, or returns no Status");
  static_assert(
      F != settled_signature,
      "settled(memory, known, still) of this law is not const, does not take these, or returns no bool");
  static_assert(F != resumed_signature,
                "resumed(memory, known) of this law is not const, or does not return its Memory");
  static_assert(F != distance_signature,
                "distance(known, goal) of this law does not return position, orientation and joint");
  static_assert(F != now_signature, "now(memory, known) of this law is not const, or does not take these");
  static_assert(
      F != evaluate_signature,
      "evaluate(memory, known, dt) of this law does not return the Evaluation of its Memory and terms");
  static_assert(F != name_type, "name of this law is no text: `static constexpr const char* name = ...;`");
  static_assert(F != presses_type,
                "presses of this law is no constant: `static constexpr bool presses = true;`");
  static_assert(F != friction_type, "compensates_friction of this law is no `static constexpr bool`");
  static_assert(F != blank_type, "starts_blank of this law is no `static constexpr bool`");
  static_assert(F != gravity_laws_type, "gravity_laws of this law is no `static constexpr std::size_t`");
  static_assert(F != complete_sum_type, "complete_sum of this law is no `static constexpr bool`");
  static_assert(
      F != see_signature,
      "see(memory, input, seen) of this law is not const, does not take these, or returns no Status");
  static_assert(F != input_unseen,
                "this law has an Input, but lacks see(memory, input, seen), which reads it");
  static_assert(F != output_signature,
                "output(memory) of this law is not const, or does not return its Output");
  static_assert(F != waits_signature, "needs_contacts() of this law is not const, or returns no bool");
  static_assert(
      F != terms_type,
      "terms of this law is no `static constexpr std::size_t`, or roles no array of as many LawRole");
};

/// The `Goal` of a law that has one.
template <class L>
struct GoalOfLaw {};
template <HasGoal L>
struct GoalOfLaw<L> {
  using Goal = typename L::Goal;
};
/// Replaces a faulty law after its error: does nothing, and accepts any constructor arguments.
template <class L>
struct WrongLaw : Composable, GoalOfLaw<L> {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr std::size_t gravity_laws = LawTable<L>::gravity_laws;
  static constexpr bool compensates_friction = LawTable<L>::compensates_friction;
  static constexpr LawRole role = LawTable<L>::role;
  static constexpr std::size_t joints = LawTable<L>::joints;
  template <class... X>
  constexpr WrongLaw(const X&...) noexcept {}
  template <class K>
  [[nodiscard]] Memory start(const K&) const noexcept {
    return {};
  }
  template <GravityTerm = GravityTerm::included, class K>
  [[nodiscard]] JointTorque<K::joints, typename K::scalar> torque(
      const Memory&, const K&, const LawShare<typename K::scalar>& = {}) const noexcept {
    return {};
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory&, const K&, const typename K::scalar&,
                               Opposition) const noexcept {
    return {};
  }
  template <class K, class G>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K&, const G&) const noexcept {
    return {memory, {}};
  }
};

template <class L>
inline constexpr bool is_wrong_law = false;
template <class L>
inline constexpr bool is_wrong_law<WrongLaw<L>> = true;

}  // namespace detail
SKINCTL_END_NAMESPACE
