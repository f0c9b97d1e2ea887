// SPDX-License-Identifier: BSD-3-Clause
// What recordings of a led hand are cut by: smoothing, velocities and their noise, stretches, levels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "skinctl/semantics/detail/middle.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Samples `begin` to `end - 1` of a recording.
struct Span {
  std::size_t begin = 0, end = 0;
};

namespace detail {
/// Weighted means of `x` around each sample: a Gaussian of deviation `sigma` [s], without delay.
template <class Samples, class X>
[[nodiscard]] std::vector<X> smoothed(const Samples& at, const std::vector<X>& x, double sigma) {
  std::vector<X> out(x.size());
  std::size_t first = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    while (at[i] - at[first] > 3 * sigma) ++first;
    double weights = 1;
    X sum = x[i];
    for (std::size_t j = first; j < x.size() && at[j] - at[i] <= 3 * sigma; ++j) {
      if (j == i) continue;
      const double u = (at[j] - at[i]) / sigma, w = std::exp(-0.5 * u * u);
      sum = sum + w * x[j];
      weights += w;
    }
    out[i] = (1 / weights) * sum;
  }
  return out;
}
/// Velocities by central differences [m/s].
[[nodiscard]] inline std::vector<Xyz<double>> velocities(const std::vector<double>& at,
                                                         const std::vector<Xyz<double>>& p) {
  std::vector<Xyz<double>> v(p.size(), Xyz<double>{0, 0, 0});
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t a = i > 0 ? i - 1 : 0, b = i + 1 < p.size() ? i + 1 : i;
    if (at[b] > at[a]) v[i] = (1 / (at[b] - at[a])) * Xyz<double>(p[b] - p[a]);
  }
  return v;
}
/// Root mean square of a velocity about its straight line in each window of 0.2 s, over the slowest 5 % of
/// them [m/s].
[[nodiscard]] inline double velocity_noise(const std::vector<double>& at, const std::vector<Xyz<double>>& v) {
  struct Window {
    double mean, square;
  };
  std::vector<Window> windows;
  for (std::size_t i = 0; i < v.size();) {
    double n = 0, st = 0, stt = 0, svv = 0;
    Xyz<double> sv{0, 0, 0}, stv{0, 0, 0};
    const double from = at[i];
    for (; i < v.size() && at[i] - from < 0.2; ++i) {
      const double t = at[i] - from;
      n += 1, st += t, stt += t * t, svv += dot(v[i], v[i]);
      sv = sv + v[i], stv = stv + t * v[i];
    }
    if (n < 4) continue;
    const double T = stt - st * st / n;
    const Xyz<double> TV = stv - (st / n) * sv;
    const double left = svv - dot(sv, sv) / n - (T > 0 ? dot(TV, TV) / T : 0);
    windows.push_back({norm(sv) / n, std::max(0.0, left) / n});
  }
  if (windows.empty()) return 0;
  const std::size_t count = std::max<std::size_t>(1, windows.size() / 20);
  std::partial_sort(windows.begin(), windows.begin() + static_cast<std::ptrdiff_t>(count), windows.end(),
                    [](const Window& a, const Window& b) { return a.mean < b.mean; });
  double square = 0;
  for (std::size_t i = 0; i < count; ++i) square += windows[i].square / static_cast<double>(count);
  return std::sqrt(square);
}
/// Stretches in which `on(i)` has begun and `off(i)` has not; gaps and stretches shorter than `least` [s] are
/// none.
template <class On, class Off>
[[nodiscard]] std::vector<Span> stretches(const std::vector<double>& at, Span in, double least, On&& on,
                                          Off&& off) {
  std::vector<Span> out;
  bool up = false;
  for (std::size_t i = in.begin; i < in.end; ++i) {
    if (!up && on(i)) {
      up = true;
      if (!out.empty() && at[i] - at[out.back().end - 1] < least)
        out.back().end = i + 1;
      else
        out.push_back({i, i + 1});
    } else if (up && off(i)) {
      up = false;
    }
    if (up) out.back().end = i + 1;
  }
  std::erase_if(out, [&](const Span& s) { return at[s.end - 1] - at[s.begin] < least; });
  return out;
}
/// Means of the lower and the upper of two clusters (Lloyd).
struct Levels {
  double low = 0, high = 0;
};
[[nodiscard]] inline Levels two_means(const std::vector<double>& x) {
  Levels m{*std::min_element(x.begin(), x.end()), *std::max_element(x.begin(), x.end())};
  for (int i = 0; i < 30; ++i) {
    const double border = 0.5 * (m.low + m.high);
    double low = 0, high = 0, lows = 0, highs = 0;
    for (const double v : x) (v < border ? low : high) += v, (v < border ? lows : highs) += 1;
    if (lows == 0 || highs == 0) break;
    m = {low / lows, high / highs};
  }
  return m;
}
}  // namespace detail

SKINCTL_END_NAMESPACE
