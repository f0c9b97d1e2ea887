#include "examples/simulated_ur5/contact.hpp"

#include <algorithm>

#include "skinctl/core/contract.hpp"

namespace simulated_ur5 {
namespace {

constexpr std::size_t most_touches = 10000;
constexpr double profile_lead = 0.5;  ///< approach before a recorded press [s]

}  // namespace

double ForceProfile::at(double t) const {
  if (time.empty() || t < time.front() || t > time.back()) return 0;
  const auto next = std::upper_bound(time.begin(), time.end(), t);
  const auto i = static_cast<std::size_t>(next - time.begin());
  if (i >= time.size()) return force.back();
  const double part = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return force[i - 1] + part * (force[i] - force[i - 1]);
}

double Touch::duration() const {
  if (!profile.time.empty()) return profile_lead + profile.duration() + gap / release_speed;
  return (gap + travel) / approach_speed + hold + (gap + travel) / release_speed;
}

void check(const Touch& t) {
  using skinctl::require;
  const auto in = [&](const char* what, double value, double low, double high, const char* range) {
    require(value >= low && value <= high, (t.name + ": " + what).c_str(), value, range);
  };
  in("start", t.start, 0, 1e6, "0 to 1e6 s");
  in("stiffness", t.stiffness, 1, 1e6, "1 to 1e6 N/m");
  in("damping", t.damping, 0, 1e4, "0 to 1e4 N s/m");
  in("tremor", t.tremor, 0, 0.5, "0 to 0.5");
  in("gap", t.gap, 0, 1, "0 to 1 m");
  in("approach_speed", t.approach_speed, 1e-4, 5, "1e-4 to 5 m/s");
  in("travel", t.travel, 0, 0.5, "0 to 0.5 m");
  in("hold", t.hold, 0, 1e5, "0 to 1e5 s");
  in("release_speed", t.release_speed, 1e-4, 5, "1e-4 to 5 m/s");
  in("patch_radius", t.patch_radius, 1e-3, 0.2, "1e-3 to 0.2 m");
  in("reach", t.reach, 1e-3, 1, "1e-3 to 1 m");
  in("profile_scale", t.profile_scale, 0, 1e6, "0 to 1e6");
  in("link", static_cast<double>(t.link), 0, 5, "0 to 5");
  in("length of normal", norm(t.normal), 0.5, 2, "0.5 to 2");
  in("length of point", norm(t.point), 0, 10, "0 to 10 m");
}

ContactWorld::ContactWorld(std::vector<Touch> touches, const std::vector<SkinCell>& cells,
                           double proximity_distance)
    : touches_(std::move(touches)), cells_(cells), proximity_distance_(proximity_distance) {
  skinctl::require(touches_.size() <= most_touches, "number of touches", static_cast<double>(touches_.size()),
                   "at most 10000");
  for (Touch& touch : touches_) {
    check(touch);
    std::size_t target = no_cell;
    if (touch.cell) {
      for (std::size_t i = 0; i < cells_.size(); ++i)
        if (cells_[i].id == *touch.cell) target = i;
      if (target == no_cell)
        skinctl::refuse(touch.name + ": there is no cell " + std::to_string(*touch.cell));
      touch.link = cells_[target].link;
      touch.point = cells_[target].position;
      touch.normal = cells_[target].normal;
    }
    touch.normal = normalised(touch.normal);
    target_cell_.push_back(target);
    std::vector<std::size_t> near;
    near.reserve(touch.led ? cells_.size() : 0);
    for (std::size_t i = 0; i < cells_.size(); ++i)
      if (cells_[i].link == touch.link && dot(cells_[i].normal, touch.normal) > 0.3) near.push_back(i);
    near_cells_.push_back(std::move(near));
  }
  stimulus_.force.assign(cells_.size(), 0);
  stimulus_.proximity.assign(cells_.size(), 0);
  weights_.assign(cells_.size(), 0);
  restart();
}

void ContactWorld::restart() {
  fingers_.assign(touches_.size(), Finger{});
  results_.assign(touches_.size(), TouchResult{});
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    results_[i].name = touches_[i].name;
    results_[i].link = touches_[i].link;
    results_[i].cell = touches_[i].cell.value_or(0);
  }
  load_ = {};
  force_ = moment_ = tool_force_ = tool_moment_ = {};
  largest_ = 0;
  active_ = -1;
  quiet_ = true;
  std::fill(stimulus_.force.begin(), stimulus_.force.end(), 0);
  std::fill(stimulus_.proximity.begin(), stimulus_.proximity.end(), 0);
}

Vec3 ContactWorld::target_point(const Touch& touch, const Links& links, Vec3& normal) const {
  const Pose& pose = links.link[touch.link];
  normal = pose.rotate(touch.normal);
  return pose.point(touch.point);
}

void ContactWorld::place(std::size_t i, std::size_t link, Vec3 point, Vec3 normal, std::size_t cell) {
  Touch& touch = touches_[i];
  touch.link = std::min(link, joint_count - 1);
  touch.point = point;
  touch.normal = normalised(normal);
  target_cell_[i] = cell < cells_.size() ? cell : no_cell;
  near_cells_[i].clear();
  for (std::size_t k = 0; k < cells_.size(); ++k)
    if (cells_[k].link == touch.link && dot(cells_[k].normal, touch.normal) > 0.3)
      near_cells_[i].push_back(k);
  for (std::size_t k = 0; k < touches_.size(); ++k)
    if (!touches_[k].led) results_[k].ended = true;
  fingers_[i] = Finger{};
  fingers_[i].led = true;
  fingers_[i].led_way = -touch.gap;
  TouchResult& result = results_[i];
  result.link = touch.link;
  result.cell = 0;
  result.began = result.ended = false;
  result.first_contact = result.last_contact = -1;
  result.peak_force = result.peak_force_time = result.impulse = result.peak_deflection = 0;
}

void ContactWorld::lead(std::size_t i, double way, Vec3 aside) {
  fingers_[i].led_way = way;
  fingers_[i].aside = aside;
}

void ContactWorld::lift(std::size_t i) {
  fingers_[i].led = false;
}

void ContactWorld::set_stiffness(std::size_t i, double stiffness) {
  touches_[i].stiffness = std::clamp(stiffness, 1.0, 1e6);
}

ContactWorld::Surface ContactWorld::surface_at(const Touch& touch, const Links& links, Vec3 tip,
                                               Vec3 outward) const {
  const Pose& pose = links.link[touch.link];
  const auto index = static_cast<std::size_t>(&touch - touches_.data());
  const Vec3 from = pose.point_back(tip), along = pose.rotate_back(outward);
  // How far a cell is beside the finger's line: the spring gives, the finger itself stays on the surface.
  const auto beside_2 = [&](Vec3 position) {
    const Vec3 off = position - from;
    const double ahead = dot(off, along);
    return std::max(0.0, dot(off, off) - ahead * ahead);
  };
  double nearest_2 = beside_2(touch.point);
  Vec3 point = touch.point, normal = touch.normal;
  if (target_cell_[index] != no_cell) {
    // The surface through the cells: their planes, blended where they meet, so that it has no edges.
    constexpr double width = 0.008;
    for (const std::size_t i : near_cells_[index])
      nearest_2 = std::min(nearest_2, beside_2(cells_[i].position));
    Vec3 points{}, normals{};
    double sum = 0;
    for (const std::size_t i : near_cells_[index]) {
      const double slope = dot(along, cells_[i].normal);
      if (slope < 0.2) continue;
      const double w = std::exp(-0.5 * (beside_2(cells_[i].position) - nearest_2) / (width * width));
      const double way = dot(cells_[i].position - from, cells_[i].normal) / slope;
      points = points + w * (from + way * along);
      normals = normals + w * cells_[i].normal;
      sum += w;
    }
    if (sum < 1e-12) return {};
    point = (1 / sum) * points;
    normal = normalised(normals);
  }
  const double slope = dot(along, normal);
  if (slope < 0.2) return {};  // the link has turned its side to the finger
  Surface out;
  out.depth = dot(point - from, normal) / slope;
  out.point = pose.point(from + out.depth * along);
  out.normal = pose.rotate(normal);
  out.hold = std::clamp(2 - std::sqrt(nearest_2) / touch.reach, 0.0, 1.0);
  return out;
}

double ContactWorld::travelled(const Touch& touch, double since) const {
  // Distance of the tip inward from the surface where the line was fixed; negative before it.
  if (!touch.profile.time.empty()) {
    if (since < profile_lead) return -touch.gap * (1 - since / profile_lead);
    const double into = since - profile_lead;
    if (into <= touch.profile.duration())
      return touch.profile_scale * touch.profile.at(into) / touch.stiffness;
    return -touch.release_speed * (into - touch.profile.duration());
  }
  const double way = touch.gap + touch.travel;
  const double arrival = way / touch.approach_speed;
  if (since < arrival) return -touch.gap + touch.approach_speed * since;
  if (since < arrival + touch.hold) return touch.travel;
  return touch.travel - touch.release_speed * (since - arrival - touch.hold);
}

void ContactWorld::spread(const Touch& touch, const Links& links, Vec3 point, double force) {
  const auto index = static_cast<std::size_t>(&touch - touches_.data());
  const Vec3 local = links.link[touch.link].point_back(point);
  double sum = 0;
  for (const std::size_t i : near_cells_[index]) {
    const Vec3 off = local - cells_[i].position;
    const double height = dot(off, cells_[i].normal);
    const double beside_2 = std::max(0.0, dot(off, off) - height * height);
    weights_[i] = std::exp(-0.5 * beside_2 / (touch.patch_radius * touch.patch_radius));
    sum += weights_[i];
  }
  if (sum < 1e-9) return;
  for (const std::size_t i : near_cells_[index]) stimulus_.force[i] += force * weights_[i] / sum;
}

void ContactWorld::approach(const Touch& touch, const Links& links, Vec3 tip) {
  const auto index = static_cast<std::size_t>(&touch - touches_.data());
  const Vec3 local = links.link[touch.link].point_back(tip);
  for (const std::size_t i : near_cells_[index]) {
    const Vec3 off = local - cells_[i].position;
    // The sensor looks outward from 2 mm below the surface, so that a touching finger is still ahead of it.
    const double height = dot(off, cells_[i].normal);
    const double ahead = std::max(0.002, height + 0.002);
    // As wide as the area that it presses: what feels it sees it as well.
    const double beside =
        std::max(0.0, std::sqrt(std::max(0.0, dot(off, off) - height * height)) - touch.patch_radius);
    const double beside_2 = beside * beside;
    const double distance_2 = beside_2 + std::max(0.0, height) * std::max(0.0, height);
    const double cosine_2 = ahead * ahead / (ahead * ahead + beside_2);
    const double s2 = proximity_distance_ * proximity_distance_;
    const double reading = cosine_2 * s2 / (s2 + distance_2);
    stimulus_.proximity[i] = std::max(stimulus_.proximity[i], reading);
  }
}

void ContactWorld::press(std::size_t i, double t, double h, const Links& links) {
  const Touch& touch = touches_[i];
  Finger& finger = fingers_[i];
  TouchResult& result = results_[i];
  const double since = t - touch.start;
  const bool recorded = !touch.profile.time.empty();
  result.began = true;

  if (!finger.frozen) {
    finger.anchor = target_point(touch, links, finger.direction);
    finger.placed = true;
    if (!touch.follow) finger.frozen = true;
  }
  const double way = touch.led ? finger.led_way : travelled(touch, since);
  if (way > 0) finger.frozen = true;

  double force = 0;
  Surface surface;
  Vec3 tip;
  if (recorded && touch.impose_force) {
    surface.point = target_point(touch, links, surface.normal);
    tip = surface.point - std::min(way, 0.0) * surface.normal;
    const double into = since - profile_lead;
    if (into >= 0) force = touch.profile_scale * touch.profile.at(into);
  } else {
    tip = finger.anchor - way * finger.direction + finger.aside;
    surface = surface_at(touch, links, tip, finger.direction);
    const double depth = surface.depth;
    if (depth > 0) {
      double rate = finger.depth > 0 ? (depth - finger.depth) / h : 0;
      // A recording already holds what its finger's own motion did: only the arm's motion is damped.
      if (recorded && finger.depth > 0) rate -= (way - finger.way) / h;
      constexpr double pulse = 2 * 3.14159265358979 * 8;  // of a hand's tremor [rad/s]
      const double trembles = 1 + touch.tremor * std::sin(pulse * since);
      force = surface.hold * std::max(0.0, trembles * (touch.stiffness * depth + touch.damping * rate));
      if (surface.hold > 0) tip = surface.point;
    }
    finger.depth = depth;
    finger.way = way;
  }
  finger.tip = tip;
  finger.force = force;
  approach(touch, links, tip);
  const Pose& pose = links.link[touch.link];
  if (force > 0) {
    const Vec3 pushed = -force * surface.normal;
    const Vec3 at = surface.point;
    const Joints torque = torque_of_force(links, touch.link, at, pushed);
    for (std::size_t j = 0; j < joint_count; ++j) load_[j] += torque[j];
    force_ = force_ + pushed;
    moment_ = moment_ + cross(at, pushed);
    if (touch.link == 5) {
      tool_force_ = tool_force_ + pushed;
      tool_moment_ = tool_moment_ + cross(at, pushed);
    }
    largest_ = std::max(largest_, force);
    active_ = static_cast<int>(i);
    spread(touch, links, at, force);
    if (!finger.pressed) {
      finger.pressed = true;
      finger.contact_in_link = pose.point_back(at);
      finger.contact_anchor = at;
      finger.contact_direction = surface.normal;
      result.first_contact = t;
      double nearest = 1e9;
      for (const std::size_t c : near_cells_[i]) {
        const double d = norm(cells_[c].position - finger.contact_in_link);
        if (d < nearest) {
          nearest = d;
          result.cell = cells_[c].id;
        }
      }
    }
    result.last_contact = t;
    result.impulse += force * h;
    if (force > result.peak_force) {
      result.peak_force = force;
      result.peak_force_time = t;
    }
  }
  if (finger.pressed) {
    const double pushed =
        dot(finger.contact_anchor - pose.point(finger.contact_in_link), finger.contact_direction);
    result.peak_deflection = std::max(result.peak_deflection, pushed);
  }
}

void ContactWorld::advance(double t, double h, const Links& links) {
  if (!quiet_) {
    std::fill(stimulus_.force.begin(), stimulus_.force.end(), 0);
    std::fill(stimulus_.proximity.begin(), stimulus_.proximity.end(), 0);
  }
  load_ = {};
  force_ = moment_ = tool_force_ = tool_moment_ = {};
  largest_ = 0;
  active_ = -1;
  quiet_ = true;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    const double since = t - touches_[i].start;
    fingers_[i].force = 0;
    if (touches_[i].led ? !fingers_[i].led : since < 0 || results_[i].ended) continue;
    if (!touches_[i].led && since >= touches_[i].duration()) {
      results_[i].ended = true;
      continue;
    }
    quiet_ = false;
    press(i, t, h, links);
  }
}

}  // namespace simulated_ur5
