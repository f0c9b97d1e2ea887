// SPDX-License-Identifier: BSD-3-Clause
// Cartesian force control: a tool presses with a given force and tracks its pose in all other directions.
#pragma once

#include <cmath>

#include "skinctl/control/operational_control.hpp"
#include "skinctl/control/skin_cartesian_control.hpp"
#include "skinctl/math/tanh.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Goal of a `ForceControl`: direction and magnitude of the force.
template <Scalar T = double>
struct ForceGoal {
  Xyz<T> direction;  ///< direction along the axes of the base, of any length; 0: hold the present pose
  T force{0};        ///< force on the environment along the direction [N], >= 0

  template <class F>
  friend void each_number(ForceGoal& g, F&& f) {
    each_number(g.direction, f);
    f(g.force);
  }
};

/// Settings of `ForceControl`.
template <std::size_t N, Real T = double>
struct ForceSettings {
  OperationalSettings<N, T> pose = {};  ///< settings of the tracking in all other directions
  T K_p = T(0.002);    ///< speed per error of force [m/(s N)]; K_p k < 1/(4 lag) for a surface of k [N/m]
  T K_i1 = T(0.0005);  ///< gain of the integral of the error [m/(s^2 N)]
  T K_i2 = T(0.0005);  ///< gain of the integral of tanh(mu dF) [m/s^2]
  T mu = T(0.5);       ///< steepness of tanh [1/N]
  T max_velocity = T(0.05);  ///< speed of the approach without contact [m/s]
  T max_travel = T(0.3);     ///< largest travel of the tool along the direction, either way [m]
  Nanoseconds lag = 10ms;    ///< time constant of each of the two lags that smooth the speed
  /// The part of the contact's own torque that the law compensates: 1 on a torque interface, where the
  /// contact pushes the controlled robot itself, and where the same touch is in the sum; 0 for a virtual
  /// robot that does not feel the contact otherwise.
  T carried = T(0);
};

/// Settings of force control for this robot.
template <class Robot>
[[nodiscard]] ForceSettings<Robot::joints, typename Robot::scalar> force_settings(const Robot& robot) {
  using T = typename Robot::scalar;
  return {.pose = operational_settings(robot),
          .carried = Robot::interface == Interface::torque ? T(1) : T(0)};
}

/// The paper's ForceCart, after Cartesian sliding PID force/position control (Garcia-Valdovinos et al.,
/// 2005): with `dF = F_d - F` along the direction n, F from the skin (`touch_on_tool`), the target of an
/// `OperationalControl` moves along n at
///
///     v = sat(K_p dF + K_i1 int dF + K_i2 int tanh(mu dF)),
///
/// through two lags, so that velocity and acceleration of the target are true derivatives whatever the sensor
/// reports. Position across n and orientation are tracked. On a stiff surface `dF' = -k v`, so the force
/// converges without error; without contact the tool approaches at `max_velocity`. Integrals stop where v is
/// saturated (anti-windup), before the contact, and while the skin pushes against the law.
template <std::size_t N, std::size_t Ix, Frame P = Tool, Real T = double>
class ForceControl : public Composable {
 public:
  using Tracker = OperationalControl<N, Ix, P, T>;
  using Goal = ForceGoal<T>;
  using scalar = T;
  using Settings = ForceSettings<N, T>;
  using Surface = typename Tracker::Surface;
  static constexpr Needs needs = Tracker::needs | Needs{.angles = true, .touch = true};
  static constexpr std::size_t joints = N;
  static constexpr LawRole role = LawRole::tracking;
  static constexpr const char* name = "force";
  static constexpr bool presses = true;  ///< the law presses against a contact: the skin does not oppose it
  struct Memory {
    typename Tracker::Memory tracker;
    ForceGoal<T> goal{{T(0), T(0), T(0)}, T(0)};  ///< goal with a direction of length 1, or 0
    T v = T(0), a = T(0);  ///< speed of the target along the direction [m/s], and its derivative [m/s^2]
    T I1 = T(0), I2 = T(0);
    T travel = T(0);  ///< distance of the target along the direction since it was first asked for [m]
  };

  /// Throws `ConfigurationError` for settings that cannot work.
  explicit ForceControl(const Transform<Link<Ix>, P, T>& X_LP, const Settings& settings = {})
      : tracker_(OperationalSpace<N, Ix, P, T>(X_LP, settings.pose), settings.pose),
        X_LP_(X_LP),
        settings_(settings) {
    const auto check = [](bool allowed, const char* what, const T& x, const char* range) {
      require(allowed && x - x == T(0), what, static_cast<double>(x), range);
    };
    check(settings.K_p > T(0), "K_p of the force", settings.K_p, "> 0 m/(s N)");
    check(settings.K_i1 >= T(0), "K_i1 of the force", settings.K_i1, ">= 0");
    check(settings.K_i2 >= T(0), "K_i2 of the force", settings.K_i2, ">= 0");
    check(settings.mu > T(0), "mu of the force", settings.mu, "> 0 1/N");
    check(settings.max_velocity > T(0) && settings.max_velocity < settings.pose.max_linear_velocity,
          "max_velocity of the approach", settings.max_velocity, "> 0 and below max_linear_velocity");
    check(settings.max_travel > T(0), "max_travel", settings.max_travel, "> 0 m");
    check(settings.carried >= T(0) && settings.carried <= T(1), "carried", settings.carried, "0 to 1");
    require(settings.lag > 0ns && settings.lag <= 10s, "lag", milliseconds(settings.lag), "> 0 ms, <= 10 s");
  }
  /// A force control for a described robot, from which the settings follow.
  template <DescribedRobot R>
  ForceControl(const R& robot, const Transform<Link<Ix>, P, T>& X_LP)
      : ForceControl(X_LP, force_settings(robot)) {}
  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
  /// Throws `ConfigurationError` where dt or virtual dynamics are not those of the robot, and where the gains
  /// do not fit a limit of jerk.
  template <class Terms>
  void check_for(const Terms& terms) const {
    tracker_.check_for(terms);
  }

  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    Memory memory;
    memory.tracker = tracker_.start(known);
    return memory;
  }
  /// Takes a new direction and force; the target moves on from its present place. Speed, integrals and travel
  /// go on by their parts along the new direction, so the same goal in each cycle changes nothing, and goals
  /// in a row reach no further than `max_travel`; a direction of 0 or across begins anew. Refused if not
  /// finite or negative.
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K&, const Goal& goal) const noexcept {
    const T size = norm(goal.direction);
    const T sum = size + goal.force;
    if (!(sum - sum == T(0)) || goal.force < T(0)) return {memory, Reason::goal_refused};
    Received<Memory> out{memory, {}};
    out.memory.goal = {size > T(0) ? Xyz<T>(T(T(1) / size) * goal.direction) : goal.direction, goal.force};
    const T along = dot(memory.goal.direction, out.memory.goal.direction);
    for (T Memory::* part : {&Memory::v, &Memory::a, &Memory::travel})
      out.memory.*part = along * memory.*part;
    for (T Memory::* integral : {&Memory::I1, &Memory::I2})  // of the other way's errors nothing is left
      out.memory.*integral = along > T(0) ? T(along * memory.*integral) : T(0);
    return out;
  }

  /// The force with which the tool presses [N]: that of the skin against the direction.
  template <class K>
  [[nodiscard]] T force(const Memory& memory, const K& known) const noexcept {
    const auto J = known.template jacobian<Ix>(X_LP_);
    const auto inverse = damped_inverse(J, settings_.pose.singularities);
    return -dot(touch_on_tool(inverse, known).force, memory.goal.direction);
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE Surface now(const Memory& memory, const K& known) const noexcept {
    return tracker_.now(memory.tracker, known);
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const LawShare<T>& share,
                                                        const Surface& at_t) const noexcept {
    auto tau = tracker_.template torque<G>(memory.tracker, known, share, at_t);
    if (settings_.carried > T(0))
      tau -= T(share.feed_forward * settings_.carried) * SkinJointControl{}.torque(known);
    return tau;
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const LawShare<T>& share = {}) const noexcept {
    return torque<G>(memory, known, share, now(memory, known));
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& memory, const K& known, const T& dt, Opposition opposition,
                               const Surface& at_t) const noexcept {
    Memory next = memory;
    next.tracker = tracker_.advance(memory.tracker, known, dt, opposition, at_t);
    const T missing = memory.goal.force - force(memory, known);
    if (dot(memory.goal.direction, memory.goal.direction) > T(0) && missing - missing == T(0))
      move(next, missing, dt, opposition == Opposition::lasting);
    return next;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known, const T& dt,
                                              Opposition opposition) const noexcept {
    return advance(memory, known, dt, opposition, now(memory, known));
  }
  [[nodiscard]] Status status(const Memory& memory) const noexcept { return tracker_.status(memory.tracker); }

 private:
  void move(Memory& m, const T& missing, const T& dt, bool held) const noexcept {
    using std::sqrt;
    const auto& s = settings_;
    T asked = s.K_p * missing + s.K_i1 * m.I1 + s.K_i2 * m.I2;
    const bool saturated = detail::magnitude(asked) > s.max_velocity && asked * missing > T(0);
    const bool touches = missing < T(0.9) * m.goal.force;  // nothing is integrated before the contact
    if (!held && !saturated && touches) {
      m.I1 = bounded(m.I1 + dt * missing, s.K_i1);
      T steep[1] = {s.mu * missing}, sign[1];
      math::tanh<1>(steep, sign);
      m.I2 = bounded(m.I2 + dt * sign[0], s.K_i2);
    }
    asked = asked / sqrt(T(1) + asked * asked / (s.max_velocity * s.max_velocity));
    if (held || (m.travel * asked > T(0) && detail::magnitude(m.travel) > s.max_travel)) asked = T(0);
    const T w = T(1) / seconds<T>(s.lag);
    m.a = (m.a + w * w * dt * (asked - m.v)) / (T(1) + w * dt * (T(2) + w * dt));
    m.v = m.v + dt * m.a;
    m.travel = m.travel + dt * m.v;
    const Xyz<T> n = m.goal.direction;
    const auto& X_BP = tracker_.target(m.tracker).X_BP;
    m.tracker = Tracker::with_target(
        m.tracker, {Transform<Base, P, T>::trusted(X_BP.axes(), X_BP.origin() + T(dt * m.v) * n),
                    {m.v * n, {T(0), T(0), T(0)}},
                    {m.a * n, {T(0), T(0), T(0)}}});
  }
  /// An integral, cut off where it alone would saturate the speed.
  T bounded(const T& integral, const T& gain) const noexcept {
    const T limit = gain > T(0) ? T(settings_.max_velocity / gain) : T(1);
    return integral > limit ? limit : (integral < -limit ? T(-limit) : integral);
  }

  Tracker tracker_;
  Transform<Link<Ix>, P, T> X_LP_;
  Settings settings_;
};
template <DescribedRobot R, std::size_t Ix, Frame P>
ForceControl(const R&, const Transform<Link<Ix>, P, typename R::scalar>&)
    -> ForceControl<R::joints, Ix, P, typename R::scalar>;

SKINCTL_END_NAMESPACE
