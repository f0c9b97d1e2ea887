// Internals of SkillSet: how a skill begins, changes and ends.
#pragma once

#include "skinctl/skills/skill_set.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {
template <class L, class K>
inline constexpr bool tells_distance = requires(const L& law, const K& known, const typename L::Goal& goal) {
  law.distance(known, goal).position;
};
}  // namespace detail

/// Carries a request out, lets it wait, or refuses it.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class K>
SKINCTL_COLD auto SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::receive(
    const Memory& memory, const K& known, const Goal& request) const noexcept -> Received<Memory> {
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

/// Whether controllers of a skill accept the request's goals: at least one, and none refuses.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class K>
SKINCTL_COLD auto SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::fits(
    const Memory& m, const K& known, const Goal& request, std::uint8_t skill, Status& status) const noexcept
    -> bool {
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

/// The request's goals to the controllers that are loaded; the others get them once they are.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class K>
SKINCTL_COLD void SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::deliver(
    Memory& m, const K& known, const Goal& request, Status& status, bool arrived) const noexcept {
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

/// The change to another skill begins.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class K>
SKINCTL_COLD auto SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::begun(
    const Memory& memory, const K& known, const Goal& request) const noexcept -> Received<Memory> {
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

/// Makes a change last long enough that along its quintics the torque changes no faster than `max_rate`: to
/// the torque of the other skill at this state, and then, where the feedback of a tracking law fades in, to
/// its torque against the skin. The latter changes at up to `1.7 |tau_skin| sqrt(lambda / T)`, with 100 1/s
/// for lambda.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class K>
SKINCTL_COLD void SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::stretch(
    typename Blend::Memory& m, const K& known) const noexcept {
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

/// The torque to add to the torque `own` of all laws but the skin's, so that none changes by more than
/// `most`.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class Torque, class Shares, class T>
SKINCTL_COLD auto SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::bounded(
    detail::RateBound<joints>& bound, const typename Blend::Memory& before, typename Blend::Memory& next,
    const Torque& own, Shares shares, const T& most) const noexcept -> Torque {
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

/// The phase of the skill after `dt`, and its consequences.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class K, class Torque>
SKINCTL_NOINLINE void SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::supervise(
    Memory& m, const K& known, const Torque& touched, Nanoseconds dt) const noexcept {
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
      if (c.finish == SkillFinish::gripped && holds && !Grip::holds(m.gripper) && later(m.held, dt) >= c.hold)
        return end(m, SkillFailure::empty, 0);
    }
  }
  if (c.finish == SkillFinish::settled && tolerance.any())
    holds = near(m, known, tolerance);
  else if (c.finish == SkillFinish::settled)
    detail::each_index<controllers>([&](auto i) {
      using Law = law_at<i.value>;
      if constexpr (Law::role == LawRole::tracking)
        if (s.weights[i.value] > 0)
          holds = holds &&
                  settled(std::get<i.value>(blend_.sum().laws()), Blend::template memory<i.value>(m.blend),
                          known, static_cast<typename K::scalar>(c.still));
    });
  m.held = holds ? later(m.held, dt) : 0ns;
  if (holds && m.held >= c.hold) end(m, SkillFailure::none, s.next);
}

template <class... Behaviour, Sum P, class... L, class Grip>
template <class K>
SKINCTL_COLD auto SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::near(
    const Memory& m, const K& known, const GoalTolerance& t) const noexcept -> bool {
  bool any = false, all = true;
  each_goal(m.request, m.skill, [&](auto i, const auto& goal) {
    using Law = law_at<i.value>;
    if constexpr (detail::tells_distance<Law, K>) {
      const auto d = std::get<i.value>(blend_.sum().laws()).distance(known, goal);
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

template <class... Behaviour, Sum P, class... L, class Grip>
void SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::end(Memory& m, SkillFailure failure,
                                                                   std::uint8_t next) const noexcept {
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

/// One evaluation of the sum, and of the skill beside it.
template <class... Behaviour, Sum P, class... L, class Grip>
template <class K>
SKINCTL_INLINE auto SkillSet<Behaviours<Behaviour...>, Fused<P, L...>, Grip>::step(
    const Memory& memory, const K& known, const typename K::scalar& dt, Opposition given) const noexcept
    -> Evaluation<K::joints, typename K::scalar, Memory, terms> {
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

SKINCTL_END_NAMESPACE
