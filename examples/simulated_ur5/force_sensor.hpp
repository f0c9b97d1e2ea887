// The force-torque sensor at the tool flange of an e-Series, and what ages, warms up or is told wrong.
#pragma once

#include "examples/simulated_ur5/geometry.hpp"
#include "examples/simulated_ur5/random.hpp"

namespace simulated_ur5 {

/// What such a sensor reads besides what acts: every number is 0 for one without that flaw.
struct ForceSensorConfig {
  double force_noise = 0.15;       ///< standard deviation of each component of force [N]
  double moment_noise = 0.004;     ///< standard deviation of each component of moment [N m]
  Vec3 force_bias, moment_bias;    ///< along the flange's axes [N], [N m]
  Vec3 force_creep, moment_creep;  ///< change of the bias [N/s], [N m/s]
  double bias_from = 0;   ///< when they begin [s after the scenario's start]; 0: the bias from boot on
  Vec3 force_per_kelvin;  ///< bias by temperature, which rises as that of the motors [N/K]
};
/// Throws `skinctl::ConfigurationError` for numbers outside their ranges.
void check(const ForceSensorConfig& config);

/// A force, and a moment about the origin of the flange, along the flange's axes.
struct FlangeWrench {
  Vec3 force, moment;
};

class ForceSensor {
 public:
  explicit ForceSensor(const ForceSensorConfig& config) : config_(config) {}
  void reseed(std::uint64_t seed) { random_ = Random(seed); }

  /// What it reads of what acts: once per cycle.
  /// @param time     since the scenario's start [s]; negative: before it.
  /// @param warming  above the temperature at which it was zeroed [K].
  FlangeWrench read(const FlangeWrench& acts, double time, double warming) {
    const double since = time - config_.bias_from;
    const auto noise = [this](double size) {
      return size * Vec3{random_.normal(), random_.normal(), random_.normal()};
    };
    FlangeWrench out{acts.force + warming * config_.force_per_kelvin + noise(config_.force_noise),
                     acts.moment + noise(config_.moment_noise)};
    if (time < 0 || since < 0) return out;
    out.force = out.force + config_.force_bias + since * config_.force_creep;
    out.moment = out.moment + config_.moment_bias + since * config_.moment_creep;
    return out;
  }

 private:
  ForceSensorConfig config_;
  Random random_;
};

}  // namespace simulated_ur5
