#include "examples/simulated_ur5/robot_data.hpp"

#include <bit>

namespace simulated_ur5::robot_data {

std::array<std::uint32_t, joint_count> kinematics_checksum() {
  std::array<std::uint32_t, joint_count> sums{};
  for (std::size_t i = 0; i < joint_count; ++i) {
    std::uint32_t crc = 0xffffffffu;
    for (const double parameter : {dh_theta[i], dh_a[i], dh_d[i], dh_alpha[i]})
      for (int byte = 7; byte >= 0; --byte) {
        crc ^= static_cast<std::uint8_t>(std::bit_cast<std::uint64_t>(parameter) >> (8 * byte));
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
      }
    sums[i] = ~crc;
  }
  return sums;
}

}  // namespace simulated_ur5::robot_data
