// Whether cases in 50 digits are compiled: under the sanitizers each of them takes minutes, and the same
// templates run in double.
#pragma once

#include "skinctl/testing/sanitized.hpp"

#define SKINCTL_MANY_DIGITS (!SKINCTL_SANITIZED)
