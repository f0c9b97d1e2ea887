// Datagrams of KUKA's Robot Sensor Interface: XML, one each way a cycle.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace adapters::rsi {

inline constexpr std::size_t longest = 2048;  ///< bytes of a datagram

/// From the controller: degrees, newtons.
struct Rob {
  std::array<double, 6> actual{};    ///< AIPos, measured axes
  std::array<double, 6> setpoint{};  ///< ASPos, where the axes were told to be
  std::array<double, 6> wrench{};    ///< FT X Y Z A B C, of a sensor that the user's configuration sends
  std::uint64_t ipoc = 0;
  std::uint32_t late = 0;  ///< Delay D: answers that came too late
  unsigned axes = 0;       ///< A1 to An of AIPos
  bool has_setpoint = false, has_wrench = false, has_late = false;
};
/// To the controller.
struct Sen {
  std::array<double, 6> correction{};  ///< AK [deg]
  std::uint64_t ipoc = 0;              ///< as it came
  bool stop = false;                   ///< ends the motion there
};

/// False for what is no such XML: names in any case and order, others passed over; numbers finite, |number|
/// <= 1e6.
bool parse(std::string_view xml, Rob& out) noexcept;
bool parse(std::string_view xml, Sen& out) noexcept;
/// The number of characters written; 0: there was no room.
std::size_t print(const Rob& rob, std::span<char> to) noexcept;
/// @param type  SENTYPE of the user's configuration.
std::size_t print(const Sen& sen, std::string_view type, std::span<char> to) noexcept;

}  // namespace adapters::rsi
