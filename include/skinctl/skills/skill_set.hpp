// SPDX-License-Identifier: BSD-3-Clause
// All skills of a robot as one law: the active one is chosen while it runs, with bumpless transfer.
#pragma once

#include "skinctl/skills/detail/skill_loop.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A set of skills, made by `skill_set(library, controllers...)`. It is a law like any other: a `Cycle` runs,
/// records and replays it, and `Input::goal` brings its requests.
///
/// - Its controllers are one blended sum; a skill is a row of weights. So another skill costs one row, a
///   controller is computed only while a skill gives it a weight, and gravity is compensated once and whole
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
/// - With a gripper (`OneGripper`) requests may bring it a goal, and `Input::gripper` its state: a skill can
///   wait until it holds something.
///
/// @tparam Names  `Behaviours<...>`: the compile-time names of the skills, in the order of their indices.
template <class Names, class Fusion, class Grip = NoGripper>
class SkillSet;
template <class... Behaviour>
struct Behaviours {
  static constexpr std::size_t count = sizeof...(Behaviour);
  /// Index of the behaviour `B`; `count` if it is none of them.
  template <class B>
  static constexpr std::size_t index = [] {
    constexpr bool found[] = {std::is_same_v<B, Behaviour>...};
    std::size_t i = 0;
    while (i < count && !found[i]) ++i;
    return i;
  }();
};

template <class... Behaviour, Sum P, class... L, class Grip>
class SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>
    : public detail::SkillLoop<Behaviours<Behaviour...>, Grip, P, L...> {
  using Loop = detail::SkillLoop<Behaviours<Behaviour...>, Grip, P, L...>;
  using Loop::blend_;
  using Loop::run;
  using Loop::settings_;
  using Loop::skills_;
  using Loop::skin;
  using Loop::step;

 public:
  using Names = Behaviours<Behaviour...>;
  using Fusion = Fused<P, L...>;
  static constexpr std::size_t joints = Loop::joints;
  static constexpr bool has_gripper = Loop::has_gripper;
  static constexpr std::size_t controllers = Loop::controllers;
  static constexpr std::size_t skills = Loop::skills;
  using Goal = typename Loop::Goal;
  using Memory = typename Loop::Memory;

  /// @param rows  the first is the initial skill and the fallback. Throws `ConfigurationError` for numbers
  ///              out of their range.
  SkillSet(const Fusion& sum, const std::array<Skill<controllers>, skills>& rows,
           const SkillSettings& settings = {}, const Grip& gripper = {})
      : Loop(sum, rows, settings, gripper) {}
  using Loop::skill;
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
  [[nodiscard]] const Skill<controllers>& active(const Memory& m) const noexcept { return skills_[m.skill]; }
  /// The commanded values of the discrete controls.
  [[nodiscard]] static const SkillSwitches& commanded(const Memory& m) noexcept { return m.commanded; }

  /// The report on the request with this number. One that nothing is known of (not received, waiting for the
  /// end of a change, replaced by a later one) gives a report with the number 0.
  ///
  /// The numbers of a sequence of skills and of a fallback are those of the request that began them: a
  /// failure stays reported, with its reason, while the fallback runs, until another request begins.
  [[nodiscard]] static SkillReport report_of(const Memory& m, std::uint16_t ticket) noexcept {
    if (ticket == 0) return {};
    if (m.told.ticket == ticket) return m.told;
    return m.refused.ticket == ticket ? m.refused : SkillReport{};
  }

  /// The input that skills read before each evaluation: the contacts of a touch that finds them, and the
  /// gripper's state.
  using Input = detail::Together<std::conditional_t<has_gripper, GripperInput, NothingAdded>,
                                 typename Loop::Blend::Input>;
  using Output = detail::Together<std::conditional_t<has_gripper, GripperOutput, NothingAdded>,
                                  typename Loop::Blend::Output>;
  template <class In, class Seen>
  SKINCTL_INLINE Status see(Memory& m, const In& input, const Seen& seen) const noexcept {
    if constexpr (Seen::finds_contacts)
      m.touched = skills_[m.skill].conditions.touch.holds(seen.contacts(), seen.now);
    if constexpr (has_gripper) Grip::hear(m.gripper, input.gripper, seen.now);
    return blend_.see(m.blend, input, seen);
  }
  [[nodiscard]] Output output(const Memory& m) const noexcept {
    Output out{};
    if constexpr (!std::is_empty_v<typename Loop::Blend::Output>)
      static_cast<typename Loop::Blend::Output&>(out) = blend_.output(m.blend);
    if constexpr (has_gripper) out.gripper = Grip::command(m.gripper);
    return out;
  }

  /// Whether a skill waits for contacts: its scene then needs a skin that has them.
  [[nodiscard]] bool needs_contacts() const noexcept {
    bool waits = blend_.needs_contacts();
    for (const auto& s : skills_)
      waits = waits || s.conditions.finish == SkillFinish::touched ||
              s.conditions.finish == SkillFinish::released;
    return waits;
  }

  // Requests, for `Input::goal` or `receive`.
  /// A request to start the skill of a behaviour, with or without goals for its controllers.
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
  /// A request with other goals for the controllers of the active skill.
  template <class... G>
  [[nodiscard]] static Goal goal(const G&... goals) noexcept {
    Goal out;
    ((out.goals.template of<G>().has = true, out.goals.template of<G>().goal = goals), ...);
    return out;
  }
  /// A request that reports the switches.
  [[nodiscard]] static Goal report(const SkillSwitches& reported) noexcept {
    Goal out;
    out.kind = static_cast<unsigned char>(Goal::Kind::report);
    out.reported = reported;
    return out;
  }

  /// The memory in which the first skill begins, at the known state.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory start(const K& known) const noexcept {
    Memory m{};
    m.blend = blend_.start(known);
    m.commanded = skills_[0].switches;
    const auto e = run(m.blend, known, known.dt(), Opposition::none);
    if constexpr (joints > 0) m.bound.follow(e.torque - skin(e.shares), {}, {}, settings_.max_rate);
    return m;
  }

  /// The memory after a stop: the active skill goes on from where the robot is.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory resumed(const Memory& memory, const K& known) const noexcept {
    Memory m = memory;
    m.blend = blend_.resumed(m.blend, known);
    return m;
  }
  /// Takes a request: see `SkillRequest`.
  using Loop::receive;

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
};

SKINCTL_END_NAMESPACE
