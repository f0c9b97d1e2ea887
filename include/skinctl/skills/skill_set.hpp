// All skills of a robot as one law: the active one is chosen while it runs, with bumpless transfer.
#pragma once

#include <cmath>

#include "skinctl/fusion/blended.hpp"
#include "skinctl/skills/detail/rate_bound.hpp"
#include "skinctl/skills/one_gripper.hpp"
#include "skinctl/skills/skill_request.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of the change between skills.
struct SkillSettings {
  Nanoseconds bumpless_transfer = 100ms;  ///< time in which the torque changes over to the next skill ...
  Nanoseconds longest = 2s;               ///< ... or longer for large changes, up to this
  /// Of every joint's torque during a transfer [N m/s]. A transfer takes 1.9 times its largest difference of torque over this
  /// rate, up to `longest`, and what is asked for meanwhile waits for its end: a skill that has to answer at once needs a
  /// higher rate.
  double max_rate = 1000;
  double touched = 1;               ///< the skin's joint torque from which the robot counts as touched [N m]
  OppositionSettings opposition{};  ///< when skin and tracking count as opposed
};

/// A set of skills, made by `skill_set(library, controllers...)`. It is a law like any other: a `Cycle` runs,
/// records and replays it, and `Input::goal` brings its requests.
///
/// - Its controllers are one blended sum; a skill is a row of weights. So another skill costs one row, a
///   controller is computed only while a skill loads it, and gravity is compensated once and whole
///   throughout.
/// - A change moves the shares by a quintic. New controllers start at the present state with share zero, kept
///   ones go on: torque and rate are continuous. The time is as configured, and longer where the change would
///   move the torque faster than `max_rate`.
/// - During a transfer (a change of skill, a controller with a new goal or pushed by the skin) no joint's
///   torque changes faster than `max_rate`, whatever the controllers compute, apart from the skin's own
///   torque: a touch is answered at once. The remaining difference is carried on until it is made up, and is
///   the last share.
/// - A request during a change waits for its end; of several the last counts.
/// - A finished skill holds, or goes on to its `next`; a failed one falls back to the first of the set.
///
/// - With a gripper (`OneGripper`) requests may bring it a goal, and `Input::gripper` its state: a skill can wait
///   until it holds something.
///
/// @tparam Names  `Behaviours<...>`: the compile-time names of the skills, in the order of their indices.
template <class Names, class Fusion, class Grip = NoGripper>
class SkillSet;
template <class... Behaviour>
struct Behaviours {
  static constexpr std::size_t count = sizeof...(Behaviour);
  /// `count` if it is none of them.
  template <class B>
  static constexpr std::size_t index = [] {
    constexpr bool found[] = {std::is_same_v<B, Behaviour>...};
    std::size_t i = 0;
    while (i < count && !found[i]) ++i;
    return i;
  }();
};

template <class... Behaviour, Sum P, class... L, class Grip>
class SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip> {
 public:
  using Names = Behaviours<Behaviour...>;
  using Fusion = Fused<P, L...>;
  using Laws = std::tuple<L...>;
  using Blend = Blended<Fusion>;
  static constexpr bool has_gripper = !std::is_same_v<Grip, NoGripper>;
  using Goal =
      typename detail::GoalTypes<std::conditional_t<has_gripper, SkillRequest<GripperGoal>, SkillRequest<>>,
                                 L...>::type;
  static constexpr std::size_t controllers = Fusion::terms;
  static constexpr std::size_t terms = controllers + 1;  ///< with the carried difference
  static constexpr auto roles = detail::roles_with_carried<Fusion>;
  static constexpr std::size_t skills = Names::count;
  static constexpr Needs needs = Blend::needs;
  static constexpr LawRole role = Fusion::role;
  static constexpr const char* name = "skills";
  static constexpr bool complete_sum = true;
  static constexpr bool compensates_friction = Fusion::compensates_friction;
  static_assert(Fusion::gravity_laws == 1, "a set of skills holds gravity: give it a gravity controller");
  static_assert(skills > 0 && skills < 256);
  static constexpr std::size_t joints = detail::joints_of_laws<L...>();
  static_assert(joints > 0 || Fusion::tracking_laws == 0,
                "a tracking controller says for how many joints it is: static constexpr std::size_t joints");

  struct Memory {
    typename Blend::Memory blend;
    detail::RateBound<joints> bound;
    Goal request;  ///< the accepted one: its goals serve the skills of a sequence
    Goal waiting;  ///< waits for the end of a change
    SkillSwitches commanded, reported;
    std::uint32_t reporting = 0;  ///< switches that have ever been reported
    double touch = 0;             ///< norm of the last torque of the skin's laws [N m]
    Nanoseconds since{};          ///< the skill's start
    Nanoseconds held{};           ///< how long its finish condition has held
    std::uint8_t skill = 0;
    SkillPhase phase = SkillPhase::loading;
    [[no_unique_address]] typename Grip::Memory gripper;
    SkillReport told;      ///< of the request that the skill, or the one that failed last, serves
    SkillReport refused;   ///< of the last request that was refused
    bool waits = false;    ///< for the end of a change
    bool goes_on = false;  ///< what waits is the next skill of a sequence, or the fallback
    bool touched = false, was_touched = false;  ///< as the skill's `touch` says; and since it began to run
  };

  /// @param rows  the first is the initial skill and the fallback. Throws `ConfigurationError` for numbers
  ///              out of their range.
  SkillSet(const Fusion& sum, const std::array<Skill<controllers>, skills>& rows,
           const SkillSettings& settings = {}, const Grip& gripper = {})
      : blend_(sum.opposed_by(settings.opposition), rows[0].weights,
               BlendSettings{settings.bumpless_transfer, {}}),
        skills_(rows),
        settings_(settings),
        gripper_(gripper) {
    require(settings.max_rate > 0 && settings.max_rate <= 1e9, "max_rate", settings.max_rate, "> 0 N m/s");
    require(settings.longest >= settings.bumpless_transfer, "longest", seconds<double>(settings.longest),
            ">= bumpless_transfer, in s");
    for (const auto& s : rows) {
      const auto& c = s.conditions;
      require(s.next < skills, "next", s.next, "the index of a skill");
      require(c.hold >= 0ns && c.timeout >= 0ns, "hold or timeout",
              seconds<double>(c.hold < c.timeout ? c.hold : c.timeout), ">= 0 s");
      require(c.still > 0 && c.still <= 1e3, "still", c.still, "> 0 rad/s");
      require(c.touch.force >= 0 && c.touch.force <= 1e6 && c.touch.lasts >= 0ns, "touch: force",
              c.touch.force, "0 to 1e6 N, for at least 0 s");
      require(c.tolerance.position >= 0 && c.tolerance.orientation >= 0 && c.tolerance.joint >= 0,
              "tolerance", -1, ">= 0 m or rad");
      require(!s.grips || (has_gripper && finite(s.grip)), "goal of a gripper", s.grip.opening,
              "finite, in a set with a gripper");
      require(has_gripper || (c.finish != SkillFinish::gripped && c.finish != SkillFinish::opened),
              "skills that wait for a gripper", 1, "in a set with a gripper");
      require(c.max_touch >= 0 && c.max_touch <= 1e9, "max_touch", c.max_touch, ">= 0 N m");
      for (std::size_t i = 0; i < controllers; ++i)
        require(Fusion::roles[i] == LawRole::gravity ? s.weights[i] == 1
                                                     : s.weights[i] >= 0 && s.weights[i] <= 1e6,
                "weight of a controller", s.weights[i], "0 to 1e6, and 1 for gravity");
    }
    require(rows[0].conditions.timeout == 0ns && rows[0].conditions.max_touch == 0,
            "failure of the first skill", 1, "none: others fall back to it");
  }
  [[nodiscard]] const Fusion& sum() const noexcept { return blend_.sum(); }
  template <class Terms>
  void check_for(const Terms& robot) const {
    blend_.check_for(robot);
  }
  [[nodiscard]] const Skill<controllers>& skill(std::size_t i) const noexcept { return skills_[i]; }
  template <class B>
  [[nodiscard]] const Skill<controllers>& skill() const noexcept {
    return skills_[index<B>()];
  }
  /// The index of a behaviour's skill.
  template <class B>
  [[nodiscard]] static constexpr std::uint8_t index() noexcept {
    constexpr std::size_t i = Names::template index<B>;
    static_assert(i < skills, "no such skill in this set: its recipe or one of its controllers is missing");
    return static_cast<std::uint8_t>(i);
  }
  /// The active skill, or the one to which the torque changes over.
  [[nodiscard]] const Skill<controllers>& now(const Memory& m) const noexcept { return skills_[m.skill]; }
  /// The commanded values of the discrete controls.
  [[nodiscard]] static const SkillSwitches& commanded(const Memory& m) noexcept { return m.commanded; }

  /// What has become of the request with this number. One that nothing is known of (not received, waiting for the end
  /// of a change, replaced by a later one) gives a report with the number 0.
  ///
  /// The numbers of a sequence of skills and of a fallback are those of the request that began them: a failure stays
  /// reported, with its reason, while the fallback runs, until another request begins.
  [[nodiscard]] static SkillReport report_of(const Memory& m, std::uint16_t ticket) noexcept {
    if (ticket == 0) return {};
    if (m.told.ticket == ticket) return m.told;
    return m.refused.ticket == ticket ? m.refused : SkillReport{};
  }

  /// The gripper's state, as a `Cycle` was told it at `now`, before each evaluation.
  void grip(Memory& m, const GripperState& state, Nanoseconds now) const noexcept
    requires has_gripper
  {
    Grip::hear(m.gripper, state, now);
  }
  /// What the gripper is asked for.
  [[nodiscard]] static GripperCommand gripper(const Memory& m) noexcept
    requires has_gripper
  {
    return Grip::command(m.gripper);
  }
  /// The contacts that a skin with contacts feels at `now`: a `Cycle` tells them before each evaluation.
  template <class Contacts>
  void feel(Memory& m, const Contacts& contacts, Nanoseconds now) const noexcept {
    m.touched = skills_[m.skill].conditions.touch.holds(contacts, now);
  }

  /// Whether a skill waits for contacts: its scene then needs a skin that has them.
  [[nodiscard]] bool waits_for_contacts() const noexcept {
    bool waits = false;
    for (const auto& s : skills_)
      waits = waits || s.conditions.finish == SkillFinish::touched ||
              s.conditions.finish == SkillFinish::released;
    return waits;
  }

  // Requests, for `Input::goal` or `receive`.
  /// The skill of a behaviour, with or without goals for its controllers.
  template <class B, class... G>
  [[nodiscard]] static Goal start_skill(const G&... goals) noexcept {
    return start_skill(index<B>(), goals...);
  }
  template <class... G>
  [[nodiscard]] static Goal start_skill(std::uint8_t skill, const G&... goals) noexcept {
    Goal out = goal(goals...);
    out.kind = static_cast<unsigned char>(Goal::Kind::start);
    out.skill = skill;
    return out;
  }
  /// Other goals for the controllers of the active skill.
  template <class... G>
  [[nodiscard]] static Goal goal(const G&... goals) noexcept {
    Goal out;
    ((out.goals.template of<G>().has = true, out.goals.template of<G>().goal = goals), ...);
    return out;
  }
  /// A report of the switches.
  [[nodiscard]] static Goal report(const SkillSwitches& reported) noexcept {
    Goal out;
    out.kind = static_cast<unsigned char>(Goal::Kind::report);
    out.reported = reported;
    return out;
  }

  /// The first skill, at the known state.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory start(const K& known) const noexcept {
    Memory m{};
    m.blend = blend_.start(known);
    m.commanded = skills_[0].switches;
    const auto e = run(m.blend, known, known.dt(), Opposition::none);
    if constexpr (joints > 0) m.bound.follow(e.torque - skin(e.shares), {}, {}, settings_.max_rate);
    return m;
  }

  /// A request, as `SkillRequest` says.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> receive(const Memory& memory, const K& known,
                                                      const Goal& request) const noexcept;

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const Memory& memory, const K& known) const noexcept {
    return step(memory, known, known.dt(), Opposition::none).torque;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known,
                                              const typename K::scalar& dt,
                                              Opposition opposition) const noexcept {
    return step(memory, known, dt, opposition).memory;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE auto evaluate(const Memory& memory, const K& known,
                                             const typename K::scalar& dt) const noexcept {
    return step(memory, known, dt, Opposition::none);
  }

 private:
  template <std::size_t I>
  using law_at = std::tuple_element_t<I, std::tuple<L...>>;

  [[nodiscard]] bool may_start(const Memory& m, const Skill<controllers>& s) const noexcept {
    if (s.conditions.untouched && !(m.touch <= settings_.touched)) return false;
    return m.commanded.then(m.reported).stand(s.conditions.needs);
  }
  /// Calls `f(index, goal)` for each controller of a skill for which the request has a goal.
  template <class F>
  void each_goal(const Goal& request, std::uint8_t skill, F&& f) const noexcept {
    detail::each_index<controllers>([&](auto i) {
      if constexpr (detail::takes_goals<law_at<i.value>>) {
        const auto& part = request.goals.template of<typename law_at<i.value>::Goal>();
        if (part.has && skills_[skill].weights[i.value] > 0) f(i, part.goal);
      }
    });
  }
  template <class K>
  [[nodiscard]] SKINCTL_COLD bool fits(const Memory& m, const K& known, const Goal& request,
                                       std::uint8_t skill, Status& status) const noexcept;
  template <class K>
  SKINCTL_COLD void deliver(Memory& m, const K& known, const Goal& request, Status& status,
                            bool arrived = false) const noexcept;
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> begun(const Memory& memory, const K& known,
                                                    const Goal& request) const noexcept;
  template <class K>
  SKINCTL_COLD void stretch(typename Blend::Memory& m, const K& known) const noexcept;
  template <class Torque, class Shares, class T>
  [[nodiscard]] SKINCTL_COLD Torque bounded(detail::RateBound<joints>& bound,
                                            const typename Blend::Memory& before,
                                            typename Blend::Memory& next, const Torque& own, Shares shares,
                                            const T& most) const noexcept;
  template <class K, class Torque>
  SKINCTL_NOINLINE void supervise(Memory& m, const K& known, const Torque& touched,
                                  Nanoseconds dt) const noexcept;
  /// The goal of a request, or else of its skill, to the gripper.
  void ask_gripper(Memory& m, const Goal& request, std::uint8_t skill, bool starts) const noexcept {
    if constexpr (has_gripper) {
      const auto& part = request.goals.template of<GripperGoal>();
      const auto& own = skills_[skill];
      if (part.has)
        gripper_.ask(m.gripper, part.goal);
      else if (starts && own.grips)
        gripper_.ask(m.gripper, own.grip);
    }
  }
  /// Whether the robot is within the tolerance of each goal of its request that has a distance.
  template <class K>
  [[nodiscard]] SKINCTL_COLD bool near(const Memory& m, const K& known,
                                       const GoalTolerance& t) const noexcept;
  void end(Memory& m, SkillFailure failure, std::uint8_t next) const noexcept;
  [[nodiscard]] Nanoseconds within(double time) const noexcept {
    const Nanoseconds asked = time < 1e6 ? nanoseconds(time) : settings_.longest;
    return asked > settings_.longest             ? settings_.longest
           : asked > settings_.bumpless_transfer ? asked
                                                 : settings_.bumpless_transfer;
  }
  // One function for the loop and for requests: it is the largest part of the code.
  template <class K>
  [[nodiscard]] SKINCTL_NOINLINE auto run(const typename Blend::Memory& m, const K& known,
                                          const typename K::scalar& dt,
                                          Opposition opposition) const noexcept {
    return blend_.evaluate(m, known, dt, opposition);
  }

  /// Gives the newly loaded controllers their goals.
  template <class K>
  SKINCTL_COLD Status arrive(Memory& m, const K& known) const noexcept {
    Status status;
    m.phase = SkillPhase::running;
    if (m.told.phase == SkillPhase::loading) m.told.phase = SkillPhase::running;
    deliver(m, known, m.request, status, true);
    return status;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<K::joints, typename K::scalar, Memory, terms> step(
      const Memory& memory, const K& known, const typename K::scalar& dt, Opposition given) const noexcept;
  template <class Torque>
  [[nodiscard]] static auto largest(const Torque& tau) noexcept {
    auto most = detail::magnitude(tau[0]);
    for (const auto& x : tau)
      if (detail::magnitude(x) > most) most = detail::magnitude(x);
    return most;
  }
  /// The torque of the skin's laws.
  template <class Shares>
  [[nodiscard]] static SKINCTL_INLINE auto skin(const Shares& shares) noexcept {
    std::remove_cvref_t<decltype(shares[0])> sum;
    detail::each_index<controllers>([&](auto i) {
      if constexpr (detail::answers_touch<law_at<i.value>>) sum += shares[i.value];
    });
    return sum;
  }

  Blend blend_;
  std::array<Skill<controllers>, skills> skills_;
  SkillSettings settings_;
  [[no_unique_address]] Grip gripper_;
};

SKINCTL_END_NAMESPACE

#include "skinctl/skills/detail/skill_change.hpp"
