// The first picture of README.md: `playground_picture FILE` writes a moving SVG of the arm that gives way
// beside the same arm that does not, under the same finger. What moves is computed by the playground's core.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "examples/playground/playground.hpp"
#include "examples/support/svg_plot.hpp"
#include "examples/support/text.hpp"
#include "examples/support/ur5_shape.hpp"
#include "skinctl/core/contract.hpp"

namespace {

using skinctl::Xyz;
using skinctl::ur5::tubes;

constexpr double panel = 400, foot = 300, plot_top = 352, plot_height = 110, scale = 270,
                 most_force = 200;                               // [px], [px/m], [N]
constexpr double frame_time = 0.1, before = 0.5, pressed = 1.6;  // [s]

struct Point {
  double x = 0, y = 0;
};
/// An instant of both arms: the ends of each covered tube, and the line through all joints.
struct Frame {
  double time = 0, force[2] = {};
  std::vector<std::array<Point, 2>> skin[2];
  std::vector<Point> bones[2];
  Point tip, from;  ///< of the finger
};

/// The plane of the task's pose, which turns with its first joint.
struct Plane {
  Xyz<double> reach, up{0, 0, 1};
  Point operator()(const Xyz<double>& p) const {
    return {0.4 * panel - scale * dot(p, reach), foot - scale * dot(p, up)};
  }
};
examples::LinkPose pose_of(const double (&x)[12]) {
  const skinctl::Rotation<double> axes{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}};
  return {axes, Xyz<double>{x[9], x[10], x[11]}};
}
examples::LinkPoses poses_of(const double (&links)[6][12]) {
  return {pose_of(links[0]), pose_of(links[1]), pose_of(links[2]),
          pose_of(links[3]), pose_of(links[4]), pose_of(links[5])};
}

Frame frame_of(const playground::View& v, const Plane& plane) {
  Frame f;
  f.time = v.time;
  for (std::size_t arm = 0; arm < 2; ++arm)
    for (const auto& c : examples::ur5_capsules(poses_of(arm == 0 ? v.rigid_links : v.links))) {
      if (c.covered) f.skin[arm].push_back({plane(c.from), plane(c.to)});
      if (!c.covered) f.bones[arm].push_back(plane(c.from));
    }
  const Xyz<double> tip{v.tip[0], v.tip[1], v.tip[2]}, way{v.direction[0], v.direction[1], v.direction[2]};
  f.tip = plane(tip), f.from = plane(tip + 0.16 * way);
  return f;
}

/// Two rounds of the task: the arm is pressed once at each place, on its forearm and on its upper arm.
std::vector<Frame> run(playground::Arms& arms) {
  Plane plane;
  std::vector<Frame> out;
  playground::View v;
  bool rested = true;
  double rest_at = -1, force[2] = {};  // the largest since the last frame: no peak is left out
  for (int touches = -1; touches < 2;) {
    arms.cycle(v);
    if (v.ended > 0 || v.time > 120) throw skinctl::ConfigurationError("the arm does not go on");
    const bool rests = v.resting > 0, fine = v.away < 0.02;
    if (rests && !rested && fine) rest_at = v.time, ++touches;
    rested = rests;
    if (touches < 0) continue;
    if (touches == 2) break;
    plane.reach = {std::cos(v.target[0]), std::sin(v.target[0]), 0};
    const double since = v.time - rest_at;
    if (since >= before && since < before + v.period) {
      const std::size_t link = touches == 0 ? 2 : 1;
      // The cell that is farthest out and faces up and away from the base.
      const Xyz<double> out_there = std::sqrt(0.5) * (plane.up - plane.reach);
      std::size_t best = 0;
      double farthest = -10;
      for (std::size_t i = 0; i < static_cast<std::size_t>(v.cells); ++i) {
        const auto c = arms.cell(i);
        if (static_cast<std::size_t>(c[0]) != link) continue;
        const auto X = pose_of(v.links[link]);
        const Xyz<double> place = examples::in_base(X, {c[1], c[2], c[3]}),
                          normal = X.axes() * Xyz<double>{c[4], c[5], c[6]};
        const double worth = dot(place, out_there) + 0.5 * dot(normal, out_there);  // half a metre a turn
        if (worth > farthest) farthest = worth, best = i;
      }
      const auto c = arms.cell(best);
      arms.press(link, &c[1], &c[4]);
    }
    if (since >= before + pressed && since < before + pressed + v.period) arms.release();
    force[0] = std::max(force[0], v.rigid_force), force[1] = std::max(force[1], v.force);
    if (!out.empty() && v.time - out.back().time < frame_time - 0.5 * v.period) continue;
    out.push_back(frame_of(v, plane));
    std::copy_n(force, 2, out.back().force), std::fill_n(force, 2, 0.0);
  }
  return out;
}

std::string number(double x) {
  return examples::text("%.4g", std::round(x * 10) / 10);
}
std::string points(const Point* p, std::size_t n) {
  std::string out;
  for (std::size_t i = 0; i < n; ++i) out += (i > 0 ? " " : "") + number(p[i].x) + ',' + number(p[i].y);
  return out;
}
/// `attribute` takes `value(frame)` one after the other, for ever.
template <class Value>
std::string moving(const std::vector<Frame>& all, const char* attribute, const Value& value) {
  std::string out = std::string("<animate attributeName=\"") + attribute + "\" dur=\"" +
                    number(all.back().time - all.front().time) + "s\" repeatCount=\"indefinite\" values=\"";
  for (std::size_t k = 0; k < all.size(); ++k) out += (k > 0 ? ";" : "") + value(all[k]);
  return out + "\"/>";
}
std::string line(const std::vector<Frame>& all, const char* kind, double width, const auto& value) {
  return std::string("<polyline class=\"") + kind + "\" stroke-width=\"" + number(width) + "\" points=\"" +
         value(all.front()) + "\">" + moving(all, "points", value) + "</polyline>";
}

std::string arm_svg(const std::vector<Frame>& all, std::size_t arm) {
  std::string out = "<g transform=\"translate(" + number(static_cast<double>(arm) * (panel + 80)) + " 0)\">";
  out += "<text class=\"head\" x=\"0\" y=\"18\">" +
         std::string(arm == 0 ? "A stiff arm" : "The same arm with skinctl") + "</text>";
  out += "<path class=\"ground\" d=\"M" + number(0.4 * panel - 60) + ' ' + number(foot) + "h120\"/>";
  out += line(all, "body", 2 * scale * 0.034,
              [&](const Frame& f) { return points(f.bones[arm].data(), f.bones[arm].size()); });
  for (std::size_t i = 0; i < 6; ++i)
    out += line(all, "skin", 2 * scale * tubes[i].radius,
                [&](const Frame& f) { return points(f.skin[arm][i].data(), 2); });
  out += line(all, "finger", 13, [](const Frame& f) {
    const Point p[2] = {f.from, f.tip};
    return points(p, 2);
  });
  // The gauge, whose scale is the plot's.
  const auto level = [&](const Frame& f) { return number(170 * std::min(1.0, f.force[arm] / most_force)); };
  const auto top = [&](const Frame& f) {
    return number(230 - 170 * std::min(1.0, f.force[arm] / most_force));
  };
  out += "<rect class=\"gauge\" x=\"14\" y=\"60\" width=\"16\" height=\"170\"/><rect class=\"f" +
         std::to_string(arm) + "\" x=\"14\" y=\"230\" width=\"16\" height=\"0\">" + moving(all, "y", top) +
         moving(all, "height", level) + "</rect>";
  for (int n = 0; n <= 200; n += 50)
    out += "<text x=\"36\" y=\"" + number(234 - 170.0 * n / most_force) + "\">" + std::to_string(n) +
           (n == 200 ? " N" : "") + "</text>";
  return out + "</g>";
}

double most(const std::vector<Frame>& all, std::size_t arm) {
  double out = 0;
  for (const Frame& f : all) out = std::max(out, f.force[arm]);
  return out;
}

/// Both forces over the time of the whole loop, on one scale, with the instant that is shown above.
std::string plot_svg(const std::vector<Frame>& all) {
  constexpr double left = 46, right = 2 * panel + 60;
  const double begin = all.front().time, end = all.back().time;
  const auto x = [&](double t) { return left + (right - left) * (t - begin) / (end - begin); };
  const auto y = [](double n) { return plot_top + plot_height * (1 - std::min(n, most_force) / most_force); };
  std::string out;
  for (int n = 0; n <= 200; n += 100)
    out += "<path class=\"grid\" d=\"M" + number(left) + ' ' + number(y(n)) + "H" + number(right) +
           "\"/><text x=\"" + number(left - 6) + "\" y=\"" + number(y(n) + 4) + "\" text-anchor=\"end\">" +
           std::to_string(n) + (n == 200 ? " N" : "") + "</text>";
  for (int t = 0; begin + t <= end; t += 2)
    out += "<text x=\"" + number(x(begin + t)) + "\" y=\"" + number(plot_top + plot_height + 17) +
           "\" text-anchor=\"middle\">" + std::to_string(t) + (t == 0 ? " s" : "") + "</text>";
  for (std::size_t arm = 0; arm < 2; ++arm) {
    std::vector<Point> curve;
    for (const Frame& f : all) curve.push_back({x(f.time), y(f.force[arm])});
    out += "<polyline class=\"c" + std::to_string(arm) + "\" points=\"" + points(curve.data(), curve.size()) +
           "\"/>";
  }
  out += "<line class=\"now\" y1=\"" + number(plot_top) + "\" y2=\"" + number(plot_top + plot_height) + "\">";
  for (const char* end_of : {"x1", "x2"}) {
    out += std::string("<animate attributeName=\"") + end_of + "\" dur=\"" + number(end - begin) +
           "s\" repeatCount=\"indefinite\" values=\"" + number(left) + ';' + number(right) + "\"/>";
  }
  return out + "</line>";
}

std::string picture(const std::vector<Frame>& all) {
  const std::string said = "The same finger on two arms by position: the stiff one pushes back with " +
                           plotting::decimal(most(all, 0), 0) + " N, the other with " +
                           plotting::decimal(most(all, 1), 0) + " N";
  constexpr const char* style =
      "text{font:13px system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;fill:#57606a}"
      ".head{font-size:16px;font-weight:600;fill:#1f2328}"
      "polyline{fill:none;stroke-linejoin:round;stroke-linecap:round}"
      ".body{stroke:#8b949e}.skin{stroke:#c4d3e6}.finger{stroke:#e3a008}"
      ".ground{stroke:#57606a;stroke-width:3}.grid{stroke:#e4e8ec}.gauge{fill:#e4e8ec}"
      ".f0{fill:#d1580a}.f1{fill:#1662d2}.c0{stroke:#d1580a;stroke-width:2}.c1{stroke:#1662d2;stroke-width:2}"
      ".now{stroke:#57606a}"
      "@media(prefers-color-scheme:dark){text{fill:#9da7b3}.head{fill:#e6edf3}.body{stroke:#57606a}"
      ".skin{stroke:#33465e}.grid{stroke:#262d36}.gauge{fill:#262d36}.f1{fill:#58a6ff}.c1{stroke:#58a6ff}"
      ".f0{fill:#f0883e}.c0{stroke:#f0883e}.ground,.now{stroke:#9da7b3}}";
  const std::string width = number(2 * panel + 80), height = number(plot_top + plot_height + 50);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "\" height=\"" + height +
         "\" viewBox=\"0 0 " + width + ' ' + height + "\" role=\"img\" aria-label=\"" + said + "\"><style>" +
         style + "</style>" + arm_svg(all, 0) + arm_svg(all, 1) + plot_svg(all) + "<text x=\"0\" y=\"" +
         number(plot_top + plot_height + 42) + "\">" + said + ".</text></svg>\n";
}

int draw(const char* file) {
  const auto scenario = playground::read_scenarios(WITH_SKIN, WITHOUT_SKIN);
  const auto arms = playground::make_arms(scenario, {}, scenario.places.back());
  return plotting::write_svg(file, picture(run(*arms))) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    std::printf("usage: playground_picture FILE.svg\n");
    return argc == 2 && std::string(argv[1]) == "--help" ? 0 : 2;
  }
  try {
    return draw(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "playground_picture: %s\n", e.what());
    return 2;
  }
}
