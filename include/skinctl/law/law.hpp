// SPDX-License-Identifier: BSD-3-Clause
// The protocol of a law: an immutable configuration that computes joint torque from the known state; its
// memory is kept outside.
#pragma once

#include "skinctl/core/state.hpp"
#include "skinctl/law/detail/law_rows.hpp"
#include "skinctl/law/law_values.hpp"
#include "skinctl/law/needs.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Base of a law without memory: `Own` defines `torque(known)`, and `needs` and `role` where they differ from
/// the defaults.
///
///     struct Damper : StatelessLaw<Damper> {
///       JointTorque<6> torque(const auto& known) const noexcept {
///         return JointTorque<6>::generate([&](std::size_t i) { return -2.0 * known.dq()[i]; });
///       }
///     };
///
/// @tparam Own  the law that derives from this base. The memories of different laws are then different empty
///              types, which take no space side by side.
template <class Own>
struct StatelessLaw : Composable {
  struct Memory {};
  static constexpr Needs needs = {};
  static constexpr LawRole role = LawRole::reactive;

  template <class K>
  [[nodiscard]] static SKINCTL_INLINE constexpr Memory start(const K&) noexcept {
    return {};
  }
  template <class K>
  [[nodiscard]] static SKINCTL_INLINE constexpr Memory advance(const Memory&, const K&,
                                                               const typename K::scalar&,
                                                               Opposition) noexcept {
    return {};
  }
};

/// Any type with the members of a law, whatever the robot. It names members, not a call: an Eigen vector is
/// callable too.
template <class L>
concept LawMembers = detail::HasMemory<L> && detail::HasNeeds<L> && detail::HasRole<L>;

/// A law for a robot of `K`'s size: an immutable value. `known` is a `Quantities`: the state, the quantities
/// computed from it, and the interval for which the torque will be held. All functions are const, pure and
/// `noexcept`. The library uses no other members of a law.
///
/// Every law has
/// - `Memory`: the data that change from cycle to cycle, trivially copyable. Only the law itself reads or
///   writes its members;
/// - `needs`, `role`: compile-time values;
/// - `start(known)`: the memory with which the law begins at that state;
/// - `torque(memory, known)`: the joint torque [N m]; `torque(known)` if `Memory` is empty. A tracking law
///   has `parts` instead, see `TrackingLaw`;
/// - `advance(memory, known, dt, opposition)`: the memory after `dt` seconds.
///
/// `StatelessLaw` derives all but the torque. A law that derives from `Composable` can be written in sums.
///
/// Optional members, with the default where a law has none, and the rule of a sum. A wrapper (`WrappedLaw`)
/// has what its law has.
///
/// | member | meaning | default | of a sum |
/// |---|---|---|---|
/// | `status(memory)` | the reasons for what it limits, holds or ramps out in this cycle | none | of all |
/// | `settled(memory, known, still)` | whether it is at rest at its goal | no joint is faster than `still` | all are |
/// | `resumed(memory, known)` | the memory after a stop, a brake or old states, in which others moved the robot | as it was | of all |
/// | `Goal`, `receive`, `follow` | see `GoalLaw` | takes no goals | the one that takes such a goal |
/// | `distance(known, goal)` | `position` [m], `orientation` and `joint` [rad] from a goal | unknown | not asked |
/// | `presses` | a tracking law that presses against a contact: the skin does not oppose it | false | each its own |
/// | `joints`, `scalar` | the robots for which it is made: compared where a scene is built | any | those of all |
/// | `compensates_friction` | its torque includes friction, so the robot must not add it | false | one does |
/// | `check_for(terms)` | throws if its settings differ from the robot's (`LawTerms`), or do not fit a limit of jerk (`JerkTerms`) | any | all |
/// | `starts_blank` | `Memory{}` is what `start` gives, in every state | only an empty `Memory` | all do |
/// | `name` | for `describe` | "law" | in words |
/// | `terms`, `roles` | number of shares in its own `evaluate`, and the role of each | 1, its `role` | one a law |
/// | `Laws` | a law made of others: a `std::tuple` of their types, each checked on its own | - | its laws |
/// | `gravity_laws` | number of gravity laws in it | 1 of role `gravity` | all |
/// | `complete_sum` | cannot be part of a sum | false | a blend is |
/// | `gate` | acts only behind a gate: `when_touched` | always | each its own |
///
/// A law that sees its scene, once in a cycle, before it is evaluated:
///
/// | member | meaning | default | of a sum |
/// |---|---|---|---|
/// | `see(memory, input, seen)` | takes in what the scene's input and its touch say: a `Status` | sees nothing | all see |
/// | `Input` | what it adds to the input of the scene: a base of it | nothing | each once |
/// | `Output`, `output(memory)` | what it adds to the output | nothing | each once |
/// | `needs_contacts()` | a touch that finds no contacts is refused | false | one does |
///
/// `seen` has `now`, the end of the interval; `contacts()`, if `finds_contacts`: each a `Found` of the touch;
/// `pressed()`, `max_proximity<Ix>()` and `coverage()`, as limits see them; `skin` and `memory`, for what a
/// touch alone can tell: `seen.skin.told(seen.memory, cell, channel)` of a `ToldSkin`.
///
/// Optional, for speed alone; the results are the same:
/// - `evaluate(memory, known, dt)`: torque, next memory, shares and status at once (`Evaluation`). Used in
///   place of `torque`, `advance` and `status` where the law is the only one of a scene.
/// - `now(memory, known)`: the common terms of torque and next memory, computed once in a sum. The law then
///   takes them as the last argument of `torque<G>(memory, known, share, now)` and of
///   `advance(..., opposition, now)`.
///
/// All of it is asked for by `LawTable` and the functions of law/evaluate.hpp, and nowhere else.
template <class L, class K>
concept Law =
    LawMembers<L> &&
    requires(const L& law, const typename L::Memory& memory, const K& known, const typename K::scalar& dt) {
      requires std::is_trivially_copyable_v<typename L::Memory>;
      { law.start(known) } -> std::same_as<typename L::Memory>;
      { law.advance(memory, known, dt, Opposition::none) } noexcept -> std::same_as<typename L::Memory>;
    } && (detail::GivesTorque<L, K> || detail::HasParts<L, K> || detail::HasStatelessParts<L, K>);

/// A law of role `tracking`. It gives the parts of its torque separately, because a sum weights them
/// differently:
/// - `parts(memory, known)`: a `TorqueParts`; `parts(known)` if `Memory` is empty. The sum adds G(q) unless
///   it holds a gravity law. Where the law is the only one of a scene, the scene adds G(q), so `needs` must
///   include `gravity`.
///
/// Optional, for speed: `torque<G>(memory, known, share)`, the weighted sum of both parts,
/// `feedback * (-K_d S_q) + feed_forward * (Y_r Theta)`, with `feed_forward * G(q)` if G is
/// `GravityTerm::included`, its default. A law that has it needs no `parts`. One recursion then computes both
/// parts and gravity.
template <class L, class K>
concept TrackingLaw = Law<L, K> && L::role == LawRole::tracking && detail::TakesShare<L, K>;

/// A law that takes goals:
/// - `Goal`: their type;
/// - `receive(memory, known, goal)`: a `Received<Memory>`. A refused goal leaves the memory unchanged and
///   gives `Reason::goal_refused`.
///
/// A law for moving targets adds `follow(memory, known, goal)` for the next sample of a target. Where it
/// exists it is called in place of `receive`, and distinguishes a sample from a new goal.
template <class L, class K>
concept GoalLaw = Law<L, K> && detail::HasGoal<L> && detail::Receives<L, K, typename L::Goal>;

SKINCTL_END_NAMESPACE
