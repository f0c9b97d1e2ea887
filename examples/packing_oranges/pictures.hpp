// The pictures of the report, as SVG to put into a page with `picture_style()` and `plotting::plot_style()`.
#pragma once

#include <string>

#include "examples/packing_oranges/run.hpp"

namespace packing {

std::string picture_style();
std::string picture_from_above(const Outcome& outcome);
std::string picture_of_time(const Outcome& outcome, const RunSettings& settings);
std::string picture_of_judgement(const Outcome& outcome, const RunSettings& settings);
std::string picture_of_force(const Outcome& outcome);

}  // namespace packing
