// SPDX-License-Identifier: BSD-3-Clause
// Skin: all patches of a robot, and the conversion of their samples to wrenches on links.
#pragma once

#include <tuple>

#include "skinctl/tactile/detail/skin_core.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
template <class... Patches>
using KindOfPatches = typename std::tuple_element_t<0, std::tuple<Patches...>>::kind;
template <class Kind, class... Patches>
constexpr bool one_kind() {
  constexpr bool one = (std::is_same_v<Kind, typename Patches::kind> && ...);
  static_assert(one, "patches of two kinds of cell: make a skin of each, and add them");
  return true;
}
}  // namespace detail

/// Patches of cells on a robot of topology `M`. Immutable; the changing data are a trivially
/// copyable `Memory` of 17 bytes a cell.
///
/// **Result.** Each cell's force [N] is piecewise linear in time through its stamped samples. A cell that
/// sends only changes is silent while its reading is constant: its force is held, and changes only within the
/// last `ramp` before the new sample. After the last sample it is held; once the cell has been silent for
/// `max_age - fade` it goes to zero within `fade` and stays there. There is no baseline that follows the
/// readings. `receive` gives the mean wrench on every link for each part of an interval. A sample may show
/// that the force has changed before the interval began, when it was assumed constant; the missing impulse is
/// then added, up to `catch_up` back. So the impulse on the robot is the integral of the force, whatever the
/// rate of the cycle.
///
/// **Method.** The sums of the held readings times their unit wrenches are updated event by event, in integer
/// steps (unit wrenches to 2^-24, readings to 2^-14 and 2^-16), so they stay exact in any order.
///
/// **Kinds.** All patches have one kind of cell, `Hexagon` unless they name another one (`SensorKind`). A
/// scene with two kinds adds two skins.
template <Topology M, Real T, class... Patches>
class Skin : public detail::SkinCore<M, T, (link_bit<Patches::link> | ...), (Patches::cells + ...),
                                     sizeof...(Patches), detail::KindOfPatches<Patches...>> {
  using Core = detail::SkinCore<M, T, (link_bit<Patches::link> | ...), (Patches::cells + ...),
                                sizeof...(Patches), detail::KindOfPatches<Patches...>>;

 public:
  static_assert(detail::one_kind<typename Core::kind, Patches...>());
  static_assert(((Patches::link < M::joints) && ...), "a patch sits on a link that the model does not have");
  using typename Core::Settings;
  using typename Core::Wrenches;

  /// Throws `ConfigurationError` for an id that occurs twice or is 2^20 or more, and for settings that
  /// `SkinSettings::check` refuses.
  SKINCTL_COLD explicit Skin(const Patches&... patch, const Settings& settings = {}) : Core(settings) {
    this->tables_.reserve(Core::cells);
    const auto add = [&](const auto& one, std::size_t link) {
      const auto gain = detail::gain_list(one.gains());
      std::vector<detail::GivenCell<typename Core::kind>> all;
      all.reserve(one.any().size());
      for (const detail::AnyCell& cell : one.any()) all.push_back({cell, settings.gates(), gain});
      this->tables_.add(all, gain, link, Wrenches::slot(link));
    };
    (add(patch, Patches::link), ...);
  }
};

SKINCTL_END_NAMESPACE
