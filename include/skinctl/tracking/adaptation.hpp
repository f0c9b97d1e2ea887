// Adaptation: a tracking law that learns the robot's inertial parameters while it moves.
#pragma once

#include "skinctl/dynamics/regressor.hpp"
#include "skinctl/tracking/tracking.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Rate and bounds of the learning.
template <std::size_t N, Real T = double>
struct AdaptationSettings {
  /// `Gamma = gamma bound^2`, parameter by parameter, so that all of them learn alike [1/(N m rad)]. At each
  /// moment `gamma sum (Y bound)^2 dt < lambda` must hold; a UR5 meets it by far at the default.
  T gamma = T(2);
  InertialParameters<N, T> bound;  ///< of the deviation from the model: see `deviations`
};

/// Bounds as a share of each parameter's own scale: of the mass, of the mass times `lever` [m], of the mass
/// times its square.
template <Real T = double, RobotModel M>
[[nodiscard]] InertialParameters<M::joints, T> deviations(const M& model, const T& part,
                                                          const T& lever = T(0.15)) {
  auto bound = inertial_parameters<T>(model);
  for (std::size_t i = 0; i < M::joints; ++i) {
    T* const b = bound.data + 10 * i;
    const T m = part * b[0];
    b[0] = m;
    for (std::size_t k = 1; k < 4; ++k) b[k] = m * lever;
    for (std::size_t k = 4; k < 10; ++k) b[k] = m * lever * lever;
  }
  return bound;
}

/// A tracking law `L` with `Y_r (Theta + D)` in place of `Y_r Theta`. The deviation D from the model is
/// learnt by `dD = -Gamma Y_r' S_q` (Slotine and Li) and kept within `+-bound` by projection: a step across
/// the bound is cut off, which never slows the decrease of the Lyapunov function. Y_r is that of the state at
/// which S_q is taken. D is constant while the skin pushes against the law, and numbers that are not finite
/// do not enter.
///
/// Learning needs motion: D converges only in the parameters that the motion excites, which is enough for
/// tracking.
template <class L>
class Adaptive : public Composable {
 public:
  static constexpr std::size_t N = L::N;
  static constexpr std::size_t joints = N;
  using scalar = typename L::scalar;
  using T = typename L::T;
  using Goal = typename L::Goal;
  using Surface = typename L::Surface;
  using Settings = AdaptationSettings<N, T>;
  static constexpr Needs needs = L::needs;
  static constexpr LawRole role = L::role;
  struct Memory {
    typename L::Memory law;
    InertialParameters<N, T> deviation;  ///< D [kg, kg m, kg m^2]
  };

  /// Throws `ConfigurationError` for a gamma or bounds that are negative or not finite.
  Adaptive(const L& law, const Settings& settings) : law_(law), settings_(settings) {
    require(settings.gamma >= T(0) && settings.gamma <= T(1e6), "gamma of the adaptation",
            static_cast<double>(settings.gamma), "0 to 1e6");
    for (const T& b : settings.bound.data)
      require(b >= T(0) && b <= T(1e6), "bound of a parameter", static_cast<double>(b), "0 to 1e6");
  }
  [[nodiscard]] const L& law() const noexcept { return law_; }
  /// Throws `ConfigurationError` where the law's settings are not those of the robot.
  template <class Terms>
  void check_for(const Terms& robot) const {
    detail::check_law_for(law_, robot);
  }

  template <class K>
  [[nodiscard]] Memory start(const K& known) const noexcept {
    return {law_.start(known), {}};
  }
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& memory, const K& known,
                                         const Goal& goal) const noexcept {
    const auto answer = law_.receive(memory.law, known, goal);
    return {{answer.memory, memory.deviation}, answer.status};
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Surface now(const Memory& memory, const K& known) const noexcept {
    return law_.now(memory.law, known);
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] JointTorque<N, T> torque(const Memory& memory, const K& known, const LawShare<T>& share,
                                         const Surface& at_t) const noexcept {
    const auto learnt =
        regressor_product(known.model(), known.q(), known.dq(), at_t.dq_r, at_t.ddq_r, memory.deviation);
    return law_.template torque<G>(memory.law, known, share, at_t) + share.feed_forward * learnt;
  }
  template <GravityTerm G = GravityTerm::included, class K>
  [[nodiscard]] JointTorque<N, T> torque(const Memory& memory, const K& known,
                                         const LawShare<T>& share = {}) const noexcept {
    return torque<G>(memory, known, share, now(memory, known));
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& memory, const K& known, const T& dt, Opposition opposition,
                               const Surface& at_t) const noexcept {
    Memory next{law_.advance(memory.law, known, dt, opposition, at_t), memory.deviation};
    if (opposition == Opposition::lasting) return next;
    const auto slope =
        regressor_transposed_product(known.model(), known.q(), known.dq(), at_t.dq_r, at_t.ddq_r, at_t.S_q);
    for (std::size_t k = 0; k < InertialParameters<N, T>::size; ++k) {
      const T b = settings_.bound.data[k];
      const T d = memory.deviation.data[k] - dt * settings_.gamma * b * b * slope.data[k];
      if (d - d == T(0)) next.deviation.data[k] = d > b ? b : (d < -b ? T(-b) : d);
    }
    return next;
  }
  template <class K>
  [[nodiscard]] Memory advance(const Memory& memory, const K& known, const T& dt,
                               Opposition opposition) const noexcept {
    return advance(memory, known, dt, opposition, now(memory, known));
  }
  template <class K>
  [[nodiscard]] bool settled(const Memory& memory, const K& known, const T& still) const noexcept {
    return law_.settled(memory.law, known, still);
  }
  /// See `Tracking::with_target`.
  template <class Target>
  [[nodiscard]] static Memory with_target(Memory memory, const Target& target) noexcept {
    memory.law = L::with_target(memory.law, target);
    return memory;
  }
  [[nodiscard]] Status status(const Memory& memory) const noexcept { return law_.status(memory.law); }

 private:
  L law_;
  Settings settings_;
};

SKINCTL_END_NAMESPACE
