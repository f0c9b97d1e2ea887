// Four sums in registers.
#pragma once

#include <utility>

#include "skinctl/core/lane.hpp"
#include "skinctl/frames/point.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Four sums that stay in registers while a loop adds to them. In memory each addition would wait for the last one to be
/// stored.
template <Real T>
class FourSums {
  static constexpr std::size_t lanes = [] {
    if constexpr (std::same_as<T, float> || std::same_as<T, double>) {
      return native_lanes<T> < 4 ? native_lanes<T> : std::size_t(4);
    } else {
      return std::size_t(1);
    }
  }();
  using Part = LaneVector<T, lanes>;

 public:
  /// `sums += factor from`, for four numbers.
  SKINCTL_INLINE void add(const T& factor, const float* from) noexcept {
    for (std::size_t k = 0; k < 4 / lanes; ++k) part_[k] = part_[k] + factor * widened(from + k * lanes);
  }
  [[nodiscard]] SKINCTL_INLINE T operator[](std::size_t i) const noexcept {
    if constexpr (lanes == 1) {
      return part_[i];
    } else {
      return part_[i / lanes][i % lanes];
    }
  }
  /// The first three.
  [[nodiscard]] SKINCTL_INLINE Xyz<T> first() const noexcept { return {(*this)[0], (*this)[1], (*this)[2]}; }

 private:
  static SKINCTL_INLINE Part widened(const float* from) noexcept {
    if constexpr (lanes == 1) {
      return static_cast<T>(*from);
    } else {
      return [&]<std::size_t... I>(std::index_sequence<I...>) SKINCTL_INLINE_LAMBDA {
        return Part{static_cast<T>(from[I])...};
      }(std::make_index_sequence<lanes>{});
    }
  }
  Part part_[4 / lanes] = {};
};

}  // namespace detail
SKINCTL_END_NAMESPACE
