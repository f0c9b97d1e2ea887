// A locale of the continent, for tests of texts that machines read.
#pragma once

#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <string>

namespace skinctl::testing {

/// While it lives, C++ streams write 1234.5 as 1.234,5; so does C's printf, without the mark between
/// thousands, where one of the system's locales does or localedef makes one.
class CommaLocale {
 public:
  CommaLocale() : before_(std::locale::global(std::locale(std::locale::classic(), new Marks))) {
    if (const char* name = std::setlocale(LC_NUMERIC, nullptr)) c_before_ = name;
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "es_ES.UTF-8", "it_IT.UTF-8"})
      if (std::setlocale(LC_NUMERIC, name) != nullptr) return;
    static_cast<void>(std::setlocale(LC_NUMERIC, made()));
  }
  ~CommaLocale() {
    std::locale::global(before_);
    std::setlocale(LC_NUMERIC, c_before_.c_str());
  }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

  /// Whether C's printf writes a comma as well, now.
  [[nodiscard]] static bool reaches_c() { return *std::localeconv()->decimal_point == ','; }

 private:
  struct Marks : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  /// Name of a locale that this process has made for itself; where nothing makes it, no locale has it.
  static const char* made() {
    static const std::string name = [] {
      const auto folder =
          std::filesystem::temp_directory_path() / ("skinctl_locale_" + std::to_string(getpid()));
      std::filesystem::create_directory(folder);
      std::ofstream(folder / "numeric")
          << "LC_NUMERIC\ndecimal_point \",\"\nthousands_sep \".\"\ngrouping 3\nEND LC_NUMERIC\n";
      ::unsetenv("LD_PRELOAD");  // which would have localedef do the same
      const std::string command =
          "cd '" + folder.string() + "' && localedef -c -i ./numeric ./comma >/dev/null 2>&1";
      static_cast<void>(!std::system(command.c_str()));  // warns of what else a locale may hold, and says 1
      ::setenv("LOCPATH", folder.c_str(), 1);
      const bool there = std::setlocale(LC_NUMERIC, "comma") != nullptr;
      std::filesystem::remove_all(folder);
      return std::string(there ? "comma" : "none");
    }();
    return name.c_str();
  }
  std::locale before_;
  std::string c_before_ = "C";
};

}  // namespace skinctl::testing
