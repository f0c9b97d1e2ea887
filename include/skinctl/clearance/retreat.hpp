// SPDX-License-Identifier: BSD-3-Clause
// Away from what comes near: velocities of all joints, for whoever has nothing else to do meanwhile.
#pragma once

#include "skinctl/clearance/clearances.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Speeds and distances of a retreat.
struct RetreatSettings {
  double speed = 0.45;     ///< speed away from an obstacle within `near` [m/s]; above the obstacle's speed
  double near = 0.1;       ///< distance of the surfaces at which the full `speed` is asked for [m]
  double far = 0.2;        ///< distance at which a retreat begins [m], > near; in between, speeds are linear
  double rate = 4;         ///< largest closing speed of other pairs over `distance - margin` [1/s]
  double max_speed = 1.5;  ///< largest speed of a joint [rad/s]
  double softness = 0.1;   ///< lever arm of the joints at which half of a speed is reached [m]
  double return_rate = 0.3;  ///< largest speed of a joint towards the posture [rad/s]
};

/// Velocities that lead the links of a `ClearanceAround` away from obstacles that approach, with the joints
/// that need the least speed for it:
///
///     min |dq - dq_p|^2  with  g_k dq >= b_k,
///
/// g_k the gradient of the distance d_k, `b_k = speed (far - d_k) / (far - near)`, at most `speed`, for an
/// obstacle that approaches, `b_k = -rate (d_k - margin)` for all other pairs, dq_p slowly back to a posture,
/// so that the robot does not fold while it retreats. What cannot be had at once is a compromise, in which
/// the robot's own pairs weigh most. A push of the cells, by contrast, gives a link the speed that its mass
/// and the number of cells that see allow.
///
/// It is a wish, for `VelocityControl`; what holds is the limit `ClearanceLimits`. Immutable; a fixed number
/// of rounds.
template <RobotModel M, std::size_t Around, Real T = double>
class Retreat {
 public:
  static constexpr std::size_t joints = M::joints;
  using Position = JointPosition<joints, T>;
  using Velocity = JointVelocity<joints, T>;
  using Near = Surroundings<Around, Base, T>;
  /// Treatment of obstacles that do not approach by themselves: other robots.
  enum class Others : unsigned char { stay, press };

  /// Throws `ConfigurationError` as `Clearances` does, and for settings out of their range.
  SKINCTL_COLD Retreat(const M& model, const ClearanceAround<Around>& given, const Position& posture,
                       const RetreatSettings& s = {})
      : clearances_(model, given.own, given.exposed), posture_(posture), s_(s), margin_(T(given.own.margin)) {
    const auto check = [](double x, double least, double most, const char* what, const char* range) {
      require(x > least && x <= most, what, x, range);
    };
    check(s.speed, 0, 10, "Retreat: speed", "> 0, <= 10 m/s");
    check(s.near, 0, 10, "Retreat: near", "> 0, <= 10 m");
    check(s.far, s.near, 10, "Retreat: far", "> near, <= 10 m");
    check(s.rate, 0, 1e3, "Retreat: rate", "> 0, <= 1000 1/s");
    check(s.max_speed, 0, 100, "Retreat: max_speed", "> 0, <= 100 rad/s");
    check(s.softness, 0, 10, "Retreat: softness", "> 0, <= 10 m");
    require(s.return_rate >= 0 && s.return_rate <= s.max_speed, "Retreat: return_rate", s.return_rate,
            "0 to max_speed");
  }
  [[nodiscard]] const RetreatSettings& settings() const noexcept { return s_; }

  /// The joint velocities of a robot at `q` beside the obstacles `near` [rad/s]; `wish` is added to the way
  /// back to its posture. Zero if a number is not finite.
  [[nodiscard]] SKINCTL_NOINLINE Velocity operator()(const Position& q, const Near& near,
                                                     Others others = Others::stay,
                                                     const Velocity& wish = {}) const noexcept {
    constexpr std::size_t most = Clearances<M, T, Around>::max_pairs;
    T distance[most], gradient[most][joints];
    clearances_.distances(q, near, distance, [](std::size_t) { return true; });
    clearances_.gradients(q, near, gradient);
    Velocity u;
    T at(0);
    for (const T& x : q) at = at + x;
    if (!(at - at == T(0))) return u;
    for (std::size_t i = 0; i < joints; ++i) u[i] = wish[i] + limited(posture_[i] - q[i], T(s_.return_rate));
    struct Row {
      std::size_t of;
      T wanted, soft, square, given;
    };
    Row rows[most];
    std::size_t count = 0;
    for (std::size_t k = 0; k < clearances_.size(near); ++k) {
      const bool comes =
          k >= clearances_.size() && (clearances_.approach(k, near) > T(0) || others == Others::press);
      const T d = distance[k];
      if (!(d < T(comes ? s_.far : s_.far + double(margin_)))) continue;
      const T share = (T(s_.far) - d) / T(s_.far - s_.near);
      const T soft = comes ? T(s_.softness) : T(0.01);
      Row r{k, comes ? T(T(s_.speed) * (share > T(1) ? T(1) : share)) : T(-T(s_.rate) * (d - margin_)),
            soft * soft, T(0), T(0)};
      for (const T& g : gradient[k]) r.square = r.square + g * g;
      if (r.square > T(1e-6)) rows[count++] = r;
    }
    // Hildreth's method on the dual, each row made soft.
    for (int round = 0; round < 30; ++round)
      for (std::size_t k = 0; k < count; ++k) {
        Row& r = rows[k];
        T opens(0);
        for (std::size_t i = 0; i < joints; ++i) opens = opens + gradient[r.of][i] * u[i];
        const T step = (r.wanted - opens - r.soft * r.given) / (r.square + r.soft);
        const T change = r.given + step > T(0) ? step : T(-r.given);
        r.given = r.given + change;
        for (std::size_t i = 0; i < joints; ++i) u[i] = u[i] + change * gradient[r.of][i];
      }
    T sum(0), largest(s_.max_speed);
    for (const T& v : u) sum = sum + v, largest = v > largest ? v : -v > largest ? T(-v) : largest;
    if (!(sum - sum == T(0))) return {};
    for (T& v : u) v = T(s_.max_speed) / largest * v;
    return u;
  }

 private:
  [[nodiscard]] static T limited(const T& x, const T& most) noexcept {
    return x > most ? most : x < -most ? T(-most) : x;
  }

  Clearances<M, T, Around> clearances_;
  Position posture_;
  RetreatSettings s_;
  T margin_;
};

SKINCTL_END_NAMESPACE
