// What an example saw over time, drawn when it ends.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "examples/support/svg_plot.hpp"

namespace examples {

/// A curve over time; its unit stands in its name.
struct Curve {
  std::string name;
  std::vector<double> t, y;
  void add(double time, double value) { t.push_back(time), y.push_back(value); }
};

/// Draws curves, each on its own axes, as an SVG file: at the path given on the command line, or `name` in
/// the working directory. Returns 0, or 1 if the file cannot be written.
inline int draw(int argc, char** argv, const std::string& name, const std::string& title,
                const std::vector<Curve>& curves) {
  std::vector<plotting::Plot> plots;
  for (const Curve& c : curves) {
    plotting::Plot plot;
    plot.y_name = c.name;
    plot.series = {{c.name, c.t, c.y, static_cast<int>(plots.size())}};
    plot.height = 190;
    plots.push_back(plot);
  }
  const std::string path = argc > 1 ? argv[1] : name;
  return plotting::write_svg(path, plotting::svg_figure(title, plots)) ? 0 : 1;
}

}  // namespace examples
