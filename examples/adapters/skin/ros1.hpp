// Skin as TUM's ROS 1 nodes send it: the bytes of a message of type SkinCellDataArray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "skinctl/sensing/cell_sample.hpp"

namespace adapters::skin {

/// The type, its sum and its definition, as a connection or a bag says them.
inline constexpr const char* skin_message_type = "tum_ics_skin_msgs/SkinCellDataArray";
inline constexpr const char* skin_message_md5 = "25fa07a551bcc135c5207881df75ddd7";
inline constexpr const char* skin_message_definition =
    "SkinCellData[] data\n"
    "================================================================================\n"
    "MSG: tum_ics_skin_msgs/SkinCellData\n"
    "int32 cellId\nint64 ts\nfloat64[] prox\nfloat64[] force\nfloat64[] acc\nfloat64[] temp\n";

struct Ros1Units {
  double acceleration = 9.80665;  ///< of a unit of `acc` [m/s^2]
  std::size_t max_cells = 16384;  ///< of one message
  std::size_t max_values =
      64;  ///< of one array: cells with more sensors than ours are read, the rest is left
};

/// The samples of a message, in order; their times are the `ts` of the sender. False, and nothing is added,
/// unless all of `bytes` is one message: little-endian, lengths as uint32. Whether a sample is plausible is
/// still to be checked (`skinctl::check`).
bool parse_ros1(std::span<const std::uint8_t> bytes, std::vector<skinctl::CellSample>& out,
                const Ros1Units& units = {});
/// The message of these samples.
[[nodiscard]] std::vector<std::uint8_t> ros1_message(std::span<const skinctl::CellSample> samples,
                                                     const Ros1Units& units = {});

}  // namespace adapters::skin
