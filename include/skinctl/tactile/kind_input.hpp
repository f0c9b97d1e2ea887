// SPDX-License-Identifier: BSD-3-Clause
// Samples of cells of other kinds than the hexagon: what their skins add to the input of a cycle.
#pragma once

#include <tuple>
#include <type_traits>
#include <vector>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/sample_span.hpp"
#include "skinctl/tactile/detail/touch_rows.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The samples that a skin of another kind than `Hexagon` adds to the input of a cycle:
/// `input.sensed.taxels = batch`, in a scene with two such kinds `taxels_of<Uskin>(input.sensed) = batch`.
/// The samples of a cell are in the order of their stamps.
template <SensorKind Kind>
struct KindInput {
  SampleSpan<SensorSample<Kind>> taxels;  ///< samples that arrived since the last cycle
};
template <SensorKind Kind>
[[nodiscard]] auto& taxels_of(KindInput<Kind>& sensed) noexcept {
  return sensed.taxels;
}

/// Storage for the samples of an input's other kinds: a vector for each kind.
template <class Sensed>
struct TaxelStore {
  static constexpr std::uint32_t fingerprint = 0;  ///< fingerprint of the other kinds; 0: none
  template <class S, class F>
  void each(S&, F&&) {}
  template <class S, class F>
  static void look(const S&, F&&) noexcept {}
};
template <SensorKind Kind>
struct TaxelStore<KindInput<Kind>> {
  static constexpr std::uint32_t fingerprint = KindTable<Kind>::fingerprint();
  std::vector<SensorSample<Kind>> kept;

  /// Calls `f(samples, kept)` for each kind: its samples in the input, and the vector that stores them.
  template <class F>
  void each(KindInput<Kind>& sensed, F&& f) {
    f(sensed.taxels, kept);
  }
  /// Calls `f(samples)` for each kind, with its samples in the input.
  template <class F>
  static void look(const KindInput<Kind>& sensed, F&& f) noexcept {
    f(sensed.taxels);
  }
};
template <class A, class B>
struct TaxelStore<detail::BothSensed<A, B>> {
  static constexpr std::uint32_t fingerprint = TaxelStore<A>::fingerprint * 31u + TaxelStore<B>::fingerprint;
  TaxelStore<A> first;
  TaxelStore<B> second;

  template <class F>
  void each(detail::BothSensed<A, B>& sensed, F&& f) {
    first.each(static_cast<A&>(sensed), f), second.each(static_cast<B&>(sensed), f);
  }
  template <class F>
  static void look(const detail::BothSensed<A, B>& sensed, F&& f) noexcept {
    TaxelStore<A>::look(static_cast<const A&>(sensed), f),
        TaxelStore<B>::look(static_cast<const B&>(sensed), f);
  }
};

namespace detail {
/// The addition of a skin to the input of a cycle: nothing for hexagons, whose samples each input has;
/// `KindInput` for another kind.
template <class Kind>
struct SensesKind {
  using Sensed = KindInput<Kind>;
};
template <>
struct SensesKind<Hexagon> {};
}  // namespace detail

SKINCTL_END_NAMESPACE
