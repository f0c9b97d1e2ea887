// SPDX-License-Identifier: BSD-3-Clause
// A tuple that is trivially copyable if its elements are.
#pragma once

#include <cstddef>
#include <utility>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The element `K` of a tuple that is trivially copyable.
template <std::size_t K, class Value>
struct Element {
  [[no_unique_address]] Value value;
};
template <class Indices, class... Values>
struct IndexedTuple;
template <std::size_t... K, class... Values>
struct IndexedTuple<std::index_sequence<K...>, Values...> : Element<K, Values>... {};
template <class... Values>
using PlainTuple = IndexedTuple<std::index_sequence_for<Values...>, Values...>;

template <std::size_t K, class Value>
[[nodiscard]] SKINCTL_INLINE Value& element(Element<K, Value>& e) noexcept {
  return e.value;
}
template <std::size_t K, class Value>
[[nodiscard]] SKINCTL_INLINE const Value& element(const Element<K, Value>& e) noexcept {
  return e.value;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
