// The client's side of RTDE, version 2: packages in a byte stream, big-endian and unaligned.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace adapters::ur5 {

/// Bytes of a package being built.
class PackageWriter {
 public:
  explicit PackageWriter(std::uint8_t type) : bytes_{0, 0, type} {}
  void u8(std::uint8_t x) { bytes_.push_back(x); }
  void u16(std::uint16_t x) { u8(static_cast<std::uint8_t>(x >> 8)), u8(static_cast<std::uint8_t>(x)); }
  void u32(std::uint32_t x) { u16(static_cast<std::uint16_t>(x >> 16)), u16(static_cast<std::uint16_t>(x)); }
  void i32(std::int32_t x) { u32(static_cast<std::uint32_t>(x)); }
  void f64(double x);
  void text(const std::string& s) {
    for (const char c : s) u8(static_cast<std::uint8_t>(c));
  }
  /// The whole package, its size filled in.
  [[nodiscard]] const std::vector<std::uint8_t>& finish();

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Reads a payload; past its end everything is 0 and `ok()` is false.
class PayloadReader {
 public:
  explicit PayloadReader(std::span<const std::uint8_t> bytes) noexcept : left_(bytes) {}
  std::uint8_t u8() noexcept;
  std::uint16_t u16() noexcept { return static_cast<std::uint16_t>((u8() << 8) | u8()); }
  std::uint32_t u32() noexcept { return (std::uint32_t(u16()) << 16) | u16(); }
  std::int32_t i32() noexcept { return static_cast<std::int32_t>(u32()); }
  std::uint64_t u64() noexcept { return (std::uint64_t(u32()) << 32) | u32(); }
  double f64() noexcept;
  std::string text(std::size_t n);
  std::string rest() { return text(left_.size()); }
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] std::size_t left() const noexcept { return left_.size(); }

 private:
  std::span<const std::uint8_t> left_;
  bool ok_ = true;
};

/// One package out of the stream; `payload` lies in the framer's buffer until the next call.
struct Package {
  std::uint8_t type;
  std::span<const std::uint8_t> payload;
};

/// Cuts packages out of a byte stream. A size that no package can have makes it `broken()`: the stream is
/// lost.
class Framer {
 public:
  static constexpr std::size_t largest = 4096;

  /// Where new bytes go, and how many fit.
  [[nodiscard]] std::span<std::uint8_t> room() noexcept;
  void received(std::size_t count) noexcept { end_ += count; }
  /// The next whole package, if there is one.
  [[nodiscard]] std::optional<Package> next() noexcept;
  [[nodiscard]] bool broken() const noexcept { return broken_; }

 private:
  std::array<std::uint8_t, 4 * largest> buffer_{};
  std::size_t begin_ = 0, end_ = 0;
  bool broken_ = false;
};

/// What is asked for besides what every driver reads.
struct ReportExtras {
  bool tool = false;    ///< pose of the tool's point
  bool motors = false;  ///< currents or torques
  bool echo = false;    ///< number of the newest message that the program on the robot has read
};

/// What the driver reads in every cycle.
struct Report {
  double timestamp = 0;             ///< the controller's clock [s]
  std::array<double, 6> q{}, dq{};  ///< measured [rad], [rad/s]
  std::int32_t robot_mode = 0;      ///< 7: running
  std::int32_t safety_mode = 0;     ///< 1: normal, 2: reduced; 3 and more: stopped
  std::uint32_t runtime_state = 0;  ///< 2: a program is playing
  std::uint64_t digital_outputs = 0;
  std::array<double, 6> told{};    ///< where the controller was told to be [rad]
  double slider = 1;               ///< where the speed slider stands, 0 to 1
  std::array<double, 6> wrench{};  ///< at the tool, as the controller estimates or measures it [N], [N m]
  std::array<double, 6> tool{};    ///< pose of the tool's point [m], rotation vector; 0 if not asked for
  std::array<double, 6> motors{};  ///< currents [A] or torques [N m], as asked for; else 0
  std::int32_t echo =
      0;  ///< number of the newest message that the program on the robot has read, if asked for

  static constexpr const char* recipe =
      "timestamp,actual_q,actual_qd,robot_mode,safety_mode,runtime_state,actual_digital_output_bits,target_q,"
      "target_speed_fraction,actual_TCP_force";
  static constexpr const char* types =
      "DOUBLE,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,UINT64,VECTOR6D,DOUBLE,VECTOR6D";
  static constexpr std::size_t bytes = 8 + 48 + 48 + 4 + 4 + 4 + 8 + 48 + 8 + 48;
  /// Whether the measured joints are numbers.
  [[nodiscard]] bool finite() const noexcept;
  /// From a data package's payload behind the recipe id; false if it is of another size.
  bool decode(std::span<const std::uint8_t> payload, const ReportExtras& extras = {}) noexcept;
};

/// Types of packages.
namespace package {
inline constexpr std::uint8_t version = 86, controller = 118, outputs = 79, inputs = 73, start = 83,
                              pause = 80, data = 85, message = 77;
}

/// Modes of robot and safety in words.
std::string describe_robot_mode(std::int32_t mode);
std::string describe_safety_mode(std::int32_t mode);

}  // namespace adapters::ur5
