// SPDX-License-Identifier: BSD-3-Clause
// Policies of speed and accuracy, as template arguments: Fast or Libm.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// The default policy: polynomials on lanes. Each function documents its error and range.
struct Fast {};
/// The policy of the standard library's function, number by number: more accurate, at several times the cost.
struct Libm {};

}  // namespace math
SKINCTL_END_NAMESPACE
