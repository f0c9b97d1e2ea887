#include "examples/compliant_ur5/touch_observer.hpp"

#include <algorithm>
#include <cmath>

#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"

namespace compliant_ur5 {

using skinctl::Xyz;

TouchObserver::TouchObserver(std::vector<ObservedCell> cells, double newtons_per_reading, double rest_reading)
    : cells_(std::move(cells)),
      reading_(cells_.size()),
      newtons_(newtons_per_reading),
      rest_(3 * rest_reading) {
  touches_.reserve(1024);
  if (cells_.empty()) return;
  std::uint32_t largest = 0;
  for (const auto& cell : cells_) largest = std::max(largest, cell.id);
  index_.assign(largest + 1, cells_.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) index_[cells_[i].id] = i;
}

TouchObserver::Poses TouchObserver::poses(const skinctl::JointPosition<6>& q) noexcept {
  const auto all = skinctl::link_poses(skinctl::ur5::Model{}, q);
  const auto plain = [](const auto& X) { return X.template renamed<skinctl::Base, skinctl::FrameTag>(); };
  return {plain(all.get<0>()), plain(all.get<1>()), plain(all.get<2>()),
          plain(all.get<3>()), plain(all.get<4>()), plain(all.get<5>())};
}

Xyz<double> TouchObserver::point(const skinctl::JointPosition<6>& q, const ObservedCell& at) noexcept {
  const auto X = poses(q)[static_cast<std::size_t>(at.link)];
  return X.origin() + X.axes() * at.position;
}

Xyz<double> TouchObserver::in_link(const skinctl::JointPosition<6>& q, int link,
                                   const Xyz<double>& direction) noexcept {
  return poses(q)[static_cast<std::size_t>(link)].axes().transpose() * direction;
}

Xyz<double> TouchObserver::place(const Poses& poses) const noexcept {
  const auto& X = poses[static_cast<std::size_t>(touched_.link)];
  return X.origin() + X.axes() * touched_.position;
}

void TouchObserver::felt_by(TouchSummary& touch, const ObservedCell& cell) noexcept {
  touch.link = cell.link;
  touch.cell = cell.id;
  touch.place = {cell.position.x, cell.position.y, cell.position.z};
}

void TouchObserver::cycle(double t, std::span<const skinctl::CellSample> samples,
                          const skinctl::JointPosition<6>& q, const skinctl::JointPosition<6>& task) {
  for (const auto& s : samples) {
    if (skinctl::check(s).any() || s.cell >= index_.size() || index_[s.cell] >= cells_.size()) continue;
    reading_[index_[s.cell]] = s.force[0] + s.force[1] + s.force[2];
  }
  std::array<double, 6> per_link{};
  std::array<std::size_t, 6> most{};
  std::array<double, 6> most_reading{};
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const auto link = static_cast<std::size_t>(cells_[i].link);
    const double r = static_cast<double>(reading_[i]) - rest_;
    if (r < 0.01) continue;  // noise
    per_link[link] += newtons_ * r;
    if (r > most_reading[link]) most_reading[link] = r, most[link] = i;
  }
  const auto link =
      static_cast<std::size_t>(std::max_element(per_link.begin(), per_link.end()) - per_link.begin());
  force_ = per_link[link];
  follow(t, cells_[most[link]], q, task);
}

void TouchObserver::cycle(double t, double force, const ObservedCell& felt,
                          const skinctl::JointPosition<6>& q, const skinctl::JointPosition<6>& task) {
  force_ = force;
  follow(t, felt, q, task);
}

void TouchObserver::follow(double t, const ObservedCell& felt, const skinctl::JointPosition<6>& q,
                           const skinctl::JointPosition<6>& task) {
  const Poses now = poses(q);
  if (!touching_ && force_ > 1) {
    touching_ = true;
    touched_ = felt;
    from_ = place(now);
    normal_ = now[static_cast<std::size_t>(felt.link)].axes() * felt.normal;
    touches_.push_back({.start = t, .end = t});
    felt_by(touches_.back(), felt);
  }
  if (touches_.empty()) return;
  TouchSummary& touch = touches_.back();
  if (touching_) {
    if (force_ > touch.peak_force) {
      touch.peak_force = force_;
      felt_by(touch, felt);
    }
    const double away = -dot(place(now) - from_, normal_);
    touch.deflection = std::max(touch.deflection, away);
    if (touch.give_way < 0 && away >= 0.001) touch.give_way = t - touch.start;
    if (force_ >= 0.5) quiet_since_ = t;
    if (t - quiet_since_ > 0.5) {  // a finger that bounces is one touch
      touching_ = false;
      touch.end = quiet_since_;
    } else {
      touch.end = t;
    }
  }
  const auto error = place(now) - place(poses(task));
  touch.return_error = std::sqrt(dot(error, error));
}

}  // namespace compliant_ur5
