// SPDX-License-Identifier: BSD-3-Clause
// Robots whose joints have several interfaces: groups of joints by position, velocity and torque.
#pragma once

#include "skinctl/core/joint_subset.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/robot/servo.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The joints `Set` of a robot, which take `Ix`, and their configuration, in the order of the joints. Made by
/// `position_joints`, `velocity_joints` and `torque_joints`.
template <Interface Ix, LinkMask Set, Real T = double>
struct JointGroup {
  static_assert(Set != 0, "a group without joints: leave it out");
  static constexpr Interface interface = Ix;
  static constexpr LinkMask set = Set;
  static constexpr std::size_t count = static_cast<std::size_t>(std::popcount(Set));
  using scalar = T;
  /// The servo that answers the group's commands, up to `History` of them under way.
  template <std::size_t History>
  using Servo = ServoOf<Ix, count, T, History>;
  RobotConfiguration<count, T> configuration;
};

namespace detail {
template <LinkMask Set, Real T>
using GroupConfiguration = RobotConfiguration<static_cast<std::size_t>(std::popcount(Set)), T>;

template <class Group>
concept IsJointGroup = requires(const Group& g) {
  g.configuration;
  { Group::interface } -> std::convertible_to<Interface>;
  { Group::set } -> std::convertible_to<LinkMask>;
};

/// The values that satisfy `Is`, in a tuple.
template <template <class> class Is, class... Values>
[[nodiscard]] auto those_of(const Values&... values) {
  return std::tuple_cat([](const auto& value) {
    if constexpr (Is<std::remove_cvref_t<decltype(value)>>::value) {
      return std::make_tuple(value);
    } else {
      return std::tuple<>();
    }
  }(values)...);
}
template <class X>
struct IsGroup : std::bool_constant<IsJointGroup<X>> {};
template <class X>
struct IsNoGroup : std::bool_constant<!IsJointGroup<X>> {};
template <class X>
struct IsStiffGroup : std::bool_constant<IsJointGroup<X> && has_servo<X::interface>> {};
template <class X>
struct IsDrivenGroup : std::bool_constant<IsJointGroup<X> && !has_servo<X::interface>> {};
}  // namespace detail

namespace detail {
/// Whether a joint is in two of the groups of a tuple. Asked by `by_groups`, which the user calls.
template <class Groups>
inline constexpr bool repeats_a_joint = false;
template <class... Groups>
inline constexpr bool repeats_a_joint<std::tuple<Groups...>> =
    (std::size_t(std::popcount(Groups::set)) + ... + 0u) !=
    std::size_t(std::popcount((Groups::set | ... | 0u)));
}  // namespace detail

/// The joints of a robot with `N` joints by their interface; each joint is in one group.
template <std::size_t N, class... Groups>
struct JointGroups {
  static constexpr LinkMask all = joints_between(0, N);
  static constexpr LinkMask named = (Groups::set | ... | 0u);
  static constexpr LinkMask by_torque =
      ((has_servo<Groups::interface> ? LinkMask(0) : Groups::set) | ... | 0u);
  static_assert((named & ~all) == 0, "a group names a joint that the robot has not");
  static_assert((all & ~named) == 0, "a joint is in no group: each takes positions, velocities or torques");

  using Driven = JointSubset<N, by_torque>;  ///< joints by torque
  using Stiff = typename Driven::Others;     ///< joints by position, velocity or impedance
  using All = std::tuple<Groups...>;
  /// The groups of the stiff joints, in a tuple; below, those of the joints by torque.
  using StiffGroups = decltype(detail::those_of<detail::IsStiffGroup>(std::declval<const Groups&>()...));
  using DrivenGroups = decltype(detail::those_of<detail::IsDrivenGroup>(std::declval<const Groups&>()...));
};

/// The elements of `whole` that belong to the joints of `Subset`.
template <class Subset, std::size_t N, Scalar T>
[[nodiscard]] SKINCTL_INLINE State<Subset::count, T> part_of(const State<N, T>& whole) noexcept {
  return {whole.time, Subset::of(whole.q), Subset::of(whole.dq)};
}
template <class Subset, std::size_t N, Scalar T>
[[nodiscard]] SKINCTL_INLINE JointCommand<Subset::count, T> part_of(
    const JointCommand<N, T>& whole) noexcept {
  return {whole.time,
          whole.valid,
          Subset::of(whole.position),
          Subset::of(whole.velocity),
          Subset::of(whole.acceleration),
          Subset::of(whole.torque)};
}
/// Writes the part of a command that belongs to the joints of `Subset`; time and validity of `whole` stay.
template <class Subset, std::size_t N, Scalar T>
SKINCTL_INLINE void put_part(const JointCommand<Subset::count, T>& from, JointCommand<N, T>& whole) noexcept {
  Subset::put(from.position, whole.position);
  Subset::put(from.velocity, whole.velocity);
  Subset::put(from.acceleration, whole.acceleration);
  Subset::put(from.torque, whole.torque);
}

namespace detail {
/// The type of the command of joints in groups: it has each of their interfaces once, in one order.
template <std::size_t N, Real T, class Groups>
struct CommandOf;
template <std::size_t N, Real T, class... Groups>
struct CommandOf<N, T, std::tuple<Groups...>> {
  template <Interface... Ix>
  struct List {};
  template <std::size_t K, Interface... Ix>
  static auto command(List<Ix...> list) {
    if constexpr (K == std::size(all_interfaces)) {
      return RobotCommand<N, T, Ix...>();
    } else if constexpr (constexpr Interface next = all_interfaces[K]; ((Groups::interface == next) || ...)) {
      return command<K + 1>(List<Ix..., next>());
    } else {
      return command<K + 1>(list);
    }
  }
  using type = decltype(command<0>(List<>()));
};
/// Copies from `whole` the numbers of the interfaces `Ix` of the joints of `Subset`.
template <class Subset, std::size_t N, Real T, Interface... J, Interface... Ix>
SKINCTL_INLINE void take_part(const RobotCommand<N, T, J...>& whole,
                              RobotCommand<Subset::count, T, Ix...>& out) noexcept {
  out.time = whole.time;
  out.valid = whole.valid;
  out.each([](auto& own, const auto& all) SKINCTL_INLINE_LAMBDA { own = Subset::of(all); }, out, whole);
}
}  // namespace detail

/// The part of a robot's command for the joints of `Subset`.
template <class Subset, std::size_t N, Real T, Interface... Ix>
[[nodiscard]] SKINCTL_INLINE RobotCommand<Subset::count, T, Ix...> part_of(
    const RobotCommand<N, T, Ix...>& whole) noexcept {
  RobotCommand<Subset::count, T, Ix...> out;
  detail::take_part<Subset>(whole, out);
  return out;
}

/// A group of the joints `Set`, which take positions.
template <LinkMask Set, Real T = double>
[[nodiscard]] JointGroup<Interface::position, Set, T> position_joints(detail::GroupConfiguration<Set, T> c) {
  return {c};
}
/// A group of the joints `Set`, which take velocities.
template <LinkMask Set, Real T = double>
[[nodiscard]] JointGroup<Interface::velocity, Set, T> velocity_joints(detail::GroupConfiguration<Set, T> c) {
  return {c};
}
/// A group of the joints `Set`, which take torques.
template <LinkMask Set, Real T = double>
[[nodiscard]] JointGroup<Interface::torque, Set, T> torque_joints(detail::GroupConfiguration<Set, T> c) {
  return {c};
}

/// The description of a robot in groups: a model, groups that hold each of its joints once, and optional
/// parts as in `RobotDescription`. Made by `by_groups`; immutable.
template <RobotModel M, Real T, class Groups, class... Parts>
class GroupsDescription;
template <RobotModel M, Real T, class... Groups, class... Parts>
class GroupsDescription<M, T, std::tuple<Groups...>, Parts...> {
 public:
  static constexpr std::size_t joints = M::joints;
  using scalar = T;
  using model_type = M;
  using Sets = JointGroups<joints, Groups...>;
  static_assert(sizeof(Sets) > 0);
  static_assert((std::is_same_v<typename Groups::scalar, T> && ...), "groups of one robot have one scalar");

  /// Throws `ConfigurationError` for a number out of its range, and where periods, sub-steps or longest
  /// intervals of two groups differ: one cycle moves them all.
  GroupsDescription(const M& model, const std::tuple<Groups...>& groups, const std::tuple<Parts...>& parts)
      : model_(model), groups_(groups), parts_(parts) {
    const auto& first = std::get<0>(groups).configuration;
    const auto one = [&](const auto& group) {
      const auto& c = group.configuration;
      check(c, group.interface != Interface::torque);
      require(c.period == first.period, "period of a group", milliseconds(c.period),
              "that of the first, in ms");
      require(group.interface == Interface::torque || c.substep == first_stiff().substep,
              "sub-step of a group", milliseconds(c.substep), "that of the others, in ms");
      require(c.longest() == first.longest(), "longest interval of a group", milliseconds(c.longest()),
              "that of the first, in ms");
    };
    std::apply([&](const auto&... g) { (one(g), ...); }, groups);
    const auto masses = [&]<class G>(const G& g) {
      detail::check_masses<G::interface>(model, g.configuration.virtual_inertia, G::set);
    };
    std::apply([&](const auto&... g) { (masses(g), ...); }, groups);
  }
  [[nodiscard]] const M& model() const noexcept { return model_; }
  [[nodiscard]] const std::tuple<Groups...>& groups() const noexcept { return groups_; }
  [[nodiscard]] const std::tuple<Parts...>& parts() const noexcept { return parts_; }
  [[nodiscard]] Nanoseconds period() const noexcept { return first_stiff().period; }
  /// The longest time between two evaluations of a law in cycles on time.
  [[nodiscard]] Nanoseconds dt() const noexcept { return planned_substep(period(), first_stiff().substep); }
  /// The longest time between two evaluations of a law in the latest cycles that the description allows.
  [[nodiscard]] Nanoseconds longest_dt() const noexcept {
    const Nanoseconds late = first_stiff().longest() / max_substeps;
    return Sets::Stiff::count > 0 && late > dt() ? late : dt();
  }
  /// The delay D of the slowest loop, see `RobotDescription::loop_delay`: delay, lag and 1.5 periods of
  /// joints by torque.
  [[nodiscard]] Nanoseconds loop_delay() const noexcept {
    Nanoseconds longest = longest_dt();
    each([&]<class G>(const G& g) {
      const auto& c = g.configuration;
      const Nanoseconds loop = c.delay + c.lag + 3 * c.period / 2;
      if (G::interface == Interface::torque && loop > longest) longest = loop;
    });
    return longest;
  }
  /// Virtual dynamics of the joints that take no torques, zero for the others: friction added to joints by
  /// torque is not compensated by laws, as they give less of it where their delay is long.
  [[nodiscard]] VirtualDynamics<joints, T> virtual_dynamics() const noexcept {
    VirtualDynamics<joints, T> out;
    each([&]<class G>(const G& g) {
      if constexpr (G::interface != Interface::torque) {
        using Set = JointSubset<joints, G::set>;
        const auto own = g.configuration.virtual_dynamics();
        out.damping = own.damping;
        Set::put(own.viscous, out.viscous), Set::put(own.coulomb, out.coulomb);
        Set::put(own.inertia, out.inertia);
      }
    });
    return out;
  }

 private:
  template <class F>
  void each(F&& f) const {
    std::apply([&](const auto&... g) { (f(g), ...); }, groups_);
  }
  [[nodiscard]] const auto& first_stiff() const noexcept {
    constexpr std::size_t k = [] {
      const bool stiff[] = {(Groups::interface != Interface::torque)...};
      std::size_t i = 0;
      while (i < sizeof...(Groups) && !stiff[i]) ++i;
      return i < sizeof...(Groups) ? i : 0;  // all by torque: they are alike
    }();
    return std::get<k>(groups_).configuration;
  }

  [[no_unique_address]] M model_;
  std::tuple<Groups...> groups_;
  [[no_unique_address]] std::tuple<Parts...> parts_;
};

namespace detail {
template <Real T, RobotModel M, class... Groups, class... Parts>
[[nodiscard]] auto describe_groups(const M& model, const std::tuple<Groups...>& groups,
                                   const std::tuple<Parts...>& parts) {
  static_assert((RobotPart<Parts> && ...),
                "beside its groups a robot takes the parts of a description: EnergyTank, ToolShape, ...");
  return GroupsDescription<M, T, std::tuple<Groups...>, Parts...>(model, groups, parts);
}
}  // namespace detail

/// A robot whose joints have several interfaces, in any mixture and order:
/// `by_groups(model, position_joints<0b000011>({...}), velocity_joints<0b000100>({...}),
/// torque_joints<0b111000>({...}), EnergyTank{...})`. The parts of a description follow the groups. Gains
/// that suit the slowest of its loops: `tracking_settings(robot)` of tracking/group_settings.hpp.
template <RobotModel M, detail::IsJointGroup First, class... Others>
[[nodiscard]] auto by_groups(const M& model, const First& first, const Others&... others) {
  const auto groups = detail::those_of<detail::IsGroup>(first, others...);
  constexpr bool repeats = detail::repeats_a_joint<std::remove_const_t<decltype(groups)>>;
  static_assert(!repeats, "a joint is in two groups");
  if constexpr (!repeats)
    return detail::describe_groups<typename First::scalar>(model, groups,
                                                           detail::those_of<detail::IsNoGroup>(others...));
}

SKINCTL_END_NAMESPACE
