// The namespace of `skin + sensor`, apart so that the errors of other sums do not list it.
#pragma once

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace sensor_sums {

/// A base of every sensor that adds to a skin: argument-dependent look-up finds the operator by it.
struct Summand {};

}  // namespace sensor_sums
SKINCTL_END_NAMESPACE
