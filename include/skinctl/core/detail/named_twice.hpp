// SPDX-License-Identifier: BSD-3-Clause
// Detects a member by its name, whatever its signature: for the fault finders of protocols.
#pragma once

#include <type_traits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A class that inherits a name twice, if `X` has it too: the name is ambiguous then.
template <class X, class Names>
struct NamedTwice : X, Names {};
template <class X>
concept CanBeAsked = std::is_class_v<X> && !std::is_final_v<X>;

}  // namespace detail
SKINCTL_END_NAMESPACE

/// Defines `Concept`: whether a class has a member of this name. `Names` is a struct with one member of each
/// name that is asked for. A class that is final cannot be asked: it has no name.
#define SKINCTL_NAMES(Concept, Names, member) \
  template <class X>                          \
  concept Concept =                           \
      ::skinctl::detail::CanBeAsked<X> && !requires { &::skinctl::detail::NamedTwice<X, Names>::member; }
