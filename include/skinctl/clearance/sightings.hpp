// SPDX-License-Identifier: BSD-3-Clause
// What proximity cells see, as obstacles at places.
#pragma once

#include <span>

#include "skinctl/clearance/surroundings.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/tactile/cell_place.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The model by which readings of proximity become obstacles.
struct SightSettings {
  double range = 0.2;         ///< range of a cell, whose reading is `1 - distance/range` or less [m]
  double half_angle = 25;     ///< half opening angle of a cell's cone [degrees], < 80
  double error = 0.01;        ///< error of a distance, noise included [m]: an obstacle may be nearer by it
  double radius = 0.04;       ///< radius of the ball that is assumed where a cell sees something [m]
  double approach = 0.3;      ///< speed at which the ball may come closer [m/s]
  double min_reading = 0.05;  ///< reading in (0, 1) below which nothing is seen
};

/// Turns readings of proximity into obstacles for `ClearanceAround`: a ball of `radius` whose surface is at
/// the read distance along the cell's normal, less `error`. The strongest readings become obstacles, as many
/// as `Surroundings` has room for.
///
/// What is known already is no sighting: a reading that one of the obstacles in `out` explains, because it is
/// in the cell's cone and no farther than read. What a cell sees of its own robot is taken out by
/// `OwnViewSkin` before. Immutable; one pass over the cells, no allocation.
template <RobotModel M, Real T = double>
class Sightings {
 public:
  static constexpr std::size_t joints = M::joints;

  /// @param places  of the skin's cells, `skin.places()`. Throws `ConfigurationError` for numbers out of
  ///                their range.
  SKINCTL_COLD Sightings(const M& model, std::span<const CellPlace> places, const SightSettings& s = {})
      : model_(model), s_(s), spread_(T(std::tan(s.half_angle * 0.017453292519943295))) {
    require(s.range > 0 && s.range <= 10, "Sightings: range", s.range, "> 0, <= 10 m");
    require(s.half_angle > 0 && s.half_angle < 80, "Sightings: half angle", s.half_angle,
            "> 0, < 80 degrees");
    require(s.error >= 0 && s.error <= 1, "Sightings: error", s.error, "0 to 1 m");
    require(s.radius >= 0 && s.radius <= 10, "Sightings: radius", s.radius, "0 to 10 m");
    require(s.approach >= 0 && s.approach <= 100, "Sightings: approach", s.approach, "0 to 100 m/s");
    require(s.min_reading > 0 && s.min_reading < 1, "Sightings: min_reading", s.min_reading, "> 0, < 1");
    for (const CellPlace& c : places) {
      require(c.link < joints, "Sightings: link of a cell", double(c.link), "one of the model");
      const auto xyz = [](const Xyz<double>& x) { return Xyz<T>{T(x.x), T(x.y), T(x.z)}; };
      cells_.push_back({c.link, xyz(c.place), xyz(c.normal)});
    }
  }
  [[nodiscard]] const SightSettings& settings() const noexcept { return s_; }

  /// Adds what the cells see, from their readings in [0, 1] in the order of the places, with the robot at
  /// `q`. A reading that is NaN is nothing. Returns the number of cells that see something unknown.
  template <class Reading, std::size_t Most>
  std::size_t look(const JointPosition<joints, T>& q, const Reading& reading,
                   Surroundings<Most, Base, T>& out) const noexcept {
    const std::size_t known = out.count < Most ? out.count : Most, room = Most - known;
    T strength[Most == 0 ? 1 : Most]{};
    std::size_t seen = 0;
    visit(q, reading, out, known,
          [&](std::size_t, const T& r, const Xyz<T>& p, const Xyz<T>& n, bool is_known) {
            if (is_known) return;
            ++seen;
            std::size_t at = seen - 1 < room ? seen - 1 : room;
            while (at > 0 && strength[at - 1] < r) --at;
            if (at >= room) return;
            const std::size_t last = seen - 1 < room ? seen - 1 : room - 1;
            for (std::size_t k = last; k > at; --k) {
              strength[k] = strength[k - 1];
              out.obstacles[known + k] = out.obstacles[known + k - 1];
            }
            strength[at] = r;
            const Xyz<T> centre = p + (T(s_.range) * (T(1) - r) - T(s_.error) + T(s_.radius)) * n;
            out.obstacles[known + at] = {{centre, centre, T(s_.radius)}, T(s_.approach)};
          });
    if (out.count <= Most) out.count = static_cast<std::uint32_t>(known + (seen < room ? seen : room));
    return seen;
  }
  /// Calls `drop(i)` for each cell whose reading one of the obstacles `known` explains: its proximity is to
  /// count as nothing, for a law that gives way to what is foreign.
  template <class Reading, std::size_t Most, class Drop>
  void each_known(const JointPosition<joints, T>& q, const Reading& reading,
                  const Surroundings<Most, Base, T>& known, const Drop& drop) const noexcept {
    visit(q, reading, known, known.count < Most ? known.count : Most,
          [&](std::size_t i, const T&, const Xyz<T>&, const Xyz<T>&, bool is_known) {
            if (is_known) drop(i);
          });
  }

 private:
  /// Calls `f(cell, reading, place, normal, whether it is known)` for each reading that is something.
  template <class Reading, std::size_t Most, class F>
  void visit(const JointPosition<joints, T>& q, const Reading& reading,
             const Surroundings<Most, Base, T>& known, std::size_t count, const F& f) const noexcept {
    const Poses<M, all_links(joints), T> poses(model_, q);
    Transform<Base, Link<0>, T> pose[joints];
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      ((pose[Ix] = poses.template get<Ix>().template renamed<Base, Link<0>>()), ...);
    }(std::make_index_sequence<joints>{});
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const T r = static_cast<T>(reading(i));
      if (!(r >= T(s_.min_reading))) continue;
      const auto& X = pose[cells_[i].link];
      const Xyz<T> p = X.origin() + X.axes() * cells_[i].place, n = X.axes() * cells_[i].normal;
      f(i, r, p, n, explained(p, n, T(s_.range) * (T(1) - r), known, count));
    }
  }
  struct Cell {
    std::size_t link;
    Xyz<T> place, normal;
  };
  template <std::size_t Most>
  [[nodiscard]] bool explained(const Xyz<T>& p, const Xyz<T>& n, const T& far,
                               const Surroundings<Most, Base, T>& known, std::size_t count) const noexcept {
    const Capsule<T> axis{p, p + far * n, T(0)};
    for (std::size_t k = 0; k < count; ++k)
      if (distance(p, known.obstacles[k].shape) <= far + T(s_.error) &&
          distance(axis, known.obstacles[k].shape).distance <= spread_ * far + T(s_.error))
        return true;
    return false;
  }

  [[no_unique_address]] M model_;
  SightSettings s_;
  T spread_;
  std::vector<Cell> cells_;
};

SKINCTL_END_NAMESPACE
