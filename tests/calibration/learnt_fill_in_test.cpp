#include "skinctl/calibration/learnt_fill_in.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/testing/random.hpp"
#include "tests/support/square_of_cells.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// What the weights of cell i cost: squared errors and ridge.
double cost(const CellGraph& g, const std::vector<float>& frames, std::size_t i, const std::vector<double>& w,
            double ridge) {
  const auto near = g.neighbours(i);
  double sum = 0, energy = 0;
  for (std::size_t f = 0; f < frames.size(); f += g.size()) {
    double e = double(frames[f + i]);
    for (std::size_t k = 0; k < near.size(); ++k) {
      e -= w[k] * double(frames[f + near[k]]);
      energy += std::pow(double(frames[f + near[k]]), 2) / double(near.size());
    }
    sum += e * e;
  }
  for (const double x : w) sum += ridge * energy * x * x;
  return sum;
}

}  // namespace

TEST_CASE("learnt_fill_in: weights are the best that are >= 0, and fill in what they have learnt") {
  const CellGraph g = square_graph(4);
  Random rng = seeded(4);
  std::vector<float> frames;
  for (int f = 0; f < 300; ++f) {
    const double x = uniform<double>(rng, -0.5, 3.5), y = uniform<double>(rng, -0.5, 3.5), r = 1.6;
    for (std::size_t i = 0; i < 16; ++i) {
      const double far = (std::pow(double(i % 4) - x, 2) + std::pow(double(i / 4) - y, 2)) / (r * r);
      frames.push_back(static_cast<float>(far < 1 ? std::sqrt(1 - far) : 0));
    }
  }
  const double ridge = 0.03;
  const FillIn learnt = learnt_fill_in(g, frames, ridge), mean(g);
  for (std::size_t i = 0; i < 16; ++i) {
    std::vector<double> w, m;
    double sum = 0;
    for (std::size_t k = 0; k < g.neighbours(i).size(); ++k) {
      w.push_back(learnt.weight(i, k)), m.push_back(mean.weight(i, k));
      sum += w.back();
      CHECK(w.back() >= 0);
    }
    CHECK(sum <= 1);
    const double best = cost(g, frames, i, w, ridge);
    CHECK(best <= cost(g, frames, i, m, ridge) * (1 + 1e-9));
    if (sum > 1 - 1e-6) continue;  // scaled to a sum of 1: no longer the optimum
    for (std::size_t k = 0; k < w.size(); ++k)
      for (const double d : {-0.01, 0.01}) {
        auto v = w;
        v[k] = std::max(0.0, v[k] + d);
        CHECK(cost(g, frames, i, v, ridge) >= best * (1 - 1e-6));
      }
  }
}

TEST_CASE("learnt_fill_in: a cell that was never touched takes the mean; wrong recordings are refused") {
  const CellGraph g = square_graph(3);
  const FillIn learnt = learnt_fill_in(g, std::vector<float>(90, 0.0f)), mean(g);
  for (std::size_t i = 0; i < 9; ++i)
    for (std::size_t k = 0; k < g.neighbours(i).size(); ++k) CHECK(learnt.weight(i, k) == mean.weight(i, k));
  CHECK_THROWS_AS(static_cast<void>(learnt_fill_in(g, std::vector<float>(10, 0.0f))), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(learnt_fill_in(g, std::vector<float>(9, -1.0f))), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(learnt_fill_in(g, std::vector<float>(9, std::nanf("")))),
                  ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(learnt_fill_in(g, std::vector<float>(9, 0.0f), 0.0)), ConfigurationError);
}
