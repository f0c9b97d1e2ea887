// SPDX-License-Identifier: BSD-3-Clause
// In place of a skin in a scene without one.
#pragma once

#include <span>

#include "skinctl/core/status.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// No skin: in a scene, and as a source of samples for `run_loop`.
struct NoSkin {
  using Wrenches = NoTouch;
  struct Memory {
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };
  [[nodiscard]] Memory start(Nanoseconds) const noexcept { return {}; }
  /// `sample_unknown` if there are samples: without a skin they are of unknown cells.
  Status receive(Memory&, std::span<const CellSample> samples, Nanoseconds, Nanoseconds, std::size_t,
                 Wrenches*) const noexcept {
    return samples.empty() ? Status{} : Status{Reason::sample_unknown};
  }
  [[nodiscard]] Wrenches wrenches(const Memory&) const noexcept { return {}; }
  /// The samples since the last call: none.
  std::span<const CellSample> poll() noexcept { return {}; }
};

SKINCTL_END_NAMESPACE
