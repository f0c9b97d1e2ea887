#include "skinctl/tactile/fill_in.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// A square of n x n cells, 1 apart.
CellGraph square(std::size_t n) {
  std::vector<CellPlace> cells(n * n);
  for (std::size_t i = 0; i < n * n; ++i) cells[i].place = {0.03 * double(i % n), 0.03 * double(i / n), 0.0};
  return CellGraph(cells, 1.5);
}
}  // namespace

TEST_CASE("FillIn: weights are >= 0, multiples of 2^-24, of sum <= 1; the mean fills a plane within 1e-6") {
  const CellGraph g = square(5);
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
  // Masked neighbours do not count; the others count for them. With none, nothing is filled in.
  const auto one = [&](std::size_t j) { return j == 7; };
  CHECK(mean.filled(12, plane, one) == doctest::Approx(plane(7)).epsilon(1e-6));
  CHECK(mean.filled(12, plane, [](std::size_t) { return false; }) == 0);
  CHECK(FillIn().filled(0, plane, all) == 0);
}

TEST_CASE("FillIn: weights that are given are rounded down; wrong ones are refused") {
  const CellGraph g = square(2);  // four cells, three neighbours each
  const FillIn given(g, std::vector<double>(12, 0.3));
  CHECK(given.weight(3, 2) <= 0.3);
  CHECK(given.weight(3, 2) > 0.3 - FillIn::unit);
  for (const double wrong : {-0.1, 0.34, 1.1, std::nan("")})
    CHECK_THROWS_AS(FillIn(g, std::vector<double>(12, wrong)), ConfigurationError);
  CHECK_THROWS_AS(FillIn(g, std::vector<double>(11, 0.3)), ConfigurationError);
}
