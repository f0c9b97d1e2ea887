#include "skinctl/io/skin_report.hpp"

#include <doctest/doctest.h>

#include "examples/support/skin_health_picture.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/skin_faults.hpp"
#include "skinctl/testing/skin_signals.hpp"
#include "tests/support/comma_locale.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}
/// Whether brackets and quotes close in the order in which they open.
bool balanced(const std::string& text) {
  std::string open;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '{' || c == '[') open.push_back(c == '{' ? '}' : ']');
    if (c == '}' || c == ']') {
      if (open.empty() || open.back() != c) return false;
      open.pop_back();
    }
  }
  return open.empty() && !quoted;
}

}  // namespace

TEST_CASE(
    "SkinHealthReport: names each faulty cell in words, as JSON, and in the picture, and no healthy one") {
  const auto patches = ur5::skin_patches<60>();
  const auto skin = ur5_skin<60>();
  SkinSignals signals(cell_places(patches));
  TrustSettings trust;
  trust.lone_force = {1.0};
  trust.noise = {{.rest = 20.5f}};
  const TrustedSkin trusted(skin, trust);
  SkinFaults spoil({{.cell = 7, .fault = CellFault::stuck, .from = 500ms},
                    {.cell = 33, .fault = CellFault::noisy, .from = 500ms, .level = 0.01},
                    {.cell = 50, .fault = CellFault::unheard, .from = 500ms}});
  auto m = trusted.start(0ns);
  std::vector<CellSample> samples;
  const auto run = [&](Nanoseconds from, Nanoseconds end) {
    for (Nanoseconds to = from + 8ms; to <= end; to += 8ms) {
      signals.samples(to, samples);
      spoil.apply(samples, to);
      decltype(skin)::Wrenches w;
      trusted.receive(m, samples, to - 8ms, to, 1, &w);
    }
  };
  run(0ns, 400ms);
  const SkinHealthReport before = report_of(trusted, m);
  CHECK(in_words(before) == "60 of 60 cells count\n");
  CHECK(times(as_json(before), "\"id\"") == 0);
  CHECK(times(examples::as_svg(before), "<circle") == 60);

  run(400ms, 2s);
  const SkinHealthReport report = report_of(trusted, m);
  CHECK(report.usable == 57);
  const std::string words = in_words(report), json = as_json(report), picture = examples::as_svg(report);
  CHECK(words.find("57 of 60 cells count; stuck: 1; noisy: 1; unheard: 1\n") == 0);
  CHECK(times(words, "\n") == 4);
  CHECK(words.find("cell 7 on link ") != std::string::npos);
  CHECK(words.find(": stuck, masked by 100 %") != std::string::npos);
  CHECK(words.find("cell 50 on link ") != std::string::npos);
  CHECK(balanced(json));
  {
    const CommaLocale comma;
    CHECK(as_json(report) == json);
    CHECK((examples::as_svg(report) == picture));
  }
  CHECK(times(json, "\"id\"") == 3);
  CHECK(times(json, "{\"id\": 33, \"link\": ") == 1);
  CHECK(times(json, "\"usable\": 57") == 1);
  CHECK(times(json, "\"faults\": [\"noisy\"]") == 1);
  CHECK(times(picture, "<circle") == 60);
  CHECK(times(picture, "fill=\"#e8e8e8\"") == 57 + 1);  // and one in the legend
  CHECK(times(picture, "<text") == times(picture, "</text>"));
  CHECK(times(picture, "<svg") == 1);
}
