// What a scene of a robot in groups of joints needs: its resolver, guard and governor. Others do not pay for it.
#pragma once

#include "skinctl/cycle/cycle.hpp"
#include "skinctl/guard/group_guard.hpp"
#include "skinctl/limits/group_governor.hpp"
#include "skinctl/limits/motion_limits.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Guard and governor of a robot in groups.
template <class Resolver>
  requires(!has_one_interface<Resolver>)
struct SceneParts<Resolver> {
  static constexpr std::size_t joints = Resolver::joints;
  using T = typename Resolver::scalar;
  using Sets = typename Resolver::JointSets;
  using M = std::remove_cvref_t<decltype(std::declval<const Resolver&>().model())>;
  template <class Smooth = NoPart>
  using Guard = GroupGuard<Resolver, !std::is_same_v<Smooth, NoPart>>;

  template <class Smooth = NoPart>
  [[nodiscard]] static Guard<Smooth> guard(const Resolver& r) {
    return Guard<Smooth>(r);
  }
  template <class Smooth = NoPart, class Settings>
  [[nodiscard]] static Guard<Smooth> guard(const Resolver& r, const Settings& settings) {
    return Guard<Smooth>(r, settings);
  }
  template <class Smooth, class Settings>
  [[nodiscard]] static Guard<Smooth> guard(const Resolver& r, const Settings& settings, const Smooth& jerk) {
    return Guard<Smooth>(r, settings, jerk.jerk());
  }
  /// The limits of the motion of joints by torque are added.
  template <class... Limits>
  [[nodiscard]] static auto governor(const Resolver& r, const Limits&... limits) {
    if constexpr (Resolver::has_driven) {
      return make_group_governor<Sets>(r.limits(), limits...,
                                       MotionLimits<M, T, typename Sets::Driven>(r.model()));
    } else if constexpr (sizeof...(Limits) > 0) {
      return make_group_governor<Sets>(r.limits(), limits...);
    } else {
      return NoGovernor{};
    }
  }
};

template <class Sets, std::size_t N, Real T, class... Parts>
inline constexpr bool is_governor<GroupGovernor<Sets, N, T, Parts...>> = true;

}  // namespace detail

SKINCTL_END_NAMESPACE
