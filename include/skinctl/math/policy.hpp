// The choice between speed and the last bit, as a template argument: Fast or Libm.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// The default: polynomials on lanes. Errors and ranges stand beside each function.
struct Fast {};
/// The standard library's function, number by number: its accuracy, at several times the cost.
struct Libm {};

}  // namespace math
SKINCTL_END_NAMESPACE
