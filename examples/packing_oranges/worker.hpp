// One arm at work: what it knows of the world, its place in the plan, and the requests to its skills that follow.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "examples/packing_oranges/believed.hpp"
#include "examples/packing_oranges/finger_room.hpp"
#include "examples/packing_oranges/giving_way.hpp"
#include "examples/packing_oranges/grip.hpp"
#include "examples/packing_oranges/right_of_way.hpp"
#include "examples/packing_oranges/tomm.hpp"
#include "examples/packing_oranges/work.hpp"
#include "skinctl/clearance/sightings.hpp"
#include "skinctl/semantics/resources.hpp"
#include "skinctl/tactile/squeeze.hpp"

namespace packing {

template <class R>
class Worker {
 public:
  using A = Arm<R>;
  using Scene = typename A::Scene;
  using Set = typename A::Set;
  using Executor = skinctl::Executor<Plan::capacity>;
  using Objects = Believed::Objects;
  struct Judged {
    double stiffness = 0;
    bool good = false;
    double time = 0;
  };

  Worker(std::size_t arm, const WorkSettings& settings, const skinctl::State<6>& measured)
      : arm_(arm),
        s_(settings),
        scene_(new Scene(A::scene(arm))),
        executor_(settings.plan, settings.executor),
        grip_(settings.hold, settings.max_hold),
        squeeze_({.from = settings.judge_from,
                  .to = settings.judge_to,
                  .finger_stiffness = 1e9,
                  .swing = 3,
                  .min_span = settings.judge_span}),
        objects_([] {
          std::array<skinctl::ObjectClass, Objects::capacity> kinds{};
          kinds.fill(orange_class);
          return kinds;
        }()),
        known_(objects_.start()),
        X_WB_(A::base(arm)),
        sight_(typename A::Model{}, scene_->skin().places(),
               {.range = sight_range, .half_angle = sight_cone}),
        retreat_(arm, settings.carry),
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
    if (s_.shown) {
      // Seen from its own side of the box.
      const skinctl::Rotation<double> turned{{side(arm), 0, 0}, {0, side(arm), 0}, {0, 0, 1}};
      s_.shown->X_OH = {turned * s_.shown->X_OH.axes(), turned * s_.shown->X_OH.origin()};
      s_.shown->way = turned * s_.shown->way;
      s_.shown->X_WH = {turned * s_.shown->X_WH.axes(), turned * s_.shown->X_WH.origin()};
      beside_ = s_.shown->X_OH.origin();
    }
    input_.measured = measured;
  }

  void see(const Picture& picture) {
    last_picture_ = picture.taken;
    for (const auto& d : picture.seen) static_cast<void>(objects_.detect(known_, d));
    if (!s_.honest) return;
    believed_.see(picture, X_WH_.origin());
    believed_.write(known_);
    believed_.find(found_);
    keep_clear_of_trays();
  }
  /// What it says about the box, before a cycle.
  [[nodiscard]] skinctl::PlaceRequest place_request() const {
    using Phase = typename Executor::Phase;
    const bool at_work =
        plan_.phase == Phase::begin || plan_.phase == Phase::run || plan_.phase == Phase::confirm;
    const auto& p = X_WH_.origin();
    const std::uint8_t to = now_at().place;
    const bool at_box = to != skinctl::no_place && mark() != orange_class && is_near_box(hand_at(to));
    skinctl::PlaceRequest out;
    out.wants = at_work && at_box ? std::uint8_t(0) : std::uint8_t(255);
    out.leaves = 1;
    out.failed = !at_work;
    out.away = is_near_box(p) ? 0u : ~0u;
    return out;
  }

  /// Whether the other arm goes first where the two are in each other's way.
  void goes_first(bool first) { way_.goes_first(first); }
  /// Whether it is kept from its way; and whether the other one is.
  [[nodiscard]] bool waits() const {
    return (kept_ && asked_ && way_.waited() > 250ms) || (gives_way_ && kept_);
  }
  void other_waits(bool waits) { other_waits_ = waits; }
  /// Whether it gives way to something that is seen, and the other arm is in its way: the other arm gives way to it then.
  [[nodiscard]] bool presses() const { return gives_way_ && kept_ && now_ - seen_at_ < hesitates; }
  void other_presses(bool presses) {
    if (presses) pressed_at_ = now_;
  }
  /// How often it went aside for the other arm.
  [[nodiscard]] int went_aside() const { return way_.times(); }
  /// What its links and hand may fill until it stands, if it brakes now; and what the other arm may fill.
  [[nodiscard]] auto occupied() const { return skinctl::occupied(*scene_, *memory_, X_WB_); }
  template <class Filled>
  void keep_clear_of(skinctl::Nanoseconds now, const Filled& other) {
    input_.around.count = 0;
    input_.around.time = now;
    input_.around.add(X_WB_.inverse(), other);
  }

  /// What the cells see beside the other arm is to be kept clear of, and given way to. The readings that the other arm
  /// explains become nothing.
  void look_around(const skinctl::State<6>& measured, std::span<skinctl::CellSample> samples) {
    sight_.each_known(
        measured.q, [&](std::size_t i) { return samples[i].proximity; }, input_.around,
        [&](std::size_t i) { samples[i].proximity = 0; });
    const std::size_t seen = sight_.look(
        measured.q,
        [&](std::size_t i) {
          return scene_->skin().held(memory_->skin, i).proximity *
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
  /// How often it gave way to something unknown, and a person set it right.
  [[nodiscard]] int gave_way() const { return gave_way_; }
  [[nodiscard]] int set_right() const { return set_right_; }

  /// What pulls the hand, as the sensor at the wrist says [N, the World's axes].
  void feel(const skinctl::Xyz<double>& wrist) { wrist_ = wrist; }

  /// A cycle.
  typename Scene::Output step(skinctl::Nanoseconds now, const skinctl::State<6>& measured,
                              const skinctl::GripperState& gripper,
                              std::span<const skinctl::CellSample> samples, bool granted, bool resume) {
    now_ = now;
    gripper_ = gripper;
    const auto was = X_WH_.origin();
    X_WH_ = X_WB_ * A::hand(measured.q);
    way_.step(now, kept_ && way_back_ == WayBack::none,
              norm(skinctl::Xyz<double>(X_WH_.origin() - was)) < 0.03 * 0.008);
    const skinctl::HandSample<> hand{now, X_WH_, 0.0002, gripper.force};
    features_ = extractor_.step(featured_, objects_, known_, hand);
    // Without an opening: what the fingers close at their constant speed.
    if (judging_)
      squeeze_.take(squeezed_, gripper.force,
                    s_.by_time ? closing_speed * skinctl::seconds<double>(now) : -gripper.opening);

    // Where the hand was high last, it comes back to from wherever it gave way to.
    if (way_back_ == WayBack::none && X_WH_.origin().z > 0.9 * s_.carry && -X_WH_.axis_z().z > 0.99)
      high_ = measured.q;

    // The plan waits while the arm gives way: nothing fails then because it takes long.
    input_.goal.reset();
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
      request_ = result.request;
      perform(result.request);
    }

    // Where it has nothing to do it makes room for the other arm.
    const bool idle = finished() || (report_.phase == skinctl::SkillPhase::running && parts_.empty());
    if (other_waits_ && idle && !way_.is_aside() && way_back_ == WayBack::none)
      go_aside(Set::start_skill(A::skills(&GoBack::rule)));

    input_.now = now;
    input_.measured = measured;
    input_.samples = samples;
    input_.gripper = gripper;
    const auto out = scene_->step(*memory_, input_);
    input_.request = skinctl::CycleRequest::none;
    kept_ = out.status.has(skinctl::Reason::clearance_kept);
    displaced_ = out.status.has(skinctl::Reason::displaced);
    return out;
  }

  [[nodiscard]] bool finished() const { return plan_.phase == Executor::Phase::finished; }
  [[nodiscard]] bool asks() const { return plan_.phase == Executor::Phase::ask; }
  [[nodiscard]] double hold() const { return grip_.hold(); }
  [[nodiscard]] const Believed& believed() const { return believed_; }
  [[nodiscard]] bool carries() const {
    return features_.in_hand && does(skinctl::activity::Put::rule, skinctl::activity::Carry::rule) &&
           plan_.phase == Executor::Phase::run;
  }
  [[nodiscard]] bool goes_back() const { return !done_.empty() && done_.back().back; }
  [[nodiscard]] bool lets_go_in_box() const {
    return !done_.empty() && !goes_back() && does(skinctl::activity::Release::rule) && mark() == box_class;
  }
  /// Whether it is limited for the other arm.
  [[nodiscard]] bool kept() const { return kept_; }
  /// Of the next cycle.
  void request(skinctl::CycleRequest asked) { input_.request = asked; }
  [[nodiscard]] const std::vector<Done>& done() const { return done_; }
  [[nodiscard]] const std::vector<Judged>& judged() const { return judged_; }
  /// Where the hand stood when it had set something down.
  [[nodiscard]] const std::vector<skinctl::Xyz<double>>& touched() const { return touched_; }
  [[nodiscard]] const skinctl::StepRequest& request() const { return request_; }
  [[nodiscard]] const skinctl::Features& features() const { return features_; }
  [[nodiscard]] const skinctl::Transform<skinctl::World, skinctl::Tool>& hand() const { return X_WH_; }

 private:
  /// The step at which its plan is.
  [[nodiscard]] const skinctl::Step& now_at() const { return executor_.task().steps[plan_.step]; }
  [[nodiscard]] bool does(const auto&... rule) const { return ((now_at().does == &rule) || ...); }
  [[nodiscard]] bool next_does(const skinctl::ActivityRule& rule) const {
    const auto next = now_at().done;
    return next < executor_.task().size && executor_.task().steps[next].does == &rule;
  }
  /// Class of the landmark of that step's place; 0: none.
  [[nodiscard]] skinctl::ObjectClass mark() const {
    return now_at().place == skinctl::no_place ? skinctl::ObjectClass(0)
                                               : executor_.task().places[now_at().place].mark;
  }
  /// Whether the step is about an orange that lies in the feed.
  [[nodiscard]] bool is_at_feed() const {
    using namespace skinctl::activity;
    return does(Reach::rule, Take::rule) || (does(Squeeze::rule) && now_at().place == skinctl::no_place);
  }
  [[nodiscard]] bool is_near_box(const skinctl::Xyz<double>& p) const {
    const Tray& box = found_.at[0];
    return std::hypot(p.x - box.x, p.y - box.y) <= 0.3;
  }
  /// The number of the tray at which the step puts; what it is about is no orange.
  [[nodiscard]] std::size_t tray_number() const { return mark() == bin_class ? 1 + arm_ : 0; }
  /// Walls are where box and bins are believed to be; with others the arm's cycle is built anew.
  void keep_clear_of_trays() {
    double off = 0;
    for (std::size_t k = 0; k < tray_count; ++k)
      off = std::max(off, std::hypot(found_.at[k].x - walls_at_[k].x, found_.at[k].y - walls_at_[k].y));
    if (off < walls_off) return;
    walls_at_ = found_.at;
    scene_.reset(new Scene(A::scene(arm_, walls_at_)));
    retreat_ = GivingWay<R>(arm_, s_.carry, walls_at_);
  }
  static constexpr double walls_off = 0.005;  ///< walls are moved; the clearance's margin is 20 mm [m]
  /// Whether the tray of the present step was seen so lately; what the hand hides is where it was.
  [[nodiscard]] bool has_seen_tray(skinctl::Nanoseconds within) const {
    if (!s_.honest) return true;
    const std::size_t k = tray_number();
    const Tray& t = found_.at[k];
    return now_ - found_.seen[k] <= within || Believed::hides(X_WH_.origin(), {t.x, t.y, 0});
  }
  /// Age of a place that is known, and of one between whose walls a hand may go: nine pictures.
  static constexpr skinctl::Nanoseconds marked_for = 1s, goes_down_for = 300ms;
  static constexpr double strays =
      0.012;  ///< a place that moved is gone for anew; the walls are 50 mm away [m]
  static constexpr double closing_speed = 0.015;  ///< of `Squeezing` [m/s]
  using Goal = typename Scene::Goal;
  struct Part {
    Goal request;
    bool moves = false;
    skinctl::Xyz<double> to{0, 0, 0};
    bool until_touched = false;
    double slowest = 0;   ///< it takes at least so long [s]
    bool judges = false;  ///< it is a squeeze
    double most = 1e9;    ///< force of a finger at which it has ended, at most [N]
  };

  [[nodiscard]] skinctl::Observed seen() const {
    using namespace skinctl;
    const auto out = observed(features_);
    // A release forgets the place, though it is still seen.
    const bool matters = s_.honest && does(activity::Find::rule, activity::Put::rule) && mark() != 0;
    return matters ? also(out, fact::marked, has_seen_tray(marked_for)) : out;
  }
  /// The log of the steps.
  void note(const typename Executor::Memory& was, const typename Executor::Memory& is,
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

  /// What a take, or fingers that came down on something, tell of the place. A person is asked when camera or
  /// hand are at fault; that a place is empty is no failure that somebody is asked for.
  void learn(const typename Executor::Memory& was, bool resume) {
    using Phase = typename Executor::Phase;
    const bool take = executor_.task().steps[was.step].does == &skinctl::activity::Take::rule;
    const bool began = was.phase == Phase::run || was.phase == Phase::confirm;
    const bool failed = plan_.phase == Phase::begin_reverse || plan_.tries > was.tries;
    if (take && began && failed && !empty_) empty_ = true, believed_.failed(feed_tray(arm_));
    if (take && began && plan_.step != was.step) believed_.took();
    if (std::exchange(stood_, false)) believed_.failed(feed_tray(arm_)), empty_ = true;
    if (plan_.phase == Phase::reverse && empty_) empty_ = false, plan_ = Executor::forgiven(plan_);
    using skinctl::StepFailure;
    const bool lift = executor_.task().steps[was.step].does == &Lift::rule;
    const bool slips =
        began && plan_.phase == Phase::begin_reverse && !take &&
        (plan_.why == StepFailure::fact_lost || (lift && plan_.why == StepFailure::fact_missing));
    if (slips && grip_.slipped())
      plan_ = Executor::forgiven(plan_);
    else if (slips)
      believed_.leave(taken_);
    if (was.phase == Phase::ask && resume) believed_.answered();
    if (believed_.asks() && plan_.phase == Phase::begin && does(skinctl::activity::Look::rule))
      plan_ = Executor::asking(plan_, now_);
    believed_.write(known_);
  }

  void perform(const skinctl::StepRequest& r) {
    using Kind = skinctl::StepRequest::Kind;
    if (r.kind == Kind::start && r.ticket != report_.ticket) begin(r);
    if (report_.phase != skinctl::SkillPhase::running) return;
    if (does(skinctl::activity::Find::rule)) return find();
    if (parts_.empty()) return look();
    if (way_.is_aside()) return;
    if (goes_to_tray()) {
      if (norm(skinctl::Xyz<double>(hand_at(r.place) - goes_to_)) > strays) begin(r);
      if (!asked_ && parts_[part_].to.z < s_.carry && !has_seen_tray(goes_down_for)) return;
    }
    if (asked_ && parts_[part_].moves && way_.should_go()) return go_aside(parts_[part_].request);
    const auto told = Set::report_of(memory_->law, ticket_);
    if (asked_ && told.phase == skinctl::SkillPhase::failed && told.ticket == ticket_) return end(false);
    if (asked_ && told.phase == skinctl::SkillPhase::finished && told.ticket == ticket_) {
      if (gripper_.force > parts_[part_].most) return;
      if (parts_[part_].judges && !judge()) return end(false);
      if (++part_ == parts_.size()) return end(true);
      asked_ = false;
    }
    if (asked_ && parts_[part_].until_touched) set_down(parts_[part_]);
    // A finger has come down on something: no further.
    if (asked_ && does(skinctl::activity::Reach::rule) && plan_.phase == Executor::Phase::run &&
        gripper_.force > stands_on) {
      stood_ = true;
      if (s_.honest) {  // off it: at rest the arm would go on along its spline
        Part off{Set::start_skill(A::skills(&skinctl::activity::Reach::rule)), true,
                 at(X_WH_.origin(), X_WH_.origin().z + 0.01)};
        ask(off);
      } else {
        send(Set::start_skill(Set::template index<behaviour::Rest>()));
      }
      return end(false);
    }
    // It goes on from where it was pushed aside to, or its orange has rolled off: it looks anew.
    if (!asked_ && does(skinctl::activity::Reach::rule) && plan_.phase == Executor::Phase::run &&
        !is_over(taken_))
      return end(false);
    if (!asked_) ask(parts_[part_]);
  }
  /// Whether the hand can go straight down to `p`: open fingers that come from the side knock over what they are to hold.
  [[nodiscard]] bool is_over(const skinctl::Xyz<double>& p) const {
    return std::hypot(X_WH_.origin().x - p.x, X_WH_.origin().y - p.y) < 0.05;
  }
  static constexpr double stands_on = 3;  ///< force of a finger that stands on something [N]
  /// On the way of a part that ends where something is touched: there the arm stops. The wrist's weight is what it was when
  /// the hand began to be slow.
  void set_down(Part& part) {
    constexpr auto first = 160ms;
    if (now_ - asked_at_ < first) {
      free_ = wrist_;
      return;
    }
    if (-dot(skinctl::Xyz<double>(wrist_ - free_), s_.shown->way) < std::max(2.0, 0.5 * s_.shown->pressed))
      return;
    part.to = X_WH_.origin();
    part.until_touched = false;
    part.slowest = 0;
    asked_ = false;
    touched_.push_back(part.to);
  }
  /// Whether it is on its way to a place in box or bin.
  [[nodiscard]] bool goes_to_tray() const {
    return does(skinctl::activity::Put::rule) && plan_.phase == Executor::Phase::run && mark() != 0;
  }
  /// The tray of this step: it is there when it was seen lately.
  void find() {
    if (has_seen_tray(goes_down_for)) end(true);
  }
  void end(bool well) {
    report_.phase = well ? skinctl::SkillPhase::finished : skinctl::SkillPhase::failed;
    judging_ = false;
  }
  /// While something unknown is near, the arm gives way with all joints and what is in the hand. No goal holds it: a law's
  /// plan waits while the skin pushes against it. Then it returns by way of the last joints at which its hand was high, and
  /// goes on with its part. Whether this cycle is taken by that.
  bool gives_way(const skinctl::JointPosition<6>& q) {
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
      add(A::skills(&skinctl::activity::Carry::rule), X_WH_.origin(), 0.01);
      hold_lightly();
      add_squeeze(A::skills(&skinctl::activity::Squeeze::rule));
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
  /// Whether it had nothing to do, or was on its way from one place above all to another one.
  [[nodiscard]] bool goes_on_from_anywhere() const {
    const double high = 0.7 * s_.carry;
    return parts_.empty() || (parts_[part_].moves && parts_[part_].to.z > high && from_.z > high);
  }
  static constexpr skinctl::Nanoseconds hesitates = 300ms;  ///< after it saw something for the last time
  /// Middles of the oranges that lie, for an arm that gives way: not what it holds or has between its fingers.
  [[nodiscard]] std::size_t lying(std::array<skinctl::Xyz<double>, Objects::capacity>& out) const {
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
  static constexpr double around =
      0.05;  ///< a hand that is less above an orange's middle has it between its fingers [m]
  /// Where an arm that gave way is on its way back.
  enum class WayBack : unsigned char { none, up, joints, over, down };
  static WayBack next(WayBack w) {
    return w == WayBack::down ? WayBack::none : static_cast<WayBack>(static_cast<unsigned char>(w) + 1);
  }
  void send(Goal g) {
    ticket_ = ticket_ == 0xffff ? std::uint16_t(1) : std::uint16_t(ticket_ + 1);
    g.ticket = ticket_;
    input_.goal = g;
  }
  /// The other arm is in the way, and this one in its: back towards its own base for a while, then the same part again.
  void go_aside(const Goal& request) {
    Part aside{request, true, X_WH_.origin()};
    aside.to.x = -side(arm_) * (R::stands - 0.32);
    if (aside.to.z < s_.carry) aside.to.z = s_.carry;
    ask(aside);
    asked_ = false;
    way_.go();
  }
  static constexpr double turning = 2;  ///< of the hand, at most [rad/s]
  /// A part's request, to the cycle.
  void ask(Part& part) {
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
    asked_at_ = now_;
  }

  void add(std::uint8_t skill, const skinctl::Xyz<double>& to, double near) {
    Part part{Set::start_skill(skill), true, to};
    part.request.tolerance = {.position = near, .orientation = 0.05};
    parts_.push_back(part);
  }
  void grip(const skinctl::GripperGoal& goal) {
    auto& part = parts_.back().request.goals.template of<skinctl::GripperGoal>();
    part.has = true;
    part.goal = goal;
  }
  /// As it is carried until it is squeezed.
  void hold_lightly() {
    grip({0, s_.lightly, 0.02});
    parts_.back().most = 1.3 * s_.lightly;
  }
  /// Squeezes; where it is carried on from there, what was squeezed is held as on the way.
  void add_squeeze(std::uint8_t skill) {
    parts_.push_back({Set::start_skill(skill), false, {}});
    parts_.back().judges = true;
    if (now_at().place == skinctl::no_place) return;
    add(A::skills(&skinctl::activity::Carry::rule), X_WH_.origin(), 0.01);
    grip({0, grip_.hold(), 0.02});
  }
  [[nodiscard]] skinctl::Xyz<double> at(const skinctl::Xyz<double>& p, double z) const {
    return {p.x, p.y, z};
  }

  /// The way of an activity: the parts that the robot does one after the other.
  void begin(const skinctl::StepRequest& r) {
    using namespace skinctl;
    report_ = {r.ticket, SkillPhase::running, SkillFailure::none};
    answer_ = true;
    asked_ = judging_ = false;
    parts_.clear();
    part_ = 0;
    looks_since_ = now_;
    const std::uint8_t skill = A::skills(r.does);
    const auto here = X_WH_.origin();
    constexpr double passing = 0.06;
    if (s_.shown) R_ = mark() == box_class ? s_.shown->X_WH.axes() : s_.shown->X_OH.axes();
    if (r.does == &activity::Look::rule) return;
    if (r.does == &activity::Find::rule) return;
    if (r.does == &activity::ReachAbove::rule) {
      if (!s_.shown) R_ = turned(turned_);
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
      if (!is_over(taken_) || empty_) return end(false);
      add(skill, taken_, 0.003);
      if (s_.honest && believed_.is_wary())
        parts_.back().slowest = 1.875 * norm(skinctl::Xyz<double>(taken_ - here)) / Believed::wary_speed;
    } else if (r.does == &activity::Squeeze::rule) {
      squeezed_ = {};
      judging_ = true;
      add_squeeze(skill);
    } else if (r.does == &activity::Carry::rule) {
      R_ = turned_at(r.place);
      const auto p = hand_at(r.place);
      add(skill, at(here, s_.carry), passing);
      hold_lightly();
      add(skill, at(p, std::max(p.z, s_.carry)), 0.01);
      hold_lightly();
    } else if (r.does == &Lift::rule) {
      add(skill, at(here, s_.carry), passing);
      grip({0, grip_.hold(), 0.02});
    } else if (r.does == &activity::Put::rule) {
      if (!s_.shown) R_ = turned_at(r.place);
      const auto p = goes_to_ = hand_at(r.place);
      if (here.z < 0.8 * s_.carry && std::hypot(p.x - here.x, p.y - here.y) > strays)
        add(skill, at(here, s_.carry), passing);
      add(skill, at(p, s_.carry), passing);
      if (mark() == box_class && s_.shown && s_.shown->until_touched) {
        // From before where it was touched in the lesson to beyond.
        constexpr double before = 0.035, beyond = 0.045, speed = 0.04;
        add(skill, p - before * s_.shown->way, 0.01);
        add(skill, p + beyond * s_.shown->way, 0.01);
        parts_.back().until_touched = true;
        parts_.back().slowest = 1.875 * (before + beyond) / speed;
        return;
      }
      const bool as_shown = mark() == box_class && s_.shown;
      const double floor = s_.honest ? tray_bottom : 0;
      add(skill, as_shown ? p : at(p, floor + std::max(p.z, taken_.z + s_.let_go)), 0.01);
    } else if (r.does == &GoBack::rule) {
      if (!s_.shown) R_ = straight_;
      const Tray feed = feed_tray(arm_);
      add(skill, at(here, s_.carry), passing);
      add(skill, {feed.x, feed.y, s_.carry}, 0.2);
    } else if (r.does == &activity::Reverse::rule) {
      const std::uint8_t let_go = Set::template index<behaviour::LetGo>();
      if (features_.in_hand && features_.carried) {
        add(skill, at(here, s_.carry), passing);
        add(skill, at(taken_, s_.carry), passing);
        add(skill, taken_, 0.01);
      }
      parts_.push_back({Set::start_skill(let_go), false, {}});
      add(skill, at(features_.in_hand && features_.carried ? taken_ : here, s_.carry), 0.05);
    } else {
      if (r.does == &activity::Take::rule && empty_) return end(false);  // the same place, at once
      parts_.push_back({Set::start_skill(skill), false, {}});
      // It may wait for the box with the orange in the hand, and somebody pushes it meanwhile.
      if (r.does == &activity::Take::rule && next_does(activity::Carry::rule)) grip({0, s_.lightly, 0.08});
      if (s_.shown && r.does == &activity::Release::rule && mark() == box_class)
        grip({s_.shown->opening, 5, 0.15});
    }
  }
  /// Where the hand stands at a place of the plan, not of an orange, in the World. The world of a lesson is the
  /// base of the arm that was led: so far in front of its own base this arm goes. In box and bins it lets go
  /// `aside` of the place.
  [[nodiscard]] skinctl::Xyz<double> hand_at(std::uint8_t place) const {
    const auto& [mark, X_MH] = executor_.task().places[place];
    const Tray& box = found_.at[0];
    if (mark == box_class && s_.shown)
      return s_.shown->X_WH.origin() + skinctl::Xyz<double>{box.x - box_tray.x, box.y - box_tray.y, 0};
    const auto p = seen_by(arm_, X_MH.origin());
    if (mark == 0) return p + seen_by(arm_, {-R::stands, 0, 0});
    const Tray& tray = mark == bin_class ? found_.at[1 + arm_] : box;
    return p + skinctl::Xyz<double>{tray.x, tray.y - side(arm_) * s_.aside, 0};
  }
  /// The hand is turned from how it points down as it was turned in the lesson from how it took.
  [[nodiscard]] skinctl::Rotation<double> turned_at(std::uint8_t place) const {
    const Plan& plan = executor_.task();
    const skinctl::Rotation<double> T{{side(arm_), 0, 0}, {0, side(arm_), 0}, {0, 0, 1}};
    for (std::size_t i = 0; i < plan.place_count; ++i)
      if (plan.places[i].mark == orange_class)
        return T * (plan.places[place].X_MH.axes() * plan.places[i].X_MH.axes().transpose()) * T * straight_;
    return straight_;
  }
  [[nodiscard]] skinctl::Rotation<double> turned(double angle) const {
    return skinctl::exp_so3(skinctl::Xyz<double>{0, 0, angle}) * straight_;
  }
  [[nodiscard]] FingerRoom room_beside(std::uint8_t orange) const {
    std::array<skinctl::Xyz<double>, Objects::capacity> others;
    std::size_t count = 0;
    for (std::uint8_t k = 0; k < Objects::capacity; ++k) {
      const auto& o = known_.objects[k];
      if (k != orange && o.known && now_ - o.time < 1s) others[count++] = o.X_WO.origin();
    }
    return finger_room(known_.objects[orange].X_WO.origin() + beside_, straight_,
                       std::span(others).first(count), s_.turns);
  }

  /// An orange of its own that is well seen; the one nearest to the hand.
  void look() {
    // A person was asked while it held an orange: that one first goes back to where it came from.
    if (features_.in_hand) return end(false);
    const bool sees = now_ - last_picture_ < 300ms;
    if (!sees) looks_since_ = now_;
    const auto fits = [&](std::uint8_t k) {
      const auto& o = known_.objects[k];
      const auto p = o.X_WO.origin();
      return sees && o.known && now_ - o.time <= 500ms && o.sigma <= 0.003 && o.misses == 0 && p.z <= 0.07 &&
             feed_tray(arm_).holds(p);
    };
    // The nearest one with room for its fingers; else where there is most.
    const auto cost = [&](std::uint8_t k) {
      const double room = room_beside(k).room;
      return room < FingerRoom::enough
                 ? 10 - room
                 : norm(skinctl::Xyz<double>(known_.objects[k].X_WO.origin() - X_WH_.origin()));
    };
    const std::uint8_t chosen = s_.honest ? believed_.choose(fits, cost) : cheapest(fits, cost);
    if (chosen != skinctl::no_object) {
      object_ = chosen;
      turned_ = room_beside(chosen).turn;
      return end(true);
    }
    if (now_ - looks_since_ < 1500ms) return;
    answer_ = false;
    end(true);
  }
  [[nodiscard]] static std::uint8_t cheapest(const auto& fits, const auto& cost) {
    std::uint8_t best = skinctl::no_object;
    double least = 1e9;
    for (std::uint8_t k = 0; k < Objects::capacity; ++k) {
      if (!fits(k)) continue;
      if (const double c = cost(k); c < least) best = k, least = c;
    }
    return best;
  }
  /// Whether the squeeze told something.
  bool judge() {
    judging_ = false;
    const auto k = squeeze_.result(squeezed_);
    if (!k.known) return false;
    const std::uint8_t border = now_at().border;
    answer_ = border == skinctl::no_border || k.stiffness >= executor_.task().borders[border];
    // Each side of an orange gives by half of the closing.
    judged_.push_back({2 * k.stiffness, answer_, skinctl::seconds<double>(now_)});
    return true;
  }

  std::size_t arm_;
  WorkSettings s_;
  std::unique_ptr<const Scene> scene_;  ///< of walls where `walls_at_` says
  Trays walls_at_ = first_trays;
  Believed::FoundTrays found_;
  skinctl::Xyz<double> goes_to_{0, 0, 0};  ///< place in box or bin to which the present step goes
  Executor executor_;
  Grip grip_;
  skinctl::Squeeze<> squeeze_;
  Objects objects_;
  skinctl::FeatureExtractor<> extractor_;
  typename Objects::Memory known_;
  Believed believed_;
  skinctl::FeatureExtractor<>::Memory featured_{};
  skinctl::Features features_{};
  skinctl::Squeeze<>::Memory squeezed_{};
  skinctl::Transform<skinctl::World, skinctl::Base> X_WB_;
  skinctl::Transform<skinctl::World, skinctl::Tool> X_WH_;
  skinctl::Rotation<double> R_;         ///< of the hand: it points down, or as it was shown
  skinctl::Rotation<double> straight_;  ///< it points down, turned as at first ...
  double turned_ = 0;                   ///< ... and so about the vertical over the orange that it takes [rad]
  skinctl::Xyz<double> beside_{0, 0, 0};  ///< the hand's place beside an orange that it takes
  skinctl::Sightings<typename A::Model> sight_;
  GivingWay<R> retreat_;
  std::unique_ptr<typename Scene::Memory> memory_;
  typename Scene::Input input_;
  typename Executor::Memory plan_;
  skinctl::StepRequest request_;
  skinctl::SkillReport report_;
  skinctl::GripperState gripper_;
  std::vector<Part> parts_;
  std::size_t part_ = 0;
  std::uint16_t ticket_ = 0;
  bool asked_ = false, answer_ = true, judging_ = false, kept_ = false, other_waits_ = false;
  bool empty_ = false, stood_ = false;  ///< the take failed; a finger stood on something on the way to it
  RightOfWay way_;
  WayBack way_back_ = WayBack::none;
  bool gives_way_ = false, displaced_ = false;
  int gave_way_ = 0, set_right_ = 0, tries_ = 0;
  skinctl::JointPosition<6> high_ = A::home();
  skinctl::Xyz<double> from_{0, 0, 0};
  skinctl::Nanoseconds seen_at_{-1s}, pressed_at_{-1s}, return_by_{}, given_way_{};
  std::uint8_t object_ = 0;
  skinctl::Xyz<double> taken_{0, 0, 0.04};
  skinctl::Nanoseconds now_{}, last_picture_{}, looks_since_{}, asked_at_{};
  skinctl::Xyz<double> wrist_{0, 0, 0}, free_{0, 0, 0};
  std::vector<skinctl::Xyz<double>> touched_;
  std::vector<Done> done_;
  std::vector<Judged> judged_;
};

}  // namespace packing
