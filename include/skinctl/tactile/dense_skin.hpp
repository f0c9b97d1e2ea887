// Link wrenches from the readings of all cells at once, for skins (or simulations) that report every cell.
#pragma once

#include <array>
#include <tuple>

#include "skinctl/tactile/link_wrenches.hpp"
#include "skinctl/tactile/unit_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The sums `sum u_i s_i` over all cells of every patch: from one number per cell to one wrench per link. See
/// `Skin` for cells that send only changes.
template <Topology M, class Policy, class... Patches>
class DenseSkin {
 public:
  static_assert(((Patches::link < M::joints) && ...), "a patch sits on a link that the model does not have");
  using Units = UnitWrenches<Policy>;
  using Stored = typename Policy::stored;
  using scalar = typename Policy::summed;
  using Wrenches = LinkWrenches<M, (link_bit<Patches::link> | ...), scalar>;
  static constexpr std::size_t patches = sizeof...(Patches);
  static constexpr std::size_t cells = (Patches::cells + ...);

  /// One number per cell: its inward push [N], >= 0. In the order of the patches; each patch begins at a
  /// multiple of `Units::group`, and the gaps between patches stay 0.
  class Frame {
   public:
    /// Cell `i` of patch `K`.
    template <std::size_t K>
    [[nodiscard]] SKINCTL_INLINE Stored& at(std::size_t i) noexcept {
      SKINCTL_EXPECTS(i < count[K], "a cell of this patch");
      return data_[first[K] + i];
    }
    template <std::size_t K>
    [[nodiscard]] SKINCTL_INLINE const Stored& at(std::size_t i) const noexcept {
      SKINCTL_EXPECTS(i < count[K], "a cell of this patch");
      return data_[first[K] + i];
    }

   private:
    friend class DenseSkin;
    alignas(64) std::array<Stored, (Units::padded(Patches::cells) + ...)> data_{};
  };

  /// Number of cells whose readings count: a frame has all of them.
  [[nodiscard]] static constexpr std::size_t usable(const Frame&) noexcept { return cells; }

  explicit DenseSkin(const Patches&... patch) : units_{Units(patch)...} {}

  /// The wrench on every link. A NaN in the frame makes its link's wrench NaN.
  [[nodiscard]] SKINCTL_INLINE Wrenches wrenches(const Frame& frame) const noexcept {
    Wrenches total;
    [&]<std::size_t... K>(std::index_sequence<K...>)
        SKINCTL_INLINE_LAMBDA { (add<K>(frame, total), ...); }(std::make_index_sequence<patches>{});
    return total;
  }

 private:
  static constexpr std::array<std::size_t, patches> count = {Patches::cells...};
  static constexpr std::array<std::size_t, patches> first = [] {
    std::array<std::size_t, patches> at{};
    for (std::size_t k = 1; k < patches; ++k) at[k] = at[k - 1] + Units::padded(count[k - 1]);
    return at;
  }();
  static constexpr std::array<std::size_t, patches> slots = {Wrenches::slot(Patches::link)...};

  template <std::size_t K>
  SKINCTL_INLINE void add(const Frame& frame, Wrenches& total) const noexcept {
    scalar part[6];
    units_[K].weigh(frame.data_.data() + first[K], part);
    for (std::size_t r = 0; r < 6; ++r) total.data[slots[K]][r] = total.data[slots[K]][r] + part[r];
  }
  std::array<Units, patches> units_;
};

SKINCTL_END_NAMESPACE
