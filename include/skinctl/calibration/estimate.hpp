// The result of an identification: a number and how well it is known.
#pragma once

#include <limits>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A number and its standard deviation; infinite where the data say nothing about it.
struct Estimate {
  double value = 0;
  double deviation = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool known() const noexcept { return deviation < std::numeric_limits<double>::infinity(); }
};

SKINCTL_END_NAMESPACE
