#include "skinctl/tactile/skin_settings.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using skinctl::testing::complaint_of;

TEST_CASE("SkinSettings: the defaults pass, a time that is none is refused by its name") {
  CHECK_NOTHROW(SkinSettings{}.check());
  const auto refused = [](auto change) -> std::string {
    SkinSettings s;
    change(s);
    return complaint_of([&] { s.check(); });
  };
  const auto names = [](const std::string& text, const char* name) {
    return text.find(name) != std::string::npos;
  };
  CHECK(names(refused([](auto& s) { s.fade = 0ns; }), "fade"));
  CHECK(names(refused([](auto& s) { s.fade = -1ns; }), "fade"));
  CHECK(names(refused([](auto& s) { s.max_age = s.fade - 1ns; }), "max_age"));
  CHECK(names(refused([](auto& s) { s.ramp = 0ns; }), "ramp"));
  CHECK(names(refused([](auto& s) { s.catch_up = -1ns; }), "catch_up"));
  CHECK(names(refused([](auto& s) { s.max_ahead = -1ns; }), "max_ahead"));
  CHECK(refused([](auto& s) {
          s.max_age = s.fade;
          s.catch_up = s.max_ahead = 0ns;
          s.ramp = 1ns;
        }).empty());
}
