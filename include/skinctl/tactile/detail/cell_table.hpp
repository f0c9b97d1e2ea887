// The table of cells by id: unit wrenches in integer steps, and indices of their sums.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "skinctl/core/lane.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A wrench as a row of eight: force, moment, two numbers that no wrench needs. So it is whole registers, and never
/// crosses a cache line.
inline constexpr std::size_t row_size = 8;
/// Numbers of such a row in a register, and numbers that are computed: six, rounded up to whole registers. With AVX-512 a
/// row of doubles is one: half the loads and stores, on which events wait.
template <Real T>
inline constexpr std::size_t row_lanes = [] {
  if constexpr (std::same_as<T, float> || std::same_as<T, double>) {
#if defined(__AVX512F__)
    return row_size;
#else
    return native_lanes<T> < row_size ? native_lanes<T> : row_size;
#endif
  } else {
    return std::size_t(1);
  }
}();
template <Real T>
inline constexpr std::size_t row_used = (6 + row_lanes<T> - 1) / row_lanes<T> * row_lanes<T>;

/// `row_lanes<T>` floats as numbers `T`.
template <Real T>
[[nodiscard]] SKINCTL_INLINE auto widened(const float* row) noexcept {
  constexpr std::size_t lanes = row_lanes<T>;
  if constexpr (lanes == 1) {
    return static_cast<T>(*row);
  } else {
    using Wide = LaneVector<T, lanes>;
#if defined(__AVX512F__) && !defined(__clang__)
    if constexpr (std::same_as<T, double>) {  // GCC converts by halves, and puts them together
      const auto narrow = *reinterpret_cast<const typename LaneTypes<float, lanes>::Anywhere*>(row);
      return __builtin_ia32_cvtps2pd512_mask(narrow, Wide{}, -1, 4);
    }
#endif
    return [&]<std::size_t... I>(std::index_sequence<I...>) SKINCTL_INLINE_LAMBDA {
      return Wide{static_cast<T>(row[I])...};
    }(std::make_index_sequence<lanes>{});
  }
}

/// `to += factor from`, on the widest registers that fit the remaining numbers.
template <std::size_t N, Real T, Real U>
SKINCTL_INLINE void multiply_add(T* to, const T& factor, const U* from) noexcept {
  if constexpr (N > 0) {
    constexpr std::size_t W = [] {
      if constexpr (std::same_as<T, float> || std::same_as<T, double>) {
        std::size_t w = native_lanes<T>;
        while (w > N) w /= 2;
        return w;
      } else {
        return std::size_t(1);
      }
    }();
    if constexpr (W > 1) {
      const auto wide = [&]<std::size_t... I>(std::index_sequence<I...>) SKINCTL_INLINE_LAMBDA {
        return Lane<T, W>(typename Lane<T, W>::Vector{static_cast<T>(from[I])...});
      }(std::make_index_sequence<W>{});
      (Lane<T, W>::load(to) + Lane<T, W>(factor) * wide).store(to);
    } else {
      *to = *to + factor * static_cast<T>(*from);
    }
    multiply_add<N - W>(to + W, factor, from + W);
  }
}

/// A unit wrench in registers, converted once for all sums of an event.
template <Real T>
class WideUnit {
  static constexpr std::size_t lanes = row_lanes<T>;
  static constexpr std::size_t count = row_used<T> / lanes;

 public:
  SKINCTL_INLINE explicit WideUnit(const float* row) noexcept {
    for (std::size_t k = 0; k < count; ++k) part_[k] = widened<T>(row + k * lanes);
  }
  /// `to += factor unit`, for a row of eight.
  SKINCTL_INLINE void add_to(T* to, const T& factor) const noexcept {
    for (std::size_t k = 0; k < count; ++k) {
      if constexpr (lanes == 1) {
        to[k] = to[k] + factor * part_[k];
      } else {
        SKINCTL_CONTRACT auto& sum =
            *reinterpret_cast<typename LaneTypes<T, lanes>::Anywhere*>(to + k * lanes);
        sum = sum + factor * part_[k];
      }
    }
  }

 private:
  using Part = decltype(widened<T>(nullptr));
  Part part_[count];
};

/// The unit wrench of a cell, `-[z ; p x z]`. Forces are multiples of 2^-24, moments of 2^-24 times the patch's reach:
/// exact in float. The last two numbers are the steps in a moment of 1 m, and the length of such a step [m]: powers of two,
/// so that sums which carry them along stay exact.
struct alignas(32) CellUnit {
  float row[row_size] = {};

  friend bool operator==(const CellUnit&, const CellUnit&) noexcept = default;
  /// `wrench += factor unit`, for six numbers.
  template <Real T>
  SKINCTL_INLINE void add_to(T* wrench, const T& factor) const noexcept {
    multiply_add<6>(wrench, factor, row);
  }
};

/// Whether the processor computes in double. A Cortex-M4 takes a hundred instructions for a sum.
#if (defined(__arm__) && !(defined(__ARM_FP) && (__ARM_FP & 8))) || \
    (defined(__riscv) && !defined(__riscv_flen)) || (defined(__riscv_flen) && __riscv_flen < 64)
inline constexpr bool computes_in_double = false;
#else
inline constexpr bool computes_in_double = true;
#endif

/// Sums over up to 8192 cells of a patch of unit wrench times count, for forces and for proximities. All terms
/// are multiples of the same steps and stay below 2^53 steps, so the sums are exact in any order.
///
/// @tparam Number  double, in newtons and newton metres per count; or int64_t, in steps.
template <class Number>
struct alignas(64) ExactSumsIn {
  static constexpr bool in_steps = std::is_same_v<Number, std::int64_t>;
  Number force[row_size] = {};
  Number proximity[row_size] = {};
  static constexpr std::size_t most_cells = 8192;

  SKINCTL_INLINE void add(const CellUnit& cell, int force_change, int proximity_change) noexcept {
    if constexpr (in_steps) {
      for (std::size_t r = 0; r < 6; ++r) {
        const auto steps = static_cast<std::int32_t>(cell.row[r] * (r < 3 ? 0x1p24f : cell.row[6]));
        force[r] += static_cast<std::int64_t>(steps) * force_change;
        proximity[r] += static_cast<std::int64_t>(steps) * proximity_change;
      }
    } else {
      add(WideUnit<double>(cell.row), force_change, proximity_change);
    }
  }
  SKINCTL_INLINE void add(const WideUnit<double>& cell, double force_change, double proximity_change) noexcept
    requires(!in_steps)
  {
    cell.add_to(force, force_change);
    cell.add_to(proximity, proximity_change);
  }
  /// Number `r` of `force` or of `proximity`; `cell` is any of the patch.
  template <Real T>
  [[nodiscard]] static SKINCTL_INLINE T at(const Number* sums, std::size_t r, const CellUnit& cell) noexcept {
    if constexpr (!in_steps) {
      return static_cast<void>(cell), static_cast<T>(sums[r]);
    } else if constexpr (std::is_same_v<T, float>) {
      // The lower half with a sign, so that a small number does not come from a difference of large ones.
      const auto low = static_cast<std::int32_t>(static_cast<std::uint32_t>(sums[r]));
      const auto high = static_cast<std::int32_t>((sums[r] - low) >> 32);
      return (static_cast<float>(high) * 0x1p32f + static_cast<float>(low)) *
             (r < 3 ? 0x1p-24f : cell.row[7]);
    } else {
      return static_cast<T>(sums[r]) * static_cast<T>(r < 3 ? 0x1p-24f : cell.row[7]);
    }
  }
  friend bool operator==(const ExactSumsIn&, const ExactSumsIn&) noexcept = default;
};
using ExactSums = ExactSumsIn<std::conditional_t<computes_in_double, double, std::int64_t>>;

/// Where a cell belongs.
struct CellSeat {
  std::uint16_t sums = 0;  ///< index of its sums
  std::uint16_t slot = 0;  ///< index of its link in the link wrenches
  friend bool operator==(const CellSeat&, const CellSeat&) noexcept = default;
};
/// All that an event looks up by its cell's id, in eight bytes.
class CellKey {
 public:
  /// Of an unknown cell: its index is beyond all cells.
  constexpr CellKey() noexcept = default;
  constexpr CellKey(std::uint32_t index, CellSeat seat) noexcept : index_(index), seat_(seat) {}
  /// In the order of the patches.
  [[nodiscard]] SKINCTL_INLINE constexpr std::size_t index() const noexcept { return index_; }
  [[nodiscard]] SKINCTL_INLINE constexpr std::size_t sums() const noexcept { return seat_.sums; }
  [[nodiscard]] SKINCTL_INLINE constexpr std::size_t slot() const noexcept { return seat_.slot; }
  friend constexpr bool operator==(const CellKey&, const CellKey&) noexcept = default;

 private:
  std::uint32_t index_ = ~std::uint32_t(0);
  CellSeat seat_;
};
static_assert(sizeof(CellKey) == 8);

/// All cells in the order of their patches, and the map from ids to indices in that order.
class CellTable {
 public:
  static constexpr std::uint32_t highest_id = (1u << 20) - 1;

  /// Room for `cells` cells, to be added.
  SKINCTL_COLD explicit CellTable(std::size_t cells) : units_(cells), places_(cells), seats_(cells) {}

  /// Adds `count` <= 8192 cells that share one sum.
  SKINCTL_COLD void add(const AnyCell* cells, std::size_t count, std::size_t sums, std::size_t slot) {
    require(count <= ExactSums::most_cells, "Skin: cells of one sum", double(count),
            "at most 8192: sums stay exact");
    require(sums <= 0xFFFF, "Skin: sums", double(sums), "at most 65536 patches, or parts of 8192 cells");
    int reach = -20;  // the moments are at most 2^reach
    for (const AnyCell* cell = cells; cell != cells + count; ++cell) {
      const auto u = unit_wrench(cell->X_LC);
      for (const double m : {u.moment.x, u.moment.y, u.moment.z})
        while (std::abs(m) > std::ldexp(1.0, reach)) ++reach;
    }
    const CellSeat seat{static_cast<std::uint16_t>(sums), static_cast<std::uint16_t>(slot)};
    for (const AnyCell* cell = cells; cell != cells + count; ++cell) {
      require(cell->id <= highest_id, "Skin: cell id", double(cell->id), "< 2^20");
      if (cell->id + 1 >= keys_.size()) keys_.resize(cell->id + 2);  // the last one is of no cell
      require(keys_[cell->id] == CellKey{}, "Skin: cell id", double(cell->id), "ids that occur once");
      keys_[cell->id] = {static_cast<std::uint32_t>(size_), seat};
      const auto u = unit_wrench(cell->X_LC);
      const auto whole = [](double x, int exponent) {
        return static_cast<float>(std::ldexp(std::round(std::ldexp(x, 24 - exponent)), exponent - 24));
      };
      const Xyz<double>& p = cell->X_LC.origin();
      places_[size_] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      units_[size_] = {{whole(u.force.x, 0), whole(u.force.y, 0), whole(u.force.z, 0),
                        whole(u.moment.x, reach), whole(u.moment.y, reach), whole(u.moment.z, reach),
                        std::ldexp(1.0f, 24 - reach), std::ldexp(1.0f, reach - 24)}};
      seats_[size_++] = seat;
    }
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Of the cell `id`; the key of an unknown cell has an index beyond all cells.
  SKINCTL_INLINE CellKey key(std::uint32_t id) const noexcept { return keys().of(id); }
  /// The keys by id, for a loop: ids beyond the highest one share the last key, of no cell.
  struct Keys {
    const CellKey* first;
    std::uint32_t last;
    SKINCTL_INLINE const CellKey& of(std::uint32_t id) const noexcept { return first[id < last ? id : last]; }
  };
  SKINCTL_INLINE Keys keys() const noexcept {
    return {keys_.data(), static_cast<std::uint32_t>(keys_.size() - 1)};
  }
  friend bool operator==(const CellTable&, const CellTable&) noexcept = default;
  SKINCTL_INLINE const CellUnit& operator[](std::size_t i) const noexcept { return units_[i]; }
  SKINCTL_INLINE const CellSeat& seat(std::size_t i) const noexcept { return seats_[i]; }
  /// Of the i-th cell in its link [m].
  SKINCTL_INLINE const std::array<float, 3>& place(std::size_t i) const noexcept { return places_[i]; }

  /// Bytes that the table takes [B].
  [[nodiscard]] std::size_t bytes() const noexcept {
    return size_ * (sizeof(CellUnit) + sizeof(places_[0]) + sizeof(CellSeat)) +
           keys_.size() * sizeof(CellKey);
  }

 private:
  std::size_t size_ = 0;
  std::vector<CellUnit> units_;
  std::vector<std::array<float, 3>> places_;
  std::vector<CellSeat> seats_;
  std::vector<CellKey> keys_ = std::vector<CellKey>(1);  // by id
};

}  // namespace detail
SKINCTL_END_NAMESPACE
