// SPDX-License-Identifier: BSD-3-Clause
// Passivity of the real robot at a contact: it returns no more energy than it received.
#pragma once

#include "skinctl/core/joint.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/tactile/contact.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The account of energy at the measured port: behind a delay the virtual robot's passivity does not make the
/// real one passive. A part of a resolver's `Passivity`.
///
/// `E_r = E_0 - sum 1/2 (F_k + F_{k-1}) dx`, F the measured push of a contact and dx the real robot's
/// displacement into it. The virtual robot moves into contacts only while `sum (F + k_max p/2) p <= E_r`, p
/// the distance of the furthest command under way, its braking distance included, ahead of the measured
/// position along the contact; otherwise it slows down and holds (`energy_held`).
///
/// A contact that is not felt yet costs up to `k_max p^2/2` with `p = sum reach_i |dq_i|` of the commands
/// under way. Where `reach` is given, that is kept below E_r too: the speed in free space is one whose impact
/// E_r can pay for.
///
/// **Motion out of all contacts is always allowed**, whatever is left, at a speed that keeps the promise: an
/// arm that gives way takes the work of the push, `-F p`, on the same way that could lead it into something
/// unseen, so the impact may cost E_r and that work together. A pushed arm with an empty account thus begins
/// at `2 F/k_max` per total delay and gets faster with what it takes; if the hand lets go at that moment, an
/// impact overdraws by `2 F^2/k_max` at most. Without contact the account is halved by an impact at most, so
/// it does not run dry; where it has nonetheless (a push grew faster than predicted), a sixteenth of the
/// reserve is left for each impact, so that the arm creeps. With `reserve` = 0 it then waits to be pushed.
template <Real T = double>
class PassivityObserver {
 public:
  using RobotPart = detail::PassivityPart;
  static constexpr bool of_virtual_robot = true;
  struct Settings {
    T start = T(1);        ///< E_0: energy at the start [J], >= 0; 1 J brings 8 kg to 0.5 m/s
    T max = T(5);          ///< largest energy in the account; more is discarded [J], >= start
    T stiffness = T(3e4);  ///< k_max: stiffest contact, the skin's cover in series [N/m], > 0
    /// Longest lever of each joint to a point that may be touched [m]; the last one applies to all further
    /// joints. Zero: impacts are not considered.
    T reach[8] = {};
    T reserve = T(0.05);  ///< share of E_0 kept for changes of pushes, and to creep, 0 to 0.9
    T newtons = T(1);     ///< newtons at the cell per newton at the law (one over the scale of w_f)
  };
  template <std::size_t N>
  struct Memory {
    /// A contact at the last cycle.
    struct Felt {
      std::size_t link = 0;
      Xyz<T> place = {T(0), T(0), T(0)}, normal = {T(0), T(0), T(0)};
      T force = T(0);     ///< push of the contact [N]
      T expected = T(0);  ///< push predicted for the time at which a present command is carried out [N]
      T ahead = T(0);     ///< distance of the furthest command under way into the contact [m]
      T row[N] = {};
    };
    T energy = T(0);
    std::size_t count = 0;
    Felt felt[max_contacts<N>];
    T under_way = T(0);     ///< largest distance of a command under way, at the longest levers [m]
    JointPosition<N, T> q;  ///< measured position at the last cycle [rad]
    bool started = false;
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit PassivityObserver(const Settings& s = {}) : s_(s) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(s.start >= T(0) && s.start <= T(1e6), "energy at the start", number(s.start), "0 to 1e6 J");
    require(s.max >= s.start && s.max <= T(1e6), "most energy", number(s.max), ">= start, <= 1e6 J");
    require(s.stiffness > T(0) && s.stiffness <= T(1e9), "stiffest contact", number(s.stiffness),
            "> 0, <= 1e9 N/m");
    require(s.reserve >= T(0) && s.reserve <= T(0.9), "reserve", number(s.reserve), "0 to 0.9");
    for (const T& r : s.reach) require(r >= T(0) && r <= T(1e3), "reach", number(r), "0 to 1e3 m");
    require(s.newtons > T(0) && s.newtons <= T(1e6), "newtons per newton", number(s.newtons), "> 0, <= 1e6");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  template <std::size_t N>
  [[nodiscard]] Memory<N> start() const noexcept {
    Memory<N> m;
    m.energy = s_.start;
    return m;
  }

  /// Books a cycle's contacts and measured position. `each_pending(f)` calls `f(dq)` for every command under
  /// way, dq the displacement from the measured position to the commanded one.
  ///
  /// @param cycles  number of cycles for which a command is under way: a growing push is extrapolated by
  ///                them.
  template <std::size_t N, std::size_t K, class EachPending>
  void book(Memory<N>& memory, const Contacts<N, T, K>& contacts, const JointPosition<N, T>& q,
            const T& cycles, EachPending&& each_pending) const noexcept {
    static_assert(K <= max_contacts<N>);
    if (memory.started) spend(memory, q);  // half along the old directions, half along the new ones
    typename Memory<N>::Felt now[K];
    bool matched[max_contacts<N>] = {};
    std::size_t count = 0;
    for (const auto& c : contacts) {
      if (!(c.force > T(0))) continue;
      auto& f = now[count++];
      f.link = c.link, f.place = c.place, f.normal = c.normal;
      f.force = s_.newtons * c.force;
      for (std::size_t j = 0; j < N; ++j) f.row[j] = c.row[j];
      const std::size_t old = detail::continued(memory.felt, matched, memory.count, c);
      T growth = f.force;
      if (old < memory.count) matched[old] = true, growth = f.force - memory.felt[old].force;
      f.expected = f.force + (growth > T(0) ? T(cycles * growth) : T(0));
    }
    for (std::size_t k = 0; k < count; ++k) memory.felt[k] = now[k];
    memory.count = count;
    if (memory.started) spend(memory, q);
    if (memory.energy > s_.max) memory.energy = s_.max;
    memory.q = q;
    memory.started = true;
    memory.under_way = T(0);
    each_pending([&](const JointPosition<N, T>& dq) {
      for (std::size_t k = 0; k < memory.count; ++k) {
        auto& f = memory.felt[k];
        const T p = along(f.row, dq);
        if (p > f.ahead) f.ahead = p;
      }
      const T p = lever(dq);
      if (p > memory.under_way) memory.under_way = p;
    });
  }

  /// Whether the virtual robot may move at `v`, which leads it to `dq` ahead of the measured position before
  /// it can stop.
  template <std::size_t N>
  [[nodiscard]] SKINCTL_INLINE bool allows(const Memory<N>& memory, const JointPosition<N, T>& dq,
                                           const JointVelocity<N, T>& v) const noexcept {
    const T left = memory.energy - s_.reserve * s_.start;
    T cost(0), gained(0);
    bool inward = false;
    for (std::size_t k = 0; k < memory.count; ++k) {
      const auto& f = memory.felt[k];
      inward = inward || along(f.row, v) > T(0);
      const T p = along(f.row, dq), furthest = p > f.ahead ? p : f.ahead;
      cost = cost + (f.expected + T(0.5) * s_.stiffness * furthest) * furthest;
      if (p < T(0)) gained = gained - f.force * p;
    }
    if (inward && !(cost <= left)) return false;
    const T p = lever(dq), furthest = p > memory.under_way ? p : memory.under_way;
    const T half = T(0.5) * memory.energy, creep = T(creeping) * s_.reserve * s_.start;
    const T most = left > half ? left : (half > creep ? half : creep);
    return T(0.5) * s_.stiffness * furthest * furthest <= most + gained || !(p > T(0));
  }

  /// `v` without its parts into the contacts.
  template <std::size_t N>
  [[nodiscard]] SKINCTL_COLD JointVelocity<N, T> outward(const Memory<N>& memory,
                                                         JointVelocity<N, T> v) const noexcept {
    for (int round = 0; round < rounds; ++round)
      for (std::size_t k = 0; k < memory.count; ++k) {
        const auto& row = memory.felt[k].row;
        const T into = along(row, v), size = along(row, row);
        if (!(into > T(0) && size > T(0))) continue;
        for (std::size_t j = 0; j < N; ++j) v[j] = v[j] - T(outward_by) * into / size * row[j];
      }
    return v;
  }

 private:
  /// Share of the reserve for each impact of an arm with an empty account: 16 of them use it up.
  static constexpr double creeping = 1.0 / 16;
  static constexpr double outward_by = 1.001;  ///< factor on what is taken off a motion into a contact
  static constexpr int rounds = 4;  ///< rounds over all contacts: what leaves one may lead into another one

  template <std::size_t N, class Q>
  static SKINCTL_INLINE T along(const T (&row)[N], const Q& dq) noexcept {
    T sum(0);
    for (std::size_t j = 0; j < N; ++j) sum = sum + row[j] * dq[j];
    return sum;
  }
  template <std::size_t N>
  SKINCTL_INLINE T lever(const JointPosition<N, T>& dq) const noexcept {
    T sum(0);
    for (std::size_t j = 0; j < N; ++j)
      sum = sum + s_.reach[j < 7 ? j : 7] * (dq[j] < T(0) ? T(-dq[j]) : dq[j]);
    return sum;
  }
  template <std::size_t N>
  void spend(Memory<N>& memory, const JointPosition<N, T>& q) const noexcept {
    for (std::size_t k = 0; k < memory.count; ++k) {
      const auto& f = memory.felt[k];
      memory.energy = memory.energy - T(0.5) * f.force * along(f.row, q - memory.q);
    }
  }

  Settings s_;
};

SKINCTL_END_NAMESPACE
