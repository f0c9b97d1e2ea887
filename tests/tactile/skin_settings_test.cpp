#include "skinctl/tactile/skin_settings.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace skinctl;

TEST_CASE("SkinSettings: the defaults pass, a time that is none is refused by its name") {
  CHECK_NOTHROW(SkinSettings{}.check());
  const auto refused = [](auto change) -> std::string {
    SkinSettings s;
    change(s);
    try {
      s.check();
    } catch (const ConfigurationError& e) {
      return e.what();
    }
    return "";
  };
  const auto names = [](const std::string& text, const char* name) {
    return text.find(name) != std::string::npos;
  };
  CHECK(names(refused([](auto& s) { s.fade = 0; }), "fade"));
  CHECK(names(refused([](auto& s) { s.fade = -1; }), "fade"));
  CHECK(names(refused([](auto& s) { s.max_age = s.fade - 1; }), "max_age"));
  CHECK(names(refused([](auto& s) { s.ramp = 0; }), "ramp"));
  CHECK(names(refused([](auto& s) { s.catch_up = -1; }), "catch_up"));
  CHECK(names(refused([](auto& s) { s.max_ahead = -1; }), "max_ahead"));
  CHECK(refused([](auto& s) {
          s.max_age = s.fade;
          s.catch_up = s.max_ahead = 0;
          s.ramp = 1;
        }).empty());
}
