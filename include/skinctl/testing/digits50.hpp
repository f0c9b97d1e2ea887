// Digits50: the scalar of the oracles, fifty decimal digits.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace skinctl::testing {

/// Fifty decimal digits, without expression templates: skinctl's own functions take it as a `Real`.
using Digits50 =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

}  // namespace skinctl::testing
