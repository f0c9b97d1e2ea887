// SPDX-License-Identifier: BSD-3-Clause
// The members of a law, or their defaults: the only way in which the library asks for the optional ones.
#pragma once

#include "skinctl/law/law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The `Goal` of laws that take none.
struct NoGoal {};
/// The addition to input or output of a law that adds nothing.
struct NothingAdded {};

namespace detail {
template <class L>
struct GoalTypeOf {
  using type = NoGoal;
};
template <HasGoal L>
struct GoalTypeOf<L> {
  using type = typename L::Goal;
};
template <class L>
struct InputTypeOf {
  using type = NothingAdded;
};
template <HasLawInput L>
struct InputTypeOf<L> {
  using type = typename L::Input;
};
template <class L>
struct OutputTypeOf {
  using type = NothingAdded;
};
template <HasLawOutput L>
struct OutputTypeOf<L> {
  using type = typename L::Output;
};
template <class L, class T>
struct ScalarTypeOf {
  using type = T;
};
template <HasScalar L, class T>
struct ScalarTypeOf<L, T> {
  using type = typename L::scalar;
};
}  // namespace detail

/// The members of the law `L`, or their defaults: see the table in law/law.hpp. Members that depend on a
/// robot are in law/evaluate.hpp.
template <class L>
struct LawTable {
  static constexpr bool takes_goals = detail::HasGoal<L>;
  /// Type of the law's goals; `NoGoal` if it takes none.
  using Goal = typename detail::GoalTypeOf<L>::type;
  /// The law's addition to the input of a scene, and to its output; `NothingAdded` or another empty type if
  /// nothing.
  using Input = typename detail::InputTypeOf<L>::type;
  using Output = typename detail::OutputTypeOf<L>::type;
  /// Number of joints of the robots for which the law is made; 0: any number.
  static constexpr std::size_t joints = [] {
    if constexpr (detail::HasJoints<L>) return std::size_t(L::joints);
    return std::size_t(0);
  }();
  /// Scalar for which the law is made; `T` if it is made for any.
  template <class T>
  using scalar_in = typename detail::ScalarTypeOf<L, T>::type;
  static constexpr LawRole role = [] {
    if constexpr (detail::HasRole<L>) return LawRole(L::role);
    return LawRole::reactive;
  }();
  static constexpr std::size_t gravity_laws = [] {
    if constexpr (detail::HasGravityLaws<L>) return std::size_t(L::gravity_laws);
    return std::size_t(role == LawRole::gravity ? 1 : 0);
  }();
  /// Whether the law compensates gravity: by a gravity law, or within `Y_r Theta`.
  static constexpr bool holds_gravity = gravity_laws > 0 || role == LawRole::tracking;
  static constexpr bool is_complete_sum = [] {
    if constexpr (detail::HasCompleteSum<L>) return bool(L::complete_sum);
    return false;
  }();
  static constexpr bool compensates_friction = [] {
    if constexpr (detail::HasFriction<L>) return bool(L::compensates_friction);
    return false;
  }();
  static constexpr bool presses = [] {
    if constexpr (detail::HasPresses<L>) return bool(L::presses);
    return false;
  }();
  static constexpr bool is_gated = detail::HasGate<L>;
  /// Whether the law is a response to the skin: others may oppose it, and it opens gates. A reactive law that
  /// does not read touch (a joint limit, a posture) opposes nothing.
  static constexpr bool answers_touch = [] {
    if constexpr (detail::HasNeeds<L>) return role == LawRole::reactive && Needs(L::needs).touch;
    return false;
  }();
  /// Whether a sum adds G(q) to the parts of the law's torque, where no gravity law is loaded.
  static constexpr bool lacks_gravity = role == LawRole::tracking && detail::MayHaveParts<L>;
  static constexpr bool starts_blank = [] {
    if constexpr (detail::HasStartsBlank<L>) return bool(L::starts_blank);
    return std::is_empty_v<typename L::Memory>;
  }();
  static constexpr std::size_t terms = [] {
    if constexpr (detail::HasTerms<L>) return std::size_t(L::terms);
    return std::size_t(1);
  }();
  static constexpr std::array<LawRole, terms> roles = [] {
    if constexpr (detail::HasRoles<L>) {
      return L::roles;
    } else {
      std::array<LawRole, terms> out{};
      for (LawRole& r : out) r = role;
      return out;
    }
  }();
  [[nodiscard]] static constexpr LawRole role_of_part(std::size_t i) noexcept {
    return i < terms ? roles[i] : role;
  }
  /// The roles of the law's parts, then that of a torque difference carried beside them: tracking.
  static constexpr std::array<LawRole, terms + 1> roles_with_carried = [] {
    std::array<LawRole, terms + 1> out{};
    for (std::size_t i = 0; i < terms; ++i) out[i] = roles[i];
    out[terms] = LawRole::tracking;
    return out;
  }();
  static constexpr std::string_view name = [] {
    if constexpr (detail::HasName<L>) return std::string_view(L::name);
    return std::string_view("law");
  }();

  /// Lets the law see its scene, if it does.
  /// @param input  input of the whole scene, a base of which is `Input`.
  template <class Memory, class In, class Seen>
  static SKINCTL_INLINE Status see(const L& law, Memory& memory, const In& input, const Seen& seen) noexcept {
    if constexpr (detail::SeesScene<L, In, Seen>) {
      return law.see(memory, input, seen);
    } else {
      return {};
    }
  }
  template <class Memory>
  [[nodiscard]] static Output output(const L& law, const Memory& memory) noexcept {
    if constexpr (detail::HasLawOutput<L>) {
      return law.output(memory);
    } else {
      return {};
    }
  }
  [[nodiscard]] static bool needs_contacts(const L& law) noexcept {
    if constexpr (detail::TellsWaits<L>) {
      return law.needs_contacts();
    } else {
      return false;
    }
  }
  /// Throws `ConfigurationError` where the law's settings are not those of the robot (`LawTerms`), or do not
  /// fit a limit of jerk (`JerkTerms`).
  template <class Terms>
  static void check_for(const L& law, const Terms& robot) {
    if constexpr (detail::ChecksTerms<L, Terms>) {
      law.check_for(robot);
    } else {
      static_assert(detail::IsJerkTerms<Terms> || !detail::NamesCheckFor<L>,
                    "check_for(terms) of this law does not take the robot's LawTerms");
    }
  }
};

/// Number of parts whose shares a law reports: its `terms`, or 1.
template <class L>
inline constexpr std::size_t terms_of = LawTable<L>::terms;

namespace detail {
/// A law of the skin without settings, or a sum with one (see fusion/expression.hpp): without a skin it does
/// nothing.
template <class L>
inline constexpr bool lives_on_skin = std::is_empty_v<L> && LawTable<L>::answers_touch;
}  // namespace detail

SKINCTL_END_NAMESPACE
