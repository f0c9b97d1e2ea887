// What the simulated controllers say they are.
#pragma once

#include <cstdint>
#include <string>

#include "examples/simulated_ur5/controller.hpp"

namespace simulated_ur5 {

struct Version {
  std::uint32_t major = 0, minor = 0, bugfix = 0, build = 0;
};

constexpr Version version_of(Series series) {
  return series == Series::cb3 ? Version{3, 15, 8, 106339} : Version{5, 11, 6, 1010327};
}

inline std::string dotted(const Version& v) {
  return std::to_string(v.major) + "." + std::to_string(v.minor) + "." + std::to_string(v.bugfix) + "." +
         std::to_string(v.build);
}

}  // namespace simulated_ur5
