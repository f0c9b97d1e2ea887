// SPDX-License-Identifier: BSD-3-Clause
// Gains, payload and tool that change while a scene runs, with bumpless transfer.
#pragma once

#include <array>
#include <vector>

#include "skinctl/cycle/cycle.hpp"
#include "skinctl/dynamics/mass_ratio.hpp"
#include "skinctl/math/lu.hpp"
#include "skinctl/trajectory/detail/carrying_law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The input of a scene with several configurations.
template <class SceneInput>
struct ConfiguredInput : SceneInput {
  /// Index of the configuration from this cycle on.
  std::uint32_t configuration = 0;
};

namespace detail {
template <class... C>
struct OtherTypes {};
template <class C>
struct CarryingScene {
  static_assert(!std::is_same_v<C, C>, "Configurations: of Cycles");
};
template <class R, class L, class S, class Parts>
struct CarryingScene<Cycle<R, L, S, Parts>> {
  using Law = CarryingLaw<R::joints, typename Cycle<R, L, S, Parts>::law_type, typename R::scalar>;
  using type = Cycle<R, Law, S, Parts>;
};
/// A change from the configuration `before`.
template <class Scene, class LawMemory>
struct ChangeFrom {
  const Scene* before;  ///< scene before the change; null: no change
  const LawMemory& memory;

  template <class Loop, class Memory, class Receive>
  Status receive(const Loop& now, Memory& m, const Receive& goal) const noexcept {
    if (before == nullptr) return goal();
    now.restart(m);
    const Status status = goal();
    if (status.has(Reason::goal_refused)) m.law = memory;
    return status;
  }
  template <class Loop, class Memory, class State>
  void carry(const Loop& now, Memory& m, const State& measured, const Interval& interval) const noexcept {
    if (before == nullptr) return;
    now.carry_from(*before, memory, m, measured, interval);
  }
};
/// The stopwatch of a cycle that began before its scene's step.
template <class Watch>
struct BegunWatch {
  Watch& watch;
  SKINCTL_INLINE void begin() noexcept {}
  SKINCTL_INLINE void end(CycleStage stage) noexcept { watch.end(stage); }
};
}  // namespace detail

/// Several configurations of one scene, one of them active: other gains, skin gains, payload, tool. The index
/// of the active one is part of the input, so it is recorded and replayed like any other.
///
///     const auto scene = [&](const LinkInertia& load) {
///       return Cycle(by_position(Loaded<ur5::Model, 5>(ur5::Model{}, load), config), skin, law);
///     };
///     const Configurations cycle(scene({}), scene(part));  // in place of a Cycle, also for run_loop
///     input.configuration = 1;                             // from this cycle on
///
/// **No jump.** All configurations share one memory: the virtual state, the plans and clocks of the laws, the
/// skin's readings and the guard's memory go on. The difference of torque is ramped out by the quintic over
/// `transfer` (`Reason::bumpless_transfer` meanwhile):
///
///     tau_out = tau + (1 - a1((t - t0) / T_h)) d,
///
/// - by position or velocity, d is the torque with which the first sub-step accelerates the virtual robot as
///   the old configuration would have, its inertia and friction included;
/// - by torque, d is the old configuration's torque less the new one's at the newest measurement.
///
/// So the cycle of the change gives the command that it would have given without it (but for limits, an empty
/// tank, and samples of touch that arrive in this cycle, which count with the new gain). Later commands
/// differ by at most the quintic's rate, 1.9/T_h of the difference, and the new law's own motion.
///
/// **Goals.** A goal in the cycle of the change starts the law anew at the robot's state, from which its plan
/// leads. Send one with another tool (`X_LT`): the old plan is of the old tool, and without a goal the law
/// corrects the difference as a tracking error, at the rate of its gains.
///
/// - An index beyond the last configuration: `Reason::configuration_refused`, the old one goes on.
/// - By torque a change waits while the robot is stopped or its state is stale, because gravity would step:
///   `configuration_refused` until then. By position or velocity the virtual robot is at rest, and there is
///   no difference.
/// - A change during a change begins again from the present torque.
/// - The cycle of a change evaluates both laws once more, and N steps of the integrator: plan for two cycles.
///   Other cycles cost one comparison more than the scene. A scene without `Configurations` costs nothing.
///
/// @tparam C  the type of all configurations: they differ by numbers, not by types.
/// @tparam Count  number of configurations.
template <class C, std::size_t Count>
class Configurations {
  using Scene = typename detail::CarryingScene<C>::type;
  using Law = typename detail::CarryingScene<C>::Law;
  using Change = detail::ChangeFrom<Scene, typename Law::Memory>;

 public:
  static_assert(Count > 0, "at least one configuration");
  static constexpr std::size_t joints = C::joints;
  static constexpr std::size_t configurations = Count;
  using scalar = typename C::scalar;
  using law_type = Law;
  using Goal = typename C::Goal;
  using Sensed = typename C::Sensed;
  using Added = typename C::Added;
  using Input = ConfiguredInput<typename Scene::Input>;
  using Output = typename Scene::Output;  ///< output; the last of `shares` is the torque that is ramped out
  struct Memory : Scene::Memory {
    std::uint32_t configuration;  ///< index of the active configuration
  };

  /// Configuration 0, which is active first, and the others. Throws `ConfigurationError` with both numbers
  /// where they differ in limits, period, longest interval, delay, lag or Coulomb friction, where a skin's
  /// cells are not the same, and by torque where the gains of a tracking law are too large for a robot as
  /// light as another configuration says, or too small for its gravity: see `mass_ratio`, `gravity_rate`
  /// and `tracking_settings(robot, lightest)`.
  template <std::same_as<C>... Others>
  explicit Configurations(const C& first, const Others&... others)
      : Configurations(Ramp<scalar>(), first, others...) {}
  /// Configurations whose difference of torque is ramped out over `transfer` in place of 100 ms; otherwise as
  /// above.
  template <std::same_as<C>... Others>
  Configurations(const Ramp<scalar>& transfer, const C& first, const Others&... others)
      : scenes_{carrying(transfer, first), carrying(transfer, others)...} {
    static_assert(sizeof...(Others) + 1 == Count, "as many configurations as the type says");
    (check(first, others), ...);
    check_masses({&first, &others...});
  }

  /// The scene of configuration `i`, with a law that carries the difference of torque.
  [[nodiscard]] const Scene& operator[](std::size_t i) const noexcept {
    SKINCTL_EXPECTS(i < Count, "a configuration of this scene");
    return scenes_[i];
  }

  /// The memory with which configuration 0 takes over: see `Cycle::start`.
  [[nodiscard]] Memory start(const State<joints, scalar>& measured) const noexcept {
    Memory m{};
    start(m, measured);
    return m;
  }
  SKINCTL_COLD void start(Memory& m, const State<joints, scalar>& measured) const noexcept {
    scenes_[0].start(m, measured);
    m.configuration = 0;
  }
  [[nodiscard]] std::pair<Output, Memory> operator()(const Memory& memory,
                                                     const Input& input) const noexcept {
    std::pair<Output, Memory> result{Output{}, memory};
    result.first = step(result.second, input);
    return result;
  }
  /// One cycle in place, with the configuration that the input names: see `Cycle::step`.
  template <class Watch = NoStopwatch>
  Output step(Memory& m, const Input& input, Watch&& watch = {}) const noexcept {
    if (input.configuration == m.configuration) [[likely]]
      return scenes_[m.configuration].step(m, input, watch);
    return change(m, input, watch);
  }
  /// Warms the configuration that runs: see `Cycle::warm`.
  template <class Watch = NoStopwatch>
  void warm(Memory& scratch, const Memory& memory, const Input& input, Nanoseconds after,
            Watch&& watch = {}) const noexcept {
    Input same = input;
    same.configuration = memory.configuration;
    detail::dry_step(*this, scratch, memory, same, after, watch);
  }

 private:
  template <class Watch>
  SKINCTL_COLD Output change(Memory& m, const Input& input, Watch& watch) const noexcept {
    watch.begin();
    detail::BegunWatch<Watch> begun{watch};
    const Scene& before = scenes_[m.configuration];
    const bool changes = input.configuration < Count && before.may_change(m, input);
    const typename Law::Memory law_before = m.law;
    if (changes) {
      m.configuration = input.configuration;
      m.mark = scenes_[m.configuration].mark();
    }
    auto out = scenes_[m.configuration].run(m, input, begun, Change{changes ? &before : nullptr, law_before});
    if (!changes) out.status |= Reason::configuration_refused;
    return out;
  }

  [[nodiscard]] static Scene carrying(const Ramp<scalar>& transfer, const C& c) {
    return Scene(c.resolver(), c.skin(), Law(c.law(), transfer), c.parts());
  }
  SKINCTL_COLD static void check(const C& first, const C& other) {
    std::vector<double> facts;
    detail::each_fact_of_memory(first.resolver(),
                                [&](const char*, double value, const char*) { facts.push_back(value); });
    auto there = facts.begin();
    detail::each_fact_of_memory(other.resolver(), [&](const char* name, double here, const char* unit) {
      detail::require_same(name, here, *there++, unit, "in a configuration", "in the first one");
    });
    if (!TouchTable<std::remove_cvref_t<decltype(first.skin())>>::understands(first.skin(), other.skin()))
      refuse("skinctl: the skins of two configurations have other cells, or the same elsewhere");
  }

  // The active configuration may be another than the payload: by torque each law's gains are checked for the
  // lightest.
  SKINCTL_COLD static void check_masses(const std::array<const C*, Count>& all) {
    using Robot = std::remove_cvref_t<decltype(all[0]->resolver())>;
    if constexpr (Robot::is_one_group) {
      if constexpr (Robot::interface == Interface::torque) {
        const auto higher = [](scalar& x, const scalar& other) { x = other > x ? other : x; };
        for (const bool weigh : {false, true})  // first the masses: more inertia of rotors helps both
          for (const C* told : all) {
            const auto& shape = told->resolver().shape();
            LawTerms<joints, scalar> terms{told->resolver().period(), shape};
            for (const C* real : all) {
              const auto &here = told->resolver().model(), &there = real->resolver().model();
              higher(terms.mass_ratio, mass_ratio(here, there, shape.inertia));
              if (weigh && real != told) higher(terms.gravity_rate, gravity_rate(here, there, shape.inertia));
            }
            LawTable<typename C::law_type>::check_for(told->law(), terms);
          }
      }
    }
  }

  std::array<Scene, Count> scenes_;
};

/// Stand-in for configurations of different types, which are refused.
template <class... C, std::size_t Count>
class Configurations<detail::OtherTypes<C...>, Count> {
  static_assert(
      sizeof...(C) == 0,
      "configurations are Cycles of one type, so that they share one Memory: same laws, same parts; "
      "an empty hand is Loaded with {}");

 public:
  constexpr Configurations(const auto&...) noexcept {}
};

template <class C, class... Others>
  requires(!(std::is_same_v<C, Others> && ...))
Configurations(const C&, const Others&...)
    -> Configurations<detail::OtherTypes<C, Others...>, sizeof...(Others) + 1>;
template <class C, std::same_as<C>... Others>
Configurations(const C&, const Others&...) -> Configurations<C, sizeof...(Others) + 1>;
template <Real T, class C, std::same_as<C>... Others>
Configurations(const Ramp<T>&, const C&, const Others&...) -> Configurations<C, sizeof...(Others) + 1>;

SKINCTL_END_NAMESPACE
