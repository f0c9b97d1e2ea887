// The two generations of the simulated controller, and what each says it is.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace simulated_ur5 {

/// CB3: 125 Hz, PolyScope 3. e-Series: 500 Hz, PolyScope 5.
enum class Series { cb3, e_series };

struct Version {
  std::uint32_t major = 0, minor = 0, bugfix = 0, build = 0;

  friend constexpr auto operator<=>(const Version&, const Version&) = default;
};

constexpr Version version_of(Series series) {
  return series == Series::cb3 ? Version{3, 15, 8, 106339} : Version{5, 25, 1, 1032100};
}

/// From these versions on a program may command joint torques, and scale the friction's compensation.
inline constexpr Version direct_torque_since{5, 23, 0, 0}, friction_scales_since{5, 25, 1, 0};

inline std::string dotted(const Version& v) {
  return std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.bugfix) + "." +
         std::to_string(v.build);
}

}  // namespace simulated_ur5
