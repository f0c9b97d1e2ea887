// SPDX-License-Identifier: BSD-3-Clause
// The torque of contacts from motor torques and measured motion alone: the residual of generalised momentum.
#pragma once

#include <cmath>
#include <optional>

#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/dynamics/friction.hpp"
#include "skinctl/dynamics/momentum_rate.hpp"
#include "skinctl/dynamics/rotor_inertia.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The time, or interval, to which a reported motor torque belongs.
enum class MotorSampling : unsigned char {
  instant,  ///< torque at the time of the state
  mean      ///< mean torque since the last state: nothing that a servo does between two samples is missed
};

/// The momentum observer of De Luca and Mattone (2005): with the joints' momentum `p = (M + rotors) dq`,
///
///     dp/dt = tau_motor - friction(dq) + C' dq - G + tau_ext,     dr/dt = rate (tau_ext - r).
///
/// The residual `r` is the torque of everything that is not in the model: contacts, but also a wrong payload
/// and friction that is not declared. No acceleration is measured, no matrix inverted.
///
/// **Sampled.** Between two samples, `e = (p1 - p0)/dt - (b0 + b1)/2` with `b = tau_motor - friction + C'
/// dq - G` is the mean external torque over dt but for the trapezoid's error, and `r += (1 - exp(-rate dt))
/// (e - r)`: the filter is exact for a constant e, and stable for any rate and dt. Samples may be lost or
/// irregular. With `MotorSampling::mean` the motors' torque enters e as it is. A stiff servo that follows
/// held commands is faster than an 8 ms cycle, so its torque at one instant says little of the interval: an
/// arm in MuJoCo then felt its own motion and did not come to rest. A driver that sees more samples than
/// cycles averages them.
///
/// **Lag and noise.** A step shows to 63 % after `1/rate`. Noise sigma of dq gives r a deviation of about
/// `M_ii sigma rate` (dt rate small), at most `sqrt(2) M_ii sigma / dt`.
template <RobotModel M, Real T = double>
class MomentumObserver {
 public:
  static constexpr std::size_t joints = M::joints;
  using Friction = JointFriction<joints, T>;
  struct Settings {
    T rate = T(25);                         ///< gain of the observer, its filter's rate [1/s], > 0, <= 1e4
    RotorInertia<joints, T> rotors = {};    ///< reflected inertia of the motors
    std::optional<Friction> friction = {};  ///< friction that is taken off the motor torques
    MotorSampling motors = MotorSampling::instant;
    Nanoseconds max_gap = 100ms;  ///< longest gap between samples; after a longer one r starts anew at 0
  };
  struct Memory {
    bool started = false;
    Nanoseconds stamp{};                ///< stamp of the last sample
    JointMomentum<joints, T> momentum;  ///< generalised momentum at `stamp`
    JointTorque<joints, T> drive;       ///< torque b at `stamp` [N m], less the motors' where it is a mean
    JointTorque<joints, T> residual;    ///< r, the residual [N m]
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  /// Throws `ConfigurationError` for a number out of its range. The model carries the payload: see `Loaded`.
  SKINCTL_COLD explicit MomentumObserver(const M& model, const Settings& settings = {})
      : model_(model), s_(settings) {
    require(s_.rate > T(0) && s_.rate <= T(1e4), "MomentumObserver: rate", double(s_.rate),
            "> 0, <= 1e4 1/s");
    require(s_.max_gap > 0ns && s_.max_gap <= 10s, "MomentumObserver: max_gap", milliseconds(s_.max_gap),
            "> 0 ms, <= 10 s");
  }
  [[nodiscard]] const M& model() const noexcept { return model_; }
  /// The torque that the motors would need on a base at rest [N m].
  /// @param adds  torque that they bear for the motion of the base, see `base_torque` [N m].
  [[nodiscard]] static JointTorque<joints, T> at_rest(const JointTorque<joints, T>& motor,
                                                      const JointTorque<joints, T>& adds) noexcept {
    return motor - adds;
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// Takes a measured state and the motors' torque at the joints at that time (current times torque constant
  /// and gear ratio) [N m]; the residual is in the memory.
  ///
  /// Ignored and reported: numbers that are not finite or absurd (`sample_not_finite`), a stamp that is not
  /// later than the last one (`time_backwards`). The next good sample bridges the gap.
  Status observe(Memory& memory, const State<joints, T>& measured,
                 const JointTorque<joints, T>& motor) const noexcept {
    using std::exp;
    T sum(0);
    for (std::size_t i = 0; i < joints; ++i) sum = sum + motor[i] * T(0);
    if (!detail::is_plausible(measured) || !detail::is_plausible(measured.time) || !(sum == T(0)))
      return Reason::sample_not_finite;
    if (memory.started && measured.time <= memory.stamp) return Reason::time_backwards;

    auto now = momentum_rate(model_, measured.q, measured.dq);
    for (std::size_t i = 0; i < joints; ++i) {
      now.momentum[i] = now.momentum[i] + s_.rotors[i] * measured.dq[i];
      if (s_.motors == MotorSampling::instant) now.drift[i] = now.drift[i] + motor[i];
    }
    if (s_.friction) now.drift = now.drift - s_.friction->torque(measured.dq);
    if (!memory.started || measured.time - memory.stamp > s_.max_gap) {
      memory.residual = {};
    } else {
      const T dt = seconds<T>(measured.time - memory.stamp), share = T(1) - exp(-s_.rate * dt);
      for (std::size_t i = 0; i < joints; ++i) {
        T mean = (now.momentum[i] - memory.momentum[i]) / dt - T(0.5) * (memory.drive[i] + now.drift[i]);
        if (s_.motors == MotorSampling::mean) mean = mean - motor[i];
        memory.residual[i] = memory.residual[i] + share * (mean - memory.residual[i]);
      }
    }
    memory.started = true;
    memory.stamp = measured.time;
    memory.momentum = now.momentum;
    memory.drive = now.drift;
    return {};
  }

 private:
  [[no_unique_address]] M model_;
  Settings s_;
};

SKINCTL_END_NAMESPACE
