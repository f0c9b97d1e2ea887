// SPDX-License-Identifier: BSD-3-Clause
// The contents of a skin file. Needs no parser: those are in `io/skin_file.hpp` and `io/skin_xml.hpp`.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "skinctl/frames/transform.hpp"
#include "skinctl/io/detail/skin_check.hpp"
#include "skinctl/io/skin_pose.hpp"
#include "skinctl/tactile/patch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A skin as a file describes it, or as a program builds it to write one: cells in patches on named links.
/// `check` says whether it makes sense; what the readers return is checked.
struct SkinFile {
  /// Entry in a list of neighbours: no cell at this port.
  static constexpr std::uint32_t nobody = 0xffffffff;
  static constexpr std::size_t max_cells = std::size_t(1) << 20;
  static constexpr std::size_t max_cells_of_a_patch = 8192;
  static constexpr std::size_t max_patches = 4096;
  static constexpr std::uint32_t highest_id = (1u << 20) - 1;

  /// A link that carries skin, by the name that it has in the robot's URDF or description.
  struct Link {
    std::string name;
    double radius = 0;  ///< radius of the tube that stands for the link in pictures [m]
    double length = 0;  ///< length of the tube [m]
    /// Unit vector along the axis of the joint that moves the link, in the link's frame; all 0: not given.
    /// Descriptions of one robot differ in the axes of equally named links; this tells them apart.
    Xyz<double> joint_axis{0, 0, 0};
    int line = 0;
    friend bool operator==(const Link&, const Link&) = default;
  };
  struct Cell {
    std::uint32_t id = 0;
    SkinPose X_RootCell;  ///< pose of the cell in its patch; z is the outward normal
    /// Ids of the cells at ports 1 to 4, or `nobody`. Empty: those within 1.3 pitches.
    std::vector<std::uint32_t> neighbours{};
    std::uint32_t group = 0;            ///< number of a group of cells that share electronics
    std::optional<double> threshold{};  ///< threshold of its three force readings' sum; none: `SkinSettings`
    double gain = 1;                    ///< factor on the patch's gains
    std::vector<double> covariance;     ///< as of a patch, for `X_RootCell`: position [m] in the patch's axes
    std::string masked;  ///< reason for which the cell's readings do not count; empty: they count
    int line = 0;        ///< line of the file; 0: none
    friend bool operator==(const Cell&, const Cell&) = default;
  };
  struct Patch {
    std::string name;
    std::string link;
    SkinPose X_LinkRoot;
    CellGains gains{};
    /// Covariance of `X_LinkRoot`: errors of position [m] in the link's axes, then of rotation vector [rad]
    /// in the patch's own. The upper triangle of 6x6 by rows, 21 numbers; empty: unknown.
    std::vector<double> covariance;
    std::vector<Cell> cells;
    int line = 0;
    friend bool operator==(const Patch& a, const Patch& b) {
      return a.name == b.name && a.link == b.link && a.X_LinkRoot == b.X_LinkRoot &&
             a.gains.force == b.gains.force && a.gains.proximity == b.gains.proximity &&
             a.covariance == b.covariance && a.cells == b.cells && a.line == b.line;
    }
  };
  /// A part of the body with a meaning of its own: cells of any patch.
  struct Region {
    std::string name;
    std::vector<std::uint32_t> cells;
    double weight = 1;  ///< factor on the forces of the region's cells
    double force_limit = std::numeric_limits<double>::infinity();  ///< largest contact force [N]; inf: none
    int line = 0;
    friend bool operator==(const Region&, const Region&) = default;
  };

  std::string source;  ///< name of the file in error texts
  std::vector<Link> links;
  std::vector<Patch> patches;
  std::vector<Region> regions;

  [[nodiscard]] std::size_t cells() const noexcept {
    std::size_t n = 0;
    for (const Patch& patch : patches) n += patch.cells.size();
    return n;
  }

  /// Throws `ConfigurationError` with source, line, patch, cell, field, value and allowed range, for
  /// - a number that is not finite or out of range; a quaternion whose length is not 1 within 1e-4; a
  ///   covariance that is not positive semidefinite;
  /// - a name that is empty, longer than 128 bytes, has control characters, or occurs twice;
  /// - a patch without cells or on a link that `links` does not have; a link without a patch;
  /// - an id that occurs twice, is 2^20 or more, or is unknown where neighbours and regions name it;
  /// - neighbours that are not mutual, or that only some cells of a patch have;
  /// - more than 2^20 cells, 8192 cells of a patch, or 4096 patches.
  void check() const { detail::SkinCheck(*this).all(); }
};

SKINCTL_END_NAMESPACE
