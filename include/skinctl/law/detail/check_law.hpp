// Finds the fault of a law that violates the protocol.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/law/detail/law_fault.hpp"
#include "skinctl/law/law.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

// Detects a member by its name, whatever its arguments: in a class that inherits the name twice it is
// ambiguous.
struct NamesOfALaw {
  int start, torque, parts, advance, receive;
};
template <class L>
struct NamedTwice : L, NamesOfALaw {};
template <class L>
concept CanBeAsked = std::is_class_v<L> && !std::is_final_v<L>;
template <class L>
concept LacksStart = CanBeAsked<L> && requires { &NamedTwice<L>::start; };
template <class L>
concept LacksTorque = CanBeAsked<L> && requires { &NamedTwice<L>::torque; };
template <class L>
concept LacksParts = CanBeAsked<L> && requires { &NamedTwice<L>::parts; };
template <class L>
concept LacksAdvance = CanBeAsked<L> && requires { &NamedTwice<L>::advance; };
template <class L>
concept LacksReceive = CanBeAsked<L> && requires { &NamedTwice<L>::receive; };

template <class L>
concept HasMemory = requires { typename L::Memory; };
template <class L>
concept HasGoal = requires { typename L::Goal; };
template <class L>
concept HasNeeds = requires {
  { L::needs } -> std::convertible_to<Needs>;
};
template <class L>
concept IsMadeOfLaws = requires { typename L::Laws; };

/// The first declared number of joints of several laws.
template <class... L>
constexpr std::size_t joints_of_laws() noexcept {
  std::size_t found = 0;
  ((found = found > 0 ? found : joints_of_law<L>()), ...);
  return found;
}
/// Whether two laws declare different numbers of joints.
template <class A, class B>
inline constexpr bool are_for_two_robots =
    joints_of_law<A>() != 0 && joints_of_law<B>() != 0 && joints_of_law<A>() != joints_of_law<B>();
template <class L, class T>
struct ScalarOfLaw {
  using type = T;
};
template <class L, class T>
  requires requires { typename L::scalar; }
struct ScalarOfLaw<L, T> {
  using type = typename L::scalar;
};

/// The faults of a law that do not depend on a robot.
template <class L>
consteval LawFault fault_in_members() {
  if constexpr (!HasMemory<L>) {
    return LawFault::no_memory;
  } else if constexpr (!std::is_trivially_copyable_v<typename L::Memory>) {
    return LawFault::heavy_memory;
  } else if constexpr (!HasNeeds<L>) {
    return LawFault::no_needs;
  } else if constexpr (!HasRole<L>) {
    return LawFault::no_role;
  } else if constexpr (LacksStart<L>) {
    return LawFault::no_start;
  } else if constexpr (LacksTorque<L> && LacksParts<L>) {
    return LawFault::no_torque;
  } else if constexpr (LacksAdvance<L>) {
    return LawFault::no_advance;
  } else if constexpr (HasGoal<L> && LacksReceive<L>) {
    return LawFault::no_receive;
  } else if constexpr (!HasGoal<L> && !LacksReceive<L> && !IsMadeOfLaws<L>) {
    return LawFault::no_goal;
  } else {
    return LawFault::none;
  }
}

/// Whether a law declares robots other than those of `N` joints in the scalar `T`.
template <class L, std::size_t N, class T>
consteval LawFault fault_for_robot() {
  constexpr Needs needs = L::needs;
  constexpr LinkMask links = N < 64 ? (LinkMask(1) << (N % 64)) - 1 : ~LinkMask(0);
  if constexpr (joints_of_law<L>() != 0 && joints_of_law<L>() != N) {
    return LawFault::other_joints;
  } else if constexpr (!std::same_as<typename ScalarOfLaw<L, T>::type, T>) {
    return LawFault::other_scalar;
  } else if constexpr (((needs.poses | needs.jacobians | needs.jacobian_rates) & ~links) != 0) {
    return LawFault::missing_link;
  } else {
    return LawFault::none;
  }
}

template <class L, class K>
concept Starts = requires(const L& law, const K& known) { law.start(known); };
template <class L, class K>
concept Advances = requires(const L& law, const typename L::Memory& m, const K& known,
                            const typename K::scalar& dt) { law.advance(m, known, dt, Opposition::none); };
template <class L, class K>
concept Receives = requires(const L& law, const typename L::Memory& m, const K& known,
                            const typename L::Goal& goal) { law.receive(m, known, goal); };
template <class L, class K>
concept TakesParts = has_parts<L, K> || has_stateless_parts<L, K>;
template <class L, class K>
concept TakesTorque = has_torque<L, K> || has_stateless_torque<L, K>;

/// Whether a function of a law returns `Wanted`, and does not throw.
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
  if constexpr (has_torque<L, K>) {
    using Given = decltype(law->torque(*m, *known));
    return fault_in_result<Torque, Given>(!noexcept(law->torque(*m, *known)), result, throws);
  } else if constexpr (has_stateless_torque<L, K>) {
    using Given = decltype(law->torque(*known));
    return fault_in_result<Torque, Given>(!noexcept(law->torque(*known)), result, throws);
  } else if constexpr (has_stateless_parts<L, K>) {
    using Given = decltype(law->parts(*known));
    return fault_in_result<Parts, Given>(!noexcept(law->parts(*known)), result, throws);
  } else {
    using Given = decltype(law->parts(*m, *known));
    return fault_in_result<Parts, Given>(!noexcept(law->parts(*m, *known)), result, throws);
  }
}

/// Whether a law's functions take the known state of a robot and return the required types.
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
  } else if constexpr (L::role == LawRole::tracking && Part && !TakesParts<L, K> &&
                       !has_weighted_torque<L, K>) {
    return LawFault::no_parts;
  } else if constexpr (!TakesTorque<L, K> && !TakesParts<L, K>) {
    return LawFault::torque_arguments;
  } else if constexpr (!TakesTorque<L, K> && !Part && !K::needs.gravity) {
    return LawFault::no_gravity;
  } else {
    if constexpr (HasGoal<L>) {
      if constexpr (!Receives<L, K>) {
        return LawFault::receive_arguments;
      } else if constexpr (!GoalLaw<L, K> && Law<L, K>) {
        return LawFault::receive_result;
      }
    }
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
/// The same for the robots that it declares.
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
/// The same for its functions, with the known state of a scene.
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

/// `L` if it has no fault, else a law that does nothing.
template <class L>
using complete_law = std::conditional_t<fault_in_members<L>() == LawFault::none, L, WrongLaw<L>>;
}  // namespace detail
SKINCTL_END_NAMESPACE
