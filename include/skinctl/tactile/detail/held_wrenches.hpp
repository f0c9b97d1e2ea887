// The wrenches of what a skin holds, and of what it owes.
#pragma once

#include "skinctl/tactile/detail/skin_memory.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Whether contacts and what is seen are apart.
template <class Means>
inline constexpr bool tells_apart = requires(const Means& m) { m.proximity; };

/// The wrenches of the held readings to each of `count` parts.
template <class Kind, Real T, class Memory, class Means>
SKINCTL_INLINE void write_held(const SkinTables<Kind, T>& tables, const Memory& memory, Means* means,
                               std::size_t count) noexcept {
  constexpr bool apart = tells_apart<Means>;
  Means held{};
  for (std::size_t k = 0; k < tables.patches.size(); ++k) {
    const PatchRow<Kind, T>& patch = tables.patches[k];
    each_channel<Kind>([&](auto c) SKINCTL_INLINE_LAMBDA {
      const auto& steps = memory.sums[k].steps[c];
      std::int64_t any = 0;
      for (const std::int64_t n : steps) any |= n;
      if (any == 0) return;
      T* wrench = nullptr;
      if constexpr (apart) {
        wrench = (KindTable<Kind>::is_seen(c) ? held.proximity : held.force).data[patch.slot];
      } else {
        wrench = held.data[patch.slot];
      }
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
    if constexpr (tells_apart<Means>) {
      means[j].force += per_whole * memory.owed.force;
      means[j].proximity += per_whole * memory.owed.proximity;
    } else {
      means[j] += per_whole * memory.owed.force;
    }
  }
  memory.owed = {};
  memory.owes = false;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
