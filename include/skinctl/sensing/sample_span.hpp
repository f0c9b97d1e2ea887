// SPDX-License-Identifier: BSD-3-Clause
// The samples of an input: a span that cannot be made from a container that ends with the statement.
#pragma once

#include <concepts>
#include <cstddef>
#include <ranges>
#include <span>
#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A `std::span<const S>` that cannot be made from a temporary container: with a plain span, `input.samples =
/// skin.poll()` compiles for a `poll()` that returns a vector by value, and the cycle reads freed memory.
/// From named containers and from spans it is made as a plain span is; what it looks at has to stay until the
/// cycle has run.
template <class S>
class SampleSpan : public std::span<const S> {
  template <class Samples>
  static constexpr bool looks_at = !std::same_as<std::remove_cvref_t<Samples>, SampleSpan> &&
                                   std::convertible_to<std::remove_reference_t<Samples>&, std::span<const S>>;
  template <class Samples>
  static constexpr bool stays = std::is_lvalue_reference_v<Samples> || std::ranges::borrowed_range<Samples>;

 public:
  constexpr SampleSpan() noexcept = default;
  constexpr SampleSpan(const S* first, std::size_t count) noexcept : std::span<const S>(first, count) {}
  template <class Samples>
    requires(looks_at<Samples> && stays<Samples>)
  constexpr SampleSpan(Samples&& samples) noexcept : std::span<const S>(samples) {}
  template <class Samples>
    requires(looks_at<Samples> && !stays<Samples>)
  SampleSpan(Samples&&) = delete;  // these samples end with this statement: keep them in a variable
};

SKINCTL_END_NAMESPACE

template <class S>
inline constexpr bool std::ranges::enable_borrowed_range<skinctl::SampleSpan<S>> = true;
template <class S>
inline constexpr bool std::ranges::enable_view<skinctl::SampleSpan<S>> = true;
