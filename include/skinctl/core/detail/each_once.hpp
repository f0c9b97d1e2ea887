// Types that parts add to one: each once, and none that is empty.
#pragma once

#include <tuple>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `type` is a tuple of those that are left.
template <class Found, class... Rest>
struct EachOnce {
  using type = Found;
};
template <class... Found, class Next, class... Rest>
struct EachOnce<std::tuple<Found...>, Next, Rest...>
    : EachOnce<std::conditional_t<std::is_empty_v<Next> || (std::is_same_v<Found, Next> || ...),
                                  std::tuple<Found...>, std::tuple<Found..., Next>>,
               Rest...> {};

/// `Own` with all types of a tuple as bases.
template <class Own, class... Parts>
struct WithParts : Own, Parts... {
  using Own::Own;
};
template <class Own, class Parts>
struct Joined;
template <class Own>
struct Joined<Own, std::tuple<>> {
  using type = Own;
};
template <class Own, class... Parts>
struct Joined<Own, std::tuple<Parts...>> {
  using type = WithParts<Own, Parts...>;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
