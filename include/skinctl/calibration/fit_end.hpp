// SPDX-License-Identifier: BSD-3-Clause
// Why a fit ended.
#pragma once

#include <cstddef>
#include <string_view>

#include "skinctl/core/config.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The reason for which a fit ended.
enum class FitEnd {
  converged,   ///< a further step would lower the cost by less than `FitSettings::decrease`
  steps_used,  ///< the fit was still improving after `FitSettings::steps`
  stuck,  ///< no step lowers the cost: the derivatives do not belong to the residuals, or rounding is reached
  not_finite  ///< the cost at the start is no number
};
[[nodiscard]] constexpr std::string_view name(FitEnd end) noexcept {
  constexpr std::string_view names[] = {"converged", "steps used", "stuck", "not finite"};
  return names[std::size_t(end)];
}

SKINCTL_END_NAMESPACE
