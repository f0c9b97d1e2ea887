// The largest error found: inputs near the states of the largest bounds, chosen for the signs of their
// roundings.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "bench/studies/bounds/aimed_roundings.hpp"
#include "bench/studies/bounds/box_search.hpp"

namespace skinctl::bounds {

/// Where the bound of a result is large.
struct SteepState {
  double bound = 0;  ///< in float
  std::size_t output = 0;
  std::vector<double> x;
};

/// Searches the states of the largest bounds. An error is a sum of hundreds of roundings that come as they
/// like: it is large where many of them may be large, which the bound at a single state tells, in float and
/// in double alike.
class SteepStates {
  using Output = math::TracedOutput;
  using L = Output::L;

 public:
  /// @param outputs  the results of the traced program.
  SteepStates(const std::vector<Range>& ranges, std::vector<Output>& outputs)
      : ranges_(ranges), outputs_(outputs) {}

  /// For `seconds` of processor time, from several starts: what came within a tenth of the largest.
  std::vector<SteepState> run(double seconds) {
    constexpr std::size_t starts = 4;
    std::vector<SteepState> found;
    for (std::size_t k = 0; k < starts; ++k) {
      SteepState best;
      for (std::size_t o = 0; o < outputs_.size(); ++o) {
        SteepState state = tried(o, 0.3 * seconds / static_cast<double>(starts * outputs_.size()));
        if (state.bound > best.bound) best = std::move(state);
      }
      found.push_back(climbed(std::move(best), 0.7 * seconds / starts));
    }
    const double most = std::max_element(found.begin(), found.end(), less)->bound;
    std::erase_if(found, [&](const SteepState& s) { return s.bound < 0.9 * most; });
    return found;
  }

 private:
  static bool less(const SteepState& a, const SteepState& b) noexcept { return a.bound < b.bound; }

  /// By trial.
  SteepState tried(std::size_t output, double seconds) {
    const double begin = processor_seconds();
    SteepState best{0, output, {}}, states[Output::lanes];
    do {
      for (SteepState& s : states) {
        s.x.clear();
        for (const Range& r : ranges_) s.x.push_back(anywhere(r));
      }
      take_best(states, best);
    } while (processor_seconds() - begin < seconds);
    return best;
  }
  /// Uphill from there.
  SteepState climbed(SteepState best, double seconds) {
    const double begin = processor_seconds();
    SteepState states[Output::lanes];
    do {
      for (SteepState& s : states) {
        s.x = best.x;
        for (std::size_t k = index(2) + 1; k > 0; --k) {
          const std::size_t i = index(ranges_.size());
          const Range& r = ranges_[i];
          const double by = 0.3 * std::pow(10.0, -3 * unit_(rng_)) * r.whole.width() * (2 * unit_(rng_) - 1);
          s.x[i] = clamped(r.weight < 1 && index(2) == 0 ? -s.x[i] : s.x[i] + by, r);
        }
      }
      take_best(states, best);
    } while (processor_seconds() - begin < seconds);
    return best;
  }
  /// Of as many states as there are lanes, exact inputs.
  void take_best(SteepState* states, SteepState& best) {
    Output& output = outputs_[best.output];
    lanes_.resize(output.inputs().size());
    for (std::size_t i = 0; i < lanes_.size(); ++i) {
      double x[Output::lanes];
      for (std::size_t w = 0; w < Output::lanes; ++w) x[w] = states[w].x[output.inputs()[i]];
      lanes_[i] = L::load(x);
    }
    const auto errors = output(lanes_.data(), lanes_.data());
    for (std::size_t w = 0; w < Output::lanes; ++w)
      if (errors.in_float[w] > best.bound || best.x.empty())
        best.bound = errors.in_float[w], best.x = states[w].x;
  }

  std::size_t index(std::size_t n) { return static_cast<std::size_t>(rng_() % n); }
  static double clamped(double x, const Range& r) { return std::clamp(x, r.whole.low, r.whole.high); }
  /// Angles everywhere, rates near their ends.
  double anywhere(const Range& r) {
    const double u = unit_(rng_);
    if (r.weight >= 1) return clamped(r.whole.low + u * r.whole.width(), r);
    return clamped((1 - 0.1 * u) * (rng_() % 2 == 0 ? r.whole.low : r.whole.high), r);
  }

  const std::vector<Range>& ranges_;
  std::vector<Output>& outputs_;
  std::mt19937_64 rng_{1};
  std::uniform_real_distribution<double> unit_{0, 1};
  std::vector<L> lanes_;
};

/// The largest error in `R` of any result, for `seconds` of processor time: around the states in turn,
/// roundings are aimed upwards and downwards.
///
/// @param program  `near(x)`: a `ProgramNear<R>`; `errors(inputs)`: of each result.
template <class R, class Program>
double worst_found(const Program& program, const std::vector<Range>& ranges,
                   const std::vector<SteepState>& states, double seconds) {
  const double begin = processor_seconds();
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> around(-1, 1);
  double worst = 0;
  std::size_t turn = 0;
  do {
    const SteepState& state = states[turn / 2 % states.size()];
    std::vector<R> x;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      // Room for the digits that are chosen.
      const auto& [low, high] = ranges[i].whole;
      const double width = high - low, off = 0.001 * width;
      x.push_back(
          static_cast<R>(std::clamp(state.x[i] + 0.002 * width * around(random), low + off, high - off)));
    }
    const ProgramNear<R> near = program.near(std::move(x));
    const double sign = turn++ % 2 == 0 ? 1 : -1;
    for (const double e : program.errors(AimedRoundings<R>(near).largest(state.output, sign, random)))
      worst = std::max(worst, std::abs(e));
  } while (processor_seconds() - begin < seconds);
  return worst;
}

}  // namespace skinctl::bounds
