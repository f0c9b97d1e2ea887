// The way of each step: the parts that an arm does one after the other, the orange that it looks for, its judgement.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

template <class R>
bool Worker<R>::is_at_feed() const {
  using namespace skinctl::activity;
  return does(Reach::rule, Take::rule) ||
         (does(Squeeze::rule, SetDown::rule) && now_at().place == skinctl::no_place);
}

template <class R>
bool Worker<R>::is_near_box(const skinctl::Xyz<double>& p) const {
  const Tray& box = found_.at[0];
  return std::hypot(p.x - box.x, p.y - box.y) <= 0.3;
}

template <class R>
typename Worker<R>::Part Worker<R>::move(std::uint8_t skill, const skinctl::Xyz<double>& to, double near) {
  Part part{Set::start_skill(skill), true, to};
  part.request.tolerance = {.position = near, .orientation = 0.05};
  return part;
}

template <class R>
void Worker<R>::grip(const skinctl::GripperGoal& goal) {
  auto& part = parts_.back().request.goals.template of<skinctl::GripperGoal>();
  part.has = true;
  part.goal = goal;
}

template <class R>
void Worker<R>::begin(const skinctl::StepRequest& r) {
  using namespace skinctl;
  report_ = {r.ticket, SkillPhase::running, SkillFailure::none};
  answer_ = true;
  asked_ = judging_ = false;
  parts_.clear();
  part_ = 0;
  looks_since_ = now_;
  if (is_about_box() && r.does != &GoBack::rule && (r.does != &activity::Reverse::rule || grips_box()))
    return begin_at_box(r);
  const std::uint8_t skill = skill_of(r.does);
  const auto here = X_WH_.origin();
  constexpr double passing = 0.06;
  if (r.does == &activity::Look::rule) return;
  if (r.does == &activity::Find::rule) {
    // A hand that has just taken its tool may hide what lies beside it.
    if (is_at_thing()) add(A::skills(&activity::Put::rule), at(here, s_.carry), passing);
    return;
  }
  if (r.does == &FindRoom::rule) {
    // It waits where it does not keep the other arm from the box.
    if (!box_is_full_ || !is_near_box(here)) return;
    add(A::skills(&activity::Put::rule), at(here, s_.carry), passing);
    return add(A::skills(&activity::Put::rule), waiting_place(), 0.2);
  }
  if (is_drive()) {
    R_ = straight_;
    add(skill, at(here, s_.carry), passing);
    return add(skill, waiting_place(), 0.1);
  }
  if (r.does == &activity::ReachAbove::rule) {
    R_ = turned(turned_);
    if (uses_tool_) stand_beside(r.place);
    const auto p = known_.objects[object_].X_WO.origin();
    if (here.z < 0.8 * s_.carry) {
      add(skill, at(here, s_.carry), passing);
      grip({gripper_range.opening, 5, 0.15});
    }
    add(skill, at(p + beside_, s_.above), s_.above_near);
    if (parts_.size() == 1) grip({gripper_range.opening, 5, 0.15});
  } else if (r.does == &activity::Reach::rule) {
    const auto p = known_.objects[object_].X_WO.origin();
    taken_ = at(p, std::clamp(p.z, 0.032, 0.044)) + beside_;
    taken_beside_.z = uses_tool_ ? taken_.z - beside_.z - p.z : 0;
    if (!is_over(taken_) || empty_) return end(false);
    add(skill, taken_, 0.003);
    if (s_.honest && believed_.is_wary())
      parts_.back().slowest = 1.875 * norm(skinctl::Xyz<double>(taken_ - here)) / Believed::wary_speed;
  } else if (r.does == &activity::Squeeze::rule) {
    squeezed_ = {};
    judging_ = true;
    add_squeeze(skill);
  } else if (r.does == &SetDown::rule) {
    stands_at_ = taken_;
    if (r.place != no_place) {
      const auto p = hand_at(r.place);
      stands_at_ = at(p, taken_.z);
      const std::uint8_t carries = skill_of(&activity::Carry::rule);
      add(carries, at(here, s_.carry), passing);
      add(carries, at(p, s_.carry), 0.01);
      add(carries, at(p, taken_.z + clear_of_table), 0.001);
    }
    parts_.push_back(press({Set::start_skill(skill), false, {}}, 1.25 * s_.feels, s_.feels));
  } else if (r.does == &activity::Carry::rule) {
    R_ = turned_at(r.place);
    const auto p = goes_to_ = hand_at(r.place);
    add(skill, at(here, s_.carry), passing);
    if (!uses_tool_) hold_lightly();
    add(skill, at(p, std::max(p.z, s_.carry)), 0.01);
    if (!uses_tool_) hold_lightly();
  } else if (r.does == &activity::Use::rule) {
    begin_use(r.place);
  } else if (r.does == &Lift::rule) {
    add(skill, at(here, s_.carry), passing);
    grip({0, grip_.hold(), 0.02});
  } else if (r.does == &activity::Put::rule) {
    R_ = turned_at(r.place);
    const double floor = s_.honest && mark() != 0 ? tray_bottom : 0;
    double low = floor + taken_.z + s_.let_go;
    if (!uses_tool_) low = floor + std::max(hand_at(r.place).z, taken_.z + s_.let_go);
    if (s_.stay && mark() != 0) {
      const Tray& tray = found_.at[tray_number()];
      spot_ = free_spot(arm_, tray, fingers_along(), s_.fingers, believed_.lying_in(tray), low);
      low = std::min(spot_.z, s_.carry);
    }
    const auto p = goes_to_ = hand_at(r.place);
    if (here.z < 0.8 * s_.carry && std::hypot(p.x - here.x, p.y - here.y) > strays)
      add(skill, at(here, s_.carry), passing);
    add(skill, at(p, s_.carry), s_.stay || uses_tool_ ? 0.006 : passing);
    add(skill, at(p, low), uses_tool_ ? 0.003 : 0.01);
  } else if (r.does == &GoBack::rule) {
    R_ = straight_;
    add(skill, at(here, s_.carry), passing);
    add(skill, waiting_place(), 0.2);
  } else if (r.does == &activity::Reverse::rule) {
    const std::uint8_t let_go = Set::template index<behaviour::LetGo>();
    const bool brings_back = features_.in_hand && features_.carried;
    // Where it came from; at the other table in front of it.
    const auto from = table_ == 0 ? taken_ : at(waiting_place(), taken_.z);
    // What it lets go while it stands still lies where its fingers held it.
    if (s_.honest && gripper_.holding && !brings_back && !features_.moving && !is_touched()) {
      const Xyz<double> p = here + X_WH_.axes() * between_ - beside_;
      if (feels_between_)
        believed_.set_down(p, {{1, 0, 0}, {0, 1, 0}}, now_);
      else
        believed_.set_down(p, {fingers_along()}, now_);
    }
    if (brings_back) {
      add(skill, at(here, s_.carry), passing);
      add(skill, at(from, s_.carry), passing);
      add(skill, from, 0.01);
    }
    parts_.push_back({Set::start_skill(let_go), false, {}});
    add(skill, at(brings_back ? from : here, s_.carry), 0.05);
  } else {
    if (r.does == &activity::Take::rule && empty_) return end(false);  // the same place, at once
    parts_.push_back({Set::start_skill(skill), false, {}});
    // It may wait for the box with the orange in the hand, and somebody pushes it meanwhile.
    if (r.does == &activity::Take::rule && next_does(activity::Carry::rule)) grip({0, s_.lightly, 0.08});
    // A handle that lies askew comes to lie between the fingers while they close on it slowly, on the table.
    if (r.does == &activity::Take::rule && uses_tool_) {
      parts_.push_back({Set::start_skill(skill), false, {}});
      grip({0, grip_.hold(), closing_speed});
    }
  }
}

template <class R>
void Worker<R>::hold_lightly() {
  grip({0, s_.lightly, 0.02});
  if (!s_.presses) parts_.back().most = 1.3 * s_.lightly;
}

template <class R>
typename Worker<R>::Part Worker<R>::press(Part part, double force, double until) const {
  auto& goal = part.request.goals.template of<skinctl::ForceGoal<>>();
  goal.has = true;
  goal.goal = {{0, 0, -1}, A::yields_to_press * force};
  part.until = until;
  return part;
}

template <class R>
void Worker<R>::press_again() {
  squeezed_ = {};
  asked_ = false;
  parts_.erase(parts_.begin(),
               std::find_if(parts_.begin(), parts_.end() - 1, [](const Part& part) { return part.judges; }));
  if (parts_.front().judges) {
    Part down{Set::start_skill(skill_of(&SetDown::rule)), false, {}};
    parts_.insert(parts_.begin(), press(down, 1.25 * s_.feels, s_.feels));
  }
  const auto above = at(stands_at_, stands_at_.z + clear_of_table);
  parts_.insert(parts_.begin(), move(skill_of(&skinctl::activity::Carry::rule), above, 0.001));
  part_ = 0;
}

template <class R>
void Worker<R>::add_squeeze(std::uint8_t skill) {
  parts_.push_back({Set::start_skill(skill), false, {}});
  parts_.back().judges = true;
  if (s_.presses) parts_.back() = press(parts_.back(), s_.press, s_.judge_to);
  if (now_at().place == skinctl::no_place) return;
  add(skill_of(&skinctl::activity::Carry::rule), X_WH_.origin(), 0.01);
  grip({0, grip_.hold(), 0.02});
}

template <class R>
skinctl::Xyz<double> Worker<R>::hand_at(std::uint8_t place) const {
  const auto& [mark, X_MH] = executor_.task().places[place];
  const auto p = seen_by(arm_, X_MH.origin()) + taken_beside_;
  if (mark == shelf_class) return p + shelf_place(arm_);
  if (mark == 0) return p + seen_by(arm_, {-R::stands, 0, 0});
  if (mark == orange_class) return p + thing_.p;
  const Tray& tray = mark == bin_class ? found_.at[1 + arm_] : found_.at[0];
  if (s_.stay && does(skinctl::activity::Put::rule)) return {tray.x + spot_.x, tray.y + spot_.y, p.z};
  return p + skinctl::Xyz<double>{tray.x, tray.y - side(arm_) * s_.aside, 0};
}

template <class R>
skinctl::Rotation<double> Worker<R>::turned_at(std::uint8_t place) const {
  const Plan& plan = executor_.task();
  const skinctl::Rotation<double> T{{side(arm_), 0, 0}, {0, side(arm_), 0}, {0, 0, 1}};
  for (std::size_t i = 0; i < plan.place_count; ++i)
    if (plan.places[i].mark == (uses_tool_ ? now_at().role : orange_class))
      return T * (plan.places[place].X_MH.axes() * plan.places[i].X_MH.axes().transpose()) * T * straight_;
  return straight_;
}

template <class R>
skinctl::Rotation<double> Worker<R>::turned(double angle) const {
  return skinctl::exp_so3(skinctl::Xyz<double>{0, 0, angle}) * straight_;
}

template <class R>
bool Worker<R>::judge() {
  judging_ = false;
  const auto k = squeeze_.result(squeezed_);
  if (!k.known) return false;
  const std::uint8_t border = now_at().border;
  answer_ = border == skinctl::no_border || k.stiffness >= executor_.task().borders[border];
  // Each side of an orange gives by half of the closing of fingers; a wrist presses in one.
  judged_.push_back(
      {(s_.presses ? 1 / press_tells : 2) * k.stiffness, answer_, skinctl::seconds<double>(now_)});
  return true;
}

}  // namespace packing
