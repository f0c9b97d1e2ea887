// What a law lacks, in one line, where a sum or a scene is built. What is wrong is replaced by a law that does
// nothing, so that nothing else is said about it.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/core/law.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

// A member is found by its name, whatever its arguments: in a class that inherits the name twice it is
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
  { L::role } -> std::convertible_to<Role>;
};
template <class L>
concept IsMadeOfLaws = requires { typename L::Laws; };

/// The joints of the robot that a law says it is for; 0: it does not say.
template <class L>
constexpr std::size_t joints_of_law() noexcept {
  if constexpr (requires { L::joints; }) {
    return L::joints;
  } else {
    return 0;
  }
}
/// Of several laws, what the first says that does.
template <class... L>
constexpr std::size_t joints_of_laws() noexcept {
  std::size_t found = 0;
  ((found = found > 0 ? found : joints_of_law<L>()), ...);
  return found;
}
/// Whether no two of them say different joints.
template <class... L>
constexpr bool are_for_one_robot() noexcept {
  return ((joints_of_law<L>() == 0 || joints_of_law<L>() == joints_of_laws<L...>()) && ...);
}
template <class L, class T>
struct ScalarOfLaw {
  using type = T;
};
template <class L, class T>
  requires requires { typename L::scalar; }
struct ScalarOfLaw<L, T> {
  using type = typename L::scalar;
};

/// Whether a law has what every law has, as far as that does not depend on a robot. Says what it lacks.
template <class L>
consteval bool is_complete_law() {
  if constexpr (!HasMemory<L>) {
    static_assert(HasMemory<L>,
                  "this law lacks its Memory: `struct Memory {...};`, or derive from StatelessLaw");
    return false;
  } else if constexpr (!std::is_trivially_copyable_v<typename L::Memory>) {
    static_assert(std::is_trivially_copyable_v<typename L::Memory>,
                  "the Memory of this law is not trivially copyable: a cycle copies, records and replays it");
    return false;
  } else if constexpr (!HasNeeds<L>) {
    static_assert(HasNeeds<L>, "this law lacks its needs: `static constexpr Needs needs = {...};`");
    return false;
  } else if constexpr (!HasRole<L>) {
    static_assert(HasRole<L>, "this law lacks its role: `static constexpr Role role = Role::reactive;`");
    return false;
  } else if constexpr (LacksStart<L>) {
    static_assert(!LacksStart<L>, "this law lacks start(known), which returns a Memory");
    return false;
  } else if constexpr (LacksTorque<L> && LacksParts<L>) {
    static_assert(!LacksTorque<L>, "this law lacks torque(memory, known), which returns a JointTorque");
    return false;
  } else if constexpr (LacksAdvance<L>) {
    static_assert(!LacksAdvance<L>, "this law lacks advance(memory, known, dt, opposition)");
    return false;
  } else if constexpr (HasGoal<L> && LacksReceive<L>) {
    static_assert(!LacksReceive<L>, "this law has a Goal, but lacks receive(memory, known, goal)");
    return false;
  } else if constexpr (!HasGoal<L> && !LacksReceive<L> && !IsMadeOfLaws<L>) {
    static_assert(HasGoal<L>, "this law receives goals, but does not name their type: `using Goal = ...;`");
    return false;
  } else {
    return true;
  }
}

template <class L, std::size_t N, class T>
consteval bool fits_robot();
template <class L, class K, bool Part>
consteval bool all_run_with();

/// The same for each law of a tuple.
template <class Laws>
struct EachLaw;
template <class... L>
struct EachLaw<std::tuple<L...>> {
  template <std::size_t N, class T>
  static consteval bool fits_robot() {
    return (detail::fits_robot<L, N, T>() && ...);
  }
  template <class K>
  static consteval bool run_with() {
    return (detail::all_run_with<L, K, true>() && ...);
  }
};

/// Whether a law is for a robot of `N` joints in the scalar `T`, as far as it says so.
template <class L, std::size_t N, class T>
consteval bool fits_robot() {
  if constexpr (!is_complete_law<L>()) {
    return false;
  } else if constexpr (IsMadeOfLaws<L>) {
    return EachLaw<typename L::Laws>::template fits_robot<N, T>();
  } else if constexpr (joints_of_law<L>() != 0 && joints_of_law<L>() != N) {
    static_assert(joints_of_law<L>() == N, "this law is for a robot with another number of joints");
    return false;
  } else if constexpr (!std::same_as<typename ScalarOfLaw<L, T>::type, T>) {
    static_assert(std::same_as<typename ScalarOfLaw<L, T>::type, T>,
                  "this law is for a robot in another scalar");
    return false;
  } else {
    constexpr Needs needs = L::needs;
    constexpr LinkMask links = N < 64 ? (LinkMask(1) << (N % 64)) - 1 : ~LinkMask(0);
    constexpr LinkMask missing = (needs.poses | needs.jacobians | needs.jacobian_rates) & ~links;
    static_assert(missing == 0, "this law asks for a link that the robot does not have: links count from 0");
    return missing == 0;
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
template <class X>
struct Returned {
  using type = std::remove_cvref_t<X>;
  bool may_throw;
};
/// What a law's function returns, and whether it may throw.
template <class L, class K>
constexpr auto torque_returned(const L* law, const typename L::Memory* m, const K* known) {
  if constexpr (has_torque<L, K>) {
    return Returned<decltype(law->torque(*m, *known))>{!noexcept(law->torque(*m, *known))};
  } else {
    return Returned<decltype(law->torque(*known))>{!noexcept(law->torque(*known))};
  }
}
template <class L, class K>
constexpr auto parts_returned(const L* law, const typename L::Memory* m, const K* known) {
  if constexpr (has_stateless_parts<L, K>) {
    return Returned<decltype(law->parts(*known))>{!noexcept(law->parts(*known))};
  } else {
    return Returned<decltype(law->parts(*m, *known))>{!noexcept(law->parts(*m, *known))};
  }
}
template <class L, class K>
constexpr auto advance_returned(const L* law, const typename L::Memory* m, const K* known,
                                const typename K::scalar* dt) {
  using Given = decltype(law->advance(*m, *known, *dt, Opposition::none));
  return Returned<Given>{!noexcept(law->advance(*m, *known, *dt, Opposition::none))};
}

/// Whether the functions of a law return what they should, and promise not to throw.
template <class L, class K>
consteval bool returns_right() {
  using Memory = typename L::Memory;
  using Torque = JointTorque<K::joints, typename K::scalar>;
  constexpr auto advance = advance_returned<L, K>(nullptr, nullptr, nullptr, nullptr);
  if constexpr (!std::same_as<typename decltype(advance)::type, Memory>) {
    static_assert(std::same_as<typename decltype(advance)::type, Memory>,
                  "advance(memory, known, dt, opposition) of this law does not return its Memory");
    return false;
  } else if constexpr (advance.may_throw) {
    static_assert(!advance.may_throw, "advance(...) of this law may throw in the loop: mark it noexcept");
    return false;
  } else if constexpr (TakesTorque<L, K>) {
    constexpr auto torque = torque_returned<L, K>(nullptr, nullptr, nullptr);
    constexpr bool right = std::same_as<typename decltype(torque)::type, Torque>;
    static_assert(std::same_as<typename decltype(torque)::type, Torque>,
                  "torque(...) of this law does not return a JointTorque of the robot's joints and scalar");
    static_assert(!right || !torque.may_throw,
                  "torque(...) of this law may throw in the loop: mark it noexcept");
    return right && !torque.may_throw;
  } else {
    constexpr auto parts = parts_returned<L, K>(nullptr, nullptr, nullptr);
    using Parts = TorqueParts<K::joints, typename K::scalar>;
    constexpr bool right = std::same_as<typename decltype(parts)::type, Parts>;
    static_assert(std::same_as<typename decltype(parts)::type, Parts>,
                  "parts(...) of this law does not return a TorqueParts of the robot's joints and scalar");
    static_assert(!right || !parts.may_throw,
                  "parts(...) of this law may throw in the loop: mark it noexcept");
    return right && !parts.may_throw;
  }
}

/// Whether a law's functions take what is known of a robot, and return what they should.
/// @tparam Part  it is part of a sum, which weighs the parts of its torque.
template <class L, class K, bool Part>
consteval bool runs_with() {
  if constexpr (!Starts<L, K>) {
    static_assert(Starts<L, K>, "start(known) of this law is not const, or does not take what is known");
    return false;
  } else if constexpr (!std::same_as<decltype(std::declval<const L&>().start(std::declval<const K&>())),
                                     typename L::Memory>) {
    using Given = decltype(std::declval<const L&>().start(std::declval<const K&>()));
    static_assert(std::same_as<Given, typename L::Memory>,
                  "start(known) of this law does not return its Memory");
    return false;
  } else if constexpr (!Advances<L, K>) {
    static_assert(Advances<L, K>,
                  "advance(memory, known, dt, opposition) of this law is not const, or does not take these");
    return false;
  } else if constexpr (L::role == Role::tracking && Part && !TakesParts<L, K> && !has_weighted_torque<L, K>) {
    static_assert(TakesParts<L, K>,
                  "a tracking law in a sum gives its parts(memory, known), a TorqueParts: see TrackingLaw");
    return false;
  } else if constexpr (!TakesTorque<L, K> && !TakesParts<L, K>) {
    static_assert(
        TakesTorque<L, K>,
        "torque(memory, known) of this law is not const, or does not take its Memory and what is known");
    return false;
  } else if constexpr (!TakesTorque<L, K> && !Part && !K::needs.gravity) {
    static_assert(K::needs.gravity,
                  "a tracking law without a gravity law beside it holds G(q): set needs.gravity");
    return false;
  } else if constexpr (HasGoal<L>) {
    static_assert(Receives<L, K>, "receive(memory, known, goal) of this law does not take its Goal");
    if constexpr (Receives<L, K>) {
      using Given = decltype(std::declval<const L&>().receive(std::declval<const typename L::Memory&>(),
                                                              std::declval<const K&>(),
                                                              std::declval<const typename L::Goal&>()));
      static_assert(std::same_as<Given, Received<typename L::Memory>>,
                    "receive(memory, known, goal) of this law does not return a Received<Memory>");
      return std::same_as<Given, Received<typename L::Memory>> && returns_right<L, K>();
    } else {
      return false;
    }
  } else {
    return returns_right<L, K>();
  }
}

/// The same, each law of a sum by itself first.
template <class L, class K, bool Part>
consteval bool all_run_with() {
  if constexpr (IsMadeOfLaws<L>) {
    if constexpr (!EachLaw<typename L::Laws>::template run_with<K>()) {
      return false;
    } else {
      return runs_with<L, K, Part>();
    }
  } else {
    return runs_with<L, K, Part>();
  }
}

/// The Goal of a law that has one.
template <class L>
struct GoalOfLaw {};
template <class L>
  requires requires { typename L::Goal; }
struct GoalOfLaw<L> {
  using Goal = typename L::Goal;
};
/// Stands for a law that is wrong, after the error about it: does nothing, and takes whatever it is made of.
template <class L>
struct WrongLaw : Composable, GoalOfLaw<L> {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr Role role = [] {
    if constexpr (HasRole<L>) {
      return Role(L::role);
    } else {
      return Role::reactive;
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
      const Memory&, const K&, const Share<typename K::scalar>& = {}) const noexcept {
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
struct CheckedLaw {
  using type = std::conditional_t<is_complete_law<L>(), L, WrongLaw<L>>;
};
template <class L>
struct CheckedLaw<WrongLaw<L>> {
  using type = WrongLaw<L>;
};
/// `L`, if it has what every law has; else an error that says what it lacks, and a law that does nothing.
template <class L>
using checked_law = typename CheckedLaw<L>::type;

}  // namespace detail
SKINCTL_END_NAMESPACE
