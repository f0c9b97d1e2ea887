// Digits50: the scalar of the oracles, fifty decimal digits.
#ifndef SKINCTL_TESTING_DIGITS50_HPP
#define SKINCTL_TESTING_DIGITS50_HPP

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace skinctl::testing {

/// Fifty decimal digits, without expression templates: skinctl's own functions take it as a `Real`.
using Digits50 =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

}  // namespace skinctl::testing

#endif
