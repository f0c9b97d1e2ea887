// SPDX-License-Identifier: BSD-3-Clause
// Several sources of touch in one scene: skin, wrist sensor, motors.
#pragma once

#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/tactile/detail/both_contacts.hpp"
#include "skinctl/tactile/force_lead.hpp"
#include "skinctl/tactile/joint_touch.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The touches of two sources: each a `LinkWrenches`, a `TouchWrenches`, a `JointTouch`, or such a sum.
template <class A, class B>
struct TouchSum {
  using model_type = typename LawTouch<A>::model_type;
  using scalar = typename LawTouch<A>::scalar;
  static constexpr LinkMask links = LawTouch<A>::links | LawTouch<B>::links;
  A first;
  B second;

  /// The wrench on link `Ix`: of one source, or the sum of both.
  template <std::size_t Ix>
    requires detail::KnowsWrench<LawTouch<A>, Ix> && detail::KnowsWrench<LawTouch<B>, Ix>
  [[nodiscard]] SKINCTL_INLINE constexpr auto wrench() const noexcept {
    static_assert((links >> Ix) & 1u, "no source of touch on this link: its wrench is unknown");
    if constexpr (((LawTouch<B>::links >> Ix) & 1u) == 0) {
      return first.template wrench<Ix>();
    } else if constexpr (((LawTouch<A>::links >> Ix) & 1u) == 0) {
      return second.template wrench<Ix>();
    } else {
      return first.template wrench<Ix>() + second.template wrench<Ix>();
    }
  }
  friend SKINCTL_INLINE constexpr bool operator==(const TouchSum& a, const TouchSum& b) noexcept {
    return a.first == b.first && a.second == b.second;
  }
};

template <class A, class B>
[[nodiscard]] SKINCTL_INLINE constexpr auto total_of(const TouchSum<A, B>& touch) noexcept {
  return TouchSum<LawTouch<A>, LawTouch<B>>{total_of(touch.first), total_of(touch.second)};
}
template <class A, class B>
[[nodiscard]] SKINCTL_INLINE constexpr TouchSum<A, B> led_by(const TouchSum<A, B>& touch,
                                                             const typename TouchSum<A, B>::scalar& share,
                                                             const TouchSum<A, B>& change) noexcept {
  return {led_by(touch.first, share, change.first), led_by(touch.second, share, change.second)};
}
template <class A, class B>
[[nodiscard]] SKINCTL_INLINE constexpr auto contact_part(const TouchSum<A, B>& touch) noexcept {
  return TouchSum<LawTouch<A>, LawTouch<B>>{contact_part(touch.first), contact_part(touch.second)};
}
template <RobotModel M, class Angles, class A, class B>
[[nodiscard]] SKINCTL_INLINE constexpr JointTorque<M::joints, typename TouchSum<A, B>::scalar> skin_torque(
    const M& model, const Angles& angles, const TouchSum<A, B>& touch) noexcept {
  return skin_torque(model, angles, touch.first) + skin_torque(model, angles, touch.second);
}
/// The contacts of both sources, those of the second first, at most `M::joints + 6`.
template <RobotModel M, Real T, class A, class B>
[[nodiscard]] auto contacts_of(const M& model, const JointPosition<M::joints, T>& q,
                               const TouchSum<A, B>& touch) noexcept {
  const auto second = contacts_of(model, q, touch.second);
  const auto first = contacts_of(model, q, touch.first);
  constexpr std::size_t most = M::joints + 6;
  constexpr std::size_t both = std::extent_v<decltype(first.list)> + std::extent_v<decltype(second.list)>;
  constexpr std::size_t room = both < most ? both : most;
  Contacts<M::joints, T, room> out;
  for (const auto& c : second)
    if (out.count < room) out.list[out.count++] = c;
  for (const auto& c : first)
    if (out.count < room) out.list[out.count++] = c;
  return out;
}

namespace detail {
template <class A, class B>
concept EitherApart = TouchTable<A>::tells_apart || TouchTable<B>::tells_apart;
template <class A, class B>
concept EitherSensed = HasSensed<A> || HasSensed<B>;
template <class A, class B>
concept EitherFound = TouchTable<A>::finds_contacts || TouchTable<B>::finds_contacts;

// The types that a sum has only where one of both has them.
template <class A, class B>
struct ApartOfSum {};
template <class A, class B>
  requires EitherApart<A, B>
struct ApartOfSum<A, B> {
  using Touch = TouchSum<typename TouchTable<A>::Touch, typename TouchTable<B>::Touch>;
};
template <class A, class B>
struct SensedOfSum {};
template <class A, class B>
  requires EitherSensed<A, B>
struct SensedOfSum<A, B> {
  using Sensed = SensedTogether<typename TouchTable<A>::Sensed, typename TouchTable<B>::Sensed>;
};
template <class A, class B>
struct FoundOfSum {};
template <class A, class B>
  requires EitherFound<A, B>
struct FoundOfSum<A, B> {
  using Found = typename std::conditional_t<TouchTable<A>::finds_contacts, A, B>::Found;
};
/// Whether two touches add different members to the input.
template <class A, class B>
inline constexpr bool sense_apart =
    std::is_empty_v<typename TouchTable<B>::Sensed> ||
    !std::is_base_of_v<typename TouchTable<B>::Sensed, typename TouchTable<A>::Sensed>;
}  // namespace detail

/// Two sources of touch as one: `skin + wrist_sensor<5>(model, {...})`, `arm_skin + hand_skin`. Each receives
/// its own samples; laws see the sum of their torques. Where the second feels all contacts of the robot
/// (`MotorTouch`), it counts only beyond what the first one feels. The rules of its members: see
/// `TouchSource`.
template <TouchSource A, TouchSource B>
class TouchSources : public detail::ApartOfSum<A, B>,
                     public detail::SensedOfSum<A, B>,
                     public detail::FoundOfSum<A, B>,
                     public detail::TakesTouch<TouchSources<A, B>>,
                     public sensor_sums::Summand {
  using First = TouchTable<A>;
  using Second = TouchTable<B>;
  static constexpr bool has_cells = First::has_cells || Second::has_cells;

 public:
  static_assert(std::is_same_v<typename A::Wrenches::scalar, typename B::Wrenches::scalar>,
                "two sources of touch in different scalars");
  static_assert(detail::sense_apart<A, B>, "two sensors of one kind: a scene has one of each");
  using FirstTouch = A;
  using SecondTouch = B;
  using scalar = typename A::Wrenches::scalar;
  using Wrenches = TouchSum<typename A::Wrenches, typename B::Wrenches>;
  static constexpr LinkMask links = Wrenches::links;
  static constexpr std::size_t max_parts = 16;  ///< maximum number of parts of an interval
  struct Memory {
    typename A::Memory first;
    typename B::Memory second;
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  /// Throws `ConfigurationError` for a cell's id that both have.
  SKINCTL_COLD TouchSources(const A& a, const B& b) : a_(a), b_(b) {
    if constexpr (First::has_cells && Second::has_cells)
      for (std::uint32_t id = 0; id < std::uint32_t(1) << 20; ++id)
        require(a_.index(id) == a_.size() || b_.index(id) == b_.size(), "sum of two skins: cell id",
                double(id), "in one of both");
  }
  [[nodiscard]] const A& first() const noexcept { return a_; }
  [[nodiscard]] const B& second() const noexcept { return b_; }

  [[nodiscard]] Memory start(Nanoseconds now) const noexcept { return {a_.start(now), b_.start(now)}; }

  template <class M, class State>
  SKINCTL_INLINE void follow_robot(Memory& memory, const M& model, const State& state) const noexcept {
    First::follow_robot(a_, memory.first, model, state);
    Second::follow_robot(b_, memory.second, model, state);
  }
  /// Takes the input: samples of cells go to sources that have cells; one that neither knows is reported.
  template <class Given, class Means>
  Status take(Memory& memory, const Given& in, Means* means) const noexcept {
    SKINCTL_EXPECTS(in.parts <= max_parts, "at most 16 parts of an interval");
    detail::Unwritten<std::remove_cvref_t<decltype(means->first)>, max_parts> first;
    detail::Unwritten<std::remove_cvref_t<decltype(means->second)>, max_parts> second;
    TouchGiven to_first = in, to_second = in;
    if constexpr (!First::takes_hexagons && Second::takes_hexagons) to_first.samples = {};
    if constexpr (!Second::takes_hexagons) to_second.samples = {};
    Status status = First::receive(a_, memory.first, to_first, first.data);
    status |= Second::receive(b_, memory.second, to_second, second.data);
    if constexpr (First::takes_hexagons && Second::takes_hexagons) {
      status = status.without(Reason::sample_unknown);
      for (const CellSample& s : in.samples)
        if (!has_hexagon(s.cell) && !check(s).any()) status |= Reason::sample_unknown;
    }
    for (std::size_t j = 0; j < in.parts; ++j) {
      means[j].first = first.data[j];
      means[j].second = Second::beyond(b_, second.data[j], in.measured, contact_part(first.data[j]));
    }
    return status;
  }

  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept {
    return {a_.wrenches(memory.first), b_.wrenches(memory.second)};
  }
  [[nodiscard]] auto touch(const Memory& memory) const noexcept
    requires detail::EitherApart<A, B>
  {
    return TouchSum<typename First::Touch, typename Second::Touch>{First::touch(a_, memory.first),
                                                                   Second::touch(b_, memory.second)};
  }
  template <class Touch>
  [[nodiscard]] auto pressed(const Memory& memory, const Touch& touch) const noexcept
    requires(First::template knows_pressed<decltype(touch.first)> ||
             Second::template knows_pressed<decltype(touch.second)>)
  {
    const auto both = [](const auto& a, const auto& b) {
      return TouchSum<std::remove_cvref_t<decltype(a)>, std::remove_cvref_t<decltype(b)>>{a, b};
    };
    return both(First::pressed(a_, memory.first, touch.first),
                Second::pressed(b_, memory.second, touch.second));
  }
  [[nodiscard]] auto contacts(const Memory& memory) const noexcept
    requires detail::EitherFound<A, B>
  {
    if constexpr (!Second::finds_contacts) {
      return a_.contacts(memory.first);
    } else if constexpr (!First::finds_contacts) {
      return b_.contacts(memory.second);
    } else {
      return detail::BothContacts(a_.contacts(memory.first), b_.contacts(memory.second));
    }
  }
  template <class F>
  void each_cell(F&& f, std::size_t most) const
    requires(First::has_cell_list || Second::has_cell_list)
  {
    First::each_cell(a_, f, most);
    Second::each_cell(b_, f, most);
  }
  template <class F>
  void each_point(F&& f) const
    requires(First::has_points || Second::has_points)
  {
    First::each_point(a_, f);
    Second::each_point(b_, f);
  }
  [[nodiscard]] double gain_everywhere() const noexcept
    requires(First::feels_everywhere || Second::feels_everywhere)
  {
    const double a = First::gain_everywhere(a_), b = Second::gain_everywhere(b_);
    return a > b ? a : b;
  }
  [[nodiscard]] Coverage coverage(const Memory& memory) const noexcept
    requires(First::has_coverage || Second::has_coverage)
  {
    return together(First::coverage(a_, memory.first), Second::coverage(b_, memory.second));
  }
  [[nodiscard]] double noticed(const Memory& memory, std::size_t i) const noexcept
    requires(First::has_noticed || Second::has_noticed)
  {
    const std::size_t of_first = First::size(a_);
    return i < of_first ? First::noticed(a_, memory.first, i)
                        : Second::noticed(b_, memory.second, i - of_first);
  }
  template <std::size_t Ix>
  [[nodiscard]] scalar max_proximity(const Memory& memory) const noexcept
    requires(First::template tells_max_proximity<Ix> || Second::template tells_max_proximity<Ix>)
  {
    if constexpr (!Second::template tells_max_proximity<Ix>) {
      return a_.template max_proximity<Ix>(memory.first);
    } else if constexpr (!First::template tells_max_proximity<Ix>) {
      return b_.template max_proximity<Ix>(memory.second);
    } else {
      const scalar a = a_.template max_proximity<Ix>(memory.first),
                   b = b_.template max_proximity<Ix>(memory.second);
      return a > b ? a : b;
    }
  }
  /// Number of cells.
  [[nodiscard]] std::size_t size() const noexcept
    requires has_cells
  {
    return First::size(a_) + Second::size(b_);
  }
  [[nodiscard]] std::size_t index(std::uint32_t id) const noexcept
    requires has_cells
  {
    const std::size_t i = First::index(a_, id), of_first = First::size(a_);
    return i < of_first ? i : of_first + Second::index(b_, id);
  }
  /// Whether a source takes the samples of a cycle's input, and whether it has a cell with this id.
  static constexpr bool takes_hexagons = First::takes_hexagons || Second::takes_hexagons;
  [[nodiscard]] bool has_hexagon(std::uint32_t id) const noexcept {
    return First::has_hexagon(a_, id) || Second::has_hexagon(b_, id);
  }
  [[nodiscard]] bool understands(const TouchSources& other) const noexcept {
    return First::understands(a_, other.a_) && Second::understands(b_, other.b_);
  }

 private:
  A a_;
  B b_;
};

namespace sensor_sums {
/// Skins and sensors as the touch of one scene.
template <TouchSource A, TouchSource B>
  requires(TouchTable<A>::has_cells || !TouchTable<B>::has_cells)
[[nodiscard]] TouchSources<A, B> operator+(const A& a, const B& b) {
  return {a, b};
}
// clang-format off
template <TouchSource A, TouchSource B>
  requires(!TouchTable<A>::has_cells && TouchTable<B>::has_cells)
void operator+(const A&, const B&) = delete;  // skins stand first: skin + sensor
// clang-format on
}  // namespace sensor_sums

SKINCTL_END_NAMESPACE
