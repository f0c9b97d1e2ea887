// SPDX-License-Identifier: BSD-3-Clause
// What a skin reads under bodies that press and slide: a generator of contacts.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/cell_place.hpp"

namespace skinctl::testing {

/// A round body that presses on a link: Hertz's pressure `sqrt(1 - (r/R)^2)` about `place`.
struct Pressing {
  std::size_t link = 0;
  Xyz<double> place{0.0, 0.0, 0.0};  ///< centre of the true pressure, along the link's axes [m]
  /// Outward normal of the surface there; cells that face away are not touched.
  Xyz<double> normal{0.0, 0.0, 1.0};
  double radius = 0.03;  ///< radius R of the pressed circle [m]
  double force = 10;     ///< force of the body, summed over the cells [N]
};

/// The push on each cell [N], in the order of `cells`: each takes the pressure at its centre, scaled such
/// that the pushes of one body add up to its force. A body between cells, farther than R from any, is not
/// felt.
[[nodiscard]] inline std::vector<double> pushes(std::span<const CellPlace> cells,
                                                std::span<const Pressing> bodies) {
  std::vector<double> push(cells.size()), one(cells.size());
  for (const Pressing& body : bodies) {
    double sum = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Xyz<double> way = cells[i].place - body.place;
      const double part = 1 - dot(way, way) / (body.radius * body.radius);
      const bool felt = cells[i].link == body.link && dot(cells[i].normal, body.normal) > 0.2 && part > 0;
      sum += one[i] = felt ? std::sqrt(part) : 0;
    }
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (one[i] > 0) push[i] += body.force * one[i] / sum;
  }
  return push;
}

/// Samples of all cells whose pushes are given, at `time`, with ids from `first_id` on: the sum of the three
/// readings is the push over `gain` [N], at most 3.
[[nodiscard]] inline std::vector<CellSample> pushed_samples(std::span<const double> push, double gain,
                                                            Nanoseconds time, std::uint32_t first_id = 1) {
  std::vector<CellSample> samples(push.size());
  for (std::size_t i = 0; i < push.size(); ++i) {
    const double each = push[i] / gain / 3;
    const auto reading = static_cast<float>(each < 1 ? each : 1);
    samples[i].cell = first_id + static_cast<std::uint32_t>(i);
    samples[i].time = time;
    samples[i].force = {reading, reading, reading};
  }
  return samples;
}

}  // namespace skinctl::testing
