// The largest error found: where the bound is largest, by trial, and by changing few inputs at a time of the worst trials.
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
/// An error is a sum of hundreds of roundings that come as they like: it is large where many of them may be large, which
/// the bound at a single state tells, and there by luck. So the state of the largest bound is searched first; then states
/// around it, and as many anywhere.
///
/// @param program  `errors<R, Wide>(x)`: of each result, at inputs x.
/// @param outputs  the results of the traced program.
template <class R, class Program>
class WorstFound {
  using Wide = std::conditional_t<std::is_same_v<R, float>, double, long double>;
  using Output = math::TracedOutput;
  using L = Output::L;

 public:
  WorstFound(const Program& program, const std::vector<Range>& ranges, std::vector<Output>& outputs,
             std::uint64_t seed)
      : program_(program), ranges_(ranges), outputs_(outputs), rng_(seed) {}

  struct Point {
    double error = 0;  ///< or its bound
    std::vector<R> x;
  };

  [[nodiscard]] double error(const std::vector<R>& x) {
    double worst = 0;
    for (const double e : program_.template errors<R, Wide>(x.data())) worst = std::max(worst, std::abs(e));
    return worst;
  }

  /// For `seconds` of processor time, of which both of the two results with the largest bounds get a half. Without rates a
  /// state is searched by trial alone: they are not many.
  Point run(double seconds) {
    moves_ = std::any_of(ranges_.begin(), ranges_.end(), [](const Range& r) { return r.weight < 1; });
    if (!moves_) {
      Point anywhere_at;
      for (const auto& r : ranges_) anywhere_at.x.push_back(anywhere(r));
      return lucky(anywhere_at, seconds);
    }
    std::vector<std::pair<Point, std::size_t>> starts;
    for (std::size_t k = 0; k < outputs_.size(); ++k)
      starts.emplace_back(steepest(outputs_[k], 0.1 * seconds / static_cast<double>(outputs_.size())), k);
    const std::size_t taken = std::min<std::size_t>(2, starts.size());
    std::partial_sort(starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(taken), starts.end(),
                      [](const auto& a, const auto& b) { return a.first.error > b.first.error; });
    Point best;
    for (std::size_t k = 0; k < taken; ++k) {
      const double share = 0.9 * seconds / static_cast<double>(taken);
      const Point start = climbed(outputs_[starts[k].second], starts[k].first, 0.25 * share);
      const Point found = lucky(start, 0.75 * share);
      if (found.error > best.error) best = found;
    }
    return best;
  }

 private:
  /// The bounds of as many states as there are lanes, exact inputs.
  void bounds_at(Output& output, Point* points) {
    lanes_.resize(output.inputs().size());
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      double x[Output::lanes];
      for (std::size_t w = 0; w < Output::lanes; ++w)
        x[w] = static_cast<double>(points[w].x[output.inputs()[i]]);
      lanes_[i] = L::load(x);
    }
    const auto errors = output(lanes_.data(), lanes_.data());
    for (std::size_t w = 0; w < Output::lanes; ++w) points[w].error = errors.in_float[w];
  }
  /// The state of the largest bound by trial.
  Point steepest(Output& output, double seconds) {
    const double begin = processor_seconds();
    Point best, points[Output::lanes];
    do {
      for (Point& p : points) {
        p.x.clear();
        for (const auto& r : ranges_) p.x.push_back(anywhere(r));
      }
      take_best(output, points, best);
    } while (processor_seconds() - begin < seconds);
    return best;
  }
  /// Uphill from there.
  Point climbed(Output& output, Point best, double seconds) {
    const double begin = processor_seconds();
    Point points[Output::lanes];
    do {
      for (Point& p : points) {
        p.x = best.x;
        for (std::size_t k = index(2) + 1; k > 0; --k) {
          const std::size_t i = index(ranges_.size());
          p.x[i] = ranges_[i].weight < 1 && index(2) == 0
                       ? clamped(-static_cast<double>(p.x[i]), ranges_[i])
                       : near(p.x[i], ranges_[i], 0.3 * std::pow(10.0, -3 * unit_(rng_)));
        }
      }
      take_best(output, points, best);
    } while (processor_seconds() - begin < seconds);
    return best;
  }
  void take_best(Output& output, Point* points, Point& best) {
    bounds_at(output, points);
    for (std::size_t w = 0; w < Output::lanes; ++w)
      if (points[w].error > best.error || best.x.empty()) best = points[w];
  }
  /// The largest error around a state, and anywhere: by trial for a third of the time, then by changing one or two
  /// inputs of the worst of both.
  Point lucky(const Point& start, double seconds) {
    const double begin = processor_seconds();
    std::vector<Point> best[2], all;
    const auto worse = [](const Point& a, const Point& b) { return a.error > b.error; };
    while (processor_seconds() - begin < seconds / 3)
      for (std::size_t k = 0; k < 64; ++k) {
        Point p = start;
        for (std::size_t i = 0; i < ranges_.size(); ++i)
          p.x[i] = moves_ && k % 2 == 0 ? near(p.x[i], ranges_[i], 0.016) : anywhere(ranges_[i]);
        p.error = error(p.x);
        std::vector<Point>& of = best[k % 2];
        if (of.size() >= 12 && p.error <= of.back().error) continue;
        of.insert(std::upper_bound(of.begin(), of.end(), p, worse), p);
        if (of.size() > 12) of.pop_back();
      }
    // The error of a program jumps from number to number: neighbours at every distance are tried, and close to where the bound
    // is largest if there are rates.
    const std::size_t steep = moves_ ? best[0].size() : 0;
    for (const auto& of : best) all.insert(all.end(), of.begin(), of.end());
    Point changed;
    for (std::size_t turn = 0; processor_seconds() - begin < seconds; ++turn) {
      const bool stays = turn % all.size() < steep;
      Point& p = all[turn % all.size()];
      for (int k = 0; k < 64; ++k) {
        changed.x = p.x;
        for (std::size_t n = index(2) + 1; n > 0; --n) {
          const std::size_t i = index(ranges_.size());
          const double reach = (stays ? 0.016 : 0.5) * std::pow(10.0, -6 * unit_(rng_));
          changed.x[i] = !stays && k % 16 == 0 ? anywhere(ranges_[i]) : near(p.x[i], ranges_[i], reach);
        }
        changed.error = error(changed.x);
        if (changed.error > p.error) p = changed;
      }
    }
    return *std::min_element(all.begin(), all.end(), worse);
  }

  std::size_t index(std::size_t n) { return static_cast<std::size_t>(rng_() % n); }
  static R clamped(double x, const Range& r) {
    return static_cast<R>(std::clamp(x, r.whole.low, r.whole.high));
  }
  /// Within `share` of the range.
  R near(R x, const Range& r, double share) {
    return clamped(static_cast<double>(x) + share * r.whole.width() * (2 * unit_(rng_) - 1), r);
  }
  /// Angles everywhere, rates near their ends.
  R anywhere(const Range& r) {
    const double u = unit_(rng_);
    if (r.weight >= 1) return clamped(r.whole.low + u * r.whole.width(), r);
    return clamped((1 - 0.1 * u) * (rng_() % 2 == 0 ? r.whole.low : r.whole.high), r);
  }

  const Program& program_;
  const std::vector<Range>& ranges_;
  std::vector<Output>& outputs_;
  std::mt19937_64 rng_;
  std::uniform_real_distribution<double> unit_{0, 1};
  std::vector<L> lanes_;
  bool moves_ = false;
};

}  // namespace skinctl::bounds
