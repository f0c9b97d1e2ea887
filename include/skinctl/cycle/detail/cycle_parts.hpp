// SPDX-License-Identifier: BSD-3-Clause
// The parts of a scene, and its types.
#pragma once

#include <type_traits>

#include "skinctl/cycle/detail/check_arithmetic.hpp"
#include "skinctl/cycle/detail/check_scene.hpp"
#include "skinctl/cycle/detail/scene_mark.hpp"
#include "skinctl/cycle/detail/scene_traits.hpp"
#include "skinctl/cycle/input.hpp"
#include "skinctl/cycle/output.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/law/evaluate.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The parts of a `Cycle`, and the types that follow from them.
template <class Resolver, class GivenLaw, class GivenSkin, class Parts>
class CycleParts {
  using Scene = detail::Scene<Resolver, GivenLaw, GivenSkin>;

 protected:
  using Governor = GovernorOf<Resolver, Parts>;
  using Guard = GuardOf<Resolver, Parts>;
  using Skin = typename Scene::Skin;
  using L = typename Scene::Law;

 public:
  static constexpr bool governed = Governor::acts;
  static constexpr std::size_t joints = Resolver::joints;
  using scalar = typename Resolver::scalar;
  using law_type = L;
  using Goal = typename LawTable<L>::Goal;
  using Sensed = typename TouchTable<Skin>::Sensed;
  using Added = AddedInputs<L, Governor>;
  using Input = typename Joined<CycleInput<joints, scalar, Goal, Sensed>, Added>::type;
  using Output = JoinedWith<CycleOutput<typename Resolver::Sent, joints, scalar, terms_of<L>>,
                            typename LawTable<L>::Output>;
  using Wrenches = typename Skin::Wrenches;
  using Known = typename Resolver::template Knows<L, Wrenches>;
  static constexpr bool watches_contacts = Resolver::watches_contacts || Governor::reads_touch;
  /// The touch that the resolver takes: forces and proximities apart where it has to distinguish them.
  using Touch = typename TouchFor<Resolver, Skin, watches_contacts>::type;

  using Change = ChangeOf<Wrenches>;

  /// The state that changes from cycle to cycle; trivially copyable.
  struct Memory {
    typename Resolver::Memory robot;
    typename L::Memory law;
    typename Guard::Memory guard;
    typename Skin::Memory skin;
    std::uint64_t mark = 0;  ///< mark of the scene by which it was started; another scene refuses it
    [[no_unique_address]] typename Governor::Memory governor;
    [[no_unique_address]] typename Change::Memory touch;
  };

  [[nodiscard]] const Resolver& resolver() const noexcept { return resolver_; }
  [[nodiscard]] const L& law() const noexcept { return law_; }
  [[nodiscard]] const Skin& skin() const noexcept { return skin_; }
  [[nodiscard]] const Guard& guard() const noexcept { return guard_; }
  [[nodiscard]] const Governor& governor() const noexcept { return governor_; }
  /// The list of the scene's parts.
  [[nodiscard]] const Parts& parts() const noexcept { return parts_; }
  /// The mark of the scene's memories: a digest of limits, times, gravity in the base, ids and places of
  /// cells.
  [[nodiscard]] std::uint64_t mark() const noexcept { return mark_; }

 protected:
  /// Checks the arithmetic; every public constructor makes one before anything else of a scene.
  struct Whole {
    Whole() { check_arithmetic<scalar>(); }
  };
  template <class Robot>
  CycleParts(Whole, const Robot& robot, Skin&& skin, const L& law, const Parts& parts)
      : resolver_(as_resolver(robot)),
        law_(law),
        skin_(std::move(skin)),
        parts_(parts),
        governor_(governor_of(resolver_, parts)),
        guard_(guard_of(resolver_, parts, governor_)),
        mark_(scene_mark(resolver_, skin_)) {
    if constexpr (Described<Robot>) {
      check_settings(robot, law);
      check_contacts(robot, skin_);
    }
    if constexpr (Governor::template has<JerkLimit>) {
      using Stiff = typename Resolver::Stiff;
      const auto& limit = governor_.template get<JerkLimit>();
      JointAcceleration<Resolver::joints, scalar> acceleration;
      Stiff::put(Stiff::of(limit.joints().acceleration()), acceleration);
      LawTable<L>::check_for(law, jerk_terms(resolver_.model(), resolver_.shape(), acceleration, limit.jerk(),
                                             resolver_.planned_step()));
    }
    if constexpr (!TouchTable<Skin>::finds_contacts)
      require(!LawTable<L>::needs_contacts(law), "skills that wait for contacts, on a skin that finds none",
              1, "a ContactSkin");
    governor_.check(resolver_);
  }
  /// The planned interval [s], for the laws that start or take goals between two evaluations.
  [[nodiscard]] scalar period() const noexcept { return resolver_.planned_step(); }
  /// Whether a limit, such as the watch over the skin, holds a robot that nobody else has stopped.
  [[nodiscard]] SKINCTL_INLINE bool pauses(const Memory& m) const noexcept {
    if constexpr (Governor::may_stay) {
      return governor_.stays(m.governor) && !resolver_.stops(m.robot);
    } else {
      return false;
    }
  }

  Resolver resolver_;
  L law_;
  Skin skin_;
  [[no_unique_address]] Parts parts_;
  [[no_unique_address]] Governor governor_;
  Guard guard_;
  std::uint64_t mark_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
