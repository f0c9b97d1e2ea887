// The health of a skin as a picture: the cells of each link, unrolled.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "skinctl/io/formatted.hpp"
#include "skinctl/io/skin_report.hpp"

namespace examples {

using skinctl::CellFault;
using skinctl::CellFaults;
using skinctl::CellHealthReport;
using skinctl::formatted;
using skinctl::SkinHealthReport;

/// The cells of a link, unrolled: their places along the link's axis, and around it [m].
struct UnrolledCells {
  std::vector<const CellHealthReport*> cells;
  std::vector<double> along, around;
  double low = 0, high = 0, left = 0, right = 0;

  UnrolledCells(const SkinHealthReport& report, std::size_t link) {
    double lowest[3] = {1e9, 1e9, 1e9}, highest[3] = {-1e9, -1e9, -1e9};
    for (const CellHealthReport& c : report.cells) {
      if (c.link != link) continue;
      cells.push_back(&c);
      for (std::size_t k = 0; k < 3; ++k)
        lowest[k] = std::min(lowest[k], double(c.place[k])),
        highest[k] = std::max(highest[k], double(c.place[k]));
    }
    if (cells.empty()) return;
    // Around the axis that the normals have least along.
    double normals[3] = {};
    for (const CellHealthReport* c : cells)
      for (std::size_t k = 0; k < 3; ++k) normals[k] += double(c->normal[k]) * double(c->normal[k]);
    const auto axis = static_cast<std::size_t>(std::min_element(normals, normals + 3) - normals);
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double mu = (lowest[u] + highest[u]) / 2, mv = (lowest[v] + highest[v]) / 2;
    const double radius = (highest[u] - lowest[u] + highest[v] - lowest[v]) / 4;
    for (const CellHealthReport* c : cells) {
      along.push_back(double(c->place[axis]) - lowest[axis]);
      around.push_back(radius * std::atan2(double(c->place[v]) - mv, double(c->place[u]) - mu));
    }
    low = 0, high = highest[axis] - lowest[axis];
    left = *std::min_element(around.begin(), around.end()),
    right = *std::max_element(around.begin(), around.end());
  }
};
struct CellLook {
  const char *fill, *text, *letter;
};
/// Okabe and Ito's colours, and a letter for those who print in black.
[[nodiscard]] inline CellLook look_of(CellFaults faults, bool unexplained) noexcept {
  if (faults.has(CellFault::unheard)) return {"#000000", "#ffffff", "-"};
  if (faults.has(CellFault::stuck)) return {"#d55e00", "#ffffff", "S"};
  if (faults.has(CellFault::saturated)) return {"#e69f00", "#000000", "T"};
  if (faults.has(CellFault::blinking)) return {"#0072b2", "#ffffff", "B"};
  if (faults.has(CellFault::noisy)) return {"#f0e442", "#000000", "N"};
  if (faults.has(CellFault::cross_talk)) return {"#56b4e9", "#000000", "X"};
  if (faults.has(CellFault::quiet)) return {"#666666", "#ffffff", "Q"};
  if (faults.has(CellFault::discharge)) return {"#009e73", "#ffffff", "D"};
  if (unexplained) return {"#cc79a7", "#000000", "?"};
  return {"#e8e8e8", "#000000", ""};
}

/// The report as a picture (SVG): the cells of each link, unrolled, link beside link; faults by colours that
/// colour-blind readers tell apart, and by a letter.
[[nodiscard]] inline std::string as_svg(const SkinHealthReport& report) {
  constexpr double scale = 800, gap = 40, top = 60;  // [px/m], [px]
  std::size_t links = 0;
  for (const CellHealthReport& c : report.cells) links = std::max(links, c.link + 1);
  double x = gap, height = 0;
  std::string body;
  for (std::size_t link = 0; link < links; ++link) {
    const UnrolledCells u(report, link);
    if (u.cells.empty()) continue;
    double nearest = 1e9;
    for (std::size_t a = 0; a < u.cells.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        nearest = std::min(nearest, std::hypot(u.along[a] - u.along[b], u.around[a] - u.around[b]));
    const double r = std::clamp(0.46 * scale * nearest, 2.0, 11.0);
    body += formatted("<text x=\"%.1f\" y=\"%.1f\" class=\"t\">link %zu</text>\n", x, top - 16, link);
    for (std::size_t k = 0; k < u.cells.size(); ++k) {
      const CellHealthReport& c = *u.cells[k];
      const auto look = look_of(c.faults, c.unexplained);
      const double cx = x + r + scale * (u.around[k] - u.left), cy = top + r + scale * (u.high - u.along[k]);
      body += formatted(
          "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\" stroke=\"#777777\"><title>cell "
          "%u</title></circle>\n",
          cx, cy, r, look.fill, c.id);
      if (look.letter[0] != 0)
        body +=
            formatted("<text x=\"%.1f\" y=\"%.1f\" class=\"c\" fill=\"%s\" font-size=\"%.1f\">%s</text>\n",
                      cx, cy + 0.45 * r, look.text, 1.3 * r, look.letter);
      height = std::max(height, cy + r);
    }
    x += scale * (u.right - u.left) + 2 * r + gap;
  }
  const double width = std::max(x, 760.0);
  double at = gap;
  std::string legend;
  const auto entry = [&](CellFaults found, bool unexplained, const std::string& label) {
    const auto look = look_of(found, unexplained);
    legend +=
        formatted("<rect x=\"%.1f\" y=\"%.1f\" width=\"16\" height=\"16\" fill=\"%s\" stroke=\"#777777\"/>\n",
                  at, height + 24, look.fill);
    legend += formatted("<text x=\"%.1f\" y=\"%.1f\" class=\"c\" fill=\"%s\" font-size=\"12\">%s</text>\n",
                        at + 8, height + 36.5, look.text, look.letter);
    legend += formatted("<text x=\"%.1f\" y=\"%.1f\" class=\"l\">%s</text>\n", at + 21, height + 36.5,
                        label.c_str());
    at += 32 + 6.6 * static_cast<double>(label.size());
  };
  entry({}, false, "healthy");
  for (const CellFault f : skinctl::detail::all_cell_faults) entry(f, false, name(f));
  entry({}, true, "drift or contact?");
  std::string out = formatted(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f %.0f\" font-family=\"sans-serif\">\n",
      std::max(width, at), height + 60);
  out +=
      "<style>.t{font-size:15px;fill:#222}.c{text-anchor:middle;font-weight:bold}.l{font-size:12px;fill:#222}"
      "</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  out +=
      formatted("<text x=\"%.0f\" y=\"24\" class=\"t\" font-weight=\"bold\">%zu of %zu cells count</text>\n",
                gap, report.usable, report.cells.size());
  return out + body + legend + "</svg>\n";
}

}  // namespace examples
