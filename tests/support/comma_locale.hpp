// A locale of the continent, for tests of texts that machines read.
#pragma once

#include <clocale>
#include <locale>
#include <string>

namespace skinctl::testing {

/// While it lives, C++ streams write 1234.5 as 1.234,5; so does C's printf, without the mark between
/// thousands, where one of the system's locales does.
class CommaLocale {
 public:
  CommaLocale() : before_(std::locale::global(std::locale(std::locale::classic(), new Marks))) {
    if (const char* name = std::setlocale(LC_NUMERIC, nullptr)) c_before_ = name;
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "es_ES.UTF-8", "it_IT.UTF-8"})
      if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
  }
  ~CommaLocale() {
    std::locale::global(before_);
    std::setlocale(LC_NUMERIC, c_before_.c_str());
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

  /// Whether C's locale writes a comma as well.
  [[nodiscard]] static bool reaches_c() { return *std::localeconv()->decimal_point == ','; }

 private:
  struct Marks : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  std::locale before_;
  std::string c_before_ = "C";
};

}  // namespace skinctl::testing
