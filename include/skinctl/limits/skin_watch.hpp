// SPDX-License-Identifier: BSD-3-Clause
// What a robot does while cells of its skin do not report.
#pragma once

#include <array>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/robot/joint_limits.hpp"
#include "skinctl/tactile/coverage.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A reaction to cells that do not report; a later one includes those before it.
enum class SkinReaction : unsigned char {
  report,  ///< none but the reason
  hold,    ///< brakes and holds; plans wait; goes on by itself
  stop     ///< brakes and holds; goes on after `CycleRequest::resume`
};

/// Part for `Cycle::with`: the reactions of a scene to cells that do not report, in three states of the skin;
/// a blind skin is no untouched one. With the defaults the robot does not move before its skin is heard, and
/// stops when a patch falls silent. `FeltPlaces` limits the speed of places that feel badly.
///
/// A cell counts while its newest sample is younger than `SkinSettings::max_age` and nothing masks it. The
/// reasons are those of the state (`skin_unheard`, `skin_blind`, `skin_incomplete`) and of what is done
/// (`skin_held`, `skin_stopped`). Holding and stopping brake as `CycleRequest::stop` does. Way back: the
/// state must have been over for `settle`.
///
/// A scene without this part takes no notice of such cells, at no cost.
struct SkinWatch {
  using Kind = SkinWatch;
  SkinReaction unheard = SkinReaction::hold;       ///< reaction from the start until each patch was heard
  SkinReaction blind = SkinReaction::stop;         ///< reaction later, while no cell of a patch counts
  SkinReaction incomplete = SkinReaction::report;  ///< reaction while each patch is heard, but not every cell
  /// Time after which a state that is over no longer counts: two lives of a sample, for a loose plug.
  Nanoseconds settle = 500ms;
};

/// A `SkinWatch` over the skin of a scene, as a limit of it.
template <Real T = double>
class CoverageLimits {
 public:
  using Kind = SkinWatch;
  static constexpr Precedence precedence = Precedence::coverage;
  static constexpr bool reads_coverage = true;

  /// Trivially copyable; `Memory{}` has heard nothing.
  struct Memory {
    bool heard = false;                            ///< whether each patch was heard once
    std::array<T, 3> left{};                       ///< time for which each state still counts [s]
    SkinReaction reaction = SkinReaction::report;  ///< reaction in the last cycle
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit CoverageLimits(const SkinWatch& watch)
      : watch_(watch), settle_(seconds<T>(watch.settle)) {
    require(watch.settle >= 0ns && watch.settle <= 10s, "SkinWatch: settle", milliseconds(watch.settle),
            "0 to 10 000 ms");
    for (const SkinReaction r : {watch.unheard, watch.blind, watch.incomplete})
      require(r <= SkinReaction::stop, "SkinWatch: reaction", static_cast<double>(r), "a SkinReaction");
  }
  [[nodiscard]] const SkinWatch& settings() const noexcept { return watch_; }

  /// Judges the skin once a cycle of `dt` >= 0 seconds.
  SKINCTL_INLINE Status look(Memory& m, const Coverage& now, const T& dt) const noexcept {
    const bool enough = now.blind_patches == 0;
    const bool states[3] = {!m.heard && !enough, m.heard && !enough, enough && now.usable < now.cells};
    m.heard = m.heard || enough;
    const SkinReaction declared[3] = {watch_.unheard, watch_.blind, watch_.incomplete};
    constexpr Reason reasons[3] = {Reason::skin_unheard, Reason::skin_blind, Reason::skin_incomplete};
    Status status;
    m.reaction = SkinReaction::report;
    for (std::size_t k = 0; k < 3; ++k) {
      const T left = m.left[k] - dt;
      m.left[k] = states[k] ? settle_ : (left > T(0) ? left : T(0));
      if (states[k]) status |= reasons[k];
      if ((states[k] || m.left[k] > T(0)) && declared[k] > m.reaction) m.reaction = declared[k];
    }
    if (m.reaction == SkinReaction::hold) status |= Reason::skin_held;
    if (m.reaction == SkinReaction::stop) status |= Reason::skin_stopped;
    return status;
  }
  template <class Seen>
  SKINCTL_INLINE Status look(Memory& m, const Seen& seen, const T& dt) const noexcept {
    return look(m, seen.coverage(), dt);
  }
  /// Whether the robot is to brake and hold because of its skin.
  [[nodiscard]] static bool stays(const Memory& m) noexcept { return m.reaction >= SkinReaction::hold; }

 private:
  SkinWatch watch_;
  T settle_;
};

/// The `CoverageLimits` that `watch` makes.
template <class M, std::size_t N, Real T>
[[nodiscard]] auto part_for(const M&, const JointLimits<N, T>&, const SkinWatch& watch) {
  return CoverageLimits<T>(watch);
}

SKINCTL_END_NAMESPACE
