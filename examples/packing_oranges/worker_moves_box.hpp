// How an arm puts the full box away: it takes a wall between its fingers, and pushes it along the table.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

/// Opening of the fingers over a wall: its thickness and 18 mm on each side, for what the detector is off. The inner
/// finger stays clear of oranges that were put down beside it [m].
inline constexpr double open_for_wall = 0.05;

template <class R>
bool Worker<R>::grips_box() const {
  using namespace skinctl::activity;
  return is_about_box() && does(Reach::rule, Take::rule, Put::rule, Release::rule);
}

template <class R>
bool Worker<R>::sees_full_box() const {
  bool is_put = false;
  for (std::size_t a = 0; a < arms; ++a) {
    const auto p = shelf_place(a);
    is_put = is_put || std::hypot(p.x - found_.at[0].x, p.y - found_.at[0].y) < put_within;
  }
  return box_is_full_ && !is_put;
}

template <class R>
void Worker<R>::count_oranges_in_box() {
  constexpr int sure = 6;  // pictures
  const bool full = believed_.lying_in(found_.at[0]).size() >= s_.full_box;
  since_full_ = full == box_is_full_ ? 0 : since_full_ + 1;
  if (since_full_ >= sure) box_is_full_ = full, since_full_ = 0;
}

template <class R>
skinctl::Xyz<double> Worker<R>::place_at_wall(std::uint8_t place) const {
  const auto wall = hand_at(place);
  const auto lying = believed_.lying_in(found_.at[0]);
  const double inner = wall.x + side(arm_) * (open_for_wall / 2 + 0.006);
  skinctl::Xyz<double> best = wall;
  double most = -1;
  for (const double y : {0.0, 0.03, -0.03, 0.06, -0.06, 0.085, -0.085}) {
    double room = 0.06;
    for (const auto& o : lying) room = std::min(room, std::hypot(o.x - inner, o.y - (wall.y + y)));
    if (room > most) most = room, best.y = wall.y + y;
  }
  return best;
}

template <class R>
skinctl::Rotation<double> Worker<R>::across_wall() const {
  const auto y = straight_ * skinctl::Xyz<double>{0, 1, 0};
  return turned(-std::atan(y.y / (std::abs(y.x) > 1e-9 ? y.x : 1e-9)));
}

template <class R>
void Worker<R>::begin_at_box(const skinctl::StepRequest& r) {
  using namespace skinctl;
  const std::uint8_t skill = A::skills(r.does), reach = A::skills(&activity::Reach::rule);
  const auto here = X_WH_.origin();
  if (r.does == &activity::Look::rule) return;
  if (r.does == &activity::ReachAbove::rule) {
    R_ = across_wall();
    taken_ = place_at_wall(r.place);
    if (here.z < 0.8 * s_.carry) add(skill, at(here, s_.carry), 0.06);
    add(skill, at(taken_, s_.carry), 0.005);
    grip({open_for_wall, 5, 0.15});
  } else if (r.does == &activity::Reach::rule) {
    if (!is_over(taken_)) return end(false);
    keep_clear_of_trays();
    constexpr double just_above = 0.115;  // the fingers' ends are 13 mm over the wall there [m]
    add(skill, at(taken_, just_above), 0.01);
    add(skill, taken_, 0.003);
    parts_.back().slowest = 1.875 * (just_above - taken_.z) / Believed::wary_speed;
  } else if (r.does == &activity::Put::rule) {
    const auto to = hand_at(r.place);
    const Xyz<double> way{to.x - found_.at[0].x, to.y - found_.at[0].y, 0};
    add(skill, here + way, 0.01);
    parts_.back().slowest = 1.875 * norm(way) / s_.box_speed;
    grip({0, s_.hold_box, 0.02});
  } else if (r.does == &activity::Release::rule || r.does == &activity::Reverse::rule) {
    add(Set::template index<behaviour::LetGo>(), here, 0.05);
    parts_.back().moves = false;
    grip({open_for_wall, 5, 0.15});
    add(reach, at(here, s_.carry), 0.05);
  } else {
    parts_.push_back({Set::start_skill(skill), false, {}});
    grip({0, 2, 0.03});  // the finger that is there first pushes the box until the other one is
  }
}

}  // namespace packing
