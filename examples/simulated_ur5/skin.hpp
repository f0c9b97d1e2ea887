// The robot skin: cells fixed to links, and what they read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "examples/simulated_ur5/arm.hpp"
#include "examples/simulated_ur5/geometry.hpp"
#include "skinctl/sensing/unrest.hpp"
#include "skinctl/testing/skin_faults.hpp"

namespace simulated_ur5 {

/// One skin cell on a link. Its z axis is the outward normal.
struct SkinCell {
  std::uint32_t id = 0;
  std::size_t link = 0;  ///< 0 to 5, frame as in `Links`
  Vec3 position;         ///< [m], link frame
  Vec3 normal;           ///< unit, link frame, outward
  Vec3 axis;             ///< x axis of the cell, unit, square to the normal
};

/// Makes `axis` square to `normal`, both unit; picks the default axis where `axis` has no part in the cell's
/// plane.
void complete(SkinCell& cell);

/// How the accelerometers of cheap cells err: standard deviations of what stays with a cell, and the shaking
/// of a link.
struct AccelerometerFaults {
  double bias = 0;          ///< of an axis [g]
  double scale = 0;         ///< of an axis
  double misalignment = 0;  ///< of the soldered sensor in its cell, about an axis [rad]
  double cross_axis = 0;    ///< of one axis by another
  double vibration = 0;     ///< of a link, at 8 to 15 Hz, amplitude [g]

  /// BMA250, with a sensor that is soldered within 0.2 degrees.
  [[nodiscard]] static AccelerometerFaults cheap() { return {0.040, 0.015, 0.0035, 0.003, 0.020}; }
};

struct SkinConfig {
  Nanoseconds period = 4'000'000;        ///< of the samples, a multiple of `plant_step`
  Nanoseconds keep_alive = 100'000'000;  ///< longest silence of a cell without new data
  double newtons_per_reading = 20;       ///< normal force on a cell per unit of f1 + f2 + f3
  double rest_reading = 0.004;           ///< of each force sensor
  double force_noise = 0.0003;           ///< standard deviation of each force reading
  double proximity_noise = 0.0005;
  double acceleration_noise = 0.02;  ///< [m/s^2]
  AccelerometerFaults accelerometers;
  double proximity_distance = 0.01;  ///< of a finger that gives reading 0.5 [m]
  double temperature = 30;           ///< [C]
  /// A reading that changed by this much is new data; a cell that is pressed by so much sends all its
  /// readings.
  double force_delta = 2.0 / 1024;
  double proximity_delta = 0.004;
  double acceleration_delta = 1;  ///< [m/s^2]
  Nanoseconds clock_offset{};     ///< added to the controller's time: the skin has its own clock
  /// What is wrong with its cells, by the controller's time.
  std::vector<skinctl::testing::FaultyCell> faults;
};
void check(const SkinConfig& config);
/// Accelerometers of a calibration: `AccelerometerFaults::cheap`, noise of 9 mg, and each measurement is
/// sent.
void err_as_cheap_ones(SkinConfig& config);

/// One sample as it goes out, by the skin's clock.
using SkinSample = skinctl::CellSample;

/// What the world does to the cells at one instant, cell by cell.
struct SkinStimulus {
  std::vector<double> force;      ///< normal force on each cell [N]
  std::vector<double> proximity;  ///< ideal reading [0, 1]
};

/// Turns stimuli into readings with the sensors' steps and noise, and picks those worth sending.
class Skin {
 public:
  Skin(std::vector<SkinCell> cells, const SkinConfig& config, std::uint64_t seed);

  const std::vector<SkinCell>& cells() const { return cells_; }
  const SkinConfig& config() const { return config_; }

  /// Samples all cells at time `t` (call every `period`); returns those with new data or due for a
  /// keep-alive.
  const std::vector<SkinSample>& sample(Nanoseconds t, const Links& links, const SkinStimulus& stimulus);

  /// Starts the noise and the keep-alive rotation anew.
  void restart(std::uint64_t seed);
  /// A cell that no longer answers, or answers again.
  void set_dead(std::uint32_t cell, bool dead);

 private:
  /// Draws what is wrong with the accelerometers.
  void draw_accelerometers(std::uint64_t seed);
  /// What shakes a link at `t`, in its axes [m/s^2].
  [[nodiscard]] Vec3 shaking(std::size_t link, Nanoseconds t) const;
  /// What the sensors read at `t`, cell by cell.
  void feel(Nanoseconds t, const Links& links, const SkinStimulus& stimulus);

  struct Memory {
    SkinSample sent;
    Nanoseconds sent_at{};
    skinctl::Unrest<>::Memory unrest;
    bool ever_sent = false;
    bool dead = false;
    Vec3 before, before_that;  ///< positions at the two samples before
  };
  /// Reading of an accelerometer: `matrix f + bias`.
  struct Accelerometer {
    std::array<Vec3, 3> matrix{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< by rows
    Vec3 bias;                                                                ///< [m/s^2]
  };
  struct Shake {
    double rate, phase, sway;  ///< [rad/s], [rad], [rad]
    Vec3 direction;            ///< [m/s^2]
  };

  std::vector<SkinCell> cells_;
  SkinConfig config_;
  std::vector<Accelerometer> accelerometers_;
  std::array<std::array<Shake, 3>, 6> shakes_{};
  std::vector<Memory> memory_;
  std::vector<SkinSample> felt_, out_;
  skinctl::Unrest<> unrest_;
  skinctl::testing::SkinFaults faults_;
  std::map<std::uint32_t, std::size_t> index_;
  std::int64_t ticks_ = 0;
  Random random_;
};

}  // namespace simulated_ur5
