// A library for LD_PRELOAD: the program runs in a locale that writes commas.
#include "tests/support/comma_locale.hpp"

namespace {
const skinctl::testing::CommaLocale comma;
}
