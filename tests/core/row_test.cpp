#include "skinctl/core/detail/row.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "skinctl/testing/sanitized.hpp"
#include "tests/support/random_robots.hpp"

using namespace skinctl;
using detail::Row;
using oracle::Random;

namespace {

/// Numbers of every kind; never all equal.
template <std::size_t N, class T>
JointVelocity<N, T> numbers(Random& rng) {
  const T odd[] = {
      T(0), T(-0.0), T(1), T(-3), std::numeric_limits<T>::infinity(), std::numeric_limits<T>::quiet_NaN()};
  return JointVelocity<N, T>::generate([&](std::size_t) {
    return rng.uniform(0, 1) < 0.5 ? odd[static_cast<std::size_t>(rng.uniform(0, 5.99))]
                                   : static_cast<T>(rng.uniform(-2, 2));
  });
}
template <class T>
bool same(const T& a, const T& b) {
  return a == b || (a != a && b != b);
}

template <class T, std::size_t N>
void agrees_with_plain_numbers() {
  Random rng(7);
  for (int k = 0; k < 300; ++k) {
    CAPTURE(N);
    const auto x = numbers<N, T>(rng), y = numbers<N, T>(rng);
    const Row<N, T> a(x), b(y);
    const auto low = T(-1), high = T(1);
    using V = JointVelocity<N, T>;
    const V sum(a + b), difference(a - b), product(a * b), ratio(a / b), opposite(-a), size(magnitude(a)),
        least(smaller(a, b)), within(clamp(a, low, high)), chosen(select(a < b, a, b));
    std::uint64_t below = 0, equal = 0, at_most = 0;
    for (std::size_t i = 0; i < N; ++i) {
      CHECK(same(sum[i], T(x[i] + y[i])));
      CHECK(same(difference[i], T(x[i] - y[i])));
      CHECK(same(product[i], T(x[i] * y[i])));
      CHECK(same(ratio[i], T(x[i] / y[i])));
      CHECK(same(opposite[i], T(-x[i])));
      CHECK(same(size[i], x[i] < T(0) ? T(-x[i]) : x[i]));
      CHECK(same(least[i], y[i] < x[i] ? y[i] : x[i]));
      CHECK(same(within[i], x[i] < low ? low : (x[i] > high ? high : x[i])));
      CHECK(same(chosen[i], x[i] < y[i] ? x[i] : y[i]));
      below |= std::uint64_t(x[i] < y[i]) << i;
      equal |= std::uint64_t(x[i] == y[i]) << i;
      at_most |= std::uint64_t(x[i] <= y[i]) << i;
    }
    constexpr std::uint64_t every = (std::uint64_t(1) << N) - 1;
    CHECK((a < b).bits() == below);
    CHECK((b > a).bits() == below);
    CHECK((a == b).bits() == equal);
    CHECK((a != b).bits() == (every & ~equal));
    CHECK((a <= b).bits() == at_most);
    CHECK((b >= a).bits() == at_most);
    CHECK(any(a < b) == (below != 0));
    CHECK(all(a < b) == (below == every));
    CHECK(any(!(a < b)) == (below != every));
    CHECK(all(!(a < b)) == (below == 0));
    CHECK(((a < b) & !(a == b)).bits() == below);
    CHECK(((a < b) | (a == b)).bits() == (below | equal));
  }
}

}  // namespace

TEST_CASE_TEMPLATE("Row: every number fares as it would alone, whatever the length", T, float, double,
                   long double) {
  agrees_with_plain_numbers<T, 1>();
  agrees_with_plain_numbers<T, 7>();
  agrees_with_plain_numbers<T, 16>();
  if constexpr (!testing::sanitized) {
    agrees_with_plain_numbers<T, 2>();
    agrees_with_plain_numbers<T, 3>();
    agrees_with_plain_numbers<T, 6>();
  }
}

TEST_CASE_TEMPLATE("Row: touches no number beside its own", T, float, double) {
  struct {
    T before = T(5);
    JointVelocity<6, T> own;
    T after[10] = {T(7), T(7), T(7), T(7), T(7), T(7), T(7), T(7), T(7), T(7)};
  } memory;
  (Row<6, T>(memory.own) + T(1)).store(memory.own);
  CHECK(memory.before == T(5));
  for (const T& x : memory.own) CHECK(x == T(1));
  for (const T& x : memory.after) CHECK(x == T(7));
}

TEST_CASE_TEMPLATE("Row: from numbers in registers, number by number", T, float, double) {
  const auto check = [](auto count) {
    constexpr std::size_t N = count;
    Random rng(9);
    const auto x =
        JointVelocity<N, T>::generate([&](std::size_t) { return static_cast<T>(rng.uniform(-2, 2)); });
    const auto row = Row<N, T>::of([&](auto i) { return x[i]; });
    CHECK(JointVelocity<N, T>(row) == x);
    for (std::size_t i = 0; i < N; ++i) CHECK(row[i] == x[i]);
  };
  check(std::integral_constant<std::size_t, 1>{});
  check(std::integral_constant<std::size_t, 3>{});
  check(std::integral_constant<std::size_t, 6>{});
  check(std::integral_constant<std::size_t, 7>{});
  check(std::integral_constant<std::size_t, 22>{});
}
