// A namespace for code that computes with Eigen alone.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// In here the library's own operators are not looked up: the compiler would ask each of their constraints about every
/// expression of Eigen, which takes most of its time (a file of the calibration: 82 of 136 s).
namespace detail::fit {
struct Nothing;
void operator+(const Nothing&, const Nothing&);
void operator-(const Nothing&, const Nothing&);
void operator*(const Nothing&, const Nothing&);
void operator/(const Nothing&, const Nothing&);
void operator==(const Nothing&, const Nothing&);
void operator!=(const Nothing&, const Nothing&);
void operator<(const Nothing&, const Nothing&);
void operator>(const Nothing&, const Nothing&);
void operator<=(const Nothing&, const Nothing&);
void operator>=(const Nothing&, const Nothing&);
void operator<<(const Nothing&, const Nothing&);
void operator&&(const Nothing&, const Nothing&);
void operator||(const Nothing&, const Nothing&);
void operator&(const Nothing&, const Nothing&);
void operator|(const Nothing&, const Nothing&);
void operator-(const Nothing&);
void operator!(const Nothing&);
}  // namespace detail::fit

SKINCTL_END_NAMESPACE
