// SPDX-License-Identifier: BSD-3-Clause
// A sub-step of the virtual robot: law, limits of torque, integrator, tank.
#pragma once

#include "skinctl/law/evaluate.hpp"
#include "skinctl/math/lu.hpp"
#include "skinctl/resolver/detail/resolver_energy.hpp"
#include "skinctl/resolver/detail/velocity_step.hpp"
#include "skinctl/tactile/touch_wrenches.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The parts of a scene's configuration that give its torque.
template <class Robot, class L, class Touch>
struct Asked {
  const Robot& robot;
  const L& law;
  const typename L::Memory& memory;
  const Touch& touch;
};

/// The input of a law in a `Resolver`, and the motion of the virtual robot under its torque.
template <RobotModel M, Real T, class Sets, class Integrator, std::size_t History, class PassivityParts,
          class Tool>
class ResolverDrive : public ResolverEnergy<M, T, Sets, Integrator, History, PassivityParts, Tool> {
  using Base = ResolverEnergy<M, T, Sets, Integrator, History, PassivityParts, Tool>;

 public:
  using Base::each;
  using Base::has_driven;
  using Base::has_tank;
  using Base::has_virtual;
  using Base::joints;
  using Driven = typename Base::Driven;
  using Stiff = typename Base::Stiff;
  using Memory = typename Base::Memory;
  static constexpr Needs passivity_needs =
      has_virtual ? Integrator::needs |
                        Needs{.angles = has_tank, .gravity = has_tank, .mass = has_tank, .touch = has_tank}
                  : Needs{.angles = has_tank, .mass = has_tank};
  using Mass = std::conditional_t<has_virtual, VirtualMass<joints, T, Tool, Stiff>, RealMass<joints, T>>;
  /// The input of a law: the state of all joints, and the quantities that law and integrator need of it.
  template <class L, class Touch = NoTouch>
  using Knows = Quantities<M, L::needs | passivity_needs, T, Touch, Mass>;

  /// The input of a law at `state`, for a torque that is held for `dt` seconds; `state` and `touch` must
  /// outlive it.
  template <class L, class Touch>
  [[nodiscard]] SKINCTL_INLINE Knows<L, Touch> known(const State<joints, T>& state, const T& dt,
                                                     const Touch& touch) const noexcept {
    if constexpr (has_virtual) {
      return Knows<L, Touch>(model_, state, dt, touch, Mass(limits_, shape_.inertia, tool_));
    } else {
      return Knows<L, Touch>(model_, state, dt, touch, Mass(limits_, shape_.inertia));
    }
  }

 protected:
  using Base::Base;
  using Base::limits_;
  using Base::model_;
  using Base::passivity_;
  using Base::shape_;
  using Base::stiff_only;
  using Base::stiff_shape_;
  using Base::tool_;
  using Base::virtual_;
  using Velocity = typename Base::Velocity;
  using Acceleration = typename Base::Acceleration;
  using Torque = typename Base::Torque;
  using StiffTorque = typename Base::StiffTorque;

  /// The law's part and the velocity after a sub-step; elements of joints by torque are zero.
  template <class L>
  struct Moved {
    /// Built in place. (GCC would first zero an aggregate, then write it.)
    template <class F>
    SKINCTL_INLINE explicit Moved(F&& law_now) : law(law_now()), status(law.status) {}

    Evaluation<joints, T, typename L::Memory, terms_of<L>> law;
    Torque torque;  ///< torque of the law, cut to the limits [N m]
    Velocity velocity;
    Status status;
  };

  /// Evaluates the law at `now`, and the virtual robot's velocity `h` seconds later. One function for the
  /// sub-steps and for a blocked robot: the law is the largest part of a cycle's code.
  /// @param total  the touch that the law gets, see `TouchChange`.
  /// @param touch  the mean touch of the sub-step, for the tank.
  template <class L, class Touch>
  SKINCTL_NOINLINE Moved<L> drive(Memory& m, const L& law, const typename L::Memory& law_memory,
                                  const State<joints, T>& now, [[maybe_unused]] const Acceleration& swing,
                                  const T& h, const LawTouch<Touch>& total,
                                  [[maybe_unused]] const Touch& touch) const noexcept {
    const Knows<L, LawTouch<Touch>> known = this->template known<L>(now, h, total);
    Moved<L> out([&]() SKINCTL_INLINE_LAMBDA { return evaluate(law, law_memory, known, h); });
    if (!is_finite(out.law.torque)) [[unlikely]] {
      out.status |= Reason::torque_not_finite;
      return out;
    }
    StiffTorque own = Stiff::of(out.law.torque);
    const StiffTorque step = T(this->torque_rate_ * h) * Stiff::of(limits_.torque());
    const Velocity v = stiff_only(now.dq);
    const auto cut = [&](StiffTorque& torque) SKINCTL_INLINE_LAMBDA {
      Torque whole;
      Stiff::put(torque, whole);
      if (limits_.within(whole, v) == whole) return false;
      torque = Stiff::of(this->limited(now, whole));
      return true;
    };
    if (m.own.template bound<L, Stiff>(out.law.shares, step, cut, own)) [[unlikely]]
      out.status |= Reason::torque_limited;
    Stiff::put(own, out.torque);
    if (!(limits_.within(out.torque, v) == out.torque)) [[unlikely]] {
      out.status |= Reason::torque_limited;
      out.torque = this->limited(now, out.torque);
    }
    const auto next = stepped(*this, m, known, out.torque, swing);
    if (next.singular) out.status |= Reason::singular;
    Stiff::put(next.velocity, out.velocity);
    if constexpr (has_tank) draw_from_tank(m, known, contact_part(touch), v, swing, out);
    return out;
  }

  /// Moves the stiff joints for `h` seconds towards the velocity `v1`. Where the leash holds joints, the
  /// others are planned anew.
  template <class Groups, class Movers>
  SKINCTL_INLINE void go(Memory& m, const Groups& groups, const T& h, const Movers& movers, Velocity v1,
                         Status& status) const noexcept {
    if constexpr (has_tank && Movers::smooth)
      if (m.passivity.template of<EnergyTank<T>>().energy < T(0)) [[unlikely]]
        v1 = in_debt(m, movers, v1, h);
    auto plans = planned(m, groups, h, movers, v1);
    std::uint64_t held = 0;
    each([&](auto k) { held |= std::get<k.value>(plans).cut | std::get<k.value>(plans).returns; });
    if (held != 0) [[unlikely]]
      plans = beside_held(m, groups, h, movers, v1, plans);
    each([&](auto k) {
      status |= std::get<k.value>(virtual_).take(m.template group<k.value>(), std::get<k.value>(groups),
                                                 std::get<k.value>(plans), h);
    });
  }

  /// The torque of the stiff joints that `next` lacks against `before`, see `Resolver::lacking`.
  template <class Asks>
  [[nodiscard]] SKINCTL_COLD StiffTorque lacking_of_stiff(const Memory& m, const Interval& interval,
                                                          const Asks& before,
                                                          const Asks& next) const noexcept {
    constexpr std::size_t n = Stiff::count;
    const T h = interval.substeps == 0 ? this->planned_step() : seconds<T>(interval.at(1) - interval.at(0));
    const State<joints, T> here = this->state(m);
    T slope[n * n], difference[n];
    const auto wanted = asked(m, here, h, before, nullptr), given = asked(m, here, h, next, slope);
    for (std::size_t j = 0; j < n; ++j) difference[j] = wanted[j] - given[j];
    StiffTorque found;
    math::Lu<n, T>(slope).solve(difference, found.data);
    return found;
  }

 private:
  template <class Groups, class Movers>
  [[nodiscard]] SKINCTL_INLINE auto planned(const Memory& m, const Groups& groups, const T& h,
                                            const Movers& movers, const Velocity& v1) const noexcept {
    return [&]<std::size_t... K>(std::index_sequence<K...>) SKINCTL_INLINE_LAMBDA {
      return std::tuple(std::get<K>(virtual_).plan(m.template group<K>(), std::get<K>(groups),
                                                   Base::template Part<K>::of(v1), h,
                                                   movers.template motion_limit_of<K>())...);
    }(std::make_index_sequence<Base::stiff_groups>{});
  }
  /// The velocity wished for while the tank is in debt. A torque that brakes is free and one that drives is
  /// not: where an acceleration ends only by its jerk, joints would turn back with the speed that braking
  /// left them, and swing on for ever.
  template <class Movers>
  [[nodiscard]] SKINCTL_COLD Velocity in_debt(const Memory& m, const Movers& movers, Velocity v1,
                                              const T& h) const noexcept {
    each([&](auto k) {
      using Set = typename Base::template Part<k.value>;
      const auto& mover = movers.template motion_limit_of<k.value>();
      if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(mover)>, Abrupt>)
        Set::put(mover.without_turning_back(m.template group<k.value>().rate, Set::of(v1), h), v1);
    });
    return v1;
  }
  /// The plans of the free joints beside those that the leash holds. A held joint takes what pushes it, as
  /// one that is held fast does: the others go on as if it stood, `M_ff (v - v1)_f = -M_fh (v - v1)_h` with
  /// friction in M, of free and held joints. Without it the virtual robot would turn about its mass, and lead
  /// the other joints away. The virtual dynamics of a tool are left out of M.
  template <class Groups, class Movers, class Plans>
  [[nodiscard]] SKINCTL_COLD Plans beside_held(const Memory& m, const Groups& groups, const T& h,
                                               const Movers& movers, Velocity v1,
                                               const Plans& plans) const noexcept {
    std::array<bool, joints> held{}, free{};
    Velocity change;  // by which the held joints miss v1
    each([&](auto k) {
      using Set = typename Base::template Part<k.value>;
      const auto& plan = std::get<k.value>(plans);
      for (std::size_t j = 0; j < Set::count; ++j) {
        const std::size_t i = Set::index[j];
        held[i] = (((plan.cut | plan.returns) >> j) & 1u) != 0;
        free[i] = !held[i];
        if (held[i]) change[i] = plan.own[j] - v1[i];
      }
    });
    const auto mass = mass_matrix(model_, this->position(m));
    T a[joints * joints] = {}, impulse[joints] = {}, moved[joints] = {};
    const T decayed = T(1) + h * shape_.damping;
    for (std::size_t i = 0; i < joints; ++i) {
      for (std::size_t j = 0; free[i] && j < joints; ++j) {
        if (free[j]) a[i * joints + j] = decayed * mass(i, j);
        if (held[j]) impulse[i] = impulse[i] - decayed * mass(i, j) * change[j];
      }
      a[i * joints + i] =
          free[i] ? T(a[i * joints + i] + decayed * shape_.inertia[i] + h * shape_.viscous[i]) : T(1);
    }
    const math::Lu<joints, T> factors(a);
    if (!factors.regular()) return plans;
    factors.solve(impulse, moved);
    for (std::size_t i = 0; i < joints; ++i)
      if (free[i]) v1[i] = v1[i] + moved[i];
    return planned(m, groups, h, movers, v1);
  }
  /// The velocity of the stiff joints after `h` seconds of the torque that `who` asks for: cut to the limits
  /// of torque if `slope` is null; otherwise not cut, and `slope[i n + j]` becomes the growth of the velocity
  /// of joint i per torque of joint j.
  template <class L, class Robot, class Touch>
  [[nodiscard]] SKINCTL_COLD JointVelocity<Stiff::count, T> asked(const Memory& m,
                                                                  const State<joints, T>& here, const T& h,
                                                                  const Asked<Robot, L, Touch>& who,
                                                                  T* slope) const noexcept {
    constexpr std::size_t n = Stiff::count;
    const Knows<L, Touch> known = who.robot.template known<L>(here, h, who.touch);
    Torque own = stiff_only(torque_of(who.law, who.memory, known));
    if (slope == nullptr && !(limits_.within(own, stiff_only(here.dq)) == own))
      own = this->limited(here, own);
    JointVelocity<n, T> first;
    for (std::size_t k = 0; k <= (slope == nullptr ? 0 : n); ++k) {  // as asked, then more at joint k - 1
      StiffTorque tau = Stiff::of(own);
      if (k > 0) tau[k - 1] += T(1);
      Torque whole;
      Stiff::put(tau, whole);
      const JointVelocity<n, T> v = stepped(who.robot, m, known, whole, {}, false).velocity;
      if (k == 0) first = v;
      for (std::size_t i = 0; i < n && k > 0; ++i) slope[i * n + k - 1] = v[i] - first[i];
    }
    return first;
  }
  /// The virtual robot's velocity after a sub-step under `tau`, with the virtual dynamics of `robot`.
  template <class Robot, class K>
  [[nodiscard]] static SKINCTL_INLINE VelocityStep<Stiff::count, T> stepped(
      const Robot& robot, const Memory& m, const K& known, const Torque& tau, const Acceleration& swing,
      bool with_coulomb = true) noexcept {
    const bool has_coulomb = with_coulomb && robot.has_coulomb_;
    if constexpr (Stiff::is_all) {
      return step_velocity<Integrator>(known, robot.stiff_shape_, has_coulomb, tau, robot.last(m),
                                       robot.tool_);
    } else {
      return step_velocity_of<Integrator, Stiff>(known, robot.stiff_shape_, has_coulomb, Stiff::of(tau),
                                                 Stiff::of(robot.last(m)), robot.tool_, &swing);
    }
  }
  /// Lets the tank pay for the law's torque beside contacts and gravity; what it cannot pay for is cut.
  template <class K, class Contact, class L>
  SKINCTL_INLINE void draw_from_tank(Memory& m, const K& known, const Contact& contact, const Velocity& v,
                                     const Acceleration& swing, Moved<L>& out) const noexcept {
    const auto& tank = passivity_.template get<EnergyTank<T>>();
    auto& memory = m.passivity.template of<EnergyTank<T>>();
    tank.charge(memory, known.mass(), v);
    const Torque port = stiff_only(skin_torque(model_, known.angles(), contact));
    const Torque passive = tank.settings().port_gain * port + stiff_only(known.gravity());
    const T share = tank.pay(memory, port, out.torque - passive, v, out.velocity, known.dt(), [&] {
      Velocity without;
      Stiff::put(stepped(*this, m, known, passive, swing).velocity, without);
      return without;
    });
    if (share < T(1)) {
      out.status |= Reason::tank_empty;
      out.torque = passive + share * (out.torque - passive);
    }
    if constexpr (has_driven) {
      // The recoil of the joints by torque is a port as a contact is.
      Torque recoil =
          coriolis_torque(model_, known.angles(), v) - coriolis_torque(model_, known.angles(), known.dq());
      for (const std::size_t i : Stiff::index)
        for (const std::size_t j : Driven::index) recoil[i] = recoil[i] - known.mass()(i, j) * swing[j];
      memory.port += stiff_only(recoil);
    }
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE
