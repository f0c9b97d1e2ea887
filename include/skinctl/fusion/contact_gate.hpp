// SPDX-License-Identifier: BSD-3-Clause
// Gates by contact: laws that act only while something touches the robot, or only while nothing does.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/law/detail/check_law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Thresholds from which the robot counts as touched, on the norm of the skin's joint torque with its
/// configured weight.
struct ContactSettings {
  double on = 1.0;                    ///< torque above which the robot counts as touched [N m]
  double off = 0.5;                   ///< torque below which the robot counts as released [N m]
  Nanoseconds release_after = 100ms;  ///< time below `off` after which the robot counts as released
};

/// Detects contact: from `|tau_skin| > on` until `|tau_skin| < off` has held without a break for
/// `release_after`.
class ContactDetector {
 public:
  struct Memory {
    Nanoseconds quiet{};  ///< time for which the torque has been below `off`
    bool touched = false;
  };
  /// Throws `ConfigurationError` unless `on >= off >= 1e-9` (its square is compared) and `0 <= release_after
  /// <= 1 h`.
  explicit ContactDetector(const ContactSettings& settings = {}) : settings_(settings) {
    require(settings.off >= 1e-9 && settings.off <= 1e9, "contact: off", settings.off, ">= 1e-9 N m");
    require(settings.on >= settings.off && settings.on <= 1e9, "contact: on", settings.on, ">= off, in N m");
    require(settings.release_after >= 0ns && settings.release_after <= 1h, "contact: release_after",
            seconds<double>(settings.release_after), "0 to 3600 s");
  }
  [[nodiscard]] const ContactSettings& settings() const noexcept { return settings_; }

  /// The memory `dt` later. A torque that is not finite counts as neither above `on` nor below `off`.
  template <std::size_t N, Scalar T>
  [[nodiscard]] SKINCTL_INLINE Memory advanced(const Memory& memory, const JointTorque<N, T>& skin,
                                               Nanoseconds dt) const noexcept {
    T square(0);
    for (std::size_t i = 0; i < N; ++i) square = square + skin[i] * skin[i];
    const T on = static_cast<T>(settings_.on), off = static_cast<T>(settings_.off);
    if (!memory.touched) return {0ns, square > on * on};
    const Nanoseconds quiet = square < off * off ? memory.quiet + dt : 0ns;
    return quiet > settings_.release_after ? Memory{} : Memory{quiet, true};
  }

 private:
  ContactSettings settings_;
};

/// The state of contact that opens a gate.
enum class TouchGate : unsigned char { touched, untouched };

/// A law that acts only while the robot is touched, or only while it is not. Needs a blended sum.
template <TouchGate G, class L>
struct Gated : L {
  static constexpr TouchGate gate = G;
  explicit Gated(const L& law) : L(law) {}
};

/// `law`, acting only while the robot is touched.
template <class L>
  requires(detail::law_in_sum<L>::role != LawRole::gravity)
[[nodiscard]] auto when_touched(const L& law) {
  static_assert(sizeof(detail::Say<detail::fault_in_sum<L>(), L>) > 0);
  return Gated<TouchGate::touched, detail::law_in_sum<L>>(law);
}
/// `law`, acting only while nothing touches the robot.
template <class L>
  requires(detail::law_in_sum<L>::role != LawRole::gravity)
[[nodiscard]] auto when_untouched(const L& law) {
  static_assert(sizeof(detail::Say<detail::fault_in_sum<L>(), L>) > 0);
  return Gated<TouchGate::untouched, detail::law_in_sum<L>>(law);
}
// clang-format off
template <class L>
L when_touched(const L&) = delete;  // gravity is always held: no gate
template <class L>
L when_untouched(const L&) = delete;  // gravity is always held: no gate
// clang-format on

SKINCTL_END_NAMESPACE
