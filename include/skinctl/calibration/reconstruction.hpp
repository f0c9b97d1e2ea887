// The shape of a patch of skin, from what its cells feel of gravity while the robot rests in several poses.
#pragma once

#include "skinctl/calibration/reconstruction_types.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Reconstructs a patch: rotations of neighbours by Procrustes as the start, then all poses, sensor errors and directions of
/// gravity together, with every connector as a tie. A cell is reported with the reason, and its pose not used, if
/// - it was recorded in fewer than three poses, or its readings are not those of a sensor at rest (0.8 to 1.2 g);
/// - no neighbour's readings turn with its own: it lies, or its connector is a cable to another link;
/// - its turn or place is known worse than the limits: it was turned about gravity only, for instance.
///
/// A common factor on all distances is not observable: the ports' positions are taken as true.
///
/// Throws `ConfigurationError` for settings out of range, and where the numbers of cells or poses do not agree.
[[nodiscard]] Reconstruction reconstruct(const PatchGraph& patch, const RestReadings& readings,
                                         const ReconstructionSettings& settings = {});

/// The start alone, which is the classical method: rotations from neighbour to neighbour along the tree.
[[nodiscard]] Reconstruction procrustes_chain(const PatchGraph& patch, const RestReadings& readings,
                                              const ReconstructionSettings& settings = {});

SKINCTL_END_NAMESPACE

#include "skinctl/calibration/detail/reconstruction_fit.hpp"
