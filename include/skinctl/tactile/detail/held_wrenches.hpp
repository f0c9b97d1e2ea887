// SPDX-License-Identifier: BSD-3-Clause
// The wrenches of what a skin holds, and of what it owes.
#pragma once

#include "skinctl/tactile/detail/skin_memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The wrenches of contacts, or of what is `Seen` only; all wrenches where the two are not separate.
template <bool Seen, class Means>
[[nodiscard]] SKINCTL_INLINE auto& use_of(Means& means) noexcept {
  if constexpr (!is_apart<Means>) {
    return means;
  } else if constexpr (Seen) {
    return means.proximity;
  } else {
    return means.force;
  }
}
/// Writes the wrenches of the held readings to each of `count` parts.
template <class Kind, Real T, class Memory, class Means>
SKINCTL_INLINE void write_held(const SkinTables<Kind, T>& tables, const Memory& memory, Means* means,
                               std::size_t count) noexcept {
  Means held{};
  for (std::size_t k = 0; k < tables.patches.size(); ++k) {
    const PatchRow<Kind, T>& patch = tables.patches[k];
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      const auto& steps = memory.sums[k].steps[c];
      std::int64_t any = 0;
      for (const std::int64_t n : steps) any |= n;
      if (any == 0) return;
      T* const wrench = use_of<KindTable<Kind>::is_seen(c)>(held).data[patch.slot];
      const T force = patch.gain[c] * T(0x1p-24), moment = patch.gain[c] * patch.moment_step;
      for (std::size_t r = 0; r < 3; ++r) wrench[r] = wrench[r] + force * real_of<T>(steps[r]);
      for (std::size_t r = 3; r < 6; ++r) wrench[r] = wrench[r] + moment * real_of<T>(steps[r]);
    });
  }
  for (std::size_t j = 0; j < count; ++j) means[j] = held;
}
/// Adds the impulse that is owed to each of `count` parts of an interval.
template <Real T, class Memory, class Means>
SKINCTL_NOINLINE void pay(Memory& memory, const T& per_whole, Means* means, std::size_t count) noexcept {
  for (std::size_t j = 0; j < count; ++j) {
    if constexpr (is_apart<Means>) {
      means[j].force += per_whole * memory.owed.force;
      means[j].proximity += per_whole * memory.owed.proximity;
    } else {
      means[j] += per_whole * memory.owed.force;
    }
  }
  memory.owed = {};
  memory.owes = false;
}

/// Adds the wrenches of pushes on cell `i`, one a channel [N].
template <class Kind, Real T, class W>
void add_pushes(const SkinTables<Kind, T>& tables, std::size_t i, const PerChannel<Kind, T>& push,
                TouchWrenches<W>& to) noexcept {
  const CellRow<Kind>& row = tables.cells[i];
  each_channel<Kind>([&](auto c) {
    tables.patch_of(i).add_unit(row.unit[KindTable<Kind>::line[c]], push[c],
                                use_of<KindTable<Kind>::is_seen(c)>(to).data[row.slot]);
  });
}
/// Adds the contact of cell `i` to the areas that are pressed, if there is one; `push` of each channel [N].
template <class Kind, Real T, class Areas>
void add_area(const SkinTables<Kind, T>& tables, std::size_t i, const PerChannel<Kind, T>& push,
              Areas& areas) noexcept {
  using Table = KindTable<Kind>;
  using std::sqrt;
  const CellRow<Kind>& row = tables.cells[i];
  const PatchRow<Kind, T>& patch = tables.patch_of(i);
  T unit[6] = {}, size(0);
  if constexpr (Table::lines == 1) {
    each_channel<Kind>([&](auto c) {
      if constexpr (!Table::is_seen(c)) size = size + push[c];
    });
    patch.add_unit(row.unit[0], T(1), unit);
  } else {
    each_channel<Kind>([&](auto c) {
      if constexpr (!Table::is_seen(c)) patch.add_unit(row.unit[Table::line[c]], push[c], unit);
    });
    size = sqrt(unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2]);
    if (size > T(0))
      for (T& x : unit) x = x / size;
  }
  const Xyz<float>& p = tables.origins[i];
  if (size > T(0)) areas.add(patch.link, {T(p.x), T(p.y), T(p.z)}, unit, size);
}

}  // namespace detail
SKINCTL_END_NAMESPACE
