// From torque to commands: a virtual robot that carries the fused torque and stays with the real one.
#pragma once

#include <span>

#include "skinctl/core/evaluate.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/math/lu.hpp"
#include "skinctl/resolver/detail/virtual_joints.hpp"
#include "skinctl/resolver/integrator.hpp"
#include "skinctl/robot/tool_shape.hpp"
#include "skinctl/robot/virtual_mass.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The result of one cycle of a resolver: the command, its status, the torque of each part of the law in the
/// last sub-step, and for a torque interface the torque that holds the robot if the guard refuses the
/// command.
template <std::size_t N, Real T, std::size_t Terms>
struct Resolved {
  JointCommand<N, T> command;
  Status status;
  std::array<JointTorque<N, T>, Terms> shares;
  JointTorque<N, T> fallback;

  /// Member by member: GCC would first zero an aggregate of this size, by an instruction that starts slowly.
  SKINCTL_INLINE Resolved(const JointCommand<N, T>& given, Status found,
                          const std::array<JointTorque<N, T>, Terms>& parts) noexcept
      : command(given.copy()), status(found), shares(parts) {}
};

/// In place of pressed areas: the resolver takes the contacts from the wrenches of the touch.
struct PressedUnknown {};

namespace detail {
/// The parts of a scene's configuration that give its torque.
template <class Robot, class L, class Touch>
struct Asked {
  const Robot& robot;
  const L& law;
  const typename L::Memory& memory;
  const Touch& touch;
};
}  // namespace detail

/// The torque resolver of the paper's section 4.5 for robots that take positions or velocities (for those
/// that take torques see `torque_resolver.hpp`).
///
/// A virtual robot with the model's M, C, G and the configured friction carries the fused torque:
/// `M dv = tau - (C + B) v - G - tau_c(v) + M L2 rho`, `dq^ = u = v + L1 rho`. All laws read its state
/// `(q^, v)`, which is sent. The real robot enters through `r`, the measured position minus the position that
/// the sent commands should have brought, by declared delay and lag, and `rho`, the part of r outside of the
/// dead band: a robot that follows as declared is not disturbed, and feels as configured.
///
/// - Position interface: q^ is sent. Velocity interface: v is sent; `L1 rho` and a slow drift move q^ only.
/// - Gravity acts on the virtual robot: a law has to compensate it (`GravityControl`, or `Y_r Theta` with G).
/// - Torque beyond the joints' limits accelerates as asked, but less: `JointLimits::along`.
/// - Limits: see `JointLimits::move`; the correction obeys them too, and so does the max lead,
///   `|q^ - q| <= max_lead v_max T`.
/// - A robot that stays beyond the dead band for 5 T is blocked: q^ goes to q, v is zero, the law's memory
///   does not change. It ends when the robot is back with q^ and is no longer pushed in the blocked
///   direction, or went on in it, or after `retry`.
/// - Friction of a servo that gives way shows as a joint that moves with commands which are ahead of it by more than
///   the dead band, or that stays when it is tried again: that joint's dead band grows, up to two thirds of the max
///   lead, and shrinks again with a time constant of a minute.
/// - A robot that stands beside its commands by a gap that they do not explain is displaced: v is braked to
///   zero and the law's memory does not change until `resume`, which takes the gap, up to `largest_gap`, off the
///   measurements.
/// - A gap within the dead band is taken off the measurements without consent, but only until the first command
///   moves, for two seconds at most from the start or from `resume` (position interface): commands that have not
///   moved cannot have met an obstacle.
/// - A stop, or no good measurement for `stale_after`: v is braked to zero, the law's memory does not change.
/// - `Keeper` names further parts that watch over energy and contacts: see `Passivity`.
/// - `Tool`: virtual inertia and friction at the tool; see `ToolShape`.
///
/// In the loop nothing throws or allocates; the cost is that of the law and the integrator, times sub-steps.
template <Interface I, RobotModel M, Real T = double, class Integrator = CrankNicolson,
          std::size_t History = 32, class Keeper = Passivity<>, class Tool = NoToolShape>
class Resolver {
 public:
  static_assert(I != Interface::torque, "for torques include skinctl/resolver/torque_resolver.hpp");
  static constexpr std::size_t joints = M::joints;
  static constexpr Interface interface = I;
  using scalar = T;
  using Configuration = RobotConfiguration<joints, T>;
  static constexpr bool has_tank = Keeper::template has<EnergyTank<T>>;
  static constexpr bool has_passivity_observer = Keeper::template has<PassivityObserver<T>>;
  static constexpr bool has_damper = Keeper::template has<ContactDamper<T>>;
  static constexpr bool watches_contacts = has_passivity_observer || has_damper;
  static constexpr Needs keeper_needs = {
      .angles = has_tank, .gravity = has_tank, .mass = has_tank, .touch = has_tank};
  /// Whether laws may compute the bias of the virtual robot beside their own recursion.
  static constexpr bool carries_bias =
      std::same_as<Integrator, CrankNicolson> && std::same_as<Tool, NoToolShape>;
  using Memory = ResolverMemory<joints, T, History, Keeper>;
  /// The input of a law: the state of the virtual robot and the quantities that law and integrator need of
  /// it.
  template <class L, class Touch = NoTouch>
  using Knows = Quantities<M, L::needs | Integrator::needs | keeper_needs, T, Touch,
                           VirtualMass<joints, T, Tool, AllJoints<joints>, carries_bias>>;

  /// Throws `ConfigurationError` for a number out of its range.
  ///
  /// @param keeper  parts that watch over energy and contacts, see `Passivity`.
  Resolver(const M& model, const Configuration& configuration, const Keeper& keeper = Keeper())
    requires std::same_as<Tool, NoToolShape>
      : model_(model), virtual_(configuration), keeper_(keeper) {}
  /// @param tool  virtual inertia and friction at the tool, see `ToolShape`.
  Resolver(const M& model, const Configuration& configuration, const Tool& tool,
           const Keeper& keeper = Keeper())
    requires(!std::same_as<Tool, NoToolShape>)
      : model_(model), virtual_(configuration), keeper_(keeper), tool_(tool) {}

  [[nodiscard]] const M& model() const noexcept { return model_; }
  [[nodiscard]] const JointLimits<joints, T>& limits() const noexcept { return parameters().limits; }
  [[nodiscard]] const Keeper& keeper() const noexcept { return keeper_; }
  /// The robot's numbers in the form in which the resolver uses them.
  [[nodiscard]] SKINCTL_INLINE const detail::ResolverParameters<joints, T>& parameters() const noexcept {
    return virtual_.parameters();
  }
  /// T = delay + lag + period [s]: the time until a measurement shows a command.
  [[nodiscard]] T total_delay() const noexcept { return parameters().total_delay; }
  /// e_max: the largest lead of joint `i` of the virtual robot over the real one [rad].
  [[nodiscard]] T max_lead(std::size_t i) const noexcept { return parameters().max_lead[i]; }
  /// Speed that the max lead leaves to joint `i` of a robot that follows: the virtual joint can still stop if
  /// the robot is blocked at that moment.
  [[nodiscard]] T top_speed(std::size_t i) const noexcept {
    const T u = speed_to_stop(max_lead(i), total_delay(), limits().acceleration()[i]);
    return u < limits().velocity()[i] ? u : limits().velocity()[i];
  }

  /// Length of a sub-step in a punctual cycle [s].
  [[nodiscard]] T planned_step() const noexcept { return parameters().planned_step(); }

  /// The virtual robot takes over at the position of the real one, and with its velocity where that covers
  /// more than the dead band in T. The law's memory then starts at `state(memory)`. A state that is not
  /// finite gives a memory that has not been started.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<joints, T>& measured) const noexcept {
    return {virtual_.start(measured), keeper_.template start<joints>()};
  }
  /// The same of a robot that was told to be at `told` and stands beside it (a servo that droops, encoders that
  /// are off): the first command is `told`, so that the robot does not step, and the gap is taken off the
  /// measurements. More than `largest_gap` of one joint: the memory has not been started.
  [[nodiscard]] SKINCTL_COLD Memory start(const State<joints, T>& measured,
                                          const JointPosition<joints, T>& told) const noexcept
    requires(I == Interface::position)
  {
    return {virtual_.start(measured, told), keeper_.template start<joints>()};
  }

  /// The state that laws read.
  [[nodiscard]] State<joints, T> state(const Memory& m) const noexcept { return {m.time, m.q.value, m.v}; }

  /// What a law knows at `state`, which must outlive it like `touch`: for a torque that is held for `dt` seconds.
  template <class L, class Touch>
  [[nodiscard]] SKINCTL_INLINE Knows<L, Touch> known(
      const State<joints, T>& state, const T& dt, const Touch& touch,
      detail::BiasBeside<joints, T>* beside = nullptr) const noexcept {
    return Knows<L, Touch>(model_, state, dt, touch,
                           {parameters().limits, parameters().shape.inertia, tool_, beside});
  }

  /// The interval that a cycle at `now` has to integrate; empty if `now` is not later than the last cycle.
  [[nodiscard]] Interval interval(const Memory& m, Nanoseconds now) const noexcept {
    return virtual_.interval(m, now);
  }

  /// One cycle: integrates `interval` and gives the command for its end.
  ///
  /// @param law, law_memory  the law and its memory, which is advanced.
  /// @param measured         the newest state of the robot, with its stamp; may be old, or faulty.
  /// @param check            whether this robot can be in a state, see `take_measurement`.
  /// @param touches          the skin's mean wrenches on the links, one per sub-step; with a tank best as
  ///                         `TouchWrenches`, otherwise all of it counts as contact.
  /// @param pressed           the contacts for `PassivityObserver` and `ContactDamper`: `PressedAreas`. If
  ///                         they are unknown, one for each link, from the last touch.
  template <class L, class Touch, class Check = AnyState, class Pressed = PressedUnknown>
  SKINCTL_INLINE Resolved<joints, T, terms_of<L>> step(
      Memory& m, const L& law, typename L::Memory& law_memory, const State<joints, T>& measured,
      const Interval& interval, std::span<const Touch> touches, const Check& check = {},
      const Pressed& pressed = {}) const noexcept;

  /// The joint torque that accelerates the virtual robot under the configuration `next` in the coming
  /// sub-step as under `before`, less that of `next`; both are of the same scene. Zero where the laws do not
  /// move the virtual robot. Evaluates both laws once and the integrator `joints` times, without limits.
  template <class L, class Touch, class Check>
  [[nodiscard]] SKINCTL_COLD JointTorque<joints, T> lacking(
      const Memory& m, const State<joints, T>& measured, const Interval& interval, const Check&,
      const detail::Asked<Resolver, L, Touch>& before,
      const detail::Asked<Resolver, L, Touch>& next) const noexcept;

  /// Tells that the guard let `command` out instead of the last one: the virtual robot goes on from there.
  SKINCTL_INLINE void sent(Memory& m, const JointCommand<joints, T>& command) const noexcept {
    virtual_.sent(m, command);
  }

  /// By what the robot stands beside its commands: the measured position less that which they should have brought, r + g.
  [[nodiscard]] static SKINCTL_INLINE JointPosition<joints, T> off(const Memory& m) noexcept {
    return m.residual + m.gap;
  }

  /// Whether the robot stops, or is beside its commands by more than the dead band, as one that is held fast. Braking and
  /// correction then have to be sent as they are: what is smoothed behind the resolver changes its velocity, and the
  /// robot swings for ever.
  [[nodiscard]] static SKINCTL_INLINE bool stops_or_corrects(const Memory& m) noexcept {
    return decltype(virtual_)::stops_or_corrects(m);
  }

  /// Tells that another configuration has taken over: a torque that differs is no jump of its laws.
  void changed(Memory& m) const noexcept { m.own.known = false; }
  /// Begins a stop.
  void stop(Memory& m) const noexcept { m.stop = true; }
  [[nodiscard]] static bool stops(const Memory& m) noexcept { return m.stop; }
  /// Ends a stop that was not the user's: a displaced robot waits on.
  static void go_on(Memory& m) noexcept { m.stop = false; }
  /// Ends a stop. A displaced robot goes on with the gap that it has now, if that is at most `largest_gap`.
  void resume(Memory& m) const noexcept { virtual_.resume(m); }

 private:
  using Torque = JointTorque<joints, T>;
  using Position = JointPosition<joints, T>;
  using Velocity = JointVelocity<joints, T>;
  using Row = detail::Row<joints, T>;
  /// The law's part and the velocity after a sub-step: `torque` is the law's, cut to the limits.
  template <class L>
  struct Driven {
    /// Built in place. (GCC would first zero an aggregate, then write it.)
    template <class F>
    SKINCTL_INLINE explicit Driven(F&& law_now) : law(law_now()), status(law.status) {}

    Evaluation<joints, T, typename L::Memory, terms_of<L>> law;
    Torque torque;
    Velocity velocity;
    Status status;
  };
  template <class Pressed>
  SKINCTL_INLINE Status watch(Memory& m, const Pressed& pressed, const T& dt) const noexcept;
  SKINCTL_INLINE bool affords(const Memory& m, Velocity& v) const noexcept;
  Torque weight(const Memory& m) const noexcept;
  Torque limited(const State<joints, T>& state, const Torque& tau) const noexcept;
  template <class L, class Touch>
  Driven<L> drive(Memory& m, const L& law, const typename L::Memory& law_memory, Nanoseconds at,
                  const Velocity& v, const JointAcceleration<joints, T>& pull, const T& h,
                  const Touch& touch) const noexcept;

  [[no_unique_address]] M model_;
  detail::VirtualJoints<I, joints, T, History> virtual_;
  [[no_unique_address]] Keeper keeper_;
  [[no_unique_address]] Tool tool_;
};

SKINCTL_END_NAMESPACE

#include "skinctl/resolver/detail/resolver_loop.hpp"
