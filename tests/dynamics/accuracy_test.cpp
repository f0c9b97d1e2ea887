// by night: many models in 50 digits; other tests sample their states
// not sanitized: the compiler takes minutes for so many models and digits
//
// Promise: errors are stated, next to singular, at q = 1e6 rad, masses from 1e-6 to 1e6 kg
// Tried: the table. Also: program `accuracy`

#include "tests/support/digits.hpp"
#if SKINCTL_MANY_DIGITS

#include <doctest/doctest.h>

#include "tests/support/accuracy.hpp"

using namespace skinctl;
using namespace skinctl::testing;

// What the README's table of accuracy promises, at a few of its states; the table itself is printed by
// bench/report/accuracy.cpp.

namespace {

constexpr int some = 100;

template <class T, RobotModel M, class F>
Ulps worst(const M& model, const Exact& exact, int states, F&& choose) {
  constexpr std::size_t N = M::joints;
  oracle::Random random(3);
  Ulps all;
  for (int k = 0; k < states; ++k) {
    testing::Motion<N, T> at(random);
    choose(random, at);
    all.note(ulps_at<T>(model, exact, at.q, at.dq, at.ddq));
  }
  return all;
}

/// The bounds that hold wherever the arm stands and however fast it is: poses to a pose's rounding, torques
/// to a few roundings a link.
void check(const Ulps& u) {
  CHECK(u.pose <= 4);
  CHECK(u.jacobian <= 4);
  CHECK(u.inverse_dynamics <= 16);
  CHECK(u.gravity <= 16);
  CHECK(u.mass <= 8);
  CHECK(u.explained <= 16);
}

template <class F>
void check_arm(const char* what, F&& choose) {
  CAPTURE(what);
  const ur5::Model model;
  static const Exact exact = exact_tree(model);
  check(worst<double>(model, exact, some, choose));
  check(worst<float>(model, exact, some, choose));
}

}  // namespace

TEST_CASE("accuracy: a UR5 to a few units in the last place, at any state, float and double") {
  const double pi = 3.14159265358979323846;
  check_arm("random", [](auto&, auto&) {});
  check_arm("straight", [](auto&, auto& at) { at.q = {}; });
  check_arm("upright", [&](auto&, auto& at) {
    using T = std::remove_cvref_t<decltype(at.q[0])>;
    at.q = {};
    at.q[1] = at.q[3] = static_cast<T>(-pi / 2);
  });
  check_arm("elbow and wrist singular", [&](auto& random, auto& at) {
    using T = std::remove_cvref_t<decltype(at.q[0])>;
    at.q[2] = random.index(2) == 0 ? T(0) : static_cast<T>(pi);
    at.q[4] = random.index(2) == 0 ? T(0) : static_cast<T>(pi);
  });
  check_arm("q = 1e6 rad", [](auto& random, auto& at) {
    for (auto& q : at.q) q = q + (random.index(2) == 0 ? 1e6f : -1e6f);
  });
  check_arm("dq = 1e3 rad/s", [](auto&, auto& at) {
    for (auto& dq : at.dq) dq = dq * 333;
  });
}

TEST_CASE(
    "accuracy: masses from 1e-6 to 1e6 kg in one chain, either way round, and links at the edge of what can "
    "exist") {
  const auto chain = [](const char* what, auto inertia) {
    CAPTURE(what);
    const auto model = [&](auto zero) {
      using T = decltype(zero);
      typename CalibratedModel<Chain<7>, T>::Links links;
      for (std::size_t i = 0; i < 7; ++i)
        links[i] = make_link({.p = {0.3, 0.1, 0.2}, .alpha = Angle::quarter(i % 2 == 0 ? 1 : -1)}, inertia(i))
                       .template cast<T>();
      return CalibratedModel<Chain<7>, T>(links);
    };
    const Exact exact = exact_tree(model(0.0));
    check(worst<double>(model(0.0), exact, some, [](auto&, auto&) {}));
    check(worst<float>(model(0.0f), exact, some, [](auto&, auto&) {}));
  };
  const auto rod = [](double m) {
    return LinkInertia{m, {0.15, 0.02, 0.05}, 0.002 * m, 0.009 * m, 0.0085 * m};
  };
  chain("tip light", [&](std::size_t i) { return rod(std::pow(10.0, 6 - 2 * static_cast<double>(i))); });
  chain("tip heavy", [&](std::size_t i) { return rod(std::pow(10.0, 2 * static_cast<double>(i) - 6)); });
  chain("flat", [](std::size_t) { return LinkInertia{1, {0.15, 0.02, 0}, 0.003, 0.004, 0.007}; });
  chain("on a line", [](std::size_t) { return LinkInertia{1, {0.15, 0, 0}, 0, 0.0075, 0.0075}; });
  chain("points", [](std::size_t) { return LinkInertia{1, {0.15, 0.02, 0.1}, 0, 0, 0}; });
}

#endif
