#include "skinctl/core/measurement.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace skinctl;

namespace {
template <class T>
State<2, T> state(Nanoseconds time, T q, T dq) {
  return {time, JointPosition<2, T>::constant(q), JointVelocity<2, T>::constant(dq)};
}
template <class T>
bool same(const State<2, T>& a, const State<2, T>& b) {
  return a.time == b.time && a.q == b.q && a.dq == b.dq;
}
struct Slow {
  template <class T>
  static bool believes(const State<2, T>& s) {
    return s.dq[0] <= T(1);
  }
};
}  // namespace

TEST_CASE_TEMPLATE("take_measurement: a newer good state takes the place of the old one", T, float, double) {
  auto good = state<T>(Nanoseconds(0), 0, 0);
  const auto next = state<T>(Nanoseconds(5), T(0.5), T(2));
  CHECK(take_measurement(good, next, Nanoseconds(9)) == Status{});
  CHECK(same(good, next));
  CHECK(take_measurement(good, state<T>(Nanoseconds(5), 1, 0), Nanoseconds(10)) == Status{});
  CHECK(good.q[1] == T(1));
}

TEST_CASE_TEMPLATE("take_measurement: what cannot be, or is older, leaves the last good state as it is", T,
                   float, double) {
  const auto first = state<T>(Nanoseconds(5), T(0.25), T(0.5));
  auto good = first;
  const T nan = std::numeric_limits<T>::quiet_NaN(), inf = std::numeric_limits<T>::infinity();
  for (const T bad : {nan, inf, T(-inf), std::numeric_limits<T>::max(), T(2e7)}) {
    auto q = state<T>(Nanoseconds(8), 0, 0), dq = q;
    q.q[1] = dq.dq[0] = bad;
    CHECK(take_measurement(good, q, Nanoseconds(8)) == Status(Reason::state_not_finite));
    CHECK(take_measurement(good, dq, Nanoseconds(8)) == Status(Reason::state_not_finite));
    CHECK(take_measurement(good, dq, Nanoseconds(8), Slow{}) == Status(Reason::state_not_finite));
  }
  CHECK(take_measurement(good, state<T>(Nanoseconds(4), 1, 0), Nanoseconds(8)) ==
        Status(Reason::time_backwards));
  CHECK(take_measurement(good, state<T>(Nanoseconds::min(), 1, 0), Nanoseconds(8)) ==
        Status(Reason::time_backwards));
  CHECK(take_measurement(good, state<T>(Nanoseconds(8), 0, 2), Nanoseconds(8), Slow{}) ==
        Status(Reason::state_out_of_range));
  CHECK(same(good, first));
}

TEST_CASE("take_measurement: a stamp in the future is that of now: nothing that comes later is refused") {
  auto good = state<double>(Nanoseconds(0), 0, 0);
  CHECK(take_measurement(good, state<double>(Nanoseconds::max(), 1, 0), Nanoseconds(8)) == Status{});
  CHECK(good.time == Nanoseconds(8));
  CHECK(take_measurement(good, state<double>(Nanoseconds(9), 2, 0), Nanoseconds(9)) == Status{});
  CHECK(good.q[0] == 2);
}
