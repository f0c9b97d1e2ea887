// SPDX-License-Identifier: BSD-3-Clause
// The health of a skin in words and as JSON.
#pragma once

#include <algorithm>
#include <array>
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

SKINCTL_END_NAMESPACE
