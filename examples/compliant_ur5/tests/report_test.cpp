#include "examples/compliant_ur5/report.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "examples/compliant_ur5/tests/synthetic_log.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/guard/faults.hpp"

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

TEST_CASE("svg_plot: limits are drawn where they are on scale, else said in words and not drawn") {
  Plot plot = plot_of({0, 10, 5});
  plot.limits = {{15, "near"}, {200, "far"}, {-200, ""}};
  for (const double width : {960.0, 200.0}) {
    CAPTURE(width);
    plot.width = width;
    const std::string svg = plotting::inline_svg(plot);
    CHECK(count(svg, "class=\"limit\"") == 1);
    CHECK(has(svg, ">near<"));
    CHECK(has(svg, "off scale: far<"));
  }
  // At its height: the line of 10 lies on the peak.
  plot.limits = {{10, "peak"}};
  const std::string svg = plotting::inline_svg(plot);
  const auto at = svg.find("class=\"limit\" d=\"M");
  REQUIRE(at != std::string::npos);
  double x = 0, y = 0;
  REQUIRE((std::istringstream(svg.substr(at + 18)) >> x >> y));
  const auto points = corners(svg, "s0");
  CHECK(y == doctest::Approx(points.at(1).y).epsilon(0.001));
}

TEST_CASE("svg_plot: both axes begin with a tick, and the y axis ends with one") {
  // A run whose first cycle is at 0.008 s.
  Plot plot = plot_of(std::vector<double>(1000));
  for (std::size_t i = 0; i < 1000; ++i) {
    plot.series[0].x[i] = 0.008 * static_cast<double>(i + 1);
    plot.series[0].y[i] = 0.31 + 0.12 * std::sin(0.01 * static_cast<double>(i));
  }
  CHECK(has(plotting::inline_svg(plot), ">0<"));
  CHECK(has(plotting::inline_svg(plot), ">8<"));
  CHECK(has(plotting::inline_svg(plot), ">0.0<"));
  CHECK(has(plotting::inline_svg(plot), ">0.5<"));
  plot.from_zero = false;  // and then what moves little is seen
  CHECK(has(plotting::inline_svg(plot), ">0.15<"));
  CHECK(has(plotting::inline_svg(plot), ">0.45<"));
  CHECK_FALSE(has(plotting::inline_svg(plot), ">0.0<"));
}

TEST_CASE("svg_plot: what is asked is dashed beside what is, in the plot and in its legend") {
  Plot plot = plot_of({0, 1, 2});
  plot.series.push_back(plot.series[0]);
  plot.series[1].name = "two";
  plot.series[1].dashed = true;
  const std::string svg = plotting::svg_plot(plot);
  CHECK(count(svg, "class=\"s1 dashed\"") == 2);
  CHECK(count(svg, "class=\"s0\"") == 2);
  for (const char* where : {".sp .curves .dashed{stroke-dasharray:", ".sp .key .dashed{stroke-dasharray:"})
    CHECK(has(svg, where));
}

namespace {

using Color = std::array<double, 3>;

/// Linear light of what the style sheet gives class `s0` to `s7`, in its light or its dark part.
Color color_of(const std::string& style, int k) {
  const std::string name = ".sp .s" + std::to_string(k) + "{stroke:#";
  const auto at = style.find(name);
  REQUIRE(at != std::string::npos);
  Color out;
  for (std::size_t i = 0; i < 3; ++i) {
    const double v = std::stoi(style.substr(at + name.size() + 2 * i, 2), nullptr, 16) / 255.0;
    out[i] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  return out;
}
Color times(const std::array<Color, 3>& M, const Color& v) {
  Color out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out[i] += M[i][j] * v[j];
  return out;
}
/// Distance in OKLab (Ottosson 2020) of linear colours.
double distance(const Color& a, const Color& b) {
  const auto lab = [](const Color& c) {
    Color lms = times({{{0.4122214708, 0.5363325363, 0.0514459929},
                        {0.2119034982, 0.6806995451, 0.1073969566},
                        {0.0883024619, 0.2817188376, 0.6299787005}}},
                      c);
    for (double& v : lms) v = std::cbrt(std::max(v, 0.0));
    return times({{{0.2104542553, 0.7936177850, -0.0040720468},
                   {1.9779984951, -2.4285922050, 0.4505937099},
                   {0.0259040371, 0.7827717662, -0.8086757660}}},
                 lms);
  };
  const Color x = lab(a), y = lab(b);
  return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

}  // namespace

TEST_CASE("svg_plot: any two colours are told apart with every kind of colour vision, light and dark") {
  // Machado, Oliveira, Fernandes 2009: how it looks without one of the three kinds of cones.
  const std::array<std::array<Color, 3>, 4> vision{{
      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
      {{{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}},
      {{{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}},
      {{{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}},
  }};
  const std::string style = plotting::plot_style();
  const auto dark = style.find("@media(prefers-color-scheme:dark)");
  REQUIRE(dark != std::string::npos);
  for (const bool is_dark : {false, true}) {
    const std::string part = is_dark ? style.substr(dark) : style.substr(0, dark);
    const double page = is_dark ? 0.0105 : 1.0;  // luminance of the card that plots lie on
    for (int i = 0; i < 8; ++i) {
      const Color a = color_of(part, i);
      const double y = 0.2126 * a[0] + 0.7152 * a[1] + 0.0722 * a[2];
      CAPTURE(is_dark);
      CAPTURE(i);
      CHECK((std::max(y, page) + 0.05) / (std::min(y, page) + 0.05) >= 3);
      for (int j = 0; j < i; ++j)
        for (const auto& M : vision) {
          CAPTURE(j);
          const auto seen = [&](Color c) {
            c = times(M, c);
            for (double& v : c) v = std::clamp(v, 0.0, 1.0);
            return c;
          };
          CHECK(distance(seen(a), seen(color_of(part, j))) >= 0.085);
        }
    }
  }
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
  // Half of it are the files that it holds.
  CHECK(html.size() < 4'000'000);
  const auto data = html.find("<section id=data>");
  REQUIRE(data != std::string::npos);
  CHECK(html.size() - (html.find("</section>", data) - data) < 700'000);
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
  // 182 N where the touches reach 33 N.
  const std::string force = html.substr(html.find("<figure id=force>"),
                                        html.find("<figure id=deflection>") - html.find("<figure id=force>"));
  CHECK(count(force, "off scale: peak of a rigid arm:") == 2);
  CHECK_FALSE(has(force, "class=\"limit\""));
  CHECK(has(html, "9 of 10"));
  CHECK(has(html, "<td class=bad>never"));
  CHECK(count(html, "<tr>") >= log.touches.size() + log.times.size() + 3);
  CHECK(has(html, "<td>33.0<td>52<td>0.40<td>31.8<td>74<td>57.00<td>1.50"));
  for (const StageTimes& t : log.times) CHECK(has(html, "<th class=word scope=row>" + t.stage + "<td>"));
  for (const auto* list : {&log.scenario, &log.result})
    for (const Fact& f : *list) CHECK(has(html, "<dt>" + f.name + "</dt><dd>" + f.value + "</dd>"));
  for (const std::string& law : log.laws) CHECK(has(html, law + "</label>"));
  CHECK(has(html, "limit of joints 3, 4, 5: 20.0 rad/s\u00B2"));
  CHECK(has(html, std::string(skinctl::describe(skinctl::Reason::acceleration_limited)) +
                      "<td class=word>limit<td>"));
  CHECK(count(html, "class=\"band\"") >= 10 * log.touches.size());
}

TEST_CASE("Report: joints count from 0, in text and pictures") {
  const std::string html = report(synthetic_log(20, 125));
  for (int j = 0; j < 6; ++j) {
    CAPTURE(j);
    CHECK(count(html, ">joint " + std::to_string(j) + "</label>") == 3);
    CHECK(count(html, "<p>Joint " + std::to_string(j) + "</p>") == 1);
  }
  CHECK_FALSE(has(html, "oint 6"));
}

namespace {

/// The files that a page holds, by name, as a browser would save them.
std::map<std::string, std::string> files(const std::string& html) {
  std::map<std::string, std::string> out;
  const std::string before = "<a download=\"", between = "\" href=\"data:text/csv;charset=utf-8,";
  for (auto at = html.find(before); at != std::string::npos; at = html.find(before, at + 1)) {
    const auto name = at + before.size(), end = html.find('"', name), from = end + between.size();
    REQUIRE(html.compare(end, between.size(), between) == 0);
    const std::string text = html.substr(from, html.find('"', from) - from);
    CHECK(text.size() < 2'000'000);  // longer ones are not downloaded by Chromium
    std::string& file = out[html.substr(name, end - name)];
    bool clean = true;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '%') {
        file += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
        i += 2;
      } else {
        clean = clean && text[i] > ' ' && text[i] < '\x7f' &&
                std::string("#\"<>'&`").find(text[i]) == std::string::npos;
        file += text[i];
      }
    }
    CHECK(clean);
  }
  return out;
}

/// The rows of a CSV file without quotes.
std::vector<std::vector<std::string>> rows(const std::string& csv) {
  std::vector<std::vector<std::string>> out;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    auto& row = out.emplace_back(1);
    for (const char c : line) {
      if (c == ',')
        row.emplace_back();
      else
        row.back() += c;
    }
  }
  return out;
}

}  // namespace

TEST_CASE("Report: the numbers behind the pictures are files that the page holds") {
  RunLog log = synthetic_log(20, 125);
  log.entries[7].force = no_number;
  const auto held = files(report(log));
  REQUIRE(held.size() == 4);
  const auto touches = rows(held.at("touches.csv"));
  REQUIRE(touches.size() == 1 + log.touches.size());
  CHECK(touches[0][1] == "link");
  CHECK(touches[3][0] == "3");
  CHECK(touches[3][8].empty());  // it never gave way
  CHECK(touches[1][2] == "11");
  CHECK(std::stod(touches[2][5]) == doctest::Approx(log.touches[1].peak_force));
  CHECK(std::stod(touches[2][10]) == doctest::Approx(log.touches[1].place[0]).epsilon(1e-3));

  const auto motion = rows(held.at("motion.csv")), commands = rows(held.at("commands.csv")),
             torques = rows(held.at("torques.csv"));
  for (const auto& [table, columns] : {std::pair{&motion, 15u}, {&commands, 13u}, {&torques, 19u}}) {
    REQUIRE(table->size() == 1 + log.entries.size());
    for (const auto& row : *table) CHECK(row.size() == columns);
  }
  CHECK(motion[0][3] == "joint 0 angle [rad]");
  CHECK(motion[8][1].empty());
  for (const std::size_t k : {std::size_t(0), std::size_t(500), log.entries.size() - 1}) {
    CAPTURE(k);
    const LogEntry& e = log.entries[k];
    CHECK(std::stod(motion[1 + k][0]) == doctest::Approx(e.time));
    for (std::size_t j = 0; j < 6; ++j) {
      CHECK(std::abs(std::stod(motion[1 + k][3 + j]) - static_cast<double>(e.q[j])) < 6e-5);
      CHECK(std::abs(std::stod(motion[1 + k][9 + j]) - static_cast<double>(e.target[j])) < 6e-5);
      CHECK(std::abs(std::stod(commands[1 + k][1 + j]) - static_cast<double>(e.velocity[j])) < 6e-5);
      CHECK(std::abs(std::stod(commands[1 + k][7 + j]) - static_cast<double>(e.acceleration[j])) < 6e-3);
      for (std::size_t law = 0; law < 3; ++law)
        CHECK(std::abs(std::stod(torques[1 + k][1 + 6 * law + j]) - static_cast<double>(e.shares[law][j])) <
              6e-3);
    }
  }
  // A longer run is thinned, and the page says so.
  const std::string long_run = report(synthetic_log());
  CHECK(has(long_run, "Of 30000 cycles one in 4."));
  CHECK(rows(files(long_run).at("motion.csv")).size() == 1 + 7500);
  CHECK_FALSE(has(report(log), "cycles one in"));
}

TEST_CASE("Report: why a cycle takes longer than the README's microsecond, in figures of the run") {
  RunLog log = synthetic_log(20, 125);
  const std::string html = report(log);
  for (const char* words :
       {"covers 8\u00A0ms in 4 sub-steps of 2\u00A0ms",
        "median of 2.71\u00A0\u00B5s is 0.677\u00A0\u00B5s a sub-step",
        "slowest took 61.3\u00A0\u00B5s in the run",
        "run 1001 times with nothing in between, 2.40\u00A0\u00B5s (median), or 0.600\u00A0\u00B5s"}) {
    CAPTURE(words);
    CHECK(has(html, words));
  }
  log.cycle = {.period = 0.002, .substeps = 1};
  CHECK(has(report(log), "A cycle here, of 2\u00A0ms, is one such sub-step."));
  CHECK_FALSE(has(report(log), "with nothing in between"));
  log.cycle = {};
  CHECK_FALSE(has(report(log), "id=why"));
}

TEST_CASE("Report: the arm with the touched places, numbered as in the table") {
  RunLog log = synthetic_log(20, 125);
  for (LogEntry& e : log.entries)
    e.q = {0, 0, 0, 0, 0, 0};  // stretched along -x, seen from the side and from above
  log.touches.resize(2);
  log.touches[0].link = log.touches[1].link = 1;
  log.touches[0].place = {-0.1, 0.054, 0.136};  // y of that link points up
  log.touches[1].place = {-0.3, -0.054, 0.136};
  const std::string html = report(log);
  const auto at = html.find("<section id=arm>");
  REQUIRE(at != std::string::npos);
  const std::string arm = html.substr(at, html.find("</section>", at) - at);
  check_nested(arm.substr(arm.find("<svg"), arm.rfind("</svg>") + 6 - arm.find("<svg")));
  REQUIRE(count(arm, "<svg") == 2);
  CHECK(has(arm, "from the side"));
  CHECK(has(arm, "from above"));
  CHECK(has(arm, "0.2 m"));
  struct Spot {
    double x, y;
    bool behind;
  };
  std::vector<Spot> spots;
  for (auto k = arm.find("<circle class=\"spot"); k != std::string::npos;
       k = arm.find("<circle class=\"spot", k + 1)) {
    const std::string tag = arm.substr(k, arm.find('>', k) - k);
    const auto value = [&](const char* of) {
      return std::stod(tag.substr(tag.find(of) + std::string(of).size()));
    };
    spots.push_back({value("cx=\""), value("cy=\""), has(tag, "behind")});
  }
  REQUIRE(spots.size() == 4);
  const auto ruler = arm.find("class=\"ruler\"");
  const double scale = std::stod(arm.substr(arm.find('h', ruler) + 1)) / 0.2;  // of the first view
  CHECK(spots[1].x - spots[0].x == doctest::Approx(0.2 * scale).epsilon(0.01));
  CHECK(spots[1].y - spots[0].y == doctest::Approx(0.108 * scale).epsilon(0.03));
  CHECK(spots[2].y ==
        doctest::Approx(spots[3].y).epsilon(0.01));  // from above: one behind the other's height
  CHECK_FALSE(spots[2].behind);
  CHECK(spots[3].behind);  // below the arm
  for (const char* number : {">1</text>", ">2</text>"}) CHECK(count(arm, number) == 2);
  // The same cell twice is one place with two numbers; an unknown place is not drawn.
  log.touches[1] = log.touches[0];
  CHECK(count(report(log), ">1, 2</text>") == 2);
  log.touches[1].place[1] = no_number;
  CHECK(count(report(log), "<circle class=\"spot") == 2);
  log.entries.clear();
  CHECK_FALSE(has(report(log), "id=arm"));
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
