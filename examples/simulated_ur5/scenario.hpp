// Scenario files: touches and the numbers of the simulated robot, in TOML.
#pragma once

#include <string>

#include "examples/simulated_ur5/simulated_ur5.hpp"

namespace simulated_ur5 {

/// Reads the tables `[robot]`, `[force_sensor]`, `[motors]`, `[skin]` and `[[touch]]` of a scenario file into
/// `config`; other tables are somebody else's and are skipped. Files that it names (`profile`, `cells`) are
/// looked for beside it. Unknown keys in its own tables, wrong types and wrong values throw
/// `skinctl::ConfigurationError` with file and line.
///
/// `[robot]`: series ("cb3" or "e-series"), delay, lag, stiffness, integral_time, unknown_payload,
/// position_noise, velocity_noise, step_tolerance, protective_force, protective_deceleration, velocity_limit,
/// acceleration_limit (one number or six), home (six), powered, power_on_time, brake_release_time,
/// unlock_time, seed. `[force_sensor]`: force_noise, moment_noise, force_bias, moment_bias, force_creep,
/// moment_creep, force_per_kelvin (three numbers each), bias_from. `[motors]`: viscous, coulomb,
/// torque_noise, torque_bias, torque_creep (one number or six), warming, warming_time, friction_per_kelvin.
/// `[skin]`: cells (file), newtons_per_reading, rest_reading, force_noise, proximity_noise,
/// acceleration_noise, proximity_distance, temperature, force_delta, proximity_delta, acceleration_delta,
/// keep_alive. `[[touch]]`: name, start, cell or link + point + normal, stiffness, damping, tremor, gap,
/// approach_speed, travel, hold, release_speed, patch_radius, reach, follow, profile (CSV file),
/// profile_scale, impose_force, repeat (number of times), period (seconds between).
void read_scenario(const std::string& file, Config& config);

/// Reads the cells of a skin file (JSON), on links by their names in the maker's ROS 2 description. Throws
/// `skinctl::ConfigurationError`.
std::vector<SkinCell> read_skin_cells(const std::string& file);
/// Reads a force profile, see `read_profile`.
ForceProfile read_profile_file(const std::string& file);

}  // namespace simulated_ur5
