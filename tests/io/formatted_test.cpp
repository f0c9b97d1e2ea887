#include "skinctl/io/formatted.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>
#include <sstream>

#include "tests/support/comma_locale.hpp"

using namespace skinctl;
using skinctl::testing::CommaLocale;

namespace {

/// As `formatted`, by the C library, in whose locale this program starts.
[[gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...) {
  std::array<char, 2000> text{};
  std::va_list x;
  va_start(x, format);
  std::vsnprintf(text.data(), text.size(), format, x);
  va_end(x);
  return text.data();
}

double any_number(std::mt19937_64& random) {
  const std::uint64_t bits = random();
  double x = 0;
  std::memcpy(&x, &bits, sizeof x);
  if (random() % 2 == 0) x = std::uniform_real_distribution<double>(-1e6, 1e6)(random);
  return std::isnan(x) ? 0.5 : x;  // the sign of a NaN is nobody's
}

}  // namespace

TEST_CASE("formatted: what printf writes in the C locale, to the character, in every locale") {
  constexpr double inf = std::numeric_limits<double>::infinity();
  std::mt19937_64 random(1);
  const auto agrees = [](auto&& write) { CHECK(write(false) == write(true)); };
#define SKINCTL_AGREES(...)                 \
  agrees([&](bool here) {                   \
    if (!here) return printed(__VA_ARGS__); \
    const CommaLocale comma;                \
    return formatted(__VA_ARGS__);          \
  })
  for (int k = 0; k < 2000; ++k) {
    const double x = any_number(random);
    const int digits = int(random() % 18), wide = int(random() % 30);
    SKINCTL_AGREES("%f %g %e", x, x, x);
    SKINCTL_AGREES("%.3f|%.0f|%.17g|%.*g|%.*e|%.9g", x, x, x, digits, x, digits, x, x);
    SKINCTL_AGREES("%12.3f|%-12.2f|%+.2f|%012.4f|%+09.1f|%*.*f", x, x, x, x, x, wide, digits, x);
    const auto n = static_cast<long long>(random());
    SKINCTL_AGREES("%d %u %x %lld %llu %llx %ld %lu %zu", int(n), unsigned(n), unsigned(n), n,
                   static_cast<unsigned long long>(n), static_cast<unsigned long long>(n),
                   static_cast<long>(n), static_cast<unsigned long>(n), static_cast<std::size_t>(n));
    SKINCTL_AGREES("%5d|%-5d|%05d|%02x|%09u|%+d", int(n % 1000), int(n % 1000), int(n % 1000),
                   unsigned(n) % 256, unsigned(n) % 100000, int(n % 1000));
  }
  for (const double x :
       {0.0, -0.0, inf, -inf, 1e-300, 1e300, 0.05, 0.5, 1.5, 2.5, 1e6, 1e-5, 123456.5, 9.9999995})
    SKINCTL_AGREES("%f %g %e %.1f %.0f %.17g %8.2g", x, x, x, x, x, x, x);
  SKINCTL_AGREES("%s|%-6s|%6s|%.2s|%c|100 %%", "text", "text", "text", "text", 'c');
  SKINCTL_AGREES("def f():\n  %s\nend\n", "");
  const std::string empty = formatted("%s", "");
  CHECK(empty.empty());
#undef SKINCTL_AGREES
}

TEST_CASE("CommaLocale: streams and printf write commas while it lives, and not after") {
  const auto streamed = [] {
    std::ostringstream out;
    out << 1234.5 << ' ' << 5678;
    return out.str();
  };
  {
    const CommaLocale comma;
    CHECK(streamed() == "1.234,5 5.678");
    CHECK(formatted("%.1f %d", 1234.5, 5678) == "1234.5 5678");
    const bool can_make = std::system("command -v localedef >/dev/null 2>&1") == 0;
    CHECK(printed("%.1f", 1234.5) == (can_make ? "1234,5" : CommaLocale::reaches_c() ? "1234,5" : "1234.5"));
    if (!CommaLocale::reaches_c())
      MESSAGE(
          "neither a locale of the system has a comma nor is localedef here: C's printf was not tried with "
          "one");
  }
  CHECK(streamed() == "1234.5 5678");
  CHECK(printed("%.1f", 0.5) == "0.5");
}
