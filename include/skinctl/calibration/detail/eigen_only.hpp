// SPDX-License-Identifier: BSD-3-Clause
// A namespace for code that computes with Eigen alone.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// In here the library's own operators are hidden: an expression of Eigen does not ask each of their
/// constraints.
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
