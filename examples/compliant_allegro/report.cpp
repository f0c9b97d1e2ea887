// The run of a hand as a page that needs nothing else; its style is the arm's.
#include <cmath>
#include <numbers>

#include "examples/compliant_allegro/run.hpp"
#include "examples/support/report_style.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/core/xml_text.hpp"

namespace compliant_allegro {
namespace {

using plotting::decimal;
using plotting::Plot;

constexpr double degrees = 180 / std::numbers::pi;
constexpr const char* fingers[] = {"Index", "Middle", "Ring", "Thumb"};

std::string cell_name(std::size_t k) {
  if (k == 0) return "palm";
  constexpr const char* parts[] = {"proximal phalanx", "middle phalanx", "distal phalanx", "tip"};
  return std::string(fingers[k / 4]) + ", " + parts[k % 4];
}

template <class Value>
plotting::Series series(const RunLog& log, const std::string& name, Value&& value) {
  plotting::Series s;
  s.name = name;
  for (const LogEntry& e : log.entries) {
    s.x.push_back(e.time);
    s.y.push_back(static_cast<double>(value(e)));
  }
  return s;
}

void add_bands(Plot& plot, const RunLog& log) {
  for (std::size_t k = 0; k < log.touches.size(); ++k) {
    const TouchSummary& t = log.touches[k];
    plot.bands.push_back({t.start, t.end, std::to_string(k + 1), cell_name(t.cell)});
  }
  for (std::size_t k = 0; k + 1 < log.task.size(); ++k)
    if (std::string_view(log.task[k].name) == "close")
      plot.bands.push_back({log.task[k].at, log.task[k + 1].at, "closed", "closes on the object"});
}

std::string figure(Plot plot, const RunLog& log, const std::string& text) {
  add_bands(plot, log);
  std::string out = "<figure><figcaption><h2>" + skinctl::xml_text(plot.title) + "</h2><p>" +
                    skinctl::xml_text(text) + "</p></figcaption>";
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const std::string id =
        "p" + std::to_string(std::hash<std::string>{}(plot.title) % 100000) + "-" + std::to_string(k);
    out += "<input type=\"checkbox\" checked id=\"" + id + "\" class=\"k" + std::to_string(k) +
           "\"><label for=\"" + id + "\"><svg class=\"sp\" viewBox=\"0 0 20 8\"><path class=\"s" +
           std::to_string(k) + "\" d=\"M0 4H20\"/></svg>" + skinctl::xml_text(plot.series[k].name) +
           "</label>";
  }
  plot.width = 700;
  std::string wide = plotting::inline_svg(plot);
  plot.width = 320;
  std::string narrow = plotting::inline_svg(plot);
  const auto with = [](std::string svg, const char* name) {
    if (const auto at = svg.find("class=\""); at != std::string::npos && at < svg.find('>'))
      svg.insert(at + 7, std::string(name) + " ");
    return svg;
  };
  return out + with(wide, "wide") + with(narrow, "narrow") + "</figure>";
}

std::string tile(const std::string& name, const std::string& value, const std::string& small) {
  return "<div class=\"tile\"><dt>" + skinctl::xml_text(name) + "</dt><dd>" + skinctl::xml_text(value) +
         "<small>" + skinctl::xml_text(small) + "</small></dd></div>";
}

}  // namespace

std::string report(const RunLog& log) {
  double moved = 0, back = 0, soonest = -1;
  for (const TouchSummary& t : log.touches) {
    moved = std::max(moved, t.moved);
    back = std::max(back, t.return_error);
    if (t.after >= 0) soonest = std::max(soonest, t.after);
  }
  std::string out =
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\"><title>" +
      skinctl::xml_text(log.title) + "</title><style>" + examples::report_style + plotting::plot_style() +
      "</style></head><body><main><p class=\"eyebrow\">" + skinctl::xml_text(log.title) + "</p><h1>";
  if (!log.reason.empty())
    out += "The run ended early: " + skinctl::xml_text(log.reason);
  else if (log.touches.empty())
    out += "Nobody touched the hand in " + std::to_string(log.cycles) + " cycles";
  else
    out += "The hand gave way to " + std::to_string(log.touches.size()) +
           (log.touches.size() == 1 ? " touch" : " touches") + " by up to " + decimal(1e3 * moved, 1) +
           "\u00A0mm and came back to within " + decimal(1e3 * back, 1) + "\u00A0mm";
  out += "</h1><dl class=\"tiles\">";
  out += tile("gave way by", decimal(1e3 * moved, 1) + " mm", "touched cell, along its normal, farthest");
  out += tile("by 1 mm within", soonest < 0 ? "never" : decimal(1e3 * soonest, 0) + " ms",
              "of the touch, slowest");
  out += tile("time of a cycle", decimal(log.median_us, 1) + " us",
              "median; 99 % within " + decimal(log.p99_us, 1) + " us");
  out +=
      "</dl><section><h2>Touches</h2><div class=\"scroll\"><table><thead><tr><th "
      "class=\"word\">touch</th><th "
      "class=\"word\">cell</th><th>at [s]</th><th>largest reading</th><th>gave way [mm]</th><th>1 mm after "
      "[ms]</th><th>return error [mm]</th></tr></thead><tbody>";
  int k = 0;
  for (const TouchSummary& t : log.touches)
    out += "<tr><th>" + std::to_string(++k) + "</th><td class=\"word\">" +
           skinctl::xml_text(cell_name(t.cell)) + "</td><td>" + decimal(t.start, 2) + "</td><td>" +
           decimal(t.reading, 2) + "</td><td>" + decimal(1e3 * t.moved, 1) + "</td><td>" +
           (t.after < 0 ? "never" : decimal(1e3 * t.after, 0)) + "</td><td>" +
           decimal(1e3 * t.return_error, 1) + "</td></tr>";
  out +=
      "</tbody></table></div></section><section><h2>Closed</h2><p>Mean of the last second before it opens: "
      "torque of "
      "the three flexing joints of each finger, and, of a simulated ball, what it feels.</p><div "
      "class=\"scroll\"><table><thead><tr><th class=\"word\">finger</th><th>torque [N m]</th><th>force on "
      "the ball "
      "[N]</th></tr></thead><tbody>";
  for (std::size_t f = 0; f < 4; ++f)
    out += std::string("<tr><th>") + fingers[f] + "</th><td>" + decimal(log.squeeze[f], 3) + "</td><td>" +
           decimal(log.ball[f], 1) + "</td></tr>";
  out += "</tbody></table></div></section>";

  Plot touch;
  touch.title = "Touch";
  touch.y_name = "reading of the firmest cell of a finger";
  for (std::size_t f = 0; f < 4; ++f)
    touch.series.push_back(series(log, fingers[f], [f](const LogEntry& e) {
      float most = 0;
      for (std::size_t i = f == 0 ? 1 : 0; i < 4; ++i) most = std::max(most, e.cell[4 * f + i]);
      return most;
    }));
  out += figure(touch, log, "Tactile cells, 0 to 1, uncalibrated.");
  for (std::size_t f = 0; f < 4; ++f) {
    Plot plot;
    plot.title = std::string(fingers[f]) + ": joints";
    plot.y_name = "angle [deg]";
    plot.from_zero = false;
    for (std::size_t i = 0; i < 4; ++i) {
      plot.series.push_back(series(log, "joint " + std::to_string(4 * f + i),
                                   [=](const LogEntry& e) { return degrees * double(e.q[4 * f + i]); }));
    }
    out += figure(plot, log, "Measured.");
  }
  Plot torque;
  torque.title = "Torque";
  torque.y_name = "largest of a finger [N m]";
  for (std::size_t f = 0; f < 4; ++f)
    torque.series.push_back(series(log, fingers[f], [f](const LogEntry& e) {
      float most = 0;
      for (std::size_t i = 0; i < 4; ++i)
        if (std::abs(e.torque[4 * f + i]) > std::abs(most)) most = e.torque[4 * f + i];
      return most;
    }));
  out += figure(torque, log, "Commanded, with its sign.");
  out += "<section><h2>Link and loop</h2><dl class=\"facts\">";
  for (const Fact& f : log.facts)
    out += "<div><dt>" + skinctl::xml_text(f.name) + "</dt><dd>" + skinctl::xml_text(f.value) + "</dd></div>";
  return out + "</dl></section></main></body></html>\n";
}

}  // namespace compliant_allegro
