// SPDX-License-Identifier: BSD-3-Clause
// The virtual robot at one pose in modes, and the loops of contacts through it, one or two at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "skinctl/core/eigen_expression.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/passivity/detail/contact_path.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The modes P of inertia M and friction B: `P' M P = 1` and `P' B P = D`, diagonal, so that
/// `(M s^2 + B s)^-1 = P diag(1/(s (s + d_i))) P'`. For configuration time.
template <std::size_t N, Real T>
class ContactModes {
 public:
  ContactModes(const MassMatrix<N, T>& inertia, const MassMatrix<N, T>& friction) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Square> modes(square(friction), square(inertia));
    for (std::size_t k = 0; k < N; ++k) {
      for (std::size_t i = 0; i < N; ++i) P_[i][k] = modes.eigenvectors()(int(i), int(k));
      const T d = modes.eigenvalues()(int(k));
      d_[k] = d > T(0) ? d : T(0);
    }
  }

  /// Writes a contact's row in these modes, `P' row`, into `mode`.
  void row(const T (&contact)[N], T* mode) const {
    for (std::size_t k = 0; k < N; ++k) {
      mode[k] = T(0);
      for (std::size_t i = 0; i < N; ++i) mode[k] += P_[i][k] * contact[i];
    }
  }
  /// `a' (M s^2 + B s)^-1 b` at s = i w, of rows in modes.
  /// @param heavier  factor of M alone, by which force gains and friction are divided: `a' (f M s^2 + B s)^-1
  ///                 b`.
  [[nodiscard]] std::complex<T> compliance(const T* a, const T* b, const T& w,
                                           const T& heavier = T(1)) const {
    T real(0), imaginary(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T d = d_[i] / heavier;
      const T share = a[i] * b[i] / (heavier * w * (d * d + w * w));
      real -= share * w;
      imaginary -= share * d;
    }
    return {real, imaginary};
  }

 private:
  using Square = EigenMatrix<T, int(N), int(N)>;
  static Square square(const MassMatrix<N, T>& m) {
    Square out;
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) out(int(i), int(j)) = m(i, j);
    return out;
  }

  T P_[N][N], d_[N];
};

/// One or two contacts through the same virtual robot.
template <std::size_t N, Real T>
struct ContactLoops {
  static constexpr double vanishing = 1e-6;  ///< share of the largest value below which a locus has ended
  static constexpr int halvings = 10;  ///< halvings of a step of frequency in which a locus crosses: to 1e-4

  const ContactModes<N, T>& robot;
  const ContactPath<T>& path;
  const T* a;        ///< row of a contact in modes
  T gain_a;          ///< newtons at the law per newton at that contact
  const T* b;        ///< row of the other contact in modes; null: none
  T gain_b;          ///< newtons at the law per newton at the other contact
  T heavier = T(1);  ///< see `ContactModes::compliance`

  /// Calls `f(w, g)` wherever an eigenvalue of `W G path` passes the line of the imaginary part `loss` [m/N]
  /// on its left side, at -g [m/N], with G the compliance and W the gains of force. False if one begins
  /// beyond it: without friction nothing rests.
  template <class F>
  [[nodiscard]] bool each_crossing(const T& loss, F&& f) const {
    const auto& grid = path.grid();
    Loci before = loci(grid[0]);
    const T largest = std::max(std::abs(before.value[0]), std::abs(before.value[1]));
    for (const C& y : before.value)
      if (y.imag() >= loss && y.real() < T(0) && std::abs(y) > T(vanishing) * largest) return false;
    for (std::size_t n = 1; n < grid.size(); ++n) {
      const Loci now = next_to(before, grid[n]);
      for (int i = 0; i < (b == nullptr ? 1 : 2); ++i) {
        const C y = before.value[i], z = now.value[i];
        if ((y.imag() < loss) == (z.imag() < loss) || (y.real() >= T(0) && z.real() >= T(0))) continue;
        T low = grid[n - 1].w, high = grid[n].w;
        Loci left = before;
        C at = z;
        for (int part = 0; part < halvings; ++part) {
          const T w = T(0.5) * (low + high);
          const Loci m = next_to(left, {w, path.at(w)});
          if ((m.value[i].imag() < loss) == (y.imag() < loss)) {
            low = w, left = m;
          } else {
            high = w, at = m.value[i];
          }
        }
        if (at.real() < T(0)) f(high, T(-at.real()));
      }
      before = now;
    }
    return true;
  }

 private:
  using C = std::complex<T>;
  struct Loci {
    C value[2];
  };

  [[nodiscard]] Loci loci(const typename ContactPath<T>::Point& at) const {
    const C p = gain_a * robot.compliance(a, a, at.w, heavier);
    if (b == nullptr) return {{at.way * p, C(T(0))}};
    const C q = gain_b * robot.compliance(b, b, at.w, heavier), x = robot.compliance(a, b, at.w, heavier);
    const C middle = T(0.5) * (p + q), half = T(0.5) * (p - q);
    const C root = std::sqrt(half * half + gain_a * gain_b * x * x);
    return {{at.way * (middle + root), at.way * (middle - root)}};
  }
  /// The eigenvalues at `at`, in the order of `one`, those at a frequency near by.
  [[nodiscard]] Loci next_to(const Loci& one, const typename ContactPath<T>::Point& at) const {
    Loci two = loci(at);
    if (std::abs(two.value[0] - one.value[0]) + std::abs(two.value[1] - one.value[1]) >
        std::abs(two.value[1] - one.value[0]) + std::abs(two.value[0] - one.value[1]))
      std::swap(two.value[0], two.value[1]);
    return two;
  }
};

/// The factor by which contacts of `k` [N/m] are too stiff to rest with the gain margin `margin`: at most 1
/// if they do. Behind the contact is a wall (`body` 0), or a free body of that mass [kg], which gives way
/// with the robot; `k (1 + i loss)` is the stiffness with what the cover loses. `1/(k (1 + i loss)) + 1/(body
/// s^2) + margin g(s)` must not turn round zero.
template <std::size_t N, Real T>
[[nodiscard]] T lack_of(const ContactLoops<N, T>& loops, const T& k, const T& body, const T& loss,
                        const T& margin) {
  T most(0);
  const T softened = k * (T(1) + loss * loss);
  const bool begins = loops.each_crossing(loss / (softened * margin), [&](const T& w, const T& g) {
    most = std::max(most, margin * g + (body > T(0) ? T(1) / (body * w * w) : T(0)));
  });
  return begins ? softened * most : std::numeric_limits<T>::infinity();
}

}  // namespace detail
SKINCTL_END_NAMESPACE
