// SPDX-License-Identifier: BSD-3-Clause
// Task priority: a second law moves the robot only in the null space of the first law's link.
#pragma once

#include "skinctl/core/contract.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/fusion/fused.hpp"
#include "skinctl/math/ldlt.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The part of a link's motion that belongs to the first law.
enum class Keeps : unsigned char { point, pose };

/// Damping of the null space near singularities.
struct NullSpaceSettings {
  Keeps keeps = Keeps::pose;  ///< motion of the first law: link's origin alone, or orientation as well
  /// The largest inertia that the task defends at a singularity [kg], [kg m^2].
  double heaviest = 1000;
  /// Damping sets in where the task's largest inertia, `trace((J M^-1 J')^-1)`, exceeds `heaviest / zone`.
  double zone = 10;
};

/// `tau = tau_1 + N' tau_2` with `N' = 1 - J' Lambda J M^-1`, `Lambda = (J M^-1 J' + l)^-1` (Khatib): the
/// second law's torque without the part that would accelerate the link. J is the Jacobian of link `Link`, or
/// of its origin.
///
/// - Dynamically consistent: with l = 0 the second law does not accelerate the task at all.
/// - Next to a singularity of J, where the task's inertia grows without bound, l grows smoothly; there the
///   task gives way to the second law along the direction in which it can hardly move.
/// - Both laws get the same share; gravity is compensated by the first law, or by the sum's gravity law,
///   never by the second.
/// - `Keeps::pose` needs a robot of six joints or more; with six of them the null space is empty except next
///   to a singularity, and `Keeps::point` leaves three dimensions.
template <std::size_t Link_, LawMembers First, LawMembers Second>
class NullSpace : public Composable,
                  public detail::GoalOf<std::tuple<>, First, Second>,
                  public detail::SeeingLaws<NullSpace<Link_, First, Second>, First, Second> {
 public:
  using Laws = std::tuple<First, Second>;
  static constexpr std::size_t joints = detail::joints_of_laws<First, Second>();
  static_assert(First::role == LawRole::tracking && Second::role != LawRole::gravity);
  static constexpr LawRole role = LawRole::tracking;
  static constexpr bool compensates_friction =
      LawTable<First>::compensates_friction || LawTable<Second>::compensates_friction;
  static constexpr bool presses = LawTable<First>::presses || LawTable<Second>::presses;
  static constexpr bool starts_blank = LawTable<First>::starts_blank && LawTable<Second>::starts_blank;
  static_assert(!LawTable<First>::is_gated && !LawTable<Second>::is_gated,
                "task_priority: a gate opens in time, in blended(sum): put it around the whole");
  static constexpr Needs needs =
      First::needs | Second::needs |
      Needs{.jacobians = link_bit<Link_>, .gravity = LawTable<First>::lacks_gravity, .mass_factors = true};
  struct Memory {
    [[no_unique_address]] typename First::Memory first;
    [[no_unique_address]] typename Second::Memory second;
  };

  /// Throws `ConfigurationError` unless `heaviest > 0` and `zone > 0`.
  NullSpace(const First& first, const Second& second, const NullSpaceSettings& settings = {})
      : first_(first), second_(second), p_(settings) {
    require(p_.heaviest > 0 && p_.heaviest <= 1e9, "heaviest", p_.heaviest, "> 0 kg");
    require(p_.zone > 0 && p_.zone <= 1e9, "zone", p_.zone, "> 0");
  }
  [[nodiscard]] const First& first() const noexcept { return first_; }
  [[nodiscard]] const Second& second() const noexcept { return second_; }
  [[nodiscard]] std::tuple<const First&, const Second&> laws() const noexcept { return {first_, second_}; }
  /// Calls `f(law, its memory)` for each law.
  template <class Memory, class F>
  SKINCTL_INLINE void each_law(Memory& memory, F&& f) const noexcept {
    f(first_, memory.first);
    f(second_, memory.second);
  }
  /// Throws `ConfigurationError` where a law's settings are not those of the robot.
  template <class Terms>
  void check_for(const Terms& robot) const {
    LawTable<First>::check_for(first_, robot);
    LawTable<Second>::check_for(second_, robot);
  }

  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    return {first_.start(known), second_.start(known)};
  }
  template <class K, class G>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known, const G& goal) const noexcept {
    Received<Memory> out{memory, {}};
    if constexpr (detail::Receives<First, K, G>) {
      const auto answer = follow_or_receive(first_, memory.first, known, goal);
      out.memory.first = answer.memory;
      out.status = answer.status;
    } else {
      const auto answer = follow_or_receive(second_, memory.second, known, goal);
      out.memory.second = answer.memory;
      out.status = answer.status;
    }
    return out;
  }

  /// The distance from a goal, of the law that takes such a goal.
  template <class K, class G>
    requires(detail::HasDistance<First, K, G> || detail::HasDistance<Second, K, G>)
  [[nodiscard]] auto distance(const K& known, const G& goal) const noexcept {
    if constexpr (detail::HasDistance<First, K, G>) {
      return first_.distance(known, goal);
    } else {
      return second_.distance(known, goal);
    }
  }

  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<K::joints, typename K::scalar> torque(
      const Memory& memory, const K& known, const LawShare<typename K::scalar>& share = {}) const noexcept {
    using T = typename K::scalar;
    const auto behind = [&]() SKINCTL_INLINE_LAMBDA {
      if constexpr (Second::role == LawRole::tracking) {
        return detail::weighted_torque<GravityTerm::left_out>(second_, memory.second, known, share);
      } else {
        return share.feedback * torque_of(second_, memory.second, known);
      }
    }();
    return detail::weighted_torque<G>(first_, memory.first, known, share) + projected<T>(known, behind);
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& memory, const K& known,
                                              const typename K::scalar& dt,
                                              Opposition opposition) const noexcept {
    return {first_.advance(memory.first, known, dt, opposition),
            second_.advance(memory.second, known, dt, opposition)};
  }
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known,
                             const typename K::scalar& still) const noexcept {
    return skinctl::settled(first_, memory.first, known, still) &&
           skinctl::settled(second_, memory.second, known, still);
  }
  [[nodiscard]] Status status(const Memory& memory) const noexcept {
    return status_of(first_, memory.first) | status_of(second_, memory.second);
  }

  /// `N' tau`: the torque `tau` without the part that would accelerate the link.
  template <class T, class K>
  [[nodiscard]] SKINCTL_NOINLINE JointTorque<K::joints, T> projected(
      const K& known, const JointTorque<K::joints, T>& tau) const noexcept;

 private:
  /// The damping l: 0 up to the inertia `heaviest / zone` of the task, and `1 / heaviest` at the singularity.
  template <class T>
  [[nodiscard]] T softness(const math::Ldlt<6, T>& mobility, std::size_t rows) const noexcept {
    const T heaviest = static_cast<T>(p_.heaviest);
    if (!mobility.positive_definite()) return T(1) / heaviest;
    T inertia(0);
    for (std::size_t r = 0; r < rows; ++r) {
      T unit[6] = {};
      unit[r] = T(1);
      mobility.solve(unit, unit);
      inertia = inertia + unit[r];
    }
    const T ratio = heaviest / (static_cast<T>(p_.zone) * inertia);
    const T rest = T(1) - ratio * ratio;
    return rest > T(0) ? T(rest * rest / heaviest) : T(0);
  }

  First first_;
  Second second_;
  NullSpaceSettings p_;
};

/// `second` in the null space of link `Link`, which `first` moves.
template <std::size_t Link, detail::MeantAsLaw First, detail::MeantAsLaw Second>
  requires(detail::law_in_sum<First>::role == LawRole::tracking &&
           detail::law_in_sum<Second>::role != LawRole::gravity)
[[nodiscard]] auto task_priority(const First& first, const Second& second,
                                 const NullSpaceSettings& settings = {}) {
  static_assert(sizeof(detail::Say<detail::fault_in_sum<First>(), First>) > 0);
  static_assert(sizeof(detail::Say<detail::fault_in_sum<Second>(), Second>) > 0);
  static_assert(!detail::are_for_two_robots<First, Second>,
                "the laws of this are for robots with different numbers of joints");
  return NullSpace<Link, detail::law_in_sum<First>, detail::law_in_sum<Second>>(first, second, settings);
}
// clang-format off
template <std::size_t Link, class First, class Second>
First task_priority(const First&, const Second&, const NullSpaceSettings& = {}) = delete;  // the first law tracks, and gravity is held whole, not in a null space
// clang-format on

template <std::size_t Link, LawMembers First, LawMembers Second>
template <class T, class K>
JointTorque<K::joints, T> NullSpace<Link, First, Second>::projected(
    const K& known, const JointTorque<K::joints, T>& tau) const noexcept {
  constexpr std::size_t n = K::joints;
  const auto J = known.template jacobian<Link>();
  const std::size_t rows = p_.keeps == Keeps::point ? 3 : 6;
  // Rows of J and of J M^-1; those that are not of the task stay zero, with a pivot of one.
  JointTorque<n, T> j[6];
  JointAcceleration<n, T> jm[6];
  J.for_each([&](auto i, const auto& c) {
    const T six[6] = {c.linear.x, c.linear.y, c.linear.z, c.angular.x, c.angular.y, c.angular.z};
    for (std::size_t r = 0; r < rows; ++r) j[r][i.value] = six[r];
  });
  T a[36] = {}, right[6] = {};
  for (std::size_t r = 0; r < rows; ++r) {
    jm[r] = known.mass_factors().solve(j[r]);
    for (std::size_t s = 0; s <= r; ++s)
      for (std::size_t i = 0; i < n; ++i) a[r * 6 + s] = a[r * 6 + s] + jm[r][i] * j[s][i];
    for (std::size_t i = 0; i < n; ++i) right[r] = right[r] + jm[r][i] * tau[i];
  }
  for (std::size_t r = rows; r < 6; ++r) a[r * 6 + r] = T(1);
  const T l = softness(math::Ldlt<6, T>(a), rows);
  for (std::size_t r = 0; r < rows; ++r) a[r * 6 + r] = a[r * 6 + r] + l;
  T force[6];
  math::Ldlt<6, T>(a).solve(right, force);
  JointTorque<n, T> out = tau;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t r = 0; r < rows; ++r) out[i] = out[i] - j[r][i] * force[r];
  return out;
}

SKINCTL_END_NAMESPACE
