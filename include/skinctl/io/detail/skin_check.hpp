// SPDX-License-Identifier: BSD-3-Clause
// The rules of a skin file, each with its error.
#pragma once

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/io/skin_pose.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

inline std::string skin_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}
/// A name in an error text: control characters become `?`, and the rest of a long one is left out.
inline std::string skin_quoted(std::string_view name) {
  std::string out = "\"";
  for (const char c : name.substr(0, 128)) out += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  return out + (name.size() > 128 ? "...\"" : "\"");
}

/// Checks a skin file by its rules.
/// @tparam File  `SkinFile`, whose `check` calls this.
template <class File>
class SkinCheck {
 public:
  explicit SkinCheck(const File& file) : file_(file) {}

  void all() {
    check_links();
    count(file_.patches.size(), 1, File::max_patches, "patches");
    for (const typename File::Patch& patch : file_.patches) check_patch(patch);
    count(cells_.size(), 1, File::max_cells, "cells");
    for (const typename File::Link& link : file_.links)
      if (!covered_.contains(link.name)) {
        at("link " + skin_quoted(link.name), link.line);
        fail("no patch is on it");
      }
    for (const typename File::Patch& patch : file_.patches) check_neighbours(patch);
    check_regions();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse("skinctl: " + file_.source + (line_ > 0 ? ":" + std::to_string(line_) : "") + ": " + where_ +
           (where_.empty() ? "" : ", ") + what);
  }
  void at(std::string where, int line) { where_ = std::move(where), line_ = line; }
  void at(const typename File::Patch& patch) { at("patch " + skin_quoted(patch.name), patch.line); }
  void at(const typename File::Patch& patch, const typename File::Cell& cell) {
    at("patch " + skin_quoted(patch.name) + ", cell " + std::to_string(cell.id),
       cell.line > 0 ? cell.line : patch.line);
  }
  void range(const char* field, double x, double low, double high, const char* unit) const {
    if (!(x >= low && x <= high))
      fail(std::string(field) + " = " + skin_number(x) + ", allowed: " + skin_number(low) + " to " +
           skin_number(high) + unit);
  }
  void count(std::size_t n, std::size_t low, std::size_t high, const char* of) const {
    if (n < low || n > high)
      fail(std::to_string(n) + " " + of + ", allowed: " + std::to_string(low) + " to " +
           std::to_string(high));
  }
  void name(const char* field, const std::string& text) const {
    const bool printable =
        std::none_of(text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; });
    if (text.empty() || text.size() > 128 || !printable)
      fail(std::string(field) + " = " + skin_quoted(text) +
           ", allowed: 1 to 128 bytes without control characters");
  }
  void pose(const std::string& field, const SkinPose& X) const {
    for (const double p : {X.p.x, X.p.y, X.p.z}) range((field + ".p").c_str(), p, -10, 10, " m");
    double square = 0;
    for (const double q : X.q) square += q * q;
    const double length = std::sqrt(square);
    if (!(std::abs(length - 1) <= 1e-4))
      fail(field + ".q: |q| = " + skin_number(length) + ", allowed: 1 within 1e-4");
  }
  void covariance(const std::vector<double>& C) const {
    if (C.empty()) return;
    if (C.size() != 21)
      fail("covariance: " + std::to_string(C.size()) + " numbers, allowed: 21, the upper triangle by rows");
    Eigen::Matrix<double, 6, 6> full;
    std::size_t k = 0;
    for (int i = 0; i < 6; ++i)
      for (int j = i; j < 6; ++j, ++k) {
        range("covariance", C[k], -100, 100, "");
        full(i, j) = full(j, i) = C[k];
      }
    // Shifted by its norm, a symmetric matrix has its eigenvalues as singular values, to 1e-14 of the norm.
    // The solver for symmetric matrices costs every file that reads a skin 4 s of compilation, this one 0.7
    // s.
    const double shift = full.norm();
    full.diagonal().array() += shift;
    const Eigen::JacobiSVD<Eigen::Matrix<double, 6, 6>, Eigen::NoQRPreconditioner> solver(full);
    if (solver.info() != Eigen::Success) fail("covariance: no finite numbers");
    const double least = solver.singularValues().minCoeff() - shift;
    const double most = solver.singularValues().maxCoeff() - shift;
    if (!(least >= -1e-9 * std::max(most, 0.0)))
      fail("covariance: smallest eigenvalue = " + skin_number(least) + ", allowed: >= 0");
  }

  void check_links() {
    for (const typename File::Link& link : file_.links) {
      at("link " + skin_quoted(link.name), link.line);
      name("name", link.name);
      if (!links_.insert(link.name).second) fail("the name occurs twice");
      range("radius", link.radius, 0, 10, " m");
      range("length", link.length, 0, 10, " m");
      const Xyz<double>& a = link.joint_axis;
      const double length = std::sqrt(dot(a, a));
      if (length != 0 && !(std::abs(length - 1) <= 1e-4))
        fail("joint_axis: its length = " + skin_number(length) + ", allowed: 1 within 1e-4");
    }
    at("", 0);
  }
  void check_patch(const typename File::Patch& patch) {
    at(patch);
    name("name", patch.name);
    if (!patches_.insert(patch.name).second) fail("the name occurs twice");
    if (!links_.contains(patch.link))
      fail("link = " + skin_quoted(patch.link) + ", allowed: a name of \"links\"");
    covered_.insert(patch.link);
    pose("X_LinkRoot", patch.X_LinkRoot);
    range("gains.force", patch.gains.force, 0, 1e6, " N");
    range("gains.proximity", patch.gains.proximity, 0, 1e6, " N");
    covariance(patch.covariance);
    count(patch.cells.size(), 1, File::max_cells_of_a_patch, "cells");
    for (const typename File::Cell& cell : patch.cells) check_cell(patch, cell);
    at("", 0);
  }
  void check_cell(const typename File::Patch& patch, const typename File::Cell& cell) {
    at(patch, cell);
    range("id", cell.id, 0, File::highest_id, "");
    if (!cells_.emplace(cell.id, &cell).second) fail("the id occurs twice");
    pose("X_RootCell", cell.X_RootCell);
    range("group", cell.group, 0, 65535, "");
    if (cell.threshold) range("threshold", *cell.threshold, 0, 3, "");
    range("gain", cell.gain, 0, 100, "");
    covariance(cell.covariance);
    if (!cell.masked.empty()) name("masked", cell.masked);
  }
  void check_neighbours(const typename File::Patch& patch) {
    const bool given = !patch.cells.front().neighbours.empty();
    for (const typename File::Cell& cell : patch.cells) {
      at(patch, cell);
      if (cell.neighbours.empty() == given)
        fail("neighbours are " + std::string(given ? "missing" : "given") +
             ", allowed: all cells of a patch have them, or none");
      if (!given) continue;
      if (cell.neighbours.size() != 4)
        fail("neighbours: " + std::to_string(cell.neighbours.size()) + " ids, allowed: 4, one a port");
      for (std::size_t port = 0; port < 4; ++port) {
        const std::uint32_t other = cell.neighbours[port];
        if (other == File::nobody) continue;
        const std::string is =
            "neighbour at port " + std::to_string(port + 1) + " = " + std::to_string(other);
        if (other == cell.id) fail(is + ", allowed: another cell");
        for (std::size_t before = 0; before < port; ++before)
          if (cell.neighbours[before] == other) fail(is + ", as at port " + std::to_string(before + 1));
        const auto found = cells_.find(other);
        if (found == cells_.end()) fail(is + ", allowed: an id of this file");
        const auto& theirs = found->second->neighbours;
        if (std::find(theirs.begin(), theirs.end(), cell.id) == theirs.end())
          fail(is + ", but cell " + std::to_string(other) + " does not name cell " + std::to_string(cell.id));
      }
    }
  }
  void check_regions() {
    std::unordered_set<std::string_view> names;
    for (const typename File::Region& region : file_.regions) {
      at("region " + skin_quoted(region.name), region.line);
      name("name", region.name);
      if (!names.insert(region.name).second) fail("the name occurs twice");
      count(region.cells.size(), 1, File::max_cells, "cells");
      range("weight", region.weight, 0, 1000, "");
      if (!(region.force_limit > 0))
        fail("force_limit = " + skin_number(region.force_limit) + ", allowed: > 0 N");
      std::unordered_set<std::uint32_t> ids;
      for (const std::uint32_t id : region.cells) {
        if (!cells_.contains(id)) fail("cell " + std::to_string(id) + ", allowed: an id of this file");
        if (!ids.insert(id).second) fail("cell " + std::to_string(id) + " occurs twice");
      }
    }
  }

  const File& file_;
  std::string where_;
  int line_ = 0;
  std::unordered_set<std::string_view> links_, patches_, covered_;
  std::unordered_map<std::uint32_t, const typename File::Cell*> cells_;
};

}  // namespace detail

SKINCTL_END_NAMESPACE
