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
template <class Kind>
struct TrustCell {
  std::uint32_t id = 0, patch = 0;
  std::size_t link = 0;
  std::array<float, 3> place{}, normal{};            ///< in its link [m]; outwards
  PerChannel<Kind, double> gain{};                   ///< [N per unit of each channel]
  PerChannel<Kind, EventGate<std::int32_t>> gate{};  ///< on counts
  double lone = 0;                                   ///< F_1 [N]
  float rest = 0;                                    ///< of one sensor, where rest levels begin [steps]
  bool masked = false;                               ///< for good: by the skin's file
};
/// Whether one body hardly touches both: they are on two links, or farther apart than a hand is long.
template <class Kind>
[[nodiscard]] bool apart(const TrustCell<Kind>& a, const TrustCell<Kind>& b) noexcept {
  float square = 0;
  for (std::size_t k = 0; k < 3; ++k) square += (a.place[k] - b.place[k]) * (a.place[k] - b.place[k]);
  return a.link != b.link || square > 0.04f;
}
/// Collects the cells of a trusted skin, patch by patch.
template <class Kind>
class TrustCells {
 public:
  SKINCTL_COLD TrustCells(const TrustSettings& trust, std::size_t cells) : trust_(trust), cells_(cells) {
    trust.check(cells);
    out_.reserve(cells);
  }
  template <class Pose>
  SKINCTL_COLD void add(std::uint32_t id, std::size_t link, const Pose& X_LC,
                        const PerChannel<Kind, double>& gain, const PerChannel<Kind, EventGate<>>& gates,
                        bool masked = false) {
    const auto one = [&](const auto& list) { return list[list.size() == 1 ? 0 : out_.size()]; };
    require(out_.size() < cells_, "TrustedSkin: cells of the patches", double(out_.size() + 1),
            "those of the skin");
    const auto numbers = [](const Xyz<double>& x) {
      return std::array{static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)};
    };
    TrustCell<Kind> cell{.id = id, .patch = patch_, .link = link};
    cell.place = numbers(X_LC.origin()), cell.normal = numbers(X_LC.axis_z());
    cell.gain = gain;
    for (std::size_t c = 0; c < gain.size(); ++c) cell.gate[c] = gates[c].counted(KindTable<Kind>::step(c));
    cell.lone = one(trust_.lone_force), cell.rest = one(trust_.noise).rest, cell.masked = masked;
    out_.push_back(cell);
  }
  void end_patch() noexcept { ++patch_; }
  [[nodiscard]] SKINCTL_COLD std::vector<TrustCell<Kind>> take() {
    require(out_.size() == cells_, "TrustedSkin: cells of the patches", double(out_.size()),
            "those of the skin");
    return std::move(out_);
  }

 private:
  const TrustSettings& trust_;
  std::size_t cells_;
  std::uint32_t patch_ = 0;
  std::vector<TrustCell<Kind>> out_;
};

template <class Kind, std::size_t... I, std::size_t... N>
[[nodiscard]] SKINCTL_COLD std::vector<TrustCell<Kind>> trust_cells(const TrustSettings& trust,
                                                                    const SettingsOf<Kind>& skin,
                                                                    std::size_t cells,
                                                                    const Patch<I, N, Kind>&... patch) {
  TrustCells<Kind> all(trust, cells);
  const auto add = [&](std::size_t link, const auto& one) {
    for (const AnyCell& cell : one.any())
      all.add(cell.id, link, cell.X_LC, gain_list(one.gains()), skin.gates());
    all.end_patch();
  };
  (add(I, patch), ...);
  return all.take();
}
template <class Kind>
[[nodiscard]] SKINCTL_COLD std::vector<TrustCell<Kind>> trust_cells(
    const TrustSettings& trust, const SettingsOf<Kind>& skin, std::size_t cells,
    const std::vector<SkinPatchOf<Kind>>& patches) {
  TrustCells<Kind> all(trust, cells);
  for (const auto& patch : patches) {
    for (const auto& cell : patch.cells)
      all.add(cell.id, patch.link, cell.X_LC, gain_list(cell.gains.value_or(patch.gains)), cell.gates(skin),
              cell.masked);
    all.end_patch();
  }
  return all.take();
}

}  // namespace detail
SKINCTL_END_NAMESPACE
