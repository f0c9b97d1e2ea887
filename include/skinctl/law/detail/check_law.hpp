// SPDX-License-Identifier: BSD-3-Clause
// Finds the fault of a law that violates the protocol.
#pragma once

#include <tuple>

#include "skinctl/core/time.hpp"
#include "skinctl/law/detail/hidden_state.hpp"
#include "skinctl/law/detail/law_fault.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The first declared number of joints of several laws.
template <class... L>
constexpr std::size_t joints_of_laws() noexcept {
  std::size_t found = 0;
  ((found = found > 0 ? found : LawTable<L>::joints), ...);
  return found;
}
/// Whether two laws declare different numbers of joints.
template <class A, class B>
inline constexpr bool are_for_two_robots =
    LawTable<A>::joints != 0 && LawTable<B>::joints != 0 && LawTable<A>::joints != LawTable<B>::joints;
template <class L>
concept LacksStart = CanBeAsked<L> && !NamesStart<L>;
template <class L>
concept LacksTorque = CanBeAsked<L> && !NamesTorque<L> && !NamesParts<L>;
template <class L>
concept LacksAdvance = CanBeAsked<L> && !NamesAdvance<L>;
template <class L>
concept LacksReceive = CanBeAsked<L> && !NamesReceive<L>;
/// A wrapper, a sum and what stands for a faulty law name `receive` and what belongs to it whatever they
/// take.
template <class L>
concept NamesForOthers = IsMadeOfLaws<L> || IsWrapper<L> || is_wrong_law<L>;

/// The fault of an optional member with a wrong type or signature.
template <class L>
consteval LawFault fault_in_optional() {
  using enum LawFault;
  if (NamesStatus<L> && !HasStatus<L>) return status_signature;
  if (NamesFollow<L> && !HasGoal<L> && !NamesForOthers<L>) return no_goal;
  if (NamesName<L> && !HasName<L>) return name_type;
  if (NamesPresses<L> && !HasPresses<L>) return presses_type;
  if (NamesFriction<L> && !HasFriction<L>) return friction_type;
  if (NamesStartsBlank<L> && !HasStartsBlank<L>) return blank_type;
  if (NamesGravityLaws<L> && !HasGravityLaws<L>) return gravity_laws_type;
  if (NamesCompleteSum<L> && !HasCompleteSum<L>) return complete_sum_type;
  if (HasLawInput<L> && CanBeAsked<L> && !NamesLawSee<L>) return input_unseen;
  if (NamesOutput<L> && !HasLawOutput<L>) return output_signature;
  if (NamesWaits<L> && !TellsWaits<L>) return waits_signature;
  if ((NamesTerms<L> && !HasTerms<L>) || (NamesRoles<L> && !HasRoles<L>)) return terms_type;
  return none;
}
/// The faults of a law that do not depend on a robot.
template <class L>
consteval LawFault fault_in_members() {
  if constexpr (!HasMemory<L>) {
    return LawFault::no_memory;
  } else if constexpr (!std::is_trivially_copyable_v<typename L::Memory>) {
    return LawFault::heavy_memory;
  } else if constexpr (HasPointerField<typename L::Memory>) {
    return LawFault::pointer_in_memory;
  } else if constexpr (HasMutableMember<L>) {
    return LawFault::mutable_member;
  } else if constexpr (!HasNeeds<L>) {
    return LawFault::no_needs;
  } else if constexpr (!HasRole<L>) {
    return LawFault::no_role;
  } else if constexpr (LacksStart<L>) {
    return LawFault::no_start;
  } else if constexpr (LacksTorque<L>) {
    return LawFault::no_torque;
  } else if constexpr (LacksAdvance<L>) {
    return LawFault::no_advance;
  } else if constexpr (HasGoal<L> && LacksReceive<L>) {
    return LawFault::no_receive;
  } else if constexpr (!HasGoal<L> && NamesReceive<L> && !NamesForOthers<L>) {
    return LawFault::no_goal;
  } else {
    return fault_in_optional<L>();
  }
}

/// The fault of a law that declares robots other than those of `N` joints in the scalar `T`.
template <class L, std::size_t N, class T>
consteval LawFault fault_for_robot() {
  constexpr Needs needs = L::needs;
  constexpr LinkMask links = N < 64 ? (LinkMask(1) << (N % 64)) - 1 : ~LinkMask(0);
  if constexpr (LawTable<L>::joints != 0 && LawTable<L>::joints != N) {
    return LawFault::other_joints;
  } else if constexpr (!std::same_as<typename LawTable<L>::template scalar_in<T>, T>) {
    return LawFault::other_scalar;
  } else if constexpr (((needs.poses | needs.jacobians) & ~links) != 0) {
    return LawFault::missing_link;
  } else {
    return LawFault::none;
  }
}

template <class L, class K>
concept TakesParts = HasParts<L, K> || HasStatelessParts<L, K>;
template <class L, class K>
concept TakesTorque = HasTorque<L, K> || HasStatelessTorque<L, K>;

/// The fault of a function of a law that does not return `Wanted`, or may throw.
template <class Wanted, class Given>
consteval LawFault fault_in_result(bool may_throw, LawFault result, LawFault throws) {
  if (!std::same_as<std::remove_cv_t<Given>, Wanted>) return result;
  return may_throw ? throws : LawFault::none;
}
template <class L, class K>
consteval LawFault fault_in_torque(const L* law, const typename L::Memory* m, const K* known) {
  using Torque = JointTorque<K::joints, typename K::scalar>;
  using Parts = TorqueParts<K::joints, typename K::scalar>;
  constexpr auto result = LawFault::torque_result, throws = LawFault::torque_throws;
  if constexpr (HasTorque<L, K>) {
    using Given = decltype(law->torque(*m, *known));
    return fault_in_result<Torque, Given>(!noexcept(law->torque(*m, *known)), result, throws);
  } else if constexpr (HasStatelessTorque<L, K>) {
    using Given = decltype(law->torque(*known));
    return fault_in_result<Torque, Given>(!noexcept(law->torque(*known)), result, throws);
  } else if constexpr (HasStatelessParts<L, K>) {
    using Given = decltype(law->parts(*known));
    return fault_in_result<Parts, Given>(!noexcept(law->parts(*known)), result, throws);
  } else {
    using Given = decltype(law->parts(*m, *known));
    return fault_in_result<Parts, Given>(!noexcept(law->parts(*m, *known)), result, throws);
  }
}

/// The input and the touch of any scene, as laws see them.
template <class T>
struct AnyTouchSeen {
  struct Found;
  static constexpr bool finds_contacts = false;
  Nanoseconds now;
  [[nodiscard]] const Found& contacts() const noexcept;
  [[nodiscard]] const Found& pressed() const noexcept;
  [[nodiscard]] const Found& coverage() const noexcept;
  template <std::size_t>
  [[nodiscard]] T max_proximity() const noexcept;
};
/// The fault of a law that does not take its goals.
template <class L, class K>
consteval LawFault fault_in_goals() {
  using Goal = typename L::Goal;
  if constexpr (!TakesGoal<L, K>) {
    return LawFault::receive_arguments;
  } else if constexpr (!Receives<L, K, Goal>) {
    return LawFault::receive_result;
  } else if constexpr (NamesFollow<L> && !Follows<L, K, Goal> && !NamesForOthers<L>) {
    return LawFault::follow_signature;
  } else {
    return NamesDistance<L> && !HasDistance<L, K, Goal> && !NamesForOthers<L> ? LawFault::distance_signature
                                                                              : LawFault::none;
  }
}

/// The fault of a law whose functions do not take the known state of a robot, or return other types.
/// @tparam Part  the law is part of a sum, which weights the parts of its torque.
template <class L, class K, bool Part>
consteval LawFault fault_in_functions(const L* law, const typename L::Memory* m, const K* known,
                                      const typename K::scalar* dt) {
  using Memory = typename L::Memory;
  if constexpr (!Starts<L, K>) {
    return LawFault::start_arguments;
  } else if constexpr (!std::same_as<decltype(law->start(*known)), Memory>) {
    return LawFault::start_result;
  } else if constexpr (!Advances<L, K>) {
    return LawFault::advance_arguments;
  } else if constexpr (L::role == LawRole::tracking && Part && !TakesShare<L, K>) {
    return LawFault::no_parts;
  } else if constexpr (!TakesTorque<L, K> && !TakesParts<L, K>) {
    return LawFault::torque_arguments;
  } else if constexpr (!TakesTorque<L, K> && !Part && !K::needs.gravity) {
    return LawFault::no_gravity;
  } else {
    if constexpr (HasGoal<L>) {
      constexpr LawFault found = fault_in_goals<L, K>();
      if (found != LawFault::none) return found;
    }
    if constexpr (NamesSettled<L> && !HasSettled<L, K>) return LawFault::settled_signature;
    if constexpr (NamesResumed<L> && !HasResumed<L, K> && !IsWrapper<L>) return LawFault::resumed_signature;
    if constexpr (NamesLawSee<L> &&
                  !SeesScene<L, typename LawTable<L>::Input, AnyTouchSeen<typename K::scalar>>)
      return LawFault::see_signature;
    if constexpr (NamesNow<L> && !HasNow<L, K> && !IsWrapper<L>) return LawFault::now_signature;
    if constexpr (!Part && NamesEvaluate<L> && !HasEvaluate<L, K, LawTable<L>::terms>)
      return LawFault::evaluate_signature;
    using Given = decltype(law->advance(*m, *known, *dt, Opposition::none));
    const auto fault =
        fault_in_result<Memory, Given>(!noexcept(law->advance(*m, *known, *dt, Opposition::none)),
                                       LawFault::advance_result, LawFault::advance_throws);
    return fault != LawFault::none ? fault : fault_in_torque<L, K>(law, m, known);
  }
}

/// The first fault in a list of findings.
template <class L>
constexpr Found<LawFault::none, L> first_found() {
  return {};
}
template <class L, class F, class... Rest>
constexpr auto first_found(F found, Rest... rest) {
  if constexpr (F::fault != LawFault::none) {
    return found;
  } else {
    return first_found<L>(rest...);
  }
}

/// The fault of a law; the laws of which it is made are checked first.
template <class L>
constexpr auto find_in_members();
template <class... L>
constexpr auto find_in_members_of(std::type_identity<std::tuple<L...>>) {
  return first_found<void>(find_in_members<L>()...);
}
template <class L>
constexpr auto find_in_members() {
  constexpr Found<fault_in_members<L>(), L> own;
  if constexpr (own.fault == LawFault::none && IsMadeOfLaws<L>) {
    return first_found<L>(find_in_members_of(std::type_identity<typename L::Laws>()));
  } else {
    return own;
  }
}
/// The fault of a law for robots of `N` joints in the scalar `T`; the laws of which it is made come first.
template <class L, std::size_t N, class T>
constexpr auto find_for_robot();
template <std::size_t N, class T, class... L>
constexpr auto find_for_robot_in(std::type_identity<std::tuple<L...>>) {
  return first_found<void>(find_for_robot<L, N, T>()...);
}
template <class L, std::size_t N, class T>
constexpr auto find_for_robot() {
  if constexpr (IsMadeOfLaws<L>) {
    return first_found<L>(find_for_robot_in<N, T>(std::type_identity<typename L::Laws>()),
                          Found<fault_for_robot<L, N, T>(), L>());
  } else {
    return Found<fault_for_robot<L, N, T>(), L>();
  }
}
/// The fault of a law's functions with the known state of a scene; the laws of which it is made come first.
template <class L, class K, bool Part>
constexpr auto find_in_functions();
template <class K, class... L>
constexpr auto find_in_functions_of(std::type_identity<std::tuple<L...>>) {
  return first_found<void>(find_in_functions<L, K, true>()...);
}
template <class L, class K, bool Part>
constexpr auto find_in_own_functions() {
  return Found<fault_in_functions<L, K, Part>(nullptr, nullptr, nullptr, nullptr), L>();
}
template <class L, class K, bool Part>
constexpr auto find_in_functions() {
  if constexpr (IsMadeOfLaws<L>) {
    constexpr auto found = find_in_functions_of<K>(std::type_identity<typename L::Laws>());
    if constexpr (found.fault != LawFault::none) {
      return found;
    } else {
      return find_in_own_functions<L, K, Part>();
    }
  } else {
    return find_in_own_functions<L, K, Part>();
  }
}

/// The fault that keeps a law out of a sum. Memory and members of the other kinds are refused by the scene:
/// there a compiler names the place with one line of context less.
template <class L>
consteval LawFault fault_in_sum() {
  using enum LawFault;
  constexpr LawFault f = fault_in_members<L>();
  return f == heavy_memory || f == pointer_in_memory || f == mutable_member ? none : f;
}
/// `L` if it can stand in a sum, else a law that does nothing.
template <class L>
using law_in_sum = std::conditional_t<fault_in_sum<L>() == LawFault::none, L, WrongLaw<L>>;
/// `L` if it has no fault, else a law that does nothing.
template <class L>
using complete_law = std::conditional_t<fault_in_members<L>() == LawFault::none, L, WrongLaw<L>>;
}  // namespace detail
SKINCTL_END_NAMESPACE
