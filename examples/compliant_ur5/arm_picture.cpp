#include "examples/compliant_ur5/arm_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "examples/support/svg_plot.hpp"
#include "examples/support/ur5_shape.hpp"

namespace compliant_ur5 {
namespace {

using skinctl::Xyz;
using Poses = examples::LinkPoses;
using examples::Capsule, examples::in_base, examples::on_axis;

constexpr double width = 360, margin = 34, font = 13, mark_radius = 11;
constexpr double thinner = 0.85;  // a link than its skin
constexpr std::size_t max_places = 24;

struct Point {
  double x = 0, y = 0;
};
double distance(Point a, Point b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}
double distance(Point p, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double s = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return distance(p, {a.x + s * dx, a.y + s * dy});
}

/// A cell that was touched, with the numbers of its touches.
struct Place {
  Xyz<double> at{}, normal{};
  std::uint32_t cell = 0;
  std::string numbers;
  int count = 0;
};

/// A place of the skin, and the grade of what it feels: the better, the smaller.
struct Dot {
  Xyz<double> at{}, normal{};
  int grade = 0;
};

/// What is drawn, seen along one direction: `right` and `up` of the picture, `viewer` out of it.
struct View {
  const char* name;
  Xyz<double> right{}, up{}, viewer{};
};

Poses poses_at(const std::array<float, 6>& q) {
  return examples::ur5_poses(
      skinctl::JointPosition<6>::generate([&](std::size_t i) { return static_cast<double>(q[i]); }));
}
double length(const Xyz<double>& v) {
  return std::sqrt(dot(v, v));
}

std::vector<Place> places(const RunLog& log, const Poses& X) {
  std::vector<Place> out;
  for (std::size_t i = 0; i < log.touches.size(); ++i) {
    const TouchSummary& t = log.touches[i];
    if (t.link < 0 || t.link >= 6 || !std::isfinite(t.place[0] + t.place[1] + t.place[2])) continue;
    auto same = std::find_if(out.begin(), out.end(), [&](const Place& p) { return p.cell == t.cell; });
    if (same == out.end()) {
      if (out.size() == max_places) continue;
      const auto link = static_cast<std::size_t>(t.link);
      const Xyz<double> p{t.place[0], t.place[1], t.place[2]};
      out.push_back(
          {in_base(X[link], p), X[link].axes() * (p - on_axis(skinctl::ur5::tubes[link], p)), t.cell, "", 0});
      same = out.end() - 1;
    }
    ++same->count;
    if (same->count <= 3) same->numbers += (same->count > 1 ? ", " : "") + std::to_string(i + 1);
    if (same->count == 4) same->numbers += ", \u2026";
  }
  return out;
}

std::string number(double v) {
  std::string text = plotting::decimal(v, 1);
  if (text.rfind("\u2212", 0) == 0) text.replace(0, 3, "-");
  return text;
}

class Drawing {
 public:
  Drawing(const View& view, std::vector<Capsule> links, const std::vector<Place>& touched)
      : view_(view), links_(std::move(links)), touched_(touched) {
    double left = 1e9, right = -1e9, low = 0, high = 0;
    for (const Capsule& c : links_)
      for (const Xyz<double>& p : {c.from, c.to}) {
        left = std::min(left, dot(p, view_.right) - c.radius);
        right = std::max(right, dot(p, view_.right) + c.radius);
        low = std::min(low, dot(p, view_.up) - c.radius);
        high = std::max(high, dot(p, view_.up) + c.radius);
      }
    // Tall poses get no taller a picture than wide ones.
    scale_ = std::min((width - 2 * margin) / (right - left), (width - 2 * margin) / (high - low));
    left_ = 0.5 * (left + right) - 0.5 * width / scale_;
    high_ = high;
    height_ = 2 * margin + scale_ * (high - low);
    // The skin of a link hides the link, whose middle is almost as near.
    const auto nearness = [&](const Capsule& c) {
      return 0.5 * dot(c.from + c.to, view_.viewer) + (c.covered ? 0.02 : 0);
    };
    std::stable_sort(links_.begin(), links_.end(),
                     [&](const Capsule& a, const Capsule& b) { return nearness(a) < nearness(b); });
  }

  std::string svg(const std::vector<Dot>& dots = {}) const {
    std::string out = "<svg class=\"sp arm\" viewBox=\"0 0 " + number(width) + ' ' + number(height_ + 30) +
                      "\" role=\"img\" aria-label=\"The arm, " + view_.name + "\">";
    out += "<text class=\"name\" x=\"0\" y=\"13\">" + std::string(view_.name) + "</text>";
    if (view_.up.z > 0.5) {  // what the arm stands on
      const Point foot = seen({0, 0, -thinner * skinctl::ur5::tubes[0].radius});
      out += "<path class=\"ground\" d=\"M" + number(foot.x - 60) + ' ' + number(foot.y) + "h120\"/>";
    }
    for (const Capsule& c : links_) out += capsule(c);
    for (const Dot& d : dots) {
      if (dot(d.normal, view_.viewer) < 0) continue;  // on the far side
      const Point p = seen(d.at);
      out += "<circle class=\"felt-" + std::to_string(d.grade) + "\" cx=\"" + number(p.x) + "\" cy=\"" +
             number(p.y) + "\" r=\"3.2\"/>";
    }
    std::vector<Label> labels;
    for (const Place& place : touched_) labels.push_back(label(place, labels));
    for (std::size_t i = 0; i < labels.size(); ++i) out += leader(touched_[i], labels[i]);
    for (std::size_t i = 0; i < labels.size(); ++i) out += mark(touched_[i], labels[i]);
    return out + ruler() + "</svg>";
  }

 private:
  struct Label {
    Point at;
    double half = mark_radius;  ///< of its width
  };

  Point seen(const Xyz<double>& p) const {
    return {scale_ * (dot(p, view_.right) - left_), margin + scale_ * (high_ - dot(p, view_.up))};
  }
  bool behind(const Place& place) const {
    return dot(place.normal, view_.viewer) < -0.2 * length(place.normal);
  }

  std::string capsule(const Capsule& c) const {
    const Point a = seen(c.from), b = seen(c.to);
    const std::string d = "d=\"M" + number(a.x) + ' ' + number(a.y) + 'L' + number(b.x + 0.01) + ' ' +
                          number(b.y) + "\" stroke-width=\"";
    const double thick = 2 * scale_ * c.radius;
    return "<path class=\"edge\" " + d + number(thick) + "\"/><path class=\"" +
           (c.covered ? "skin" : "body") + "\" " + d + number(thick - 2.4) + "\"/>";
  }

  /// A free spot near the place, rather beside the arm than on it.
  Label label(const Place& place, const std::vector<Label>& taken) const {
    Label best;
    best.half = std::max(mark_radius, 4 + 0.5 * 7.5 * static_cast<double>(place.numbers.size()));
    const Point p = seen(place.at);
    double least = 1e18;
    for (int ring = 1; ring <= 9; ++ring)
      for (int k = 0; k < 24; ++k) {
        const double angle = 2 * 3.14159265358979 * k / 24, r = 12.0 * ring + 6;
        const Point at{p.x + (r + best.half - mark_radius) * std::cos(angle), p.y + r * std::sin(angle)};
        double cost = r;
        if (at.x < best.half + 2 || at.x > width - best.half - 2 || at.y < font + mark_radius + 6 ||
            at.y > height_ - mark_radius)
          cost += 1e6;
        for (const Label& other : taken)
          if (std::abs(at.x - other.at.x) < best.half + other.half + 3 &&
              std::abs(at.y - other.at.y) < 2 * mark_radius + 3)
            cost += 1e4;
        for (const Place& other : touched_)
          if (distance(seen(other.at), at) < best.half + 5) cost += 300;
        for (const Label& other : taken)
          if (distance(other.at, p, at) < other.half) cost += 300;
        for (const Capsule& c : links_)
          if (distance(at, seen(c.from), seen(c.to)) < scale_ * c.radius + mark_radius) cost += 25;
        if (cost < least) least = cost, best.at = at;
      }
    return best;
  }

  std::string leader(const Place& place, const Label& to) const {
    const Point p = seen(place.at);
    return std::string("<path class=\"") + (behind(place) ? "leader behind" : "leader") + "\" d=\"M" +
           number(p.x) + ' ' + number(p.y) + 'L' + number(to.at.x) + ' ' + number(to.at.y) + "\"/>";
  }
  std::string mark(const Place& place, const Label& l) const {
    const Point p = seen(place.at);
    return std::string("<circle class=\"") + (behind(place) ? "spot behind" : "spot") + "\" cx=\"" +
           number(p.x) + "\" cy=\"" + number(p.y) + "\" r=\"4\"/><rect class=\"flag\" x=\"" +
           number(l.at.x - l.half) + "\" y=\"" + number(l.at.y - mark_radius) + "\" width=\"" +
           number(2 * l.half) + "\" height=\"" + number(2 * mark_radius) + "\" rx=\"" + number(mark_radius) +
           "\"/><text class=\"touch\" x=\"" + number(l.at.x) + "\" y=\"" + number(l.at.y + 4.5) +
           "\" text-anchor=\"middle\">" + place.numbers + "</text>";
  }
  std::string ruler() const {
    const double long_ = 0.2 * scale_, y = height_ + 12;
    return "<path class=\"ruler\" d=\"M1 " + number(y - 4) + "v8M1 " + number(y) + 'h' + number(long_) + 'm' +
           "0 -4v8\"/><text x=\"" + number(long_ + 8) + "\" y=\"" + number(y + 4.5) + "\">0.2 m</text>";
  }

  View view_;
  std::vector<Capsule> links_;
  const std::vector<Place>& touched_;
  double scale_ = 1, left_ = 0, high_ = 0, height_ = width;
};

/// Both views of the arm in the first pose of the log; `draw(drawing, poses)` gives the SVG of one.
template <class Draw>
std::string views(const RunLog& log, const Draw& draw) {
  const auto first = std::find_if(log.entries.begin(), log.entries.end(), [](const LogEntry& e) {
    return std::all_of(e.q.begin(), e.q.end(), [](float q) { return std::isfinite(q); });
  });
  if (first == log.entries.end()) return {};
  const Poses X = poses_at(first->q);
  // The arm's plane turns with joint 0; at 0 it reaches along -x.
  const double c = std::cos(static_cast<double>(first->q[0])), s = std::sin(static_cast<double>(first->q[0]));
  const Xyz<double> reach{-c, -s, 0}, side{-s, c, 0}, up{0, 0, 1};
  std::string out;
  for (const View& view : {View{"from the side", reach, up, side}, View{"from above", reach, {s, -c, 0}, up}})
    out += draw(view, X);
  return out;
}

}  // namespace

std::string arm_picture(const RunLog& log) {
  return views(log, [&](const View& view, const Poses& X) {
    const auto touched = places(log, X);
    return Drawing(view, examples::ur5_capsules(X), touched).svg();
  });
}
std::string felt_picture(const RunLog& log) {
  if (log.felt.empty()) return {};
  return views(log, [&](const View& view, const Poses& X) {
    const std::vector<Place> none;
    std::vector<Dot> dots;
    for (const FeltPlace& f : log.felt) {
      if (f.link >= 6) continue;
      const auto& [x, y, z] = f.place;
      const auto& [u, v, w] = f.normal;
      const int grade = f.noticed <= 5 ? 0 : f.noticed <= 25 ? 1 : std::isfinite(f.noticed) ? 2 : 3;
      dots.push_back({in_base(X[f.link], {x, y, z}), X[f.link].axes() * Xyz<double>{u, v, w}, grade});
    }
    return Drawing(view, examples::ur5_capsules(X), none).svg(dots);
  });
}

}  // namespace compliant_ur5
