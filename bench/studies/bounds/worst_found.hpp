// The largest error found: by trial, and by changing one input at a time of the worst trials.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <type_traits>
#include <vector>

#include "bench/studies/bounds/box_search.hpp"

namespace skinctl::bounds {

/// Searches the errors of `program` in `R` against the same program with more digits.
///
/// @param program  `errors<R, Wide>(x)`: of each result, at inputs x.
template <class R, class Program>
class WorstFound {
  using Wide = std::conditional_t<std::is_same_v<R, float>, double, long double>;

 public:
  WorstFound(const Program& program, const std::vector<Range>& ranges, std::uint64_t seed)
      : program_(program), ranges_(ranges), rng_(seed) {}

  struct Point {
    double error = 0;
    std::vector<R> x;
  };

  [[nodiscard]] double error(const std::vector<R>& x) {
    double worst = 0;
    for (const double e : program_.template errors<R, Wide>(x.data())) worst = std::max(worst, std::abs(e));
    return worst;
  }

  /// For `seconds` of processor time: a third of it at random, the rest around the worst.
  Point run(double seconds) {
    const double begin = processor_seconds();
    std::vector<Point> best;
    const auto worse = [](const Point& a, const Point& b) { return a.error > b.error; };
    const auto keep = [&](Point p) {
      if (best.size() >= 24 && p.error <= best.back().error) return;
      best.insert(std::upper_bound(best.begin(), best.end(), p, worse), std::move(p));
      if (best.size() > 24) best.pop_back();
    };
    while (processor_seconds() - begin < seconds / 3)
      for (int k = 0; k < 64; ++k) {
        Point p;
        for (const auto& r : ranges_) p.x.push_back(anywhere(r));
        p.error = error(p.x);
        keep(std::move(p));
      }
    // The error of a program jumps from number to number: neighbours at every distance are tried.
    for (std::size_t turn = 0; processor_seconds() - begin < seconds; ++turn) {
      Point& p = best[turn % best.size()];
      for (int k = 0; k < 64; ++k) {
        const std::size_t i = index(ranges_.size());
        const R before = p.x[i];
        const double reach = ranges_[i].whole.width() * std::pow(10.0, -6 * unit_(rng_));
        p.x[i] = k % 8 == 0 ? anywhere(ranges_[i])
                            : clamped(static_cast<double>(before) + reach * (unit_(rng_) - 0.5), ranges_[i]);
        const double e = error(p.x);
        if (e > p.error)
          p.error = e;
        else
          p.x[i] = before;
      }
    }
    return *std::min_element(best.begin(), best.end(), worse);
  }

 private:
  std::size_t index(std::size_t n) { return static_cast<std::size_t>(rng_() % n); }
  static R clamped(double x, const Range& r) {
    return static_cast<R>(std::clamp(x, r.whole.low, r.whole.high));
  }
  /// Angles everywhere, rates near their ends.
  R anywhere(const Range& r) {
    const double u = unit_(rng_);
    if (r.split) return clamped(r.whole.low + u * r.whole.width(), r);
    return clamped((1 - 0.1 * u) * (rng_() % 2 == 0 ? r.whole.low : r.whole.high), r);
  }

  const Program& program_;
  const std::vector<Range>& ranges_;
  std::mt19937_64 rng_;
  std::uniform_real_distribution<double> unit_{0, 1};
};

}  // namespace skinctl::bounds
