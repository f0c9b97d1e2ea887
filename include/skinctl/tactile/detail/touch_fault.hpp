// SPDX-License-Identifier: BSD-3-Clause
// Finds the fault of a touch that violates the protocol: a member that is missing, or that has a wrong
// signature.
#pragma once

#include <bit>

#include "skinctl/core/detail/named_twice.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A type that was meant as a touch, even if members are missing.
template <class S>
concept MeantAsTouch = requires { typename S::Wrenches; };

struct NamesOfATouch {
  int touch, pressed, contacts, coverage, noticed, max_proximity, index, each_cell, each_point,
      gain_everywhere, understands;
};
SKINCTL_NAMES(NamesTouch, NamesOfATouch, touch);
SKINCTL_NAMES(NamesPressed, NamesOfATouch, pressed);
SKINCTL_NAMES(NamesContacts, NamesOfATouch, contacts);
SKINCTL_NAMES(NamesCoverage, NamesOfATouch, coverage);
SKINCTL_NAMES(NamesNoticed, NamesOfATouch, noticed);
SKINCTL_NAMES(NamesMaxProximity, NamesOfATouch, max_proximity);
SKINCTL_NAMES(NamesIndex, NamesOfATouch, index);
SKINCTL_NAMES(NamesEachCell, NamesOfATouch, each_cell);
SKINCTL_NAMES(NamesEachPoint, NamesOfATouch, each_point);
SKINCTL_NAMES(NamesGainEverywhere, NamesOfATouch, gain_everywhere);
SKINCTL_NAMES(NamesUnderstands, NamesOfATouch, understands);

template <class S>
concept HasStart = requires(const S& s, Nanoseconds now) {
  { s.start(now) } -> std::same_as<typename S::Memory>;
};
template <class S>
concept HasHeldWrenches = requires(const S& s, const typename S::Memory& m) {
  { s.wrenches(m) } -> std::same_as<typename S::Wrenches>;
};
template <class S>
concept ReceivesCells = requires(const S& s, typename S::Memory& m, std::span<const CellSample> samples,
                                 Nanoseconds t, std::size_t parts, typename S::Wrenches* means) {
  { s.receive(m, samples, t, t, parts, means) } -> std::same_as<Status>;
};
template <class S, class State>
concept ReceivesSensed =
    HasSensed<S> && requires(const S& s, typename S::Memory& m, std::span<const CellSample> samples,
                             const typename SensedOf<S, NoSensors>::type& sensed, const State& measured,
                             Nanoseconds t, std::size_t parts, typename S::Wrenches* means) {
      { s.receive(m, samples, sensed, measured, t, t, parts, means) } -> std::same_as<Status>;
    };
template <class S>
constexpr bool max_proximity_of_its_links() noexcept {
  if constexpr (HasLinks<S>) {
    constexpr LinkMask links = S::Wrenches::links;
    if constexpr (links != 0) return HasNearest<S, static_cast<std::size_t>(std::countr_zero(links))>;
  }
  return true;
}

/// A sum of touches, which has a member where one of its parts has it.
template <class S>
concept IsTouchSum = requires {
  typename S::FirstTouch;
  typename S::SecondTouch;
};

/// Faults of a touch.
enum class TouchFault {
  none,
  types,
  memory,
  start,
  wrenches,
  receive,
  receive_sensed,
  touch,
  pressed,
  contacts,
  coverage,
  noticed,
  max_proximity,
  index,
  each_cell,
  each_point,
  gain_everywhere,
  understands
};
/// The first fault of a touch, for a robot whose state is a `State`.
template <class S, class State>
consteval TouchFault fault_in_touch() {
  using enum TouchFault;
  if constexpr (!HasTouchTypes<S>) {
    return types;
  } else if constexpr (IsTouchSum<S>) {
    constexpr TouchFault first = fault_in_touch<typename S::FirstTouch, State>();
    return first != none ? first : fault_in_touch<typename S::SecondTouch, State>();
  } else {
    if (!std::is_trivially_copyable_v<typename S::Memory>) return memory;
    if (!HasStart<S>) return start;
    if (!HasHeldWrenches<S>) return wrenches;
    if (HasSensed<S> && !ReceivesSensed<S, State>) return receive_sensed;
    if (!HasSensed<S> && !ReceivesCells<S>) return receive;
    if (NamesTouch<S> && !HasTouch<S>) return touch;
    if (NamesPressed<S> && !HasPressed<S, typename ApartOf<S>::type>) return pressed;
    if (NamesContacts<S> && !HasContacts<S>) return contacts;
    if (NamesCoverage<S> && !HasCoverage<S>) return coverage;
    if (NamesNoticed<S> && !HasNoticed<S>) return noticed;
    if (NamesMaxProximity<S> && !max_proximity_of_its_links<S>()) return max_proximity;
    if (NamesIndex<S> && !HasCells<S>) return index;
    if (NamesEachCell<S> && !HasEachCell<S>) return each_cell;
    if (NamesEachPoint<S> && !HasEachPoint<S>) return each_point;
    if (NamesGainEverywhere<S> && !HasGainEverywhere<S>) return gain_everywhere;
    if (NamesUnderstands<S> && !HasUnderstands<S>) return understands;
    return none;
  }
}
/// States the fault of a touch as a compile error.
template <TouchFault F, class Touch>
struct SayTouch {
  using enum TouchFault;
  static_assert(F != types && F != wrenches,
                "a touch has Memory, Wrenches and wrenches(memory): is this one?");
  static_assert(F != memory, "the Memory of this touch cannot be copied trivially");
  static_assert(F != start, "touch: start(now) has to give its Memory");
  static_assert(F != receive, "touch: receive(memory, samples, from, to, parts, means) has to give a Status");
  static_assert(
      F != receive_sensed,
      "touch with Sensed: receive(memory, samples, sensed, measured, from, to, parts, means) has to "
      "give a Status");
  static_assert(F != touch, "touch: touch(memory) has to give its type Touch");
  static_assert(F != pressed, "touch: pressed(memory, touch) has to take its own touch");
  static_assert(F != contacts, "touch: contacts(memory) has to give a list of its type Found");
  static_assert(F != coverage, "touch: coverage(memory) has to give a Coverage");
  static_assert(F != noticed, "touch: noticed(memory, i) has to give a double, for each of its cells");
  static_assert(F != max_proximity,
                "touch: max_proximity<I>(memory) has to give a scalar on each of its links");
  static_assert(F != index, "touch: index(id) has to give a std::size_t, beside size()");
  static_assert(F != each_cell, "touch: each_cell(f, most) has to call f(link, force, moment, gain)");
  static_assert(F != each_point, "touch: each_point(f) has to call f(link, force, moment, gain)");
  static_assert(F != gain_everywhere, "touch: gain_everywhere() has to give a double");
  static_assert(F != understands, "touch: understands(other) has to give a bool");
};

}  // namespace detail
SKINCTL_END_NAMESPACE
