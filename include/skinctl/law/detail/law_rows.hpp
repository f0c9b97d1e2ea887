// SPDX-License-Identifier: BSD-3-Clause
// Whether a law has each member of the protocol: the rows of its table.
#pragma once

#include <array>
#include <concepts>
#include <string_view>
#include <type_traits>

#include "skinctl/core/detail/named_twice.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/law/law_values.hpp"
#include "skinctl/law/needs.hpp"

SKINCTL_BEGIN_NAMESPACE

template <std::size_t N, Scalar T, class M, std::size_t Terms>
struct Evaluation;

namespace detail {

// What every law has.
template <class L>
concept HasMemory = requires { typename L::Memory; };
template <class L>
concept HasNeeds = requires {
  { L::needs } -> std::convertible_to<Needs>;
};
template <class L>
concept HasRole = requires {
  { L::role } -> std::convertible_to<LawRole>;
};
template <class L, class K>
concept Starts = requires(const L& law, const K& known) { law.start(known); };
template <class L, class K>
concept Advances = requires(const L& law, const typename L::Memory& m, const K& known,
                            const typename K::scalar& dt) { law.advance(m, known, dt, Opposition::none); };
// The forms of its torque; a law without memory may leave the memory out.
template <class L, class K>
concept HasTorque =
    requires(const L& law, const typename L::Memory& m, const K& known) { law.torque(m, known); };
template <class L, class K>
concept HasStatelessTorque =
    std::is_empty_v<typename L::Memory> && requires(const L& law, const K& known) { law.torque(known); };
template <class L, class K>
concept GivesTorqueByMemory = requires(const L& law, const typename L::Memory& m, const K& known) {
  { law.torque(m, known) } noexcept -> std::same_as<JointTorque<K::joints, typename K::scalar>>;
};
template <class L, class K>
concept GivesStatelessTorque = HasStatelessTorque<L, K> && requires(const L& law, const K& known) {
  { law.torque(known) } noexcept -> std::same_as<JointTorque<K::joints, typename K::scalar>>;
};
template <class L, class K>
concept GivesTorque = GivesTorqueByMemory<L, K> || GivesStatelessTorque<L, K>;
template <class L, class K>
concept HasParts =
    requires(const L& law, const typename L::Memory& m, const K& known) { law.parts(m, known); };
template <class L, class K>
concept HasStatelessParts =
    std::is_empty_v<typename L::Memory> && requires(const L& law, const K& known) { law.parts(known); };
template <class L, class K>
concept HasWeightedTorque = requires(const L& law, const typename L::Memory& m, const K& known,
                                     const LawShare<typename K::scalar>& share) {
  law.template torque<GravityTerm::left_out>(m, known, share);
};
/// A law whose torque can be weighted in a sum.
template <class L, class K>
concept TakesShare = HasWeightedTorque<L, K> || HasParts<L, K> || HasStatelessParts<L, K>;

/// A known state of a robot that includes its limits; a law may be evaluated without them.
template <class K>
concept KnowsLimits = requires(const K& known) { known.limits(); };

// Constants.
template <class L>
concept HasJoints = requires {
  { L::joints } -> std::convertible_to<std::size_t>;
};
template <class L>
concept HasScalar = requires { typename L::scalar; };
template <class L>
concept HasName = requires { std::string_view(L::name); };
template <class L>
concept HasPresses = requires {
  { L::presses } -> std::convertible_to<bool>;
};
template <class L>
concept HasFriction = requires {
  { L::compensates_friction } -> std::convertible_to<bool>;
};
template <class L>
concept HasStartsBlank = requires {
  { L::starts_blank } -> std::convertible_to<bool>;
};
template <class L>
concept HasGravityLaws = requires {
  { L::gravity_laws } -> std::convertible_to<std::size_t>;
};
template <class L>
concept HasCompleteSum = requires {
  { L::complete_sum } -> std::convertible_to<bool>;
};
template <class L>
concept HasGate = requires { L::gate; };
template <class L>
concept HasTerms = requires {
  { L::terms } -> std::convertible_to<std::size_t>;
};
template <class L>
concept HasRoles = HasTerms<L> && requires {
  { L::roles } -> std::convertible_to<std::array<LawRole, L::terms>>;
};
template <class L>
concept IsMadeOfLaws = requires { typename L::Laws; };
template <class L>
concept IsWrapper = requires { typename L::WrappedType; };

// Functions.
template <class L>
concept HasStatus = requires(const L& law, const typename L::Memory& m) {
  { law.status(m) } -> std::same_as<Status>;
};
template <class L, class K>
concept HasSettled =
    requires(const L& law, const typename L::Memory& m, const K& known, const typename K::scalar& still) {
      { law.settled(m, known, still) } -> std::same_as<bool>;
    };
template <class L, class K>
concept HasResumed = requires(const L& law, const typename L::Memory& m, const K& known) {
  { law.resumed(m, known) } -> std::same_as<typename L::Memory>;
};
template <class L, class Terms>
concept ChecksTerms = requires(const L& law, const Terms& robot) { law.check_for(robot); };
template <class Terms>
concept IsJerkTerms = requires(const Terms& t) { t.rise; };
template <class L>
concept HasGoal = requires { typename L::Goal; };
template <class L, class K>
concept TakesGoal = requires(const L& law, const typename L::Memory& m, const K& known,
                             const typename L::Goal& goal) { law.receive(m, known, goal); };
template <class L, class K, class G>
concept Receives = requires(const L& law, const typename L::Memory& m, const K& known, const G& goal) {
  { law.receive(m, known, goal) } -> std::same_as<Received<typename L::Memory>>;
};
template <class L, class K, class G>
concept Follows = requires(const L& law, const typename L::Memory& m, const K& known, const G& goal) {
  { law.follow(m, known, goal) } -> std::same_as<Received<typename L::Memory>>;
};
template <class L, class K, class G>
concept HasDistance = requires(const L& law, const K& known, const G& goal) {
  law.distance(known, goal).position;
  law.distance(known, goal).orientation;
  law.distance(known, goal).joint;
};

// Of a law that sees its scene.
template <class L>
concept HasLawInput = requires { typename L::Input; };
template <class L>
concept HasLawOutput = requires(const L& law, const typename L::Memory& m) {
  { law.output(m) } -> std::same_as<typename L::Output>;
};
template <class L, class In, class Seen>
concept SeesScene = requires(const L& law, typename L::Memory& m, const In& input, const Seen& seen) {
  { law.see(m, input, seen) } -> std::same_as<Status>;
};
/// Whether a law sees its scene: a sum tells whether one of its laws does.
template <class L, class In, class Seen>
inline constexpr bool sees = SeesScene<L, In, Seen>;
template <class L, class In, class Seen>
concept TellsIfOneSees = requires { L::template one_sees<In, Seen>; };
template <class L, class In, class Seen>
  requires TellsIfOneSees<L, In, Seen>
inline constexpr bool sees<L, In, Seen> = L::template one_sees<In, Seen>;
template <class L>
concept TellsWaits = requires(const L& law) {
  { law.needs_contacts() } -> std::same_as<bool>;
};

// For speed.
template <class L, class K>
concept HasNow = requires(const L& law, const typename L::Memory& m, const K& known) { law.now(m, known); };
template <class L, class K, std::size_t Terms>
concept HasEvaluate =
    requires(const L& law, const typename L::Memory& m, const K& known, const typename K::scalar& dt) {
      {
        law.evaluate(m, known, dt)
      } -> std::same_as<Evaluation<K::joints, typename K::scalar, typename L::Memory, Terms>>;
    };

// Names, whatever their signature.
struct NamesOfALaw {
  int start, torque, parts, advance, receive, follow, status, settled, resumed, distance, check_for, now,
      evaluate, name, presses, compensates_friction, starts_blank, gravity_laws, complete_sum, terms, roles,
      see, output, needs_contacts;
};
SKINCTL_NAMES(NamesStart, NamesOfALaw, start);
SKINCTL_NAMES(NamesTorque, NamesOfALaw, torque);
SKINCTL_NAMES(NamesParts, NamesOfALaw, parts);
SKINCTL_NAMES(NamesAdvance, NamesOfALaw, advance);
SKINCTL_NAMES(NamesReceive, NamesOfALaw, receive);
SKINCTL_NAMES(NamesFollow, NamesOfALaw, follow);
SKINCTL_NAMES(NamesStatus, NamesOfALaw, status);
SKINCTL_NAMES(NamesSettled, NamesOfALaw, settled);
SKINCTL_NAMES(NamesResumed, NamesOfALaw, resumed);
SKINCTL_NAMES(NamesDistance, NamesOfALaw, distance);
SKINCTL_NAMES(NamesCheckFor, NamesOfALaw, check_for);
SKINCTL_NAMES(NamesNow, NamesOfALaw, now);
SKINCTL_NAMES(NamesEvaluate, NamesOfALaw, evaluate);
SKINCTL_NAMES(NamesName, NamesOfALaw, name);
SKINCTL_NAMES(NamesPresses, NamesOfALaw, presses);
SKINCTL_NAMES(NamesFriction, NamesOfALaw, compensates_friction);
SKINCTL_NAMES(NamesStartsBlank, NamesOfALaw, starts_blank);
SKINCTL_NAMES(NamesGravityLaws, NamesOfALaw, gravity_laws);
SKINCTL_NAMES(NamesCompleteSum, NamesOfALaw, complete_sum);
SKINCTL_NAMES(NamesTerms, NamesOfALaw, terms);
SKINCTL_NAMES(NamesRoles, NamesOfALaw, roles);
SKINCTL_NAMES(NamesLawSee, NamesOfALaw, see);
SKINCTL_NAMES(NamesOutput, NamesOfALaw, output);
SKINCTL_NAMES(NamesWaits, NamesOfALaw, needs_contacts);
/// A torque that is weighted by its parts contains G(q) where no gravity law is loaded.
template <class L>
concept MayHaveParts = !CanBeAsked<L> || NamesParts<L>;

}  // namespace detail
SKINCTL_END_NAMESPACE
