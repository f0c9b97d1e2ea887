// The simulated robot of the main job.
#pragma once

#include <memory>
#include <optional>

#include "examples/adapters/skin/authentication.hpp"
#include "examples/compliant_ur5/run_log.hpp"
#include "examples/compliant_ur5/settings.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"

namespace compliant_ur5 {

/// The simulated robot of a scenario, started and waiting; its numbers go to `log.scenario`.
std::unique_ptr<simulated_ur5::SimulatedUr5> start_simulation(const Settings& settings,
                                                              std::uint16_t skin_port,
                                                              const std::optional<adapters::skin::Key>& key,
                                                              RunLog& log);

}  // namespace compliant_ur5
