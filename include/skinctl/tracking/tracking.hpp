// SPDX-License-Identifier: BSD-3-Clause
// The second-order sliding mode of eqs. (8)-(14), in joint or operational space, for any plan of targets.
#pragma once

#include "skinctl/tracking/check_terms.hpp"
#include "skinctl/tracking/detail/tracking_reset.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Tracking, eqs. (8)-(14): `tau = -K_d S_q + Y_r Theta`, evaluated at the middle of the interval for which
/// it will be held, at the state that the law predicts there.
///
/// Every reset (a new goal, the skin that begins or ceases to push against the law) keeps the torque and its
/// rate: the reference motion continues from its old values and reaches its new course after
/// `bumpless_transfer` (`SurfaceBias`). In the loop nothing is refused but goals. For a state that is not
/// finite the torque is not finite either, so that the cycle drops it; the memory stays finite.
///
/// @tparam Space  the coordinates: `JointSpace` or `OperationalSpace`.
/// @tparam Plan   the source of targets: a spline to a goal, or samples from outside.
template <class Space, class Plan, class Damping = InertialDamping<typename Space::scalar>>
class Tracking : public detail::TrackingReset<Space, Plan, Damping> {
  using Reset = detail::TrackingReset<Space, Plan, Damping>;
  using Reset::begin_bias;
  using Reset::begin_gain;
  using Reset::bound_integrals;
  using Reset::bumpless_transfer;
  using Reset::damping_;
  using Reset::gains;
  using Reset::gains_;
  using Reset::look;
  using Reset::schedule_;
  using Reset::settings_;
  using Reset::space_;
  using Reset::stepped;
  using Reset::switched;
  using Reset::time_to_accelerate;

 public:
  using Reset::coordinates;
  using Reset::N;
  using scalar = typename Reset::scalar;
  using T = typename Reset::T;
  using Memory = typename Reset::Memory;
  using Goal = typename Reset::Goal;
  using Surface = typename Reset::Surface;
  using Settings = typename Reset::Settings;

  /// Throws `ConfigurationError` for settings that cannot work: see `check`.
  Tracking()
    requires(std::same_as<Damping, InertialDamping<T>> && std::default_initializable<Space>)
      : Tracking(Space(), Settings{}) {}
  template <std::same_as<typename Space::Settings> S = typename Space::Settings>
  explicit Tracking(const S& settings)  // a template: `({})` is the default
    requires(std::same_as<Damping, InertialDamping<T>> && std::default_initializable<Space>)
      : Tracking(Space(), settings) {}
  Tracking(const Settings& settings, const Damping& damping)
    requires std::default_initializable<Space>
      : Tracking(Space(), settings, damping) {}
  Tracking(const Space& space, const Settings& settings)
    requires std::same_as<Damping, InertialDamping<T>>
      : Tracking(space, settings, InertialDamping<T>(Space::tracking(settings).lambda)) {}
  /// A law for a described robot, with `tracking_settings(robot)`.
  template <DescribedRobot R>
  explicit Tracking(const R& robot)
    requires(std::same_as<Damping, InertialDamping<T>> && std::default_initializable<Space>)
      : Tracking(Space::settings_of(robot)) {}
  template <DescribedRobot R>
  Tracking(const R& robot, const typename Space::Placement& X_LP)
    requires(std::same_as<Damping, InertialDamping<T>>)
      : Tracking(X_LP, Space::settings_of(robot)) {}
  Tracking(const typename Space::Placement& X_LP, const Settings& settings)
    requires(std::same_as<Damping, InertialDamping<T>> && !std::default_initializable<Space>)
      : Tracking(Space(X_LP, settings), settings) {}
  Tracking(const Space& space, const Settings& settings, const Damping& damping)
      : Reset(space, settings, damping) {}
  /// Checks the law for a robot: throws `ConfigurationError` where times or virtual dynamics are not those
  /// of the robot, and where the gains are too large for the lightest of its configurations, or too small for
  /// the gravity that they differ by.
  void check_for(const LawTerms<N, T>& robot) const {
    skinctl::check_for(gains(), robot);
    if (robot.mass_ratio > gains().mass_ratio)
      detail::check_gains(gains(), damping_.fastest(), robot.mass_ratio);
    detail::check_gravity(gains(), damping_.slowest(), robot.gravity_rate);
  }
  void check_for(const JerkTerms<N, T>& limit) const { skinctl::check_for(gains(), limit); }

  /// The memory of a law that takes over at the known state: the target is the robot's position, `S_d` takes
  /// up its velocity, S_q is zero.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory start(const K& known) const noexcept {
    Memory memory;
    memory.plan = Plan::standing(space_.where(space_.site(known)), settings_);
    memory.tb = seconds<T>(gains().tb);
    memory.K_from = schedule_.K_c();
    begin_bias(memory, known);
    space_.take_up(memory.space, look(memory, known).S_q);
    return memory;
  }

  /// Takes a new goal: the plan, the time base, the surface and its integrals start again from the known
  /// state. Refused: no numbers, joints beyond the robot's position limits, a pose whose axes are no
  /// rotation. Too fast ones are stretched or refused: `GoalPolicy`.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Received<Memory> receive(const Memory& memory, const K& known,
                                                      const Goal& goal) const noexcept {
    if (!detail::within_limits<Space>(known, goal)) return {memory, Reason::goal_refused};
    const auto planned = [&] {
      const auto site = space_.site(known);
      if constexpr (Plan::streams || Space::of_joints) {
        return memory.plan.to(goal, space_.where(site), settings_);
      } else {
        return memory.plan.to(goal, space_.where(site), settings_, time_to_accelerate(memory, site, goal));
      }
    }();
    Received<Memory> out{memory, planned.status};
    if (planned.status.has(Reason::goal_refused)) return out;
    out.memory.plan = planned.memory;
    if constexpr (Plan::reacts) return out;
    out.memory.space = Space::renewed(memory.space);
    out.status |= begin_gain(out.memory, known);
    if (out.status.has(Reason::goal_refused)) return {memory, out.status};
    out.memory.I1 = out.memory.I2 = Integrals<Space::coordinates, T>();
    out.memory.used = {};
    begin_bias(out.memory, known);
    bumpless_transfer(out.memory, memory, known);
    return out;
  }

  /// The memory that goes on after a stop or a brake, in which others moved the robot: its plan leads from
  /// the known state to where it led, in the time that it had left; time base, surface and integrals start
  /// again. As it was where the robot is near enough to its course to be back within a bumpless transfer.
  template <class K>
  [[nodiscard]] SKINCTL_COLD Memory resumed(const Memory& memory, const K& known) const noexcept {
    const Surface here = this->look(memory, known);
    const T soon = seconds<T>(gains().bumpless_transfer);
    bool near = !memory.held;
    if constexpr (!Plan::streams)  // settings may know no accelerations
      near = near && memory.plan.is_near(Space::motion(space_.site(known)), settings_);
    for (std::size_t i = 0; i < N; ++i) {
      const T most = gains().joint_acceleration[i];
      near = near && detail::magnitude(here.S_q[i]) <= soon * most &&
             detail::magnitude(here.ddq_r[i]) <= most / T(detail::planned_share);
    }
    if (near) return memory;
    Memory out = memory;
    out.held = false;
    out.plan = memory.plan.resumed(Space::motion(space_.site(known)), settings_);
    out.space = Space::renewed(memory.space);
    static_cast<void>(begin_gain(out, known));
    out.I1 = out.I2 = Integrals<Space::coordinates, T>();
    out.used = {};
    begin_bias(out, known);
    return out;
  }

  /// Takes the next sample of a target that moves smoothly: time base, surface and integrals go on. A sample
  /// is a new goal if it is further from the extrapolation of the last one than the largest speed covers in
  /// the time between both, of which up to four times `dt` count.
  ///
  /// A goal of a spline within twice `target_age` of the last one, and no further from it than the largest
  /// speed covers, is a sample too: the same one changes nothing, another one gets a plan that goes on from
  /// the reference. Where the reference would step, as in a reversal, it is a new goal.
  template <class K>
  [[nodiscard]] Received<Memory> follow(const Memory& memory, const K& known,
                                        const Goal& goal) const noexcept {
    if constexpr (Plan::streams) {
      if (detail::within_limits<Space>(known, goal) && memory.plan.leads_to(goal, settings_)) {
        const auto planned = memory.plan.to(goal, space_.where(space_.site(known)), settings_);
        Received<Memory> out{memory, planned.status};
        out.memory.plan = planned.memory;
        return out;
      }
    } else if (memory.plan.leads_to(goal, settings_)) {
      Received<Memory> out{memory, {}};
      out.memory.plan.heard = 0ns;
      return out;
    } else if (memory.plan.is_sample(goal, settings_) && detail::within_limits<Space>(known, goal)) {
      const auto from = Space::where_of(memory.plan.at(T(0), settings_));
      const auto planned = memory.plan.to(goal, from, settings_);
      Received<Memory> out{memory, planned.status};
      out.memory.plan = planned.memory;
      if (planned.memory.goes_on_from(memory.plan, settings_)) return out;
    }
    return receive(memory, known, goal);
  }

  using Reset::now;
  using Reset::torque;
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& memory, const K& known,
                                                        const LawShare<T>& share = {}) const noexcept {
    return torque<G>(memory, known, share, now(memory, known));
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known, const T& dt,
                                              Opposition opposition, const Surface& at_t) const noexcept {
    if ((opposition == Opposition::lasting) != memory.held) [[unlikely]]
      return switched(memory, known, dt, opposition);
    Memory next = stepped(memory, at_t, dt);
    if constexpr (!Plan::streams)
      next.plan =
          next.plan.waited(Space::share_of_speed(at_t, settings_), nanoseconds(double(dt)), settings_);
    bound_integrals(next, known);
    return next;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known, const T& dt,
                                              Opposition opposition) const noexcept {
    return advance(memory, known, dt, opposition, now(memory, known));
  }

  /// Torque and next memory at once.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<N, T, Memory, 1> evaluate(const Memory& memory, const K& known,
                                                                    const T& dt) const noexcept {
    const auto at_t = now(memory, known);
    const detail::Row<N, T> tau(torque(memory, known, LawShare<T>{}, at_t));
    using Torque = JointTorque<N, T>;
    return {Torque(tau), advance(memory, known, dt, Opposition::none, at_t), {Torque(tau)}, status(memory)};
  }
  /// Whether the target is at rest, the skin does not push against the law, and neither robot nor reference
  /// is faster than `still` [rad/s].
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    return !memory.held && Space::stands(reference(memory)) && detail::slower(known.dq(), still) &&
           detail::slower(now(memory, known).dq_r, still);
  }
  /// The distance of the robot from a goal, or from a target as it is now: of poses in position [m] and
  /// orientation [rad], else the largest of a joint [rad].
  struct Distance {
    T position = T(0), orientation = T(0), joint = T(0);
  };
  template <class K>
  [[nodiscard]] Distance distance(const K& known, const Goal& goal) const noexcept {
    const auto site = space_.site(known);
    const auto& at = space_.where(site);
    const auto& there = Space::place(goal);
    if constexpr (!Space::of_joints) {
      return {norm(Xyz<T>(there.origin() - at.origin())), norm(log_so3(there.axes() * at.axes().transpose())),
              T(0)};
    } else {
      Distance d;
      for (std::size_t i = 0; i < N; ++i) {
        T off = there[i] - at[i];
        off = off < T(0) ? T(-off) : off;
        d.joint = off <= d.joint ? d.joint : off;
      }
      return d;
    }
  }
  /// The present reference: a point of the spline, or the last target, extrapolated.
  [[nodiscard]] auto reference(const Memory& memory) const noexcept {
    return memory.plan.at(T(0), settings_);
  }
  /// The last target, as received.
  [[nodiscard]] const Goal& target(const Memory& memory) const noexcept
    requires(Plan::streams)
  {
    return memory.plan.target;
  }
  /// The memory with another target, for callers that move it smoothly and within the settings: nothing is
  /// checked, and there is no bumpless transfer.
  [[nodiscard]] static Memory with_target(Memory memory, const Goal& target) noexcept
    requires(Plan::is_movable)
  {
    memory.plan = Plan::moved(target);
    return memory;
  }
  /// The reasons that the law reports: bumpless transfer under way, opposition of the skin, the space's own.
  [[nodiscard]] SKINCTL_INLINE Status status(const Memory& memory) const noexcept {
    Status s = space_.status(memory.space);
    if (memory.bias.is_transferring(gains().bumpless_transfer)) s |= Reason::bumpless_transfer;
    if (memory.held) s |= Reason::opposed;
    return s;
  }
};

SKINCTL_END_NAMESPACE
