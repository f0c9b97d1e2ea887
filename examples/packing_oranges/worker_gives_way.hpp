// How an arm gives way to what it does not know, and comes back.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

template <class R>
bool Worker<R>::gives_way(const skinctl::JointPosition<6>& q) {
  using namespace skinctl;
  const auto told = Set::report_of(memory_->law, ticket_);
  const bool done =
      told.ticket == ticket_ && (told.phase == SkillPhase::finished || told.phase == SkillPhase::failed);
  const bool pressed = now_ - pressed_at_ < hesitates;
  if (now_ - seen_at_ < hesitates || pressed) {
    if (way_back_ == WayBack::none) from_ = X_WH_.origin();
    if (!gives_way_) {
      ++gave_way_;
      // Fingers that are around an orange close and take it along: it is back in its place when the arm is.
      const bool holds = features_.in_hand || does(activity::Take::rule);
      Goal away = Set::start_skill(Set::template index<behaviour::GiveWay>());
      auto& grip = away.goals.template of<GripperGoal>();
      grip.has = true;
      grip.goal = features_.in_hand ? GripperGoal{0, 1.4 * grip_.hold(), 0.02}
                  : holds           ? GripperGoal{0, grip_.hold(), 0.06}
                                    : GripperGoal{gripper_range.opening, 5, 0.15};
      send(away);
    }
    using Others = typename GivingWay<R>::Others;
    std::array<skinctl::Xyz<double>, Objects::capacity> oranges;
    const std::size_t count = lying(oranges);
    if (gives_way_ || !input_.goal) input_.goal.emplace();
    auto& wish = input_.goal->goals.template of<VelocityGoal<6>>();
    wish.has = true;
    wish.goal.velocity =
        retreat_(q, input_.around, std::span(oranges).first(count), pressed ? Others::press : Others::stay);
    gives_way_ = true;
    way_back_ = WayBack::up;
    tries_ = 0;
    return true;
  }
  if (way_back_ == WayBack::none) return false;
  if (!gives_way_ && !done && now_ < return_by_) return true;
  // Joints that are not reached are tried again: from there a hand cannot go straight.
  const bool again = way_back_ == WayBack::joints && told.phase != SkillPhase::finished && ++tries_ < 5;
  if (!gives_way_) way_back_ = again ? WayBack::up : next(way_back_);
  if (way_back_ == WayBack::up && tries_ == 0 && X_WH_.origin().z > 0.95 * s_.carry)
    way_back_ = WayBack::joints;
  if (way_back_ == WayBack::over && goes_on_from_anywhere()) way_back_ = WayBack::none;
  // From above an orange that is judged goes on, and an empty hand looks anew where its orange is.
  const bool at_orange = is_at_feed();
  if (way_back_ == WayBack::down && features_.in_hand != at_orange) {
    way_back_ = WayBack::none;
    if (at_orange) end(false);
  }
  gives_way_ = asked_ = false;
  squeezed_ = {};
  if (way_back_ == WayBack::none && judging_ && !is_at_feed()) {
    // It was held firmly on the way: a squeeze is judged by the rise of the force.
    parts_.clear();
    part_ = 0;
    add(skill_of(&skinctl::activity::Carry::rule), X_WH_.origin(), 0.01);
    hold_lightly();
    add_squeeze(skill_of(&skinctl::activity::Squeeze::rule));
  }
  if (way_back_ == WayBack::none) return false;
  if (way_back_ == WayBack::joints) {
    Goal g = Set::start_skill(Set::template index<behaviour::Return>());
    auto& to = g.goals.template of<JointGoal<6>>();
    double way = 0;
    for (std::size_t i = 0; i < 6; ++i) way = std::max(way, std::abs(high_[i] - q[i]));
    to.has = true;
    to.goal = {high_, nanoseconds(std::max(0.5, 1.9 * way / 1.5))};
    send(g);
  } else {
    Part back{Set::start_skill(Set::template index<behaviour::Reaching>()), true,
              way_back_ == WayBack::up     ? at(X_WH_.origin(), std::max(X_WH_.origin().z, s_.carry))
              : way_back_ == WayBack::over ? at(from_, std::max(from_.z, s_.carry))
                                           : from_};
    back.request.tolerance = {.position = 0.003, .orientation = 0.05};
    if (way_back_ == WayBack::up && !features_.in_hand) {
      auto& grip = back.request.goals.template of<GripperGoal>();
      grip.has = true;
      grip.goal = {gripper_range.opening, 5, 0.15};
    }
    ask(back);
  }
  asked_ = false;
  return_by_ = now_ + (way_back_ == WayBack::up ? 1s : 5s);
  return true;
}

template <class R>
void Worker<R>::stands_on_something() {
  const bool open = gripper_.opening > 0.95 * gripper_range.opening;
  const double told = grips_box() ? s_.hold_box : grip_.hold();
  const bool feels = open || !s_.presses;  // a wrist that presses takes what it holds down with that force
  if (feels && gripper_.force > (open ? s_.stands_on : told + comes_down_on)) {
    stands_at_most_ = std::max(stands_at_most_.value_or(0), X_WH_.origin().z);
    stands_since_ = now_;
  } else if (now_ - std::max(stands_since_, pushed_last_) > untouched) {
    stands_at_most_.reset();
  }
  if (!stands_at_most_) return;
  // A body under the hand, so near that the hand's capsule may come no lower.
  constexpr double size = 0.15;
  const double clear = A::around_hand.radius + A::clearance().own.margin + size;
  const auto below = at(X_WH_.origin(), *stands_at_most_ - clear);
  input_.around.add(X_WB_.inverse() * skinctl::Obstacle<skinctl::World>{{below, below, size}, 0});
}

template <class R>
bool Worker<R>::goes_on_from_anywhere() const {
  const double high = 0.7 * s_.carry;
  return parts_.empty() || (parts_[part_].moves && parts_[part_].to.z > high && from_.z > high);
}

template <class R>
std::size_t Worker<R>::lying(std::array<skinctl::Xyz<double>, Objects::capacity>& out) const {
  std::size_t count = 0;
  const bool goes_for_one = is_at_feed();
  // A finger that stands on an orange feels a force, too.
  const bool closed = gripper_.opening < 0.95 * gripper_range.opening;
  for (std::uint8_t k = 0; k < Objects::capacity; ++k) {
    const auto& o = known_.objects[k];
    const auto p = o.X_WO.origin();
    if (!o.known || (k == known_.held && closed) || now_ - o.time > 1s) continue;
    if (goes_for_one && k == object_ && X_WH_.origin().z < p.z + around) continue;
    out[count++] = p;
  }
  return count;
}

}  // namespace packing
