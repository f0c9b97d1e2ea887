// SPDX-License-Identifier: BSD-3-Clause
// Impedance: a spring and a damper between robot and target, the plain alternative to sliding modes.
#pragma once

#include <array>

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/tracking/joint_space.hpp"
#include "skinctl/tracking/operational_space.hpp"
#include "skinctl/tracking/spline_plan.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Springs and dampers, one per coordinate: joints, or the tool's position and then its orientation.
template <class Space>
struct ImpedanceSettings {
  using T = typename Space::scalar;
  typename Space::Settings space = {};  ///< settings of goals and of the tool; their gains are not read
  std::array<T, Space::coordinates> stiffness = uniform(T(100));  ///< stiffness, >= 0 [N m/rad], [N/m]
  std::array<T, Space::coordinates> damping = uniform(T(20));     ///< damping, >= 0 [N m s/rad], [N s/m]
  JointTorque<Space::joints, T> joint_damping;  ///< joint damping for the null space [N m s/rad]

  static constexpr std::array<T, Space::coordinates> uniform(const T& value) {
    std::array<T, Space::coordinates> a{};
    for (T& x : a) x = value;
    return a;
  }
};

/// `tau = -J'(K e + D de)` in the coordinates of `Space` (in joint space J = 1), e the position less the
/// target's, plus G: at a contact spring and damper are felt in series with the robot's own inertia. It
/// inverts no Jacobian and has no singularity. Without an integral, a load leaves an error of load over
/// stiffness.
///
/// A damper whose torque is held turns unstable for `D dt > 2 m`, and a wrist has a very small inertia m.
/// Therefore the damper acts on the velocity at the end of the interval,
/// `-M (M + dt D_q)^-1 (J'D de + joint_damping dq)` with `D_q = J'D J + joint_damping`: stable for every
/// damping, and the plain one for dt -> 0. Springs need `K dt^2 < m`.
///
/// Goals move along the spline, eq. (22), from the present target; the change of torque at a goal or a
/// contact is ramped out over `bumpless_transfer`.
template <class Space, class Plan = SplinePlan<Space>>
class Impedance : public Composable {
 public:
  static constexpr std::size_t N = Space::joints;
  static constexpr std::size_t joints = N;
  using scalar = typename Space::scalar;
  using T = scalar;
  using Goal = typename Plan::Goal;
  using Settings = ImpedanceSettings<Space>;
  static constexpr Needs needs = Needs{.gravity = true, .mass = true} | Space::needs;
  static constexpr LawRole role = LawRole::tracking;
  static constexpr const char* name = "impedance";
  struct Memory {
    Plan plan;
    JointTorque<N, T> difference;  ///< change of torque at the last reset [N m]
    Nanoseconds elapsed = clock_end;
    bool held = false;
    [[no_unique_address]] typename Space::Memory space = {};
  };

  /// Throws `ConfigurationError` for numbers that are negative or not finite.
  explicit Impedance(const Settings& settings = {})
    requires std::default_initializable<Space>
      : Impedance(Space(), settings) {}
  Impedance(const Space& space, const Settings& settings) : space_(space), settings_(settings) {
    const auto check = [](const T& x, const char* what) {
      require(x >= T(0) && x <= T(1e6), what, static_cast<double>(x), "0 to 1e6");
    };
    for (const T& k : settings.stiffness) check(k, "stiffness");
    for (const T& d : settings.damping) check(d, "damping");
    for (const T& d : settings.joint_damping) check(d, "joint_damping");
    const auto& s = Space::tracking(settings.space);
    require(s.bumpless_transfer > 0ns && s.bumpless_transfer <= 1000s, "bumpless_transfer",
            milliseconds(s.bumpless_transfer), "> 0 ms, <= 1000 s");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
  [[nodiscard]] const Space& space() const noexcept { return space_; }

  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    Memory memory;
    memory.plan = Plan::standing(space_.where(space_.site(known)), settings_.space);
    return memory;
  }
  /// The memory after a stop or a brake: the plan leads from the known state to where it led. As it was where
  /// the robot is still near its course.
  template <class K>
  [[nodiscard]] Memory resumed(const Memory& memory, const K& known) const noexcept {
    if constexpr (!Plan::streams)
      if (memory.plan.is_near(Space::motion(space_.site(known)), settings_.space)) return memory;
    Memory out = start(known);
    out.plan = memory.plan.resumed(Space::motion(space_.site(known)), settings_.space);
    return out;
  }
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const Goal& goal) const noexcept {
    if (!detail::within_limits<Space>(known, goal)) return {memory, Reason::goal_refused};
    bool streamed = false;
    if constexpr (!Plan::streams) {
      streamed = memory.plan.is_sample(goal, settings_.space);
      if (memory.plan.leads_to(goal, settings_.space)) {
        Received<Memory> same{memory, {}};
        same.memory.plan.heard = 0ns;
        return same;
      }
    }
    const auto from = Space::where_of(memory.plan.at(T(0), settings_.space));
    const auto planned = memory.plan.to(goal, from, settings_.space);
    Received<Memory> out{memory, planned.status};
    if (planned.status.has(Reason::goal_refused)) return out;
    out.memory.plan = planned.memory;
    if (!streamed || !planned.memory.goes_on_from(memory.plan, settings_.space))
      bumpless_transfer(out.memory, memory, known);
    return out;
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] JointTorque<N, T> torque(const Memory& memory, const K& known,
                                         const LawShare<T>& share = {}) const noexcept {
    const auto site = space_.site(known);
    const auto error = space_.errors(memory.plan.at(T(0), settings_.space), site, memory.space);
    constexpr std::size_t m = Space::coordinates;
    T J[m][N], A[N * N], braked[N];
    Space::rows(site, J);
    JointTorque<N, T> tau;
    for (std::size_t i = 0; i < N; ++i) {
      T spring(0), damper = settings_.joint_damping[i] * known.dq()[i];
      for (std::size_t c = 0; c < m; ++c) {
        spring = spring + J[c][i] * settings_.stiffness[c] * error.e[c];
        damper = damper + J[c][i] * settings_.damping[c] * error.de[c];
      }
      tau[i] = -spring;
      braked[i] = damper;
      for (std::size_t j = 0; j <= i; ++j) {
        T sum = i == j ? settings_.joint_damping[i] : T(0);
        for (std::size_t c = 0; c < m; ++c) sum = sum + settings_.damping[c] * J[c][i] * J[c][j];
        A[i * N + j] = known.mass()(i, j) + known.dt() * sum;
      }
    }
    JointAcceleration<N, T> a;
    math::Ldlt<N, T>(A).solve(braked, a.data);
    tau -= known.mass() * a;
    const T left =
        quintic(seconds<T>(memory.elapsed) / seconds<T>(Space::tracking(settings_.space).bumpless_transfer))
            .rest;
    for (std::size_t i = 0; i < N; ++i) tau[i] = share.feedback * (tau[i] + left * memory.difference[i]);
    if constexpr (G == GravityTerm::included) tau += share.feed_forward * known.gravity();
    return tau;
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& memory, const K& known, const T& dt,
                               Opposition opposition) const noexcept {
    Memory next = memory;
    if ((opposition == Opposition::lasting) != memory.held) {
      next.held = opposition == Opposition::lasting;
      next.plan = memory.plan.held(next.held, settings_.space);
      bumpless_transfer(next, memory, known);
    }
    const Nanoseconds ns = nanoseconds(static_cast<double>(dt));
    next.plan = next.plan.advanced(ns, settings_.space);
    next.elapsed = later(next.elapsed, ns);
    Space::follow_branch(next.space, memory.plan.at(T(0), settings_.space), space_.site(known));
    return next;
  }
  /// Whether the target is at rest, no touch holds the law off (`held`), and no joint is faster than `still`
  /// [rad/s].
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    return !memory.held && Space::stands(memory.plan.at(T(0), settings_.space)) &&
           detail::slower(known.dq(), still);
  }
  [[nodiscard]] Status status(const Memory& memory) const noexcept {
    Status s;
    if (memory.elapsed < Space::tracking(settings_.space).bumpless_transfer) s |= Reason::bumpless_transfer;
    if (memory.held) s |= Reason::opposed;
    return s;
  }

 private:
  template <class K>
  void bumpless_transfer(Memory& next, const Memory& before, const K& known) const noexcept {
    const auto old = torque(before, known);
    next.elapsed = clock_end;
    next.difference = old - torque(next, known);
    next.elapsed = 0ns;
    for (T& x : next.difference)
      if (!(x - x == T(0))) x = T(0);
  }

  [[no_unique_address]] Space space_;
  Settings settings_;
};

/// Impedance with springs at the joints.
template <std::size_t N, Real T = double>
using JointImpedance = Impedance<JointSpace<N, T>>;
/// Impedance with springs at a tool `P` on link `Ix`.
template <std::size_t N, std::size_t Ix, Frame P = Tool, Real T = double, TaskSpace What = TaskSpace::pose>
using CartesianImpedance = Impedance<OperationalSpace<N, Ix, P, T, What>>;

SKINCTL_END_NAMESPACE
