// SPDX-License-Identifier: BSD-3-Clause
// The topology of a kinematic tree, known at compile time: the parent of each link.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include "skinctl/core/link_mask.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The kind of a joint: its link moves about or along the z axis of the link's frame.
enum class JointKind : unsigned char { revolute, prismatic };

/// Mask of all links of a model of `n` joints.
constexpr LinkMask all_links(std::size_t n) noexcept {
  return n >= 64 ? ~LinkMask(0) : (LinkMask(1) << n) - 1;
}

/// A type that names a tree: `joints`, and per joint its parent link (`-1`: the base; parents come before
/// children) and its kind.
template <class M>
concept Topology = requires {
  { M::joints } -> std::convertible_to<std::size_t>;
  M::parents[0];
  M::kinds[0];
};

/// Mask of the links on the path from the base to link `i`, itself included: the joints that move it.
template <Topology M>
constexpr LinkMask ancestors(std::size_t i) noexcept {
  LinkMask mask = 0;
  for (int j = static_cast<int>(i); j >= 0; j = M::parents[static_cast<std::size_t>(j)])
    mask |= LinkMask(1) << j;
  return mask;
}

/// Mask of all links on the paths from the base to the links of `mask`.
template <Topology M>
constexpr LinkMask closure(LinkMask mask) noexcept {
  LinkMask all = 0;
  for (std::size_t i = 0; i < M::joints; ++i)
    if ((mask >> i) & 1u) all |= ancestors<M>(i);
  return all;
}

/// Mask of the links that link `i` carries, itself included.
template <Topology M>
constexpr LinkMask subtree(std::size_t i) noexcept {
  LinkMask mask = 0;
  for (std::size_t j = i; j < M::joints; ++j)
    if ((ancestors<M>(j) >> i) & 1u) mask |= LinkMask(1) << j;
  return mask;
}

/// Whether the parents come before their children, for 1 to 64 joints.
template <Topology M>
constexpr bool is_tree() noexcept {
  for (std::size_t i = 0; i < M::joints; ++i)
    if (M::parents[i] < -1 || M::parents[i] >= static_cast<int>(i)) return false;
  return M::joints > 0 && M::joints <= 64;
}

namespace detail {
/// Number of links whose parent is `P`.
template <Topology M, int P>
constexpr std::size_t child_count() noexcept {
  std::size_t n = 0;
  for (std::size_t i = 0; i < M::joints; ++i) n += M::parents[i] == P ? 1u : 0u;
  return n;
}
template <Topology M, int P>
constexpr auto make_children() noexcept {
  std::array<std::size_t, child_count<M, P>()> out{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < M::joints; ++i)
    if (M::parents[i] == P) out[n++] = i;
  return out;
}
}  // namespace detail

/// The links whose parent is link `P` (`-1`: the base), in ascending order.
template <Topology M, int P>
inline constexpr auto children = detail::make_children<M, P>();

/// The parent indices of every serial chain of `N` joints.
template <std::size_t N>
constexpr std::array<int, N> chain_parents() noexcept {
  std::array<int, N> p{};
  for (std::size_t i = 0; i < N; ++i) p[i] = static_cast<int>(i) - 1;
  return p;
}
/// The kinds of `N` joints that are all of one kind.
template <std::size_t N>
constexpr std::array<JointKind, N> all_of_kind(JointKind kind) noexcept {
  std::array<JointKind, N> k{};
  for (auto& x : k) x = kind;
  return k;
}

/// A serial chain of `N` revolute joints.
template <std::size_t N>
struct Chain {
  static constexpr std::size_t joints = N;
  static constexpr auto parents = chain_parents<N>();
  static constexpr auto kinds = all_of_kind<N>(JointKind::revolute);
};

SKINCTL_END_NAMESPACE
