// The cells that have stood above their rest level for long, with nothing to say whether they are touched: for
// a report on the skin's health.
#pragma once

#include <cstddef>
#include <cstdio>
#include <span>
#include <string>

#include "skinctl/sensing/rest_level.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A cell that has been frozen for 60 s or more although nothing says that it is touched.
struct UnexplainedCell {
  std::size_t cell = 0;  ///< place of the cell in the rows
  float above = 0;       ///< smoothed reading above the rest level [steps]: what it reads as force
  float evidence = 0;    ///< smoothed sum of the evidence for a drift
  bool fast = false;     ///< whether the cell rose as fast as a touch
};

/// Calls `f(UnexplainedCell)` for each of `count` cells from the `first` on that `unexplained` holds of, in their
/// order.
template <class F>
void each_unexplained(std::span<const RestRow> rows, std::size_t first, std::size_t count, F&& f) {
  SKINCTL_EXPECTS(first + count <= rows.size() * RestRow::cells, "cells of these rows");
  for (std::size_t i = first; i < first + count; ++i) {
    const RestCell<> cell = RestLevel::cell(rows[i / RestRow::cells], i % RestRow::cells);
    if (unexplained(cell)) f(UnexplainedCell{i, cell.above, cell.evidence, cell.frozen < 0});
  }
}

/// A line for a person. Not for the loop: it allocates.
/// @param name  of the cell, as its user knows it: "cell 17 of forearm".
[[nodiscard]] inline std::string describe(const UnexplainedCell& cell, const std::string& name) {
  char steps[48];
  std::snprintf(steps, sizeof steps, ": %.1f steps above its rest level", static_cast<double>(cell.above));
  const char* why = cell.evidence < 1.0f ? "; nothing says whether it is touched or has drifted"
                    : cell.fast
                        ? "; something else says that it is not touched, but it rose as fast as a touch"
                        : "; there is evidence for a drift, but not enough";
  return name + steps + " for 60 s or more" + why;
}

SKINCTL_END_NAMESPACE
