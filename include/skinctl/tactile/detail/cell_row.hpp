// SPDX-License-Identifier: BSD-3-Clause
// What an event looks up of a cell and of its patch: unit wrenches in whole steps, gates, gains.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <utility>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/event_gate.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Numbers of a cell, one for each channel that pushes.
template <class Kind, class Number>
using PerChannel = std::array<Number, KindTable<Kind>::pushing>;

/// The counts of a cell as numbers, and back.
template <class Kind>
[[nodiscard]] SKINCTL_INLINE PerChannel<Kind, std::uint16_t> raw_of(const CountsOf<Kind>& counts) noexcept {
  return std::bit_cast<PerChannel<Kind, std::uint16_t>>(counts);
}
template <class Kind>
[[nodiscard]] SKINCTL_INLINE CountsOf<Kind> counts_of(const PerChannel<Kind, std::uint16_t>& raw) noexcept {
  return std::bit_cast<CountsOf<Kind>>(raw);
}

/// Calls `f(c)` for each channel of a kind that pushes, `c` an integral constant.
template <class Kind, class F>
SKINCTL_INLINE constexpr void each_channel(const F& f) noexcept {
  [&]<std::size_t... C>(std::index_sequence<C...>) SKINCTL_INLINE_LAMBDA {
    (f(std::integral_constant<std::size_t, C>{}), ...);
  }(std::make_index_sequence<KindTable<Kind>::pushing>{});
}

/// A whole number as a scalar. `float` holds 24 bits, so that a step of a unit wrench is exact.
template <Real T, std::signed_integral N>
[[nodiscard]] SKINCTL_INLINE T real_of(N n) noexcept {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(n);
  } else {
    return static_cast<T>(static_cast<double>(n));
  }
}

/// A unit wrench: forces in steps of 2^-24, moments in steps of 2^-24 times the reach of its patch.
using UnitWrench = std::array<std::int32_t, 6>;

/// Gate and gain of one channel of a cell, in counts: a magnitude above `opens` passes, while the gate is
/// open one above `opens - less`; `subtract`, at most `opens - less + 1`, is taken off it. `share` is the
/// cell's share of its patch's gain, in steps of 2^-15.
struct ChannelTuning {
  std::uint16_t opens = 0, less = 0, subtract = 0;
  std::uint16_t share = whole;
  static constexpr int whole_bits = 15;
  static constexpr std::uint16_t whole = 1u << whole_bits;

  void set(const EventGate<std::int32_t>& gate) noexcept {
    const auto cut = [](std::int32_t x) {
      return static_cast<std::uint16_t>(x < 0 ? 0 : x < 0xFFFF ? x : 0xFFFF);
    };
    opens = cut(gate.opens_at() - 1);
    less = static_cast<std::uint16_t>(opens - cut(gate.closes_below() - 1));
    subtract = cut(gate.subtract());
  }
  friend bool operator==(const ChannelTuning&, const ChannelTuning&) noexcept = default;
};

/// All that an event looks up of a cell.
template <class Kind>
struct CellRow {
  using Table = KindTable<Kind>;
  using Counts = PerChannel<Kind, std::uint16_t>;
  using Weighed = PerChannel<Kind, std::int32_t>;
  std::array<UnitWrench, Table::lines> unit{};
  std::uint16_t patch = 0, slot = 0;  ///< index of the cell's patch; of its link in the link wrenches
  PerChannel<Kind, ChannelTuning> tuning{};

  /// The counts of `raw` that pass the cell's gates; `old` passed last.
  [[nodiscard]] SKINCTL_INLINE Counts gated(const Counts& raw, const Counts& old) const noexcept {
    Counts out;
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      const ChannelTuning& gate = tuning[c];
      const std::int32_t x = number_of<Kind, c>(raw[c]), size = x < 0 ? -x : x;
      const std::int32_t above = gate.opens - (old[c] != 0 ? gate.less : 0);
      const std::int32_t passed = size > above ? size - gate.subtract : 0;
      out[c] = static_cast<std::uint16_t>(x < 0 ? -passed : passed);
    });
    return out;
  }
  /// Counts times the cell's shares of its patch's gains.
  [[nodiscard]] SKINCTL_INLINE Weighed weigh(const Counts& counts) const noexcept {
    Weighed out;
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      constexpr std::int32_t half = ChannelTuning::whole / 2;
      const std::int32_t n = number_of<Kind, c>(counts[c]), share = tuning[c].share;
      out[c] = n < 0 ? -((-n * share + half) >> ChannelTuning::whole_bits)
                     : (n * share + half) >> ChannelTuning::whole_bits;
    });
    return out;
  }
  /// The counts, with shear scaled down toward 0 to its friction cone; `newton` are gains [N] per count.
  [[nodiscard]] Counts within_cones(Counts counts, const PerChannel<Kind, double>& newton) const noexcept {
    const Weighed weighed = weigh(counts);
    double pressure = 0, square = 0;
    each_channel<Kind>([&](auto c) {
      const double push = newton[c] * weighed[c];
      if constexpr (Table::is_pressure(c)) pressure += push;
      if constexpr (Table::has_cone(c)) {
        constexpr double per_friction = 1 / Kind::channels[c].cone.friction;
        square += (per_friction * push) * (per_friction * push);
      }
    });
    if (square <= pressure * pressure) return counts;
    const double share = pressure / std::sqrt(square);  // the square is above 0
    each_channel<Kind>([&](auto c) {
      if constexpr (Table::has_cone(c))
        counts[c] =
            static_cast<std::uint16_t>(static_cast<std::int32_t>(share * number_of<Kind, c>(counts[c])));
    });
    return counts;
  }
};

/// The data of a patch that its cells share.
template <class Kind, Real T>
struct PatchRow {
  PerChannel<Kind, T> gain{};               ///< gain of each channel [N] per count
  PerChannel<Kind, double> newton{};        ///< gain for the cones [N] per count
  T moment_step{};                          ///< step of the moments of unit wrenches times 2^24 [m]
  std::uint32_t first = 0, count = 0;       ///< first cell, number of cells
  std::uint32_t link = 0, slot = 0;         ///< link, its index in the link wrenches
  PerChannel<Kind, std::int32_t> hidden{};  ///< largest opening threshold [counts]

  /// The counts of `raw` that pass a cell's gates, limited to the friction cones; `old` passed last.
  [[nodiscard]] SKINCTL_INLINE PerChannel<Kind, std::uint16_t> pass(
      const CellRow<Kind>& cell, const PerChannel<Kind, std::uint16_t>& raw,
      const PerChannel<Kind, std::uint16_t>& old) const noexcept {
    const PerChannel<Kind, std::uint16_t> out = cell.gated(raw, old);
    if constexpr (KindTable<Kind>::cones > 0) {
      return cell.within_cones(out, newton);
    } else {
      return out;
    }
  }
  /// Adds `factor` times a unit wrench to a wrench.
  SKINCTL_INLINE void add_unit(const UnitWrench& unit, const T& factor, T* wrench) const noexcept {
    const T force = factor * T(0x1p-24), moment = factor * moment_step;
    for (std::size_t r = 0; r < 3; ++r) wrench[r] = wrench[r] + force * real_of<T>(unit[r]);
    for (std::size_t r = 3; r < 6; ++r) wrench[r] = wrench[r] + moment * real_of<T>(unit[r]);
  }
  /// The pressure of weighed counts [N].
  [[nodiscard]] SKINCTL_INLINE T pressure(const PerChannel<Kind, std::int32_t>& weighed) const noexcept {
    T sum(0);
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      if constexpr (KindTable<Kind>::is_pressure(c)) sum = sum + gain[c] * real_of<T>(weighed[c]);
    });
    return sum;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
