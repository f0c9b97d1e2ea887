// What a simulated hand is behind its wire: the plant with its servo, temperature and faults.
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "examples/adapters/allegro/frames.hpp"
#include "examples/simulated_allegro/plant.hpp"

namespace simulated_allegro {

using adapters::allegro::Generation;

/// What goes wrong. Shares are of frames (CAN) or datagrams (UDP); times are the hand's [s], below 0: never.
struct Faults {
  double from = 0;  ///< the shares hold from here on
  double lose = 0, duplicate = 0, reorder = 0, truncate = 0;
  double late_at = -1, late_for = 0.03;  ///< held back, then sent in one burst
  double silent_at = -1;                 ///< nothing is sent any more
  double unplug_at = -1;                 ///< the link is closed
  double servo_off_at = -1;              ///< the hand drops its servo
  double hot_at = -1;                    ///< it becomes too hot within 0.1 s
  double motor_error_at = -1;            ///< V5 Sense by UDP
  double other_version_at = -1;          ///< by UDP
  double restart_at = -1;                ///< by UDP: the numbers of samples begin anew
  bool mute = false;                     ///< it answers no request
};

struct Config {
  Generation generation = Generation::v4;
  bool geared = false;       ///< V5: joints 1, 5 and 9; a V5 Sense is
  char type = 'A';           ///< V5: the letter in its serial number, which says nothing sure about gears
  int hardware = -1;         ///< upper byte of its hardware version; -1: its generation
  unsigned hand = 0;         ///< number on the bus
  double full_torque = 0.7;  ///< V4: at 1200 PWM [N m]
  /// 1: real time. 0: as fast as commands come: time stands still after each set of positions until the
  /// torques are there, or for `patience` seconds.
  double speed = 1;
  double patience = 1;
  PlantConfig plant;
  Faults faults;
  unsigned seed = 1;
};

/// What the simulated world knows; a real hand could not tell all of it.
struct Snapshot {
  double time = 0;  ///< [s]
  Joints q{}, dq{}, torque{}, cell_force{}, ball_force{};
  bool servo = false;
  double servo_off_time = -1;  ///< when it last went off by command
  std::uint64_t sets = 0;      ///< of positions, sent or lost
  std::uint64_t torques = 0;   ///< sets of torques that arrived
  std::uint64_t nonsense = 0;  ///< that nobody should have sent
};

/// Where fault times have passed, and the shares of what goes wrong.
class Body {
 public:
  explicit Body(const Config& config) : config_(config), plant_(config.plant), random_(config.seed) {}

  void servo(bool on) {
    if (snapshot_.servo && !on) snapshot_.servo_off_time = plant_.time();
    snapshot_.servo = on;
    wire_ = {};
    plant_.command({});
  }
  /// Torques as on the wire, of joints `first` to `first + 3`.
  void torque(std::size_t first, const std::array<std::int16_t, 4>& value) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t j = first + i;
      const bool gear =
          (config_.geared || config_.generation == Generation::v5_sense) && (j == 1 || j == 5 || j == 9);
      const double unit =
          config_.generation == Generation::v4 ? config_.full_torque / 1200 : (gear ? 2.0 : 1.0) / 1430;
      wire_[j] = snapshot_.servo ? unit * value[i] : 0;
    }
  }
  /// All torques have come.
  void act() {
    ++snapshot_.torques;
    plant_.command(wire_);
  }
  void advance(double t) {
    if (past(config_.faults.servo_off_at) && !dropped_) {
      dropped_ = true;
      servo(false);
    }
    plant_.advance(t);
    snapshot_.time = plant_.time();
    snapshot_.q = plant_.q();
    snapshot_.dq = plant_.dq();
    snapshot_.torque = plant_.torque();
    snapshot_.cell_force = plant_.cell_force();
    snapshot_.ball_force = plant_.ball_force();
  }

  [[nodiscard]] bool past(double when) const noexcept { return when >= 0 && plant_.time() >= when; }
  /// Whether an event of this share happens now.
  [[nodiscard]] bool happens(double share) {
    return share > 0 && plant_.time() >= config_.faults.from &&
           std::uniform_real_distribution<>(0, 1)(random_) < share;
  }
  [[nodiscard]] int temperature() const noexcept {
    if (!past(config_.faults.hot_at)) return 40;
    return static_cast<int>(std::min(90.0, 40 + 500 * (plant_.time() - config_.faults.hot_at)));
  }
  /// Encoder steps of joint `i`.
  [[nodiscard]] std::int16_t position(std::size_t i) const noexcept {
    const double degrees = plant_.q()[i] * 57.29577951308232;
    const double step = config_.generation == Generation::v4 ? 333.3 / 65536 : 0.088;
    return static_cast<std::int16_t>(std::lround(degrees / step));
  }
  /// Tactile reading of cell `k`, 0 to 1020.
  [[nodiscard]] std::uint16_t cell(std::size_t k) const noexcept {
    const double x = plant_.cell_force()[k] / config_.plant.newtons_of_full_scale;
    return static_cast<std::uint16_t>(1020 * std::min(1.0, std::max(0.0, x)));
  }
  [[nodiscard]] const Config& config() const noexcept { return config_; }
  [[nodiscard]] const Plant& plant() const noexcept { return plant_; }
  [[nodiscard]] Snapshot& snapshot() noexcept { return snapshot_; }
  [[nodiscard]] std::string serial() const {
    return std::string("5T") + config_.type + (config_.plant.side == Side::right ? "R" : "L") + "0042";
  }

 private:
  Config config_;
  Plant plant_;
  std::mt19937 random_;
  Joints wire_{};
  Snapshot snapshot_;
  bool dropped_ = false;
};

}  // namespace simulated_allegro
