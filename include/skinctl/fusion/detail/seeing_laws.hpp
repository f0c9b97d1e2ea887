// SPDX-License-Identifier: BSD-3-Clause
// Laws of a sum that see their scene: all of them see, and what they add to input and output is there once.
#pragma once

#include <tuple>

#include "skinctl/core/detail/each_once.hpp"
#include "skinctl/fusion/detail/law_parts.hpp"
#include "skinctl/fusion/detail/memories.hpp"
#include "skinctl/law/evaluate.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The members by which laws see their scene, for a sum `Own` that has `each_law(memory, f)`, which calls
/// `f(law, memory)`.
template <class Own, class... L>
struct SeeingLaws {
  using Input = Together<typename LawTable<L>::Input...>;
  using Output = Together<typename LawTable<L>::Output...>;
  /// Whether one of the laws sees its scene.
  template <class In, class Seen>
  static constexpr bool one_sees = (sees<L, In, Seen> || ...);

  template <class Memory, class In, class Seen>
  SKINCTL_INLINE Status see(Memory& memory, const In& input, const Seen& seen) const noexcept {
    Status status;
    own().each_law(memory, [&]<class Law>(const Law& law, auto& m)
                               SKINCTL_INLINE_LAMBDA { status |= LawTable<Law>::see(law, m, input, seen); });
    return status;
  }
  template <class Memory>
  [[nodiscard]] Output output(const Memory& memory) const noexcept {
    Output out{};
    own().each_law(memory, [&]<class Law>(const Law& law, const auto& m) {
      using Part = typename LawTable<Law>::Output;
      if constexpr (!std::is_empty_v<Part>) static_cast<Part&>(out) = LawTable<Law>::output(law, m);
    });
    return out;
  }
  /// The memory after a stop: of all laws.
  template <class Memory, class K>
  [[nodiscard]] SKINCTL_COLD Memory resumed(const Memory& memory, const K& known) const noexcept {
    Memory out = memory;
    own().each_law(out, [&](const auto& law, auto& m) { m = skinctl::resumed(law, m, known); });
    return out;
  }
  [[nodiscard]] bool needs_contacts() const noexcept {
    bool waits = false;
    std::apply([&](const L&... law) { waits = (LawTable<L>::needs_contacts(law) || ...); }, own().laws());
    return waits;
  }

 private:
  [[nodiscard]] SKINCTL_INLINE const Own& own() const noexcept { return static_cast<const Own&>(*this); }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
