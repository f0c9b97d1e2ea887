#include "examples/packing_oranges/report.hpp"

#include <algorithm>
#include <cmath>

#include "examples/packing_oranges/pictures.hpp"
#include "examples/packing_oranges/process.hpp"
#include "examples/support/report_style.hpp"
#include "examples/support/svg_plot.hpp"
#include "examples/support/text.hpp"
#include "skinctl/core/xml_text.hpp"

namespace packing {
using examples::text;
namespace {
int failed(const ArmOutcome& a) {
  return static_cast<int>(std::count_if(a.done.begin(), a.done.end(),
                                        [](const Done& d) { return d.why != skinctl::StepFailure::none; }));
}
int went_back(const ArmOutcome& a) {
  return static_cast<int>(std::count_if(a.done.begin(), a.done.end(), [](const Done& d) { return d.back; }));
}
/// What squeezes told of the stiffness, over the true one.
struct Judgement {
  double mean = 0, spread = 0;
};
Judgement judgement(const Outcome& o) {
  double n = 0, sum = 0, square = 0;
  for (const ArmOutcome& a : o.arm)
    for (const auto& j : a.judged) {
      if (!(j.truth > 0) || !(j.stiffness < 1e6)) continue;
      const double x = j.stiffness / j.truth;
      ++n, sum += x, square += x * x;
    }
  if (!(n > 0)) return {};
  return {sum / n, std::sqrt(std::max(0.0, square / n - sum * sum / (n * n))) * n / sum};
}
/// The share that these squeezes would misjudge if good ones were `ratio` times as stiff as bad ones, both normally
/// distributed with the relative deviation `spread`, half of them good.
double misjudged_at(const Outcome& o, double ratio, double spread) {
  const auto below = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
  double n = 0, wrong = 0;
  for (const ArmOutcome& a : o.arm)
    for (const auto& j : a.judged) {
      if (!(j.truth > 0) || !(spread > 0)) continue;
      const double told = j.stiffness / j.truth, border = std::sqrt(ratio);
      wrong += 0.5 * (below((1 / (border * told) - 1) / spread) + below((1 - border / told) / spread));
      ++n;
    }
  return n > 0 ? wrong / n : 0;
}
std::string failures(const ArmOutcome& a, const Plan& plan) {
  constexpr int shown = 8;
  std::string out;
  int n = 0;
  for (const Done& d : a.done) {
    if (d.why == skinctl::StepFailure::none) continue;
    if (++n <= shown)
      out += text("  %8.2f s  %s: %s\n", d.to, name_of(plan, d.step), skinctl::describe(d.why));
  }
  if (n > shown) out += text("  and %d more\n", n - shown);
  return out;
}
/// Full boxes that arms have put away, and how long each took, from reaching for its wall until it was let go [s].
std::string put_away(const Outcome& o, const Plan& plan) {
  double time = 0, force = 0;
  int count = 0, failed = 0;
  for (const ArmOutcome& a : o.arm) {
    force = std::max(force, a.worst_push);
    for (const Done& d : a.done) {
      if (plan.steps[d.step].role != full_box_class || d.does == &skinctl::activity::Look::rule) continue;
      time += d.to - d.from;
      const bool fails = d.why != skinctl::StepFailure::none;
      failed += fails;
      count += d.does == &skinctl::activity::Release::rule && !d.back && !fails;
    }
  }
  return text(
      "the arms put away %d full boxes: %.1f s each, with %.1f N at most, %d steps failed; a person fetched "
      "%d\n",
      count, count > 0 ? time / count : 0.0, force, failed, o.fetched);
}
/// The figures of a task with a tool.
std::string summary_of_tools(const Outcome& o, const RunSettings& s) {
  std::string out = text("a tool used by each of two %s, in %.0f s%s\n", o.robot.c_str(), o.time,
                         o.over      ? ""
                         : o.stopped ? ": interrupted"
                                     : ": the time is up");
  out += text("largest force of a finger %.2f N while holding, %.2f N at all; lost %d\n", o.worst_grip(),
              o.worst_force(), o.tool[0].lost() + o.tool[1].lost());
  for (std::size_t a = 0; a < arms; ++a) {
    const ArmOutcome& m = o.arm[a];
    const ToolOutcome& t = o.tool[a];
    out += text(
        "arm %zu: the tip went %.1f %% of its taught way within %.0f mm, %.1f mm beside it (95 %%), at least "
        "%.0f mm over the bread (taught: %.0f)\n",
        a + 1, 100 * t.share, 1e3 * ToolOutcome::tip_within, 1e3 * t.strayed, 1e3 * t.height,
        1e3 * t.taught_height);
    out += text(
        "arm %zu: from where it was taught lies the tool %.1f mm, the bread %.1f mm; a person moved the "
        "bread "
        "%d times\n",
        a + 1, 1e3 * t.tool_off, 1e3 * t.thing_off, t.moved);
    out += text(
        "arm %zu: %d steps failed, %d times back, %d times asked; touched %d times; %llu ms at walls or the "
        "table (%.1f N), %llu ms at the other arm; holds with %.1f N\n",
        a + 1, failed(m), went_back(m), m.asked, m.touches, static_cast<unsigned long long>(m.walls),
        m.wall_force, static_cast<unsigned long long>(m.other_arm), m.hold);
    out += failures(m, s.work.plan);
  }
  return out + text("%.1f times real time on one core; %.1f us a cycle of an arm, with its executor\n",
                    o.computed > 0 ? o.time / o.computed : 0, o.cycle);
}
}  // namespace

std::string summary(const Outcome& o, const RunSettings& s) {
  if (uses_tool(s.work.plan)) return summary_of_tools(o, s);
  std::string out;
  const int ended = static_cast<int>(o.ended.size());
  out += text("%d of %d oranges by two %s in %.0f s%s\n", ended, o.oranges, o.robot.c_str(), o.time,
              o.over      ? ""
              : o.stopped ? ": interrupted"
                          : ": the time is up");
  out += text("right %d (%.1f %%), misjudged %d, lost %d\n", o.right(),
              ended > 0 ? 100.0 * o.right() / ended : 0.0, o.misjudged(), o.lost());
  out += text("%.2f s an orange and arm; fingertips %.2f m/s^2 rms while carrying\n", o.seconds_an_orange(),
              o.shake());
  out += text("largest force of a finger %.2f N while holding, %.2f N at all\n", o.worst_grip(),
              o.worst_force());
  if (s.world.binary)
    out += text("largest force of a pressed orange on the table %.2f N\n",
                std::max(o.arm[0].worst_press, o.arm[1].worst_press));
  const Judgement j = judgement(o);
  out += text("stiffness by squeezing: %.3f of the true one in the mean, %.1f %% rms apart from that\n",
              j.mean, 100 * j.spread);
  out += "with such errors these would be misjudged, good ones so many times as stiff as bad ones:";
  for (const double ratio : {1.4, 1.5, 1.6, 1.7, 2.0})
    out += text("%s %.1f: %.1f %%", ratio > 1.4 ? "," : "", ratio,
                100 * misjudged_at(o, ratio, s.supply.spread));
  out += '\n';
  for (std::size_t a = 0; a < arms; ++a) {
    const ArmOutcome& m = o.arm[a];
    out += text(
        "arm %zu: %zu judged, %d steps failed, %d times back, %d times asked; waited %.1f s for the box; "
        "touched %d times; %llu ms at walls (%llu at once, %.1f N), %llu ms at the other arm, went "
        "aside for it %d times\n",
        a + 1, m.judged.size(), failed(m), went_back(m), m.asked, m.waited, m.touches,
        static_cast<unsigned long long>(m.walls), static_cast<unsigned long long>(m.longest_at_wall),
        m.wall_force, static_cast<unsigned long long>(m.other_arm), m.went_aside);
    out += failures(m, s.work.plan);
    if (m.gave_up)
      out += text("  it gave up: more than %d times back with no orange put; what lies before it is left\n",
                  s.work.in_vain + s.work.in_vain / 2);
  }
  for (std::size_t a = 0; a < arms && s.honest; ++a) {
    const ArmOutcome& m = o.arm[a];
    out += text("arm %zu: %d takes found nothing; bias %+.0f %+.0f mm; holds with %.1f N, left %zu; doubted:",
                a + 1, m.empty_takes, 1e3 * m.bias.x, 1e3 * m.bias.y, m.hold, m.slipped.size());
    for (const auto& p : m.doubted) out += text(" %+.2f %+.2f", p.x, p.y);
    out += m.doubted.empty() ? " nothing\n" : " m\n";
  }
  if (o.drives > 0)
    out += text(
        "drove %d times over %.1f m, halted %d times for a touch, went on %d times because it stood too far "
        "off; "
        "in the end wheels are off by %.0f mm, %.0f mrad; where it worked it stood within %.1f mm, %.1f mrad "
        "of "
        "where it took itself to stand\n",
        o.drives, second_table, o.halts, o.corrections, 1e3 * std::hypot(o.wheels_off.x, o.wheels_off.y),
        1e3 * std::abs(o.wheels_off.yaw), 1e3 * o.stood_off, 1e3 * o.stood_turned);
  if (puts_boxes_away(s.work.plan)) out += put_away(o, s.work.plan);
  if (o.put_away > 0) out += text("a person put away %d full boxes and bins\n", o.put_away);
  if (s.move_box > 0)
    out += text("a person moved the box by %.0f mm %d times\n", 1e3 * s.move_box, o.box_moved);
  if (s.obstacle > 0)
    out += text(
        "something passed %d times, at %.2f m/s: the arms gave way %d times, nearest %.0f mm (as capsules), "
        "%llu ms in contact, into which an arm moved at up to %.3f m/s itself; a person set an arm right %d "
        "times\n",
        o.passes, s.obstacle, o.arm[0].gave_way + o.arm[1].gave_way, 1e3 * o.nearest,
        static_cast<unsigned long long>(o.arm[0].obstacle + o.arm[1].obstacle),
        std::max(o.arm[0].into_obstacle, o.arm[1].into_obstacle), o.arm[0].set_right + o.arm[1].set_right);
  if (s.fault != Fault::none)
    out += text("fault at %.1f s, for %.1f s: %s\n", o.fault_begins, o.fault_ends - o.fault_begins,
                describe(s.fault));
  out += text("%.1f times real time on one core; %.1f us a cycle of an arm, with its executor\n",
              o.computed > 0 ? o.time / o.computed : 0, o.cycle);
  if (o.hand_cycle > 0) out += text("%.1f us a cycle of a hand\n", o.hand_cycle);
  return out;
}

std::string report(const Outcome& o, const RunSettings& s) {
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>Packing oranges</title>\n<style>\n" +
      std::string(examples::report_style) + plotting::plot_style() + picture_style() +
      "</style></head><body><main>\n<h1>Packing oranges</h1>\n<pre>" + skinctl::xml_text(summary(o, s)) +
      "</pre>\n";
  const auto part = [&](const std::string& title, const std::string& words, const std::string& picture) {
    page += "<figure><figcaption><h2>" + title + "</h2>\n<p>" + words + "</p></figcaption>\n" + picture +
            "</figure>\n";
  };
  part("Where the hands went", "From above, the first minute.", picture_from_above(o));
  part("What each arm did",
       "A row an arm, a minute a line; red: the way back after a failure, black: a person is asked.",
       picture_of_time(o, s));
  part("What was judged", "The stiffness that a squeeze told, over the orange's own; the line is the border.",
       picture_of_judgement(o, s));
  part("Force of a finger",
       "Blue: the force; brown: the opening in cm. The first oranges of the first arm; shaded: a person "
       "pushes the forearm.",
       picture_of_force(o));
  return page + "</main></body></html>\n";
}

}  // namespace packing
