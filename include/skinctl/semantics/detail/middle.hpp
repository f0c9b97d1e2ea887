// SPDX-License-Identifier: BSD-3-Clause
// The middle of numbers and of rotations.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/frames/transform.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
[[nodiscard]] inline double median(std::vector<double>& x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  if (x.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(x.begin(), middle));
}
/// The quantile `q`, 0 to 1, of `x`; 0 if `x` is empty.
[[nodiscard]] inline double quantile(std::vector<double> x, double q) {
  if (x.empty()) return 0;
  const auto at = x.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(x.size() - 1));
  std::nth_element(x.begin(), at, x.end());
  return *at;
}
/// The rotation with the least sum of squared angles to all given ones (Karcher), which are near each other.
[[nodiscard]] inline Rotation<double> mean_rotation(const std::vector<Rotation<double>>& all) {
  Rotation<double> mean = all[all.size() / 2];
  for (int i = 0; i < 5; ++i) {
    Xyz<double> off{0, 0, 0};
    for (const auto& R : all)
      off = off + (1.0 / static_cast<double>(all.size())) * log_so3(mean.transpose() * R);
    mean = normalised(mean * exp_so3(off));
    if (norm(off) < 1e-12) break;
  }
  return mean;
}
/// The median of the positions [m], with the mean of the rotations.
template <Frame A, Frame B>
[[nodiscard]] Transform<A, B> middle(const std::vector<Transform<A, B>>& all) {
  std::vector<double> x, y, z;
  std::vector<Rotation<double>> R;
  for (const auto& X : all) {
    x.push_back(X.origin().x), y.push_back(X.origin().y), z.push_back(X.origin().z);
    R.push_back(X.axes());
  }
  return Transform<A, B>::trusted(mean_rotation(R), {median(x), median(y), median(z)});
}
}  // namespace detail

SKINCTL_END_NAMESPACE
