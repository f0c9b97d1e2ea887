// SPDX-License-Identifier: BSD-3-Clause
// A scene is refused where the compiler's flags, or the processor's mode, change what its arithmetic gives.
#pragma once

#include <cmath>
#include <limits>

#include "skinctl/core/contract.hpp"
#include "skinctl/math/sincos.hpp"
#include "skinctl/math/sum.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Throws `ConfigurationError` unless range reduction, a compensated sum and a comparison with NaN give what
/// they give in IEEE arithmetic, each operation rounded to `T` in the order in which it is written. What
/// compilers show in macros is refused in `core/config.hpp`; this is for the rest.
template <class T>
SKINCTL_NOINLINE void check_arithmetic() {
  if constexpr (math::detail::has_kernel<T>) {
    // Volatile: the numbers are computed while the program runs, by the flags that the loop has.
    const volatile T angles[] = {T(0.5), T(100)}, one = 1, small = std::numeric_limits<T>::epsilon() / 8,
                     none = std::numeric_limits<T>::quiet_NaN();
    const auto check = [](const char* name, T value, double right, const char* allowed) {
      // The rounding mode of the thread may be any.
      require(std::abs(value - T(right)) <= 16 * std::numeric_limits<T>::epsilon(), name, double(value),
              allowed);
    };
    const auto half = math::sincos(T(angles[0])), large = math::sincos(T(angles[1]));
    check("sin(0.5), computed with this program's flags,", half.sin, 0.479425538604203, "0.479425539");
    check("cos(0.5), computed with this program's flags,", half.cos, 0.877582561890373, "0.877582562");
    check("sin(100), computed with this program's flags,", large.sin, -0.506365641109759, "-0.506365641");
    check("cos(100), computed with this program's flags,", large.cos, 0.862318872287684, "0.862318872");
    const auto sum = math::two_sum(T(one), T(small));
    const T kept = ((sum.value - T(one)) + sum.error) / T(small);
    check("share of a small term that a compensated sum keeps,", kept, 1, "1");
    const T unknown = none;
    require(!(unknown <= T(one)) && !(unknown >= T(one)),
            "a NaN, which compares like a number with this program's flags,", double(unknown),
            "no comparison holds");
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
