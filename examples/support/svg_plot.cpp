#include "examples/support/svg_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

#include "skinctl/core/xml_text.hpp"
#include "skinctl/io/formatted.hpp"

namespace plotting {
namespace {

constexpr double largest = 1e15;
constexpr double font = 13;
constexpr double letter = 8.3;        // advance of a digit at that size in a wide typeface
constexpr double small_letter = 7.2;  // mean advance of a text of 12 units
constexpr double tick_distance = 36;  // of the y axis

bool shown(double v) {
  return std::abs(v) <= largest;  // false for NaN
}

std::string fixed(double v, int decimals) {
  return skinctl::formatted("%.*f", std::clamp(decimals, 0, 15), v);
}
std::string coordinate(double v) {
  return fixed(v, 1);
}

/// Number of characters, not bytes.
double text_width(std::string_view text) {
  return letter * static_cast<double>(
                      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void take(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool empty() const { return low > high; }
  double span() const { return high - low; }
};

struct Ticks {
  double step = 1;
  int decimals = 0;
  std::vector<double> at;
};

/// Round numbers inside the range, about as many as wanted.
Ticks ticks_of(Range r, double wanted) {
  Ticks ticks;
  const double raw = r.span() / std::max(wanted, 1.0);
  const double magnitude = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    ticks.step = factor * magnitude;
    if (ticks.step >= raw * 0.999) break;
  }
  ticks.decimals = std::max(0, static_cast<int>(-std::floor(std::log10(ticks.step) + 1e-9)));
  const double first = std::ceil(r.low / ticks.step - 1e-9), last = std::floor(r.high / ticks.step + 1e-9);
  for (double k = first; k <= last && ticks.at.size() < 40; ++k)
    ticks.at.push_back(k == 0 ? 0 : k * ticks.step);
  return ticks;
}

std::string tick_text(double v, const Ticks& ticks) {
  if (std::abs(v) >= 1e6 || ticks.decimals > 6) return significant(v, 4);
  return decimal(v, ticks.decimals);
}

/// A path in tenths of a unit: integers and relative steps keep it short.
class Path {
 public:
  void move(double x, double y) {
    finish();
    x_ = round(x), y_ = round(y);
    text_ += 'M' + std::to_string(x_) + ' ' + std::to_string(y_);
    open_ = true, drawn_ = false;
  }
  void line(double x, double y) {
    if (!open_) return move(x, y);
    const long dx = round(x) - x_, dy = round(y) - y_;
    if (dx == 0 && dy == 0) return;
    if (dy == 0 && dx > 0) {  // along a flat stretch only its end counts
      flat_ += dx;
      x_ += dx;
      return;
    }
    flush();
    text_ += 'l' + std::to_string(dx) + (dy < 0 ? "" : " ") + std::to_string(dy);
    x_ += dx, y_ += dy;
    drawn_ = true;
  }
  void gap() {
    finish();
    open_ = false;
  }
  std::string text() {
    finish();
    return text_;
  }

 private:
  static long round(double v) { return std::lround(10 * v); }
  void flush() {
    if (flat_ == 0) return;
    text_ += 'h' + std::to_string(flat_);
    flat_ = 0;
    drawn_ = true;
  }
  void finish() {
    flush();
    if (open_ && !drawn_) text_ += "h0", drawn_ = true;  // a lone sample is a dot
  }
  std::string text_;
  long x_ = 0, y_ = 0, flat_ = 0;
  bool open_ = false, drawn_ = false;
};

/// Where numbers lie in the picture.
struct Frame {
  double left = 0, top = 0, width = 1, height = 1;
  Range x, y;
  double px(double v) const { return left + width * std::clamp((v - x.low) / x.span(), 0.0, 1.0); }
  double py(double v) const { return top + height * (1 - std::clamp((v - y.low) / y.span(), 0.0, 1.0)); }
};

std::string path_of(const Series& s, const Frame& f) {
  Path path;
  const std::size_t n = std::min(s.x.size(), s.y.size());
  const bool every = static_cast<double>(n) <= 2 * f.width;
  struct Extreme {
    double x = 0, y = 0;
    std::size_t index = 0;
  } low, high;
  long column = -1;
  const auto flush = [&] {
    if (column < 0) return;
    const Extreme& first = low.index <= high.index ? low : high;
    const Extreme& second = low.index <= high.index ? high : low;
    path.line(f.px(first.x), f.py(first.y));
    path.line(f.px(second.x), f.py(second.y));
    column = -1;
  };
  for (std::size_t i = 0; i < n; ++i) {
    const double x = s.x[i], y = s.y[i];
    if (!shown(x) || !shown(y)) {
      flush();
      path.gap();
      continue;
    }
    if (every) {
      path.line(f.px(x), f.py(y));
      continue;
    }
    const long here = std::lround(std::floor(f.px(x)));
    if (here != column) {
      flush();
      column = here;
      low = high = {x, y, i};
    }
    if (y < low.y) low = {x, y, i};
    if (y > high.y) high = {x, y, i};
  }
  flush();
  return path.text();
}

std::string text(std::string_view cls, double x, double y, std::string_view anchor, std::string_view what) {
  std::string out = "<text";
  if (!cls.empty()) out += " class=\"" + std::string(cls) + '"';
  out += " x=\"" + coordinate(x) + "\" y=\"" + coordinate(y) + '"';
  if (anchor != "start") out += " text-anchor=\"" + std::string(anchor) + '"';
  return out + '>' + skinctl::xml_text(what) + "</text>";
}

std::string line(std::string_view cls, double x1, double y1, double x2, double y2) {
  return "<path class=\"" + std::string(cls) + "\" d=\"M" + coordinate(x1) + ' ' + coordinate(y1) + 'L' +
         coordinate(x2) + ' ' + coordinate(y2) + "\"/>";
}

std::string class_of(const Series& s, std::size_t place) {
  const int color = s.color >= 0 ? s.color % 8 : static_cast<int>(place % 8);
  return 's' + std::to_string(color) + (s.dashed ? " dashed" : "");
}

Range x_range(const Plot& plot) {
  Range r;
  for (const Series& s : plot.series)
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
      if (shown(s.x[i])) r.take(s.x[i]);
  if (r.empty()) r = {0, 1};
  if (r.span() < 1e-9 * std::max(1.0, std::abs(r.low)))
    r.high = r.low + std::max(1.0, 1e-6 * std::abs(r.low));
  return r;
}

/// The data, and zero if the plot wants it.
Range y_data(const Plot& plot) {
  Range r;
  if (plot.from_zero) r = {0, 0};
  for (const Series& s : plot.series)
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
      if (shown(s.x[i]) && shown(s.y[i])) r.take(s.y[i]);
  return r;
}

/// A limit so far beyond the data that the axis does not reach it.
bool off_scale(const Limit& limit, const Range& data) {
  const double reach = std::max({std::abs(data.low), std::abs(data.high), 1e-12});
  return data.empty() || std::abs(limit.value) > 3 * reach;
}

double axis_height(const Plot& plot);

/// The data and the limits on scale, from tick to tick.
Range y_range(const Plot& plot) {
  Range r = y_data(plot);
  if (r.empty() || std::max(std::abs(r.low), std::abs(r.high)) < 1e-12) return {-1, 1};
  const Range data = r;
  for (const Limit& limit : plot.limits)
    if (shown(limit.value) && !off_scale(limit, data)) r.take(limit.value);
  if (r.span() < 1e-9 * std::abs(r.high)) r = {r.low - std::abs(r.low), r.high + std::abs(r.high)};
  // What is beyond a tick by a pixel or so does not take another one.
  constexpr double pixel = 0.03;
  Range whole = r;
  for (int k = 0; k < 3; ++k) {
    const double step = ticks_of(whole, axis_height(plot) / tick_distance).step;
    whole = {step * std::floor(r.low / step + pixel), step * std::ceil(r.high / step - pixel)};
    if (whole.empty() || whole.span() < 0.5 * step)
      whole = {step * std::floor(r.low / step), step * std::ceil(r.high / step)};
  }
  return whole;
}

std::string drawn_bands(const Plot& plot, const Frame& f) {
  std::string out;
  double free = f.left;
  for (const Band& band : plot.bands) {
    if (!shown(band.from) || !shown(band.to) || band.to < f.x.low || band.from > f.x.high) continue;
    const double from = f.px(band.from), to = std::max(f.px(band.to), from + 1);
    out += "<rect class=\"band\" x=\"" + coordinate(from) + "\" y=\"" + coordinate(f.top) + "\" width=\"" +
           coordinate(to - from) + "\" height=\"" + coordinate(f.height) + "\">";
    if (!band.tooltip.empty()) out += "<title>" + skinctl::xml_text(band.tooltip) + "</title>";
    out += "</rect>";
    const double half = text_width(band.label) / 2, middle = (from + to) / 2;
    if (band.label.empty() || middle - half < free || middle + half > f.left + f.width) continue;
    out += text("mark", middle, f.top - 4, "middle", band.label);
    free = middle + half + 4;
  }
  return out;
}

std::string drawn_limits(const Plot& plot, const Frame& f) {
  std::string out;
  const double right = f.left + f.width - 4;
  std::vector<Limit> limits = plot.limits;
  const Range data = y_data(plot);
  std::erase_if(limits, [&](const Limit& limit) { return !shown(limit.value) || off_scale(limit, data); });
  std::stable_sort(limits.begin(), limits.end(),
                   [](const Limit& a, const Limit& b) { return a.value > b.value; });
  struct Place {
    double base, left;
  };
  std::vector<Place> taken;
  for (const Limit& limit : limits) {
    const double y = f.py(limit.value);
    out += line("limit", f.left, y, f.left + f.width, y);
    if (limit.name.empty()) continue;
    const double width = text_width(limit.name), lower = y + font + 1;
    Place place{y < f.top + font + 6 ? lower : y - 4, right};
    // Beside the texts that are at this height; where there is no room, below them.
    for (const Place& other : taken) {
      if (std::abs(other.base - place.base) >= font + 2) continue;
      if (other.left - 16 - width > f.left)
        place.left = std::min(place.left, other.left - 16);
      else
        place = {std::max(other.base + font + 3, lower), right};
    }
    out += text("warn", place.left, place.base, "end", limit.name);
    taken.push_back({place.base, place.left - width});
  }
  return out;
}

bool has_marks(const Plot& plot) {
  return std::any_of(plot.bands.begin(), plot.bands.end(), [](const Band& b) { return !b.label.empty(); });
}
std::vector<std::string> wrapped(const std::string& text, double columns);

/// What is said of limits that are not drawn.
std::string off_scale_words(const Plot& plot) {
  const Range data = y_data(plot);
  std::string words;
  for (const Limit& limit : plot.limits)
    if (shown(limit.value) && off_scale(limit, data) && !limit.name.empty())
      words += (words.empty() ? "off scale: " : "; ") + limit.name;
  return words;
}
/// Whether these words have room beside the name of the axis.
bool beside_name(const Plot& plot, const std::string& words) {
  return text_width(plot.y_name) + 20 + text_width(words) < plot.width - 12;
}
/// Or else the rows that they take below it.
std::vector<std::string> off_scale_rows(const Plot& plot) {
  const std::string words = off_scale_words(plot);
  if (words.empty() || beside_name(plot, words)) return {};
  return wrapped(words, plot.width / small_letter);
}

/// Heights above and below the axes, for names, marks and numbers.
double head_of(const Plot& plot) {
  return (1 + static_cast<double>(off_scale_rows(plot).size())) * (font + 4) +
         (has_marks(plot) ? font + 9 : 14);
}
double foot_of(const Plot& plot) {
  return (plot.x_name.empty() ? 1 : 2) * font + 10;
}
double axis_height(const Plot& plot) {
  return std::max(plot.height - head_of(plot) - foot_of(plot), 20.0);
}

/// Room that the numbers of the y axis need.
double margin_of(const Plot& plot) {
  const Ticks ticks = ticks_of(y_range(plot), axis_height(plot) / tick_distance);
  double widest = 0;
  for (const double v : ticks.at) widest = std::max(widest, text_width(tick_text(v, ticks)));
  return widest + 10;
}

/// Axes, bands, curves and limits inside the rectangle (0, top, plot.width, plot.height).
std::string panel(const Plot& plot, double top, double margin) {
  Range x = x_range(plot);
  const Range y = y_range(plot);
  Frame f;
  f.x = x, f.y = y;
  f.top = top + head_of(plot);
  f.height = axis_height(plot);
  const Ticks y_ticks = ticks_of(y, f.height / tick_distance);
  f.left = margin;
  f.width = std::max(plot.width - f.left - 12, 20.0);
  // A run from 0.008 to 59.998 s begins at the tick of 0 s and ends at that of 60 s.
  const double step = ticks_of(x, f.width / 64).step, next = step * std::ceil(x.high / step - 1e-9),
               before = step * std::floor(x.low / step + 1e-9);
  const double close = 0.01 * x.span();
  if (next - x.high < close) f.x.high = x.high = next;
  if (x.low - before < close) f.x.low = x.low = before;
  const Ticks x_ticks = ticks_of(x, f.width / 64);
  const double right = f.left + f.width, bottom = f.top + f.height;

  std::string out = drawn_bands(plot, f);
  for (const double v : y_ticks.at) {
    out += line(v == 0 ? "zero" : "grid", f.left, f.py(v), right, f.py(v));
    out += text("", f.left - 6, f.py(v) + font / 3, "end", tick_text(v, y_ticks));
  }
  double free = -1e9;
  for (const double v : x_ticks.at) {
    const std::string number = tick_text(v, x_ticks);
    const double half = text_width(number) / 2,
                 at = std::clamp(f.px(v), f.left, std::max(f.left, plot.width - half));
    out += line("tick", f.px(v), bottom, f.px(v), bottom + 4);
    if (at - half < free) continue;
    out += text("", at, bottom + font + 5, "middle", number);
    free = at + half + 6;
  }
  out += line("axis", f.left, bottom, right, bottom);
  out += text("name", 0, top + font, "start", plot.y_name);
  if (const std::string words = off_scale_words(plot); !words.empty() && beside_name(plot, words))
    out += text("warn", right, top + font, "end", words);
  double row_at = top + font;
  for (const std::string& row : off_scale_rows(plot))
    out += text("warn", 0, row_at += font + 4, "start", row);
  out += text("name", right, bottom + 2 * font + 8, "end", plot.x_name);
  out += "<g class=\"curves\" transform=\"scale(.1)\">";
  bool any = false;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const std::string d = path_of(plot.series[i], f);
    if (d.empty()) continue;
    any = true;
    out += "<path class=\"" + class_of(plot.series[i], i) + "\" d=\"" + d + "\"/>";
  }
  out += "</g>" + drawn_limits(plot, f);
  if (!any) out += text("name", (f.left + right) / 2, (f.top + bottom) / 2 - 8, "middle", "nothing to show");
  return out;
}

std::string opening(double width, double height, std::string_view label, bool file) {
  std::string out = "<svg class=\"sp\"";
  if (file)
    out += " xmlns=\"http://www.w3.org/2000/svg\" width=\"" + coordinate(width) + "\" height=\"" +
           coordinate(height) + '"';
  return out + " viewBox=\"0 0 " + coordinate(width) + ' ' + coordinate(height) +
         "\" role=\"img\" aria-label=\"" + skinctl::xml_text(label) + "\">";
}

/// Rows of at most so many characters, broken at blanks.
std::vector<std::string> wrapped(const std::string& text, double columns) {
  std::vector<std::string> rows;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (rows.empty() || text_width(rows.back() + ' ' + word) > letter * columns)
      rows.push_back(word);
    else
      rows.back() += ' ' + word;
    at = end + 1;
  }
  return rows;
}

struct Block {
  std::string text;
  double height = 0;
};

/// Line and name of each series, in as many rows as needed.
Block legend(const Plot& plot, double top) {
  Block block;
  if (plot.series.size() < 2) return block;
  double x = 0, y = top + font;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const double width = 24 + text_width(plot.series[i].name) + 14;
    if (x > 0 && x + width > plot.width) x = 0, y += font + 6;
    block.text += "<g class=\"key\">" + line(class_of(plot.series[i], i), x, y - 4, x + 18, y - 4) + "</g>" +
                  text("", x + 24, y, "start", plot.series[i].name);
    x += width;
  }
  block.height = y + 8 - top;
  return block;
}

// At least 3:1 on their page, and any two apart by 0.09 in OKLab with every kind of colour vision.
constexpr std::array<const char*, 8> light{"#1662d2", "#d1580a", "#052a00", "#b07adc",
                                           "#432873", "#7d4700", "#270d2b", "#af508e"};
constexpr std::array<const char*, 8> dark{"#58a6ff", "#f0883e", "#b8f0c0", "#8250df",
                                          "#ffdc53", "#d32e60", "#ffffff", "#6f8f9d"};

}  // namespace

std::string decimal(double value, int decimals) {
  if (!std::isfinite(value)) return "\u2013";
  if (std::abs(value) >= largest) return significant(value, 4);
  std::string number = fixed(std::abs(value), decimals);
  const bool zero = number.find_first_not_of("0.") == std::string::npos;
  return value < 0 && !zero ? "\u2212" + number : number;
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "\u2013";
  const double size = std::abs(value);
  std::string number = skinctl::formatted("%.*e", std::max(digits - 1, 0), size);
  if (size == 0 || (size >= 1e-6 && size < 1e7)) {
    // Rounding may carry into a new digit: 9.996 with three digits is 10.0.
    const int exponent = size > 0 ? std::atoi(number.substr(number.find('e') + 1).c_str()) : 0;
    number = skinctl::formatted("%.*f", std::max(digits - 1 - exponent, 0), size);
  }
  return value < 0 ? std::string("\u2212") + number : number;
}

std::string plot_style() {
  const auto colors = [](const std::array<const char*, 8>& of, const char* ink, const char* soft,
                         const char* grid, const char* band, const char* warn, const char* halo) {
    std::string out = std::string(".sp text{fill:") + soft + "}.sp .name,.sp .head{fill:" + ink +
                      "}.sp .grid{stroke:" + grid + "}.sp .axis,.sp .tick,.sp .zero{stroke:" + soft +
                      "}.sp .band{fill:" + band + "}.sp .limit{stroke:" + warn + "}.sp .warn{fill:" + warn +
                      ";stroke:" + halo + '}';
    for (std::size_t i = 0; i < of.size(); ++i)
      out += ".sp .s" + std::to_string(i) + "{stroke:" + of[i] + '}';
    return out;
  };
  return ".sp{font:13px system-ui,-apple-system,\"Segoe UI\",Roboto,\"DejaVu Sans\",sans-serif}"
         ".sp path{fill:none}.sp .grid,.sp .tick,.sp .axis{stroke-width:1}.sp "
         ".zero{stroke-width:1;opacity:.7}"
         ".sp .band{fill-opacity:.2}.sp .mark,.sp .warn{font-size:12px}.sp "
         ".head{font-size:16px;font-weight:600}"
         ".sp .limit{stroke-width:1.5;stroke-dasharray:6 4}.sp .warn{paint-order:stroke;stroke-width:4;"
         "stroke-linejoin:round;stroke-opacity:.8}.sp .key path{stroke-width:3}"
         ".sp .curves path{stroke-width:16;stroke-linejoin:round;stroke-linecap:round}"
         ".sp .curves .dashed{stroke-dasharray:60 50}.sp .key .dashed{stroke-dasharray:5 4}" +
         colors(light, "#1f2328", "#57606a", "#e4e8ec", "#e3a008", "#c0262d", "#fff") +
         "@media(prefers-color-scheme:dark){" +
         colors(dark, "#e6edf3", "#9da7b3", "#262d36", "#d29922", "#ff7b72", "#151b23") + '}';
}

std::string inline_svg(const Plot& plot) {
  return opening(plot.width, plot.height, plot.title, false) + panel(plot, 0, margin_of(plot)) + "</svg>";
}

std::string svg_figure(const std::string& title, const std::vector<Plot>& plots, const Head& head) {
  std::string body;
  double y = 0, width = 200;
  for (const Plot& plot : plots) width = std::max(width, plot.width);
  double margin = 0;
  for (const Plot& plot : plots) margin = std::max(margin, margin_of(plot));
  for (const std::string& row : wrapped(title, width / (letter * 1.3))) {
    body += text("head", 0, y + 18, "start", row);
    y += 22;
  }
  if (y > 0) y += 10;
  if (head.height > 0)
    body += "<g transform=\"translate(0 " + coordinate(y) + ")\">" + head.svg + "</g>", y += head.height + 6;
  for (const Plot& plot : plots) {
    if (!plot.title.empty() && plot.title != title) {
      body += text("head", 0, y + font + 3, "start", plot.title);
      y += font + 15;
    }
    const Block keys = legend(plot, y);
    body += keys.text;
    y += keys.height;
    body += panel(plot, y, margin);
    y += plot.height + 6;
  }
  return opening(width, std::max(y, 20.0), title, true) + "<style>" + plot_style() + head.style + "</style>" +
         body + "</svg>\n";
}

bool write_svg(const std::string& path, const std::string& svg) {
  std::ofstream file(path);
  file << svg;
  const bool written = static_cast<bool>(file.flush());
  std::fprintf(written ? stdout : stderr, written ? "wrote %s\n" : "cannot write %s\n", path.c_str());
  return written;
}

std::string svg_plot(const Plot& plot) {
  return svg_figure(plot.title, {plot});
}

}  // namespace plotting
