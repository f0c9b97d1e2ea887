// The constant data of a skin.
#pragma once

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/detail/cell_table.hpp"
#include "skinctl/tactile/detail/count_pair.hpp"
#include "skinctl/tactile/skin_settings.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The readings of a cell that make up a wrench.
enum class Reading { both, force, proximity };

/// A patch, or the part of a large one whose cells share a sum.
template <Real T>
struct alignas(32) PatchRow {
  T force_gain, proximity_gain;  ///< [N] per count
  std::uint32_t first, count;    ///< cells
  std::uint32_t link, slot;      ///< and its index in the link wrenches
  std::uint32_t number;          ///< of the patch among those that were given
  std::int32_t hidden;           ///< no proximity below passes, in counts
};
/// Number of sums of a patch of `cells` cells.
constexpr std::size_t sums_of(std::size_t cells) noexcept {
  return (cells + ExactSums::most_cells - 1) / ExactSums::most_cells;
}

/// What one cell has of its own: thresholds as in `GatePair`, and shares of its patch's gains.
struct CellTuning {
  CellCounts opens, less, subtract;
  CellCounts share{whole, whole};
  static constexpr int whole_bits = 15;
  static constexpr std::uint16_t whole = 1u << whole_bits;

  /// Thresholds of gates in counts; no reading is above 65535.
  void set(const EventGate<std::int32_t>& force, const EventGate<std::int32_t>& proximity) noexcept {
    const auto most = [](std::int32_t x) {
      return static_cast<std::uint16_t>(x < 0 ? 0 : x < 0xFFFF ? x : 0xFFFF);
    };
    const auto one = [&](const EventGate<std::int32_t>& gate, auto member) {
      opens.*member = most(gate.opens_at() - 1);
      less.*member = static_cast<std::uint16_t>(opens.*member - most(gate.closes_below() - 1));
      subtract.*member = most(gate.subtract());
    };
    one(force, &CellCounts::force);
    one(proximity, &CellCounts::proximity);
  }
  [[nodiscard]] SKINCTL_INLINE GatePair gates() const noexcept {
    return {CountPair(opens), CountPair(less), CountPair(subtract)};
  }
};
static_assert(sizeof(CellTuning) == 16);

/// All cells of a skin with their gains and thresholds. `Tuned`: each cell has its own.
template <Real T, bool Tuned = false>
struct SkinTables {
  using scalar = T;
  static constexpr bool tuned = Tuned;
  SkinSettings settings;
  CellTuning common;  ///< of all cells, unless `Tuned`
  GatePair gates;
  std::vector<PatchRow<T>> patches;
  CellTable cells;
  std::vector<CellTuning> tuning;   ///< of each cell, if `Tuned`
  std::vector<std::uint32_t> numb;  ///< cells without gains: they are heard, and do not feel
  std::uint32_t given = 0;          ///< number of patches that were added

  SkinTables(const SkinSettings& s, std::size_t count) : settings(s), cells(count) {
    common.set(s.force.counted(CellCounts::force_unit), s.proximity.counted(CellCounts::proximity_unit));
    gates = common.gates();
  }

  /// Adds a patch on link `link`: a row and a sum for each 8192 of its cells.
  SKINCTL_COLD void add(const std::vector<AnyCell>& patch, const CellGains& gains, std::size_t link,
                        std::size_t slot) {
    for (std::size_t from = 0; from < patch.size(); from += ExactSums::most_cells) {
      const std::size_t rest = patch.size() - from;
      const std::size_t count = rest < ExactSums::most_cells ? rest : ExactSums::most_cells;
      patches.push_back({T(gains.force * CellCounts::force_unit),
                         T(gains.proximity * CellCounts::proximity_unit),
                         static_cast<std::uint32_t>(cells.size()), static_cast<std::uint32_t>(count),
                         static_cast<std::uint32_t>(link), static_cast<std::uint32_t>(slot), given,
                         Tuned ? 0 : settings.proximity.counted(CellCounts::proximity_unit).opens_at()});
      cells.add(patch.data() + from, count, patches.size() - 1, slot);
    }
    ++given;
  }
  /// What the next cell has of its own: thresholds, and shares of its patch's gains.
  SKINCTL_COLD void tune(const EventGate<>& force, const EventGate<>& proximity, double force_share,
                         double proximity_share)
    requires Tuned
  {
    const auto steps = [](double share) {
      return static_cast<std::uint16_t>(std::round(share * double(CellTuning::whole)));
    };
    const auto seen = proximity.counted(CellCounts::proximity_unit);
    tuning.emplace_back().set(force.counted(CellCounts::force_unit), seen);
    tuning.back().share = {steps(force_share), steps(proximity_share)};
    if (tuning.back().share == CellCounts{0, 0})
      numb.push_back(static_cast<std::uint32_t>(tuning.size() - 1));
    std::int32_t& hidden = patches[cells.seat(tuning.size() - 1).sums].hidden;
    hidden = seen.opens_at() > hidden ? seen.opens_at() : hidden;
  }

  /// The counts of cell `i` that pass its thresholds; `old` is what passed last.
  SKINCTL_INLINE CountPair pass(std::size_t i, CountPair raw, CountPair old) const noexcept {
    if constexpr (Tuned) {
      return tuning[i].gates().pass(raw, old);
    } else {
      return static_cast<void>(i), gates.pass(raw, old);
    }
  }
  SKINCTL_INLINE CellCounts pass(std::size_t i, CellCounts raw, CellCounts old) const noexcept {
    return pass(i, CountPair(raw), CountPair(old)).counts_of();
  }
  /// Counts of cell `i` as shares of its patch's gains.
  SKINCTL_INLINE WideCounts weigh(std::size_t i, CountPair c) const noexcept {
    if constexpr (Tuned) {
      return WideCounts((c.wide().row() * CountPair(tuning[i].share).wide().row() + CellTuning::whole / 2) >>
                        CellTuning::whole_bits);
    } else {
      return static_cast<void>(i), c.wide();
    }
  }
  SKINCTL_INLINE CellCounts weigh(std::size_t i, CellCounts c) const noexcept {
    if constexpr (Tuned) {
      const WideCounts weighed = weigh(i, CountPair(c));
      return {static_cast<std::uint16_t>(weighed.force()), static_cast<std::uint16_t>(weighed.proximity())};
    } else {
      return static_cast<void>(i), c;
    }
  }
  SKINCTL_INLINE const PatchRow<T>& patch_of(std::size_t i) const noexcept {
    return patches[cells.seat(i).sums];
  }
  /// The push by weighed counts of one kind, or of both [N].
  template <Reading R>
  SKINCTL_INLINE T push_on(CellSeat seat, CellCounts c) const noexcept {
    const PatchRow<T>& patch = patches[seat.sums];
    if constexpr (R == Reading::force) return patch.force_gain * static_cast<T>(c.force);
    if constexpr (R == Reading::proximity) return patch.proximity_gain * static_cast<T>(c.proximity);
    return patch.force_gain * static_cast<T>(c.force) + patch.proximity_gain * static_cast<T>(c.proximity);
  }
  /// What its proximity gate takes off the readings of cell `i` that pass, in counts.
  SKINCTL_INLINE std::int32_t hidden_below(std::size_t i) const noexcept {
    if constexpr (Tuned) {
      return tuning[i].subtract.proximity;
    } else {
      return static_cast<void>(i), common.subtract.proximity;
    }
  }
  /// Of its patch's gain of force that cell `i` has.
  [[nodiscard]] double share(std::size_t i) const noexcept {
    if constexpr (Tuned) {
      return double(tuning[i].share.force) / CellTuning::whole;
    } else {
      return static_cast<void>(i), 1;
    }
  }
  /// Bytes that the tables take [B].
  [[nodiscard]] std::size_t bytes() const noexcept {
    return cells.bytes() + patches.size() * sizeof(PatchRow<T>) + tuning.size() * sizeof(CellTuning);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
