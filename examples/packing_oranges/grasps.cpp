#include "examples/packing_oranges/grasps.hpp"

#include <algorithm>
#include <cmath>

#include "examples/packing_oranges/tomm.hpp"
#include "examples/support/text.hpp"

namespace packing {
using examples::text;
namespace {
using Point = skinctl::Xyz<double>;
using Pose = skinctl::Transform<skinctl::Base, skinctl::Tool>;
using A = Arm<Ur5>;

constexpr double handed_over = 3, shake_from = 4, shake_to = 8, over_from = 9, over_to = 12, back_from = 13.5,
                 back_to = 16.5, end = 18;
constexpr double cycle = 0.008, rate = 2;  // of the shaking [Hz]
const skinctl::JointPosition<6> stands{0.0, -2.0, 1.6, -1.17, -1.57, 0.0};

/// 0 to 1 with speed and acceleration 0 at the ends.
double quintic(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}
/// What the arm does: the joints at time t.
skinctl::JointPosition<6> arm_at(double t, double shake, double radius) {
  auto q = stands;
  constexpr double pi = 3.14159265358979;
  const double w = 2 * pi * rate;
  const double in = quintic((t - shake_from) / 0.5) - quintic((t - shake_to + 0.5) / 0.5);
  q[0] += in * shake / (w * w * radius) * std::sin(w * (t - shake_from));
  const double over =
      quintic((t - over_from) / (over_to - over_from)) - quintic((t - back_from) / (back_to - back_from));
  q[4] += pi * over;
  return q;
}
double angle_of(const auto& X) {
  const double trace = X.axis_x().x + X.axis_y().y + X.axis_z().z;
  return std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0));
}
}  // namespace

std::vector<GraspTrial> three_grasps() {
  std::vector<GraspTrial> out;
  {
    GraspTrial t;
    t.grasp = around_a_ball();
    t.words = "ball, 76 mm";
    t.thing = {Thing::Shape::ball, {0.038, 0, 0}, 0.18, 6000};
    t.X_HT = Pose({}, t.grasp.centre);
    out.push_back(t);
  }
  {
    GraspTrial t;
    Grasp& g = t.grasp;
    g.name = "all fingers";
    g.takes_part = {0.25, 0.5, 0.25, 1};  // three fingers stand against one thumb
    g.centre = {0.05, 0, 0.02};
    for (std::size_t f = 0; f < 3; ++f) {
      g.away[f] = {std::sin(0.15), 0, std::cos(0.15)};
      g.beside[f] = {0, 0.024 * (1 - static_cast<double>(f)), 0};
    }
    g.away[3] = {std::sin(0.15), 0, -std::cos(0.15)};
    g.posture = {-0.33, 0.2, 1.1, 1.1, 0, 0.15, 1.2, 1.15, 0.33, 0.2, 1.1, 1.1, 1.1, 0.75, 0.94, 1.4};
    g.least = 0.034, g.most = 0.062;
    t.words = "bottle, 56 mm";
    t.thing = {Thing::Shape::cylinder, {0.028, 0, 0.08}, 0.25, 6000};
    t.X_HT = Pose({{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, g.centre);
    t.force = 3;
    out.push_back(t);
  }
  {
    GraspTrial t;
    Grasp& g = t.grasp;
    const Point n{std::sin(0.3), 0, std::cos(0.3)}, along{std::cos(0.3), 0, -std::sin(0.3)};
    g.name = "thumb and index";
    g.takes_part = {1, 0, 0, 1};
    g.centre = {0.04, 0.04, 0.025};
    g.away[0] = n, g.away[3] = -1.0 * n;
    g.posture = {-0.16, 0.1,   1.55,  1.44,  0,    -0.15, -0.12, -0.15,
                 0,     -0.15, -0.12, -0.15, 0.95, 0.15,  1.27,  0.8};
    g.least = 0.0125, g.most = 0.045;
    t.words = "plate, 6 mm";
    t.thing = {Thing::Shape::box, {0.003, 0.03, 0.025}, 0.06, 6000};
    t.X_HT = Pose({n, {0, 1, 0}, -1.0 * along}, g.centre + 0.018 * along);
    out.push_back(t);
  }
  return out;
}

GraspTrial wrapped_bottle() {
  GraspTrial t = three_grasps()[1];
  Grasp& g = t.grasp;
  g = {};
  g.name = "wrapped";
  g.wraps = true;
  g.takes_part = {1, 1, 1, 1};
  g.centre = {0.045, 0, 0.03};
  g.posture = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1.3, 0.4, 0, 0};
  g.curled = {0, 1.5, 1.6, 1.5, 0, 1.5, 1.6, 1.5, 0, 1.5, 1.6, 1.5, 1.3, 0.4, 1.0, 1.5};
  t.X_HT = Pose({{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, g.centre);
  t.force = 1;  // of a phalanx, in the mean
  return t;
}

GraspFigures try_grasp(const GraspTrial& trial, const GraspSettings& s) {
  GraspFigures out;
  out.name = std::string(trial.words) + ", " + trial.grasp.name;
  out.mass = trial.thing.mass;
  std::array<ArmBody, arms> bodies{A::body(0), A::body(1)};
  bodies[0].hand = hand_body(trial.grasp, bodies[0].flange, reach_of_gripper);
  for (std::size_t i = 0; i < 6; ++i) bodies[0].home[i] = stands[i];
  WorldSettings settings;
  settings.thing = trial.thing;
  World world(bodies, settings, s.seed);
  world.step();
  Hand hand(trial.grasp, world.fingers(0));
  const auto open = world.fingers(0).q;
  const Point reach = A::hand(stands).origin();
  const double radius = std::hypot(reach.x, reach.y);
  const auto in_hand = [&] {
    const auto X = world.palm(0).inverse() * world.thing();
    return Pose({X.axis_x(), X.axis_y(), X.axis_z()}, X.origin());
  };
  const auto palm_to_world = [&](const Pose& X) {
    const auto P = world.palm(0);
    const auto turned = [&](const Point& v) {
      return v.x * P.axis_x() + v.y * P.axis_y() + v.z * P.axis_z();
    };
    using Placed = skinctl::Transform<skinctl::World, skinctl::Tool>;
    return Placed({turned(X.axis_x()), turned(X.axis_y()), turned(X.axis_z())},
                  P.origin() + turned(X.origin()));
  };
  world.put_thing(palm_to_world(trial.X_HT));
  Pose before = in_hand();
  Point lies = before.origin();
  Point last{0, 0, 0}, speed{0, 0, 0};
  const bool pulls = norm(s.pull) > 0;
  double sum = 0, count = 0, let_go_at = 0;
  bool let_go = false;
  out.held = true;
  out.least = 1e3;
  for (int tick = 0; tick < static_cast<int>(1000 * s.until); ++tick) {
    const double t = 0.001 * tick;
    if (tick % 8 == 0) {
      const double moves = pulls ? 0 : t;
      const auto to = arm_at(moves + cycle, s.shake, radius),
                 from = arm_at(moves + cycle - 1e-4, s.shake, radius);
      skinctl::JointVelocity<6> v;
      for (std::size_t i = 0; i < 6; ++i) v[i] = (to[i] - from[i]) / 1e-4;
      world.command(0, to, v);
    }
    if (tick % 3 == 0) {
      Hand::Input in;
      in.measured = world.fingers(0);
      in.tips = world.tips(0);
      // As the arm's joints tell how the palm stands, not the world.
      if (s.feels_gravity) in.gravity = gravity_in_hand(A::base(0) * A::hand(world.joints(0).q));
      in.command = {{0, trial.force, 0.04}, t < 0.3 ? 0u : 1u};
      const auto torque = hand.step(in);
      world.command(0, torque);
      for (std::size_t i = 0; i < 16 && let_go; ++i)
        out.most_torque = std::max(out.most_torque, std::abs(torque[i]));
    }
    if (!let_go && ((t > 1 && hand.state().holding) || t >= handed_over)) {
      let_go = true;
      before = in_hand();
      world.let_go_of_thing();
      out.fingers = skeleton(world.fingers(0).q);
      let_go_at = t;
      const auto& p = world.phalanges(0);
      out.all = p.palm;
      for (const double f : p.links) out.touch += f > 0.05, out.all += f;
    }
    if (pulls && let_go) {
      const double force = 5 * (t - let_go_at - 0.5);
      const bool out_of_it = force > 0 && norm(Point(in_hand().origin() - lies)) > 0.015;
      if (out_of_it || force > 80) {
        out.pulled = std::min(force, 80.0);
        return out;
      }
      const auto P = world.palm(0);
      world.pull_thing(std::max(0.0, force) *
                       (s.pull.x * P.axis_x() + s.pull.y * P.axis_y() + s.pull.z * P.axis_z()));
    }
    world.step();
    const auto X = in_hand();
    const double moved = norm(Point(X.origin() - before.origin()));
    if (tick % 10 == 0) out.path.push_back({t, world.tips(0), let_go ? 1e3 * moved : 0});
    const Point p = world.palm(0).origin(), v = 1000.0 * Point(p - last);
    if (t > shake_from && t < shake_to)
      out.shaken = std::max(out.shaken, norm(Point(1000.0 * Point(v - speed))));
    last = p, speed = v;
    if (!let_go) continue;
    int touch = 0;
    for (std::size_t f = 0; f < 4; ++f) {
      if (!(trial.grasp.takes_part[f] > 0)) {
        for (std::size_t i = 4 * f; i < 4 * f + 4; ++i)
          out.bent = std::max(out.bent, std::abs(world.fingers(0).q[i] - open[i]));
        continue;
      }
      const double F = world.true_tips(0)[f];
      touch += F > 0;
      out.least = std::min(out.least, F), out.most = std::max(out.most, F);
      sum += F, count += 1;
    }
    if (trial.grasp.wraps) {
      touch = 0;
      for (const double f : world.phalanges(0).links) touch += f > 0;
    }
    out.held = out.held && touch >= 2;
    if (t < let_go_at + 0.5) lies = X.origin();
    out.shaken_off = std::max(out.shaken_off, norm(Point(X.origin() - lies)));
    out.gave_way = std::max(out.gave_way, moved);
    out.slipped = moved;
    out.turned = angle_of(before.inverse() * X);
  }
  out.mean = sum / count;
  return out;
}

std::string compare_wrapped(std::uint64_t seed) {
  std::string out =
      "bottle                        touch    all forces   moved   turned   torque   pulled out along it, to "
      "the tips, "
      "from the palm\n";
  const GraspTrial trials[] = {three_grasps()[1], wrapped_bottle()};
  for (const GraspTrial& trial : trials) {
    const GraspFigures shaken = try_grasp(trial, {.seed = seed});
    double pulled[3];
    const Point ways[] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    for (std::size_t k = 0; k < 3; ++k)
      pulled[k] = try_grasp(trial, {.until = 30, .pull = ways[k], .seed = seed}).pulled;
    out += text("%-28s %6d %9.1f N %6.1f mm %6.1f deg %6.2f N m %12.1f %8.1f %8.1f N%s\n", trial.grasp.name,
                shaken.touch, shaken.all, 1e3 * shaken.shaken_off, 57.2957795 * shaken.turned,
                shaken.most_torque, pulled[0], pulled[1], pulled[2], shaken.held ? "" : ", LOST");
  }
  return out;
}

std::string summary(const std::vector<GraspFigures>& figures) {
  std::string out;
  for (const GraspFigures& f : figures)
    out += text(
        "%-30s %.2f kg: %s; fingertips %.2f to %.2f N, mean %.2f; gave way %.1f mm, in the end %.1f mm and "
        "%.1f "
        "degrees off; shaken by %.1f m/s^2%s\n",
        f.name.c_str(), f.mass, f.held ? "held" : "LOST", f.least, f.most, f.mean, 1e3 * f.gave_way,
        1e3 * f.slipped, 57.2957795 * f.turned, f.shaken,
        f.bent > 0 ? text("; idle fingers bent by %.3f rad", f.bent).c_str() : "");
  return out;
}

namespace {
constexpr double column = 330, view = 300, plot = 190, scale = 1450;
constexpr const char* colours[] = {"#2b7bba", "#3f9f6f", "#8e5bb5", "#c2571a"};

std::string side_view(const GraspTrial& t, const GraspFigures& f) {
  // The hand's z to the right, its x down.
  const auto X = [](double z) { return 165 + scale * (z - 0.02); };
  const auto Y = [](double x) { return 95 + scale * x; };
  std::string out = text("<rect x='%.1f' y='%.1f' width='%.1f' height='%.1f' class='palm'/>", X(-0.095),
                         Y(-0.024), scale * 0.095, scale * 0.024);
  const Point p = t.X_HT.origin();
  const auto& h = t.thing.half;
  if (t.thing.shape == Thing::Shape::box) {
    const Point n = t.X_HT.axis_x(), a = t.X_HT.axis_z();
    out += "<polygon class='thing' points='";
    constexpr int sign[4][2] = {{1, 1}, {1, -1}, {-1, -1}, {-1, 1}};
    for (const auto& c : sign) {
      const Point q = p + (c[0] * h.x) * n + (c[1] * h.z) * a;
      out += text("%.1f,%.1f ", X(q.z), Y(q.x));
    }
    out += "'/>";
  } else {
    out += text("<circle class='thing' cx='%.1f' cy='%.1f' r='%.1f'/>", X(p.z), Y(p.x), scale * h.x);
  }
  for (const std::size_t finger : {std::size_t(2), std::size_t(1), std::size_t(0), std::size_t(3)}) {
    const bool part = t.grasp.takes_part[finger] > 0;
    const double faint = part ? 0.85 : 0.25;
    out += text(
        "<polyline fill='none' stroke='%s' stroke-opacity='%.2f' stroke-width='9' stroke-linejoin='round' "
        "stroke-linecap='round' points='",
        colours[finger], faint);
    for (const Point& q : f.fingers[finger]) out += text("%.1f,%.1f ", X(q.z), Y(q.x));
    const Point& tip = f.fingers[finger][4];
    out += text("'/><circle cx='%.1f' cy='%.1f' r='%.1f' fill='%s' fill-opacity='%.2f'/>", X(tip.z), Y(tip.x),
                scale * tip_radius, colours[finger], 0.6 * faint);
  }
  return out;
}
std::string time_plot(const GraspTrial& t, const GraspFigures& f) {
  const auto X = [](double s) { return 34 + (column - 50) * s / end; };
  const auto Y = [](double v) { return view + plot - 26 - (plot - 50) * v / 6; };
  std::string out;
  const auto band = [&](double from, double to, const char* name) {
    out += text(
        "<rect class='band' x='%.1f' y='%.1f' width='%.1f' height='%.1f'/><text x='%.1f' y='%.1f'>%s</text>",
        X(from), Y(6), X(to) - X(from), Y(0) - Y(6), X(from) + 2, Y(6) - 4, name);
  };
  band(shake_from, shake_to, "shaken"), band(over_from, over_to, "over"), band(back_from, back_to, "back");
  out += text("<path class='axis' d='M%.1f %.1fV%.1fH%.1f'/>", X(0), Y(6), Y(0), X(end));
  for (int v = 0; v <= 6; v += 2) out += text("<text x='%.1f' y='%.1f'>%d</text>", X(0) - 14, Y(v) + 4, v);
  for (int s = 0; s <= 18; s += 6) out += text("<text x='%.1f' y='%.1f'>%d</text>", X(s) - 4, Y(0) + 16, s);
  const auto curve = [&](const char* colour, const char* more, auto&& of) {
    out += text("<polyline fill='none' stroke='%s' stroke-width='1.2' %s points='", colour, more);
    for (std::size_t k = 0; k < f.path.size(); k += 6)
      out += text("%.1f,%.1f ", X(f.path[k].t), Y(std::min(6.0, of(f.path[k]))));
    out += "'/>";
  };
  for (std::size_t finger = 0; finger < 4; ++finger)
    if (t.grasp.takes_part[finger] > 0)
      curve(colours[finger], "", [&](const auto& p) { return p.tips[finger]; });
  curve("#888", "stroke-dasharray='5 3'", [](const auto& p) { return p.moved; });
  return out;
}
}  // namespace

std::string picture(const std::vector<GraspTrial>& trials, const std::vector<GraspFigures>& figures) {
  std::string out = text(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %.0f %.0f' font-family='system-ui,sans-serif' "
      "font-size='12'><style>text{fill:#333}.palm{fill:#bbb}.thing{fill:#e8912d;fill-opacity:.35;stroke:#"
      "e8912d}"
      ".band{fill:#888;fill-opacity:.12}.axis{fill:none;stroke:#888}"
      "@media(prefers-color-scheme:dark){text{fill:#ddd}}</style>",
      column * static_cast<double>(trials.size()), view + plot + 22);
  for (std::size_t k = 0; k < trials.size(); ++k)
    out += text("<g transform='translate(%.0f 0)'><text x='12' y='20' font-size='14'>%s</text>",
                column * static_cast<double>(k), figures[k].name.c_str()) +
           side_view(trials[k], figures[k]) + time_plot(trials[k], figures[k]) + "</g>";
  constexpr const char* names[] = {"index", "middle", "ring", "thumb"};
  double x = 12;
  for (std::size_t f = 0; f < 4; ++f, x += 70)
    out +=
        text("<text x='%.0f' y='%.0f' style='fill:%s'>%s</text>", x, view + plot + 12, colours[f], names[f]);
  return out +
         text(
             "<text x='%.0f' y='%.0f'>force of each fingertip [N]; dashed: how far the object moved in the "
             "hand [mm]; over the time [s]</text></svg>\n",
             x, view + plot + 12);
}

}  // namespace packing
