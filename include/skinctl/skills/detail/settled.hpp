// Whether a tracking law has come to rest where it was sent.
#pragma once

#include "skinctl/core/law.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <class V, class T>
[[nodiscard]] bool slower(const V& velocity, const T& most) noexcept {
  for (const T& v : velocity)
    if (!(v <= most && -v <= most)) return false;
  return true;
}
/// Whether a reference, of joints or of a pose, does not move.
template <class R>
[[nodiscard]] bool stands(const R& reference) noexcept {
  if constexpr (requires { reference.dq_d; }) {
    for (const auto& v : reference.dq_d)
      if (v != 0) return false;
    return true;
  } else {
    return dot(reference.V.linear, reference.V.linear) == 0 &&
           dot(reference.V.angular, reference.V.angular) == 0;
  }
}
/// The target stands, the skin does not hold the law up, and neither robot nor reference is faster than
/// `still`. Laws without a plan are always settled.
template <class L, class K, class T>
[[nodiscard]] SKINCTL_NOINLINE bool settled(const L& law, const typename L::Memory& memory, const K& known,
                                            const T& still) noexcept {
  if constexpr (requires { memory.plan.at(T(0), law.settings()); }) {
    if (memory.held || !stands(memory.plan.at(T(0), law.settings())) || !slower(known.dq(), still))
      return false;
    return slower(law.now(memory, known).dq_r, still);
  } else {
    return slower(known.dq(), still);
  }
}

}  // namespace detail
SKINCTL_END_NAMESPACE
