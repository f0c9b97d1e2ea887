// SPDX-License-Identifier: BSD-3-Clause
// A robot in groups of joints as a resolver uses it: its model and numbers, checked.
#pragma once

#include <span>

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/resolver/detail/virtual_joints.hpp"
#include "skinctl/resolver/integrator.hpp"
#include "skinctl/robot/detail/held_friction.hpp"
#include "skinctl/robot/joint_groups.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/robot/virtual_mass.hpp"
#include "skinctl/tactile/force_lead.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// `interface` of a robot that is one group.
template <class... Groups>
struct InterfaceOf {
  static constexpr bool is_one_group = false;
};
template <class Group>
struct InterfaceOf<Group> {
  static constexpr bool is_one_group = true;
  static constexpr Interface interface = Group::interface;
};
template <class Stiff, class Driven>
struct InterfaceOfSets;
template <class... S, class... D>
struct InterfaceOfSets<std::tuple<S...>, std::tuple<D...>> : InterfaceOf<S..., D...> {};

/// The data of a `Resolver`, which derives from it, and what follows from them alone.
template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class PassivityParts,
          class Tool>
class ResolverNumbers : public InterfaceOfSets<typename Sets::StiffGroups, typename Sets::DrivenGroups> {
 public:
  static constexpr std::size_t joints = M::joints;
  using Driven = typename Sets::Driven;  ///< joints by torque
  using Stiff = typename Sets::Stiff;    ///< joints by position or velocity
  using Groups = typename Sets::StiffGroups;
  static constexpr std::size_t stiff_groups = std::tuple_size_v<Groups>;
  static constexpr bool has_driven = Driven::count > 0;
  static constexpr bool has_virtual = Stiff::count > 0;
  using scalar = T;
  using Configuration = RobotConfiguration<joints, T>;
  using JointSets = Sets;
  /// The command that this robot is sent.
  using Sent = typename CommandOf<joints, T, typename Sets::All>::type;
  using Memory = MemoryOf<M, ResolverMemory<joints, T, Sets, History, PassivityParts>, T>;
  static constexpr bool one_group = Memory::one_group;
  static constexpr bool has_tank = PassivityParts::template has<EnergyTank<T>>;
  static constexpr bool has_passivity_observer = PassivityParts::template has<PassivityObserver<T>>;
  static constexpr bool watches_contacts = has_passivity_observer;
  /// Whether contacts deflect joints from their commands.
  static constexpr bool gives_way = []<class... G>(std::tuple<G...>*) {
    return (G::template Servo<History>::gives_way || ...);
  }(static_cast<Groups*>(nullptr));
  /// Whether joints are sent a torque beside their positions.
  static constexpr bool feeds_forward = []<class... G>(std::tuple<G...>*) {
    return (takes_torque(G::interface) || ...);
  }(static_cast<Groups*>(nullptr));
  static_assert(has_virtual || !has_passivity_observer,
                "by torque no command runs ahead of the robot: its Passivity is an EnergyTank, leave "
                "PassivityObserver out");

  /// The joints of the stiff group `K`.
  template <std::size_t K>
  using Group = std::tuple_element_t<K, Groups>;
  template <std::size_t K>
  using Part = JointSubset<joints, Group<K>::set>;
  /// Calls `f(std::integral_constant<std::size_t, K>)` for each stiff group.
  template <class F>
  static SKINCTL_INLINE void each(F&& f) {
    [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
      (f(std::integral_constant<std::size_t, K>{}), ...);
    }(std::make_index_sequence<stiff_groups>{});
  }

  [[nodiscard]] const M& model() const noexcept { return model_; }
  /// The limits of all joints.
  [[nodiscard]] const JointLimits<joints, T>& limits() const noexcept { return limits_; }
  [[nodiscard]] const PassivityParts& passivity() const noexcept { return passivity_; }
  /// The numbers of the stiff group `K` in the form in which the resolver uses them.
  template <std::size_t K = 0>
  [[nodiscard]] SKINCTL_INLINE const auto& parameters() const noexcept {
    return std::get<K>(virtual_).parameters();
  }
  [[nodiscard]] Nanoseconds period() const noexcept { return period_; }
  [[nodiscard]] Nanoseconds longest_interval() const noexcept { return longest_interval_; }
  /// Virtual inertia and friction of the stiff joints; added friction and motors of the joints by torque.
  [[nodiscard]] const VirtualDynamics<joints, T>& shape() const noexcept { return shape_; }
  /// Delay and lag of the joints by torque, the longest of their groups.
  [[nodiscard]] Nanoseconds driven_delay() const noexcept { return driven_delay_; }
  [[nodiscard]] Nanoseconds driven_lag() const noexcept { return driven_lag_; }
  /// The configuration that a guard of the joints by torque reads; `limits` are theirs.
  [[nodiscard]] RobotConfiguration<Driven::count, T> for_guard(
      const JointLimits<Driven::count, T>& limits) const {
    return {.limits = limits,
            .period = period_,
            .delay = driven_delay_,
            .lag = driven_lag_,
            .longest_interval = longest_interval_,
            .stale_after = stale_after_};
  }
  /// The time for which a law's torque is held in a punctual cycle [s]: a sub-step, or by torque a period.
  [[nodiscard]] T planned_step() const noexcept {
    return seconds<T>(has_virtual ? planned_substep(period_, substep_) : period_);
  }
  /// T = delay + lag + period of the slowest stiff group [s]: the time until a measurement shows a command.
  [[nodiscard]] T total_delay() const noexcept {
    T slowest(0);
    each([&](auto k) {
      const T total = parameters<k.value>().total_delay;
      if (total > slowest) slowest = total;
    });
    return slowest;
  }

 protected:
  using Position = JointPosition<joints, T>;
  using Velocity = JointVelocity<joints, T>;
  using Acceleration = JointAcceleration<joints, T>;
  using Torque = JointTorque<joints, T>;
  using StiffTorque = JointTorque<Stiff::count, T>;
  using DrivenTorque = JointTorque<Driven::count, T>;

  template <class... S, class... D>
  SKINCTL_COLD ResolverNumbers(const M& model, const std::tuple<S...>& stiff, const std::tuple<D...>& driven,
                               const PassivityParts& passivity, const Tool& tool)
      : model_(model),
        virtual_(virtual_of(stiff)),
        limits_(limits_of_all(std::tuple_cat(stiff, driven))),
        passivity_(passivity),
        tool_(tool) {
    const auto groups = std::tuple_cat(stiff, driven);
    const auto& first = std::get<0>(groups).configuration;
    period_ = first.period;
    substep_ = first.substep;
    longest_interval_ = first.longest();
    if constexpr (has_virtual) {
      shape_.damping = first.virtual_dynamics().damping;
      torque_rate_ = first.torque_rate;
    }
    std::apply([&](const auto&... g) { (take(g), ...); }, groups);
    if constexpr (has_virtual)
      stiff_shape_ = {Stiff::of(shape_.viscous), Stiff::of(shape_.coulomb), Stiff::of(shape_.inertia),
                      shape_.damping};
  }

  /// The mass matrix of the links, and of the motors of the joints by torque.
  [[nodiscard]] SKINCTL_INLINE MassMatrix<joints, T> real_mass(const Position& q) const noexcept {
    MassMatrix<joints, T> m = mass_matrix(model_, q);
    for (const std::size_t i : Driven::index) m(i, i) = m(i, i) + shape_.inertia[i];
    return m;
  }
  /// Friction added to the joints by torque, and what brakes and holds them, friction included [N m].
  struct Resistance {
    DrivenTorque friction, brakes;
  };
  /// @param stopped  where the joints are held, and since when they stop; null: they do not.
  [[nodiscard]] SKINCTL_INLINE Resistance
  resistance(const State<joints, T>& s, decltype(Memory::driven)* stopped = nullptr) const noexcept {
    Resistance out;
    if constexpr (has_driven) {
      const auto mass = real_mass(s.q);
      const T delay = seconds<T>(driven_delay_ + driven_lag_ + 3 * period_ / 2);  // D
      if (has_friction_) out.friction = held_friction<Driven>(shape_.viscous, mass, s.dq, delay);
      const DrivenTorque hardest = momentum_of<Driven>(mass, s.dq) * T(T(1) / delay);
      out.brakes = out.friction + T(gain_times_delay) * (hardest - out.friction);
      if (stopped != nullptr) [[unlikely]]
        out.brakes -= held_in_place<Driven>(mass, limits_.torque(), s.q, delay, *stopped);
    }
    return out;
  }
  /// The virtual robot's torque within its limits, along the motion that `tau` asks for; with Coriolis
  /// forces: at full speed they are as large as what is left of a light joint's torque.
  [[nodiscard]] SKINCTL_COLD Torque limited(const State<joints, T>& now, const Torque& tau) const noexcept {
    const Torque hold = stiff_only(bias_torque(model_, JointAngles<M, T>(model_, now.q), now.dq));
    return limits_.along(tau, hold, stiff_only(now.dq));
  }
  /// `whole` with zeros for the joints by torque.
  template <class V>
  [[nodiscard]] static SKINCTL_INLINE V stiff_only(const V& whole) noexcept {
    if constexpr (Stiff::is_all) {
      return whole;
    } else {
      V out;
      Stiff::put(Stiff::of(whole), out);
      return out;
    }
  }
  /// The touch that a law gets: `touch`, which changes by `change` in a sub-step, `share` sub-steps ahead; as
  /// it is if `change` is null.
  template <class Touch>
  [[nodiscard]] static SKINCTL_INLINE LawTouch<Touch> ahead(const Touch& touch,
                                                            [[maybe_unused]] const LawTouch<Touch>* change,
                                                            [[maybe_unused]] const T& share) noexcept {
    if constexpr (can_be_led<LawTouch<Touch>>)
      if (change != nullptr) return led_by(total_of(touch), share, *change);
    return total_of(touch);
  }
  /// The touch, ahead, that the law of the joints by torque gets at the end of a cycle of `dt` seconds.
  template <class Touch>
  [[nodiscard]] SKINCTL_INLINE LawTouch<Touch> ahead_of_driven(
      const Touch& touch, [[maybe_unused]] std::span<const LawTouch<Touch>> changes,
      [[maybe_unused]] const T& dt) const noexcept {
    if constexpr (has_driven && can_be_led<LawTouch<Touch>>)
      if (!changes.empty()) {
        LawTouch<Touch> whole = changes[0];
        for (std::size_t j = 1; j < changes.size(); ++j) whole = led_by(whole, T(1), changes[j]);
        return led_by(total_of(touch), T(driven_force_lead_ / dt), whole);
      }
    return total_of(touch);
  }
  [[no_unique_address]] M model_;
  template <class... G>
  [[nodiscard]] static auto virtual_of(const std::tuple<G...>& groups) {
    return std::apply(
        [](const auto&... g) {
          return std::tuple<VirtualJoints<G::interface, G::count, T, History>...>(
              VirtualJoints<G::interface, G::count, T, History>(g.configuration)...);
        },
        groups);
  }
  decltype(virtual_of(std::declval<Groups>())) virtual_;
  JointLimits<joints, T> limits_;
  VirtualDynamics<joints, T> shape_;  ///< virtual dynamics of all joints
  struct NoShape {};
  /// Virtual dynamics of the stiff joints.
  [[no_unique_address]] std::conditional_t<has_virtual, VirtualDynamics<Stiff::count, T>, NoShape>
      stiff_shape_;
  Nanoseconds period_{}, substep_{}, longest_interval_{}, driven_delay_{}, driven_lag_{};
  Nanoseconds stale_after_{};  ///< age of a measurement at which joints by torque are no longer controlled
  T torque_rate_ = T(0);       ///< rate of the stiff joints' own torque [torque limits per second]
  T driven_torque_rate_ = T(0);
  T force_lead_ = T(0), driven_force_lead_ = T(0);  ///< `RobotConfiguration::force_lead`, the longest [s]
  bool has_coulomb_ = false, has_friction_ = false;
  [[no_unique_address]] PassivityParts passivity_;
  [[no_unique_address]] Tool tool_;

 private:
  /// Takes the numbers of a group; throws `ConfigurationError` where they are out of range.
  template <class Given>
  void take(const Given& g) {
    using Set = JointSubset<joints, Given::set>;
    const auto& c = g.configuration;
    check(c, Given::interface != Interface::torque);
    Set::put(c.viscous_friction, shape_.viscous);
    Set::put(c.coulomb_friction, shape_.coulomb);
    Set::put(c.virtual_inertia, shape_.inertia);
    const T damping = c.virtual_dynamics().damping, ahead = seconds<T>(c.leads_force_by());
    T& longest_ahead = Given::interface == Interface::torque ? driven_force_lead_ : force_lead_;
    if (ahead > longest_ahead) longest_ahead = ahead;
    const auto number = [](const T& x) { return static_cast<double>(x); };
    if constexpr (Given::interface == Interface::torque) {
      for (std::size_t i = 0; i < Given::count; ++i) {
        has_friction_ = has_friction_ || c.viscous_friction[i] > T(0);
        require(c.coulomb_friction[i] == T(0), "Coulomb friction", number(c.coulomb_friction[i]),
                "0 for joints by torque");
        require(!has_virtual || c.virtual_inertia[i] == T(0), "virtual inertia", number(c.virtual_inertia[i]),
                "0 for joints by torque beside others");
      }
      require(damping == T(0), "virtual damping", number(damping), "0 for joints by torque");
      driven_torque_rate_ = c.torque_rate;
      stale_after_ = c.stale();
      driven_delay_ = c.delay > driven_delay_ ? c.delay : driven_delay_;
      driven_lag_ = c.lag > driven_lag_ ? c.lag : driven_lag_;
    } else {
      for (const T& x : c.coulomb_friction) has_coulomb_ = has_coulomb_ || x > T(0);
      require(damping == shape_.damping, "virtual damping of a group", number(damping),
              "that of the other groups: one virtual robot");
      require(c.torque_rate == torque_rate_, "torque rate of a group", number(c.torque_rate),
              "that of the other groups: one law");
    }
  }
  template <class Given>
  [[nodiscard]] static SKINCTL_COLD JointLimits<joints, T> limits_of_all(const Given& groups) {
    typename JointLimits<joints, T>::Values all;
    const auto put = [&](const auto& g) {
      using Set = JointSubset<joints, std::remove_cvref_t<decltype(g)>::set>;
      const auto& v = g.configuration.limits.values();
      Set::put(v.lower, all.lower);
      Set::put(v.upper, all.upper);
      Set::put(v.velocity, all.velocity);
      Set::put(v.acceleration, all.acceleration);
      Set::put(v.torque, all.torque);
      Set::put(v.power, all.power);
    };
    std::apply([&](const auto&... g) { (put(g), ...); }, groups);
    return JointLimits<joints, T>(all);
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
