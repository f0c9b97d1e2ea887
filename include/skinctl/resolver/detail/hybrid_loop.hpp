// One cycle of a hybrid resolver.
#pragma once

#include "skinctl/resolver/hybrid_resolver.hpp"

SKINCTL_BEGIN_NAMESPACE
#define SKINCTL_HYBRID \
  template <Interface I, LinkMask ByTorque, RobotModel M, Real T, class Integrator, std::size_t History>
#define SKINCTL_HYBRID_CLASS HybridResolver<I, ByTorque, M, T, Integrator, History>

SKINCTL_HYBRID
template <class L, class Touch, class Check>
auto SKINCTL_HYBRID_CLASS::step(Memory& m, const L& law, typename L::Memory& law_memory,
                                const State<joints, T>& measured, const Interval& interval,
                                std::span<const Touch> touches, const Check& check) const noexcept
    -> Resolved<joints, T, terms_of<L>> {
  Resolved<joints, T, terms_of<L>> out{m.command, interval.status, {}, {}};
  if (!m.stiff.started) return out;
  if (interval.substeps == 0) {
    m.stiff.odd = detail::odd_time_of(interval);
    // Even if the clock is wrong, gravity is compensated at the measured position.
    out.fallback = held(detail::believed(measured, m.measured, check));
    return out;
  }
  SKINCTL_EXPECTS(touches.size() >= interval.substeps, "one touch per sub-step");
  const auto& p = virtual_.parameters();
  out.status |= take_measurement(m.measured, measured, interval.to, check);
  const auto begun = virtual_.begin(m.stiff, part_of<Stiff>(m.measured), interval);
  out.status |= begun.status;
  StiffTorque stiff_torque = m.stiff.command.torque;

  for (unsigned j = 0; j < interval.substeps; ++j) {
    const T h = seconds<T>(interval.at(j + 1) - interval.at(j));
    Velocity v1;
    if (m.stiff.mode == ResolverMode::following) {
      const auto now = state(m, interval.at(j), m.stiff.v);
      const Knows<L, Touch> known = this->template known<L>(now, h, touches[j]);
      const auto asked = evaluate(law, law_memory, known, h);
      out.status |= asked.status;
      if (detail::is_finite(asked.torque)) [[likely]] {
        const StiffTorque wish = Stiff::of(asked.torque);
        stiff_torque = p.limits.within(wish, m.stiff.v);
        if (!(stiff_torque == wish)) out.status |= Reason::torque_limited;
        const auto next = detail::step_velocity_of<Integrator, Stiff>(
            known, p.shape, p.has_coulomb, stiff_torque, begun.correction.pull, m.stiff.last);
        if (next.singular) out.status |= Reason::singular;
        v1 = next.velocity;
        law_memory = asked.memory;
        out.shares = asked.shares;
      } else {
        out.status |= Reason::torque_not_finite;
      }
    }
    out.status |= virtual_.move(m.stiff, begun.correction, v1, h);
  }
  m.stiff.time = interval.to;

  // An old velocity is no basis for braking.
  out.fallback = begun.status.has(Reason::state_stale) ? held(m.measured.q, {}) : held(m.measured);
  DrivenTorque driven = Driven::of(out.fallback);
  const bool blocked = m.stiff.mode == ResolverMode::blocked;
  if (blocked) out.status |= Reason::blocked;
  if (m.stiff.mode != ResolverMode::braking && !m.stiff.stop) {
    const auto now = state(m, m.stiff.time, blocked ? Velocity{} : m.stiff.v);
    const Knows<L, Touch> known =
        this->template known<L>(now, seconds<T>(p.period), touches[interval.substeps - 1]);
    const auto asked = torque_of(law, law_memory, known);
    if (detail::is_finite(asked)) [[likely]] {
      driven = Driven::of(asked) - friction(now);
      if (blocked) {
        stiff_torque = p.limits.within(Stiff::of(asked), Velocity{});
        virtual_.try_to_leave(m.stiff, begun.correction,
                              stiff_torque - Stiff::of(gravity_torque(model_, now.q)));
      }
    } else {
      out.status |= Reason::torque_not_finite;
    }
  }
  const DrivenTorque given = limits_.within(driven, Driven::of(m.measured.dq));
  if (!(given == driven)) out.status |= Reason::torque_limited;
  out.status |= virtual_.end(m.stiff, begun, stiff_torque);
  compose(m, given);
  out.command = m.command;
  return out;
}

#undef SKINCTL_HYBRID
#undef SKINCTL_HYBRID_CLASS

SKINCTL_END_NAMESPACE
