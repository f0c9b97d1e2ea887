// The requests of an arm to its skills, and what the outcome of a step teaches it.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

template <class R>
void Worker<R>::note(const typename Executor::Memory& was, const typename Executor::Memory& is,
                     const skinctl::StepRequest&) {
  using Phase = typename Executor::Phase;
  const double t = skinctl::seconds<double>(now_);
  const auto back = [](Phase p) { return p == Phase::begin_reverse || p == Phase::reverse; };
  const bool same = was.step == is.step && back(was.phase) == back(is.phase) &&
                    (was.phase == Phase::ask) == (is.phase == Phase::ask) && was.tries == is.tries;
  if (same && !done_.empty()) {
    done_.back().to = t;
    return;
  }
  if (!done_.empty()) {
    done_.back().to = t;
    const bool failed = back(is.phase) != back(was.phase) ? back(is.phase) : is.tries > was.tries;
    if (failed) done_.back().why = is.why;
  }
  if (is.phase != Phase::finished)
    done_.push_back({is.step, executor_.task().steps[is.step].does, back(is.phase), is.phase == Phase::ask,
                     skinctl::StepFailure::none, t, t});
}

template <class R>
void Worker<R>::learn(const typename Executor::Memory& was, bool resume) {
  using Phase = typename Executor::Phase;
  using skinctl::StepFailure;
  const skinctl::Step& step = executor_.task().steps[was.step];
  if (step.role == full_box_class) {  // of oranges, and of the camera that sees them, a wall tells nothing
    stood_ = empty_ = false;
    return believed_.write(known_);
  }
  const bool take = step.does == &skinctl::activity::Take::rule, lift = step.does == &Lift::rule;
  const bool squeezes = step.does == &skinctl::activity::Squeeze::rule && step.place == skinctl::no_place;
  const bool began = was.phase == Phase::run || was.phase == Phase::confirm;
  const bool gives_up = began && plan_.phase == Phase::begin_reverse;
  const bool lost = gives_up && plan_.why == StepFailure::fact_lost;
  // What lies is squeezed out of fingers that stand beside its middle, whatever its friction.
  const bool failed = take ? began && (gives_up || plan_.tries > was.tries) : squeezes && lost;
  if (failed && !empty_) empty_ = true, believed_.failed(feed_tray(arm_));
  if ((take || squeezes) && began && plan_.step != was.step && !is_at_feed()) believed_.took();
  if (std::exchange(stood_, false)) believed_.failed(feed_tray(arm_)), empty_ = true;
  if (plan_.phase == Phase::reverse && empty_) empty_ = false, plan_ = Executor::forgiven(plan_);
  if (take && began && plan_.step != was.step) set_down_in_doubt(was);
  const bool slips =
      !take && !failed && (lost || (lift && gives_up && plan_.why == StepFailure::fact_missing));
  if (slips && lift) believed_.slipped();
  // A tool is taken along its handle, whichever way it is turned: where it lies tells nothing of the camera.
  if (slips && !uses_tool_ && !believed_.knows_camera())
    believed_.doubt_camera(), plan_ = Executor::forgiven(plan_);
  if (slips && grip_.slipped())
    plan_ = Executor::forgiven(plan_);
  else if (slips && believed_.knows_camera())
    believed_.leave(taken_);
  // It does not see how a tool is turned that has fallen: a person lays it back.
  if (slips && step.role == tool_class) believed_.ask();
  if (was.phase == Phase::ask && resume) believed_.answered();
  if (believed_.asks() && plan_.phase == Phase::begin && does(skinctl::activity::Look::rule))
    plan_ = Executor::asking(plan_, now_);
  believed_.write(known_);
}

template <class R>
void Worker<R>::set_down_in_doubt(const typename Executor::Memory& was) {
  constexpr double middle =
      0.01;  // of a hand that stands over what it takes: three deviations of both places [m]
  if (std::hypot(between_.x, between_.y) > middle) believed_.doubt_camera();
  if (!believed_.doubts_camera()) return;
  believed_.took();
  plan_ = was;
  plan_.phase = Executor::Phase::begin_reverse;
  done_.back() = {was.step,          now_at().does,  true, false, skinctl::StepFailure::none,
                  done_.back().from, done_.back().to};
}

template <class R>
void Worker<R>::count_ways_back(const typename Executor::Memory& was) {
  using Phase = typename Executor::Phase;
  const auto works = [](Phase p) { return p == Phase::begin || p == Phase::run || p == Phase::confirm; };
  if (!works(was.phase)) return;
  if (plan_.phase == Phase::begin_reverse || plan_.phase == Phase::ask) ++in_vain_;
  const bool let_go = executor_.task().steps[was.step].does == &skinctl::activity::Release::rule;
  if (let_go && works(plan_.phase) && plan_.step != was.step) in_vain_ = 0;
  if (in_vain_ > s_.in_vain && !asked_in_vain_ && plan_.phase == Phase::begin) {
    asked_in_vain_ = true;
    plan_ = Executor::asking(plan_, now_);
  }
}

template <class R>
void Worker<R>::end(bool well) {
  report_.phase = well ? skinctl::SkillPhase::finished : skinctl::SkillPhase::failed;
  judging_ = false;
}

template <class R>
void Worker<R>::perform(const skinctl::StepRequest& r) {
  using Kind = skinctl::StepRequest::Kind;
  if (r.kind == Kind::start && r.ticket != report_.ticket) begin(r);
  if (report_.phase != skinctl::SkillPhase::running) return;
  const bool reverses = plan_.phase == Executor::Phase::reverse;
  const bool finds = does(skinctl::activity::Find::rule) && !(uses_tool_ && reverses);
  if (finds) {
    if (is_at_thing() ? has_seen_thing(goes_down_for) : has_seen_tray(goes_down_for)) return end(true);
    if (!is_at_thing() || part_ == parts_.size()) return;
  }
  if (does(FindRoom::rule)) {
    if (has_seen_tray(goes_down_for) && !box_is_full_ && granted_) return end(true);
    if (part_ == parts_.size()) return;
  }
  if (is_drive() && part_ == parts_.size()) {
    if (table_ == drives_to()) end(true);
    return;
  }
  if (parts_.empty()) return look();
  if (way_.is_aside()) return;
  if (goes_to_tray() && norm(skinctl::Xyz<double>(hand_at(r.place) - goes_to_)) > strays) begin(r);
  if (has_come_down_in_tray()) {
    Part off{Set::start_skill(A::skills(&skinctl::activity::Put::rule)), true,
             at(X_WH_.origin(), X_WH_.origin().z + 0.005)};
    ask(off);
    return end(true);
  }
  if (asked_ && parts_[part_].moves && way_.should_go() && !grips_box())
    return go_aside(parts_[part_].request);
  // A box that does not come along is let go.
  if (moves_box() && gripper_.force > s_.box_is_stuck) return end(false);
  const auto told = Set::report_of(memory_->law, ticket_);
  const bool somebody_pushes = now_ - pushed_last_ < untouched;
  if (somebody_pushes && parts_[part_].until < 1e9) press_again();
  const bool pressed = asked_ && press_.force() >= parts_[part_].until;
  if (asked_ && told.phase == skinctl::SkillPhase::failed && told.ticket == ticket_) return end(false);
  if (pressed || (asked_ && told.phase == skinctl::SkillPhase::finished && told.ticket == ticket_)) {
    if (gripper_.force > parts_[part_].most) return;
    if (!pressed && parts_[part_].until < 1e9) return end(false);  // nothing is below, or fingers slide
    if (parts_[part_].judges && !judge()) return end(false);
    if (pressed && parts_[part_].judges) {
      Part less = press({Set::start_skill(skill_of(&SetDown::rule)), false, {}}, s_.feels, 0);
      less.request.kind = static_cast<unsigned char>(Goal::Kind::goal);
      ask(less);
    }
    if (++part_ == parts_.size()) {
      if (!does(FindRoom::rule) && !finds && !is_drive()) end(true);
      return;
    }
    asked_ = false;
  }
  // A finger has come down on something: no further.
  if (asked_ && does(skinctl::activity::Reach::rule) && plan_.phase == Executor::Phase::run &&
      gripper_.force > s_.stands_on) {
    stood_ = true;
    // Off it: at rest the arm would go on along its spline.
    Part off{Set::start_skill(A::skills(&skinctl::activity::Reach::rule)), true,
             at(X_WH_.origin(), X_WH_.origin().z + 0.01)};
    ask(off);
    return end(false);
  }
  // It goes on from where it was pushed aside to, or its orange has rolled off: it looks anew.
  if (!asked_ && does(skinctl::activity::Reach::rule) && plan_.phase == Executor::Phase::run &&
      !is_over(taken_))
    return end(false);
  if (lowers_in_tray()) {
    if (!asked_ && !has_seen_tray(goes_down_for)) return;
    if (something_lies_there()) begin(r);
  }
  if (!asked_) ask(parts_[part_]);
}

template <class R>
bool Worker<R>::something_lies_there() const {
  constexpr double seen_within = 0.006;  // deviation of places that is no news [m]
  if (!s_.stay) return false;
  const auto lying = believed_.lying_in(found_.at[tray_number()]);
  return least_height(goes_to_, fingers_along(), s_.fingers, lying, -seen_within) >
         parts_[part_].to.z + 0.003;
}

template <class R>
bool Worker<R>::has_come_down_in_tray() const {
  return s_.stay && lowers_in_tray() && asked_ && gripper_.force > grip_.hold() + comes_down_on;
}

template <class R>
void Worker<R>::go_aside(const Goal& request) {
  Part aside{request, true, X_WH_.origin()};
  aside.to.x = -side(arm_) * (R::stands - 0.32);
  if (aside.to.z < s_.carry) aside.to.z = s_.carry;
  ask(aside);
  asked_ = false;
  way_.go();
}

template <class R>
void Worker<R>::send(Goal g) {
  ticket_ = ticket_ == 0xffff ? std::uint16_t(1) : std::uint16_t(ticket_ + 1);
  g.ticket = ticket_;
  input_.goal = g;
}

template <class R>
void Worker<R>::ask(Part& part) {
  Goal& g = part.request;
  const bool starts = g.kind == static_cast<unsigned char>(Goal::Kind::start);
  if (part.moves) {
    auto& pose = g.goals.template of<skinctl::PoseGoal<skinctl::Tool>>();
    pose.has = true;
    const double way = norm(skinctl::Xyz<double>(part.to - X_WH_.origin()));
    const double turns = norm(skinctl::log_so3(X_WH_.axes().transpose() * R_));
    const double time = std::max({0.3, part.slowest, std::sqrt(5.78 * way / s_.acceleration),
                                  1.875 * way / s_.speed, 1.875 * turns / turning});
    pose.goal = {X_WB_.inverse() * skinctl::Transform<skinctl::World, skinctl::Tool>(R_, part.to),
                 skinctl::nanoseconds(time)};
  }
  if (starts && part_ > 0 && memory_->law.skill == g.skill)
    g.kind = static_cast<unsigned char>(Goal::Kind::goal);
  send(g);
  asked_ = true;
}

}  // namespace packing
