// SPDX-License-Identifier: BSD-3-Clause
// Something once in a period.
#pragma once

#include <optional>

#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A timer that is due once in a period, by the stamps of cycles. After a gap, and where stamps begin anew,
/// it counts from there.
class Pace {
 public:
  explicit Pace(Nanoseconds period) noexcept : period_(period) {}
  [[nodiscard]] bool due(Nanoseconds now) noexcept {
    if (next_ && now < *next_ && now > *next_ - 2 * period_) return false;
    next_ = next_ && now - *next_ < period_ && now >= *next_ ? *next_ + period_ : now + period_;
    return true;
  }

 private:
  Nanoseconds period_;
  std::optional<Nanoseconds> next_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
