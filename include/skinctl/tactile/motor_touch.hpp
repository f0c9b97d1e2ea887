// SPDX-License-Identifier: BSD-3-Clause
// Touch felt by the motors: an arm without any tactile sensor gives way.
#pragma once

#include <array>
#include <span>

#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/event_gate.hpp"
#include "skinctl/tactile/detail/base_seen.hpp"
#include "skinctl/tactile/detail/sampled_row.hpp"
#include "skinctl/tactile/detail/touch_rows.hpp"
#include "skinctl/tactile/joint_touch.hpp"
#include "skinctl/tactile/momentum_observer.hpp"
#include "skinctl/tactile/push_watch.hpp"
#include "skinctl/tactile/touch_sum.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The addition of `MotorTouch` to the input of a cycle: the motors' torque at the joints at the time of the
/// measured state [N m], `current * torque constant * gear ratio`. For a robot that finds the torque of the
/// world itself (`RobotObserver`) that torque stands here.
template <std::size_t N, Scalar T = double>
struct MotorInput {
  JointTorque<N, T> motor_torque;
};

namespace detail {
/// Torque beyond that of any joint of a robot arm [N m].
inline constexpr double no_joint_torque = 1e4;
template <std::size_t N>
[[nodiscard]] constexpr std::array<double, N> joints_of_any_robot() noexcept {
  std::array<double, N> all{};
  all.fill(no_joint_torque);
  return all;
}
}  // namespace detail

/// Observer, thresholds and times of `MotorTouch`.
template <RobotModel M, Real T = double, class Observer = MomentumObserver<M, T>>
struct MotorTouchSettings {
  typename Observer::Settings observer = {};
  /// Per joint, gate of |residual| [N m]: above the errors of friction and model. No default suits two
  /// robots.
  std::array<EventGate<T>, M::joints> gates;
  /// Per joint, torque that its motor, or a contact, never exceeds [N m], at most 1e4: a sample beyond was
  /// garbled and is refused. By default 1e4: one sample of that size moves an arm by a radian. Twice the
  /// joint's rating leaves room for peaks: a motor that is refused while somebody pushes does not give way.
  std::array<double, M::joints> max_torque = detail::joints_of_any_robot<M::joints>();
  T gain = T(1);  ///< torque that the laws see per torque found, > 0
  /// Per joint, standard deviation of the residual's mean over 8 ms [N m]: with all of them known, a residual
  /// of friction or of a wrongly declared payload does not lead the arm (`PushWatch`); 0: unknown, and
  /// nothing watches.
  std::array<double, M::joints> noise = {};
  LifeSettings life = {};       ///< life of a push, as a contact at the lever `assumed_lever`
  Nanoseconds max_age = 100ms;  ///< age of the last state from which nothing is felt
  Nanoseconds fade = 50ms;      ///< last part of `max_age`, in which the torque goes linearly to 0
};

/// The momentum observer's residual as touch, in place of a skin or beside one:
///
///     Cycle(arm, MotorTouch(model, {.gates = same_gate(model, {2.0, 1.5, 1.5})}), law)
///     Cycle(arm, skin + MotorTouch(model, {...}), law)
///
/// Laws see a joint torque, as if it were the torque of a skin; where the contact is remains unknown. For
/// limits and passivity it is one contact with an assumed lever (`assumed_lever`). Beside a skin or a wrist
/// sensor it counts only beyond what they feel: see `beyond`.
///
/// A stiff contact is felt late by the filter: `StiffestContact::skin_delay` is `1/rate` and a period here.
///
/// **Bias.** With `noise` declared a residual has to live, as a hand's does: see `WristSensor`. Below the
/// gates nothing is followed: a joint at rest hides up to its dry friction in either direction.
///
/// **Observer.** One with `joints`, `Settings`, `Memory` (`started`, `stamp`, `residual`), `model()` and
/// `observe(memory, state, torque)`: `MomentumObserver`, or `RobotObserver` for robots that observe
/// themselves.
///
/// Each state with a new stamp is a sample. Between samples the torque is linear in time, delayed by one
/// sample; without new states it fades (`sample_stale`).
template <RobotModel M, Real T = double, class Observer = MomentumObserver<M, T>>
class MotorTouch : public sensor_sums::Summand {
 public:
  static constexpr std::size_t joints = M::joints;
  using scalar = T;
  using Wrenches = JointTouch<M, T>;
  using Sensed = MotorInput<joints, T>;
  using Settings = MotorTouchSettings<M, T, Observer>;
  /// Number of sums of |residual| that are watched for life; beyond 16 joints, several joints share a sum.
  static constexpr std::size_t sizes = joints < 16 ? joints : 16;
  using Watch = PushWatch<joints, sizes>;
  static constexpr LinkMask links = 0;
  using OnBase = detail::BaseSeen<M, T>;
  struct Memory {
    typename Observer::Memory observer;
    detail::SampledRow<joints, T> row;  ///< the torque behind the gates [N m]
    typename Watch::Memory watch;       ///< watch for residuals without life
    State<joints, T> followed;          ///< robot's state when its displacement was last counted
    LinkMask open = 0;                  ///< joints whose gates are open
    [[no_unique_address]] OnBase base;  ///< motion of a base that moves
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD MotorTouch(const M& model, const Settings& settings)
      : observer_(model, settings.observer), s_(settings), watch_(s_.life, noise_of(s_.noise), {}) {
    require_masses(model, "MotorTouch");
    for (const double most : s_.max_torque)
      require(most > 0 && most <= detail::no_joint_torque, "MotorTouch: max_torque", most, "> 0, <= 1e4 N m");
    require(s_.gain > T(0) && s_.gain <= T(1000), "MotorTouch: gain", double(s_.gain), "> 0, <= 1000");
    require(s_.fade > 0ns, "MotorTouch: fade", milliseconds(s_.fade), "> 0 ms");
    require(s_.max_age >= s_.fade && s_.max_age <= 10s, "MotorTouch: max_age", milliseconds(s_.max_age),
            ">= fade, <= 10 s [ms]");
  }
  [[nodiscard]] const Observer& observer() const noexcept { return observer_; }

  [[nodiscard]] Memory start(Nanoseconds now) const noexcept {
    Memory memory;
    memory.row.begin = now;
    memory.base = OnBase::start(observer_.model());
    return memory;
  }

  /// Counts how far the arm gives way to a push; called by a scene.
  template <class Model, class State>
  void follow_robot(Memory& m, const Model& model, const State& state) const noexcept {
    m.base.take(model);
    watch_.follow_robot(m.watch, m.followed, state, [&] {
      const double force = force_of(m.row.held);
      double work = 0;
      for (std::size_t i = 0; i < joints; ++i) work += double(m.row.held[i] * (state.q[i] - m.followed.q[i]));
      return force > Watch::min_push ? work / force : 0.0;
    });
  }

  /// Takes a measured state and gives the mean torque over each of `parts` >= 1 equal parts of `(from, to]`.
  /// A repeated state is no sample; one that is not finite is refused (`sample_not_finite`), and so is one
  /// whose torque no joint has (`sample_out_of_range`).
  Status receive(Memory& memory, std::span<const CellSample> cells, const MotorInput<joints, T>& input,
                 const State<joints, T>& measured, Nanoseconds from, Nanoseconds to, std::size_t parts,
                 Wrenches* means) const noexcept {
    const auto row = [means](std::size_t j) SKINCTL_INLINE_LAMBDA -> T* { return means[j].torque.data; };
    const detail::SampledTimes times{s_.max_age, s_.fade, s_.max_age, 0ns, s_.max_age};
    detail::SampledInterval<joints, T, decltype(row)> interval(times, memory.row, from, to, parts, row);
    Status status = cells.empty() ? Status{} : Status{Reason::sample_unknown};
    State<joints, T> now = measured;
    if (now.time > to) now.time = to;
    if (memory.observer.started && memory.observer.stamp > to)
      memory.observer = {};  // the clock was set back
    if (!memory.observer.started || now.time != memory.observer.stamp) {
      const Status seen =
          can_be(input.motor_torque)
              ? observer_.observe(memory.observer, now, at_rest(memory, now, input.motor_torque))
              : Status{Reason::sample_out_of_range};
      status |= seen;
      if (!seen.any() && !interval.admits(to).any()) {
        T value[joints];
        find(memory, value);
        interval.take(to, value);
      }
    }
    if (interval.end()) status |= Reason::sample_stale;
    return status | watch_.settle(memory.watch, to);
  }

  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept {
    Wrenches out;
    for (std::size_t i = 0; i < joints; ++i) out.torque[i] = memory.row.held[i];
    return out;
  }

  /// Newtons that laws see per newton anywhere on the robot: the motors feel all links.
  [[nodiscard]] double gain_everywhere() const noexcept { return static_cast<double>(s_.gain); }

  /// The part of `found` that is not explained by the contacts that another source feels: per joint, the rest
  /// in the direction of `found`. So a push on the skin counts once, with the larger of the two torques, and
  /// what the skin overstates does not turn the residual round.
  template <class Contact>
  [[nodiscard]] Wrenches beyond(Wrenches found, const JointPosition<joints, T>& q,
                                const Contact& contact) const noexcept {
    const JointTorque<joints, T> felt = skin_torque(observer_.model(), q, contact);
    for (std::size_t i = 0; i < joints; ++i) {
      const T r = found.torque[i], rest = r - felt[i];
      if (r > T(0)) {
        found.torque[i] = felt[i] > T(0) ? (rest > T(0) ? rest : T(0)) : r;
      } else {
        found.torque[i] = felt[i] < T(0) ? (rest < T(0) ? rest : T(0)) : r;
      }
    }
    return found;
  }

 private:
  /// Whether the joints can have this torque; NaN is left to the observer, which names it.
  [[nodiscard]] bool can_be(const JointTorque<joints, T>& torque) const noexcept {
    for (std::size_t i = 0; i < joints; ++i)
      if (torque[i] > T(s_.max_torque[i]) || torque[i] < T(-s_.max_torque[i])) return false;
    return true;
  }
  /// `torque` without what the motion of the base adds.
  [[nodiscard]] JointTorque<joints, T> at_rest([[maybe_unused]] const Memory& m,
                                               [[maybe_unused]] const State<joints, T>& now,
                                               const JointTorque<joints, T>& torque) const noexcept {
    if constexpr (base_moves<M>) {
      return Observer::at_rest(torque,
                               base_torque(observer_.model().at_rest(), now.q, now.dq, m.base.motion));
    } else {
      return torque;
    }
  }
  /// Force of the contact at the lever `assumed_lever` with this joint torque [N].
  [[nodiscard]] static double force_of(const T (&torque)[joints]) noexcept {
    double square = 0;
    for (const T& x : torque) square += double(x * x);
    return std::sqrt(square) / assumed_lever<double>;
  }
  [[nodiscard]] static std::array<double, sizes> noise_of(const std::array<double, joints>& noise) noexcept {
    std::array<double, sizes> out{};
    for (std::size_t i = 0; i < joints; ++i) out[i % sizes] += noise[i];
    return out;
  }
  /// Puts the residual behind the gates, times gain and the share that counts, into `value` [N m].
  SKINCTL_INLINE void find(Memory& m, T (&value)[joints]) const noexcept {
    std::array<double, joints> rest{};
    std::array<double, sizes> size{};
    LinkMask open = 0;
    std::uint16_t pressed = 0;
    for (std::size_t i = 0; i < joints; ++i) {
      const T r = m.observer.residual[i] - T(m.watch.bias[i]);
      const T amount = r < T(0) ? T(-r) : r;
      const T passed = s_.gates[i].pass(amount, ((m.open >> i) & 1u) != 0);
      if (passed > T(0))
        open |= LinkMask(1) << i, pressed = static_cast<std::uint16_t>(pressed | 1u << i % sizes);
      value[i] = r < T(0) ? T(-passed) : passed;
      rest[i] = double(r), size[i % sizes] += double(amount);
    }
    m.open = open;
    watch_.take(m.watch, rest, size, pressed);
    const T share = s_.gain * T(watch_.share(m.watch, force_of(value)));
    for (T& x : value) x = share * x;
  }

  Observer observer_;
  Settings s_;
  Watch watch_;
};

/// `gate` for each joint of a model.
template <RobotModel M, Real T = double>
[[nodiscard]] std::array<EventGate<T>, M::joints> same_gate(const M&, const EventGate<T>& gate) {
  std::array<EventGate<T>, M::joints> all;
  all.fill(gate);
  return all;
}

SKINCTL_END_NAMESPACE
