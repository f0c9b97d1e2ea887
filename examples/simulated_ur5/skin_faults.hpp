// Faults of the simulated skin's cells, from the words of a command line.
#pragma once

#include <string>
#include <vector>

#include "examples/simulated_ur5/skin.hpp"
#include "skinctl/testing/skin_faults.hpp"

namespace simulated_ur5 {

/// Reads `FAULT:CELLS[@SECONDS][=LEVEL]`, several of them separated by commas: `stuck:145@3,blinking:10%@5`.
///
/// - FAULT: stuck, saturated, blinking, noisy, cross-talk, discharge or unheard (`skinctl::CellFault`).
/// - CELLS: the id of a cell, or a share of all of them in percent, picked with `seed`.
/// - SECONDS: when it begins, after the start of the simulation; 0 if left out.
/// - LEVEL: see `skinctl::testing::FaultyCell`.
///
/// Throws `skinctl::ConfigurationError` with the word for anything else.
std::vector<skinctl::testing::FaultyCell> read_skin_faults(const std::string& text,
                                                           const std::vector<SkinCell>& cells,
                                                           std::uint64_t seed = 1);

}  // namespace simulated_ur5
