#include "skinctl/math/exact_sum.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/testing/allocation_guard.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

template <class T>
using ExactSum = math::Sum<T, math::Exact>;

constexpr double cancelled() {
  ExactSum<double> sum;
  for (const double x : {1e300, 1.0, 1e-300, -1e300, -1.0}) sum += x;
  return sum.value();
}
static_assert(cancelled() == 1e-300);
static_assert(sizeof(ExactSum<float>) == 96 && sizeof(ExactSum<double>) == 552);
static_assert(std::is_trivially_copyable_v<ExactSum<float>>);

/// Any finite number: every bit pattern as likely as any other.
template <class T>
T any_finite(Random& random) {
  using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t, std::uint32_t>;
  for (;;) {
    const T x = std::bit_cast<T>(static_cast<Bits>(random()));
    if (x - x == T(0)) return x;
  }
}

/// The sum as a whole number of smallest subnormals, rounded by its bits: another way to the same result.
template <class T>
T rounded_once(const std::vector<T>& terms) {
  using boost::multiprecision::cpp_int;
  constexpr int digits = std::numeric_limits<T>::digits;
  constexpr int lowest = std::numeric_limits<T>::min_exponent - digits;
  cpp_int total = 0;
  for (const T x : terms) {
    int exponent = 0;
    const T fraction = std::frexp(x, &exponent);
    if (x == T(0)) continue;
    const int place = std::max(exponent - digits, lowest);
    cpp_int whole = static_cast<long long>(std::ldexp(fraction, exponent - place));
    total += whole * (cpp_int(1) << (place - lowest));
  }
  const bool negative = total < 0;
  cpp_int size = negative ? cpp_int(-total) : total;
  if (size == 0) return T(0);
  const int top = static_cast<int>(msb(size));
  const int drop = std::max(0, top + 1 - digits);
  cpp_int kept = size >> drop;
  const cpp_int rest = size - (kept << drop);
  if (drop > 0) {
    const cpp_int half = cpp_int(1) << (drop - 1);
    if (rest > half || (rest == half && (kept & 1) != 0)) ++kept;
  }
  const T value = std::ldexp(static_cast<T>(static_cast<long long>(kept)), drop + lowest);
  return negative ? -value : value;
}

}  // namespace

TEST_CASE_TEMPLATE("exact Sum: the true sum rounded once, whatever bits the terms have", T, float, double) {
  Random random = seeded(1);
  for (int k = 0; k < 2000; ++k) {
    std::vector<T> terms(1 + random() % 30);
    for (T& x : terms) {
      x = any_finite<T>(random);
      if (k % 3 == 1) x = std::ldexp(static_cast<T>(uniform(random, -1.0, 1.0)), int(random() % 60));
      if (k % 3 == 2 && random() % 2 == 0)
        x = static_cast<T>(random() % 16) * std::numeric_limits<T>::denorm_min();
    }
    if (k % 5 == 0)  // all but one cancel
      for (std::size_t i = 0, n = terms.size(); i + 1 < n; ++i) terms.push_back(-terms[i]);
    ExactSum<T> sum;
    for (const T x : terms) sum += x;
    CHECK(sum.value() == rounded_once(terms));
  }
}

TEST_CASE_TEMPLATE("exact Sum: one term is itself, to the bit; the ends of the range", T, float, double) {
  Random random = seeded(2);
  for (int k = 0; k < 20000; ++k) {
    const T x = any_finite<T>(random);
    CHECK(ExactSum<T>(x).value() == x);
  }
  constexpr T most = std::numeric_limits<T>::max(), least = std::numeric_limits<T>::denorm_min();
  constexpr T infinity = std::numeric_limits<T>::infinity();
  CHECK(ExactSum<T>(least).value() == least);
  CHECK(ExactSum<T>(std::numeric_limits<T>::min()).value() == std::numeric_limits<T>::min());
  CHECK_FALSE(std::signbit(ExactSum<T>(T(-0.0)).value()));
  ExactSum<T> sum(most);
  CHECK(sum.value() == most);
  sum += most;
  CHECK(sum.value() == infinity);
  sum -= most;
  CHECK(sum.value() == most);  // partial sums may pass the range
  sum += std::ldexp(most - std::nextafter(most, T(0)), -2);
  CHECK(sum.value() == most);  // less than half a unit
  sum += std::ldexp(most - std::nextafter(most, T(0)), -2);
  CHECK(sum.value() == infinity);  // a tie, away from the odd last digit
}

TEST_CASE_TEMPLATE("exact Sum: ties go to the even neighbour, and a last digit below them decides", T, float,
                   double) {
  const T half = std::numeric_limits<T>::epsilon() / 2, least = std::numeric_limits<T>::denorm_min();
  const T next = T(1) + std::numeric_limits<T>::epsilon();
  const auto sum_of = [](std::initializer_list<T> terms) {
    ExactSum<T> sum;
    for (const T x : terms) sum += x;
    return sum.value();
  };
  CHECK(sum_of({T(1), half}) == T(1));
  CHECK(sum_of({T(1), half, least}) == next);
  CHECK(sum_of({T(1), half, -least}) == T(1));
  CHECK(sum_of({next, half}) == next + std::numeric_limits<T>::epsilon());
  CHECK(sum_of({next, half, -least}) == next);
  CHECK(sum_of({T(-1), -half, -least}) == -next);
}

TEST_CASE_TEMPLATE("exact Sum: any order, any grouping, the same bits", T, float, double) {
  Random random = seeded(3);
  std::vector<T> terms(1000);
  for (T& x : terms) x = std::ldexp(static_cast<T>(uniform(random, -1.0, 1.0)), int(random() % 80) - 40);
  ExactSum<T> forward;
  for (const T x : terms) forward += x;
  for (int k = 0; k < 20; ++k) {
    std::shuffle(terms.begin(), terms.end(), random);
    ExactSum<T> parts[3];
    for (std::size_t i = 0; i < terms.size(); ++i) parts[i % 3] += terms[i];
    parts[0] += parts[1];
    parts[2] += parts[0];
    CHECK(parts[2].value() == forward.value());
  }
  ExactSum<T> nothing = forward;
  for (const T x : terms) nothing -= x;
  CHECK(nothing.value() == T(0));
}

TEST_CASE_TEMPLATE("exact Sum: doubling it a hundred times carries as it should", T, float, double) {
  // As many terms as nobody can add one by one: 2^50.
  ExactSum<T> sum(T(3)), negative(T(-3));
  for (int i = 0; i < 50; ++i) {
    sum += ExactSum<T>(sum);
    negative += ExactSum<T>(negative);
  }
  CHECK(sum.value() == std::ldexp(T(3), 50));
  CHECK(negative.value() == std::ldexp(T(-3), 50));
  sum += negative;
  CHECK(sum.value() == T(0));
}

TEST_CASE_TEMPLATE("exact Sum: NaN and infinities as in IEEE 754, and no allocation", T, float, double) {
  constexpr T infinity = std::numeric_limits<T>::infinity();
  ExactSum<T> sum(T(1));
  const AllocationGuard guard;
  sum += infinity;
  const T up = sum.value();
  sum += T(-5);
  const T still_up = sum.value();
  sum += -infinity;
  const T both = sum.value();
  ExactSum<T> nan(std::numeric_limits<T>::quiet_NaN());
  nan += T(1);
  const auto allocations = guard.count();
  CHECK(up == infinity);
  CHECK(still_up == infinity);
  CHECK(std::isnan(both));
  CHECK(std::isnan(nan.value()));
  CHECK(allocations == 0);
}
