// Opposition: detects that the skin pushes against the tracking laws, end of section 4.2.1.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/core/law.hpp"
#include "skinctl/core/time.hpp"

SKINCTL_BEGIN_NAMESPACE

/// When skin and tracking count as opposed, by the norm of the skin's joint torque as it enters the sum. A
/// push below the threshold may wind the integrals up.
struct OppositionSettings {
  double on = 1.0;                   ///< opposed above this, if the torques oppose each other [N m]
  double off = 0.5;                  ///< ends when it has been below this [N m] ...
  Nanoseconds release_after = 50ms;  ///< ... for this duration
};

/// Opposed from the moment that `|tau_skin| > on` and `tau_skin . tau_track < 0`, until `|tau_skin| < off`
/// has held without a break for `release_after`, whatever the rate of the cycle.
class OppositionDetector {
 public:
  struct Memory {
    Nanoseconds quiet{};  ///< how long the skin has been below `off`
    bool below = false;   ///< whether it was at the last evaluation
    bool opposed = false;
  };
  struct Result {
    Memory memory;
    Opposition opposition;
  };

  /// Throws `ConfigurationError` unless `on >= off > 0` and `release_after >= 0`.
  explicit OppositionDetector(const OppositionSettings& settings = {}) : settings_(settings) {
    require(settings.off > 0 && settings.off <= 1e9, "opposition: off", settings.off, "> 0 N m");
    require(settings.on >= settings.off && settings.on <= 1e9, "opposition: on", settings.on,
            ">= off, in N m");
    require(settings.release_after >= 0ns, "opposition: release_after",
            seconds<double>(settings.release_after), ">= 0 s");
  }
  [[nodiscard]] const OppositionSettings& settings() const noexcept { return settings_; }

  /// @param skin   weighted torque of the reactive laws.
  /// @param track  weighted torque of the tracking laws without gravity.
  /// @param dt     time until the next call [s].
  /// Torques that are not finite change nothing.
  template <std::size_t N, Scalar T>
  [[nodiscard]] SKINCTL_INLINE Result detect(const Memory& memory, const JointTorque<N, T>& skin,
                                             const JointTorque<N, T>& track, const T& dt) const noexcept {
    T square(0), product(0);
    for (std::size_t i = 0; i < N; ++i) {
      square = square + skin[i] * skin[i];
      product = product + skin[i] * track[i];
    }
    const T on = static_cast<T>(settings_.on), off = static_cast<T>(settings_.off);
    Memory next = memory;
    if (!memory.opposed) {
      if (square > on * on && product < T(0)) return {{0ns, false, true}, Opposition::lasting};
      return {next, Opposition::none};
    }
    next.below = square < off * off;
    if (!next.below) {
      next.quiet = 0ns;
      return {next, Opposition::lasting};
    }
    if (memory.quiet >= settings_.release_after) return {{}, Opposition::released};
    next.quiet = memory.quiet + nanoseconds(static_cast<double>(dt));
    return {next, Opposition::lasting};
  }

 private:
  OppositionSettings settings_;
};

SKINCTL_END_NAMESPACE
