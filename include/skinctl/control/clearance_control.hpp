// Clearance Control: links push themselves off each other and off known objects before a limit has to stop them.
#pragma once

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/tactile/clearances.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The clearances of a robot as a law: a pair that is nearer than `range` is pushed apart as by a cell that sees
/// it, `tau = sum_k force (1 - (d_k - margin) / (range - margin)) dd_k/dq`, at most `force` each. Its work is the
/// controller's own: a tank pays for it, and with an empty one only `ClearanceLimits` holds. Section 6 of the
/// paper avoids what proximity sees; this is the same for what is known.
template <RobotModel M, Real T = double>
class ClearanceControl : public StatelessLaw<ClearanceControl<M, T>> {
 public:
  static constexpr Needs needs = {};
  static constexpr const char* name = "clearance";
  static constexpr std::size_t joints = M::joints;
  struct Settings {
    double force = 20;   ///< on each pair, at the margin [N]
    double range = 0.1;  ///< distance from which it is pushed apart [m], > margin
  };

  /// Throws `ConfigurationError` as `Clearances` does, and for settings out of their range.
  SKINCTL_COLD ClearanceControl(const M& model, const Clearance& given, const Settings& s)
      : clearances_(model, given), margin_(T(given.margin)), range_(T(s.range)), force_(T(s.force)) {
    require(s.range > given.margin && s.range <= 10, "ClearanceControl: range", s.range, "> margin, <= 10 m");
    require(s.force >= 0 && s.force <= 1e4, "ClearanceControl: force", s.force, "0 to 1e4 N");
  }

  template <class K>
  [[nodiscard]] JointTorque<joints, T> torque(const K& known) const noexcept {
    static_assert(K::joints == joints, "clearances of another robot");
    JointTorque<joints, T> tau;
    T distance[Clearances<M, T>::most_pairs], gradient[Clearances<M, T>::most_pairs][joints];
    clearances_.distances(known.q(), distance);
    bool any = false;
    for (std::size_t k = 0; k < clearances_.size(); ++k) any = any || distance[k] < range_;
    if (!any) return tau;
    clearances_.gradients(known.q(), gradient);
    for (std::size_t k = 0; k < clearances_.size(); ++k) {
      const T near = (range_ - distance[k]) / (range_ - margin_), push = near > T(1) ? T(1) : near;
      if (!(push > T(0))) continue;
      for (std::size_t i = 0; i < joints; ++i) tau[i] = tau[i] + force_ * push * gradient[k][i];
    }
    return tau;
  }

 private:
  Clearances<M, T> clearances_;
  T margin_, range_, force_;
};

SKINCTL_END_NAMESPACE
