// The same robot of two UR10e: longer arms that stand further from the box. The plan, and all else, is the same.
#pragma once

#include "examples/packing_oranges/tomm.hpp"

namespace packing {

struct Ur10e {
  using Model = skinctl::ur10e::Model;
  using Description = skinctl::ur10e::Description;
  static constexpr const char* name = "UR10e";
  static constexpr double flange = Description::flange[2];
  static constexpr double stands = 0.8;
  static constexpr double reach = 1.6;
  static constexpr HandRoom room{stands, 0.1807, 0.6127 + 0.57155, 0.17415, 0.11985 + flange};
  static constexpr std::size_t cells[] = {132, 28, 28, 87, 180};
  static constexpr std::array<skinctl::Capsule<>, 6> shapes = {{{{0, 0, 0.04}, {0, 0, 0.18}, 0.075},
                                                                {{-0.07, 0, 0.176}, {-0.54, 0, 0.176}, 0.067},
                                                                {{-0.07, 0, 0.04}, {-0.51, 0, 0.04}, 0.055},
                                                                {{0, 0, 0.05}, {0, 0, 0.17}, 0.055},
                                                                {{0, 0, 0.03}, {0, 0, 0.115}, 0.055},
                                                                {{0, 0, 0.06}, {0, 0, 0.11}, 0.045}}};
};

}  // namespace packing
