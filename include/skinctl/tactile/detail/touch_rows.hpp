// SPDX-License-Identifier: BSD-3-Clause
// Whether a touch has each member of the protocol: the rows of its table.
#pragma once

#include <type_traits>
#include <utility>

#include "skinctl/core/config.hpp"
#include "skinctl/model/topology.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/coverage.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The namespace of `skin + sensor`, apart so that the errors of other sums do not list it.
namespace sensor_sums {
/// A base of every sensor that adds to a skin: argument-dependent look-up finds the operator by it.
struct Summand {};
}  // namespace sensor_sums

namespace detail {

template <class S>
concept HasTouchTypes = requires {
  typename S::Memory;
  typename S::Wrenches;
};
template <class S>
concept HasSensed = requires { typename S::Sensed; };
template <class S>
concept HasTouch = requires(const S& s, const typename S::Memory& m) {
  { s.touch(m) } -> std::convertible_to<typename S::Touch>;
};
template <class S, class T>
concept HasPressed =
    requires(const S& s, const typename S::Memory& m, const T& touch) { s.pressed(m, touch); };
template <class S>
concept HasContacts = requires(const S& s, const typename S::Memory& m) {
  typename S::Found;
  s.contacts(m).begin();
};
template <class S>
concept HasCells = requires(const S& s, std::uint32_t id) {
  { s.index(id) } -> std::same_as<std::size_t>;
  { s.size() } -> std::same_as<std::size_t>;
};
template <class S>
concept HasKind = requires { typename S::kind; };
template <class S>
concept HasHexagon = requires(const S& s, std::uint32_t id) {
  { s.has_hexagon(id) } -> std::same_as<bool>;
};
/// Whether a touch takes the samples of a cycle's input: all cells but those of another kind.
template <class S>
struct TakesHexagons : std::bool_constant<HasCells<S>> {};
template <HasKind S>
struct TakesHexagons<S> : std::bool_constant<std::is_same_v<typename S::kind, Hexagon>> {};
template <HasHexagon S>
struct TakesHexagons<S> : std::bool_constant<S::takes_hexagons> {};
template <class S>
concept HasCoverage = requires(const S& s, const typename S::Memory& m) {
  { s.coverage(m) } -> std::same_as<Coverage>;
};
template <class S>
concept HasNoticed = requires(const S& s, const typename S::Memory& m) {
  { s.noticed(m, std::size_t()) } -> std::same_as<double>;
};
template <class S>
concept HasLinks = requires {
  { S::Wrenches::links } -> std::convertible_to<LinkMask>;
};
/// Whether the wrench on link `Ix` is known, if the touch is of that link at all.
template <class W, std::size_t Ix>
concept KnowsWrench = ((W::links >> Ix) & 1u) == 0 || requires(const W& w) { w.template wrench<Ix>(); };
/// Whether a touch holds the wrenches of links, as numbers side by side.
template <class W>
concept HoldsWrenches = requires(const W& w) { w.data[0][0]; };
template <class S>
concept NamesModel = requires { typename S::Wrenches::model_type; };
template <class S, std::size_t Ix>
concept HasNearest = requires(const S& s, const typename S::Memory& m) {
  { s.template max_proximity<Ix>(m) } -> std::same_as<typename S::Wrenches::scalar>;
};
template <class S, std::size_t Ix>
concept TellsMaxProximity = HasLinks<S> && ((S::Wrenches::links >> Ix) & 1u) != 0 && HasNearest<S, Ix>;

/// A function that `each_cell` and `each_point` can call.
struct TakesWrenches {
  template <class V>
  void operator()(std::size_t, const V&, const V&, double) const noexcept {}
};
template <class S>
concept HasEachCell = requires(const S& s, const TakesWrenches& f) { s.each_cell(f, std::size_t(6)); };
template <class S>
concept HasEachPoint = requires(const S& s, const TakesWrenches& f) { s.each_point(f); };
template <class S>
concept HasGainEverywhere = requires(const S& s) {
  { s.gain_everywhere() } -> std::same_as<double>;
};
template <class S>
concept HasUnderstands = requires(const S& s) {
  { s.understands(s) } -> std::same_as<bool>;
};
template <class S, class Found, class State, class Contact>
concept HasBeyond = requires(const S& s, const Found& found, const State& measured, const Contact& contact) {
  { s.beyond(found, measured.q, contact) } -> std::same_as<Found>;
};
template <class S, class M, class State>
concept HasFollowRobot = requires(const S& s, typename S::Memory& m, const M& model, const State& state) {
  s.follow_robot(m, model, state);
};
template <class S>
concept HasRecomputed = requires(const S& s, const typename S::Memory& m) { s.recomputed(m); };
template <class S, class Nothing>
struct SensedOf {
  using type = Nothing;
};
template <HasSensed S, class Nothing>
struct SensedOf<S, Nothing> {
  using type = typename S::Sensed;
};
template <class S>
struct ApartOf {
  using type = typename S::Wrenches;
};
template <HasTouch S>
struct ApartOf<S> {
  using type = typename S::Touch;
};
/// Type of the contacts of a touch that finds none.
struct NothingFound {};

/// The inputs of two sources, each with its own members.
template <class A, class B>
struct BothSensed : A, B {};
template <class A>
struct BothSensed<A, A> : A {};
template <class A, class B>
using SensedTogether =
    std::conditional_t<std::is_empty_v<B>, A, std::conditional_t<std::is_empty_v<A>, B, BothSensed<A, B>>>;

/// The part of an input that is a touch's own.
template <class Sensed, class Given>
[[nodiscard]] SKINCTL_INLINE decltype(auto) part_of(const Given& given) noexcept {
  if constexpr (std::is_empty_v<Sensed>) {
    return Sensed{};
  } else {
    return static_cast<const Sensed&>(given);
  }
}

/// The touch `S` with another input, if a wrapper adds to it.
template <class S, class Nothing, class... Adds>
struct WithSensed : S {
  explicit WithSensed(const S& s) : S(s) {}
};
template <class S, class Nothing, class Adds>
struct WithSensed<S, Nothing, Adds> : S {
  static_assert(std::is_empty_v<Adds> || !std::is_base_of_v<Adds, typename SensedOf<S, Nothing>::type>,
                "two parts of a touch add the same to the input");
  using Sensed = SensedTogether<typename SensedOf<S, Nothing>::type, Adds>;
  explicit WithSensed(const S& s) : S(s) {}
};

}  // namespace detail
SKINCTL_END_NAMESPACE
