// SPDX-License-Identifier: BSD-3-Clause
// What proximity cells see of the robot itself and of known objects.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "skinctl/clearance/capsule.hpp"
#include "skinctl/core/eigen.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/cell_place.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Range and cone of a cell's proximity sensor, and its curve: `1 - distance/range` or less.
struct CellView {
  double range = 0.2;      ///< largest distance that a cell sees [m]
  double half_angle = 25;  ///< half opening angle of the cell's cone [degrees]
  double error = 0.01;     ///< error of capsules and places of cells [m]
  double fade_band = 0.1;  ///< rise above the predicted reading over which a reading fades in
};

/// The proximity that each cell can at most owe to the robot's other links and to known objects, by capsules.
///
/// Four balls along its normal cover a cell's view. If one of them, larger by `error`, meets a capsule at the
/// distance d of the cell, the cell's reading is up to `1 - (d - error)/range` that capsule's. A reading up
/// to there counts as nothing; from `fade_band` above it on, something is nearer, and it counts fully. The
/// cell's own link is not looked at, and forces are never taken away. Immutable.
template <RobotModel M, Real T = double>
class OwnView {
 public:
  static constexpr std::size_t joints = M::joints;
  static constexpr std::size_t max_capsules = 32;

  /// Throws `ConfigurationError` for a view or capsule out of its range, and for more than 32 capsules.
  SKINCTL_COLD OwnView(const M& model, std::span<const CellPlace> places,
                       const std::vector<LinkCapsule>& capsules, const CellView& view = {})
      : model_(model), view_(view) {
    require(view.range > 0 && view.range <= 10, "CellView: range", view.range, "> 0, <= 10 m");
    require(view.half_angle > 0 && view.half_angle <= 60, "CellView: half angle", view.half_angle,
            "> 0, <= 60 degrees");
    require(view.error >= 0 && view.error <= 1, "CellView: error", view.error, "0 to 1 m");
    require(view.fade_band > 0 && view.fade_band <= 1, "CellView: fade_band", view.fade_band, "> 0, <= 1");
    require(capsules.size() <= max_capsules, "OwnView: capsules", double(capsules.size()), "at most 32");
    const auto convert = [](const Xyz<double>& x) { return Xyz<T>{T(x.x), T(x.y), T(x.z)}; };
    for (const LinkCapsule& c : capsules) {
      c.check(joints);
      capsules_.push_back({c.link, {convert(c.shape.from), convert(c.shape.to), T(c.shape.radius)}});
    }
    for (const CellPlace& c : places) {
      require(c.link < joints, "OwnView: link of a cell", double(c.link), "one of the model");
      cells_.push_back({c.link, convert(c.place), convert(c.normal)});
    }
    cover();
  }

  [[nodiscard]] std::size_t size() const noexcept { return cells_.size(); }
  [[nodiscard]] const CellView& view() const noexcept { return view_; }

  /// Writes the largest readings that the cells may have of known capsules at `q`, 0 to 65535; 0 for a cell
  /// that sees none of them.
  SKINCTL_NOINLINE void look(const JointPosition<joints, T>& q, std::span<std::uint16_t> own) const noexcept {
    SKINCTL_EXPECTS(own.size() >= size(), "room for each cell");
    const Poses<M, all_links(joints), T> poses(model_, q);
    Transform<Base, Link<0>, T> pose[joints];
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      ((pose[Ix] = poses.template get<Ix>().template renamed<Base, Link<0>>()), ...);
    }(std::make_index_sequence<joints>{});
    Capsule<T> placed[max_capsules];
    for (std::size_t k = 0; k < capsules_.size(); ++k) {
      const auto& [link, c] = capsules_[k];
      placed[k] = c;
      if (link == LinkCapsule::fixed) continue;
      const auto& X = pose[link];
      placed[k] = {X.origin() + X.axes() * c.from, X.origin() + X.axes() * c.to, c.radius};
    }
    const T error = T(view_.error), range = T(view_.range);
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const Cell& cell = cells_[i];
      const auto& X = pose[cell.link];
      const Xyz<T> p = X.origin() + X.axes() * cell.place, n = X.axes() * cell.normal;
      T least = range;
      for (std::size_t k = 0; k < capsules_.size(); ++k) {
        if (capsules_[k].link == cell.link) continue;
        const T d = distance(p, placed[k]) - error;
        if (d < least && meets(p, n, placed[k])) least = d;
      }
      const T reading = least > T(0) ? T(T(1) - least / range) : T(1);
      own[i] = static_cast<std::uint16_t>(T(65535) * reading + T(least < range ? 0.5 : 0));
    }
  }

  /// The part of a reading that known capsules do not explain, by their prediction `own` from `look`.
  [[nodiscard]] SKINCTL_INLINE std::uint16_t foreign(std::uint16_t reading,
                                                     std::uint16_t own) const noexcept {
    if (own == 0) return reading;
    const double above = (double(reading) - double(own)) / (65536 * view_.fade_band);
    return above >= 1 ? reading : above > 0 ? static_cast<std::uint16_t>(above * reading) : std::uint16_t(0);
  }

 private:
  struct Cell {
    std::size_t link;
    Xyz<T> place, normal;
  };
  struct Placed {
    std::size_t link;
    Capsule<T> shape;
  };
  /// Balls whose slices cover the cone: each takes the part of the view between two depths, `edges` in parts
  /// of the range, from the widest points of both ends.
  SKINCTL_COLD void cover() {
    constexpr double edges[] = {0, 0.25, 0.54, 0.80, 1};
    const double a = view_.half_angle * 0.017453292519943295;
    for (int k = 0; k < 4; ++k) {
      // The rim of the near end and the far edge of the spherical sector, from the centre on the axis.
      const double near = edges[k] * view_.range, far = edges[k + 1] * view_.range;
      double best = 1e9, at = 0;
      for (double c = near * std::cos(a); c <= far; c += 1e-4 * view_.range) {
        const auto rim = [&](double r) { return std::hypot(r * std::cos(a) - c, r * std::sin(a)); };
        const double radius =
            std::max({rim(near), rim(far), std::abs(far - c), std::abs(near * std::cos(a) - c)});
        if (radius < best) best = radius, at = c;
      }
      centre_[k] = T(at), radius_[k] = T(best + view_.error);
    }
  }
  [[nodiscard]] SKINCTL_INLINE bool meets(const Xyz<T>& p, const Xyz<T>& n,
                                          const Capsule<T>& c) const noexcept {
    for (std::size_t k = 0; k < 4; ++k)
      if (distance(p + centre_[k] * n, c) <= radius_[k]) return true;
    return false;
  }

  [[no_unique_address]] M model_;
  CellView view_;
  T centre_[4], radius_[4];
  std::vector<Cell> cells_;
  std::vector<Placed> capsules_;
};

SKINCTL_END_NAMESPACE
