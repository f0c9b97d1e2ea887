// The choice of less code instead of less time.
#pragma once

#include "skinctl/model/model.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `M`, whose recursions go link by link.
template <RobotModel M>
class LinkByLink : public M {
 public:
  static constexpr bool link_by_link = true;
  constexpr LinkByLink() = default;
  explicit constexpr LinkByLink(const M& model) : M(model) {}
};

namespace detail {
template <class M>
constexpr bool is_revolute_chain() noexcept {
  for (std::size_t i = 0; i < M::joints; ++i)
    if (M::parents[i] != static_cast<int>(i) - 1 || M::kinds[i] != JointKind::revolute) return false;
  return true;
}
/// Whether the recursions of `M` in `T` go link by link.
template <class M, class T>
inline constexpr bool goes_link_by_link = false;
template <class M, std::floating_point T>
  requires requires { requires M::link_by_link; }
inline constexpr bool goes_link_by_link<M, T> = is_revolute_chain<M>();
}  // namespace detail

SKINCTL_END_NAMESPACE
