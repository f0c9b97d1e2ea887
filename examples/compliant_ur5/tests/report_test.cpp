#include "examples/compliant_ur5/report.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "examples/compliant_ur5/tests/synthetic_log.hpp"
#include "examples/support/svg_plot.hpp"

using namespace compliant_ur5;
using plotting::Plot;

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

bool has(const std::string& text, const std::string& what) {
  return text.find(what) != std::string::npos;
}

struct Point {
  double x, y;
};

/// The corners of the curve with the class, in units of the view box.
std::vector<Point> corners(const std::string& svg, const std::string& cls) {
  const auto curves = svg.find("class=\"curves\"");
  REQUIRE(curves != std::string::npos);
  const std::string begin = "<path class=\"" + cls + "\" d=\"";
  const auto at = svg.find(begin, curves);
  if (at == std::string::npos) return {};
  const auto from = at + begin.size();
  std::istringstream d(svg.substr(from, svg.find('"', from) - from));
  std::vector<Point> out;
  double x = 0, y = 0, dx = 0, dy = 0;
  for (char command = 0; d >> command;) {
    if (command == 'M') REQUIRE((d >> x >> y));
    if (command == 'l') {
      REQUIRE((d >> dx >> dy));
      x += dx, y += dy;
    }
    if (command == 'h') {
      REQUIRE((d >> dx));
      x += dx;
    }
    out.push_back({x / 10, y / 10});
  }
  return out;
}

/// Every tag that is opened is closed, in order; for SVG, which is XML.
void check_nested(const std::string& xml) {
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const auto end = xml.find('>', at);
    REQUIRE(end != std::string::npos);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    REQUIRE(!tag.empty());
    REQUIRE(tag.find('<') == std::string::npos);
    if (tag.back() == '/') continue;
    const std::string name = tag.substr(0, tag.find_first_of(" \n"));
    if (name[0] != '/') {
      open.push_back(name);
    } else {
      REQUIRE(!open.empty());
      CHECK(open.back() == name.substr(1));
      open.pop_back();
    }
  }
  CHECK(open.empty());
}

Plot plot_of(std::vector<double> y) {
  Plot plot;
  plot.title = "title";
  plot.y_name = "force [N]";
  auto& s = plot.series.emplace_back();
  s.name = "one";
  for (std::size_t i = 0; i < y.size(); ++i) s.x.push_back(0.002 * static_cast<double>(i));
  s.y = std::move(y);
  return plot;
}

}  // namespace

TEST_CASE("svg_plot: no peak vanishes among 30000 samples, however short") {
  std::mt19937 random(3);
  for (int round = 0; round < 40; ++round) {
    std::vector<double> y(30000, 0.0);
    const std::size_t at = random() % y.size(), below = random() % y.size();
    y[at] = 100;
    y[below] = -50;
    Plot plot = plot_of(y);
    const std::string svg = plotting::inline_svg(plot);
    const auto points = corners(svg, "s0");
    REQUIRE(!points.empty());
    const auto by_height = [](Point a, Point b) { return a.y < b.y; };
    const auto [top, bottom] = std::minmax_element(points.begin(), points.end(), by_height);
    const double zero =
        points.front().y == top->y || points.front().y == bottom->y ? points.back().y : points.front().y;
    CAPTURE(at);
    CAPTURE(below);
    CHECK((bottom->y - zero) / (zero - top->y) == doctest::Approx(0.5).epsilon(0.01));
    // In the right column: the axes of both ends are those of the first and the last sample.
    const double left = points.front().x, right = points.back().x;
    CHECK(top->x ==
          doctest::Approx(left + (right - left) * static_cast<double>(at) / 29999.0).epsilon(0.003));
    CHECK(svg.size() < 12000);
  }
}

TEST_CASE("svg_plot: few samples are drawn as they are") {
  const auto points = corners(plotting::inline_svg(plot_of({0, 1, 4, 2})), "s0");
  REQUIRE(points.size() == 4);
  const double unit = points[0].y - points[1].y;
  CHECK(points[0].y - points[2].y == doctest::Approx(4 * unit).epsilon(0.01));
  CHECK(points[0].y - points[3].y == doctest::Approx(2 * unit).epsilon(0.01));
  CHECK(points[2].x - points[1].x == doctest::Approx(points[1].x - points[0].x).epsilon(0.01));
}

TEST_CASE("svg_plot: numbers that are not finite are gaps and never reach the text") {
  const std::string svg = plotting::svg_plot(plot_of({1, no_number, 3, 4, inf, -inf, 1e300, 2}));
  CHECK(count(svg.substr(svg.find("curves\"")), "M") == 3);
  for (const std::vector<double>& y : {std::vector<double>{},
                                       {no_number},
                                       {5},
                                       {0},
                                       {inf, -inf},
                                       {1e14, -1e14},
                                       {1e-300, 2e-300},
                                       {7, 7, 7},
                                       {-1e-9, 1e-9},
                                       {3e5, 1e-5}}) {
    Plot plot = plot_of(y);
    plot.limits = {{no_number, "a"}, {inf, "b"}, {3, "c"}, {-1e14, "d"}};
    plot.bands = {{no_number, 1, "x", ""}, {-inf, inf, "y", ""}, {5, 2, "z", ""}, {-4, 1e9, "w", ""}};
    const std::string text = plotting::svg_plot(plot);
    check_nested(text);
    CHECK_FALSE(has(text, "nan"));
    CHECK_FALSE(has(text, "inf"));
    CHECK(text.size() < 12000);
    CHECK(has(text, "nothing to show") == corners(text, "s0").empty());
  }
  Plot ragged = plot_of({1, 2, 3});
  ragged.series[0].x.resize(2);
  CHECK(corners(plotting::inline_svg(ragged), "s0").size() == 2);
  ragged.series[0].x = {2, no_number};
  check_nested(plotting::svg_plot(ragged));
}

TEST_CASE("svg_plot: limits are drawn in the plot when near, at its edge with an arrow when far") {
  Plot plot = plot_of({0, 10, 5});
  plot.limits = {{15, "near"}, {200, "far"}};
  const std::string svg = plotting::inline_svg(plot);
  CHECK(count(svg, "class=\"limit\"") == 2);
  CHECK(has(svg, ">near<"));
  CHECK(has(svg, ">\u2191 far<"));
}

TEST_CASE("svg_plot: ticks are round, carry their unit's digits, and reach the end of the run") {
  std::vector<double> y(30000);
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = 0.25 * std::sin(0.001 * static_cast<double>(i));
  const std::string svg = plotting::inline_svg(plot_of(y));
  for (const char* tick : {">0<", ">60<", ">0.2<", ">\u22120.2<", ">time [s]<", ">force [N]<"}) {
    CAPTURE(tick);
    CHECK(has(svg, tick));
  }
}

TEST_CASE("Text: markup, control characters and broken UTF-8 do no harm") {
  using plotting::escaped;
  CHECK(escaped("<a b='1' c=\"2\">&") == "&lt;a b=&#39;1&#39; c=&quot;2&quot;&gt;&amp;");
  CHECK(escaped(std::string("a\0b\x1b\n", 5)) == "a b  ");
  CHECK(escaped("m/s\u00B2 \u2212 \U0001F916") == "m/s\u00B2 \u2212 \U0001F916");
  const std::string bad = "\uFFFD";
  CHECK(escaped("\xff") == bad);
  CHECK(escaped("x\xc3") == "x" + bad);
  CHECK(escaped("\xc0\xaf") == bad + bad);            // overlong
  CHECK(escaped("\xed\xa0\x80") == bad + bad + bad);  // surrogate
  CHECK(escaped("\xf4\x90\x80\x80").find(bad) == 0);  // beyond Unicode
  CHECK(escaped("\xc2\x85") == bad + bad);            // a control character
  CHECK(escaped("\xe2\x82") == bad + bad);
}

TEST_CASE("Numbers: decimals, a true minus, no minus zero, dashes") {
  using plotting::decimal;
  using plotting::significant;
  CHECK(decimal(-1.25, 1) == "\u22121.2");
  CHECK(decimal(-0.001, 2) == "0.00");
  CHECK(decimal(no_number, 1) == "\u2013");
  CHECK(decimal(-inf, 1) == "\u2013");
  CHECK(decimal(1e300, 1).size() < 12);
  CHECK(significant(0.4137, 3) == "0.414");
  CHECK(significant(9.996, 3) == "10.0");
  CHECK(significant(61.34, 3) == "61.3");
  CHECK(significant(12345, 3) == "12345");
  CHECK(significant(0, 3) == "0.00");
  CHECK(significant(inf, 3) == "\u2013");
}

TEST_CASE("Headline: one sentence for every course of events") {
  RunLog log;
  CHECK(headline(log) == "Nothing was recorded.");
  log.entries.resize(2);
  log.entries[1].time = 61.4;
  CHECK(headline(log) == "Nobody touched the arm in 61 s.");
  log.touches.resize(1);
  log.touches[0].give_way = 0.04;
  log.touches[0].return_error = 0.0004;
  log.peak_force = 31.2;
  CHECK(headline(log) ==
        "Touched once, the arm gave way: at most 31 N, and back to within 0.4 mm of its task.");
  log.rigid_peak_force = 190;
  log.touches.resize(3, log.touches[0]);
  CHECK(headline(log) ==
        "Touched 3 times, the arm gave way every time: at most 31 N where a rigid arm pushes with 190 N, and "
        "back to "
        "within 0.4 mm of its task.");
  log.touches[1].give_way = -1;
  CHECK(has(headline(log), "The arm gave way to 2 of 3 touches: "));
  for (TouchSummary& t : log.touches) t.give_way = no_number;
  log.rigid_peak_force = 20;  // no better than rigid: nothing is claimed
  CHECK(headline(log) == "Touched 3 times, the arm never gave way: at most 31 N.");
}

TEST_CASE("Report: says what the log says, needs nothing else, and stays small for a minute at 500 Hz") {
  const RunLog log = synthetic_log();
  const std::string html = report(log);
  CHECK(html.size() < 700'000);
  CHECK(html.rfind("<!doctype html>", 0) == 0);
  for (const char* outside : {"<script", "http:", "https:", "src=", "@import", "url(", "nan", "inf<"}) {
    CAPTURE(outside);
    CHECK_FALSE(has(html, outside));
  }
  for (const char* plot : {"Touch force", "Joint deflection", "Commanded velocity", "Commanded acceleration",
                           "Share of each law"}) {
    CAPTURE(plot);
    CHECK(has(html, "<h2>" + std::string(plot) + "</h2>"));
  }
  CHECK(count(html, "<figure") == 5);
  CHECK(has(html, "6.1 times lower than rigid"));
  CHECK(has(html, "9 of 10"));
  CHECK(has(html, "<td class=bad>never"));
  CHECK(count(html, "<tr>") >= log.touches.size() + log.times.size() + 3);
  CHECK(has(html, "<td>33.0<td>52<td>0.40<td>31.8<td>74<td>57.00<td>1.50"));
  for (const StageTimes& t : log.times) CHECK(has(html, "<th class=word scope=row>" + t.stage + "<td>"));
  for (const auto* list : {&log.scenario, &log.result})
    for (const Fact& f : *list) CHECK(has(html, "<dt>" + f.name + "</dt><dd>" + f.value + "</dd>"));
  for (const std::string& law : log.laws) CHECK(has(html, law + "</label>"));
  CHECK(has(html, "limit of 4, 5, 6: 20.0 rad/s\u00B2"));
  CHECK(has(html, "acceleration limited<td>"));
  CHECK(count(html, "class=\"band\"") >= 10 * log.touches.size());
}

TEST_CASE("Report: a hostile or broken log still makes a page") {
  RunLog log = synthetic_log(20, 125);
  const std::string evil = "</title></style><script>alert(1)</script>\"'&\x01\xff";
  log.title = evil;
  log.laws.fill(evil);
  log.scenario = log.result = {{evil, evil}};
  log.times = {{evil, no_number, inf, -inf, -1}};
  std::mt19937 random(5);
  for (LogEntry& e : log.entries) {
    switch (random() % 8) {
      case 0:
        e.force = no_number;
        break;
      case 1:
        e.q[2] = std::numeric_limits<float>::infinity();
        break;
      case 2:
        e.time = random() % 2 != 0U ? no_number : -1e300;
        break;
      case 3:
        e.acceleration.fill(std::numeric_limits<float>::max());
        break;
      case 4:
        e.shares[1][3] = std::numeric_limits<float>::quiet_NaN();
        break;
      case 5:
        e.status = 0xFFFFFFFFu;
        break;
      default:
        break;
    }
  }
  log.touches[0] = {no_number, inf, -7, 0xFFFFFFFFu, no_number, no_number, no_number, no_number, no_number};
  log.velocity_limit = {no_number, inf, -1, 0, 1e-300, 1e300};
  log.peak_force = inf;
  log.rigid_peak_force = no_number;
  for (const RunLog& each : {log, RunLog{}}) {
    const std::string html = report(each);
    CHECK_FALSE(has(html, "<script"));
    CHECK_FALSE(has(html, ">nan"));
    CHECK_FALSE(has(html, "inf<"));
    CHECK_FALSE(has(html, "\xff"));
    CHECK_FALSE(has(html, "\x01"));
    CHECK(has(html, "</main></body></html>"));
    check_nested(picture(each));
  }
  CHECK(has(report(log), "are not finite and left out"));
}

TEST_CASE("Report: written whole or not at all") {
  std::string folder = (std::filesystem::temp_directory_path() / "report_XXXXXX").string();
  REQUIRE(::mkdtemp(folder.data()) != nullptr);
  const RunLog log = synthetic_log(8, 125);
  const std::string path = folder + "/run.html";
  write_report(log, path);
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  CHECK(text.str() == report(log));
  CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 1);
  std::filesystem::create_directory(folder + "/taken.html");
  for (const std::string& wrong : {folder + "/no/such/run.html", folder + "/taken.html", std::string()}) {
    CAPTURE(wrong);
    bool threw = false;
    try {
      write_report(log, wrong);
    } catch (const std::runtime_error& e) {
      threw = has(e.what(), "cannot write the report");
    }
    CHECK(threw);
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 2);
  std::filesystem::remove_all(folder);
}

TEST_CASE("Picture: force above deflection, touches shaded in both, one file that is valid XML") {
  const RunLog log = synthetic_log();
  const std::string svg = picture(log);
  check_nested(svg);
  CHECK(has(svg, "xmlns=\"http://www.w3.org/2000/svg\""));
  CHECK(count(svg, "class=\"band\"") == 2 * log.touches.size());
  CHECK(svg.find("touch force [N]") < svg.find("deflection, farthest joint [deg]"));
  CHECK(svg.size() < 60'000);
}
