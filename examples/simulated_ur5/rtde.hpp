// The Real-Time Data Exchange protocol, versions 1 and 2: packages, variables and recipes, without sockets.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "examples/simulated_ur5/state.hpp"
#include "examples/simulated_ur5/wire.hpp"

namespace simulated_ur5::rtde {

enum class Package : std::uint8_t {
  request_protocol_version = 'V',
  get_urcontrol_version = 'v',
  text_message = 'M',
  data = 'U',
  setup_outputs = 'O',
  setup_inputs = 'I',
  start = 'S',
  pause = 'P'
};

/// Level of a text message.
enum class Level : std::uint8_t { exception = 0, error = 1, warning = 2, info = 3 };

enum class Type : std::uint8_t {
  boolean,
  uint8,
  uint32,
  uint64,
  int32,
  real,
  vector3,
  vector6,
  vector6_int32,
  vector6_uint32
};
std::string_view type_name(Type type);
std::size_t type_size(Type type);

/// Header included; a package that claims more is refused. Clients send at most a name list of 2048 bytes.
inline constexpr std::size_t largest_request = 4096;
inline constexpr std::size_t longest_name_list = 2048;
inline constexpr std::size_t header_size = 3;

/// Cuts a byte stream into packages.
class Framer {
 public:
  struct Frame {
    std::uint8_t type = 0;
    std::span<const std::uint8_t> payload;  ///< valid until the next call
  };
  /// Takes bytes; at most `room()` of them.
  void feed(std::span<const std::uint8_t> bytes);
  std::size_t room() const { return largest_request - size_; }
  /// The next whole package, if there is one.
  std::optional<Frame> next();
  /// Part of a package is there.
  bool unfinished() const { return size_ > taken_; }
  /// True once a package claimed a size below 3 or above `largest_request`: the stream is lost.
  bool broken() const { return broken_; }

 private:
  std::uint8_t buffer_[largest_request] = {};
  std::size_t size_ = 0, taken_ = 0;
  bool broken_ = false;
};

/// A variable that the robot sends.
struct Output {
  Type type = Type::real;
  void (*write)(const RobotState&, std::size_t index, BigEndianWriter&) = nullptr;
  std::size_t index = 0;
};
/// A variable that clients send. `key` is the same for the same variable.
struct Input {
  Type type = Type::real;
  void (*read)(RobotInputs&, std::size_t index, BigEndianReader&) = nullptr;
  std::size_t index = 0;
  std::size_t key = 0;
};
/// Number of different input keys.
std::size_t input_key_count();

std::optional<Output> find_output(std::string_view name);
std::optional<Input> find_input(std::string_view name);
/// Comma-separated names; one trailing comma is allowed.
std::vector<std::string_view> split_names(std::string_view names);

/// Begins a package in `out`; `finish` writes its size.
class PackageWriter : public BigEndianWriter {
 public:
  PackageWriter(std::vector<std::uint8_t>& out, Package type);
  void finish();

 private:
  std::vector<std::uint8_t>& out_;
  std::size_t start_;
};

/// A text message; both texts are cut at 255 bytes in version 2.
void write_text(std::vector<std::uint8_t>& out, int version, Level level, std::string_view text,
                std::string_view source);

}  // namespace simulated_ur5::rtde
