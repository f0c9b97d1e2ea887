// SPDX-License-Identifier: BSD-3-Clause
// Finds what a law would change behind the back of a cycle: mutable members, and pointers in a Memory.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

template <class L>
concept ConstantByDefault = requires { typename std::bool_constant<(static_cast<void>(L{}), true)>; };
template <class L>
inline constexpr L constant_law{};
/// Whether a constant of this type can be copied in a constant expression: the language refuses that for one
/// with a mutable member.
template <class L>
concept CopiesAsConstant =
    requires { typename std::bool_constant<(static_cast<void>(L(constant_law<L>)), true)>; };
/// Whether its copy constructor is `constexpr`: what the expression itself has made may be copied.
template <class L>
concept CopiesWhatItMade =
    requires { typename std::bool_constant<(static_cast<void>(L(static_cast<const L&>(L{}))), true)>; };
template <std::size_t>
struct AnyField {
  template <class T>
  operator T() const noexcept;  // NOLINT: it stands for any field
};
struct PointerField {
  template <class T>
  operator T*() const noexcept;  // NOLINT: it stands for a pointer
};
/// A constant as an argument of a template: its type has neither private members nor mutable ones.
template <auto>
struct ByValue {};
template <class T>
concept TemplateArgument = requires { typename ByValue<T{}>; };
struct FieldOfNone {
  template <class T>
    requires(!TemplateArgument<T>)
  operator T() const noexcept;  // NOLINT: it stands for a field that may be no argument
};
/// Whether there is no field behind those before, or one of a type that may be such an argument.
template <class L, std::size_t... Before>
constexpr bool is_plain_behind(std::index_sequence<Before...>) {
  constexpr bool says = requires { L{AnyField<Before>()..., AnyField<0>()}; };
  constexpr bool exists = says || requires { L{AnyField<Before>()..., {}}; };
  return !exists || (says && !requires { L{AnyField<Before>()..., FieldOfNone()}; });
}
template <class L, std::size_t... Field>
constexpr bool are_plain(std::index_sequence<Field...>) {
  return (is_plain_behind<L>(std::make_index_sequence<Field>()) && ...);
}
/// A law with a mutable member, where `L{}` is a constant expression. GCC 12 copies one whole: it is found
/// there in aggregates, among the first 16 fields, as one that cannot be an argument though each of its
/// fields can.
#if defined(__clang__) || !defined(__GNUC__)
template <class L>
concept HasMutableMember = ConstantByDefault<L> && CopiesWhatItMade<L> && !CopiesAsConstant<L>;
#else
template <class L>
concept HasMutableMember = ConstantByDefault<L> && std::is_aggregate_v<L> && !TemplateArgument<L> &&
                           are_plain<L>(std::make_index_sequence<16>());
#endif
template <class M, std::size_t... Before>
constexpr bool is_pointer_behind(std::index_sequence<Before...>) {
  return requires { M{AnyField<Before>()..., PointerField()}; };
}
template <class M, std::size_t... Field>
constexpr bool has_pointer_among(std::index_sequence<Field...>) {
  return (is_pointer_behind<M>(std::make_index_sequence<Field>()) || ...);
}
/// A Memory with a pointer: replayed or copied, it would point to what is no longer so. Found among the first
/// 16 fields of an aggregate, not within another one that hides it (a view).
template <class M>
concept HasPointerField =
    std::is_aggregate_v<M> && !std::is_empty_v<M> && has_pointer_among<M>(std::make_index_sequence<16>());

}  // namespace detail
SKINCTL_END_NAMESPACE
