// A cycle of an arm: what it is told of the world and of the other arm before it, and the cycle.
#pragma once

#include "examples/packing_oranges/worker.hpp"

namespace packing {

template <class R>
Worker<R>::Worker(std::size_t arm, const WorkSettings& settings, const skinctl::State<6>& measured)
    : arm_(arm),
      s_(settings),
      uses_tool_(uses_tool(settings.plan)),
      walls_at_(trays_at_first(settings.drives, uses_tool_)),
      scene_(new Scene(A::scene(arm, walls_at_))),
      executor_(settings.plan, settings.executor),
      grip_(settings.hold, settings.max_hold),
      squeeze_({.from = settings.judge_from,
                .to = settings.judge_to,
                .finger_stiffness = 1e9,
                .swing = 3,
                .min_span = settings.judge_span}),
      objects_([this] {
        std::array<skinctl::ObjectClass, Objects::capacity> kinds{};
        kinds.fill(orange_class);
        for (std::size_t a = 0; a < arms && uses_tool_; ++a) kinds[tool_of(a)] = tool_class;
        return kinds;
      }()),
      known_(objects_.start()),
      X_WB_(A::base(arm)),
      sight_(typename A::Model{}, scene_->skin().first().places(),
             {.range = sight_range, .half_angle = sight_cone}),
      retreat_(arm, settings.carry, walls_at_),
      memory_(std::make_unique<typename Scene::Memory>()) {
  scene_->start(*memory_, measured);
  plan_ = executor_.start(measured.time);
  X_WH_ = X_WB_ * A::hand(measured.q);
  const auto x = X_WH_.axis_x();
  const double size = std::hypot(x.x, x.y);
  const skinctl::Xyz<double> across{x.x / size, x.y / size, 0}, down{0, 0, -1};
  R_ = straight_ = {across, cross(down, across), down};
  const Plan& plan = executor_.task();
  for (std::size_t i = plan.place_count; i-- > 0;)
    if (plan.places[i].mark == orange_class) beside_ = seen_by(arm, plan.places[i].X_MH.origin());
  input_.measured = measured;
  found_.at = walls_at_;
}

template <class R>
void Worker<R>::see(const Picture& picture) {
  last_picture_ = picture.taken;
  for (const auto& d : picture.seen) static_cast<void>(objects_.detect(known_, d));
  if (!s_.honest) return;
  believed_.see(picture, std::array{X_WH_.origin(), other_hand_});
  believed_.write(known_);
  believed_.find(found_);
  count_oranges_in_box();
  keep_clear_of_trays();
}

template <class R>
skinctl::PlaceRequest Worker<R>::place_request() const {
  using Phase = typename Executor::Phase;
  const bool at_work =
      plan_.phase == Phase::begin || plan_.phase == Phase::run || plan_.phase == Phase::confirm;
  const auto& p = X_WH_.origin();
  const std::uint8_t to = now_at().place;
  const bool goes_there = to != skinctl::no_place && mark() != orange_class && is_near_box(hand_at(to));
  skinctl::PlaceRequest out;
  out.wants = at_work && goes_there && !waits_for_room() ? std::uint8_t(0) : std::uint8_t(255);
  out.leaves = 1;
  out.step_failed = !at_work;
  out.away = is_near_box(p) ? 0u : ~0u;
  return out;
}

template <class R>
void Worker<R>::look_around(const skinctl::State<6>& measured, std::span<skinctl::CellSample> samples) {
  sight_.each_known(
      measured.q, [&](std::size_t i) { return samples[i].proximity; }, input_.around,
      [&](std::size_t i) { samples[i].proximity = 0; });
  const std::size_t seen = sight_.look(
      measured.q,
      [&](std::size_t i) {
        return scene_->skin().first().held(memory_->skin.first, i).proximity *
               double(skinctl::CellCounts::proximity_unit);
      },
      input_.around);
  if (seen > 0) seen_at_ = measured.time;
  // A person sets right an arm that something pushed off its place.
  if (displaced_ && measured.time - seen_at_ > 1s) {
    input_.request = skinctl::CycleRequest::resume;
    displaced_ = false;
    ++set_right_;
  }
}

template <class R>
typename Worker<R>::Scene::Output Worker<R>::step(skinctl::Nanoseconds now, const skinctl::State<6>& measured,
                                                  const skinctl::GripperState& gripper,
                                                  std::span<const skinctl::CellSample> samples, bool granted,
                                                  bool resume) {
  now_ = now;
  gripper_ = gripper;
  granted_ = granted;
  const auto was = X_WH_.origin();
  X_WH_ = X_WB_ * A::hand(measured.q);
  if (does(skinctl::activity::Reach::rule, skinctl::activity::Take::rule)) believed_.feel(gripper);
  way_.step(now, kept_ && way_back_ == WayBack::none,
            norm(skinctl::Xyz<double>(X_WH_.origin() - was)) < 0.03 * 0.008);
  const skinctl::HandSample<> hand{now, X_WH_, 0.0002, gripper.force};
  features_ = extractor_.step(featured_, objects_, known_, hand);
  const std::uint8_t skill = memory_->law.skill;
  press_.step(skill == Set::template index<behaviour::ForceCartesian>() ||
              skill == Set::template index<behaviour::ClosingToPress>());
  if (Pressing::pushed(samples, 3 * newtons_per_reading)) pushed_last_ = now;
  // Without an opening: what the fingers close at their constant speed.
  if (judging_ && s_.presses)
    squeeze_.take(squeezed_, press_.force(), -X_WH_.origin().z);
  else if (judging_)
    squeeze_.take(squeezed_, gripper.force,
                  s_.by_time ? closing_speed * skinctl::seconds<double>(now) : -gripper.opening);

  // Where the hand was high last, it comes back to from wherever it gave way to.
  if (way_back_ == WayBack::none && X_WH_.origin().z > 0.9 * s_.carry && -X_WH_.axis_z().z > 0.99)
    high_ = measured.q;

  if (is_at_thing()) follow_thing();
  // The plan waits while the arm gives way: nothing fails then because it takes long.
  input_.goal.reset();
  const bool waits_to_drive = table_ != Carriage::nowhere && wants_to_drive() != Carriage::nowhere;
  if (waits_to_drive && table_ != drives_to()) given_way_ += now - input_.now;  // for the other arm
  if (gives_way(measured.q)) {
    given_way_ += now - input_.now;
  } else {
    const auto result = executor_.step(plan_, {.now = now - given_way_,
                                               .seen = seen(),
                                               .skill = report_,
                                               .answer = answer_,
                                               .granted = granted,
                                               .resume = resume});
    note(plan_, result.memory, result.request);
    const auto before = plan_;
    plan_ = result.memory;
    if (s_.honest) learn(before, resume);
    count_ways_back(before);
    request_ = result.request;
    perform(result.request);
  }

  // Where it has nothing to do it makes room for the other arm.
  const bool idle = finished() || (report_.phase == skinctl::SkillPhase::running && parts_.empty());
  if (other_waits_ && idle && !way_.is_aside() && way_back_ == WayBack::none)
    go_aside(Set::start_skill(A::skills(&GoBack::rule)));

  stands_on_something();
  input_.now = now;
  input_.measured = measured;
  input_.samples = samples;
  input_.gripper = gripper;
  input_.sensed.wrenches = press_.samples();
  const auto out = scene_->step(*memory_, input_);
  input_.request = skinctl::CycleRequest::none;
  kept_ = !stands_at_most_ && out.status.has(skinctl::Reason::clearance_kept);
  displaced_ = out.status.has(skinctl::Reason::displaced);
  return out;
}

template <class R>
void Worker<R>::keep_clear_of_trays() {
  if (table_ == Carriage::nowhere) return;
  Trays stand = trays_before_it();
  if (grips_box()) stand[0].x = 9;  // its fingers are where a wall is
  double off = 0;
  for (std::size_t k = 0; k < tray_count; ++k)
    off = std::max(off, std::hypot(stand[k].x - walls_at_[k].x, stand[k].y - walls_at_[k].y));
  if (off < walls_off) return;
  walls_at_ = stand;
  scene_.reset(new Scene(A::scene(arm_, walls_at_)));
  retreat_ = GivingWay<R>(arm_, s_.carry, walls_at_);
}

template <class R>
bool Worker<R>::has_seen_tray(skinctl::Nanoseconds within) const {
  if (!s_.honest) return true;
  const std::size_t k = tray_number();
  const Tray& t = found_.at[k];
  return now_ - found_.seen[k] <= within || Believed::hides(X_WH_.origin(), {t.x, t.y, 0});
}

template <class R>
skinctl::Observed Worker<R>::seen() const {
  using namespace skinctl;
  const auto out = observed(features_);
  // A release forgets the place, though it is still seen.
  const bool matters =
      s_.honest && does(activity::Find::rule, FindRoom::rule, activity::Put::rule) && mark() != 0;
  if (is_at_thing()) return also(out, fact::marked, has_seen_thing(marked_for));
  return matters ? also(out, fact::marked, has_seen_tray(marked_for)) : out;
}

}  // namespace packing
