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

/// `to += factor from`, on the widest registers that fit the remaining numbers.
template <std::size_t N, Real T>
SKINCTL_INLINE void multiply_add(T* to, const T& factor, const float* from) noexcept {
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

/// One cell. Half a cache line, so that an event reads one.
struct alignas(32) CellEntry {
  /// `-[z ; p x z]`. Forces are multiples of 2^-24, moments of 2^-24 times the patch's reach: exact in float.
  float unit[6] = {};
  std::uint32_t patch = 0;  ///< index of its sums
  std::uint32_t slot = 0;   ///< index of its link in the link wrenches

  friend bool operator==(const CellEntry&, const CellEntry&) noexcept = default;
  /// `wrench += factor unit`.
  template <Real T>
  SKINCTL_INLINE void add_to(T* wrench, const T& factor) const noexcept {
    multiply_add<6>(wrench, factor, unit);
  }
};

/// Sums over the cells of a patch of unit wrench times count, for forces and for proximities. All terms are
/// multiples of the same steps and stay below 2^53 steps, so the sums are exact in any order.
struct ExactSums {
  std::array<double, 6> force{};
  std::array<double, 6> proximity{};
  static constexpr std::size_t most_cells = 8192;

  SKINCTL_INLINE void add(const CellEntry& cell, int force_change, int proximity_change) noexcept {
    cell.add_to(force.data(), static_cast<double>(force_change));
    cell.add_to(proximity.data(), static_cast<double>(proximity_change));
  }
  friend bool operator==(const ExactSums&, const ExactSums&) noexcept = default;
};

/// All cells in the order of their patches, and the map from ids to indices in that order.
class CellTable {
 public:
  static constexpr std::uint32_t highest_id = (1u << 20) - 1;

  explicit CellTable(std::size_t cells) {
    entries_.reserve(cells);
    places_.reserve(cells);
  }

  SKINCTL_COLD void add(const std::vector<AnyCell>& cells, std::size_t number, std::size_t slot) {
    require(cells.size() <= ExactSums::most_cells, "Skin: cells of a patch", double(cells.size()),
            "at most 8192: sums stay exact");
    int reach = -20;  // the patch's moments are at most 2^reach
    for (const AnyCell& cell : cells) {
      const auto u = unit_wrench(cell.X_LC);
      for (const double m : {u.moment.x, u.moment.y, u.moment.z})
        while (std::abs(m) > std::ldexp(1.0, reach)) ++reach;
    }
    for (const AnyCell& cell : cells) {
      require(cell.id <= highest_id, "Skin: cell id", double(cell.id), "< 2^20");
      if (cell.id >= index_.size()) index_.resize(cell.id + 1, none);
      require(index_[cell.id] == none, "Skin: cell id", double(cell.id), "ids that occur once");
      index_[cell.id] = static_cast<std::uint32_t>(entries_.size());
      const auto u = unit_wrench(cell.X_LC);
      const auto whole = [](double x, int exponent) {
        return static_cast<float>(std::ldexp(std::round(std::ldexp(x, 24 - exponent)), exponent - 24));
      };
      const Xyz<double>& p = cell.X_LC.origin();
      places_.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
      entries_.push_back({{whole(u.force.x, 0), whole(u.force.y, 0), whole(u.force.z, 0),
                           whole(u.moment.x, reach), whole(u.moment.y, reach), whole(u.moment.z, reach)},
                          static_cast<std::uint32_t>(number),
                          static_cast<std::uint32_t>(slot)});
    }
  }
  SKINCTL_INLINE std::size_t index(std::uint32_t id) const noexcept {
    return id < index_.size() ? index_[id] : none;
  }
  friend bool operator==(const CellTable&, const CellTable&) noexcept = default;
  SKINCTL_INLINE const CellEntry& operator[](std::size_t i) const noexcept { return entries_[i]; }
  /// Of the i-th cell in its link [m].
  SKINCTL_INLINE const std::array<float, 3>& place(std::size_t i) const noexcept { return places_[i]; }

 private:
  static constexpr std::uint32_t none = ~std::uint32_t(0);
  std::vector<CellEntry> entries_;
  std::vector<std::array<float, 3>> places_;
  std::vector<std::uint32_t> index_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
