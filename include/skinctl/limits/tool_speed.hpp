// A limit on the speed of a point of the robot, such as its tool.
#pragma once

#include <cmath>

#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The largest speed [m/s] of a point fixed to link `I`, kept by slowing all joints alike.
///
/// At constant joint velocities the point gets faster as the arm stretches. So the limited quantity is the
/// largest speed of the point while all joints brake together from here, at the rate of the weakest: with
/// `v = |J u|`, growth `K = R (sum |u_i|)^2` and rate `a = min A_i / |u_i|`, that is v if `K <= a v`, else at
/// most `2/3 v + K/(3 a)`. After a motion by `scale` it can always be kept.
template <RobotModel M, std::size_t I, Real T = double>
class ToolSpeed {
 public:
  static_assert(I < M::joints, "the speed of a link that the model does not have");
  static constexpr std::size_t joints = M::joints;
  static constexpr std::size_t link = I;

  struct Values {
    T speed;                            ///< [m/s], > 0
    Xyz<T> point = {T(0), T(0), T(0)};  ///< in the axes of link `I`, from its origin [m]
    T reach;                            ///< R: largest distance of the point from any joint axis [m]
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD ToolSpeed(const M& model, const JointLimits<joints, T>& limits, const Values& values)
      : model_(model), limits_(limits), values_(values) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(values.speed > T(0) && values.speed <= T(100), "tool speed", number(values.speed),
            "> 0, <= 100 m/s");
    require(values.reach > T(0) && values.reach <= T(100), "reach of the tool", number(values.reach),
            "> 0, <= 100 m");
    require(dot(values.point, values.point) <= T(1e4), "point of the tool",
            number(dot(values.point, values.point)), "within 100 m of its link");
  }

  [[nodiscard]] T limit() const noexcept { return values_.speed; }
  [[nodiscard]] const M& model() const noexcept { return model_; }

  /// The point's velocity per joint velocity at `q`, for several queries.
  class At {
   public:
    /// `|J u|` [m/s].
    [[nodiscard]] SKINCTL_INLINE T speed(const JointVelocity<joints, T>& u) const noexcept {
      using std::sqrt;
      Xyz<T> v{T(0), T(0), T(0)};
      for (std::size_t i = 0; i < joints; ++i) v = v + u[i] * column_[i];
      return sqrt(dot(v, v));
    }
    /// Whether a motion that reaches `u` over `path`, the sum of the joints' paths, and brakes from there,
    /// keeps the limit. False for NaN.
    [[nodiscard]] SKINCTL_INLINE bool keeps(const JointVelocity<joints, T>& u, const T& path) const noexcept {
      T sum(0), rate = std::numeric_limits<T>::infinity();
      for (std::size_t i = 0; i < joints; ++i) {
        const T w = u[i] < T(0) ? T(-u[i]) : u[i];
        sum = sum + w;
        if (w * rate > of_.limits_.acceleration()[i]) rate = of_.limits_.acceleration()[i] / w;
      }
      const T R = of_.values_.reach, v = speed(u) + R * path * sum, growth = R * sum * sum;
      if (growth <= rate * v) return v <= of_.limit();
      return T(2) * v + growth / rate <= T(3) * of_.limit();
    }

   private:
    friend ToolSpeed;
    At(const ToolSpeed& of, const JointPosition<joints, T>& q) noexcept : of_(of) {
      const auto J = jacobian<I>(Poses<M, closure<M>(link_bit<I>), T>(of.model_, q), at(of.values_.point));
      J.for_each([&](auto i, const auto& c) { column_[i.value] = c.linear; });
    }
    static Transform<Link<I>, Cell, T> at(const Xyz<T>& p) noexcept {
      return Transform<Link<I>, Cell, T>::trusted(
          {Xyz<T>{T(1), T(0), T(0)}, Xyz<T>{T(0), T(1), T(0)}, Xyz<T>{T(0), T(0), T(1)}}, p);
    }
    const ToolSpeed& of_;
    Xyz<T> column_[joints] = {};
  };
  [[nodiscard]] SKINCTL_INLINE At at(const JointPosition<joints, T>& q) const noexcept {
    return At(*this, q);
  }

  /// The share in [0, 1] of `u` with which the point keeps the limit for the next `time` seconds: the root of
  /// `s v + s^2 K time = limit`. 0 for NaN.
  [[nodiscard]] SKINCTL_NOINLINE T share(const JointPosition<joints, T>& q, const JointVelocity<joints, T>& u,
                                         const T& time) const noexcept {
    using std::sqrt;
    T sum(0);
    for (std::size_t i = 0; i < joints; ++i) sum = sum + (u[i] < T(0) ? T(-u[i]) : u[i]);
    const T v = at(q).speed(u), growth = values_.reach * sum * sum * time, most = limit();
    if (v + growth <= most) [[likely]]
      return T(1);
    const T s = T(2) * most / (v + sqrt(v * v + T(4) * growth * most));
    return s > T(0) ? s : T(0);
  }

  /// The step from `u0` to `u1` over `h` seconds as far as it keeps the limit: `u1` if it does, else its mix
  /// with the motion that brakes all joints alike from u0; that motion alone if no mix does.
  [[nodiscard]] SKINCTL_NOINLINE JointVelocity<joints, T> within(const JointPosition<joints, T>& q,
                                                                 const JointVelocity<joints, T>& u0,
                                                                 const JointVelocity<joints, T>& u1,
                                                                 const T& h) const noexcept {
    const At here = at(q);
    const auto path = [&](const JointVelocity<joints, T>& u) {
      T sum(0);
      for (std::size_t i = 0; i < joints; ++i) {
        const T way = T(0.5) * h * (u0[i] + u[i]);
        sum = sum + (way < T(0) ? T(-way) : way);
      }
      return sum;
    };
    if (here.keeps(u1, path(u1))) [[likely]]
      return u1;
    T rate(0);  // the weakest joint stops last
    for (std::size_t i = 0; i < joints; ++i) {
      const T stop = (u0[i] < T(0) ? T(-u0[i]) : u0[i]) / limits_.acceleration()[i];
      if (stop > rate) rate = stop;
    }
    const T left = rate > h ? T(T(1) - h / rate) : T(0);
    T good(0), bad(1);
    JointVelocity<joints, T> out = left * u0;
    for (int k = 0; k < 16; ++k) {
      const T part = T(0.5) * (good + bad);
      JointVelocity<joints, T> u;
      for (std::size_t i = 0; i < joints; ++i) u[i] = left * u0[i] + part * (u1[i] - left * u0[i]);
      const bool keeps = here.keeps(u, path(u));
      if (keeps) out = u;
      (keeps ? good : bad) = part;
    }
    return out;
  }

 private:
  [[no_unique_address]] M model_;
  JointLimits<joints, T> limits_;
  Values values_;
};

SKINCTL_END_NAMESPACE
