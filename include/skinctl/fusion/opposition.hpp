// SPDX-License-Identifier: BSD-3-Clause
// Opposition: detects that the skin pushes against the tracking laws, end of section 4.2.1.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/law/law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Thresholds from which skin and tracking count as opposed, on the norm of the skin's joint torques as they
/// enter the sum, each as a share of its joint's largest torque: a shoulder, a wrist and a finger feel alike.
/// A push below the threshold may wind the integrals up.
struct OppositionSettings {
  double on = 0.01;  ///< share above which skin and tracking are opposed, if their torques oppose each other
  double off = 0.005;                ///< share below which the opposition ends
  Nanoseconds release_after = 50ms;  ///< time below `off` after which the opposition ends
};

/// The largest torques of the joints as far as they are known; 100 N m otherwise.
template <class K>
[[nodiscard]] SKINCTL_INLINE decltype(auto) torque_scale(const K& known) noexcept {
  if constexpr (detail::KnowsLimits<K>) {
    return known.limits().torque();
  } else {
    return JointTorque<K::joints, typename K::scalar>::constant(typename K::scalar(100));
  }
}

/// Detects when skin and tracking are opposed: from the moment that `|tau_skin| > on` and
/// `tau_skin . tau_track < 0`, until `|tau_skin| < off` has held without a break for `release_after`,
/// whatever the rate of the cycle. Norm and product are those of torques over the largest torque of their
/// joint.
class OppositionDetector {
 public:
  struct Memory {
    Nanoseconds quiet{};  ///< time for which the skin's torque has been below `off`
    bool below = false;   ///< the skin's torque was below `off` at the last evaluation
    bool opposed = false;
  };
  struct Result {
    Memory memory;
    Opposition opposition;
  };

  /// Throws `ConfigurationError` unless `on >= off >= 1e-9` and `0 <= release_after <= 1 h`.
  explicit OppositionDetector(const OppositionSettings& settings = {}) : settings_(settings) {
    require(settings.off >= 1e-9 && settings.off <= 1e9, "opposition: off", settings.off, ">= 1e-9");
    require(settings.on >= settings.off && settings.on <= 1e9, "opposition: on", settings.on, ">= off");
    require(settings.release_after >= 0ns && settings.release_after <= 1h, "opposition: release_after",
            seconds<double>(settings.release_after), "0 to 3600 s");
  }
  [[nodiscard]] const OppositionSettings& settings() const noexcept { return settings_; }

  /// The opposition now, and the memory for the next call.
  ///
  /// @param skin   weighted torque of the laws that answer the skin [N m].
  /// @param track  weighted torque of the tracking laws without gravity [N m].
  /// @param scale  the largest torque of each joint [N m], > 0: see `torque_scale`.
  /// @param dt     time until the next call [s].
  /// Torques that are not finite change nothing.
  template <std::size_t N, Scalar T>
  [[nodiscard]] SKINCTL_INLINE Result detect(const Memory& memory, const JointTorque<N, T>& skin,
                                             const JointTorque<N, T>& track, const JointTorque<N, T>& scale,
                                             const T& dt) const noexcept {
    T square(0), product(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T per = T(1) / scale[i], pushed = per * skin[i];
      square = square + pushed * pushed;
      product = product + pushed * (per * track[i]);
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
