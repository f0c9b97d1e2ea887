// Whether cases in 50 digits are compiled: under the sanitizers each of them takes minutes, and the same
// templates run in double.
#pragma once

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SKINCTL_MANY_DIGITS 0
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define SKINCTL_MANY_DIGITS 0
#endif
#if !defined(SKINCTL_MANY_DIGITS)
#define SKINCTL_MANY_DIGITS 1
#endif
