// SPDX-License-Identifier: BSD-3-Clause
// The kinds of limits and their order.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/limits/detail/group_motion.hpp"
#include "skinctl/limits/limit.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The velocity that limits leave, and why.
template <std::size_t N, Real T>
struct Slowed {
  JointVelocity<N, T> velocity;
  Status status;
  bool slowed = false;

  SKINCTL_INLINE void by(const T& share) noexcept {
    if (share < T(1)) slowed = true, velocity = share * velocity;
  }
};

/// The kind of a limit or of its settings; of a kind, the kind itself.
template <class Part>
struct KindOf {
  using type = Part;
};
template <LimitWithKind Part>
struct KindOf<Part> {
  using type = typename Part::Kind;
};
template <class Part, class Kind>
inline constexpr bool of_kind = std::is_same_v<typename KindOf<Part>::type, typename KindOf<Kind>::type>;

/// The first index at which `is` is true, or `Count`.
template <std::size_t Count>
[[nodiscard]] consteval std::size_t place_of(std::array<bool, Count> is) {
  std::size_t k = 0;
  while (k < Count && !is[k]) ++k;
  return k;
}
template <std::size_t Mover, class... Limits>
[[nodiscard]] auto mover_among(const std::tuple<Limits...>& all) {
  if constexpr (Mover < sizeof...(Limits)) {
    return std::get<Mover>(all);
  } else {
    return Abrupt{};
  }
}
/// The indices of `keys` in rising order; equal ones stay as they are.
template <class Key, std::size_t N>
[[nodiscard]] constexpr std::array<std::size_t, N> order_of(const std::array<Key, N>& keys) {
  std::array<std::size_t, N> out{};
  for (std::size_t i = 0; i < N; ++i) {
    std::size_t before = 0;
    for (std::size_t j = 0; j < N; ++j)
      if (keys[j] < keys[i] || (keys[j] == keys[i] && j < i)) ++before;
    out[before] = i;
  }
  return out;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
