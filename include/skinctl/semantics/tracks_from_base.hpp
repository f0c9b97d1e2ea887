// SPDX-License-Identifier: BSD-3-Clause
// Things seen from a base that drives: their places in the world, and how sure they are after a drive.
#pragma once

#include "skinctl/model/moving_base.hpp"
#include "skinctl/semantics/tracks.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A thing as a detector on a base that drives saw it, with its place in the base: see `ClassDetection`.
template <Real T = double>
struct DetectionFromBase {
  Xyz<T> p_B{T(0), T(0), T(0)};  ///< position of the thing in Base [m]
  T sigma = T(0.005);            ///< deviation of the place in Base, along each axis [m], 1e-6 to 100
  ObjectClass kind = 0;          ///< class of the thing; 0: none
};

/// A detection from the base in the world, by the base's odometry at the time of the picture. The deviation
/// stays that of the detector: drift of the odometry moves all things alike, see `TracksFromBase::drove`.
template <Real T>
[[nodiscard]] ClassDetection<T> in_world(const BaseState<T>& base,
                                         const DetectionFromBase<T>& seen) noexcept {
  return {base.X_WB.origin() + base.X_WB.axes() * seen.p_B, seen.sigma, seen.kind};
}

/// `Tracks` in the world of a base's odometry.
///
/// Drift of the odometry moves all things in that world. So with each change of the base's deviations the
/// tracks' deviations grow,
///
///     sigma^2 <- sigma^2 + |change of base.sigma^2| + |change of base.sigma_turn^2| r^2,
///
/// r the distance from the base [m]: also where a map makes the base surer, which leaps then. A track whose
/// `sigma` is too large for a hand has to be looked at again; the picture finds it within the wider radius,
/// and is believed.
template <std::size_t Capacity, Real T = double>
class TracksFromBase : public Tracks<Capacity, T> {
  using Still = Tracks<Capacity, T>;

 public:
  using Still::aim;
  using Still::Still;
  struct Memory : Still::Memory {
    T base_sigma = T(0), base_turn = T(0);  ///< base's deviations in the tracks [m], [rad]
  };

  /// Takes the state of the base, and widens the tracks by the change of its deviations. Called before each
  /// picture that is taken from there, and before a track is chosen. A base that is no number, or whose
  /// deviations are negative or beyond 100 m or 10 rad, changes nothing (`sample_not_finite`,
  /// `sample_out_of_range`).
  Status drove(Memory& m, const BaseState<T>& base) const noexcept {
    const Xyz<T> o = base.X_WB.origin();
    const T sum = dot(o, o) + base.sigma + base.sigma_turn;
    if (!(sum - sum == T(0))) return Reason::sample_not_finite;
    const auto within = [](const T& x, double most) { return x >= T(0) && x <= T(most); };
    if (!within(base.sigma, 100) || !within(base.sigma_turn, 10)) return Reason::sample_out_of_range;
    using std::abs, std::sqrt;
    const auto change = [](const T& now, const T& before) { return abs(now * now - before * before); };
    const T moved = change(base.sigma, m.base_sigma), turned = change(base.sigma_turn, m.base_turn);
    for (Track<T>& t : m.tracks) {
      if (t.kind == 0) continue;
      const Xyz<T> way = t.p - o;
      t.sigma = sqrt(t.sigma * t.sigma + moved + turned * dot(way, way));
    }
    m.base_sigma = base.sigma, m.base_turn = base.sigma_turn;
    return {};
  }
  /// The place in the world [m] to which a hand on the base goes for a thing seen at `p_W`: the bias between
  /// camera and hand turns with the base.
  [[nodiscard]] Xyz<T> aim(const Memory& m, const Xyz<T>& p_W, const BaseState<T>& base) const noexcept {
    return p_W + base.X_WB.axes() * Still::aim(m, Xyz<T>{T(0), T(0), T(0)});
  }
};

SKINCTL_END_NAMESPACE
