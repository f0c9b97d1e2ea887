// A skin that exists: accelerations from its datagrams, as adapters/skin/PROTOCOL.md defines them.
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "examples/adapters/skin/receiver.hpp"
#include "examples/calibrate_skin/arm.hpp"
#include "skinctl/calibration/joint_lines_types.hpp"

namespace calibrate_skin {

/// Receives what the cells of a skin feel, on the robot's clock. Of versions 1, 2 and 3 of the datagram.
class WireSkin {
 public:
  /// Throws `adapters::ConnectionError` where the port cannot be bound.
  explicit WireSkin(const WireOptions& options);

  /// The robot's options with this skin listening in each of its cycles.
  [[nodiscard]] ArmOptions listening(ArmOptions arm);
  /// Forgets what was kept, and keeps what comes from now on.
  void begin() { kept_.clear(); }

  /// Mean reading since `begin` [g]. Throws `std::runtime_error`, in words with the id and what arrived, for
  /// a cell of which less than `least` measurements have come.
  [[nodiscard]] Eigen::Vector3d mean(std::uint16_t id, std::size_t least) const;
  /// Readings since `begin`, with times from `from` of the robot's clock on. Throws as `mean`.
  [[nodiscard]] skinctl::CellReadings readings(std::uint16_t id, skinctl::Nanoseconds from, double duration,
                                               std::size_t least) const;
  /// Wants the lights of these cells on, of no others; told in the robot's cycles from now on. Throws as
  /// `ReceiverCore::show`.
  void show(const std::vector<std::uint32_t>& ids) { receiver_.show(ids); }
  /// Whether the skin says that they are.
  [[nodiscard]] bool shown() const noexcept { return receiver_.shown(); }
  /// Datagrams that came and that were lost, in words.
  [[nodiscard]] std::string said() const;

 private:
  struct Reading {
    skinctl::Nanoseconds time;
    Eigen::Vector3d g;
  };
  [[nodiscard]] const std::vector<Reading>& of(std::uint16_t id, std::size_t least) const;

  adapters::skin::Receiver receiver_;
  std::map<std::uint32_t, std::vector<Reading>> kept_;
};

}  // namespace calibrate_skin
