// SPDX-License-Identifier: BSD-3-Clause
// Impacts and slips that the accelerometers of cells feel.
#pragma once

#include <cmath>

#include "skinctl/core/state.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/kinematics/jacobian_rate.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The proper acceleration of a cell at `X_LC` on link `Ix`, along its own axes [m/s^2], as an ideal
/// accelerometer reads it: that of its place, less gravity. At rest it points upwards.
///
/// @param ddq  of the joints, for example from differences of their speeds.
/// @param up   minus gravity, along the base's axes.
template <std::size_t Ix, RobotModel M, Real T>
[[nodiscard]] Xyz<T> proper_acceleration(const M& model, const State<M::joints, T>& state,
                                         const JointAcceleration<M::joints, T>& ddq,
                                         const Transform<Link<Ix>, Cell, T>& X_LC,
                                         const Xyz<T>& up = {T(0), T(0), T(9.80665)}) noexcept {
  const Poses<M, closure<M>(link_bit<Ix>), T> poses(model, state.q);
  const Xyz<T> a = acceleration(jacobian<Ix>(poses, X_LC), state.dq, ddq).linear + up;
  const auto X = poses.template get<Ix>() * X_LC;
  return {dot(X.axis_x(), a), dot(X.axis_y(), a), dot(X.axis_z(), a)};
}

/// Impacts and slips at one cell, from its accelerometer.
///
/// - **Impact**: the reading differs from the link's predicted acceleration by more than `impact`.
/// - **Slip**: the squared second differences of what is left of the readings, over `window`, exceed `slip`
///   times what they are when nothing happens. The motion of an arm is smooth: its second differences are as
///   small as those of noise. The calm level is learnt over `learn`; a slip raises it by a third of its own
///   at most, so that one that lasts is not forgotten.
///
/// The defaults are for an arm that stands still, or whose motion is known at the rate of the cells. On a
/// real one that moves at 0.3 m/s, predicted from poses at 15 Hz, up to 10 m/s^2 are left and it vibrates 290
/// times as much as at rest (`touch_motion_test`): ask at rest, or set `impact` and `slip` from a recording
/// of the arm (`MotionThresholds`).
///
/// Second differences allow for samples that come irregularly; a gap of more than `window` begins anew.
template <Real T = double>
class TouchMotion {
 public:
  struct Settings {
    T impact = T(1);            ///< difference from the predicted acceleration that is an impact [m/s^2], > 0
    T slip = T(6);              ///< squared second differences, over their calm level, that are a slip, > 1
    Nanoseconds window = 40ms;  ///< time constant of the mean of squared second differences, > 0
    Nanoseconds learn = 10s;    ///< time constant of the calm level, > `window`
    T noise = T(0.05);  ///< expected standard deviation of an axis, where learning begins [m/s^2], > 0
  };
  /// Trivially copyable; `Memory{}` has heard nothing.
  struct Memory {
    /// Residual accelerations of the last sample and of the one before [m/s^2].
    Xyz<T> last = {T(0), T(0), T(0)}, before = {T(0), T(0), T(0)};
    Nanoseconds time = Nanoseconds::min();
    T step = T(0);                 ///< time between the last two samples [s]
    T energy = T(0), calm = T(0);  ///< mean squares of second differences: of the window, when calm
    int samples = 0;               ///< samples since the last gap, at most 3
    bool slipping = false;
  };
  struct Felt {
    bool impact = false, slip = false;
    T residual = T(0);   ///< size of the difference [m/s^2]
    T vibration = T(0);  ///< mean square of second differences over the calm one
  };

  /// Throws `ConfigurationError` for a setting out of its range.
  SKINCTL_COLD explicit TouchMotion(const Settings& s = {})
      : s_(s), window_(seconds<T>(s.window)), learn_(seconds<T>(s.learn)) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(s.impact > T(0) && s.impact <= T(1e4), "TouchMotion: impact", number(s.impact), "> 0 m/s^2");
    require(s.slip > T(1) && s.slip <= T(1e6), "TouchMotion: slip", number(s.slip), "> 1");
    require(s.window > 0ns && s.window <= 1s, "TouchMotion: window", milliseconds(s.window),
            "> 0, <= 1000 ms");
    require(s.learn > s.window && s.learn <= 1000s, "TouchMotion: learn", seconds<double>(s.learn),
            "> window, <= 1000 s");
    require(s.noise > T(0) && s.noise <= T(100), "TouchMotion: noise", number(s.noise), "> 0 m/s^2");
  }

  /// A reading of the cell, and what the link's motion predicts there. A reading or prediction that is not
  /// finite, or not later than the last one, is ignored.
  Felt take(Memory& m, Nanoseconds time, const Xyz<T>& reading, const Xyz<T>& predicted) const noexcept {
    using std::exp;
    using std::sqrt;
    const Xyz<T> r = reading - predicted;
    const T square = dot(r, r);
    if (!(square - square == T(0)) || (m.samples > 0 && time <= m.time)) return {};
    Felt out;
    out.residual = sqrt(square);
    out.impact = out.residual > s_.impact;
    const T h = m.samples > 0 ? seconds<T>(elapsed_from(m.time, time)) : T(0);
    if (h > window_) m.samples = 0, m.energy = m.calm, m.slipping = false;
    if (m.calm == T(0)) m.energy = m.calm = T(18) * s_.noise * s_.noise;  // three axes, 1 + 4 + 1
    if (m.samples >= 2) {
      const Xyz<T> second = (r - m.last) - (h / m.step) * (m.last - m.before);
      // As at equal steps, where noise has 1 + 4 + 1 of its square.
      const T ratio = h / m.step, weight = T(6) / (T(1) + (T(1) + ratio) * (T(1) + ratio) + ratio * ratio);
      const T now = weight * dot(second, second);
      m.energy = m.energy + (T(1) - exp(-h / window_)) * (now - m.energy);
      const T most = T(1.333) * m.calm, seen = m.energy < most ? m.energy : most;
      if (!m.slipping) m.calm = m.calm + (T(1) - exp(-h / learn_)) * (seen - m.calm);
      out.vibration = m.energy / m.calm;
      m.slipping = out.vibration > s_.slip || (m.slipping && T(2) * out.vibration > s_.slip);
      out.slip = m.slipping;
    }
    m.before = m.last, m.last = r, m.time = time, m.step = h;
    if (m.samples < 3) ++m.samples;
    return out;
  }

 private:
  static Nanoseconds elapsed_from(Nanoseconds from, Nanoseconds to) noexcept {
    constexpr Nanoseconds longest = 1000s;
    return from < to - longest ? longest : to - from;
  }
  Settings s_;
  T window_, learn_;
};

/// Thresholds of `TouchMotion` for an arm that shakes or whose motion is predicted late: what nobody touched,
/// times a margin. Fed with a recording of the arm's own motion (a minute of all that it will do, untouched).
template <Real T = double>
class MotionThresholds {
 public:
  /// @param like  the settings but for `impact` and `slip`.
  SKINCTL_COLD explicit MotionThresholds(const typename TouchMotion<T>::Settings& like = {})
      : settings_(like), judge_(like) {}

  /// As `TouchMotion::take`.
  void take(Nanoseconds time, const Xyz<T>& reading, const Xyz<T>& predicted) noexcept {
    const auto felt = judge_.take(memory_, time, reading, predicted);
    residual_ = felt.residual > residual_ ? felt.residual : residual_;
    vibration_ = felt.vibration > vibration_ ? felt.vibration : vibration_;
  }
  /// Another cell, or another recording: the clock and the calm level begin anew.
  void begin() noexcept { memory_ = {}; }

  /// `margin` times the largest residual and vibration taken, but never below the settings given.
  /// Throws `ConfigurationError` for a margin below 1, or above 100.
  [[nodiscard]] SKINCTL_COLD typename TouchMotion<T>::Settings settings(const T& margin = T(1.5)) const {
    require(margin >= T(1) && margin <= T(100), "MotionThresholds: margin", static_cast<double>(margin),
            ">= 1, <= 100");
    auto s = settings_;
    s.impact = margin * residual_ > s.impact ? margin * residual_ : s.impact;
    s.slip = margin * vibration_ > s.slip ? margin * vibration_ : s.slip;
    return s;
  }

 private:
  typename TouchMotion<T>::Settings settings_;
  TouchMotion<T> judge_;
  typename TouchMotion<T>::Memory memory_;
  T residual_ = T(0), vibration_ = T(0);
};

SKINCTL_END_NAMESPACE
