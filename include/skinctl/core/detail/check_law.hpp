// Errors for laws that violate the protocol: one line, at the point where a sum or a scene is built. A faulty
// law is then replaced by one that does nothing, so that no further errors follow.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/core/law.hpp"

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
concept HasRole = requires {
  { L::role } -> std::convertible_to<LawRole>;
};
template <class L>
concept IsMadeOfLaws = requires { typename L::Laws; };

/// Number of the robot's joints as the law declares it; 0 if it declares none.
template <class L>
constexpr std::size_t joints_of_law() noexcept {
  if constexpr (requires { L::joints; }) {
    return L::joints;
  } else {
    return 0;
  }
}
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

/// The possible faults of a law.
enum class LawFault {
  none,
  no_memory,
  heavy_memory,
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
  receive_result
};
/// A law and its fault.
template <LawFault F, class L>
struct Found {
  static constexpr LawFault fault = F;
  using Law = L;
};
/// The `Goal` of a law that has one.
template <class L>
struct GoalOfLaw {};
template <class L>
  requires requires { typename L::Goal; }
struct GoalOfLaw<L> {
  using Goal = typename L::Goal;
};
/// Replaces a faulty law after its error: does nothing, and accepts any constructor arguments.
template <class L>
struct HeldByLaw {};
template <class L>
  requires requires { L::gravity_laws; }
struct HeldByLaw<L> {
  static constexpr std::size_t gravity_laws = L::gravity_laws;
  static constexpr bool compensates_friction = requires { requires L::compensates_friction; };
};
template <class L>
struct WrongLaw : Composable, GoalOfLaw<L>, HeldByLaw<L> {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = [] {
    if constexpr (HasRole<L>) {
      return LawRole(L::role);
    } else {
      return LawRole::reactive;
    }
  }();
  static constexpr std::size_t joints = joints_of_law<L>();
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

/// Raises the error for a fault. Used in a `static_assert` of the function that a user calls, so that the
/// error appears once, with few lines of context. (Reading any member of a class with an error is one more
/// error in Clang.)
template <LawFault F, class L>
struct Say {
  using enum LawFault;
  static_assert(F != no_memory,
                "this law lacks its Memory: `struct Memory {...};`, or derive from StatelessLaw");
  static_assert(F != heavy_memory,
                "the Memory of this law is not trivially copyable: a cycle copies and records it");
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
