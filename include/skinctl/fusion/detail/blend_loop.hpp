// The part of Blended that runs in every cycle.
#pragma once

#include "skinctl/fusion/blended.hpp"

SKINCTL_BEGIN_NAMESPACE

template <Sum P, class... L>
template <class K>
SKINCTL_INLINE auto Blended<Fused<P, L...>>::step(const Memory& memory, const K& known,
                                                  const typename K::scalar& dt,
                                                  Opposition given) const noexcept
    -> Evaluation<K::joints, typename K::scalar, Memory, terms> {
  using T = typename K::scalar;
  Evaluation<K::joints, T, Memory, terms> out{{}, memory, {}, {}};
  Memory& next = out.memory;
  if (memory.waiting && !moves(memory)) [[unlikely]]
    next = begun(memory, known);
  const Factors shares = factors(next);
  JointTorque<K::joints, T> skin, track, contact;
  const Nanoseconds ns = nanoseconds(static_cast<double>(dt));
  [&]<std::size_t... I>(std::index_sequence<I...>) SKINCTL_INLINE_LAMBDA {
    std::tuple<Part<typename NowOf<law_at<I>, K>::type, K::joints, T>...> parts;
    detail::each_index<terms>([&](auto i) SKINCTL_INLINE_LAMBDA {
      constexpr std::size_t J = i.value;
      constexpr LawRole r = law_at<J>::role;
      const bool on = loaded(next, J);
      if (!on && !(gated && detail::answers_touch<law_at<J>>)) return;
      if constexpr (r == LawRole::tracking)
        if (comes(next, J) && next.elapsed < next.ramp) [[unlikely]]
          detail::memory_of<J>(next.laws) = law<J>().start(known);
      auto& part = std::get<J>(parts);
      compute<J>(part, next, known, shares[J]);
      if constexpr (r == LawRole::tracking && !detail::presses<law_at<J>>) {
        track += part.torque;
        if constexpr (Fusion::watches && holds_gravity)
          track -= static_cast<T>(shares[J].feed_forward) * known.gravity();
      } else if constexpr (r == LawRole::reactive) {
        if constexpr (gated && detail::answers_touch<law_at<J>>)
          contact += static_cast<T>(sum_.weights()[J]) * part.torque;
        part.torque = static_cast<T>(shares[J].feedback) * part.torque;
        if constexpr (detail::answers_touch<law_at<J>>) skin += part.torque;
      }
      out.shares[J] = part.torque;
      out.torque += part.torque;
      if (on) out.status |= status_of(law<J>(), detail::memory_of<J>(next.laws));
    });
    if constexpr (holds_gravity) {
      double left = 1;
      for (std::size_t i = 0; i < terms; ++i)
        if (Fusion::roles[i] == LawRole::tracking) left -= shares[i].feed_forward;
      out.torque += static_cast<T>(left) * known.gravity();
    }
    Opposition opposition = given;
    if constexpr (Fusion::watches) {
      const auto found = sum_.detector().detect(memory.opposition, skin, track, torque_scale(known), dt);
      next.opposition = found.memory;
      if (given == Opposition::none) opposition = found.opposition;
      if (opposition == Opposition::lasting) out.status |= Reason::opposed;
    }
    detail::each_index<terms>([&](auto i) SKINCTL_INLINE_LAMBDA {
      constexpr std::size_t J = i.value;
      if constexpr (!std::is_empty_v<typename law_at<J>::Memory>)
        if (loaded(next, J)) move_on<J>(next, std::get<J>(parts).now, known, dt, opposition);
    });
  }(std::index_sequence_for<L...>{});
  if (moves(next)) out.status |= Reason::bumpless_transfer;
  next.elapsed = later(next.elapsed, ns);
  if constexpr (gated) {
    next.contact = contact_.advanced(next.contact, contact, ns);
    if (next.contact.touched != memory.contact.touched) {
      next.waiting = true;
      next.next_ramp = ramp_.duration();
    }
  }
  return out;
}

SKINCTL_END_NAMESPACE
