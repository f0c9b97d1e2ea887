// The constants of the cells of a trusted skin.
#pragma once

#include <array>
#include <vector>

#include "skinctl/tactile/patch.hpp"
#include "skinctl/tactile/skin_of.hpp"
#include "skinctl/tactile/trust_settings.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The constants of a cell of a trusted skin.
struct TrustCell {
  std::uint32_t id = 0, patch = 0;
  std::size_t link = 0;
  std::array<float, 3> place{};                        ///< in its link [m]
  float unit[6] = {};                                  ///< its unit wrench
  double force_gain = 0, proximity_gain = 0;           ///< [N per unit of the readings]
  EventGate<std::int32_t> force_gate, proximity_gate;  ///< on counts
  double lone = 0;                                     ///< F_1 [N]
  float rest = 0;                                      ///< where its rest level begins [steps]
  bool masked = false;                                 ///< for good: by the skin's file
};
/// Whether one body hardly touches both: they are on two links, or farther apart than a hand is long.
[[nodiscard]] inline bool apart(const TrustCell& a, const TrustCell& b) noexcept {
  float square = 0;
  for (std::size_t k = 0; k < 3; ++k) square += (a.place[k] - b.place[k]) * (a.place[k] - b.place[k]);
  return a.link != b.link || square > 0.04f;
}
/// Collects the cells of a trusted skin, patch by patch.
class TrustCells {
 public:
  SKINCTL_COLD TrustCells(const TrustSettings& trust, std::size_t cells) : trust_(trust), cells_(cells) {
    trust.check(cells);
    out_.reserve(cells);
  }
  template <class Pose>
  SKINCTL_COLD void add(std::uint32_t id, std::size_t link, const Pose& X_LC, const CellGains& gains,
                        const EventGate<>& force, const EventGate<>& proximity, bool masked = false) {
    const auto one = [&](const auto& list) { return list[list.size() == 1 ? 0 : out_.size()]; };
    require(out_.size() < cells_, "TrustedSkin: cells of the patches", double(out_.size() + 1),
            "those of the skin");
    const auto u = unit_wrench(X_LC);
    const Xyz<double>& p = X_LC.origin();
    out_.push_back(
        {id,
         patch_,
         link,
         {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)},
         {static_cast<float>(u.force.x), static_cast<float>(u.force.y), static_cast<float>(u.force.z),
          static_cast<float>(u.moment.x), static_cast<float>(u.moment.y), static_cast<float>(u.moment.z)},
         gains.force,
         gains.proximity,
         force.counted(CellCounts::force_unit),
         proximity.counted(CellCounts::proximity_unit),
         one(trust_.lone_force),
         3 * one(trust_.noise).rest,
         masked});
  }
  void end_patch() noexcept { ++patch_; }
  [[nodiscard]] SKINCTL_COLD std::vector<TrustCell> take() {
    require(out_.size() == cells_, "TrustedSkin: cells of the patches", double(out_.size()),
            "those of the skin");
    return std::move(out_);
  }

 private:
  const TrustSettings& trust_;
  std::size_t cells_;
  std::uint32_t patch_ = 0;
  std::vector<TrustCell> out_;
};

template <std::size_t... I, std::size_t... N>
[[nodiscard]] SKINCTL_COLD std::vector<TrustCell> trust_cells(const TrustSettings& trust,
                                                              const SkinSettings& skin, std::size_t cells,
                                                              const Patch<I, N>&... patch) {
  TrustCells all(trust, cells);
  const auto add = [&](std::size_t link, const auto& one) {
    for (const AnyCell& cell : one.any())
      all.add(cell.id, link, cell.X_LC, one.gains(), skin.force, skin.proximity);
    all.end_patch();
  };
  (add(I, patch), ...);
  return all.take();
}
[[nodiscard]] SKINCTL_COLD inline std::vector<TrustCell> trust_cells(const TrustSettings& trust,
                                                                     const SkinSettings& skin,
                                                                     std::size_t cells,
                                                                     const std::vector<SkinPatch>& patches) {
  TrustCells all(trust, cells);
  for (const SkinPatch& patch : patches) {
    for (const SkinCell& cell : patch.cells)
      all.add(cell.id, patch.link, cell.X_LC, cell.gains.value_or(patch.gains),
              cell.force.value_or(skin.force), cell.proximity.value_or(skin.proximity), cell.masked);
    all.end_patch();
  }
  return all.take();
}

}  // namespace detail
SKINCTL_END_NAMESPACE
