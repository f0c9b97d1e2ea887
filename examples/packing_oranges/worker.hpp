// One arm at work: what it knows of the world, its place in the plan, and the requests to its skills that follow.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "examples/packing_oranges/believed.hpp"
#include "examples/packing_oranges/carriage.hpp"
#include "examples/packing_oranges/finger_room.hpp"
#include "examples/packing_oranges/giving_way.hpp"
#include "examples/packing_oranges/grip.hpp"
#include "examples/packing_oranges/pressing.hpp"
#include "examples/packing_oranges/right_of_way.hpp"
#include "examples/packing_oranges/tomm.hpp"
#include "examples/packing_oranges/tool.hpp"
#include "examples/packing_oranges/work.hpp"
#include "skinctl/clearance/sightings.hpp"
#include "skinctl/semantics/resources.hpp"
#include "skinctl/tactile/squeeze.hpp"

namespace packing {

template <class R>
class Worker : WorkNumbers {
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

  Worker(std::size_t arm, const WorkSettings& settings, const skinctl::State<6>& measured);

  void see(const Picture& picture);
  /// Where the robot stands, before a cycle, and at which table; `Carriage::nowhere`: it drives.
  void stands(const skinctl::BaseState<>& base, std::size_t table);
  /// The table to which it wants to drive, and is ready to; `Carriage::nowhere`: none.
  [[nodiscard]] std::size_t wants_to_drive() const;
  /// Whether somebody pushes its skin.
  [[nodiscard]] bool is_touched() const { return pushed_last_ == now_; }
  /// A reading of the wrist's force sensor, before a cycle, where there is one.
  void feel(const skinctl::WrenchSample& wrist) { press_.feel(wrist); }
  /// Where its fingers hold something, beside their middle, in the hand's frame, before a cycle [m]:
  /// fingertips that feel the joints of their fingers tell it.
  void feel_between(const skinctl::Xyz<double>& place) { between_ = place, feels_between_ = true; }
  /// What it says about the box, before a cycle.
  [[nodiscard]] skinctl::PlaceRequest place_request() const;

  /// Whether the other arm goes first where the two are in each other's way.
  void goes_first(bool first) { way_.goes_first(first); }
  /// Whether it is kept from its way; and whether the other one is.
  [[nodiscard]] bool waits() const {
    return (kept_ && asked_ && way_.waited() > 250ms) || (gives_way_ && kept_);
  }
  void other_waits(bool waits) { other_waits_ = waits; }
  /// Whether the other arm is out of work for good: what lies before it, in reach, is this one's too.
  void other_is_out(bool out) { other_is_out_ = out; }
  /// How far the other arm has found the camera off counts for this one, which sees by the same.
  void hear_of_camera(const Believed& others) { believed_.hear_of_camera(others); }
  /// Where the other arm's hand is: it hides things from the detector, too.
  void other_hand(const skinctl::Xyz<double>& place) { other_hand_ = place; }
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
  void look_around(const skinctl::State<6>& measured, std::span<skinctl::CellSample> samples);
  /// How often it gave way to something unknown, and a person set it right.
  [[nodiscard]] int gave_way() const { return gave_way_; }
  [[nodiscard]] int set_right() const { return set_right_; }

  /// A cycle.
  typename Scene::Output step(skinctl::Nanoseconds now, const skinctl::State<6>& measured,
                              const skinctl::GripperState& gripper,
                              std::span<const skinctl::CellSample> samples, bool granted, bool resume);

  [[nodiscard]] bool finished() const { return plan_.phase == Executor::Phase::finished; }
  [[nodiscard]] bool asks() const { return plan_.phase == Executor::Phase::ask; }
  /// Whether it has ended because it went back too often in a row, though it sees oranges.
  [[nodiscard]] bool gives_up() const { return in_vain_ > s_.in_vain + s_.in_vain / 2; }
  [[nodiscard]] double hold() const { return grip_.hold(); }
  [[nodiscard]] const Believed& believed() const { return believed_; }
  [[nodiscard]] bool carries() const {
    return features_.in_hand && does(skinctl::activity::Put::rule, skinctl::activity::Carry::rule) &&
           !is_about_box() && plan_.phase == Executor::Phase::run;
  }
  /// Whether it has a full box between its fingers, or is about to; and whether it moves one now.
  [[nodiscard]] bool grips_box() const;
  [[nodiscard]] bool moves_box() const {
    return is_about_box() && does(skinctl::activity::Put::rule) && plan_.phase == Executor::Phase::run;
  }
  /// Whether it waits with an orange for a box that has room.
  [[nodiscard]] bool waits_for_room() const { return does(FindRoom::rule) && box_is_full_; }
  [[nodiscard]] bool goes_back() const { return !done_.empty() && done_.back().back; }
  /// Whether it is limited for the other arm.
  [[nodiscard]] bool kept() const { return kept_; }

  /// Of the next cycle.
  void request(skinctl::CycleRequest asked) { input_.request = asked; }
  [[nodiscard]] const std::vector<Done>& done() const { return done_; }
  [[nodiscard]] const std::vector<Judged>& judged() const { return judged_; }
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
  /// Whether that step is about a full box, and no orange.
  [[nodiscard]] bool is_about_box() const { return now_at().role == full_box_class; }
  /// Whether a full box is to be put away: one that is believed to be full, and is not yet where a person fetches it.
  [[nodiscard]] bool sees_full_box() const;
  /// A box is full, and empty, once some pictures in a row have shown it.
  void count_oranges_in_box();
  /// Where at the wall of a place, along it, the inner finger has most room beside what lies in the box.
  [[nodiscard]] skinctl::Xyz<double> place_at_wall(std::uint8_t place) const;
  /// The hand points down, and its fingers move across the walls on both arms' sides.
  [[nodiscard]] skinctl::Rotation<double> across_wall() const;
  /// The parts of a step that is about a full box.
  void begin_at_box(const skinctl::StepRequest& r);
  /// Class of the landmark of that step's place; 0: none.
  [[nodiscard]] skinctl::ObjectClass mark() const {
    return now_at().place == skinctl::no_place ? skinctl::ObjectClass(0)
                                               : executor_.task().places[now_at().place].mark;
  }
  /// Whether the step is about an orange that lies in the feed.
  [[nodiscard]] bool is_at_feed() const;
  [[nodiscard]] bool is_near_box(const skinctl::Xyz<double>& p) const;
  /// Whether the step is a drive.
  [[nodiscard]] bool is_drive() const { return does(DriveToOranges::rule, DriveToBox::rule); }
  [[nodiscard]] std::size_t drives_to() const { return does(DriveToBox::rule) ? 1 : 0; }
  /// Whether a thing of this class there is its to take, or to use its tool on.
  [[nodiscard]] bool is_its(const skinctl::Xyz<double>& p, skinctl::ObjectClass kind = orange_class) const;
  /// Whether the step looks for the thing on which a tool is used, or brings the tool there.
  [[nodiscard]] bool is_at_thing() const {
    return uses_tool_ && mark() == orange_class &&
           does(skinctl::activity::Find::rule, skinctl::activity::Carry::rule);
  }
  /// The believed place of that thing, while it is seen; and whether it was, or a hand hides it.
  void follow_thing();
  [[nodiscard]] bool has_seen_thing(skinctl::Nanoseconds within) const;
  /// The hand's place about what it takes, as it was shown; but across its fingers over the middle, where
  /// they close.
  void stand_beside(std::uint8_t place);
  /// The corners of the way in which the tool is used, at the place of the step.
  void begin_use(std::uint8_t place);
  /// Where its hand waits: over the oranges before it, as high as it carries.
  [[nodiscard]] skinctl::Xyz<double> waiting_place() const;
  /// Box and bins, from the robot's middle.
  [[nodiscard]] Trays trays_before_it() const;
  /// The number of the tray at which the step puts; what it is about is no orange.
  [[nodiscard]] std::size_t tray_number() const { return mark() == bin_class ? 1 + arm_ : 0; }
  /// Walls are where box and bins are believed to be; with others the arm's cycle is built anew.
  void keep_clear_of_trays();
  /// Whether the tray of the present step was seen so lately; what the hand hides is where it was.
  [[nodiscard]] bool has_seen_tray(skinctl::Nanoseconds within) const;
  using Goal = typename Scene::Goal;
  struct Part {
    Goal request;
    bool moves = false;
    skinctl::Xyz<double> to{0, 0, 0};
    double slowest = 0;   ///< it takes at least so long [s]
    bool judges = false;  ///< it is a squeeze
    double most = 1e9;    ///< force of a finger at which it has ended, at most [N]
    double until = 1e9;   ///< it presses until the wrist feels so much [N]
  };

  [[nodiscard]] skinctl::Observed seen() const;
  /// The log of the steps.
  void note(const typename Executor::Memory& was, const typename Executor::Memory& is,
            const skinctl::StepRequest&);

  /// What a take, or fingers that came down on something, tell of the place. A person is asked when camera or
  /// hand are at fault; that a place is empty is no failure that somebody is asked for.
  void learn(const typename Executor::Memory& was, bool resume);
  /// Where the camera may be off, what was just taken is set down and looked at, see `Believed::set_down`.
  void set_down_in_doubt(const typename Executor::Memory& was);

  /// Every plan ends: ways back are counted until an orange is put, see `WorkSettings::in_vain`.
  void count_ways_back(const typename Executor::Memory& was);

  void perform(const skinctl::StepRequest& r);
  /// Whether the hand can go straight down to `p`: open fingers that come from the side knock over what they are to hold.
  [[nodiscard]] bool is_over(const skinctl::Xyz<double>& p) const {
    return std::hypot(X_WH_.origin().x - p.x, X_WH_.origin().y - p.y) < 0.05;
  }
  /// Whether it is on its way to a place in box or bin.
  [[nodiscard]] bool goes_to_tray() const {
    return (does(skinctl::activity::Put::rule) || is_at_thing()) && plan_.phase == Executor::Phase::run &&
           mark() != 0 && !is_about_box();
  }
  /// Whether it goes down there, or is about to.
  [[nodiscard]] bool lowers_in_tray() const {
    return goes_to_tray() && part_ < parts_.size() && parts_[part_].to.z < s_.carry;
  }
  /// Whether an orange is believed to lie in its way down: it was seen late, or has moved.
  [[nodiscard]] bool something_lies_there() const;
  /// Whether its orange has come down on something: it lets go there, and no lower.
  [[nodiscard]] bool has_come_down_in_tray() const;
  void end(bool well);
  /// While something unknown is near, the arm gives way with all joints and what is in the hand. No goal holds it: a law's
  /// plan waits while the skin pushes against it. Then it returns by way of the last joints at which its hand was high, and
  /// goes on with its part. Whether this cycle is taken by that.
  bool gives_way(const skinctl::JointPosition<6>& q);
  /// Whether it had nothing to do, or was on its way from one place above all to another one.
  [[nodiscard]] bool goes_on_from_anywhere() const;
  /// Fingers that press harder than they hold stand on something: the hand goes no lower there, whoever pushes the arm,
  /// until nobody does.
  void stands_on_something();
  /// Middles of the oranges that lie, for an arm that gives way: not what it holds or has between its fingers.
  [[nodiscard]] std::size_t lying(std::array<skinctl::Xyz<double>, Objects::capacity>& out) const;
  /// Where an arm that gave way is on its way back.
  enum class WayBack : unsigned char { none, up, joints, over, down };
  static WayBack next(WayBack w) {
    return w == WayBack::down ? WayBack::none : static_cast<WayBack>(static_cast<unsigned char>(w) + 1);
  }
  void send(Goal g);
  /// The other arm is in the way, and this one in its: back towards its own base for a while, then the same part again.
  void go_aside(const Goal& request);
  /// A part's request, to the cycle.
  void ask(Part& part);

  /// The part that moves the hand; adds it; and lets the last part bring this goal of the gripper.
  [[nodiscard]] static Part move(std::uint8_t skill, const skinctl::Xyz<double>& to, double near);
  void add(std::uint8_t skill, const skinctl::Xyz<double>& to, double near) {
    parts_.push_back(move(skill, to, near));
  }
  void grip(const skinctl::GripperGoal& goal);
  /// As it is carried until it is squeezed.
  void hold_lightly();
  /// The skill that does an activity with this gripper.
  [[nodiscard]] std::uint8_t skill_of(const skinctl::ActivityRule* does) const {
    return s_.presses ? A::binary_skills(does) : A::skills(does);
  }
  /// The part that presses down with a force, until so much is felt.
  [[nodiscard]] Part press(Part part, double force, double until) const;
  /// A press that somebody pushes tells nothing: back, just above where it stood, down until it stands, and once more.
  void press_again();
  /// Squeezes; where it is carried on from there, what was squeezed is held as on the way.
  void add_squeeze(std::uint8_t skill);
  [[nodiscard]] skinctl::Xyz<double> at(const skinctl::Xyz<double>& p, double z) const {
    return {p.x, p.y, z};
  }

  /// The way of an activity: the parts that the robot does one after the other.
  void begin(const skinctl::StepRequest& r);
  /// Where the hand stands at a place of the plan, not of an orange, in the World. The world of a lesson is the
  /// base of the arm that was led: so far in front of its own base this arm goes. In box and bins it lets go
  /// `aside` of the place.
  [[nodiscard]] skinctl::Xyz<double> hand_at(std::uint8_t place) const;
  /// Way of the fingers where it lets go.
  [[nodiscard]] skinctl::Xyz<double> fingers_along() const { return R_ * skinctl::Xyz<double>{0, 1, 0}; }
  /// The hand is turned from how it points down as it was turned in the lesson from how it took.
  [[nodiscard]] skinctl::Rotation<double> turned_at(std::uint8_t place) const;
  [[nodiscard]] skinctl::Rotation<double> turned(double angle) const;
  [[nodiscard]] FingerRoom room_beside(std::uint8_t orange) const;

  /// An orange of its own that is well seen; the one nearest to the hand.
  void look();
  /// Whether the squeeze told something.
  bool judge();

  std::size_t arm_;
  WorkSettings s_;
  bool uses_tool_;
  Believed::FoundThing thing_;                  ///< on which a tool is used
  skinctl::Xyz<double> taken_beside_{0, 0, 0};  ///< the hand from where it was shown, about what it took [m]
  Trays walls_at_;                              ///< from the robot's middle
  std::unique_ptr<const Scene> scene_;          ///< of walls where `walls_at_` says
  Believed::FoundTrays found_;
  skinctl::Xyz<double> goes_to_{0, 0, 0};  ///< place in box or bin to which the present step goes
  skinctl::Xyz<double> spot_{0, 0, 0};     ///< place in box or bin, from its middle, where there is room
  Executor executor_;
  Grip grip_;
  skinctl::Squeeze<> squeeze_;
  Pressing press_;
  Objects objects_;
  skinctl::FeatureExtractor<> extractor_;
  typename Objects::Memory known_;
  Believed believed_;
  skinctl::FeatureExtractor<>::Memory featured_{};
  skinctl::Features features_{};
  skinctl::Squeeze<>::Memory squeezed_{};
  std::size_t table_ = 0;  ///< before the robot; `Carriage::nowhere`: it drives
  skinctl::Transform<skinctl::World, skinctl::Base> X_WR_, X_WB_;  ///< the robot; its own base
  skinctl::Transform<skinctl::World, skinctl::Tool> X_WH_;
  skinctl::Rotation<double> R_;         ///< of the hand: it points down, or as it was shown
  skinctl::Rotation<double> straight_;  ///< it points down, turned as at first ...
  double turned_ = 0;                   ///< ... and so about the vertical over the orange that it takes [rad]
  skinctl::Xyz<double> beside_{0, 0, 0};   ///< the hand's place beside an orange that it takes
  skinctl::Xyz<double> between_{0, 0, 0};  ///< where its fingers hold something, in the hand's frame
  bool feels_between_ = false;
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
  bool other_is_out_ = false;
  bool empty_ = false, stood_ = false;  ///< the take failed; a finger stood on something on the way to it
  RightOfWay way_;
  WayBack way_back_ = WayBack::none;
  bool gives_way_ = false, displaced_ = false;
  bool granted_ = false, box_is_full_ = false;
  int since_full_ = 0;  ///< pictures in a row that say something else than `box_is_full_`
  int gave_way_ = 0, set_right_ = 0, tries_ = 0, in_vain_ = 0;
  bool asked_in_vain_ = false;
  skinctl::JointPosition<6> high_ = A::home();
  skinctl::Xyz<double> from_{0, 0, 0}, other_hand_{0, 0, 9};
  skinctl::Xyz<double> stands_at_{0, 0, 0};  ///< place of the hand where what it holds is set down
  skinctl::Nanoseconds pushed_last_{-1s};    ///< when somebody pushed its skin last
  std::optional<double> stands_at_most_;     ///< height below which its fingers stand on something [m]
  skinctl::Nanoseconds stands_since_{-1s};   ///< when they were felt to stand on it last
  skinctl::Nanoseconds seen_at_{-1s}, pressed_at_{-1s}, return_by_{}, given_way_{};
  std::uint8_t object_ = 0;
  skinctl::Xyz<double> taken_{0, 0, 0.04};
  skinctl::Nanoseconds now_{}, last_picture_{}, looks_since_{};
  std::vector<Done> done_;
  std::vector<Judged> judged_;
};

}  // namespace packing

#include "examples/packing_oranges/worker_cycle.hpp"
#include "examples/packing_oranges/worker_drives.hpp"
#include "examples/packing_oranges/worker_gives_way.hpp"
#include "examples/packing_oranges/worker_looks.hpp"
#include "examples/packing_oranges/worker_moves_box.hpp"
#include "examples/packing_oranges/worker_requests.hpp"
#include "examples/packing_oranges/worker_steps.hpp"
#include "examples/packing_oranges/worker_uses_tool.hpp"
