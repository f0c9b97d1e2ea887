// SPDX-License-Identifier: BSD-3-Clause
// Control fusion: a weighted sum of laws that is itself a law, eq. (23).
#pragma once

#include <tuple>

#include "skinctl/core/detail/row.hpp"
#include "skinctl/fusion/detail/law_parts.hpp"
#include "skinctl/fusion/detail/seeing_laws.hpp"
#include "skinctl/fusion/opposition.hpp"
#include "skinctl/law/evaluate.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The effect of the weights of tracking laws. In every case gravity enters once with weight 1, and a
/// reactive law with its own weight.
enum class Sum : unsigned char {
  normalised,  ///< weights divided by their sum, for feedback and feed-forward alike
  weighted,    ///< weights as given for feedback, divided by their sum for feed-forward
  plain        ///< the paper's sum: everything but gravity with the weights as given
};

/// A sum of laws, written `0.6 * skin + 0.4 * reach + gravity` (fusion/expression.hpp).
///
/// - Gravity enters exactly once: where a gravity law is in the sum, tracking laws leave G out of
///   `Y_r Theta`; where none is, `Y_r Theta` contains it. (In a plain sum without a gravity law the weights
///   of the tracking laws also multiply G, so they should sum to one.)
/// - Each law is computed once for the torque, its share and the opposition of skin and tracking, which then
///   freezes and resets the tracking laws; what its torque and memory share (`now`) is computed once, too.
template <Sum Policy, LawMembers... L>
class Fused : public Composable,
              public detail::GoalOf<std::tuple<>, L...>,
              public detail::SeeingLaws<Fused<Policy, L...>, L...> {
 public:
  using Laws = std::tuple<L...>;
  static constexpr std::size_t terms = sizeof...(L);
  static constexpr std::size_t joints = detail::joints_of_laws<L...>();  ///< number of joints; 0: any robot
  static constexpr Sum policy = Policy;
  static constexpr std::array<LawRole, terms> roles = {L::role...};
  static constexpr std::size_t gravity_laws = detail::count_role<L...>(LawRole::gravity);
  static constexpr std::size_t tracking_laws = detail::count_role<L...>(LawRole::tracking);
  static constexpr std::size_t reactive_laws = detail::count_role<L...>(LawRole::reactive);
  static constexpr bool answers_touch = (false || ... || LawTable<L>::answers_touch);
  static constexpr bool watches = tracking_laws > 0 && answers_touch;
  static constexpr bool compensates_friction = (false || ... || LawTable<L>::compensates_friction);
  static_assert(terms > 0 && gravity_laws <= 1, "gravity twice: keep one gravity law");
  static constexpr GravityTerm gravity_term =
      gravity_laws > 0 ? GravityTerm::left_out : GravityTerm::included;
  /// The union of the laws' needs; without a gravity law, the test for opposition needs G as well.
  static constexpr Needs needs =
      (Needs{.gravity = gravity_laws == 0 && (watches || ... || LawTable<L>::lacks_gravity)} | ... |
       Needs(L::needs));
  static constexpr LawRole role = tracking_laws > 0   ? LawRole::tracking
                                  : reactive_laws > 0 ? LawRole::reactive
                                                      : LawRole::gravity;

  struct Memory {
    detail::Memories<typename L::Memory...> laws;
    OppositionDetector::Memory opposition;
  };
  static constexpr bool starts_blank = (LawTable<L>::starts_blank && ...);

  /// @param weights  one for each law: > 0, <= 1e6, and 1 for gravity; else throws `ConfigurationError`.
  explicit Fused(const std::tuple<L...>& laws, const std::array<double, terms>& weights,
                 const OppositionDetector& detector = OppositionDetector())
      : laws_(laws), weights_(weights), detector_(detector) {
    for (std::size_t i = 0; i < terms; ++i) {
      require(weights[i] > 0 && weights[i] <= 1e6, "weight of a law", weights[i],
              "> 0: leave out what has none");
      require(roles[i] != LawRole::gravity || weights[i] == 1.0, "weight of gravity", weights[i], "1");
    }
    shares_ = shares(weights);
  }

  /// The factors of each law's two parts that the policy computes from weights >= 0. Where no tracking law
  /// has a weight, none has a share.
  [[nodiscard]] static constexpr std::array<LawShare<double>, terms> shares(
      const std::array<double, terms>& weights) noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < terms; ++i)
      if (roles[i] == LawRole::tracking) sum += weights[i];
    std::array<LawShare<double>, terms> out{};
    for (std::size_t i = 0; i < terms; ++i) {
      const double w = weights[i], part = roles[i] == LawRole::tracking && sum > 0 ? w / sum : w;
      out[i] = {Policy == Sum::normalised ? part : w, Policy == Sum::plain ? w : part};
    }
    return out;
  }

  /// This sum with other thresholds of opposition.
  [[nodiscard]] Fused opposed_by(const OppositionSettings& settings) const {
    return Fused(laws_, weights_, OppositionDetector(settings));
  }
  [[nodiscard]] const std::tuple<L...>& laws() const noexcept { return laws_; }
  /// Throws `ConfigurationError` where a law's settings are not those of the robot.
  template <class Terms>
  void check_for(const Terms& robot) const {
    std::apply([&](const L&... law) { (LawTable<L>::check_for(law, robot), ...); }, laws_);
  }
  [[nodiscard]] const std::array<double, terms>& weights() const noexcept { return weights_; }
  [[nodiscard]] const OppositionDetector& detector() const noexcept { return detector_; }
  /// The `Ix`-th law's part of a memory.
  template <std::size_t Ix>
  [[nodiscard]] static SKINCTL_INLINE constexpr const auto& memory(const Memory& m) noexcept {
    return detail::memory_of<Ix>(m.laws);
  }

  /// Calls `f(law, its memory)` for each law.
  template <class Memory, class F>
  SKINCTL_INLINE void each_law(Memory& memory, F&& f) const noexcept {
    each([&](auto i, const auto& law)
             SKINCTL_INLINE_LAMBDA { f(law, detail::memory_of<i.value>(memory.laws)); });
  }
  /// The index of the law that takes goals of this type; `terms` if none or several do.
  template <class Goal>
  static constexpr std::size_t taker() noexcept {
    std::size_t found = terms, count = 0, i = 0;
    const auto look = [&](bool takes) {
      if (takes) found = i, ++count;
      ++i;
    };
    (look(LawTable<L>::takes_goals && std::same_as<typename LawTable<L>::Goal, Goal>), ...);
    return count == 1 ? found : terms;
  }

  /// The memory with which every law starts at the known state.
  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    Memory memory{};
    each([&](auto i, const auto& law) { detail::memory_of<i.value>(memory.laws) = law.start(known); });
    return memory;
  }

  /// The memory after a goal, or the next sample of a target, for the one law that takes goals of this type.
  template <class K, class Goal>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const Goal& goal) const noexcept {
    constexpr std::size_t i = taker<Goal>();
    static_assert(i < terms, "no law, or more than one, takes such a goal: receive<I>(memory, known, goal)");
    return receive<i>(memory, known, goal);
  }
  /// The memory after a goal for the `Ix`-th law, or after the next sample of a target that it follows.
  template <std::size_t Ix, class K, class Goal>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const Goal& goal) const noexcept {
    Received<Memory> out{memory, {}};
    auto& part = detail::memory_of<Ix>(out.memory.laws);
    const auto answer = follow_or_receive(std::get<Ix>(laws_), part, known, goal);
    part = answer.memory;
    out.status = answer.status;
    return out;
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const Memory& memory, const K& known) const noexcept {
    return evaluate(memory, known, known.dt()).torque;
  }
  /// The reasons of all laws, and `opposed` while skin and tracking are.
  [[nodiscard]] Status status(const Memory& memory) const noexcept {
    Status out;
    each_law(memory, [&](const auto& law, const auto& m) { out |= status_of(law, m); });
    if (memory.opposition.opposed) out |= Reason::opposed;
    return out;
  }
  /// Whether all laws are settled.
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known,
                             const typename K::scalar& still) const noexcept {
    return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      return (skinctl::settled(std::get<Ix>(laws_), detail::memory_of<Ix>(memory.laws), known, still) && ...);
    }(std::index_sequence_for<L...>{});
  }
  /// The memory after `dt` seconds.
  /// @param opposition  `none`: this sum detects it.
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known,
                                              const typename K::scalar& dt,
                                              Opposition opposition) const noexcept {
    return step(memory, known, dt, opposition).memory;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE auto evaluate(const Memory& memory, const K& known,
                                             const typename K::scalar& dt) const noexcept {
    return step(memory, known, dt, Opposition::none);
  }

 private:
  template <std::size_t Ix>
  using law_at = std::tuple_element_t<Ix, std::tuple<L...>>;

  /// Calls `f(index, law)` for each law.
  template <class F>
  SKINCTL_INLINE constexpr void each(F&& f) const noexcept {
    detail::each_index<terms>([&](auto i) SKINCTL_INLINE_LAMBDA { f(i, std::get<i.value>(laws_)); });
  }
  template <class First, class Rest>
  struct Chain {
    First first;
    Rest rest;
  };
  /// The quantities that torque and memory of the laws from the `Ix`-th on share, each built in place.
  template <std::size_t Ix, class K>
  [[nodiscard]] SKINCTL_INLINE auto now_from(const Memory& memory, const K& known) const noexcept {
    if constexpr (Ix == terms) {
      return detail::Memories<>{};
    } else {
      using Here = decltype(detail::now_of(std::get<Ix>(laws_), detail::memory_of<Ix>(memory.laws), known));
      return Chain<Here, decltype(now_from<Ix + 1>(memory, known))>{
          detail::now_of(std::get<Ix>(laws_), detail::memory_of<Ix>(memory.laws), known),
          now_from<Ix + 1>(memory, known)};
    }
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE Evaluation<K::joints, typename K::scalar, Memory, terms> step(
      const Memory& memory, const K& known, const typename K::scalar& dt, Opposition given) const noexcept {
    static_assert(!(false || ... || LawTable<L>::is_gated), "a gate opens in time: blended(sum)");
    using T = typename K::scalar;
    using Torque = JointTorque<K::joints, T>;
    const auto now = now_from<0>(memory, known);
    const auto shares = [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
      return std::array<Torque, terms>{share<Ix>(memory, known, now)...};
    }(std::index_sequence_for<L...>{});

    Torque total, skin, track;
    Status status;
    each([&](auto i, const auto& law) SKINCTL_INLINE_LAMBDA {
      constexpr std::size_t Ix = i.value;
      if constexpr (law_at<Ix>::role == LawRole::tracking && !LawTable<law_at<Ix>>::presses) {
        track += shares[Ix];
        if constexpr (watches && gravity_laws == 0)
          track -= static_cast<T>(shares_[Ix].feed_forward) * known.gravity();
      } else if constexpr (LawTable<law_at<Ix>>::answers_touch) {
        skin += shares[Ix];
      }
      total += shares[Ix];
      const auto& part = detail::memory_of<Ix>(memory.laws);
      status |= status_of(law, part);
    });

    Opposition opposition = given;
    auto watched = memory.opposition;
    if constexpr (watches) {
      const auto found = detector_.detect(memory.opposition, skin, track, torque_scale(known), dt);
      watched = found.memory;
      if (given == Opposition::none) opposition = found.opposition;
      if (opposition == Opposition::lasting) status |= Reason::opposed;
    }
    return [&]<std::size_t... Ix>(std::index_sequence<Ix...>) SKINCTL_INLINE_LAMBDA {
      using Row = detail::Row<K::joints, T>;
      const auto row = [](const Torque& torque) SKINCTL_INLINE_LAMBDA {
        return Torque(Row::of([&](auto i) SKINCTL_INLINE_LAMBDA { return torque[i.value]; }));
      };
      return Evaluation<K::joints, T, Memory, terms>{
          row(total),
          {advanced<0>(memory, known, dt, opposition, now), watched},
          {row(shares[Ix])...},
          status};
    }(std::index_sequence_for<L...>{});
  }

  /// The torque of the `Ix`-th law.
  template <std::size_t Ix, class K, class Now>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> share(
      const Memory& memory, const K& known, const Now& now) const noexcept {
    using T = typename K::scalar;
    const auto& law = std::get<Ix>(laws_);
    const auto& part = detail::memory_of<Ix>(memory.laws);
    if constexpr (law_at<Ix>::role == LawRole::tracking) {
      const LawShare<T> weight{static_cast<T>(shares_[Ix].feedback),
                               static_cast<T>(shares_[Ix].feed_forward)};
      return detail::torque_with<gravity_term>(law, part, known, weight, detail::memory_of<Ix>(now));
    } else if constexpr (law_at<Ix>::role == LawRole::reactive) {
      return static_cast<T>(weights_[Ix]) * torque_of(law, part, known);
    } else {
      return torque_of(law, part, known);
    }
  }

  /// The memories after `dt` seconds, from the `Ix`-th law on.
  template <std::size_t Ix, class K, class Now>
  [[nodiscard]] SKINCTL_INLINE auto advanced(const Memory& memory, const K& known,
                                             const typename K::scalar& dt, Opposition opposition,
                                             const Now& now) const noexcept {
    if constexpr (Ix == terms) {
      return detail::Memories<>{};
    } else {
      return detail::MemoriesFrom<Ix, typename L::Memory...>{
          detail::advance_with(std::get<Ix>(laws_), detail::memory_of<Ix>(memory.laws), known, dt, opposition,
                               detail::memory_of<Ix>(now)),
          advanced<Ix + 1>(memory, known, dt, opposition, now)};
    }
  }
  std::tuple<L...> laws_;
  std::array<double, terms> weights_;
  std::array<LawShare<double>, terms> shares_{};
  OppositionDetector detector_;
};
SKINCTL_END_NAMESPACE
