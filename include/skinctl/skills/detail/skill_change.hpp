// SPDX-License-Identifier: BSD-3-Clause
// How a skill begins: requests, their goals, the change of the weights.
#pragma once

#include "skinctl/skills/detail/skill_parts.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The changes of skill in a `SkillSet`.
template <class Names, class Grip, Sum P, class... L>
class SkillChange : public SkillParts<Names, Grip, P, L...> {
  using Parts = SkillParts<Names, Grip, P, L...>;

 public:
  static constexpr bool has_gripper = Parts::has_gripper;
  static constexpr std::size_t controllers = Parts::controllers;
  static constexpr std::size_t skills = Parts::skills;
  using Blend = typename Parts::Blend;
  using Goal = typename Parts::Goal;
  using Memory = typename Parts::Memory;

  /// Carries out a request, lets it wait, or refuses it.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> receive(const Memory& memory, const K& known,
                                                      const Goal& request) const noexcept {
    using Kind = typename Goal::Kind;
    Received<Memory> out{memory, {}};
    const auto refused = [&](Reason reason, SkillFailure failure) {
      out = {memory, reason};
      if (request.ticket != 0) out.memory.refused = {request.ticket, SkillPhase::failed, failure};
      return out;
    };
    if (request.kind == static_cast<unsigned char>(Kind::report)) {
      out.memory.reported = out.memory.reported.then(request.reported);
      out.memory.reporting |= request.reported.which;
      return out;
    }
    if (request.kind == static_cast<unsigned char>(Kind::goal)) {
      if (!fits(memory, known, request, memory.skill, out.status))
        return refused(Reason::goal_refused, SkillFailure::goal);
      deliver(out.memory, known, request, out.status);
      ask_gripper(out.memory, request, memory.skill, false);
      out.memory.request.tolerance = request.tolerance;
      out.memory.held = 0ns;
      if (memory.phase == SkillPhase::finished) out.memory.phase = SkillPhase::running;
      if (request.ticket != 0) out.memory.told = {request.ticket, out.memory.phase, SkillFailure::none};
      return out;
    }
    if (request.kind != static_cast<unsigned char>(Kind::start) || request.skill >= skills)
      return refused(Reason::goal_refused, SkillFailure::goal);
    if (!may_start(memory, skills_[request.skill]))
      return refused(Reason::skill_refused, SkillFailure::conditions);
    if (!Blend::moves(memory.blend)) {
      if (memory.phase == SkillPhase::loading) out.status |= arrive(out.memory, known);
      auto change = begun(out.memory, known, request);
      change.status |= out.status;
      return change;
    }
    out.memory.waiting = request;
    out.memory.waits = true;
    out.memory.goes_on = false;
    return out;
  }

 protected:
  using Parts::blend_;
  using Parts::each_goal;
  using Parts::gripper_;
  using Parts::largest;
  using Parts::may_start;
  using Parts::run;
  using Parts::settings_;
  using Parts::SkillParts;
  using Parts::skills_;
  using Parts::skin;

  /// Gives the newly loaded controllers their goals.
  template <class K>
  SKINCTL_COLD Status arrive(Memory& m, const K& known) const noexcept {
    Status status;
    m.phase = SkillPhase::running;
    if (m.told.phase == SkillPhase::loading) m.told.phase = SkillPhase::running;
    deliver(m, known, m.request, status, true);
    return status;
  }
  /// The memory in which the change to the requested skill has begun, or its goal is refused.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> begun(const Memory& memory, const K& known,
                                                    const Goal& request) const noexcept {
    Received<Memory> out{memory, {}};
    Memory& m = out.memory;
    m.waits = false;
    const bool goes_on = m.goes_on;
    m.goes_on = false;
    bool any = false;
    each_goal(request, request.skill, [&](auto, const auto&) { any = true; });
    if constexpr (has_gripper) any = any || request.goals.template of<GripperGoal>().has;
    if (any && !fits(m, known, request, request.skill, out.status)) {
      if (goes_on)
        m.told = {m.told.ticket, SkillPhase::failed, SkillFailure::goal};
      else if (request.ticket != 0)
        m.refused = {request.ticket, SkillPhase::failed, SkillFailure::goal};
      return out;
    }
    const auto& next = skills_[request.skill];
    m.blend = blend_.change(m.blend, known, BlendWeights<controllers>{next.weights}).memory;
    stretch(m.blend, known);
    m.skill = request.skill;
    m.request = request;
    deliver(m, known, request, out.status);
    ask_gripper(m, request, request.skill, true);
    m.commanded = m.commanded.then(next.switches);
    // An old report does not count for switches that are only beginning.
    m.reported.which &= ~next.switches.which;
    m.phase = SkillPhase::loading;
    if (!goes_on) m.told = {request.ticket, SkillPhase::loading, SkillFailure::none};
    m.since = m.held = 0ns;
    m.touched = m.was_touched = false;
    return out;
  }

 private:
  /// Whether controllers of a skill accept the request's goals: at least one, and none refuses.
  template <class K>
  [[nodiscard]] SKINCTL_COLD bool fits(const Memory& m, const K& known, const Goal& request,
                                       std::uint8_t skill, Status& status) const noexcept {
    bool taken = false;
    each_goal(request, skill, [&](auto i, const auto& goal) {
      const auto& law = std::get<i.value>(blend_.sum().laws());
      const bool on = Blend::loaded(m.blend, i) && !Blend::comes(m.blend, i);
      status |=
          law.receive(on ? Blend::template memory<i.value>(m.blend) : law.start(known), known, goal).status;
      taken = true;
    });
    if constexpr (has_gripper) {
      const auto& part = request.goals.template of<GripperGoal>();
      taken = taken || part.has;
      if (part.has && !finite(part.goal)) status |= Reason::goal_refused;
    }
    return taken && !status.has(Reason::goal_refused);
  }
  /// Gives the request's goals to the controllers that are loaded; the others get them once they are.
  template <class K>
  SKINCTL_COLD void deliver(Memory& m, const K& known, const Goal& request, Status& status,
                            bool arrived = false) const noexcept {
    each_goal(request, m.skill, [&](auto i, const auto& goal) {
      if (Blend::comes(m.blend, i)) {
        m.request.goals.template of<std::remove_cvref_t<decltype(goal)>>() =
            request.goals.template of<std::remove_cvref_t<decltype(goal)>>();
      } else if (!arrived || Blend::is_new(m.blend, i)) {
        auto& kept = m.request.goals.template of<std::remove_cvref_t<decltype(goal)>>();
        kept.has = true;
        kept.goal = goal;
        const auto answer = blend_.template receive<i.value>(m.blend, known, goal);
        m.blend = answer.memory;
        status |= answer.status;
      }
    });
  }
  /// Makes a change last long enough that along its quintics the torque changes no faster than `max_rate`: to
  /// the torque of the other skill at this state, and then, where the feedback of a tracking law fades in, to
  /// its torque against the skin. The latter changes at up to `1.7 |tau_skin| sqrt(lambda / T)`, with 100 1/s
  /// for lambda.
  template <class K>
  SKINCTL_COLD void stretch(typename Blend::Memory& m, const K& known) const noexcept {
    const auto there = Blend::arrived(m);
    const auto from = run(m, known, known.dt(), Opposition::none);
    const auto to = run(there, known, known.dt(), Opposition::none);
    const auto seconds_for = [&](const auto& way) {
      return static_cast<double>(largest(way)) / settings_.max_rate;
    };
    const double push = 1.7 * seconds_for(skin(to.shares));
    Blend::set_times(m, within(quintic_peak_speed<double> * seconds_for(to.torque - from.torque)),
                     within(100 * push * push));
  }
  [[nodiscard]] Nanoseconds within(double time) const noexcept {
    const Nanoseconds asked = time < 1e6 ? nanoseconds(time) : settings_.longest;
    return asked > settings_.longest             ? settings_.longest
           : asked > settings_.bumpless_transfer ? asked
                                                 : settings_.bumpless_transfer;
  }
  /// Gives the goal of a request, or else that of its skill, to the gripper.
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
};

}  // namespace detail
SKINCTL_END_NAMESPACE
