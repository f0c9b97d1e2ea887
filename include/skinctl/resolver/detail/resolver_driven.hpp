// SPDX-License-Identifier: BSD-3-Clause
// The joints by torque of a resolver: the law at the newest measurement, friction, tank.
#pragma once

#include "skinctl/resolver/detail/resolver_drive.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The part of a `Resolver` that takes measurements, and moves the joints by torque.
template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class PassivityParts,
          class Tool>
class ResolverDriven : public ResolverDrive<M, T, Sets, Integrator, History, PassivityParts, Tool> {
  using Base = ResolverDrive<M, T, Sets, Integrator, History, PassivityParts, Tool>;

 public:
  using Base::each;
  using Base::has_driven;
  using Base::has_tank;
  using Base::has_virtual;
  using Base::joints;
  using Base::one_group;
  using Driven = typename Base::Driven;
  using Memory = typename Base::Memory;
  template <std::size_t K>
  using Part = typename Base::template Part<K>;
  template <class L, class Touch = NoTouch>
  using Knows = typename Base::template Knows<L, Touch>;

  /// Whether the coming cycle evaluates the law for joints by torque: no stop, no stale state.
  template <class Check>
  [[nodiscard]] bool asks_law(const Memory& m, const State<joints, T>& measured, Nanoseconds now,
                              const Check& check) const noexcept {
    if constexpr (!has_driven) return true;
    State<joints, T> state = m.measured();
    static_cast<void>(take_measurement(state, measured, now, check));
    return m.started && !m.stop && now - state.time <= stale_after_;
  }

 protected:
  using Base::Base;
  using Base::limits_;
  using Base::model_;
  using Base::passivity_;
  using Base::stale_after_;
  using Base::virtual_;
  using Acceleration = typename Base::Acceleration;
  using Torque = typename Base::Torque;
  using DrivenTorque = typename Base::DrivenTorque;

  /// The results of a cycle's measurement.
  template <class Groups>
  struct Begun {
    Groups groups;                         ///< results of each stiff group
    Acceleration swing{};                  ///< measured accelerations of joints by torque [rad/s^2]
    JointPosition<joints, T> displaced{};  ///< measured motion since the last cycle [rad]
    Status status{};
    bool stale = false;  ///< the last good measurement is too old
    bool held = false;   ///< a joint has been held fast for long
  };
  struct NoLoad {};
  /// The torques that act on the joints by torque, and those that they are sent.
  struct DrivenLoad {
    Torque gravity;        ///< torque that holds the weight [N m]
    Torque port;           ///< torque of the contacts [N m]
    DrivenTorque resists;  ///< friction that is added [N m]
    DrivenTorque brakes;   ///< torque that brakes and holds where no law is asked, friction included [N m]
    DrivenTorque passive;  ///< torque for which a tank does not pay [N m]
    DrivenTorque given;    ///< torque that is sent [N m]
    /// Torque that the motion of the base adds; in `gravity`, too [N m].
    [[no_unique_address]] std::conditional_t<base_moves<M>, DrivenTorque, NoLoad> base;
  };

  /// Takes the measurement of a cycle.
  ///
  /// @param pushed  joint torque of the contacts felt [N m].
  template <class Check>
  [[nodiscard]] SKINCTL_INLINE auto begin(Memory& m, const State<joints, T>& measured,
                                          const Interval& interval, const Check& check,
                                          [[maybe_unused]] const T& dt, const Torque& pushed) const noexcept {
    if constexpr (one_group) {
      Begun<std::tuple<typename std::tuple_element_t<0, decltype(virtual_)>::Begun>> out{
          {std::get<0>(virtual_).begin(m.group(), measured, interval, check, pushed)}};
      out.status = std::get<0>(out.groups).status;
      out.held = std::get<0>(out.groups).held;
      return out;
    } else {
      const State<joints, T> before = m.whole.measured;
      const Status taken = take_measurement(m.whole.measured, measured, interval.to, check);
      auto groups = [&]<std::size_t... K>(std::index_sequence<K...>) {
        return std::tuple{std::get<K>(virtual_).begin(m.template group<K>(),
                                                      part_of<Part<K>>(m.whole.measured), interval,
                                                      AnyState{}, Part<K>::of(pushed))...};
      }(std::make_index_sequence<Base::stiff_groups>{});
      Begun<decltype(groups)> out{groups};
      out.status = taken;
      each([&](auto k) {
        out.status |= std::get<k.value>(out.groups).status;
        out.held = out.held || std::get<k.value>(out.groups).held;
      });
      if (has_driven && interval.to - m.whole.measured.time > stale_after_) out.status |= Reason::state_stale;
      out.stale = out.status.has(Reason::state_stale);
      for (const std::size_t i : Driven::index) out.swing[i] = (m.whole.measured.dq[i] - before.dq[i]) / dt;
      out.displaced = m.whole.measured.q - before.q;
      return out;
    }
  }

  /// Computes the torques that act on joints by torque; books the work of the last `dt` seconds in the tank.
  template <class Began, class Touch>
  [[nodiscard]] SKINCTL_INLINE auto load_of(Memory& m, const Began& begun, const Touch& touch,
                                            [[maybe_unused]] const T& dt) const noexcept {
    if constexpr (!has_driven) {
      return NoLoad{};
    } else {
      DrivenLoad load;
      const State<joints, T>& now = m.measured();
      load.gravity = gravity_torque(model_, now.q);
      if constexpr (base_moves<M>) {
        load.base =
            Driven::of(this->torque_of_base(m, begun.stale ? State<joints, T>{now.time, now.q, {}} : now));
        Driven::put(Driven::of(load.gravity) + load.base, load.gravity);
      }
      m.driven.stopped = m.stop ? m.driven.stopped + dt : T(0);
      // An old velocity is no basis for braking, and an old position none for holding.
      if (!begun.stale) {
        const auto resistance = this->resistance(now, m.stop ? &m.driven : nullptr);
        load.resists = resistance.friction, load.brakes = resistance.brakes;
      }
      if constexpr (has_tank) {
        // The stiff joints draw from the same tank afterwards.
        const auto& tank = passivity_.template get<EnergyTank<T>>();
        auto& shared = m.passivity.template of<EnergyTank<T>>().energy;
        load.port = skin_torque(model_, JointAngles<M, T>(model_, now.q), contact_part(touch));
        m.driven.tank.energy = shared;
        tank.book(m.driven.tank, Driven::of(begun.displaced), Driven::of(load.port), Driven::of(load.gravity),
                  dt, seconds<T>(this->driven_delay() + this->driven_lag()));
        shared = m.driven.tank.energy;
        load.passive = tank.settings().port_gain * Driven::of(load.port) + Driven::of(load.gravity) -
                       (m.stop ? load.brakes : load.resists);
      }
      return load;
    }
  }

  /// Resumes a law that the robot follows again after a stop, stale states or a brake of the guard: others
  /// moved the robot since then.
  template <class L, class Touch>
  SKINCTL_INLINE void resume_law(Memory& m, const L& law, typename L::Memory& law_memory, const Touch& touch,
                                 bool stale) const noexcept {
    const bool follows = has_virtual ? this->following(m) : !m.stop && !stale;
    if (m.left && follows) [[unlikely]] {
      const T period = seconds<T>(this->period());
      const State<joints, T> now = this->state(m);
      law_memory = resumed(law, law_memory, this->template known<L>(now, period, touch));
    }
    m.left = !follows;
  }

  /// Evaluates the law at `now` for `load.given`, the torque of joints by torque, which stays if the law's is
  /// not finite. Where all joints take torques, the law's memory advances by `dt`.
  template <class L, class Touch, class Load, class Out>
  SKINCTL_NOINLINE void ask(Memory& m, const L& law, typename L::Memory& law_memory,
                            const State<joints, T>& now, const Touch& total, const T& dt, Load& load,
                            Out& out) const noexcept {
    const T period = seconds<T>(this->period());
    const Knows<L, Touch> known = this->template known<L>(has_virtual ? now : m.measured(), period, total);
    const auto evaluation = evaluate(law, law_memory, known, has_virtual ? period : dt);
    if (!has_virtual) out.status |= evaluation.status;
    if (!is_finite(evaluation.torque)) [[unlikely]] {
      out.status |= Reason::torque_not_finite;
      return;
    }
    if constexpr (!has_virtual) {
      law_memory = evaluation.memory;
      out.shares = evaluation.shares;
    }
    load.given = Driven::of(evaluation.torque);
    const DrivenTorque step = T(this->driven_torque_rate_ * dt) * Driven::of(limits_.torque());
    const auto cut = [&](DrivenTorque& torque) SKINCTL_INLINE_LAMBDA {
      Torque whole;
      Driven::put(torque, whole);
      const DrivenTorque within = Driven::of(limits_.within(whole, known.dq()));
      const bool acts = !(within == torque);
      torque = within;
      return acts;
    };
    if (m.driven.own.template bound<L, Driven>(evaluation.shares, step, cut, load.given)) [[unlikely]]
      out.status |= Reason::torque_limited;
    load.given -= load.resists;
    if constexpr (base_moves<M>) load.given += load.base;
    if constexpr (has_tank) out.status |= this->pay(m, load.passive, Driven::of(load.gravity), load.given);
  }
  /// Puts `load.given`, cut to the limits of the joints by torque, into `torque`.
  template <class Out>
  SKINCTL_INLINE void give(Memory& m, const DrivenLoad& load, Torque& torque, Out& out) const noexcept {
    const State<joints, T>& now = m.measured();
    Driven::put(load.given, torque);
    const Torque given = limits_.within(torque, now.dq);
    if (!(Driven::of(given) == load.given)) out.status |= Reason::torque_limited;
    m.driven.torque = Driven::of(given);
    Driven::put(m.driven.torque, torque);
    for (const std::size_t i : Driven::index)
      if (!(now.q[i] >= limits_.lower()[i] && now.q[i] <= limits_.upper()[i]))
        out.status |= Reason::outside_limits;
    if constexpr (has_tank)
      passivity_.template get<EnergyTank<T>>().sent(m.driven.tank, m.driven.torque, load.passive,
                                                    Driven::of(load.port), Driven::of(load.gravity));
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
