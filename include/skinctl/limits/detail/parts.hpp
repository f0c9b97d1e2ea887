// Finds the parts of a governor by their kind.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// In place of a part that a governor does not have.
struct NoPart {
  struct Memory {};
};
template <class Part>
concept JerkPart = requires(const Part& p) { p.jerk(); };
template <class Part>
concept ToolPart = requires { typename Part::At; };
template <class Part>
concept ContactPart = requires { typename Part::Verdict; };

template <class Part>
concept MotionPart = requires { typename Part::MotionPart; };
template <class Part>
concept WatchPart = requires { typename Part::WatchPart; };

template <class Part>
concept ClearancePart = requires { typename Part::ClearancePart; };

/// Whether it is the contact of one link; those of all links are joined.
template <class Part>
inline constexpr bool is_link_contact = false;

struct IsClearance {
  template <class P>
  static constexpr bool of = ClearancePart<P>;
};
struct IsMotion {
  template <class P>
  static constexpr bool of = MotionPart<P>;
};
struct IsJerk {
  template <class P>
  static constexpr bool of = JerkPart<P>;
};
struct IsTool {
  template <class P>
  static constexpr bool of = ToolPart<P>;
};
struct IsContact {
  template <class P>
  static constexpr bool of = ContactPart<P>;
};

struct IsWatch {
  template <class P>
  static constexpr bool of = WatchPart<P>;
};

/// The first of the parts that `Is`, or `NoPart`.
template <class Is>
constexpr NoPart pick() noexcept {
  return {};
}
template <class Is, class First, class... Rest>
constexpr auto pick(const First& first, const Rest&... rest) noexcept {
  if constexpr (Is::template of<First>) {
    return first;
  } else {
    return pick<Is>(rest...);
  }
}

/// Whether these are parts of a governor, each at most once.
template <class... Parts>
consteval void check_parts() {
  static_assert(((JerkPart<Parts> || ToolPart<Parts> || ContactPart<Parts> || MotionPart<Parts> ||
                  WatchPart<Parts> || ClearancePart<Parts>) &&
                 ...),
                "a governor takes JerkLimits, ToolSpeed, ClearanceLimits, ContactLimits, MotionLimits and "
                "CoverageLimits");
  static_assert(((int(JerkPart<Parts>) + ... + 0) <= 1) && ((int(ToolPart<Parts>) + ... + 0) <= 1) &&
                    ((int(ContactPart<Parts>) + ... + 0) <= 1) && ((int(WatchPart<Parts>) + ... + 0) <= 1) &&
                    ((int(ClearancePart<Parts>) + ... + 0) <= 1),
                "a governor takes each part once; contact limits of all links belong into one");
}
/// `make` of the parts in their order, `NoPart` for those that are not there.
template <class Make, class... Parts>
[[nodiscard]] auto with_parts(const Make& make, const Parts&... parts) {
  return make(pick<IsJerk>(parts...), pick<IsTool>(parts...), pick<IsContact>(parts...),
              pick<IsMotion>(parts...), pick<IsWatch>(parts...), pick<IsClearance>(parts...));
}

}  // namespace detail
SKINCTL_END_NAMESPACE
