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
  report,     ///< none but the reason
  slow_down,  ///< all joints are slowed alike until none is faster than `SkinWatch::slow`
  hold,       ///< brakes and holds; plans wait; goes on by itself
  stop        ///< brakes and holds; goes on after `CycleRequest::resume`
};

/// For `Cycle::with`: a blind skin is no untouched one. In one of three states a scene reacts as declared; with
/// the defaults it does not move before its skin is heard, and stops when a patch falls silent.
///
/// A cell counts while its newest sample is younger than `SkinSettings::max_age` and nothing masks it. Too few count also
/// while the skin has a hole (`TrustSettings::reach`): many cells are no use to a place that none of them feels. The
/// reasons are those of the state (`skin_unheard`, `skin_blind`, `skin_incomplete`) and of what is done
/// (`skin_slowed`, `skin_held`, `skin_stopped`). With `slow_down` the speed falls to `slow` within 0.25 s and as
/// fast as the joints can brake; a robot by torque is braked to it, by its torques, and also if it is pushed.
/// Holding and stopping brake as `CycleRequest::stop` does. Way back: the state must have been over for `settle`.
///
/// Without this part a scene takes no notice, at no cost.
struct SkinWatch {
  using Kind = SkinWatch;
  double enough = 0.9;  ///< share of the cells of each patch that have to report, in (0, 1]
  SkinReaction unheard = SkinReaction::hold;  ///< from the start until enough cells of each patch were heard
  SkinReaction blind = SkinReaction::stop;    ///< later, while too few cells of a patch report
  SkinReaction incomplete = SkinReaction::report;  ///< while enough report, but not all
  double slow = 0.1;                               ///< greatest speed of a joint when slowed [rad/s]
  Nanoseconds settle = 500ms;
};

/// A `SkinWatch` over the skin of a robot of N joints, as a limit of a scene.
template <std::size_t N, Real T = double>
class CoverageLimits {
 public:
  using Kind = SkinWatch;
  static constexpr Precedence precedence = Precedence::coverage;
  static constexpr bool reads_coverage = true;
  static constexpr double ramp = 0.25;  ///< of the greatest speed [s]

  /// Trivially copyable; `Memory{}` has heard nothing.
  struct Memory {
    bool heard = false;                            ///< whether enough cells of each patch were heard once
    std::array<T, 3> left{};                       ///< time for which each state still counts [s]
    SkinReaction reaction = SkinReaction::report;  ///< in the last cycle
    T slowed = T(0);                               ///< from 0, the joints' own limits, to 1, `slow`
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD CoverageLimits(const JointLimits<N, T>& limits, const SkinWatch& watch)
      : watch_(watch), speed_(limits.velocity()), settle_(seconds<T>(watch.settle)) {
    require(watch.enough > 0 && watch.enough <= 1, "SkinWatch: enough", watch.enough, "> 0, <= 1");
    require(watch.settle >= 0ns && watch.settle <= 10s, "SkinWatch: settle", milliseconds(watch.settle),
            "0 to 10 000 ms");
    double least = static_cast<double>(speed_[0]);
    for (std::size_t i = 1; i < N; ++i)
      if (static_cast<double>(speed_[i]) < least) least = static_cast<double>(speed_[i]);
    require(watch.slow > 0 && watch.slow <= least, "SkinWatch: slow", watch.slow,
            "> 0 rad/s, at most every joint's velocity limit");
    for (const SkinReaction r : {watch.unheard, watch.blind, watch.incomplete})
      require(r <= SkinReaction::stop, "SkinWatch: reaction", static_cast<double>(r), "a SkinReaction");
  }
  [[nodiscard]] const SkinWatch& settings() const noexcept { return watch_; }

  /// Judges the skin once a cycle of `dt` >= 0 seconds.
  SKINCTL_INLINE Status look(Memory& m, const Coverage& now, const T& dt) const noexcept {
    const bool enough = now.least >= watch_.enough && now.hole == Coverage::whole;
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
    const T turn = dt * T(1 / ramp);
    if (m.reaction >= SkinReaction::slow_down) {
      m.slowed = m.slowed + turn < T(1) ? T(m.slowed + turn) : T(1);
    } else {
      m.slowed = m.slowed > turn ? T(m.slowed - turn) : T(0);
    }
    if (m.reaction == SkinReaction::slow_down) status |= Reason::skin_slowed;
    if (m.reaction == SkinReaction::hold) status |= Reason::skin_held;
    if (m.reaction == SkinReaction::stop) status |= Reason::skin_stopped;
    return status;
  }
  template <class Seen>
  SKINCTL_INLINE Status look(Memory& m, const Seen& seen, const T& dt) const noexcept {
    return look(m, seen.coverage(), dt);
  }
  /// Whether the robot is to brake and hold by this.
  [[nodiscard]] static bool stays(const Memory& m) noexcept { return m.reaction >= SkinReaction::hold; }

  /// The share in [0, 1] of `u` that is slow enough; 1 leaves `u` as it is.
  [[nodiscard]] SKINCTL_INLINE T share(const Memory& m, const JointVelocity<N, T>& u) const noexcept {
    T share(1);
    if (!(m.slowed > T(0))) return share;
    for (std::size_t i = 0; i < N; ++i) {
      const T most = speed_[i] + m.slowed * (T(watch_.slow) - speed_[i]),
              speed = u[i] < T(0) ? T(-u[i]) : u[i];
      if (speed * share > most) share = most / speed;
    }
    return share;
  }
  template <class Going, class Seen>
  [[nodiscard]] SKINCTL_INLINE SpeedShare<T> share(const Memory& m, const Going&, const Seen&,
                                                   const JointVelocity<N, T>& u) const noexcept {
    return {share(m, u), {}};
  }

 private:
  SkinWatch watch_;
  JointVelocity<N, T> speed_;
  T settle_;
};

/// The limit of a robot that it makes.
template <class M, std::size_t N, Real T>
[[nodiscard]] auto part_for(const M&, const JointLimits<N, T>& limits, const SkinWatch& watch) {
  return CoverageLimits<N, T>(limits, watch);
}

SKINCTL_END_NAMESPACE
