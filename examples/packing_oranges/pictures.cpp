#include "examples/packing_oranges/pictures.hpp"

#include <algorithm>
#include <cmath>

#include "examples/support/svg_plot.hpp"
#include "examples/support/text.hpp"

namespace packing {
using examples::text;
namespace {
std::string opened(double width, double height) {
  return text("<svg class=\"po\" viewBox=\"0 0 %.0f %.0f\" role=\"img\">", width, height);
}
constexpr double shown = 60;  // the minute that is drawn [s]

/// One colour for a kind of step.
const char* colour(const Done& d) {
  if (d.asks) return "#222";
  if (d.back) return "#d33";
  using namespace skinctl;
  const auto does = [&](const auto&... rule) { return ((d.does == &rule) || ...); };
  if (does(activity::Look::rule, activity::Find::rule)) return "#bbb";
  if (does(activity::ReachAbove::rule, activity::Reach::rule, GoBack::rule)) return "#6aaed6";
  if (does(activity::Take::rule, activity::Release::rule)) return "#3f7f5f";
  return does(activity::Squeeze::rule) ? "#8e5bb5" : "#e8912d";
}
}  // namespace

std::string picture_style() {
  return ".po text{font:13px system-ui,sans-serif;fill:currentColor}.po .line{fill:none;stroke:currentColor;"
         "stroke-opacity:.35}.po .a{fill:none;stroke:#2b7bba;stroke-width:1.1;stroke-opacity:.6}"
         ".po .b{fill:none;stroke:#c2571a;stroke-width:1.1;stroke-opacity:.6}\n";
}

std::string picture_from_above(const Outcome& o) {
  constexpr double width = 900, height = 640, scale = 560;
  const auto X = [](double x) { return width / 2 + scale * x; };
  const auto Y = [](double y) { return height / 2 - scale * y; };
  std::string out = opened(width, height);
  const auto tray = [&](const Tray& t, const char* name) {
    out += text(
        "<rect class=\"line\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/><text x=\"%.1f\" "
        "y=\"%.1f\">%s</text>",
        X(t.x - t.half_x), Y(t.y + t.half_y), 2 * scale * t.half_x, 2 * scale * t.half_y,
        X(t.x - t.half_x) + 4, Y(t.y - t.half_y) - 5, name);
  };
  tray(box_tray, "box");
  for (std::size_t a = 0; a < arms; ++a) {
    tray(bin_tray(a), a == 0 ? "bin of arm 1" : "bin of arm 2");
    tray(feed_tray(a), a == 0 ? "oranges for arm 1" : "oranges for arm 2");
    std::string points;
    for (const auto& p : o.arm[a].path)
      if (p.t < shown) points += text("%.1f,%.1f ", X(p.x), Y(p.y));
    out += text("<polyline class=\"%c\" points=\"", a == 0 ? 'a' : 'b') + points + "\"/>";
    for (const auto& p : o.arm[a].path)
      if (p.t < shown && p.touched)
        out += text("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"1.6\" fill=\"#d33\"/>", X(p.x), Y(p.y));
    out += text("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">arm %zu</text>", a == 0 ? 8.0 : width - 8,
                height / 2, a == 0 ? "start" : "end", a + 1);
  }
  out += text(
      "<line x1=\"%.0f\" x2=\"%.0f\" y1=\"%.0f\" y2=\"%.0f\" stroke=\"currentColor\"/><text x=\"%.0f\" "
      "y=\"%.0f\">0.2 m; red: touched</text>",
      10.0, 10 + 0.2 * scale, height - 10, height - 10, 16 + 0.2 * scale, height - 6);
  return out + "</svg>";
}

std::string picture_of_time(const Outcome& o, const RunSettings& s) {
  constexpr double width = 900, left = 60, row = 18, gap = 12, scale = (width - left - 30) / shown;
  // The minutes of the beginning and, with a fault, of its course.
  const double from = s.fault == Fault::none ? 0 : std::max(0.0, o.fault_begins - 10);
  const int lines = static_cast<int>(std::clamp(std::ceil((o.time - from) / shown), 1.0, 3.0));
  const double height = lines * (2 * row + gap + 16) + 34;
  std::string out = opened(width, height);
  for (int k = 0; k < lines; ++k) {
    const double begin = from + shown * k, y = k * (2 * row + gap + 16);
    for (std::size_t a = 0; a < arms; ++a) {
      const double top = y + row * static_cast<double>(a);
      out += text("<text x=\"0\" y=\"%.1f\">arm %zu</text>", top + 13, a + 1);
      for (const Done& d : o.arm[a].done) {
        const double x1 = std::max(d.from, begin), x2 = std::min(d.to, begin + shown);
        if (x2 <= x1) continue;
        out += text(
            "<rect x=\"%.2f\" y=\"%.1f\" width=\"%.2f\" height=\"%.1f\" fill=\"%s\"><title>%s, %.2f to %.2f "
            "s%s%s</title></rect>",
            left + scale * (x1 - begin), top, std::max(0.4, scale * (x2 - x1) - 0.4), row - 2, colour(d),
            d.asks   ? "asks"
            : d.back ? "back"
                     : name_of(s.work.plan, d.step),
            d.from, d.to, d.why == skinctl::StepFailure::none ? "" : ": ",
            d.why == skinctl::StepFailure::none ? "" : skinctl::describe(d.why));
      }
    }
    for (int t = 0; t <= 60; t += 10)
      out += text("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%.0f s</text>", left + scale * t,
                  y + 2 * row + 13, begin + t);
    const double f1 = std::max(o.fault_begins, begin), f2 = std::min(o.fault_ends, begin + shown);
    if (s.fault != Fault::none && f2 > f1)
      out +=
          text("<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#d33\" stroke-width=\"3\"/>",
               left + scale * (f1 - begin), left + scale * (f2 - begin), y + 2 * row, y + 2 * row);
  }
  double x = left;
  const double y = height - 6;
  const auto key = [&](const Done& d, const char* words) {
    out += text(
        "<rect x=\"%.1f\" y=\"%.1f\" width=\"12\" height=\"12\" fill=\"%s\"/><text x=\"%.1f\" "
        "y=\"%.1f\">%s</text>",
        x, y - 11, colour(d), x + 16, y, words);
    x += 120;
  };
  key({.does = &skinctl::activity::Look::rule}, "look");
  key({.does = &skinctl::activity::Reach::rule}, "reach, go back");
  key({.does = &skinctl::activity::Take::rule}, "take, release");
  key({.does = &skinctl::activity::Squeeze::rule}, "squeeze");
  key({.does = &Lift::rule}, "lift and put");
  key({.back = true}, "failed: back");
  key({.asks = true}, "asks");
  return out + "</svg>";
}

std::string picture_of_judgement(const Outcome& o, const RunSettings& s) {
  constexpr double width = 900, height = 360, left = 60, bottom = 40, most = 9000;
  const auto X = [](double k) { return left + (width - left - 20) * k / most; };
  const auto Y = [](double k) { return height - bottom - (height - bottom - 10) * k / most; };
  std::string out = opened(width, height);
  out += text("<line class=\"line\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>", X(0), Y(0), X(most),
              Y(most));
  const double sides = s.work.presses ? 1 / press_tells : 2;  // of an orange that give
  for (std::size_t i = 0; i < s.work.plan.border_count; ++i)
    out += text("<line x1=\"%.1f\" x2=\"%.1f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#8e5bb5\"/>", X(0), X(most),
                Y(sides * s.work.plan.borders[i]), Y(sides * s.work.plan.borders[i]));
  for (int k = 0; k <= 9000; k += 3000) {
    out +=
        text("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%d</text>", X(k), height - bottom + 18, k);
    out += text("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%d</text>", left - 6, Y(k) + 4, k);
  }
  out += text("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">the orange's stiffness [N/m]</text>",
              X(most / 2), height - 4);
  for (const auto& a : o.arm)
    for (const auto& j : a.judged) {
      const char* fill = j.said_good != j.good ? "#d33" : j.good ? "#e8912d" : "#7a6a4f";
      out += text("<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\" fill-opacity=\".7\"/>", X(j.truth),
                  Y(std::min(j.stiffness, most)), fill);
    }
  return out + "</svg>";
}

std::string picture_of_force(const Outcome& o) {
  plotting::Plot plot;
  plot.y_name = "[N]";
  plotting::Series force{.name = "force", .x = {}, .y = {}},
      opening{.name = "opening [cm]", .x = {}, .y = {}};
  const ArmOutcome& arm = o.arm[0];
  const double until = arm.judged.size() > 1 ? arm.judged[1].time + 6 : 15;
  double touched = -1;
  for (const auto& p : arm.path) {
    if (p.t > until) break;
    force.x.push_back(p.t), force.y.push_back(p.force);
    opening.x.push_back(p.t), opening.y.push_back(100 * p.opening);
    if (p.touched && touched < 0) touched = p.t;
    if (!p.touched && touched >= 0) {
      plot.bands.push_back({touched, p.t, "touched", ""});
      touched = -1;
    }
  }
  plot.series = {std::move(force), std::move(opening)};
  return plotting::inline_svg(plot);
}

}  // namespace packing
