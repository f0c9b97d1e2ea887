// The virtual robot at one pose in modes, and the loops of contacts through it, one or two at a time.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "skinctl/core/eigen_expression.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/passivity/detail/contact_path.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `P' M P = 1` and `P' B P = D`, diagonal: then `(M s^2 + B s)^-1 = P diag(1/(s (s + d_i))) P'`. For configuration time.
template <std::size_t N, Real T>
class ContactModes {
 public:
  ContactModes(const MassMatrix<N, T>& inertia, const MassMatrix<N, T>& friction) {
    const Eigen::GeneralizedSelfAdjointEigenSolver<Square> modes(square(friction), square(inertia));
    const auto& P = modes.eigenvectors();
    const auto& d = modes.eigenvalues();
    for (std::size_t k = 0; k < N; ++k) {
      for (std::size_t i = 0; i < N; ++i) P_[i][k] = P(int(i), int(k));
      d_[k] = d(int(k)) > T(0) ? T(d(int(k))) : T(0);
    }
  }

  /// A contact's row in these modes: `P' row`.
  void row(const T (&contact)[N], T* mode) const {
    for (std::size_t k = 0; k < N; ++k) {
      mode[k] = T(0);
      for (std::size_t i = 0; i < N; ++i) mode[k] += P_[i][k] * contact[i];
    }
  }
  /// `a' (M s^2 + B s)^-1 b` at s = i w, of rows in modes.
  [[nodiscard]] std::complex<T> compliance(const T* a, const T* b, const T& w) const {
    T real(0), imaginary(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T share = a[i] * b[i] / (w * (d_[i] * d_[i] + w * w));
      real -= share * w;
      imaginary -= share * d_[i];
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

/// The stiffness up to which one contact (`b` null), or two of equal stiffness, are stable [N/m]: where an
/// eigenvalue of `W k (1 + s b G)^-1 G path` first passes -1, G the compliance, W the gains of force, `damping`
/// b along each contact [N s/m]. To 0.1 %.
template <std::size_t N, Real T>
[[nodiscard]] T stiffest_contacts(const ContactModes<N, T>& robot, const ContactPath<T>& path, const T* a,
                                  const T& gain_a, const T* b, const T& gain_b, const T& damping) {
  using C = std::complex<T>;
  using std::abs;
  using std::sqrt;
  const int count = b == nullptr ? 1 : 2;
  struct Loci {
    C value[2];
  };
  const auto loci = [&](const typename ContactPath<T>::Point& at) -> Loci {
    const C s(T(0), at.w), g = robot.compliance(a, a, at.w);
    if (b == nullptr) return {{gain_a * at.way * g / (T(1) + damping * s * g), C(T(0))}};
    const C h = robot.compliance(b, b, at.w), x = robot.compliance(a, b, at.w);
    // (1 + s b G)^-1 G = (G + s b det G) / det(1 + s b G), symmetric.
    const C det = g * h - x * x, under = T(1) + damping * s * (g + h) + damping * damping * s * s * det;
    const C p = gain_a * (g + damping * s * det) / under, q = gain_b * (h + damping * s * det) / under;
    const C both = gain_a * gain_b * x * x / (under * under);
    const C middle = T(0.5) * (p + q), half = T(0.5) * (p - q), root = sqrt(half * half + both);
    return {{at.way * (middle + root), at.way * (middle - root)}};
  };
  const auto match = [](const Loci& one, Loci& two) {
    if (abs(two.value[0] - one.value[0]) + abs(two.value[1] - one.value[1]) >
        abs(two.value[1] - one.value[0]) + abs(two.value[0] - one.value[1]))
      std::swap(two.value[0], two.value[1]);
  };
  const auto& grid = path.grid();
  T k = std::numeric_limits<T>::infinity();
  Loci before = loci(grid[0]);
  // Without friction the loop begins beyond -180 degrees: nothing rests.
  const T largest = std::max(abs(before.value[0]), abs(before.value[1]));
  for (const C& y : before.value)
    if (y.imag() >= T(0) && y.real() < T(0) && abs(y) > T(1e-6) * largest) return T(0);
  for (std::size_t n = 1; n < grid.size(); ++n) {
    Loci now = loci(grid[n]);
    match(before, now);
    for (int i = 0; i < count; ++i) {
      // Every crossing of the negative real axis counts, in either direction.
      const C y = before.value[i], z = now.value[i];
      if ((y.imag() < T(0)) == (z.imag() < T(0)) || (y.real() >= T(0) && z.real() >= T(0))) continue;
      T low = grid[n - 1].w, high = grid[n].w;
      Loci left = before;
      C at = z;
      for (int part = 0; part < 10; ++part) {
        const T w = T(0.5) * (low + high);
        Loci m = loci({w, path.at(w)});
        match(left, m);
        if ((m.value[i].imag() < T(0)) == (y.imag() < T(0))) {
          low = w, left = m;
        } else {
          high = w;
          at = m.value[i];
        }
      }
      if (at.real() < T(0) && T(-1) / at.real() < k) k = T(-1) / at.real();
    }
    before = now;
  }
  return k;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
