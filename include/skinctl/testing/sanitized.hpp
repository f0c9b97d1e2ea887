// SPDX-License-Identifier: BSD-3-Clause
// Whether this is a build under the address sanitizer, where loops without further value there are shortened.
//
// Guarded by macros, like digits50.hpp: both are in the tests' precompiled header, which a compiler cache may
// take from a tree whose comments differ, and GCC knows a file that says `#pragma once` there by its contents
// alone.
#ifndef SKINCTL_TESTING_SANITIZED_HPP
#define SKINCTL_TESTING_SANITIZED_HPP

#if defined(__SANITIZE_ADDRESS__)
#define SKINCTL_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SKINCTL_SANITIZED 1
#endif
#endif
#if !defined(SKINCTL_SANITIZED)
#define SKINCTL_SANITIZED 0
#endif

namespace skinctl::testing {

inline constexpr bool sanitized = SKINCTL_SANITIZED != 0;

}  // namespace skinctl::testing

#endif
