// SPDX-License-Identifier: BSD-3-Clause
// The skin's wrench on each link with skin.
#pragma once

#include <bit>

#include "skinctl/frames/wrench.hpp"
#include "skinctl/model/topology.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Force [N] and moment [N m] about the link's origin, along the link's axes, for every link of `Skinned`:
/// the sum over its cells, eq. (7). Other links have no wrench, and none is stored. Zero by default,
/// trivially copyable.
template <Topology M, LinkMask Skinned, Scalar T = double>
struct LinkWrenches {
  static_assert((Skinned & ~all_links(M::joints)) == 0, "the mask names a link that the model does not have");
  using model_type = M;
  using scalar = T;
  static constexpr LinkMask links = Skinned;
  static constexpr std::size_t count = static_cast<std::size_t>(std::popcount(Skinned));

  /// Per link in ascending order: force x, y, z, moment x, y, z.
  T data[count == 0 ? 1 : count][6] = {};

  /// Index of link `i` in `data`.
  static constexpr std::size_t slot(std::size_t i) noexcept {
    return static_cast<std::size_t>(std::popcount(Skinned & ((LinkMask(1) << i) - 1)));
  }

  /// The wrench on link `Ix`. A link without skin does not compile.
  template <std::size_t Ix>
  [[nodiscard]] SKINCTL_INLINE constexpr Wrench<Link<Ix>, Link<Ix>, Link<Ix>, T> wrench() const noexcept {
    static_assert((Skinned >> Ix) & 1u, "no skin on this link: its wrench is zero");
    const T* w = data[slot(Ix)];
    return {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}};
  }
  /// Replaces the wrench on link `Ix`.
  template <std::size_t Ix>
  SKINCTL_INLINE constexpr void set(const Wrench<Link<Ix>, Link<Ix>, Link<Ix>, T>& F) noexcept {
    static_assert((Skinned >> Ix) & 1u, "no skin on this link: its wrench is zero");
    T* w = data[slot(Ix)];
    w[0] = F.force.x, w[1] = F.force.y, w[2] = F.force.z;
    w[3] = F.moment.x, w[4] = F.moment.y, w[5] = F.moment.z;
  }

  friend SKINCTL_INLINE constexpr LinkWrenches operator+(const LinkWrenches& a,
                                                         const LinkWrenches& b) noexcept {
    LinkWrenches c;
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t r = 0; r < 6; ++r) c.data[k][r] = a.data[k][r] + b.data[k][r];
    return c;
  }
  friend SKINCTL_INLINE constexpr LinkWrenches operator-(const LinkWrenches& a,
                                                         const LinkWrenches& b) noexcept {
    return a + T(-1) * b;
  }
  friend SKINCTL_INLINE constexpr LinkWrenches operator*(const T& s, const LinkWrenches& a) noexcept {
    LinkWrenches c;
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t r = 0; r < 6; ++r) c.data[k][r] = s * a.data[k][r];
    return c;
  }
  SKINCTL_INLINE constexpr LinkWrenches& operator+=(const LinkWrenches& b) noexcept {
    return *this = *this + b;
  }
  friend SKINCTL_INLINE constexpr bool operator==(const LinkWrenches& a, const LinkWrenches& b) noexcept {
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t r = 0; r < 6; ++r)
        if (!(a.data[k][r] == b.data[k][r])) return false;
    return true;
  }
};

SKINCTL_END_NAMESPACE
