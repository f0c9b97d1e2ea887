#include "skinctl/tactile/unit_wrenches.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// A patch of `N` cells with random readings, against the sum cell by cell in long double.
template <std::size_t N, class Policy>
void sums_as_cell_by_cell() {
  using Stored = typename Policy::stored;
  using Summed = typename Policy::summed;
  Random random = seeded(N);
  const auto patch = random_patch<2, N>(random, 1);
  const UnitWrenches<Policy> units(patch);
  std::vector<Stored> readings(UnitWrenches<Policy>::padded(N), Stored(0));
  long double exact[6] = {}, size = 0;
  for (std::size_t i = 0; i < N; ++i) {
    readings[i] = static_cast<Stored>(5 * uniform<double>(random));
    const auto u = unit_wrench(patch.placed()[i].X_LC);
    const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
    for (std::size_t r = 0; r < 6; ++r) exact[r] += static_cast<long double>(row[r]) * readings[i];
    size += std::abs(static_cast<long double>(readings[i]));
  }
  Summed wrench[6];
  const AllocationGuard guard;
  units.weigh(readings.data(), wrench);
  const auto allocations = guard.count();
  CHECK(allocations == 0);
  const double epsilon = static_cast<double>(std::numeric_limits<Stored>::epsilon());
  constexpr bool in_steps = std::is_same_v<typename Policy::unit, std::int16_t>;
  double reach = 0;
  for (const auto& cell : patch.any()) {
    const auto m = unit_wrench(cell.X_LC).moment;
    reach = std::max({reach, std::abs(m.x), std::abs(m.y), std::abs(m.z)});
  }
  for (std::size_t r = 0; r < 6; ++r) {
    const double step = in_steps ? 0.5 / 32767 * (r < 3 ? 1 : reach) : 0;
    CHECK(std::abs(static_cast<double>(wrench[r] - exact[r])) <=
          (4 * epsilon + step) * static_cast<double>(size));
  }
  CHECK(units.bytes() == UnitWrenches<Policy>::padded(N) * 6 * sizeof(typename Policy::unit));
}

}  // namespace

TEST_CASE_TEMPLATE("UnitWrenches: the sum over cells, for any number of them", Policy, DoubleSum,
                   FloatStoredSum, FloatSum, ShortStoredSum) {
  using U = UnitWrenches<Policy>;
  static_assert(U::padded(0) == 0 && U::padded(1) == U::group && U::padded(U::group) == U::group &&
                U::padded(U::group + 1) == 2 * U::group);
  sums_as_cell_by_cell<1, Policy>();
  sums_as_cell_by_cell<3, Policy>();
  sums_as_cell_by_cell<8, Policy>();
  sums_as_cell_by_cell<17, Policy>();
  sums_as_cell_by_cell<100, Policy>();
}
