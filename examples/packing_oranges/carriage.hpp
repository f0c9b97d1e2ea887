// The base on which both arms stand: it drives from one table to the other, and knows where it stands.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <optional>
#include <span>

#include "examples/packing_oranges/layout.hpp"
#include "examples/packing_oranges/plan.hpp"
#include "skinctl/model/moving_base.hpp"
#include "skinctl/semantics/track.hpp"
#include "skinctl/skinctl.hpp"

namespace packing {

/// Where the robot stands, by its wheels, and by marks that its camera sees while it stands.
///
/// A Kalman filter of x, y and yaw. Wheels slip by a share that is the same on a whole drive, so the
/// deviations grow with the way since the last stand; a mark is a measurement of two of the three.
class Whereabouts {
 public:
  /// What the wheels tell, every cycle.
  void roll(const skinctl::State<3>& wheels);
  /// Marks of a picture, as it was taken from where the robot took itself to stand, `X_WB`.
  void see(const skinctl::Transform<skinctl::World, skinctl::Base>& X_WB,
           std::span<const skinctl::ClassDetection<>> things);
  /// It has stopped: the next drive slips by another share.
  void stops() { way_ = 0; }

  [[nodiscard]] const Standing& at() const { return at_; }
  /// Deviations of position [m] and yaw [rad].
  [[nodiscard]] double sigma() const { return std::sqrt(std::max(P_(0, 0), P_(1, 1))); }
  [[nodiscard]] double sigma_turn() const { return std::sqrt(P_(2, 2)); }

 private:
  /// Shares of a way by which wheels slip, as the maker of the base tells them [m/m], [rad/m].
  static constexpr double slip = 0.015, slip_turn = 0.01;
  static constexpr double is_mark = 0.15;      ///< a mark is seen so far from where it is known, at most [m]
  static constexpr double max_deviations = 4;  ///< of a mark that counts
  static constexpr double first = 0.001;       ///< deviation of where it stands at first [m], [rad]

  Standing at_;
  Eigen::Matrix3d P_ = first * first * Eigen::Matrix3d::Identity();
  std::optional<Standing> told_;
  double way_ = 0;  ///< since it stood [m]
};

/// A base that drives: three joints by velocity with limits of their own, and a spline to each place. It
/// halts while somebody touches the robot.
class Carriage {
 public:
  static constexpr std::size_t nowhere = 99;
  static constexpr skinctl::Nanoseconds period = 8ms;

  explicit Carriage(const skinctl::State<3>& wheels);
  ~Carriage();

  /// Where it shall go: to a table.
  void go(std::size_t table);
  /// A picture, which counts while it stands.
  void see(const skinctl::BaseState<>& taken_at, std::span<const skinctl::ClassDetection<>> things);
  /// A cycle: what the wheels shall do.
  skinctl::JointVelocity<3> step(skinctl::Nanoseconds now, const skinctl::State<3>& wheels, bool touched);

  /// The table at which it stands and has looked where; `nowhere` while it drives.
  [[nodiscard]] std::size_t table() const { return phase_ == Phase::stands ? goal_ : nowhere; }
  /// Where it takes itself to be.
  [[nodiscard]] const skinctl::BaseState<>& state() const { return state_; }
  [[nodiscard]] int drives() const { return drives_; }
  /// How often it went on because it stood too far from where it should; and how often it halted for a touch.
  [[nodiscard]] int corrections() const { return corrections_; }
  [[nodiscard]] int halts() const { return halts_; }

 private:
  enum class Phase : unsigned char { stands, drives, looks };
  static constexpr double near = 0.03,
                          near_turn = 0.02;  ///< of its place, where the arms can work [m], [rad]
  static constexpr double sure = 0.0015, sure_turn = 0.002;  ///< deviations from which arms work [m], [rad]
  static constexpr double pace = 0.8, turning = 0.5;         ///< largest speeds on a spline [m/s], [rad/s]
  static constexpr double swing = 0.7;                       ///< largest acceleration on it [m/s^2]
  /// A base at rest, from when its pictures count.
  static constexpr skinctl::Nanoseconds settles = 200ms;
  static constexpr skinctl::Nanoseconds untouched = 300ms;  ///< since a touch, before it drives on

  [[nodiscard]] static Standing place(std::size_t table) { return {0, second_table * double(table), 0}; }
  void send();
  void tell(skinctl::Nanoseconds now, const skinctl::State<3>& wheels,
            const skinctl::JointAcceleration<3>& planned);

  struct Driving;
  std::unique_ptr<Driving> driving_;
  Whereabouts where_;
  skinctl::BaseState<> state_;
  skinctl::State<3> wheels_;
  Phase phase_ = Phase::stands;
  std::size_t goal_ = 0;
  bool halted_ = false;
  skinctl::Nanoseconds now_{}, moved_{-1s}, touched_{-1s};
  int drives_ = 0, corrections_ = 0, halts_ = 0;
};

}  // namespace packing
