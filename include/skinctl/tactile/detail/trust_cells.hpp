// The constants of the cells of a trusted skin.
#pragma once

#include <array>
#include <vector>

#include "skinctl/tactile/patch.hpp"
#include "skinctl/tactile/trust_settings.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The constants of a cell of a trusted skin.
struct TrustCell {
  std::uint32_t id = 0, patch = 0;
  std::size_t link = 0;
  std::array<float, 3> place{};               ///< in its link [m]
  float unit[6] = {};                         ///< its unit wrench
  double force_gain = 0, proximity_gain = 0;  ///< [N per unit of the readings]
  double lone = 0;                            ///< F_1 [N]
  float rest = 0;                             ///< where its rest level begins [steps]
  friend bool operator==(const TrustCell&, const TrustCell&) noexcept = default;
};
/// Whether one body hardly touches both.
[[nodiscard]] inline bool apart(const TrustCell& a, const TrustCell& b) noexcept {
  float square = 0;
  for (std::size_t k = 0; k < 3; ++k) square += (a.place[k] - b.place[k]) * (a.place[k] - b.place[k]);
  return a.link != b.link || square > 0.01f;
}
template <std::size_t... I, std::size_t... N>
[[nodiscard]] SKINCTL_COLD std::vector<TrustCell> trust_cells(const TrustSettings& s, std::size_t cells,
                                                              const Patch<I, N>&... patch) {
  s.check(cells);
  std::vector<TrustCell> out;
  out.reserve(cells);
  std::uint32_t number = 0;
  const auto one = [](const auto& list, std::size_t i) { return list[list.size() == 1 ? 0 : i]; };
  const auto add_all = [&](std::size_t link, const std::vector<AnyCell>& list, const CellGains& gains) {
    for (const AnyCell& cell : list) {
      const std::size_t i = out.size();
      const auto u = unit_wrench(cell.X_LC);
      const Xyz<double>& p = cell.X_LC.origin();
      out.push_back(
          {cell.id,
           number,
           link,
           {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
           {static_cast<float>(u.force.x), static_cast<float>(u.force.y), static_cast<float>(u.force.z),
            static_cast<float>(u.moment.x), static_cast<float>(u.moment.y), static_cast<float>(u.moment.z)},
           gains.force,
           gains.proximity,
           one(s.lone_force, i),
           3 * one(s.noise, i).rest});
    }
    ++number;
  };
  (add_all(I, patch.any(), patch.gains()), ...);
  require(out.size() == cells, "TrustedSkin: cells of the patches", double(out.size()), "those of the skin");
  return out;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
