#include "skinctl/core/xml_text.hpp"

#include <doctest/doctest.h>

using skinctl::xml_text;

TEST_CASE("xml_text: marks are escaped, control characters and broken UTF-8 do no harm") {
  CHECK(xml_text("<a b='1' c=\"2\">&") == "&lt;a b=&#39;1&#39; c=&quot;2&quot;&gt;&amp;");
  CHECK(xml_text(std::string("a\0b\x1b\x7f", 5)) == "a b  ");
  CHECK(xml_text("a\tb\nc") == "a\tb\nc");
  CHECK(xml_text("m/s\u00B2 \u2212 \U0001F916") == "m/s\u00B2 \u2212 \U0001F916");
  const std::string bad = "\uFFFD";
  CHECK(xml_text("\xff") == bad);
  CHECK(xml_text("x\xc3") == "x" + bad);
  CHECK(xml_text("\xc0\xaf") == bad + bad);            // overlong
  CHECK(xml_text("\xed\xa0\x80") == bad + bad + bad);  // surrogate
  CHECK(xml_text("\xf4\x90\x80\x80").find(bad) == 0);  // beyond Unicode
  CHECK(xml_text("\xc2\x85") == bad + bad);            // a control character
  CHECK(xml_text("\xe2\x82") == bad + bad);
}
