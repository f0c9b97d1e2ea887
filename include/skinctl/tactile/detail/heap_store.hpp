// Room for the memory of a skin whose number of cells is known at run time.
#pragma once

#include <vector>

#include "skinctl/tactile/detail/skin_memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Room for a number that is known at run time, on the heap.
struct HeapStore {
  std::vector<ExactSums> sums;
  std::vector<Nanoseconds> oldest;
  std::vector<BlockStates> states;
  std::vector<CellRecord> records;
  /// Whether so many cells are fetched ahead: the nearest cache does not hold them.
  static constexpr bool fetches(std::size_t cells) noexcept { return cells >= 4096; }
  static constexpr bool fixed = false;
  SKINCTL_COLD void make_room(std::size_t cells, std::size_t number_of_sums) {
    sums.resize(number_of_sums);
    oldest.assign((cells + 63) / 64, Nanoseconds::max());
    states.resize((cells + 63) / 64);
    records.resize(cells);
  }
  friend bool operator==(const HeapStore&, const HeapStore&) noexcept = default;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
