// The page in headless Chromium: what it draws, what it says, stop. Without Chromium the case says so.
#include "examples/packing_oranges/live.hpp"

#include "examples/support/devtools.hpp"

using namespace packing;
namespace browser = examples::browser;

TEST_CASE("packing_oranges --live: the page shows both arms, the oranges and the plan, and stops the robot") {
  const std::string chromium = browser::find();
  if (chromium.empty()) {
    MESSAGE("no Chromium: the live page was not looked at");
    return;
  }
  LivePage live(0, false);
  Scenery s;
  s.time = 3.25, s.robot = "UR5", s.all = 8, s.box = 2, s.bins = 1;
  for (std::size_t a = 0; a < arms; ++a) {
    for (int i = 0; i < 7; ++i)
      s.arm[a].parts.push_back({{-0.6 * side(a), 0, 0.1 * i}, {-0.6 * side(a), 0.1, 0.1 * i}, 0.05});
    s.arm[a].step = a == 0 ? "squeeze" : "to bin";
    s.arm[a].state = a == 0 ? "" : "goes back";
  }
  s.arm[0].stiffness = 6012, s.arm[0].said_good = true, s.arm[0].has_box = true;
  s.arm[1].touched = s.arm[1].kept = true;
  s.oranges.push_back({{0.1, 0.2, 0.04}});
  s.things.push_back({{-0.1, -0.1, 0.4}, 0.05});

  const browser::Folder folder;
  browser::Page page(chromium, folder);
  page.window(390, 800);
  page.go(live.url());
  const auto shows = [&](const std::string& script) {
    for (int n = 0; n < 200; ++n) {
      live.show(s);
      if (page.until(script, 0.05)) return true;
    }
    return false;
  };
  CHECK(shows("packing.frames > 2 && packing.messages > 2 && packing.trays.length === 5"));
  CHECK(page.evaluate("packing.errors") == 0);
  CHECK(page.evaluate("document.getElementById('count').textContent") == "2 in the box, 1 in the bins, of 8");
  CHECK(page.evaluate("[...document.querySelectorAll('[aria-current]')].map(e => e.textContent).join()") ==
        "squeeze,to bin");
  CHECK(page.evaluate("document.querySelectorAll('ol.back').length") == 1);
  const std::string second = page.evaluate("document.querySelector('#arm1 p').textContent");
  CHECK_MESSAGE(
      second.find("goes back; a person pushes its forearm; kept clear of the other arm") != std::string::npos,
      second);
  CHECK(page.evaluate("document.querySelector('#arm0 p').textContent") ==
        "finger 0.0 N, last judged good (6012 N/m); has the box");
  // Both colours of arms, and the orange.
  const auto painted = [&](const char* rgb) {
    return page.evaluate(
        "(() => { const k = document.getElementById('world'), p = k.getContext('2d').getImageData(0, "
        "0, k.width, k.height).data, c = [" +
        std::string(rgb) +
        "]; let n = 0; for (let i = 0; i < p.length; i += 4) n += Math.abs(p[i] - c[0]) + "
        "Math.abs(p[i + 1] - c[1]) + Math.abs(p[i + 2] - c[2]) < 12; return n; })()");
  };
  CHECK(painted("59,118,196") > 100);
  CHECK(painted("160,44,110") > 100);
  CHECK(painted("138,91,181") > 100);
  CHECK(painted("242,140,30") > 5);
  CHECK(page.evaluate("document.documentElement.scrollWidth <= innerWidth") == true);

  CHECK(live.take() == skinctl::CycleRequest::none);
  CHECK(page.evaluate("document.getElementById('resume').disabled") == true);
  page.key("s");
  skinctl::CycleRequest asked{};
  for (int n = 0; n < 100 && asked == skinctl::CycleRequest::none; ++n) {
    ::usleep(20'000);
    asked = live.take();
  }
  CHECK(asked == skinctl::CycleRequest::stop);
  CHECK(page.until("document.getElementById('said').textContent === 'both arms brake, and hold'", 5));
  CHECK_MESSAGE(page.errors().empty(), page.errors());
}
