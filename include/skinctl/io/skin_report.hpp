// SPDX-License-Identifier: BSD-3-Clause
// The health of a skin in words, as JSON, and as a picture.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "skinctl/io/formatted.hpp"
#include "skinctl/tactile/trusted_skin.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The health of one cell.
struct CellHealthReport {
  std::uint32_t id = 0;
  std::size_t link = 0;
  std::array<float, 3> place{}, normal{};  ///< position in the link's frame [m], and its outward normal
  CellFaults faults;                       ///< faults found, silence included
  double mask = 0;                         ///< mask of the cell; 1: it does not count
  double rest = 0;                         ///< rest level: sum of the three forces while untouched
  /// Whether the cell has read something for a minute, and nobody can tell whether that is a contact or a
  /// drift.
  bool unexplained = false;
};

/// The health of all cells of a skin, at one time. Not for the loop: it allocates.
struct SkinHealthReport {
  std::vector<CellHealthReport> cells;  ///< cells in the order of the patches
  std::size_t usable = 0;               ///< cells that count
  [[nodiscard]] std::size_t count(CellFault fault) const noexcept {
    return static_cast<std::size_t>(std::count_if(
        cells.begin(), cells.end(), [&](const CellHealthReport& c) { return c.faults.has(fault); }));
  }
  [[nodiscard]] std::size_t unexplained() const noexcept {
    return static_cast<std::size_t>(
        std::count_if(cells.begin(), cells.end(), [](const CellHealthReport& c) { return c.unexplained; }));
  }
};

template <class S>
[[nodiscard]] SKINCTL_COLD SkinHealthReport report_of(const TrustedSkin<S>& skin,
                                                      const typename TrustedSkin<S>::Memory& memory) {
  SkinHealthReport out;
  for (const auto& c : skin.table()) {
    const std::size_t i = out.cells.size();
    out.cells.push_back({c.id, c.link, c.place, c.normal, skin.faults(memory, i),
                         double(skin.mask(memory, i)), skin.rest(memory, i), skin.is_unexplained(memory, i)});
  }
  out.usable = skin.coverage(memory).usable;
  return out;
}

namespace detail {
inline constexpr std::array<CellFault, cell_faults> all_cell_faults = {
    CellFault::stuck,      CellFault::saturated, CellFault::blinking, CellFault::noisy,
    CellFault::cross_talk, CellFault::discharge, CellFault::unheard,  CellFault::quiet};
}  // namespace detail

/// The report in words: a line with the numbers, then one for each cell that is not healthy. "258 of 260
/// cells count; stuck: 2"
[[nodiscard]] SKINCTL_COLD inline std::string in_words(const SkinHealthReport& report) {
  std::string out = formatted("%zu of %zu cells count", report.usable, report.cells.size());
  for (const CellFault f : detail::all_cell_faults)
    if (const std::size_t n = report.count(f); n > 0) out += formatted("; %s: %zu", name(f), n);
  if (const std::size_t n = report.unexplained(); n > 0)
    out += formatted("; reading something that nobody can explain: %zu", n);
  out += "\n";
  for (const CellHealthReport& c : report.cells) {
    if (!c.faults.any() && !c.unexplained && c.mask == 0) continue;
    out += formatted("cell %u on link %zu:", c.id, c.link);
    const char* comma = " ";
    for (const CellFault f : detail::all_cell_faults)
      if (c.faults.has(f)) out += std::string(comma) + name(f), comma = ", ";
    if (c.unexplained) out += std::string(comma) + "drift or contact, nobody can tell", comma = ", ";
    if (!c.faults.any() && !c.unexplained) out += " comes back";
    if (c.mask > 0) out += formatted(", masked by %.0f %%", 100 * c.mask);
    out += formatted(", rest level %.3f\n", c.rest);
  }
  return out;
}

/// The report as JSON: `{"cells": 260, "usable": 258, "faults": {"stuck": 2, ...}, "unexplained": 0,
/// "unhealthy": [{"id": 7, "link": 2, "faults": ["stuck"], "mask": 1, "rest": 0.06, "unexplained": false},
/// ...]}`.
[[nodiscard]] SKINCTL_COLD inline std::string as_json(const SkinHealthReport& report) {
  std::string out =
      formatted("{\"cells\": %zu, \"usable\": %zu, \"faults\": {", report.cells.size(), report.usable);
  const char* comma = "";
  for (const CellFault f : detail::all_cell_faults)
    out += formatted("%s\"%s\": %zu", comma, name(f), report.count(f)), comma = ", ";
  out += formatted("}, \"unexplained\": %zu, \"unhealthy\": [", report.unexplained());
  comma = "";
  for (const CellHealthReport& c : report.cells) {
    if (!c.faults.any() && !c.unexplained && c.mask == 0) continue;
    out += formatted("%s\n  {\"id\": %u, \"link\": %zu, \"faults\": [", comma, c.id, c.link);
    comma = "";
    for (const CellFault f : detail::all_cell_faults)
      if (c.faults.has(f)) out += formatted("%s\"%s\"", comma, name(f)), comma = ", ";
    out += formatted("], \"mask\": %.3f, \"rest\": %.4f, \"unexplained\": %s}", c.mask, c.rest,
                     c.unexplained ? "true" : "false");
    comma = ",";
  }
  return out + "]}\n";
}

namespace detail {
/// The cells of a link, unrolled: their places along the link's axis, and around it [m].
struct Unrolled {
  std::vector<const CellHealthReport*> cells;
  std::vector<double> along, around;
  double low = 0, high = 0, left = 0, right = 0;

  Unrolled(const SkinHealthReport& report, std::size_t link) {
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
}  // namespace detail

/// The report as a picture (SVG): the cells of each link, unrolled, link beside link; faults by colours that
/// colour-blind readers tell apart, and by a letter.
[[nodiscard]] SKINCTL_COLD inline std::string as_svg(const SkinHealthReport& report) {
  constexpr double scale = 800, gap = 40, top = 60;  // [px/m], [px]
  std::size_t links = 0;
  for (const CellHealthReport& c : report.cells) links = std::max(links, c.link + 1);
  double x = gap, height = 0;
  std::string body;
  for (std::size_t link = 0; link < links; ++link) {
    const detail::Unrolled u(report, link);
    if (u.cells.empty()) continue;
    double nearest = 1e9;
    for (std::size_t a = 0; a < u.cells.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        nearest = std::min(nearest, std::hypot(u.along[a] - u.along[b], u.around[a] - u.around[b]));
    const double r = std::clamp(0.46 * scale * nearest, 2.0, 11.0);
    body += formatted("<text x=\"%.1f\" y=\"%.1f\" class=\"t\">link %zu</text>\n", x, top - 16, link);
    for (std::size_t k = 0; k < u.cells.size(); ++k) {
      const CellHealthReport& c = *u.cells[k];
      const auto look = detail::look_of(c.faults, c.unexplained);
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
    const auto look = detail::look_of(found, unexplained);
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
  for (const CellFault f : detail::all_cell_faults) entry(f, false, name(f));
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

SKINCTL_END_NAMESPACE
