// Sums of a patch in steps, for processors that do not compute in double, against those in double.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "skinctl/tactile/detail/cell_table.hpp"
#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

detail::CellTable random_table(Random& rng, std::size_t cells, double reach) {
  std::vector<detail::AnyCell> placed;
  for (std::uint32_t id = 0; id < cells; ++id)
    placed.push_back(
        {id, Transform<detail::AnyLink, Cell>(random_rotation<double>(rng), random_xyz(rng, reach))});
  detail::CellTable table(cells);
  table.add(placed.data(), placed.size(), 0, 0);
  return table;
}

}  // namespace

TEST_CASE("ExactSums: steps are the sums in double, bit for bit, and one rounding from them in float") {
  static_assert(detail::computes_in_double && !detail::ExactSums::in_steps);
  using Steps = detail::ExactSumsIn<std::int64_t>;
  using Double = detail::ExactSumsIn<double>;
  Random rng = seeded(5);
  for (const double reach : {1e-3, 0.09, 0.5, 3.0}) {
    const auto table = random_table(rng, 300, reach);
    Steps steps;
    Double sums;
    const auto compare = [&] {
      for (std::size_t r = 0; r < 6; ++r)
        for (const bool force : {false, true}) {
          const double exact = (force ? sums.force : sums.proximity)[r];
          const std::int64_t* of = force ? steps.force : steps.proximity;
          CAPTURE(exact);
          CHECK(Steps::at<double>(of, r, table[7]) == exact);
          const double error = static_cast<double>(Steps::at<float>(of, r, table[7])) - exact;
          CHECK(std::abs(error) <= std::abs(exact) * 0x1p-23);
        }
    };
    for (int k = 0; k < 3000; ++k) {
      const std::size_t i = rng() % table.size();
      const int force = static_cast<int>(rng() % 131071u) - 65535,
                proximity = static_cast<int>(rng() % 3u) - 1;
      steps.add(table[i], force, proximity);
      sums.add(table[i], force, proximity);
      if (k % 10 == 0) compare();
    }
    // As many as one sum may have, all alike and pressed as hard as a reading says.
    steps = {}, sums = {};
    for (std::size_t k = 0; k < Steps::most_cells; ++k) {
      steps.add(table[3], 65535, -65535);
      sums.add(table[3], 65535, -65535);
    }
    compare();
  }
}
