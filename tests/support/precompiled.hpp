// What most tests read, once for all of them. Nothing of skinctl's own loop: a header that changes rebuilds
// the tests that include it and no others.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <random>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "skinctl/testing/sanitized.hpp"
#include "tests/support/digits50.hpp"

// Under the sanitizers a case that runs in float, double and 50 digits runs in double: the same templates
// walk the same paths. core/, math/, tactile/ and clearance/ keep float, which has lanes and kernels of its
// own there. All scalars run in the other build.
#if SKINCTL_SANITIZED
namespace skinctl::testing {

constexpr bool keeps_float(std::string_view file) {
  return file.find("/core/") != file.npos || file.find("/math/") != file.npos ||
         file.find("/tactile/") != file.npos || file.find("/clearance/") != file.npos;
}

template <class Kept, bool Float, bool Double, class... T>
struct TriedScalars {
  using type = Kept;
};
template <class... Kept, bool Float, bool Double, class First, class... Rest>
struct TriedScalars<std::tuple<Kept...>, Float, Double, First, Rest...> {
  static constexpr bool left_out =
      Double && (std::is_same_v<First, Digits50> || (std::is_same_v<First, float> && !Float));
  using type =
      typename TriedScalars<std::conditional_t<left_out, std::tuple<Kept...>, std::tuple<Kept..., First>>,
                            Float, Double, Rest...>::type;
};
template <bool Float, class... T>
using tried_scalars =
    typename TriedScalars<std::tuple<>, Float, (std::is_same_v<T, double> || ...), T...>::type;

}  // namespace skinctl::testing

#define SKINCTL_TEST_CASE_TEMPLATE(name, T, id, ...)                                                 \
  DOCTEST_TEST_CASE_TEMPLATE_DEFINE_IMPL(name, T, DOCTEST_CAT(id, ITERATOR), id);                    \
  DOCTEST_TEST_CASE_TEMPLATE_INSTANTIATE_IMPL(                                                       \
      id, id, skinctl::testing::tried_scalars<skinctl::testing::keeps_float(__FILE__), __VA_ARGS__>) \
  template <typename T>                                                                              \
  static void id()
#undef TEST_CASE_TEMPLATE
#define TEST_CASE_TEMPLATE(name, T, ...) \
  SKINCTL_TEST_CASE_TEMPLATE(name, T, DOCTEST_ANONYMOUS(DOCTEST_ANON_TMP_), __VA_ARGS__)
#endif
