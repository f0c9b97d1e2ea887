// The constant data of a skin: its cells by id, unit wrenches in whole steps, gates, gains.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/event_gate.hpp"
#include "skinctl/tactile/detail/held_signal.hpp"
#include "skinctl/tactile/patch.hpp"

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
template <Real T>
[[nodiscard]] SKINCTL_INLINE T real_of(std::int32_t n) noexcept {
  if constexpr (std::is_same_v<T, float> || std::is_same_v<T, double>) {
    return static_cast<T>(n);
  } else {
    return static_cast<T>(static_cast<double>(n));
  }
}
template <Real T>
[[nodiscard]] SKINCTL_INLINE T real_of(std::int64_t n) noexcept {
  if constexpr (std::is_same_v<T, float>) {
    return static_cast<T>(n);
  } else {
    return static_cast<T>(static_cast<double>(n));
  }
}

/// A unit wrench: forces in steps of 2^-24, moments in steps of 2^-24 times the reach of its patch.
using UnitWrench = std::array<std::int32_t, 6>;

/// What one channel of a cell has of its own, in counts: a magnitude above `opens` passes, while it is open one above
/// `opens - less`, and `subtract`, which is no more than that and one, is taken off; `share` of its patch's gain.
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
  std::uint16_t patch = 0, slot = 0;  ///< index of its patch; of its link in the link wrenches
  PerChannel<Kind, ChannelTuning> tuning{};

  /// The counts that pass its gates; `old` passed last.
  [[nodiscard]] SKINCTL_INLINE Counts gated(const Counts& raw, const Counts& old) const noexcept {
    Counts out;
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      const ChannelTuning& gate = tuning[c];
      const std::int32_t x = number_of<Kind>(c, raw[c]), size = x < 0 ? -x : x;
      const std::int32_t above = gate.opens - (old[c] != 0 ? gate.less : 0);
      const std::int32_t passed = size > above ? size - gate.subtract : 0;
      out[c] = static_cast<std::uint16_t>(x < 0 ? -passed : passed);
    });
    return out;
  }
  /// Counts as shares of its patch's gains.
  [[nodiscard]] SKINCTL_INLINE Weighed weigh(const Counts& counts) const noexcept {
    Weighed out;
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      constexpr std::int32_t half = ChannelTuning::whole / 2;
      const std::int32_t n = number_of<Kind>(c, counts[c]), share = tuning[c].share;
      out[c] = n < 0 ? -((-n * share + half) >> ChannelTuning::whole_bits)
                     : (n * share + half) >> ChannelTuning::whole_bits;
    });
    return out;
  }
  /// What of its counts lies within their cones: the others are scaled down to them, toward 0.
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
            static_cast<std::uint16_t>(static_cast<std::int32_t>(share * number_of<Kind>(c, counts[c])));
    });
    return counts;
  }
};

/// A patch, as all its cells have it.
template <class Kind, Real T>
struct PatchRow {
  PerChannel<Kind, T> gain{};               ///< [N] per count
  PerChannel<Kind, double> newton{};        ///< the same, for cones
  T moment_step{};                          ///< of its cells' unit wrenches [m]
  std::uint32_t first = 0, count = 0;       ///< cells
  std::uint32_t link = 0, slot = 0;         ///< and its index in the link wrenches
  PerChannel<Kind, std::int32_t> hidden{};  ///< no count of what is seen below passes

  /// The counts of a cell that count: those that pass its gates, as far as their cones let them. `old` passed last.
  [[nodiscard]] SKINCTL_INLINE PerChannel<Kind, std::uint16_t> pass(
      const CellRow<Kind>& cell, const PerChannel<Kind, std::uint16_t>& raw,
      const PerChannel<Kind, std::uint16_t>& old) const noexcept {
    const PerChannel<Kind, std::uint16_t> out = cell.gated(raw, old);
    if constexpr (KindTable<Kind>::has_cones) {
      return cell.within_cones(out, newton);
    } else {
      return out;
    }
  }
  /// A unit wrench times `factor`, added to a wrench.
  SKINCTL_INLINE void add_unit(const UnitWrench& unit, const T& factor, T* wrench) const noexcept {
    const T force = factor * T(0x1p-24), moment = factor * moment_step;
    for (std::size_t r = 0; r < 3; ++r) wrench[r] = wrench[r] + force * real_of<T>(unit[r]);
    for (std::size_t r = 3; r < 6; ++r) wrench[r] = wrench[r] + moment * real_of<T>(unit[r]);
  }
  /// The pressure by weighed counts [N].
  [[nodiscard]] SKINCTL_INLINE T pressure(const PerChannel<Kind, std::int32_t>& weighed) const noexcept {
    T sum(0);
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      if constexpr (KindTable<Kind>::is_pressure(c)) sum = sum + gain[c] * real_of<T>(weighed[c]);
    });
    return sum;
  }
};

/// A cell that is to be added to a skin.
template <class Kind>
struct NewCell {
  AnyCell placed;
  PerChannel<Kind, EventGate<>> gates;
  PerChannel<Kind, double> gain;  ///< [N] per unit of each channel; 0 where it does not feel
};

/// All cells of a skin, in the order of their patches.
template <class Kind, Real T>
struct SkinTables {
  using Table = KindTable<Kind>;
  static constexpr std::uint32_t highest_id = (1u << 20) - 1;

  SampledTimes times;
  std::vector<PatchRow<Kind, T>> patches;
  std::vector<CellRow<Kind>> cells;
  std::vector<std::pair<Xyz<float>, Xyz<float>>> places;  ///< origin [m] and outward normal of each cell
  std::vector<std::uint32_t> numb;            ///< cells without gains: they are heard, and do not feel
  std::vector<std::uint32_t> by_id = {none};  ///< index of each id; the last one is of no cell
  static constexpr std::uint32_t none = ~std::uint32_t(0);

  /// Room for so many cells.
  SKINCTL_COLD void reserve(std::size_t count) {
    cells.reserve(count), places.reserve(count), by_id.reserve(count + 2);
  }
  /// Adds a patch on link `link`, whose gains are the greatest of its cells', or `gain`.
  SKINCTL_COLD void add(const std::vector<NewCell<Kind>>& patch, const PerChannel<Kind, double>& gain,
                        std::size_t link, std::size_t slot) {
    require(patches.size() < 0xFFFF, "Skin: patches", double(patches.size() + 1), "at most 65535");
    const int reach = reach_of(patch);
    PatchRow<Kind, T> row;
    row.moment_step = static_cast<T>(std::ldexp(1.0, reach - 24));
    row.first = static_cast<std::uint32_t>(cells.size()),
    row.count = static_cast<std::uint32_t>(patch.size());
    row.link = static_cast<std::uint32_t>(link), row.slot = static_cast<std::uint32_t>(slot);
    for (std::size_t c = 0; c < Table::pushing; ++c)
      row.newton[c] = gain[c] * Table::step(c), row.gain[c] = static_cast<T>(row.newton[c]);
    for (const NewCell<Kind>& cell : patch) {
      const std::uint32_t id = cell.placed.id;
      require(id <= highest_id, "Skin: cell id", double(id), "< 2^20");
      if (id + 1 >= by_id.size()) by_id.resize(id + 2, none);
      require(by_id[id] == none, "Skin: cell id", double(id), "ids that occur once");
      by_id[id] = static_cast<std::uint32_t>(cells.size());
      add_cell(cell, gain, reach, row);
    }
    patches.push_back(row);
  }

  /// Index of a cell by its id; `none` for an unknown one.
  [[nodiscard]] SKINCTL_INLINE std::uint32_t index(std::uint32_t id) const noexcept {
    const std::size_t last = by_id.size() - 1;
    return by_id[id < last ? id : last];
  }
  SKINCTL_INLINE const PatchRow<Kind, T>& patch_of(std::size_t i) const noexcept {
    return patches[cells[i].patch];
  }

  /// Whether another skin has the same cells at the same places.
  [[nodiscard]] bool same_cells(const SkinTables& other) const noexcept {
    bool same = by_id == other.by_id && cells.size() == other.cells.size();
    for (std::size_t i = 0; same && i < cells.size(); ++i)
      same = cells[i].unit == other.cells[i].unit && cells[i].patch == other.cells[i].patch &&
             patch_of(i).link == other.patch_of(i).link &&
             double(patch_of(i).moment_step) == double(other.patch_of(i).moment_step);
    return same;
  }
  /// Bytes that the tables take [B].
  [[nodiscard]] std::size_t bytes() const noexcept {
    return cells.size() * (sizeof(cells[0]) + sizeof(places[0])) + by_id.size() * sizeof(by_id[0]) +
           patches.size() * sizeof(patches[0]);
  }

 private:
  /// Force and moment about the link's origin of one newton along a channel's direction, eqs. (4) and (6).
  [[nodiscard]] static std::pair<Xyz<double>, Xyz<double>> push_along(const AnyCell& cell, std::size_t line) {
    std::size_t c = 0;
    while (Table::line[c] != line) ++c;
    const auto& d = Kind::channels[c].direction;
    const auto& at = Kind::channels[c].place;
    const auto axes = cell.X_LC.axes();
    const Xyz<double> force = d[0] * axes.x + d[1] * axes.y + d[2] * axes.z;
    const Xyz<double> p = cell.X_LC.origin() + at[0] * axes.x + at[1] * axes.y + at[2] * axes.z;
    return {force, cross(p, force)};
  }
  /// The moments of a patch's unit wrenches are at most 2^reach.
  [[nodiscard]] SKINCTL_COLD static int reach_of(const std::vector<NewCell<Kind>>& patch) {
    int reach = -20;
    for (const NewCell<Kind>& cell : patch)
      for (std::size_t line = 0; line < Table::lines; ++line) {
        const Xyz<double> m = push_along(cell.placed, line).second;
        for (const double x : {m.x, m.y, m.z})
          while (std::abs(x) > std::ldexp(1.0, reach)) ++reach;
      }
    return reach;
  }
  SKINCTL_COLD void add_cell(const NewCell<Kind>& cell, const PerChannel<Kind, double>& gain, int reach,
                             PatchRow<Kind, T>& patch) {
    CellRow<Kind> row;
    row.patch = static_cast<std::uint16_t>(patches.size()), row.slot = static_cast<std::uint16_t>(patch.slot);
    const auto whole = [](double x, int exponent) {
      return static_cast<std::int32_t>(std::round(std::ldexp(x, 24 - exponent)));
    };
    for (std::size_t line = 0; line < Table::lines; ++line) {
      const auto [f, m] = push_along(cell.placed, line);
      row.unit[line] = {whole(f.x, 0),     whole(f.y, 0),     whole(f.z, 0),
                        whole(m.x, reach), whole(m.y, reach), whole(m.z, reach)};
    }
    bool feels = false;
    for (std::size_t c = 0; c < Table::pushing; ++c) {
      const auto gate = cell.gates[c].counted(Table::step(c));
      const double share = gain[c] > 0 ? cell.gain[c] / gain[c] : 1;
      row.tuning[c].set(gate);
      row.tuning[c].share = static_cast<std::uint16_t>(std::round(share * double(ChannelTuning::whole)));
      feels = feels || row.tuning[c].share != 0;
      patch.hidden[c] = gate.opens_at() > patch.hidden[c] ? gate.opens_at() : patch.hidden[c];
    }
    if (!feels) numb.push_back(static_cast<std::uint32_t>(cells.size()));
    cells.push_back(row);
    const auto rounded = [&](double x) { return static_cast<float>(std::ldexp(whole(x, 0), -24)); };
    const Xyz<double>&p = cell.placed.X_LC.origin(), z = cell.placed.X_LC.axis_z();
    places.push_back({{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
                      {rounded(z.x), rounded(z.y), rounded(z.z)}});
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
