// The skin of the main job: the generated one, or one from a file.
#pragma once

#include <vector>

#include "examples/compliant_ur5/settings.hpp"
#include "examples/compliant_ur5/touch_observer.hpp"
#include "examples/simulated_ur5/skin.hpp"
#include "skinctl/tactile/ur5_skin.hpp"

namespace compliant_ur5 {

inline constexpr std::size_t cells = 260;
using SkinPatches = decltype(skinctl::ur5::skin_patches<cells>());

/// Patches with the gains of the settings, or those of `Settings::skin`, a file of 260 cells spread over the
/// links as `ur5_skin<260>` spreads them. On a rigid arm all gains are 0. Throws
/// `skinctl::ConfigurationError`.
SkinPatches skin_patches(const Settings& settings);

/// The same cells as the observer and as the simulation want them.
std::vector<ObservedCell> observed_cells(const SkinPatches& patches);
std::vector<simulated_ur5::SkinCell> simulated_cells(const SkinPatches& patches);

}  // namespace compliant_ur5
