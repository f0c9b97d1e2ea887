// SPDX-License-Identifier: BSD-3-Clause
// The parts of a set of skills, its memory, and its numbers.
#pragma once

#include "skinctl/fusion/blended.hpp"
#include "skinctl/skills/detail/rate_bound.hpp"
#include "skinctl/skills/one_gripper.hpp"
#include "skinctl/skills/skill_request.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of the change between skills.
struct SkillSettings {
  Nanoseconds bumpless_transfer = 100ms;  ///< shortest time of a change of torque to the next skill
  Nanoseconds longest = 2s;               ///< longest time of such a change, for large differences of torque
  /// Largest rate of every joint's torque during a transfer [N m/s]. A transfer takes 1.9 times its largest
  /// difference of torque over this rate, up to `longest`, and a request meanwhile waits for its end: a skill
  /// that has to answer at once needs a higher rate.
  double max_rate = 1000;
  double touched = 1;               ///< the skin's joint torque from which the robot counts as touched [N m]
  OppositionSettings opposition{};  ///< numbers by which skin and tracking count as opposed
};

namespace detail {

/// The configuration of a `SkillSet`.
template <class Names, class Grip, Sum P, class... L>
class SkillParts {
 public:
  using Fusion = Fused<P, L...>;
  using Laws = std::tuple<L...>;
  using Blend = Blended<Fusion>;
  static constexpr bool has_gripper = !std::is_same_v<Grip, NoGripper>;
  using Goal = typename GoalTypes<std::conditional_t<has_gripper, SkillRequest<GripperGoal>, SkillRequest<>>,
                                  L...>::type;
  static constexpr std::size_t controllers = Fusion::terms;
  static constexpr std::size_t terms = controllers + 1;  ///< with the carried difference
  static constexpr auto roles = LawTable<Fusion>::roles_with_carried;
  static constexpr std::size_t skills = Names::count;
  static constexpr Needs needs = Blend::needs;
  static constexpr LawRole role = Fusion::role;
  static constexpr const char* name = "skills";
  static constexpr bool complete_sum = true;
  static constexpr std::size_t gravity_laws = Fusion::gravity_laws;
  static constexpr bool compensates_friction = Fusion::compensates_friction;
  static_assert(Fusion::gravity_laws == 1, "a set of skills holds gravity: give it a gravity controller");
  static_assert(skills > 0 && skills < 256);
  static constexpr std::size_t joints = joints_of_laws<L...>();
  static_assert(joints > 0 || Fusion::tracking_laws == 0,
                "a tracking controller says for how many joints it is: static constexpr std::size_t joints");

  struct Memory {
    typename Blend::Memory blend;
    RateBound<joints> bound;
    Goal request;  ///< accepted request: its goals serve the skills of a sequence
    Goal waiting;  ///< request that waits for the end of a change
    SkillSwitches commanded, reported;
    std::uint32_t reporting = 0;  ///< switches that have ever been reported
    double touch = 0;             ///< norm of the last torque of the skin's laws [N m]
    Nanoseconds since{};          ///< time since the skill began
    Nanoseconds held{};           ///< time for which its finish condition has held
    std::uint8_t skill = 0;
    SkillPhase phase = SkillPhase::loading;
    [[no_unique_address]] typename Grip::Memory gripper;
    SkillReport told;      ///< report on the request that the skill, or the one that failed last, serves
    SkillReport refused;   ///< report on the last request that was refused
    bool waits = false;    ///< a request waits for the end of a change
    bool goes_on = false;  ///< the waiting request is the next skill of a sequence, or the fallback
    bool touched = false, was_touched = false;  ///< contact as of `touch`: now, since the skill began to run
  };

  [[nodiscard]] const Fusion& sum() const noexcept { return blend_.sum(); }
  template <class Terms>
  void check_for(const Terms& robot) const {
    blend_.check_for(robot);
  }
  [[nodiscard]] const Skill<controllers>& skill(std::size_t i) const noexcept { return skills_[i]; }

 protected:
  template <std::size_t Ix>
  using law_at = std::tuple_element_t<Ix, std::tuple<L...>>;

  SkillParts(const Fusion& sum, const std::array<Skill<controllers>, skills>& rows,
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

  [[nodiscard]] bool may_start(const Memory& m, const Skill<controllers>& s) const noexcept {
    if (s.conditions.untouched && !(m.touch <= settings_.touched)) return false;
    return m.commanded.then(m.reported).stand(s.conditions.needs);
  }
  /// Calls `f(index, goal)` for each controller with a weight in a skill for which the request has a goal.
  template <class F>
  void each_goal(const Goal& request, std::uint8_t skill, F&& f) const noexcept {
    each_index<controllers>([&](auto i) {
      if constexpr (LawTable<law_at<i.value>>::takes_goals) {
        const auto& part = request.goals.template of<typename law_at<i.value>::Goal>();
        if (part.has && skills_[skill].weights[i.value] > 0) f(i, part.goal);
      }
    });
  }
  // One function for the loop and for requests: it is the largest part of the code.
  template <class K>
  [[nodiscard]] SKINCTL_NOINLINE auto run(const typename Blend::Memory& m, const K& known,
                                          const typename K::scalar& dt,
                                          Opposition opposition) const noexcept {
    return blend_.evaluate(m, known, dt, opposition);
  }
  template <class Torque>
  [[nodiscard]] static auto largest(const Torque& tau) noexcept {
    auto most = magnitude(tau[0]);
    for (const auto& x : tau)
      if (magnitude(x) > most) most = magnitude(x);
    return most;
  }
  /// The sum of the torques of the skin's laws [N m].
  template <class Shares>
  [[nodiscard]] static SKINCTL_INLINE auto skin(const Shares& shares) noexcept {
    std::remove_cvref_t<decltype(shares[0])> sum;
    each_index<controllers>([&](auto i) {
      if constexpr (LawTable<law_at<i.value>>::answers_touch) sum += shares[i.value];
    });
    return sum;
  }

  Blend blend_;
  std::array<Skill<controllers>, skills> skills_;
  SkillSettings settings_;
  [[no_unique_address]] Grip gripper_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
