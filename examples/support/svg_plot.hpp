// Plots over time as SVG: series, axes, shaded bands, limits. No script, no font, no file beside it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace plotting {

/// A curve. Numbers that are not finite (or beyond 1e15) are gaps.
struct Series {
  std::string name;
  std::vector<double> x;  ///< ascending
  std::vector<double> y;  ///< as long as `x`; what is longer is left out
  int color = -1;         ///< 0 to 7; -1: its place among the series
  bool dashed = false;    ///< for what is asked, beside what is
};

/// A shaded stretch of the x axis.
struct Band {
  double from = 0, to = 0;
  std::string label;    ///< short, above the plot
  std::string tooltip;  ///< shown by browsers under the pointer
};

/// A level that the series should be compared with: a line. A level more than three times beyond the data
/// would flatten it; it is said in words above the plot and not drawn.
struct Limit {
  double value = 0;
  std::string name;  ///< empty: the line has no text
};

/// All that a plot shows. Series of any length: per pixel column the smallest and the largest value are kept,
/// so that no peak vanishes. The y axis ends at ticks; the x axis does where the data comes close to one.
/// Any two of the eight colours differ for the colour-blind as well.
struct Plot {
  std::string title;
  std::string x_name = "time [s]";
  std::string y_name;
  std::vector<Series> series;
  std::vector<Band> bands;
  std::vector<Limit> limits;
  double width = 960, height = 300;  ///< of the view box; text is 13 units high
  bool from_zero = true;             ///< the y axis holds 0; else the data only
};

/// A complete SVG file with title and legend, in the light or dark colours that its viewer prefers.
std::string svg_plot(const Plot& plot);

/// A drawing between title and plots.
struct Head {
  std::string svg;    ///< elements, from (0, 0) down to the height
  std::string style;  ///< their style sheet
  double height = 0;
};

/// Several plots, one below the other, as one SVG file.
std::string svg_figure(const std::string& title, const std::vector<Plot>& plots, const Head& head = {});

/// Writes a picture to a file, and prints where it is; or, on the error output, that it cannot: false.
[[nodiscard]] bool write_svg(const std::string& path, const std::string& svg);

/// Only the axes and curves, for a page that has `plot_style()` and shows title and legend itself. Curves
/// carry the classes `s0` to `s7`.
std::string inline_svg(const Plot& plot);

/// Style sheet of the above; every rule begins with `.sp`.
std::string plot_style();

/// A number with so many decimals, with a true minus sign; a dash when it is not finite.
std::string decimal(double value, int decimals);

/// A number with so many significant digits, never in powers of ten below 1e7; a dash when it is not finite.
std::string significant(double value, int digits);

}  // namespace plotting
