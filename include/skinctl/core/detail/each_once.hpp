// SPDX-License-Identifier: BSD-3-Clause
// Types that parts add to one: each once, and none that is empty.
#pragma once

#include <tuple>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Several types as one type, which derives from each.
template <class... Parts>
struct PartsTogether : Parts... {};

/// `type` is a tuple of the types, each once and none that is empty; `PartsTogether` counts as its parts.
template <class Found, class... Rest>
struct EachOnce {
  using type = Found;
};
template <class... Found, class Next, class... Rest>
struct EachOnce<std::tuple<Found...>, Next, Rest...>
    : EachOnce<std::conditional_t<std::is_empty_v<Next> || (std::is_same_v<Found, Next> || ...),
                                  std::tuple<Found...>, std::tuple<Found..., Next>>,
               Rest...> {};
template <class... Found, class... Parts, class... Rest>
struct EachOnce<std::tuple<Found...>, PartsTogether<Parts...>, Rest...>
    : EachOnce<std::tuple<Found...>, Parts..., Rest...> {};

template <class Each>
struct AsOne;
template <class... Parts>
struct AsOne<std::tuple<Parts...>> {
  using type = PartsTogether<Parts...>;
};
template <class Part>
struct AsOne<std::tuple<Part>> {
  using type = Part;
};
/// All of them as bases of one, each once; empty ones are left out.
template <class... Parts>
using Together = typename AsOne<typename EachOnce<std::tuple<>, Parts...>::type>::type;

/// `Own` with all types of a tuple as bases; with `Part`, if it is not empty.
template <class Own, class Each>
struct Joined;
template <class Own>
struct Joined<Own, std::tuple<>> {
  using type = Own;
};
template <class Own, class... Parts>
struct Joined<Own, std::tuple<Parts...>> {
  struct type : Own, Parts... {
    using Own::Own;
  };
};
template <class Own, class Part>
using JoinedWith =
    typename Joined<Own, std::conditional_t<std::is_empty_v<Part>, std::tuple<>, std::tuple<Part>>>::type;

}  // namespace detail
SKINCTL_END_NAMESPACE
