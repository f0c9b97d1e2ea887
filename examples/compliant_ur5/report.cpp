#include "examples/compliant_ur5/report.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "examples/compliant_ur5/arm_picture.hpp"
#include "examples/compliant_ur5/noted.hpp"
#include "examples/support/report_style.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/core/xml_text.hpp"
#include "skinctl/guard/faults.hpp"
#include "skinctl/io/formatted.hpp"

namespace compliant_ur5 {
namespace {

using plotting::decimal;
using plotting::Plot;
using plotting::significant;

constexpr double degrees = 180 / std::numbers::pi;
constexpr double wide = 700, narrow = 320;

std::string link_name(int link) {
  if (link < 0) return "unknown link";  // felt by the motors
  const std::string number = "link " + std::to_string(link);
  return link >= 0 && link < 6 ? std::string(link_names[static_cast<std::size_t>(link)]) + " (" + number + ")"
                               : number;
}

bool gave_way(const TouchSummary& t) {
  return std::isfinite(t.give_way) && t.give_way >= 0;
}

double worst_return(const RunLog& log) {
  double worst = 0;
  for (const TouchSummary& t : log.touches)
    if (std::isfinite(t.return_error)) worst = std::max(worst, std::abs(t.return_error));
  return worst;
}

/// How many times more a rigid arm pushed; 0: unknown.
double ratio(const RunLog& log) {
  const bool known = std::isfinite(log.rigid_peak_force) && log.rigid_peak_force > 0 &&
                     std::isfinite(log.peak_force) && log.peak_force > 0;
  return known ? log.rigid_peak_force / log.peak_force : 0;
}

double duration(const RunLog& log) {
  double longest = 0;
  for (const LogEntry& e : log.entries)
    if (std::isfinite(e.time)) longest = std::max(longest, e.time);
  return longest;
}

std::string seconds(double s) {
  return decimal(s, s < 10 ? 1 : 0) + " s";
}

/// Keeps numbers and their units on one line.
std::string unbroken(std::string text) {
  for (const char* unit : {" N", " mm", " s"})
    for (std::size_t at = text.find(unit); at != std::string::npos; at = text.find(unit, at + 1))
      if (at > 0 && text[at - 1] >= '0' && text[at - 1] <= '9') text.replace(at, 1, "\u00A0");
  return text;
}

template <class Value>
plotting::Series series(const RunLog& log, std::string name, Value&& value) {
  plotting::Series s;
  s.name = std::move(name);
  s.x.reserve(log.entries.size());
  s.y.reserve(log.entries.size());
  for (const LogEntry& e : log.entries) {
    s.x.push_back(e.time);
    s.y.push_back(value(e));
  }
  return s;
}

template <class Value>
void add_joints(Plot& plot, const RunLog& log, Value&& value) {
  for (std::size_t j = 0; j < 6; ++j)
    plot.series.push_back(
        series(log, "joint " + std::to_string(j), [&](const LogEntry& e) { return value(e, j); }));
}

/// Both signs of each joint's limit; joints with the same limit share a line.
void add_limits(Plot& plot, const std::array<double, 6>& limits, double scale, int decimals,
                const std::string& unit) {
  std::vector<std::pair<double, std::string>> groups;
  for (std::size_t j = 0; j < 6; ++j) {
    if (!std::isfinite(limits[j]) || limits[j] <= 0) continue;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& g) {
      return std::abs(g.first - limits[j]) < 1e-9 * limits[j];
    });
    const std::string joint = std::to_string(j);
    if (same == groups.end())
      groups.emplace_back(limits[j], joint);
    else
      same->second += ", " + joint;
  }
  std::sort(groups.begin(), groups.end());
  for (const auto& [limit, joints] : groups) {
    std::string name;
    if (groups.size() <= 2)
      name = groups.size() == 2 ? "limit of joints " + joints + ": " : "limit of every joint: ";
    else if (&joints == &groups.back().second)
      name = "limits of the joints: " + decimal(groups.front().first * scale, decimals) + " to ";
    if (!name.empty()) name += decimal(limit * scale, decimals) + ' ' + unit;
    plot.limits.push_back({limit * scale, name});
    plot.limits.push_back({-limit * scale, ""});
  }
}

void add_touches(Plot& plot, const RunLog& log) {
  for (std::size_t i = 0; i < log.touches.size(); ++i) {
    const TouchSummary& t = log.touches[i];
    const std::string number = std::to_string(i + 1);
    plot.bands.push_back({t.start, t.end, number,
                          "touch " + number + ": " + link_name(t.link) +
                              (t.cell == 0 ? "" : ", cell " + std::to_string(t.cell)) + ", " +
                              decimal(t.peak_force, 1) + " N"});
  }
}

Plot force_plot(const RunLog& log) {
  Plot plot;
  plot.title = "Touch force";
  plot.y_name = "force [N]";
  plot.series.push_back(series(log, "felt by the skin", [](const LogEntry& e) { return e.force; }));
  if (log.rigid_peak_force > 0)
    plot.limits.push_back(
        {log.rigid_peak_force, "peak of a rigid arm: " + decimal(log.rigid_peak_force, 0) + " N"});
  add_touches(plot, log);
  return plot;
}

Plot farthest_plot(const RunLog& log) {
  Plot plot;
  plot.title = "Deflection";
  plot.y_name = "deflection, farthest joint [deg]";
  plot.series.push_back(series(log, "deflection", [](const LogEntry& e) { return degrees * e.deflection; }));
  plot.series.back().color = 2;
  add_touches(plot, log);
  return plot;
}

Plot deflection_plot(const RunLog& log) {
  Plot plot;
  plot.title = "Joint deflection";
  plot.y_name = "joint angle, actual less target [deg]";
  add_joints(plot, log, [](const LogEntry& e, std::size_t j) {
    return degrees * (static_cast<double>(e.q[j]) - static_cast<double>(e.target[j]));
  });
  add_touches(plot, log);
  return plot;
}

Plot velocity_plot(const RunLog& log) {
  Plot plot;
  plot.title = "Commanded velocity";
  plot.y_name = "joint velocity [deg/s]";
  add_joints(plot, log,
             [](const LogEntry& e, std::size_t j) { return degrees * static_cast<double>(e.velocity[j]); });
  add_limits(plot, log.velocity_limit, degrees, 0, "deg/s");
  add_touches(plot, log);
  return plot;
}

Plot acceleration_plot(const RunLog& log) {
  Plot plot;
  plot.title = "Commanded acceleration";
  plot.y_name = "joint acceleration [rad/s\u00B2]";
  add_joints(plot, log,
             [](const LogEntry& e, std::size_t j) { return static_cast<double>(e.acceleration[j]); });
  add_limits(plot, log.acceleration_limit, 1, 1, "rad/s\u00B2");
  add_touches(plot, log);
  return plot;
}

std::string law_name(const RunLog& log, std::size_t law) {
  return log.laws[law].empty() ? "law " + std::to_string(law) : log.laws[law];
}

Plot shares_plot(const RunLog& log) {
  Plot plot;
  plot.title = "Share of each law";
  plot.y_name = "length of the torque vector [N m]";
  for (std::size_t law = 0; law < log.laws.size(); ++law)
    plot.series.push_back(series(log, law_name(log, law), [law](const LogEntry& e) {
      double sum = 0;
      for (const float tau : e.shares[law]) sum += static_cast<double>(tau) * static_cast<double>(tau);
      return std::sqrt(sum);
    }));
  add_touches(plot, log);
  return plot;
}

Plot joint_shares_plot(const RunLog& log, std::size_t joint) {
  Plot plot;
  plot.title = "Joint " + std::to_string(joint) + ": torque of each law";
  plot.y_name = "torque [N m]";
  plot.width = narrow;
  plot.height = 190;
  for (std::size_t law = 0; law < log.laws.size(); ++law)
    plot.series.push_back(series(log, law_name(log, law), [law, joint](const LogEntry& e) {
      return static_cast<double>(e.shares[law][joint]);
    }));
  add_touches(plot, log);
  return plot;
}

std::size_t not_finite(const Plot& plot) {
  std::size_t n = 0;
  for (const plotting::Series& s : plot.series)
    for (std::size_t i = 0; i < s.y.size(); ++i) n += !std::isfinite(s.x[i]) || !std::isfinite(s.y[i]);
  return n;
}

/// Boxes that switch curves on and off without a script.
std::string switches(const Plot& plot, const std::string& id) {
  if (plot.series.size() < 2) return {};
  std::string out;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const std::string k = std::to_string(i);
    out += "<input type=checkbox checked class=k" + k + " id=" + id + k + "><label for=" + id + k +
           "><svg class=sp viewBox=\"0 0 20 8\" aria-hidden=true><g class=key><path class=s" + k +
           " d=\"M1 4H19\"/></g></svg>" + skinctl::xml_text(plot.series[i].name) + "</label>";
  }
  return out;
}

std::string svg_of_class(const Plot& plot, const std::string& cls) {
  std::string svg = plotting::inline_svg(plot);
  return svg.replace(svg.find("class=\"sp\""), 10, "class=\"sp " + cls + '"');
}

std::string figure(Plot plot, const std::string& id, const std::string& says, double height,
                   const std::string& more = {}) {
  std::string out =
      "<figure id=" + id + "><figcaption><h2>" + skinctl::xml_text(plot.title) + "</h2><p>" + says;
  if (const std::size_t n = not_finite(plot))
    out += " <span class=bad>" + std::to_string(n) + (n == 1 ? " value is" : " values are") +
           " not finite and left out.</span>";
  out += "</p></figcaption>" + switches(plot, id);
  plot.width = wide, plot.height = height;
  out += svg_of_class(plot, "wide");
  plot.width = narrow, plot.height = std::max(0.85 * height, 215.0);
  out += svg_of_class(plot, "narrow");
  return out + more + "</figure>\n";
}

std::string bars(const RunLog& log) {
  const double rigid = log.rigid_peak_force, ours = log.peak_force;
  if (ratio(log) == 0) return {};
  const double top = std::max(rigid, ours);
  const auto bar = [&](const char* cls, const char* name, double force) {
    return "<span>" + std::string(name) + "</span><span class=\"bar " + cls +
           "\"><i style=\"width:" + std::to_string(static_cast<int>(std::lround(74 * force / top))) +
           "%\"></i><b>" + decimal(force, force < 10 ? 1 : 0) + " N</b></span>";
  };
  return "<section><h2>Hardest contact, the same touches</h2><div class=bars>" +
         bar("rigid", "Rigid arm", rigid) + bar("ours", "With skin", ours) + "</div></section>\n";
}

std::string tile(const std::string& name, const std::string& value, const std::string& note = {}) {
  return "<div class=tile><dt>" + name + "</dt><dd>" + value +
         (note.empty() ? "" : "<small>" + note + "</small>") + "</dd></div>";
}

/// Largest share of its limit that any joint's command used, with the joint; negative: no limit is known.
std::pair<double, std::size_t> largest_use(const RunLog& log, std::array<float, 6> LogEntry::* of,
                                           const std::array<double, 6>& limits) {
  std::pair<double, std::size_t> use{-1, 0};
  for (std::size_t j = 0; j < 6; ++j) {
    if (!std::isfinite(limits[j]) || limits[j] <= 0) continue;
    for (const LogEntry& e : log.entries) {
      const double u = std::abs(static_cast<double>((e.*of)[j])) / limits[j];
      if (u > use.first) use = {u, j};
    }
  }
  return use;
}

std::string tiles(const RunLog& log) {
  double slowest = -1, farthest = 0;
  std::size_t yielded = 0;
  for (const TouchSummary& t : log.touches) {
    if (gave_way(t)) slowest = std::max(slowest, t.give_way), ++yielded;
    if (std::isfinite(t.deflection)) farthest = std::max(farthest, t.deflection);
  }
  std::string out = "<dl class=tiles>";
  out +=
      tile("Peak contact force", decimal(log.peak_force, 1) + " N",
           ratio(log) > 0 ? decimal(ratio(log), 1) + " times lower than rigid" : "a rigid arm was not run");
  if (!log.touches.empty()) {
    out += tile("Gave way", std::to_string(yielded) + " of " + std::to_string(log.touches.size()),
                slowest >= 0 ? "by 1 mm within " + decimal(1e3 * slowest, 0) + " ms" : "");
    out += tile("Farthest deflection", decimal(1e3 * farthest, 1) + " mm", "of a touched point");
    out +=
        tile("Back to its task", decimal(1e3 * worst_return(log), 2) + " mm", "largest error after a touch");
  }
  const auto use = [&](const char* name, std::array<float, 6> LogEntry::* of,
                       const std::array<double, 6>& limits) {
    const auto [share, joint] = largest_use(log, of, limits);
    if (share >= 0)
      out +=
          tile(name, decimal(100 * share, 0) + " %", "of the limit at most, joint " + std::to_string(joint));
  };
  use("Velocity used", &LogEntry::velocity, log.velocity_limit);
  use("Acceleration used", &LogEntry::acceleration, log.acceleration_limit);
  return out + "</dl>\n";
}

std::string touch_table(const RunLog& log) {
  if (log.touches.empty()) return {};
  const bool truth = std::any_of(log.touches.begin(), log.touches.end(),
                                 [](const TouchSummary& t) { return t.true_peak_force >= 0; });
  double hardest = 0;
  for (const TouchSummary& t : log.touches)
    if (std::isfinite(t.peak_force)) hardest = std::max(hardest, t.peak_force);
  std::string out =
      "<section id=touches><h2>Every touch</h2><p>Numbered as in the pictures.</p><div class=scroll "
      "tabindex=0><table><thead><tr>"
      "<th scope=col>#<th class=word scope=col>Link<th class=long scope=col>Peak force<small>N</small>"
      "<th scope=col>Deflection<small>mm</small><th class=long scope=col>Time to give way<small>ms</small>"
      "<th class=long scope=col>Return error<small>mm</small>";
  if (truth) out += "<th class=long scope=col>Finger\u2019s own peak<small>N</small>";
  out +=
      "<th scope=col>Cell<th scope=col>From<small>s</small><th "
      "scope=col>Lasted<small>s</small></tr></thead><tbody>\n";
  const auto cell = [&](const std::string& v, bool bad = false) {
    out += (bad ? "<td class=bad>" : "<td>") + v;
  };
  for (std::size_t i = 0; i < log.touches.size(); ++i) {
    const TouchSummary& t = log.touches[i];
    out += "<tr>";
    cell(std::to_string(i + 1));
    out += "<th class=word scope=row>" + link_name(t.link);
    const double share =
        hardest > 0 && std::isfinite(t.peak_force) ? std::clamp(t.peak_force / hardest, 0.0, 1.0) : 0;
    out += "<td class=meter style=\"--v:" + std::to_string(static_cast<int>(100 * share)) + "%\">" +
           decimal(t.peak_force, 1);
    cell(decimal(1e3 * t.deflection, 1), t.deflection < 0);
    cell(gave_way(t) ? decimal(1e3 * t.give_way, 0) : "never", !gave_way(t));
    cell(decimal(1e3 * t.return_error, 2));
    if (truth) cell(t.true_peak_force >= 0 ? decimal(t.true_peak_force, 1) : "\u2013");
    cell(std::to_string(t.cell));
    cell(decimal(t.start, 2));
    cell(decimal(t.end - t.start, 2));
    out += "</tr>\n";
  }
  return out + "</tbody></table></div></section>\n";
}

std::string arm_section(const RunLog& log) {
  const std::string views = arm_picture(log);
  if (views.empty()) return {};
  std::string says = "The pose in which the run began.";
  if (!log.touches.empty())
    says += " Numbers: the touches of the table, each at the cell that felt most; dashed: on the far side.";
  return "<section id=arm><h2>Where it was touched</h2><p>" + says + "</p><div class=views>" + views +
         "</div></section>\n";
}

std::string felt_section(const RunLog& log) {
  const std::string views = felt_picture(log);
  if (views.empty()) return {};
  std::array<std::size_t, 2> counts{};
  double slowest = std::numeric_limits<double>::infinity();
  for (const FeltPlace& f : log.felt) {
    ++counts[std::isfinite(f.noticed) ? 0 : 1];
    slowest = std::min(slowest, f.speed);
  }
  return "<section id=felt><h2>Where this arm feels, and how well</h2><p>The least force on each place that "
         "somebody notices, at the end of the run: <span class=\"dot felt-0\"></span> up to 5 N, <span "
         "class=\"dot felt-1\"></span> up to 25 N, <span class=\"dot felt-2\"></span> more, <span "
         "class=\"dot "
         "felt-3\"></span> none: " +
         std::to_string(counts[1]) + " of " + std::to_string(counts[0] + counts[1]) +
         " places. A place may lead no faster than a body that it meets allows; the slowest " +
         decimal(slowest, 3) + " m/s.</p><div class=views>" + views + "</div></section>\n";
}

/// Why the times above are not those of the README.
std::string why_slower(const RunLog& log) {
  const CycleParts& c = log.cycle;
  if (c.substeps == 0 || c.period <= 0 || log.times.empty()) return {};
  const StageTimes& whole = log.times.back();
  const auto us = [](double t) { return significant(t, 3) + "\u00A0\u00B5s"; };
  const auto ms = [](double s) {
    return decimal(1e3 * s, s < 0.01 && std::fmod(1e3 * s, 1) > 1e-9 ? 1 : 0) + "\u00A0ms";
  };
  std::string out =
      "<p id=why>The README\u2019s microsecond is one evaluation of skin and laws and one sub-step of the "
      "virtual robot, run again and again with everything in the caches. ";
  out += c.substeps == 1 ? "A cycle here, of " + ms(c.period) + ", is one such sub-step. "
                         : "A cycle here covers " + ms(c.period) + " in " + std::to_string(c.substeps) +
                               " sub-steps of " + ms(c.period / c.substeps) +
                               ", each with an evaluation of its own: the median of " + us(whole.median) +
                               " is " + us(whole.median / c.substeps) + " a sub-step. ";
  out +=
      "Between two cycles the loop waits for the robot, while others use the processor and its caches; that "
      "shows in the slowest cycles.";
  if (c.repeated > 0)
    out += " The slowest took " + us(whole.max) + " in the run; with the same memory and input, run " +
           std::to_string(c.repeated) + " times with nothing in between, " + us(c.repeated_median) +
           " (median)" +
           (c.substeps > 1 ? ", or " + us(c.repeated_median / c.substeps) + " a sub-step." : ".");
  return out + "</p>";
}

/// A field of a CSV file.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + '"';
}
/// The shortest number with so many decimals at most; empty when it is not finite.
std::string plain(double v, int decimals) {
  if (!std::isfinite(v)) return {};
  if (std::abs(v) >= 1e15) return skinctl::formatted("%.6g", v);
  std::string out = skinctl::formatted("%.*f", decimals, v);
  out.erase(out.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
  return out == "-0" || out.empty() ? "0" : out;
}

std::string touches_csv(const RunLog& log) {
  std::string out =
      "touch,link,cell,from [s],to [s],peak force [N],finger's own peak [N],deflection [m],time to give way "
      "[s],return error [m],x in the link's frame [m],y [m],z [m]\n";
  for (std::size_t i = 0; i < log.touches.size(); ++i) {
    const TouchSummary& t = log.touches[i];
    out += std::to_string(i + 1) + ',' + std::to_string(t.link) + ',' + std::to_string(t.cell);
    const auto add = [&](double v, int decimals, bool known = true) {
      out += ',' + (known ? plain(v, decimals) : std::string());
    };
    add(t.start, 4), add(t.end, 4), add(t.peak_force, 4), add(t.true_peak_force, 4, t.true_peak_force >= 0);
    add(t.deflection, 6), add(t.give_way, 4, gave_way(t)), add(t.return_error, 6);
    for (const double p : t.place) add(p, 5);
    out += '\n';
  }
  return out;
}

/// More rows would make links that browsers refuse to download (2 MB), and a page that is slow to load.
constexpr std::size_t max_rows = 8000;
std::size_t every_nth(const RunLog& log) {
  return (log.entries.size() + max_rows - 1) / max_rows;
}

/// Quantities of each joint, with their decimals.
struct Columns {
  std::string name;
  int decimals = 4;
  const std::array<float, 6>& (*of)(const LogEntry&) = nullptr;
};
std::string cycles_csv(const RunLog& log, bool with_force, const std::vector<Columns>& columns) {
  std::string out = "time [s]";
  if (with_force) out += ",force [N],deflection [rad]";
  for (const Columns& c : columns)
    for (std::size_t j = 0; j < 6; ++j) out += ',' + field("joint " + std::to_string(j) + ' ' + c.name);
  out += '\n';
  for (std::size_t i = 0; i < log.entries.size(); i += every_nth(log)) {
    const LogEntry& e = log.entries[i];
    out += plain(e.time, 4);
    if (with_force) out += ',' + plain(e.force, 2) + ',' + plain(e.deflection, 4);
    for (const Columns& c : columns)
      for (const float v : c.of(e)) out += ',' + plain(static_cast<double>(v), c.decimals);
    out += '\n';
  }
  return out;
}

/// A link that is a file itself.
std::string file_link(const std::string& name, const std::string& says, const std::string& text) {
  constexpr char digits[] = "0123456789ABCDEF";
  std::string out = "<li><a download=\"" + name + "\" href=\"data:text/csv;charset=utf-8,";
  for (const char ch : text) {
    const auto c = static_cast<unsigned char>(ch);
    if (c > 0x20 && c < 0x7F && std::strchr("%#\"&<>'`", ch) == nullptr)
      out += ch;
    else
      out += {'%', digits[c >> 4], digits[c & 15]};
  }
  const std::size_t kb = (text.size() + 999) / 1000;
  return out + "\">" + name + "</a> <small>" + says + ", " + std::to_string(kb) + " kB</small>";
}

std::string data_section(const RunLog& log) {
  if (log.entries.empty() && log.touches.empty()) return {};
  std::string out = "<section id=data><h2>Data</h2><p>What is drawn above, as files that this page holds.";
  if (const std::size_t n = every_nth(log); n > 1)
    out += " Of " + std::to_string(log.entries.size()) + " cycles one in " + std::to_string(n) + '.';
  out += "</p><ul class=files>";
  if (!log.touches.empty()) out += file_link("touches.csv", "every touch", touches_csv(log));
  if (!log.entries.empty()) {
    out += file_link("motion.csv", "force, angle of each joint and its target",
                     cycles_csv(log, true,
                                {{"angle [rad]", 4, [](const LogEntry& e) -> auto& { return e.q; }},
                                 {"target [rad]", 4, [](const LogEntry& e) -> auto& { return e.target; }}}));
    out += file_link(
        "commands.csv", "commanded velocity and acceleration",
        cycles_csv(
            log, false,
            {{"velocity [rad/s]", 4, [](const LogEntry& e) -> auto& { return e.velocity; }},
             {"acceleration [rad/s^2]", 2, [](const LogEntry& e) -> auto& { return e.acceleration; }}}));
    out += file_link(
        "torques.csv", "torque of each law",
        cycles_csv(
            log, false,
            {{law_name(log, 0) + " [N m]", 2, [](const LogEntry& e) -> auto& { return e.shares[0]; }},
             {law_name(log, 1) + " [N m]", 2, [](const LogEntry& e) -> auto& { return e.shares[1]; }},
             {law_name(log, 2) + " [N m]", 2, [](const LogEntry& e) -> auto& { return e.shares[2]; }}}));
  }
  return out + "</ul></section>\n";
}

std::string time_table(const RunLog& log) {
  if (log.times.empty()) return {};
  std::string out =
      "<section><h2>Cycle times</h2><p>Microseconds of one cycle on the machine that ran this, by stage.</p>"
      "<div class=scroll tabindex=0><table><thead><tr><th class=word scope=col>Stage<th scope=col>Median"
      "<th scope=col>99 %<th scope=col>99.9 %<th scope=col>Longest</tr></thead><tbody>\n";
  for (const StageTimes& t : log.times) {
    out += "<tr><th class=word scope=row>" + skinctl::xml_text(t.stage);
    for (const double v : {t.median, t.p99, t.p999, t.max}) out += "<td>" + significant(v, 3);
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>" + why_slower(log) + "</section>\n";
}

std::string facts(const std::string& title, const std::vector<Fact>& list) {
  if (list.empty()) return {};
  std::string out = "<section><h2>" + title + "</h2><dl class=facts>";
  for (const Fact& f : list)
    out += "<div><dt>" + skinctl::xml_text(f.name) + "</dt><dd>" + skinctl::xml_text(f.value) + "</dd></div>";
  return out + "</dl></section>\n";
}

/// What the loop reported, with which effect, and in how many cycles.
std::string statuses(const RunLog& log) {
  std::string rows;
  for (const Noted& n : noted(log))
    rows += "<tr><th class=word scope=row>" + skinctl::xml_text(skinctl::describe(n.reason)) +
            "<td class=word>" + skinctl::name(n.reaction) + "<td>" + std::to_string(n.cycles) + "<td>" +
            decimal(n.first, 2) + "</tr>\n";
  if (rows.empty()) return {};
  return "<section><h2>What the loop reported</h2><p>Anything that a cycle limited, held or refused after "
         "the "
         "sensor's first reading; before it, " +
         std::to_string(cycles_of_start(log)) +
         " cycles waited for it.</p>"
         "<div class=scroll tabindex=0><table><thead><tr><th class=word scope=col>What<th class=word "
         "scope=col>Effect"
         "<th scope=col>Cycles"
         "<th scope=col>First at<small>s</small></tr></thead><tbody>\n" +
         rows + "</tbody></table></div></section>\n";
}

/// The hardest touch over a second or two, so that the give-way itself is visible.
std::string close_up(const RunLog& log) {
  const TouchSummary* hardest = nullptr;
  std::size_t number = 0;
  for (std::size_t i = 0; i < log.touches.size(); ++i) {
    const TouchSummary& t = log.touches[i];
    const bool usable = std::isfinite(t.start) && std::isfinite(t.end) && std::isfinite(t.peak_force);
    if (usable && (hardest == nullptr || t.peak_force > hardest->peak_force)) hardest = &t, number = i + 1;
  }
  if (hardest == nullptr) return {};
  const double length = std::max(hardest->end - hardest->start, 0.0);
  const double from = hardest->start - 0.1, to = hardest->start + 0.75;
  RunLog part;
  for (const LogEntry& e : log.entries)
    if (e.time >= from && e.time <= to) part.entries.push_back(e);
  if (part.entries.size() < 4) return {};
  for (LogEntry& e : part.entries) e.time = 1e3 * (e.time - hardest->start);
  TouchSummary touch = *hardest;
  touch.start = 0, touch.end = 1e3 * length;
  part.touches = {touch};

  Plot force = force_plot(part), away = farthest_plot(part);
  const std::string name = "time since first contact [ms]";
  std::string out = "<section id=closeup><h2>Touch " + std::to_string(number) +
                    " up close</h2><p>Its first moments, on the " + link_name(touch.link) +
                    ": the force rises until the arm has picked up speed, then falls.</p><div class=grid>";
  for (Plot* plot : {&force, &away}) {
    plot->title += " of the hardest touch";
    plot->x_name = name;
    plot->width = 340;
    plot->height = 215;
    for (plotting::Band& band : plot->bands) band.label.clear();
    out += plotting::inline_svg(*plot);
  }
  return out + "</div></section>\n";
}

std::string plots(const RunLog& log) {
  const std::string shaded = log.touches.empty() ? "" : " Shaded: touches, numbered as in the table.";
  std::string each = "<details><summary>Each joint on its own</summary><div class=grid>";
  for (std::size_t j = 0; j < 6; ++j)
    each += "<div><p>Joint " + std::to_string(j) + "</p>" + plotting::inline_svg(joint_shares_plot(log, j)) +
            "</div>";
  each += "</div></details>";
  return figure(force_plot(log), "force", "Largest force that the skin reports." + shaded, 280) +
         figure(deflection_plot(log), "deflection",
                "How far each joint is from where its task wants it: away during a touch, back to zero after "
                "it.",
                300) +
         figure(velocity_plot(log), "velocity", "What the robot was told, with the configured limits.", 300) +
         figure(acceleration_plot(log), "acceleration",
                "Never beyond the configured limits, also at the first contact.", 300) +
         figure(shares_plot(log), "shares",
                "Length of the vector of joint torques that each law adds: the skin\u2019s rises where "
                "somebody pushes.",
                280, each);
}

constexpr char glossary[] = R"html(<footer><dl>
<dt>Peak force</dt><dd>The largest force of a touch, as the skin measured it; the finger&#39;s own only where the finger is simulated.</dd>
<dt>Deflection</dt><dd>How far the touched point moved away from the finger. Negative would be towards it.</dd>
<dt>Time to give way</dt><dd>From the first contact until the touched point had moved by 1 mm.</dd>
<dt>Return error</dt><dd>Distance of the touched point from its task before the next touch, or at the end.</dd>
</dl><p>skinctl is no safety-rated function: this page shows what was measured, and guarantees nothing beyond.</p></footer>
)html";

}  // namespace

std::string headline(const RunLog& log) {
  const std::size_t n = log.touches.size();
  if (n == 0)
    return log.entries.empty() ? "Nothing was recorded."
                               : "Nobody touched the arm in " + seconds(duration(log)) + ".";
  const auto yielded =
      static_cast<std::size_t>(std::count_if(log.touches.begin(), log.touches.end(), gave_way));
  const std::string force = decimal(log.peak_force, log.peak_force < 10 ? 1 : 0) + " N";
  std::string out;
  if (yielded == n)
    out = n == 1 ? "Touched once, the arm gave way: "
                 : "Touched " + std::to_string(n) + " times, the arm gave way every time: ";
  else if (yielded == 0)
    out = n == 1 ? "Touched once, the arm did not give way: "
                 : "Touched " + std::to_string(n) + " times, the arm never gave way: ";
  else
    out = "The arm gave way to " + std::to_string(yielded) + " of " + std::to_string(n) + " touches: ";
  const double times = ratio(log);
  if (times > 1)
    out += "at most " + force + " where a rigid arm pushes with " + decimal(log.rigid_peak_force, 0) + " N";
  else
    out += "at most " + force;
  if (yielded > 0) out += ", and back to within " + decimal(1e3 * worst_return(log), 1) + " mm of its task";
  return out + '.';
}

std::string report(const RunLog& log) {
  const std::string title = log.title.empty() ? "compliant_ur5" : log.title;
  std::string out =
      "<!doctype html>\n<html lang=en><head><meta charset=utf-8>"
      "<meta name=viewport content=\"width=device-width,initial-scale=1\">"
      "<meta name=color-scheme content=\"light dark\"><link rel=icon href=\"data:,\"><title>" +
      skinctl::xml_text(title) + "</title>\n<style>" + examples::report_style + plotting::plot_style() +
      "</style></head>\n<body><main>\n";
  out += "<p class=eyebrow>" + skinctl::xml_text(title) +
         (log.entries.empty() ? "" : " \u00B7 " + seconds(duration(log))) + "</p>\n<h1>" +
         unbroken(skinctl::xml_text(headline(log))) + "</h1>\n";
  out += bars(log) + tiles(log);
  out +=
      arm_section(log) + touch_table(log) + close_up(log) + plots(log) + felt_section(log) + time_table(log);
  out += "<div class=two>" + facts("Result", log.result) + facts("Scenario", log.scenario) + "</div>\n";
  out += statuses(log) + data_section(log) + glossary + "</main></body></html>\n";
  return out;
}

void write_report(const RunLog& log, const std::string& path) {
  const std::string page = report(log), part = path + ".part";
  const auto fail = [&](const std::string& why) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
    throw std::runtime_error("cannot write the report '" + path + "': " + why);
  };
  {
    std::ofstream out(part, std::ios::binary | std::ios::trunc);
    if (!out) fail(std::strerror(errno));
    out << page;
    out.close();
    if (!out) fail(std::strerror(errno));
  }
  std::error_code error;
  std::filesystem::rename(part, path, error);
  if (error) fail(error.message());
}

std::string picture(const RunLog& log) {
  Plot force = force_plot(log);
  force.title.clear();
  force.y_name = "touch force [N]";
  force.height = 230;
  Plot deflection = farthest_plot(log);
  deflection.title.clear();
  deflection.height = 210;
  for (plotting::Band& band : deflection.bands) band.label.clear();
  force.width = deflection.width = 880;
  return plotting::svg_figure(headline(log), {force, deflection});
}

}  // namespace compliant_ur5
