// XELA uSkin: modules of three-axis taxels, as the maker's server tells them in JSON over a WebSocket.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "examples/adapters/can/link.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/unrest.hpp"

namespace adapters::skin {

/// A taxel by its counts, which every module tells: x and y along its surface, z outward, 0 to 65535, at rest
/// somewhere in the middle. Counts are no forces, and taxels talk across: forces come from a
/// `ChannelCalibration`, see `FrontEnd`: give a skin of taxels none without `calibrated(skin, ...)`.
struct XelaCounts {
  static constexpr std::string_view name = "xela-counts";
  static constexpr std::array readings{skinctl::Reading{"x", 0, 65535}, skinctl::Reading{"y", 0, 65535},
                                       skinctl::Reading{"z", 0, 65535}};
  static constexpr std::array channels{
      skinctl::Channel{"normal", skinctl::ChannelUse::contact, 0b100, 20},
      skinctl::Channel{
          "shear x", skinctl::ChannelUse::contact, 0b001, 20, {1, 0, 0}, {}, skinctl::with_normal},
      skinctl::Channel{
          "shear y", skinctl::ChannelUse::contact, 0b010, 20, {0, 1, 0}, {}, skinctl::with_normal}};
};

/// A taxel by the forces that the server makes of its counts, where the module was calibrated and the server
/// is told so (`calibrated`). Newtons are assumed, and z > 0 for a push: try it before a robot does.
struct XelaForces {
  static constexpr std::string_view name = "xela-forces";
  static constexpr std::array readings{skinctl::Reading{"x", -30, 30}, skinctl::Reading{"y", -30, 30},
                                       skinctl::Reading{"z", -30, 30}};
  static constexpr std::array channels = XelaCounts::channels;
};
template <class K>
concept XelaKind = std::is_same_v<K, XelaCounts> || std::is_same_v<K, XelaForces>;

/// Id of a taxel, from 0 on, of the server's sensor 1, 2 ...: 1024 ids a sensor, so that taxel 3 of sensor 2
/// is 1027.
[[nodiscard]] constexpr std::uint32_t xela_cell(std::uint32_t sensor, std::uint32_t taxel) noexcept {
  return 1024 * (sensor - 1) + taxel;
}

/// What a module tells in one message.
struct XelaModule {
  std::uint32_t sensor = 0;                          ///< 1 to 64: the server's number of it
  std::vector<std::array<std::uint16_t, 3>> counts;  ///< of each taxel
  std::vector<std::array<float, 3>> forces;          ///< of each taxel [N]; none: it is not calibrated
};
struct XelaMessage {
  std::int64_t number = 0;  ///< one more than in the message before
  double time = 0;          ///< of the server's clock, seconds since 1970; 0: not told
  std::vector<XelaModule> modules;
  std::uint32_t refused = 0;  ///< modules that contradict themselves, and are left out
};
/// What a text of the server's is.
enum class XelaText { message, welcome, nonsense };

/// Reads a text: `{"message": 7, "time": s, "1": {"taxels": 16, "data": "8000,7FF0,...", "calibrated": [..]},
/// ...}`. `data` has three numbers of up to four hexadecimal digits a taxel; in its place `integer` may hold
/// them as a list. `calibrated` may be null or missing. At most 64 modules of 1024 taxels; other members are
/// left alone. It allocates; it throws nothing but `std::bad_alloc`.
[[nodiscard]] XelaText parse_xela(std::string_view text, XelaMessage& out);

/// Makes samples of a kind out of messages. Each message is a measurement of all of its taxels.
template <XelaKind Kind>
class XelaSamples {
 public:
  using Sample = skinctl::SensorSample<Kind>;

  /// The taxels of a message, all stamped `time`; of `XelaForces` those of modules that tell forces. Until
  /// the next call.
  [[nodiscard]] std::span<const Sample> of(const XelaMessage& message, skinctl::Nanoseconds time) {
    samples_.clear();
    for (const XelaModule& m : message.modules) {
      const auto& taxels = [&]() -> const auto& {
        if constexpr (std::is_same_v<Kind, XelaCounts>) {
          return m.counts;
        } else {
          return m.forces;
        }
      }();
      for (std::size_t k = 0; k < taxels.size(); ++k) {
        Sample s{.time = time, .cell = xela_cell(m.sensor, static_cast<std::uint32_t>(k)), .readings = {}};
        for (std::size_t r = 0; r < 3; ++r) s.readings[r] = static_cast<float>(taxels[k][r]);
        if (s.cell >= taxels_.size()) taxels_.resize(s.cell + 1);
        unrest_.measure(taxels_[s.cell], s), unrest_.tell(taxels_[s.cell], s);
        samples_.push_back(s);
      }
    }
    return samples_;
  }

 private:
  skinctl::Unrest<Kind> unrest_{1.0 / 60000};  // about one count
  std::vector<typename skinctl::Unrest<Kind>::Memory> taxels_;
  std::vector<Sample> samples_;
};

/// A connection to the maker's server (`xela_server`, port 5000). It sends as the modules measure, about 100
/// times a second, and nothing is sent to it.
class XelaClient {
 public:
  struct Counts {
    std::uint64_t messages = 0;
    std::uint64_t lost = 0;      ///< gaps in the messages' numbers
    std::uint64_t late = 0;      ///< messages whose number is not above the one before, left out
    std::uint64_t nonsense = 0;  ///< texts that are none, and binary messages
    std::uint64_t refused = 0;   ///< modules left out, see `XelaMessage::refused`
  };

  /// Connects. Throws `ConnectionError` where nobody answers within `timeout`, or what answers is no
  /// WebSocket.
  XelaClient(const std::string& host, std::uint16_t port = 5000, Timeout timeout = Timeout(3000));
  ~XelaClient();
  XelaClient(const XelaClient&) = delete;
  XelaClient& operator=(const XelaClient&) = delete;

  /// The next message, waiting for it until `deadline`; nothing: there is none yet, or the server has gone. A
  /// text of more than 1 MB ends the connection.
  [[nodiscard]] const XelaMessage* next(can::Deadline deadline);
  /// The server has gone: make a new client.
  [[nodiscard]] bool closed() const noexcept;
  [[nodiscard]] const Counts& counts() const noexcept;

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace adapters::skin
