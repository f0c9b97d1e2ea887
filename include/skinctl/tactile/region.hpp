// SPDX-License-Identifier: BSD-3-Clause
// Named regions of a skin, with a weight and a limit of force.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A named set of cells of a skin. Regions may overlap.
struct Region {
  std::string name;
  std::vector<std::uint32_t> cells;  ///< ids of the cells
  double weight = 1;  ///< > 0: multiplies the region's force, to count a delicate place for more
  double force_limit = std::numeric_limits<double>::infinity();  ///< largest weight times force [N], > 0
};

/// A set of regions, bit `k` for the k-th.
using RegionMask = std::uint32_t;

/// The regions of a skin, at most 32.
class Regions {
 public:
  static constexpr std::size_t most = 32;

  Regions() = default;
  SKINCTL_COLD Regions(std::initializer_list<Region> regions) : Regions(std::vector<Region>(regions)) {}
  /// Throws `ConfigurationError` for more than 32 regions, a name that is empty or occurs twice, a region
  /// without cells, and a weight or limit out of its range.
  SKINCTL_COLD explicit Regions(std::vector<Region> regions) : list_(std::move(regions)) {
    require(list_.size() <= most, "Regions: number", double(list_.size()), "at most 32");
    for (std::size_t k = 0; k < list_.size(); ++k) {
      const Region& r = list_[k];
      require(!r.name.empty() && find(r.name) == k, "Regions: name of number", double(k), "one of its own");
      require(!r.cells.empty(), "Regions: cells of number", double(k), "at least one");
      require(r.weight > 0 && r.weight <= 1e6, "Region: weight", r.weight, "> 0, <= 1e6");
      require(r.force_limit > 0, "Region: force limit", r.force_limit, "> 0 N");
    }
  }

  [[nodiscard]] std::size_t size() const noexcept { return list_.size(); }
  [[nodiscard]] const Region& operator[](std::size_t k) const noexcept { return list_[k]; }
  /// The index of the region `name`; `size()` if there is none of that name.
  [[nodiscard]] std::size_t find(const std::string& name) const noexcept {
    std::size_t k = 0;
    while (k < list_.size() && list_[k].name != name) ++k;
    return k;
  }
  /// The set that holds only the region `name`. Throws `ConfigurationError` if there is none of that name.
  [[nodiscard]] SKINCTL_COLD RegionMask mask(const std::string& name) const {
    const std::size_t k = find(name);
    require(k < list_.size(), ("region \"" + name + "\": number").c_str(), double(k), "the name of a region");
    return RegionMask(1) << k;
  }

 private:
  std::vector<Region> list_;
};

SKINCTL_END_NAMESPACE
