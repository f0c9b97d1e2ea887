// Promise: a masked cell counts as the cells around it say, never more than the largest of their readings
// Tried: weights of two rings solve their equations, those that are learnt are the best >= 0 of a sum <=
// 1; multiples of 2^-24. Round pressures of 1.6 to 3 cells, 10 and 30 % masked: a reading is off by 0.53
// and 0.62 of what the neighbours' mean is; torque of a UR5 off by 4.1 and 10.4 % at 1.6 pitches (mean:
// 5.5 and 12.4). Also: studies `skin_fill_in`, `skin_grasps`

#include "skinctl/tactile/fill_in.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "skinctl/testing/random.hpp"
#include "tests/support/square_of_cells.hpp"

using namespace skinctl;
using namespace skinctl::testing;

TEST_CASE("FillIn: weights are >= 0, multiples of 2^-24, of sum <= 1; the mean fills a plane within 1e-6") {
  const CellGraph g = square_graph(5);
  const FillIn mean(g);
  for (std::size_t i = 0; i < 25; ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < g.neighbours(i).size(); ++k) {
      const double steps = mean.weight(i, k) / FillIn::unit;
      CHECK(steps == std::floor(steps));
      CHECK(mean.weight(i, k) >= 0);
      sum += mean.weight(i, k);
    }
    CHECK(sum <= 1);
    CHECK(sum > 1 - 1e-6);
  }
  const auto plane = [](std::size_t j) { return 3.0 + double(j % 5) + 2.0 * double(j / 5); };
  const auto all = [](std::size_t) { return true; };
  for (const std::size_t i : {6u, 7u, 12u, 18u})
    CHECK(mean.filled(i, plane, all) == doctest::Approx(plane(i)).epsilon(1e-6));
  // Of masked neighbours the mean of theirs counts, or that of the others. With none, nothing is filled in.
  const auto one = [&](std::size_t j) { return j == 7; };
  CHECK(mean.filled(12, plane, one) == doctest::Approx(plane(7)).epsilon(1e-6));
  // Cell 6 lies beside 1, 7 beside both, 8, 17 and 18 beside 13; 11 and 16 beside neither.
  const auto two = [&](std::size_t j) { return j == 1 || j == 13; };
  const double a = plane(1), b = plane(13);
  CHECK(mean.filled(12, plane, two) == doctest::Approx((a + 0.5 * (a + b) + 4 * b) / 6).epsilon(1e-6));
  CHECK(mean.filled(12, plane, [](std::size_t) { return false; }) == 0);
  CHECK(FillIn().filled(0, plane, all) == 0);
}

TEST_CASE("FillIn: weights of two rings are the best linear guess for a random field") {
  const auto cells = square_places(9);
  const CellGraph g = square_graph(9);
  const FillIn field(g, cells);
  const auto apart = [&](std::size_t a, std::size_t b) {
    const auto way = cells[a].place - cells[b].place;
    return std::sqrt(dot(way, way));
  };
  bool below_zero = false;
  for (const std::size_t i : {0u, 4u, 40u, 41u, 80u}) {
    CAPTURE(i);
    double pitch = 0;
    for (const auto j : g.neighbours(i)) pitch += apart(i, j) / double(g.neighbours(i).size());
    const auto correlation = [&](std::size_t a, std::size_t b) {
      const double x = std::sqrt(3.0) * apart(a, b) / (2 * pitch);
      return (1 + x) * std::exp(-x);
    };
    const auto from = field.around(i);
    CHECK(from.size() == (i == 0 ? 8 : i == 80 ? 8 : i == 4 ? 14 : 24));
    for (std::size_t a = 0; a < from.size(); ++a) {
      double sum = 0.01 * field.weight(i, a) - correlation(i, from[a]);
      for (std::size_t b = 0; b < from.size(); ++b) sum += correlation(from[a], from[b]) * field.weight(i, b);
      CHECK(std::abs(sum) < 24 * FillIn::unit);
      below_zero = below_zero || field.weight(i, a) < 0;
    }
  }
  CHECK(below_zero);
}

TEST_CASE("FillIn: two rings fill in a pressure better than the mean, and stay within the readings around") {
  const std::size_t n = 9;
  const CellGraph g = square_graph(n);
  const FillIn field(g, square_places(n)), mean(g);
  Random rng = seeded(14);
  for (const double share : {0.1, 0.3}) {
    double by_field = 0, by_mean = 0;
    int outside = 0;
    for (int frame = 0; frame < 500; ++frame) {
      const double x = uniform(rng, 2.0, 6.0), y = uniform(rng, 2.0, 6.0), r = uniform(rng, 1.6, 3.0);
      std::vector<double> s(n * n);
      std::vector<bool> masked(n * n);
      for (std::size_t i = 0; i < n * n; ++i) {
        const double far = (std::pow(double(i % n) - x, 2) + std::pow(double(i / n) - y, 2)) / (r * r);
        s[i] = far < 1 ? std::sqrt(1 - far) : 0;
        masked[i] = uniform(rng, 0.0, 1.0) < share;
      }
      const double most = *std::max_element(s.begin(), s.end());
      for (std::size_t i = 0; i < n * n; ++i) {
        if (!masked[i]) continue;
        const auto reading = [&](std::size_t j) { return masked[j] ? NAN : s[j]; };
        const auto counts = [&](std::size_t j) { return !masked[j]; };
        const double f = field.filled(i, reading, counts);
        outside += f < 0 || f > most;
        by_field += std::abs(f - s[i]), by_mean += std::abs(mean.filled(i, reading, counts) - s[i]);
      }
    }
    MESSAGE((100 * share) << " % masked: error by two rings " << by_field / by_mean
                          << " of that by the mean");
    CHECK(outside == 0);
    CHECK(by_field < 0.7 * by_mean);
  }
}

TEST_CASE("FillIn: cells without neighbours, at one place, or that face away") {
  std::vector<CellPlace> cells(6);
  for (CellPlace& c : cells) c.place = {0.1, 0.2, 0.3};
  cells[5].normal = {0.0, 0.0, -1.0};
  std::vector<std::vector<CellGraph::Index>> lists = {{1, 2}, {0, 2, 5}, {0, 1}, {}, {}, {1}};
  const CellGraph g(lists);
  const FillIn field(g, cells);
  const auto all = [](std::size_t) { return true; };
  CHECK(field.filled(0, [](std::size_t) { return 2.0; }, all) == doctest::Approx(2).epsilon(0.01));
  CHECK(field.filled(3, [](std::size_t) { return 2.0; }, all) == 0);
  CHECK(field.around(1).size() == 2);
  CHECK(field.around(5).empty());
  cells.pop_back();
  CHECK_THROWS_AS(FillIn(g, cells), ConfigurationError);
}
