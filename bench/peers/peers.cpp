// skinctl beside what a user would otherwise run: `peers [picture.svg]` prints the tables of
// bench/results/peers.md; `peers --check` only shows that the peers' rules are their originals'.
#include <string>
#include <string_view>

#include "bench/peers/touched_tool.hpp"
#include "examples/support/svg_plot.hpp"

using namespace peers;
using namespace skinctl::testing;

namespace {

constexpr Timing timings[] = {{0.008, 0.008}, {0.002, 0.008}, {0.008, 0.038}, {0.002, 0.038}};
constexpr const char* names[] = {"ideal", "skinctl",         "skinctl, 1000 rad/s^2",
                                 "ros2",  "ros2, no filter", "fzi"};

/// From 0 to 1 within `time`, with the least jerk.
double ramp(double t, double time) {
  const double u = std::clamp(t / time, 0.0, 1.0);
  return u * u * u * (10 + u * (6 * u - 15));
}

Measured lead(Rule rule, const Timing& timing, const Admittance& a, double mass) {
  HandSettings s = leading_hand(mass);
  s.holds = true, s.tremor = 0.3, s.cover_stiffness = 5000;
  Hand hand(s);
  return run(rule, Place{}, timing, a, 4, [&](double dt, double t, double x) {
    const double f = hand.advance(dt, 0.1 * ramp(t - 0.1, 1) + 0.1 * ramp(t - 1.8, 1), x);
    return Touching{f, f};
  });
}
Measured grip(Rule rule, const Timing& timing, const Admittance& a, double mass) {
  Grip hands(leading_hand(mass), 30);
  return run(rule, Place{}, timing, a, 4, [&](double dt, double t, double x) {
    const double f = hands.advance(dt, 0.05 * ramp(t - 0.1, 0.5), x);
    return Touching{f, f};
  });
}
/// A hand's steady 20 N lead the arm into a wall 10 mm away.
Measured wall(Rule rule, const Timing& timing, const Admittance& a, double stiffness) {
  Hand body(stiff_wall(stiffness), -0.01);
  return run(rule, Place{}, timing, a, 4, [&](double dt, double t, double x) {
    const double push = 20 * ramp(t, 0.2), f = body.advance(dt, -0.01, -x);
    return Touching{push - f, f};
  });
}
/// A finger pokes by 30 mm, stays, and leaves.
Measured poke(Rule rule, const Timing& timing, const Admittance& a) {
  Hand finger(poking_finger(), -0.005);
  return run(rule, Place{}, timing, a, 3, [&](double dt, double t, double x) {
    const double f = finger.advance(dt, -0.005 + 0.035 * (ramp(t - 0.1, 0.3) - ramp(t - 1.4, 0.3)), x);
    return Touching{f, f};
  });
}
Measured steady(Rule rule, const Timing& timing, const Admittance& a) {
  return run(rule, Place{}, timing, a, 2 + 2 * a.mass / a.friction, [&](double, double, double) {
    const double f = 0.03 * a.friction;
    return Touching{f, f};
  });
}
/// 15 N for 3 s against ends 0.15 rad away, then back.
Measured ends(Rule rule, const Timing& timing, const Admittance& a) {
  return run(rule, Place{.ends = 0.15}, timing, a, 4, [](double, double t, double) {
    const double f = t < 3 ? 15 * ramp(t, 0.2) : -15;
    return Touching{f, f};
  });
}
/// Pulled to where the elbow is stretched, and beyond.
Measured stretched(Rule rule, const Timing& timing, const Admittance& a) {
  return run(rule, Place{.q = {0, -0.6, 0.3, -1.3, -1.57, 0}}, timing, a, 3, [](double, double t, double) {
    const double f = 25 * ramp(t, 0.2);
    return Touching{f, f};
  });
}

/// `value(measured, ideal)` at the four timings, for each rule.
template <class Run, class Value>
void row(const char* name, const Admittance& a, bool has_ideal, Run&& scene, Value&& value) {
  std::printf("| %s |", name);
  for (const Rule rule : all_rules) {
    if (rule == Rule::ideal && !has_ideal) {
      std::printf(" - |");
      continue;
    }
    for (const Timing& timing : timings) {
      if (rule == Rule::ideal && &timing != timings) break;
      const Measured ideal = has_ideal ? scene(Rule::ideal, timing, a) : Measured{};
      const Measured m = scene(rule, timing, a);
      if (m.away) {
        std::printf(&timing == timings ? " away" : ", away");
        continue;
      }
      const double x = value(m, ideal);
      std::printf(&timing == timings ? " %.*f" : ", %.*f", x < 9.95 ? 1 : 0, x);
    }
    std::printf(" |");
  }
  std::printf("\n");
}

void table(const char* title, const Admittance& a) {
  std::printf("\n%s: %.1f kg, %.1f N s/m\n\n| |", title, a.mass, a.friction);
  for (const char* name : names) std::printf(" %s |", name);
  std::printf("\n|---|---|---|---|---|---|---|\n");
  const auto ring = [](const Measured& m, const Measured&) { return m.ring; };
  const auto peak = [](const Measured& m, const Measured&) { return m.peak; };
  row("friction felt at 0.03 m/s [N s/m]", a, true, steady,
      [&](const Measured& m, const Measured&) { return 0.03 * a.friction / m.speed; });
  for (const double mass : {2.0, 5.0, 10.0}) {
    const auto scene = [mass](Rule r, const Timing& t, const Admittance& b) { return lead(r, t, b, mass); };
    char name[80];
    std::snprintf(name, sizeof name, "hand of %.0f kg leads: mean force over the ideal's %.1f N", mass,
                  scene(Rule::ideal, timings[0], a).mean);
    row(name, a, true, scene, [](const Measured& m, const Measured& ideal) { return m.mean / ideal.mean; });
  }
  for (const double mass : {2.0, 5.0, 10.0}) {
    char name[80];
    std::snprintf(name, sizeof name, "two hands of %.0f kg grip with 30 N: ring [N]", mass);
    row(
        name, a, true, [mass](Rule r, const Timing& t, const Admittance& b) { return grip(r, t, b, mass); },
        ring);
  }
  for (const double k : {3e3, 1e4, 3e4, 1e5}) {
    const auto scene = [k](Rule r, const Timing& t, const Admittance& b) { return wall(r, t, b, k); };
    char name[80];
    std::snprintf(name, sizeof name, "led into a wall of %.0f kN/m: peak [N]", 1e-3 * k);
    row(name, a, true, scene, peak);
    if (k < 2e4) row("the same: ring [N]", a, true, scene, ring);
  }
  row("a finger pokes: peak [N]", a, true, poke, peak);
  row("the same: turns above 3 N", a, true, poke, [](const Measured& m, const Measured&) { return m.turns; });
  row("against joint ends: beyond [mrad]", a, false, ends,
      [](const Measured& m, const Measured&) { return 1e3 * std::max(0.0, m.beyond); });
  row("the same: fastest joint [rad/s]", a, false, ends,
      [](const Measured& m, const Measured&) { return m.joint_speed; });
  row("stretched by 25 N: fastest joint [rad/s]", a, false, stretched,
      [](const Measured& m, const Measured&) { return m.joint_speed; });
}

/// The forces of all rules; beyond 60 N they are not drawn.
template <class Run>
plotting::Plot plot(const char* title, Run&& scene) {
  constexpr int colors[] = {0, 1, 2, 5, 3, 4};
  plotting::Plot p;
  p.title = title, p.y_name = "force [N]", p.height = 220;
  for (const Rule rule : all_rules) {
    if (rule == Rule::skinctl_agile) continue;
    Measured m = scene(rule);
    for (double& f : m.forces)
      if (std::abs(f) > 60) f = std::nan("");
    p.series.push_back({.name = names[int(rule)],
                        .x = m.times,
                        .y = m.forces,
                        .color = colors[int(rule)],
                        .dashed = rule == Rule::ideal});
  }
  return p;
}
bool draw(const std::string& path, const Admittance& a) {
  return plotting::write_svg(
      path,
      plotting::svg_figure(
          "The same mass and friction by each rule: 125 Hz, servo lag 8 ms; up to 60 N",
          {plot("A hand of 2 kg leads the flange by 0.1 m, twice",
                [&](Rule r) { return lead(r, timings[0], a, 2); }),
           plot("A finger pokes it by 30 mm", [&](Rule r) { return poke(r, timings[0], a); }),
           plot("20 N lead it into a wall of 3 kN/m", [&](Rule r) { return wall(r, timings[0], a, 3e3); })}));
}

}  // namespace

int main(int argc, char** argv) {
  const double off = from_originals();
  std::printf("Rules of peers differ from their originals by %.1e rad\n", off);
  if (!(off < 1e-6)) return 1;
  if (argc > 1 && std::string_view(argv[1]) == "--check") return 0;
  const Admittance light{5, 50}, heavy{12, 30};
  table("Light", light);
  table("Heavy", heavy);
  return argc > 1 && !draw(argv[1], light);
}
