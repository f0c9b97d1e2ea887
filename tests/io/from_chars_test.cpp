// Promise: robot and skin files are read where the standard library reads no floating-point numbers (libc++
// before 20)
// Tried: 200 000 numbers and broken texts against std::from_chars, bit for bit

#include "skinctl/io/detail/from_chars.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

void same(const std::string& text) {
  double x = 7, y = 7;
  const char *first = text.data(), *last = first + text.size();
  const auto wanted = std::from_chars(first, last, x), given = detail::from_chars_by_strtod(first, last, y);
  CAPTURE(text);
  CHECK(given.ec == wanted.ec);
  CHECK(given.ptr == wanted.ptr);
  CHECK((std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) || (x != x && y != y)));
}

}  // namespace

TEST_CASE("from_chars: by the C library as by the standard library") {
  for (const char* text :
       {"",       "-",    "+",  "+1",     " 1",    "1 2",   "1,5",   "1.5e", "1.5e+", "1.5e+3x",  "1e400",
        "-1e400", "0x10", "1x", ".5",     ".",     "-.5e1", "5.",    "inf",  "-inf",  "infinity", "nan",
        "-nan",   "in",   "n",  "1e-300", "00012", "--1",   "1.2.3", "e5",   "1e5e5", "NaN"})
    same(text);
  Random random = seeded(11);
  for (int k = 0; k < 100'000; ++k) {
    char text[64];
    const auto bits = (std::uint64_t(random()) << 32) ^ std::uint64_t(random());
    const double x = std::bit_cast<double>(bits);
    std::snprintf(text, sizeof text, "%.*g", int(random() % 18), k % 2 == 0 ? uniform(random, -1e3, 1e3) : x);
    for (char& c : text)
      if (c == ',') c = '.';
    // below the normal numbers libraries differ in what they call out of range
    if (k % 2 == 0 || !(std::abs(x) < 1e-300)) same(text);
    std::string broken(std::size_t(random() % 12), ' ');
    for (char& c : broken) c = "0123456789.eE+-xnaif ,"[random() % 22];
    same(broken);
  }
}
