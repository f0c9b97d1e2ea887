// Several sources of touch in one scene: skin, wrist sensor, motors.
#pragma once

#include <span>

#include "skinctl/core/detail/unwritten.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/tactile/coverage.hpp"
#include "skinctl/tactile/detail/summand.hpp"
#include "skinctl/tactile/joint_touch.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// Whether the wrench on link `I` is known, if the touch is of that link at all.
template <class W, std::size_t I>
concept KnowsWrench = ((W::links >> I) & 1u) == 0 || requires(const W& w) { w.template wrench<I>(); };
}  // namespace detail

/// The touches of two sources: each a `LinkWrenches`, a `TouchWrenches`, a `JointTouch`, or such a sum.
template <class A, class B>
struct TouchSum {
  using model_type = typename LawTouch<A>::model_type;
  using scalar = typename LawTouch<A>::scalar;
  static constexpr LinkMask links = LawTouch<A>::links | LawTouch<B>::links;
  A first;
  B second;

  /// The wrench on link `I`: of one source, or the sum of both.
  template <std::size_t I>
    requires detail::KnowsWrench<LawTouch<A>, I> && detail::KnowsWrench<LawTouch<B>, I>
  [[nodiscard]] SKINCTL_INLINE constexpr auto wrench() const noexcept {
    static_assert((links >> I) & 1u, "no source of touch on this link: its wrench is unknown");
    if constexpr (((LawTouch<B>::links >> I) & 1u) == 0) {
      return first.template wrench<I>();
    } else if constexpr (((LawTouch<A>::links >> I) & 1u) == 0) {
      return second.template wrench<I>();
    } else {
      return first.template wrench<I>() + second.template wrench<I>();
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
[[nodiscard]] SKINCTL_INLINE constexpr auto contact_part(const TouchSum<A, B>& touch) noexcept {
  return TouchSum<LawTouch<A>, LawTouch<B>>{contact_part(touch.first), contact_part(touch.second)};
}
template <RobotModel M, class Angles, class A, class B>
[[nodiscard]] SKINCTL_INLINE constexpr JointTorque<M::joints, typename TouchSum<A, B>::scalar> skin_torque(
    const M& model, const Angles& angles, const TouchSum<A, B>& touch) noexcept {
  return skin_torque(model, angles, touch.first) + skin_torque(model, angles, touch.second);
}
/// The contacts of both, at most `M::joints` and six.
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

/// A source of touch: a skin, or a sensor that names in `Sensed` what it adds to a cycle's input.
template <class S>
concept TouchSource = requires(const S& s, const typename S::Memory& m) {
  typename S::Wrenches;
  typename S::Wrenches::scalar;
  s.wrenches(m);
};
template <class S>
concept TouchSensor = TouchSource<S> && requires { typename S::Sensed; };

namespace detail {
template <class S>
struct SensedOf {
  struct type {};
};
template <class S>
  requires requires { typename S::Sensed; }
struct SensedOf<S> {
  using type = typename S::Sensed;
};
/// The inputs of two sources, each with its own members.
template <class A, class B>
struct BothSensed : A, B {};
template <class A, class B>
struct SensedByBoth {
  using type = BothSensed<typename A::Sensed, typename B::Sensed>;
};
template <class A, class B>
  requires(!TouchSensor<A>)
struct SensedByBoth<A, B> {
  using type = typename B::Sensed;
};

/// Forces and proximities of the first source apart, where it tells them.
template <class A, class B>
struct ApartOfSum {};
template <class A, class B>
  requires requires { typename A::Touch; }
struct ApartOfSum<A, B> {
  using Touch = TouchSum<typename A::Touch, typename B::Wrenches>;
};
}  // namespace detail

/// Two sources of touch as one: `skin + wrist_sensor<5>(model, {...})`. Each receives its own samples; laws see
/// the sum of their torques. The second is a sensor; where it feels all contacts of the robot (`MotorTouch`),
/// it counts only beyond what the first one feels.
template <TouchSource A, TouchSensor B>
class TouchSources : public detail::ApartOfSum<A, B>, public sensor_sums::Summand {
 public:
  static_assert(std::is_same_v<typename A::Wrenches::scalar, typename B::Wrenches::scalar>,
                "two sources of touch in different scalars");
  static_assert(!std::is_base_of_v<typename B::Sensed, typename detail::SensedOf<A>::type>,
                "two sensors of one kind: a scene has one of each");
  using scalar = typename A::Wrenches::scalar;
  using Wrenches = TouchSum<typename A::Wrenches, typename B::Wrenches>;
  using Sensed = typename detail::SensedByBoth<A, B>::type;
  static constexpr LinkMask links = Wrenches::links;
  static constexpr std::size_t most_parts = 16;  ///< of an interval
  struct Memory {
    typename A::Memory first;
    typename B::Memory second;
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  TouchSources(const A& a, const B& b) : a_(a), b_(b) {}
  [[nodiscard]] const A& first() const noexcept { return a_; }
  [[nodiscard]] const B& second() const noexcept { return b_; }

  [[nodiscard]] Memory start(Nanoseconds now) const noexcept { return {a_.start(now), b_.start(now)}; }

  /// See `Skin::receive` and that of the sensor.
  template <class State, class Means>
  Status receive(Memory& memory, std::span<const CellSample> samples, const Sensed& sensed,
                 const State& measured, Nanoseconds from, Nanoseconds to, std::size_t parts,
                 Means* means) const noexcept {
    SKINCTL_EXPECTS(parts <= most_parts, "at most 16 parts of an interval");
    using First = std::remove_cvref_t<decltype(means->first)>;
    detail::Unwritten<First, most_parts> first;
    detail::Unwritten<typename B::Wrenches, most_parts> second;
    Status status;
    if constexpr (TouchSensor<A>) {
      status = a_.receive(memory.first, samples, sensed, measured, from, to, parts, first.data);
    } else {
      status = a_.receive(memory.first, samples, from, to, parts, first.data);
    }
    status |= b_.receive(memory.second, {}, sensed, measured, from, to, parts, second.data);
    for (std::size_t j = 0; j < parts; ++j) {
      means[j].first = first.data[j];
      if constexpr (requires { b_.beyond(second.data[j], measured.q, contact_part(first.data[j])); }) {
        means[j].second = b_.beyond(second.data[j], measured.q, contact_part(first.data[j]));
      } else {
        means[j].second = second.data[j];
      }
    }
    return status;
  }

  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept {
    return {a_.wrenches(memory.first), b_.wrenches(memory.second)};
  }
  /// The same, forces and proximities apart.
  [[nodiscard]] auto touch(const Memory& memory) const noexcept
    requires requires { typename A::Touch; }
  {
    return TouchSum<typename A::Touch, typename B::Wrenches>{a_.touch(memory.first),
                                                             b_.wrenches(memory.second)};
  }
  /// The areas where the first source is pressed, beside the second one's part of `touch`.
  template <class Touch>
  [[nodiscard]] auto pressed(const Memory& memory, const Touch& touch) const noexcept
    requires requires(const A& a) { a.pressed(memory.first, touch.first); }
  {
    using First = std::remove_cvref_t<decltype(a_.pressed(memory.first, touch.first))>;
    using Second = std::remove_cvref_t<decltype(touch.second)>;
    return TouchSum<First, Second>{a_.pressed(memory.first, touch.first), touch.second};
  }
  /// See `Skin::each_cell`; of the first source.
  template <class F>
  void each_cell(F&& f, std::size_t most) const
    requires requires(const A& a) { a.each_cell(f, most); }
  {
    a_.each_cell(std::forward<F>(f), most);
  }
  /// See `WristSensor::each_point`; of both.
  template <class F>
  void each_point(F&& f) const
    requires(
        requires(const A& a) { a.each_point(f); } || requires(const B& b) { b.each_point(f); })
  {
    if constexpr (requires { a_.each_point(f); }) a_.each_point(f);
    if constexpr (requires { b_.each_point(f); }) b_.each_point(f);
  }
  /// See `MotorTouch::gain_everywhere`; of the one that has it.
  [[nodiscard]] double gain_everywhere() const noexcept
    requires(
        requires(const A& a) { a.gain_everywhere(); } || requires(const B& b) { b.gain_everywhere(); })
  {
    if constexpr (requires { b_.gain_everywhere(); }) {
      return b_.gain_everywhere();
    } else {
      return a_.gain_everywhere();
    }
  }
  /// See `Skin::usable` and `Skin::coverage`; of the first source: a sensor has no cells.
  [[nodiscard]] std::size_t usable(const Memory& memory) const noexcept
    requires detail::CountsCells<A>
  {
    return a_.usable(memory.first);
  }
  [[nodiscard]] Coverage coverage(const Memory& memory) const noexcept
    requires detail::CountsCells<A>
  {
    return detail::coverage_of(a_, memory.first);
  }
  /// See `Skin::nearest`; a sensor sees nothing, so somebody may be at any distance.
  template <std::size_t I>
  [[nodiscard]] scalar nearest(const Memory& memory) const noexcept {
    if constexpr ((A::Wrenches::links >> I) & 1u) {
      return a_.template nearest<I>(memory.first);
    } else {
      return scalar(1);
    }
  }
  /// Whether another one's memory is understood: see `Skin::same_cells`.
  [[nodiscard]] bool same_cells(const TouchSources& other) const noexcept {
    if constexpr (requires { a_.same_cells(other.a_); }) {
      return a_.same_cells(other.a_);
    } else {
      return true;
    }
  }

 private:
  A a_;
  B b_;
};

namespace sensor_sums {
/// A skin and a sensor, or two sensors, as the touch of one scene.
template <TouchSource A, TouchSensor B>
[[nodiscard]] TouchSources<A, B> operator+(const A& a, const B& b) {
  return {a, b};
}
// clang-format off
template <TouchSource A, TouchSource B>
  requires(!TouchSensor<B>)
void operator+(const A&, const B&) = delete;  // a scene has one skin, and it stands first: skin + sensor
// clang-format on
}  // namespace sensor_sums

SKINCTL_END_NAMESPACE
