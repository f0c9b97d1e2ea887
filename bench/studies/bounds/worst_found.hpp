// The largest error found: inputs near the state of the largest bound, chosen for the signs of their roundings.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "bench/studies/bounds/aimed_roundings.hpp"
#include "bench/studies/bounds/box_search.hpp"

namespace skinctl::bounds {

/// Searches the errors of `program` in `R` against the same program with more digits.
///
/// An error is a sum of hundreds of roundings that come as they like: it is large where many of them may be large, which
/// the bound at a single state tells, and there for digits that `AimedRoundings` chooses. So the state of the largest bound is
/// searched first, then the inputs around it.
///
/// @param outputs  the results of the traced program.
template <class R>
class WorstFound {
  using Output = math::TracedOutput;
  using L = Output::L;

 public:
  WorstFound(const std::vector<Range>& ranges, std::vector<Output>& outputs, std::uint64_t seed)
      : ranges_(ranges), outputs_(outputs), rng_(seed) {}

  /// For `seconds` of processor time, at the result with the largest bound; for half of it each where a second one's is within
  /// a tenth.
  ///
  /// @param program  `near(x)`: a `ProgramNear<R>`; `errors(inputs)`: of each result.
  template <class Program>
  double run(const Program& program, double seconds) {
    std::vector<std::pair<Point, std::size_t>> starts;
    for (std::size_t k = 0; k < outputs_.size(); ++k)
      starts.emplace_back(steepest(outputs_[k], 0.1 * seconds / static_cast<double>(outputs_.size())), k);
    std::sort(starts.begin(), starts.end(),
              [](const auto& a, const auto& b) { return a.first.bound > b.first.bound; });
    const bool two = starts.size() > 1 && starts[1].first.bound > 0.9 * starts[0].first.bound;
    const std::size_t taken = two ? 2 : 1;
    const double share = seconds / static_cast<double>(taken);
    double worst = 0;
    for (std::size_t k = 0; k < taken; ++k) {
      const std::size_t output = starts[k].second;
      const Point start = climbed(outputs_[output], starts[k].first, 0.2 * share);
      worst = std::max(worst, aimed(program, output, start, 0.7 * share));
    }
    return worst;
  }

 private:
  struct Point {
    double bound = 0;
    std::vector<R> x;
  };

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
    for (std::size_t w = 0; w < Output::lanes; ++w) points[w].bound = errors.in_float[w];
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
      if (points[w].bound > best.bound || best.x.empty()) best = points[w];
  }
  /// The largest error of any result at inputs whose roundings are aimed at one, upwards and downwards in turn.
  template <class Program>
  double aimed(const Program& program, std::size_t output, const Point& start, double seconds) {
    const double begin = processor_seconds();
    double worst = 0, sign = 1;
    do {
      std::vector<R> x = start.x;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = near(x[i], ranges_[i], 0.002, 0.001);
      const auto at = program.near(x);
      const auto inputs = AimedRoundings<R>(at).largest(output, sign, rng_);
      for (const double e : program.errors(inputs)) worst = std::max(worst, std::abs(e));
      sign = -sign;
    } while (processor_seconds() - begin < seconds);
    return worst;
  }

  std::size_t index(std::size_t n) { return static_cast<std::size_t>(rng_() % n); }
  /// Within the range, and off its ends by `margin` of it.
  static R clamped(double x, const Range& r, double margin = 0) {
    const double off = margin * r.whole.width();
    return static_cast<R>(std::clamp(x, r.whole.low + off, r.whole.high - off));
  }
  /// Within `share` of the range.
  R near(R x, const Range& r, double share, double margin = 0) {
    return clamped(static_cast<double>(x) + share * r.whole.width() * (2 * unit_(rng_) - 1), r, margin);
  }
  /// Angles everywhere, rates near their ends.
  R anywhere(const Range& r) {
    const double u = unit_(rng_);
    if (r.weight >= 1) return clamped(r.whole.low + u * r.whole.width(), r);
    return clamped((1 - 0.1 * u) * (rng_() % 2 == 0 ? r.whole.low : r.whole.high), r);
  }

  const std::vector<Range>& ranges_;
  std::vector<Output>& outputs_;
  std::mt19937_64 rng_;
  std::uniform_real_distribution<double> unit_{0, 1};
  std::vector<L> lanes_;
};

}  // namespace skinctl::bounds
