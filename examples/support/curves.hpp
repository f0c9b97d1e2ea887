// What an example saw over time, drawn when it ends.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "examples/support/svg_plot.hpp"

namespace examples {

/// A curve over time.
struct Curve {
  std::string name;  ///< with its unit, unless the panel says it
  std::vector<double> t{}, y{};
  bool dashed = false;  ///< what is asked, beside what is
  void add(double time, double value) { t.push_back(time), y.push_back(value); }
};

/// Curves that share their axes, so that they can be compared.
struct Panel {
  std::string name;  ///< of the y axis, with its unit
  std::vector<Curve> curves;
  std::vector<plotting::Limit> limits{};
  bool from_zero = true;

  Panel(const Curve& curve) : name(curve.name), curves{curve} {}
  Panel(const Curve& curve, plotting::Limit limit)
      : name(curve.name), curves{curve}, limits{std::move(limit)} {}
  Panel(std::string y_name, std::vector<Curve> shared, std::vector<plotting::Limit> levels = {})
      : name(std::move(y_name)), curves(std::move(shared)), limits(std::move(levels)) {}
  /// The same, with an axis that holds the data only.
  [[nodiscard]] Panel close_up() const {
    Panel panel = *this;
    panel.from_zero = false;
    return panel;
  }
};

/// The stretches of time in which a curve is above zero, to be shaded: while somebody pushes.
inline std::vector<plotting::Band> while_above_zero(const Curve& curve, const std::string& label) {
  std::vector<plotting::Band> bands;
  bool inside = false;
  for (std::size_t i = 0; i < curve.y.size(); ++i) {
    if (curve.y[i] > 0 && !inside) bands.push_back({curve.t[i], curve.t[i], label, ""});
    inside = curve.y[i] > 0;
    if (inside) bands.back().to = curve.t[i];
  }
  return bands;
}

/// Draws panels one below the other over the same time, as an SVG file: at the path given on the command
/// line, or `name` in the working directory; `head` stands above. Returns 0, or 1 if the file cannot be
/// written.
inline int draw(int argc, char** argv, const std::string& name, const std::string& title,
                const std::vector<Panel>& panels, const std::vector<plotting::Band>& bands = {},
                const plotting::Head& head = {}) {
  std::vector<plotting::Plot> plots;
  std::vector<std::string> names;  // a name has its colour in every panel
  const auto color_of = [&](const std::string& curve) {
    const auto at = std::find(names.begin(), names.end(), curve) - names.begin();
    if (at == std::ssize(names)) names.push_back(curve);
    return static_cast<int>(at);
  };
  for (const Panel& panel : panels) {
    plotting::Plot plot;
    plot.y_name = panel.name;
    for (const Curve& c : panel.curves) plot.series.push_back({c.name, c.t, c.y, color_of(c.name), c.dashed});
    plot.limits = panel.limits;
    plot.from_zero = panel.from_zero;
    plot.bands = bands;
    plot.height = 200;
    plots.push_back(std::move(plot));
  }
  const std::string path = argc > 1 ? argv[1] : name;
  return plotting::write_svg(path, plotting::svg_figure(title, plots, head)) ? 0 : 1;
}

}  // namespace examples
