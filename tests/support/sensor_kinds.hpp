// Kinds of sensors besides the hexagon.
#pragma once

#include <array>

#include "skinctl/sensing/cell_sample.hpp"

namespace skinctl::testing {

/// A three-axis taxel in newtons, with a temperature.
struct Uskin {
  static constexpr std::string_view name = "uskin-1";
  static constexpr std::array readings{Reading{"x", -20, 20}, Reading{"y", -20, 20}, Reading{"z", 0, 20},
                                       Reading{"temperature", -40, 120}};
  static constexpr std::array channels{
      Channel{"normal", ChannelUse::contact, 0b100, 20},
      Channel{"shear x", ChannelUse::contact, 0b001, 20, {1, 0, 0}, {}, with_normal},
      Channel{"shear y", ChannelUse::contact, 0b010, 20, {0, 1, 0}, {}, with_normal},
      Channel{"temperature", ChannelUse::told, 0b1000}};
};

/// A hexagon whose three forces act where they are measured, 10 mm from its centre.
struct HexagonApart {
  static constexpr double far = 0.01, half = 0.005, side = 0.00866025403784438647;
  static constexpr std::string_view name = "hexagon-apart";
  static constexpr std::array readings{Reading{"force 1"}, Reading{"force 2"}, Reading{"force 3"},
                                       Reading{"proximity"}};
  static constexpr std::array channels{
      Channel{"force 1", ChannelUse::contact, 0b0001, 1, {0, 0, -1}, {far, 0, 0}},
      Channel{"force 2", ChannelUse::contact, 0b0010, 1, {0, 0, -1}, {-half, side, 0}},
      Channel{"force 3", ChannelUse::contact, 0b0100, 1, {0, 0, -1}, {-half, -side, 0}},
      Channel{"proximity", ChannelUse::seen, 0b1000, 1}};
};

/// A distance sensor: what it sees is near where the reading is 0.2.
struct Nearness {
  static constexpr std::string_view name = "nearness-1";
  static constexpr std::array readings{Reading{"nearness", 0, 0.2}};
  static constexpr std::array channels{Channel{"nearness", ChannelUse::seen, 0b1, 0.2}};
};

}  // namespace skinctl::testing
