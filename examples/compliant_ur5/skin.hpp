// The skin of the main job: the generated one, or one from a file.
#pragma once

#include <vector>

#include "examples/compliant_ur5/settings.hpp"
#include "examples/compliant_ur5/touch_observer.hpp"
#include "examples/simulated_ur5/skin.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/skin_of.hpp"

namespace compliant_ur5 {

inline constexpr std::size_t cells = 260;      ///< of the generated skin
inline constexpr std::size_t max_cells = 512;  ///< of a file: 383 of TUM's size find room
using UrSkin = skinctl::SkinOf<skinctl::ur5::Model, double, max_cells>;

/// Standard deviation of a force sensor at rest, as it is declared [steps].
inline constexpr float force_noise = 0.4f;

inline constexpr std::uint32_t palm_cell = 60000;  ///< id of the cell of a carried hand's palm

/// w_p of a link [N per unit of proximity]: 0 unless the arm keeps clear. Throws
/// `skinctl::ConfigurationError` for a share with which a thing that is seen is stiffer to the arm than the
/// stiffest wall that it may touch.
[[nodiscard]] double proximity_gain(const Settings& settings, std::size_t link);

/// The patches of `ur5_skin<260>` with the gains of the settings, or those of the file `Settings::skin`,
/// divided by `heavier`. On a rigid arm all gains are 0. The palm of a carried hand is one more. Throws
/// `skinctl::ConfigurationError`.
std::vector<skinctl::SkinPatch> skin_patches(const Settings& settings, double heavier = 1);

/// Which of these cells are neighbours: as the file says, else those near by.
skinctl::CellGraph skin_graph(const Settings& settings, const std::vector<skinctl::SkinPatch>& patches);

/// Both of the file `Settings::skin`, with its gains.
std::vector<skinctl::SkinPatch> patches_of_file(const Settings& settings);
skinctl::CellGraph graph_of_file(const Settings& settings);

/// The same cells as the observer and as the simulation want them.
std::vector<ObservedCell> observed_cells(const std::vector<skinctl::SkinPatch>& patches);
std::vector<simulated_ur5::SkinCell> simulated_cells(const std::vector<skinctl::SkinPatch>& patches);

}  // namespace compliant_ur5
