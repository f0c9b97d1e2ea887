// SPDX-License-Identifier: BSD-3-Clause
// The mass that is felt at each cell of a link.
#pragma once

#include <span>
#include <vector>

#include "skinctl/dynamics/operational_mobility.hpp"
#include "skinctl/tactile/cell_place.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The mobility of a link about its origin, along its own axes: `A = J M^-1 J'` with the link's Jacobian J
/// and the joints' inertia M, 6 x 6, linear rows first.
template <Real T = double>
class LinkMobility {
 public:
  /// @param A     the link's mobility about its origin, along the base's axes.
  /// @param X_BL  the link's pose.
  template <class J, Frame B, Frame L>
  LinkMobility(const OperationalMobility<J>& A, const Transform<B, L, T>& X_BL) noexcept {
    const Xyz<T> axis[3] = {X_BL.axis_x(), X_BL.axis_y(), X_BL.axis_z()};
    T half[6][6];  // rows along the link's axes
    for (std::size_t s = 0; s < 6; ++s)
      for (std::size_t r = 0; r < 3; ++r) {
        half[r][s] = dot(axis[r], Xyz<T>{A(0, s), A(1, s), A(2, s)});
        half[r + 3][s] = dot(axis[r], Xyz<T>{A(3, s), A(4, s), A(5, s)});
      }
    for (std::size_t r = 0; r < 6; ++r)
      for (std::size_t s = 0; s < 3; ++s) {
        a_[r][s] = dot(axis[s], Xyz<T>{half[r][0], half[r][1], half[r][2]});
        a_[r][s + 3] = dot(axis[s], Xyz<T>{half[r][3], half[r][4], half[r][5]});
      }
  }
  [[nodiscard]] SKINCTL_INLINE const T& operator()(std::size_t r, std::size_t s) const noexcept {
    return a_[r][s];
  }

 private:
  T a_[6][6];
};

/// The unit wrenches `u = -[z; p x z]` of the cells of one link, for their mobilities: z is a cell's outward
/// normal, p its place [m], along the link's axes. Immutable.
template <Real T = double>
class CellMasses {
 public:
  CellMasses() = default;
  /// Takes those of `cells` that are on `link`, in their order.
  SKINCTL_COLD CellMasses(std::span<const CellPlace> cells, std::size_t link) {
    for (const CellPlace& c : cells) {
      if (c.link != link) continue;
      const Xyz<double> f = -c.normal, m = cross(c.place, f);
      const double u[6] = {f.x, f.y, f.z, m.x, m.y, m.z};
      for (std::size_t r = 0; r < 6; ++r) row_[r].push_back(T(u[r]));
    }
  }
  [[nodiscard]] std::size_t size() const noexcept { return row_[0].size(); }

  /// Writes the mobility `u' A u` of each cell [1/kg]: acceleration along its normal per force. The mass felt
  /// there is `1 / (u' A u)`: infinite, a mobility of 0, where the cell cannot move along its normal.
  SKINCTL_NOINLINE void mobilities(const LinkMobility<T>& A, std::span<T> out) const noexcept {
    SKINCTL_EXPECTS(out.size() >= size(), "room for each cell");
    const Rows u(row_);
    T* to = out.data();
    for (std::size_t i = 0; i < size(); ++i) to[i] = u.mobility(A, i);
  }
  /// Twice the energy [J] of the hardest collision of a cell with a free mass `body` [kg] at rest: the
  /// largest `speed^2 / (1/body + u' A u)` of the cells that move outwards, by their speed along the normal;
  /// 0 if none does. `v` is the velocity of the link's origin [m/s], `w` its angular velocity [rad/s], along
  /// its axes. With a spring of stiffness k between the two, its force peaks at `sqrt(k)` times the root of
  /// this.
  [[nodiscard]] SKINCTL_NOINLINE T hardest(const LinkMobility<T>& A, const Xyz<T>& v, const Xyz<T>& w,
                                           const T& body) const noexcept {
    const Rows u(row_);
    const T give = T(1) / body;
    T most(0);
    for (std::size_t i = 0; i < size(); ++i) {
      const T in = u.at[0][i] * v.x + u.at[1][i] * v.y + u.at[2][i] * v.z + u.at[3][i] * w.x +
                   u.at[4][i] * w.y + u.at[5][i] * w.z;
      const T hit = in < T(0) ? T(in * in / (give + u.mobility(A, i))) : T(0);
      most = hit > most ? hit : most;
    }
    return most;
  }
  /// The largest speed with which a cell moves outwards along its normal [m/s]; 0 if none does. `v`, `w`: the
  /// link's velocities, see `hardest`.
  [[nodiscard]] SKINCTL_NOINLINE T fastest(const Xyz<T>& v, const Xyz<T>& w) const noexcept {
    const Rows u(row_);
    T least(0);
    for (std::size_t i = 0; i < size(); ++i) {
      const T in = u.at[0][i] * v.x + u.at[1][i] * v.y + u.at[2][i] * v.z + u.at[3][i] * w.x +
                   u.at[4][i] * w.y + u.at[5][i] * w.z;
      least = in < least ? in : least;
    }
    return -least;
  }

 private:
  struct Rows {
    const T* at[6];
    SKINCTL_INLINE explicit Rows(const std::vector<T> (&rows)[6]) noexcept {
      for (std::size_t r = 0; r < 6; ++r) at[r] = rows[r].data();
    }
    [[nodiscard]] SKINCTL_INLINE T mobility(const LinkMobility<T>& A, std::size_t i) const noexcept {
      T sum(0);
      for (std::size_t r = 0; r < 6; ++r) {
        T row = T(0.5) * A(r, r) * at[r][i];
        for (std::size_t s = r + 1; s < 6; ++s) row = row + A(r, s) * at[s][i];
        sum = sum + at[r][i] * row;
      }
      return T(2) * sum;
    }
  };
  std::vector<T> row_[6];
};

SKINCTL_END_NAMESPACE
