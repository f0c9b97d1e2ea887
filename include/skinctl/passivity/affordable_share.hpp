// SPDX-License-Identifier: BSD-3-Clause
// The share of a torque for which some energy is enough.
#pragma once

#include <cmath>

#include "skinctl/core/real.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The share of an active torque that the energy `E` pays for. All of it costs `w1` + `w2` [J], a share alpha
/// `alpha w1 + alpha^2 w2`, w2 >= 0: 1 if all costs at most E, otherwise the root
/// `(-w1 + sqrt(w1^2 + 4 w2 E)) / (2 w2)` in [0, 1]. An E below 0 counts as 0. 0 for NaN.
template <Real T>
[[nodiscard]] SKINCTL_INLINE T affordable_share(const T& w1, const T& w2, const T& E) noexcept {
  using std::sqrt;
  const T left = E > T(0) ? E : T(0);
  if (w1 + w2 <= left) return T(1);
  // By the larger term, so that no square leaves the range.
  const T a = w1 < T(0) ? T(-w1) : w1, b = T(2) * (sqrt(w2) * sqrt(left)), most = a > b ? a : b;
  const T less = most > T(0) ? T((a > b ? b : a) / most) : T(0);
  const T root = most * sqrt(T(1) + less * less);
  // The same root in two forms: each is exact where the other one cancels.
  const T over = w1 > T(0) ? T(w1 + root) : T(2 * w2);
  const T share = over > T(0) ? T((w1 > T(0) ? T(2 * left) : T(root - w1)) / over) : T(0);
  return share > T(0) ? (share < T(1) ? share : T(1)) : T(0);
}

SKINCTL_END_NAMESPACE
