// SPDX-License-Identifier: BSD-3-Clause
// The part of a set of skills that runs in every cycle: the sum, its rate, the phase of the skill.
#pragma once

#include <cmath>

#include "skinctl/skills/detail/skill_change.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The step of a `SkillSet`.
template <class Names, class Grip, Sum P, class... L>
class SkillLoop : public SkillChange<Names, Grip, P, L...> {
  using Change = SkillChange<Names, Grip, P, L...>;

 public:
  static constexpr std::size_t joints = Change::joints;
  static constexpr std::size_t terms = Change::terms;
  static constexpr bool has_gripper = Change::has_gripper;
  static constexpr std::size_t controllers = Change::controllers;
  static constexpr std::size_t skills = Change::skills;
  using Blend = typename Change::Blend;
  using Goal = typename Change::Goal;
  using Memory = typename Change::Memory;

 protected:
  template <std::size_t Ix>
  using law_at = typename Change::template law_at<Ix>;
  using Change::arrive;
  using Change::begun;
  using Change::blend_;
  using Change::each_goal;
  using Change::largest;
  using Change::may_start;
  using Change::run;
  using Change::settings_;
  using Change::SkillChange;
  using Change::skills_;
  using Change::skin;

  /// One evaluation of the sum of laws, and of the skill's conditions.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<K::joints, typename K::scalar, Memory, terms> step(
      const Memory& memory, const K& known, const typename K::scalar& dt, Opposition given) const noexcept {
    Evaluation<K::joints, typename K::scalar, Memory, terms> out{{}, memory, {}, {}};
    Memory& m = out.memory;
    if (m.phase == SkillPhase::loading && !Blend::moves(m.blend)) [[unlikely]]
      out.status |= arrive(m, known);
    if (m.waits && !Blend::moves(m.blend)) [[unlikely]] {
      const auto change = begun(m, known, m.waiting);
      m = change.memory;
      out.status |= change.status;
    }
    if (m.bound.winds && Blend::swaps(m.blend)) [[unlikely]]  // the carried difference would wind them up
      blend_.restart(m.blend, known);
    auto e = run(m.blend, known, dt, given);
    const auto touched = skin(e.shares);
    out.torque = e.torque;
    for (std::size_t i = 0; i < controllers; ++i) out.shares[i] = e.shares[i];
    out.status |= e.status;
    if constexpr (joints > 0) {
      const auto own = e.torque - touched;
      if (m.bound.lags || Blend::moves(m.blend)) [[unlikely]] {
        const auto most = static_cast<typename K::scalar>(settings_.max_rate) * dt;
        out.shares[controllers] = bounded(m.bound, m.blend, e.memory, own, e.shares, most);
        out.torque += out.shares[controllers];
        if (m.bound.lags) out.status |= Reason::bumpless_transfer;
      } else {
        m.bound.follow(own, {}, {}, settings_.max_rate);
      }
    }
    m.blend = e.memory;
    supervise(m, known, touched, nanoseconds(static_cast<double>(dt)));
    if (m.phase == SkillPhase::finished) out.status |= Reason::skill_finished;
    if (m.phase == SkillPhase::failed) out.status |= Reason::skill_failed;
    return out;
  }

 private:
  /// The torque to add to the torque `own` of all laws but the skin's, so that none changes by more than
  /// `most`.
  template <class Torque, class Shares, class T>
  [[nodiscard]] SKINCTL_COLD Torque bounded(RateBound<joints>& bound, const typename Blend::Memory& before,
                                            typename Blend::Memory& next, const Torque& own, Shares shares,
                                            const T& most) const noexcept {
    // The change of the skin's torque by its weights until the next cycle, under a constant touch.
    const auto now = Blend::factors(before), soon = Blend::factors(next);
    for (std::size_t i = 0; i < controllers; ++i) {
      const double had = now[i].feedback, gets = soon[i].feedback;
      shares[i] = static_cast<T>(had > 0 ? (gets - had) / had : 0) * shares[i];
    }
    auto moved = skin(shares);
    if (largest(moved) > most) {
      const T slower = most / largest(moved);
      Blend::slow_down(before, next, static_cast<double>(slower));
      moved = slower * moved;
    }
    Torque carried;
    if (bound.lags || Blend::swaps(before)) carried = bound.missing(own, most);
    bound.follow(own, carried, moved, settings_.max_rate);
    if (bound.winds) Blend::settle_again(next);  // feedback came faster than the bound: fade it in once more
    if (bound.lags && Blend::swaps(before) && !Blend::moves(next))
      Blend::slow_down(before, next, 0);  // nothing has arrived before the torque has caught up
    return carried;
  }
  /// Updates the phase of the skill after `dt`, and begins the skill that follows.
  template <class K, class Torque>
  SKINCTL_NOINLINE void supervise(Memory& m, const K& known, const Torque& touched,
                                  Nanoseconds dt) const noexcept {
    const auto& s = skills_[m.skill];
    const auto& c = s.conditions;
    m.since = later(m.since, dt);
    double square = 0;
    for (const auto& x : touched) square += static_cast<double>(x) * static_cast<double>(x);
    m.touch = std::sqrt(square);
    if (m.phase == SkillPhase::failed || m.phase == SkillPhase::finished) return;
    if (c.max_touch > 0 && m.touch > c.max_touch) return end(m, SkillFailure::touch, 0);
    if (c.timeout > 0ns && m.since >= c.timeout) return end(m, SkillFailure::timeout, 0);
    if (m.phase == SkillPhase::loading || c.finish == SkillFinish::never) return;
    bool holds = true;
    if (c.finish == SkillFinish::switched) {
      const std::uint32_t reports = s.switches.which & m.reporting;
      holds = m.reported.stand({reports, s.switches.on & reports});
    }
    m.was_touched = m.was_touched || m.touched;
    if (c.finish == SkillFinish::touched) holds = m.touched;
    if (c.finish == SkillFinish::released) holds = m.was_touched && !m.touched;
    const GoalTolerance& tolerance = m.request.tolerance.any() ? m.request.tolerance : c.tolerance;
    if constexpr (has_gripper) {
      if (c.finish == SkillFinish::gripped || c.finish == SkillFinish::opened) {
        if (Grip::broken(m.gripper)) return end(m, SkillFailure::gripper, 0);
        holds = Grip::stands(m.gripper);
        if (c.finish == SkillFinish::gripped && holds && !Grip::holds(m.gripper) &&
            later(m.held, dt) >= c.hold)
          return end(m, SkillFailure::empty, 0);
      }
    }
    if (c.finish == SkillFinish::settled && tolerance.any())
      holds = near(m, known, tolerance);
    else if (c.finish == SkillFinish::settled)
      each_index<controllers>([&](auto i) {
        using Law = law_at<i.value>;
        if constexpr (Law::role == LawRole::tracking)
          if (s.weights[i.value] > 0)
            holds = holds && settled(std::get<i.value>(this->blend_.sum().laws()),
                                     Blend::template memory<i.value>(m.blend), known,
                                     static_cast<typename K::scalar>(c.still));
      });
    m.held = holds ? later(m.held, dt) : 0ns;
    if (holds && m.held >= c.hold) end(m, SkillFailure::none, s.next);
  }
  /// Whether the robot is within the tolerance of each goal of its request that has a distance.
  template <class K>
  [[nodiscard]] SKINCTL_COLD bool near(const Memory& m, const K& known,
                                       const GoalTolerance& t) const noexcept {
    bool any = false, all = true;
    each_goal(m.request, m.skill, [&](auto i, const auto& goal) {
      using Law = law_at<i.value>;
      if constexpr (HasDistance<Law, K, std::remove_cvref_t<decltype(goal)>>) {
        const auto d = std::get<i.value>(this->blend_.sum().laws()).distance(known, goal);
        const auto within = [](const auto& x, double most) {
          return !(most > 0) || static_cast<double>(x) <= most;
        };
        any = true;
        all = all && within(d.position, t.position) && within(d.orientation, t.orientation) &&
              within(d.joint, t.joint);
      }
    });
    return any && all;
  }
  void end(Memory& m, SkillFailure failure, std::uint8_t next) const noexcept {
    const bool last = next == m.skill;
    if (failure == SkillFailure::none && !last && !may_start(m, skills_[next])) failure = SkillFailure::next;
    if (failure != SkillFailure::none) next = 0;
    m.phase = failure == SkillFailure::none ? SkillPhase::finished : SkillPhase::failed;
    if (last || failure != SkillFailure::none) {  // else the sequence goes on
      // A failure stays told while the fallback runs.
      if (m.told.phase != SkillPhase::failed) m.told = {m.told.ticket, m.phase, failure};
    }
    if (last && failure == SkillFailure::none) return;
    m.waiting = m.request;
    m.waiting.kind = static_cast<unsigned char>(Goal::Kind::start);
    m.waiting.skill = next;
    if (m.phase == SkillPhase::failed) {
      m.waiting.goals = {};
      m.waiting.tolerance = {};
    }
    m.waits = true;
    m.goes_on = true;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
