// SPDX-License-Identifier: BSD-3-Clause
// An energy tank: it pays for every torque but that of contacts.
#pragma once

#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/passivity/affordable_share.hpp"
#include "skinctl/robot/detail/acted_torque.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/robot/virtual_dynamics.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A part of `Passivity`: an energy tank for all active torque, that is, all but that of contacts: weighted
/// laws, changes of skill and weight, bumpless transfers, the observer, errors of the integration, and pushes
/// of proximity readings: what is only seen does no work. Avoidance that must hold with an empty tank is a
/// limit of speed, which needs no tank: `LinkContact` with a separation.
///
/// The virtual robot is passive at its port: the sum of kinetic energy and tank never grows by more than the
/// work of the contacts, `port_gain tau_contact . dq^`, tau_contact the part of tau_skin by force readings
/// (see `TouchWrenches`). The law's torque beyond `port_gain tau_contact + G` is active: `tau_a . dq^` drains
/// the tank, or fills it up to `max`. Where a sub-step would cost more than the tank holds, `alpha tau_a`
/// remains (`tank_empty`): the robot yields and brakes as before, but no longer drives. Kinetic energy that
/// no work explains (`res`: a changed mass matrix, discretisation, the observer's correction) is charged at
/// the next sub-step. So is an acceleration that a limit of jerk ends later than its torque: while the tank
/// is in debt, joints are slowed no faster than they come to rest without turning back.
///
/// A torque interface has no virtual robot: the port is the real one, `Held` its memory, and work is computed
/// from the robot's displacement under the torque that acted meanwhile, sent a delay and a lag ago. What is
/// under way has to be payable as well; still, behind a delay more may act than the tank holds, as gravity is
/// compensated late: that is charged afterwards. What moves a joint further than predicted (a push, the
/// recoil of other joints, a limit that cuts the motion) makes a sub-step cost more: so every joint's largest
/// such surprise is remembered, fades over some 500 sub-steps, and a torque must be payable with twice that.
/// A thousandth of `max` is for a surprise larger than any so far, and no torque draws on it knowingly. If
/// even that leaves a debt, only what fills the tank in spite of surprises is active until it is paid back.
/// Where not all is payable, joints that the torque brakes keep it, the share is that of the others, and the
/// robot is slowed by `damping` times the share that it lacks: without friction it would swing for ever.
template <Real T = double>
class EnergyTank {
 public:
  using RobotPart = detail::PassivityPart;
  struct Settings {
    T start = T(1);      ///< initial energy [J], >= 0; 1 J brings 8 kg to 0.5 m/s
    T max = T(5);        ///< capacity [J], >= start
    T port_gain = T(1);  ///< weight of the contacts' torque in the law; what differs from it is active
    /// Damping of a robot by torque, in units of M [1/s], times the share of the active torque not paid for.
    T damping = T(2);
  };
  /// The predicted motion of the joints, and the error of the prediction.
  template <std::size_t N>
  struct Foresight {
    JointPosition<N, T> ahead;     ///< motion that the last sub-step is to make [rad]
    JointPosition<N, T> surprise;  ///< largest way of joints beyond the motion predicted, fading [rad]
    bool valid = false;            ///< `ahead` is valid
  };
  template <std::size_t N>
  struct Memory {
    T energy = T(0);           ///< energy in the tank [J]
    T kinetic = T(0);          ///< kinetic energy at the last sub-step [J]
    T explained = T(0);        ///< part of the change of kinetic energy that is work or friction [J]
    JointTorque<N, T> port;    ///< torque of the contacts in the last sub-step [N m]
    JointTorque<N, T> active;  ///< part of the active torque that was paid for [N m]
    MassMatrix<N, T> mass;     ///< mass matrix of the last sub-step [kg m^2]
    bool counts = false;       ///< whether kinetic energy, torques and mass are valid
    bool paid = false;         ///< a sub-step is to be charged
    Foresight<N> foresight;
  };
  /// The memory for a torque interface: the torque that was sent, by its parts.
  template <std::size_t N>
  struct Held {
    T energy = T(0);            ///< energy in the tank [J]
    JointTorque<N, T> passive;  ///< part of the torque without cost: port, gravity, friction [N m]
    JointTorque<N, T> port;     ///< contacts' part of the passive torque [N m]
    JointTorque<N, T> gravity;
    JointTorque<N, T> active;  ///< remainder of the torque, for which the tank pays [N m]
    bool counts = false;       ///< whether the torques are valid
    Foresight<N> foresight;
    detail::ActedTorque<N, T> passives, actives;  ///< torques of the last cycles, of which one acts now
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit EnergyTank(const Settings& s = {}) : s_(s) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(s.start >= T(0) && s.start <= T(1e6), "energy at the start", number(s.start), "0 to 1e6 J");
    require(s.max >= s.start && s.max <= T(1e6), "room of the tank", number(s.max), ">= start, <= 1e6 J");
    require(s.port_gain >= T(0) && s.port_gain <= T(1e6), "port gain", number(s.port_gain), "0 to 1e6");
    require(s.damping >= T(0) && s.damping <= T(20), "damping of an empty tank", number(s.damping),
            "0 to 20 1/s");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  template <std::size_t N>
  [[nodiscard]] Memory<N> start() const noexcept {
    Memory<N> m;
    m.energy = s_.start;
    return m;
  }

  /// Charges an unexplained gain of kinetic energy, at the beginning of a sub-step with the mass matrix `m`
  /// (virtual inertia included) and the velocity `v`.
  template <std::size_t N>
  SKINCTL_INLINE void charge(Memory<N>& memory, const MassMatrix<N, T>& m,
                             const JointVelocity<N, T>& v) const noexcept {
    T kinetic(0);
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) kinetic = kinetic + T(0.5) * v[i] * m(i, j) * v[j];
    if (memory.counts) {
      const T res = kinetic - memory.kinetic - memory.explained;
      if (res > T(0)) memory.energy = memory.energy - res;
    }
    memory.counts = true;
    memory.kinetic = kinetic;
    memory.mass = m;
  }

  /// The share of the law's active part that is paid for. `v1` is the velocity after the sub-step with all of
  /// that part, and becomes that with the share; `without()` gives the velocity v0 with none, and is called
  /// only if the tank does not hold enough. The displacement is that of the mean velocity:
  /// `w1 = h tau_a . (v + v0)/2`, `w2 = h tau_a . (v1 - v0)/2`.
  ///
  /// @param port    tau_contact, the contacts' own torque [N m].
  /// @param active  the law's torque less G(q) and less `port_gain * port`.
  template <std::size_t N, class Without>
  [[nodiscard]] SKINCTL_INLINE T pay(Memory<N>& memory, const JointTorque<N, T>& port,
                                     const JointTorque<N, T>& active, const JointVelocity<N, T>& v,
                                     JointVelocity<N, T>& v1, const T& h, Without&& without) const noexcept {
    T share(1);
    if (!is_payable(memory, active, v, v1, h)) [[unlikely]]
      share = share_of(memory, {}, active, v, without(), v1, h);
    foresee(memory.foresight, v, v1, h, h);
    memory.port = s_.port_gain * port;
    memory.active = share * active;
    memory.paid = true;
    return share;
  }

  /// Books a motion of the virtual robot by `dq` in `h` seconds: charges the work of the active torque, and
  /// notes that of port and friction as explained. Where no law drove it, the kinetic energy is computed
  /// anew.
  template <std::size_t N>
  SKINCTL_INLINE void book(Memory<N>& memory, const JointPosition<N, T>& dq,
                           const VirtualDynamics<N, T>& shape, const T& h) const noexcept {
    memory.counts = memory.counts && memory.paid;
    if (!memory.paid) return;
    memory.paid = false;
    learn(memory.foresight, memory.active, dq);
    T input(0), drawn(0), friction(0);
    for (std::size_t i = 0; i < N; ++i) {
      input = input + memory.port[i] * dq[i];
      drawn = drawn + memory.active[i] * dq[i];
      friction = friction + shape.viscous[i] * dq[i] * dq[i];
      if (shape.damping > T(0))
        for (std::size_t j = 0; j < N; ++j)
          friction = friction + shape.damping * dq[i] * memory.mass(i, j) * dq[j];
    }
    memory.energy = memory.energy - drawn;
    if (memory.energy > s_.max) memory.energy = s_.max;
    memory.explained = input + drawn - friction / h;
  }

  template <std::size_t N>
  [[nodiscard]] Held<N> hold() const noexcept {
    Held<N> m;
    m.energy = s_.start;
    return m;
  }

  /// Books a motion of the real robot by `dq` in `dt` seconds under the torque that acted, to a position with
  /// the torques `gravity` and `port`: charges the work of its active part, and that work of its passive part
  /// which is none of port, gravity or friction (they changed since it was sent).
  ///
  /// @param delay  time from sending a torque until it acts [s].
  template <std::size_t N>
  SKINCTL_INLINE void book(Held<N>& memory, const JointPosition<N, T>& dq, const JointTorque<N, T>& port,
                           const JointTorque<N, T>& gravity, const T& dt, const T& delay) const noexcept {
    if (!memory.counts) return;
    JointTorque<N, T> active, passive;
    const bool acts = memory.actives.step(memory.active, dt, delay, active);
    if (!memory.passives.step(memory.passive, dt, delay, passive) || !acts) return;
    learn(memory.foresight, active, dq);
    T drawn(0), res(0);
    for (std::size_t i = 0; i < N; ++i) {
      drawn = drawn + active[i] * dq[i];
      const T fair = s_.port_gain * (memory.port[i] + port[i]) + memory.gravity[i] + gravity[i];
      res = res + (passive[i] - T(0.5) * fair) * dq[i];
    }
    memory.energy = memory.energy - drawn - (res > T(0) ? res : T(0));
    if (memory.energy > s_.max) memory.energy = s_.max;
  }

  /// Cuts `active` to the torque that the tank can pay for while it is held for `h` seconds from the velocity
  /// `v` on, and returns the share in [0, 1] that is left of its elements that drive joints; those that brake
  /// stay. `move(torque)` gives the velocity to which a torque leads in `h + delay` seconds.
  ///
  /// @param passive  torque without cost [N m]: `port_gain` times the contacts', plus gravity, less friction.
  template <std::size_t N, class Move>
  [[nodiscard]] SKINCTL_INLINE T pay(Held<N>& memory, const JointTorque<N, T>& passive,
                                     JointTorque<N, T>& active, const JointVelocity<N, T>& v, const T& h,
                                     const T& delay, Move&& move) const noexcept {
    const T all = h + delay;
    JointVelocity<N, T> v1 = move(passive + active);
    T share(1);
    if (!is_payable(memory, active, v, v1, all)) [[unlikely]] {
      JointTorque<N, T> brakes, drives = active;
      for (std::size_t i = 0; i < N; ++i)
        if (cost_of(memory.foresight, i, active[i], v[i], v1[i], all) < T(0))
          brakes[i] = active[i], drives[i] = T(0);
      share = share_of(memory, brakes, drives, v, move(passive + brakes), v1, all);
      active = brakes + share * drives;
    }
    foresee(memory.foresight, v, v1, h, all);
    return share;
  }
  /// Takes the torque that is sent, after limits and guard, with its parts.
  template <std::size_t N>
  SKINCTL_INLINE void sent(Held<N>& memory, const JointTorque<N, T>& torque, const JointTorque<N, T>& passive,
                           const JointTorque<N, T>& port, const JointTorque<N, T>& gravity) const noexcept {
    memory.passive = passive;
    memory.port = port;
    memory.gravity = gravity;
    memory.active = torque - passive;
    memory.counts = true;
  }
  /// Takes another torque that was sent instead: the motion by it was not predicted.
  template <std::size_t N>
  SKINCTL_INLINE void sent(Held<N>& memory, const JointTorque<N, T>& torque) const noexcept {
    memory.active = torque - memory.passive;
    memory.counts = true;
    memory.foresight.valid = false;
  }

 private:
  /// Share of a surprise that is left after a sub-step: it fades over 500, a second of 2 ms each.
  static constexpr T fading = T(0.998);
  static constexpr T headroom = T(2);  ///< surprises paid for in advance: the next one may be larger
  /// Share of `max` for a surprise larger than any so far, on which no torque draws knowingly.
  static constexpr T reserve = T(1e-3);

  /// Learns from a motion by `dq` under the torque `active` how far joints went beyond the predicted motion,
  /// along that torque.
  template <std::size_t N>
  static SKINCTL_INLINE void learn(Foresight<N>& foresight, const JointTorque<N, T>& active,
                                   const JointPosition<N, T>& dq) noexcept {
    if (!foresight.valid) return;
    foresight.valid = false;
    for (std::size_t i = 0; i < N; ++i) {
      const T off = active[i] < T(0) ? T(foresight.ahead[i] - dq[i]) : T(dq[i] - foresight.ahead[i]);
      const T faded = fading * foresight.surprise[i];
      foresight.surprise[i] = off > faded ? off : faded;
    }
  }

  /// Predicts the displacement in `h` seconds of a motion that goes from `v` to `v1` in `all` seconds.
  template <std::size_t N>
  static SKINCTL_INLINE void foresee(Foresight<N>& foresight, const JointVelocity<N, T>& v,
                                     const JointVelocity<N, T>& v1, const T& h, const T& all) noexcept {
    for (std::size_t i = 0; i < N; ++i) foresight.ahead[i] = h * (v[i] + T(0.5) * (h / all) * (v1[i] - v[i]));
    foresight.valid = true;
  }
  /// The cost of `active` at joint `i` while it goes from `v` to `v1` in `h` seconds, surprises included [J].
  template <std::size_t N>
  static SKINCTL_INLINE T cost_of(const Foresight<N>& foresight, std::size_t i, const T& active, const T& v,
                                  const T& v1, const T& h) noexcept {
    return T(0.5) * h * active * (v + v1) +
           headroom * (active < T(0) ? T(-active) : active) * foresight.surprise[i];
  }
  /// Whether the tank pays for `active` while joints go from `v` to `v1` in `h` seconds, surprises included.
  template <class Of, std::size_t N>
  SKINCTL_INLINE bool is_payable(const Of& memory, const JointTorque<N, T>& active,
                                 const JointVelocity<N, T>& v, const JointVelocity<N, T>& v1,
                                 const T& h) const noexcept {
    T cost(0);
    for (std::size_t i = 0; i < N; ++i) cost = cost + cost_of(memory.foresight, i, active[i], v[i], v1[i], h);
    return cost <= memory.energy - reserve * s_.max || cost <= T(0);
  }
  /// The share of `drives` for which the tank pays beside all of `brakes`, and the velocity to which both
  /// lead in place of `v1`, to which all of it leads.
  ///
  /// @param v0  the velocity to which `brakes` leads alone.
  template <class Of, std::size_t N>
  SKINCTL_INLINE T share_of(const Of& memory, const JointTorque<N, T>& brakes,
                            const JointTorque<N, T>& drives, const JointVelocity<N, T>& v,
                            const JointVelocity<N, T>& v0, JointVelocity<N, T>& v1,
                            const T& h) const noexcept {
    const auto& foresight = memory.foresight;
    T w0(0), w1(0), w2(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T change = T(0.5) * h * (v1[i] - v0[i]);
      w0 = w0 + cost_of(foresight, i, brakes[i], v[i], v0[i], h);
      w1 = w1 + cost_of(foresight, i, drives[i], v[i], v0[i], h) + brakes[i] * change;
      w2 = w2 + drives[i] * change;
    }
    const T share = affordable_share(w1, w2, T(memory.energy - reserve * s_.max - w0));
    for (std::size_t i = 0; i < N; ++i) v1[i] = v0[i] + share * (v1[i] - v0[i]);
    return share;
  }

  Settings s_;
};

SKINCTL_END_NAMESPACE
