// SPDX-License-Identifier: BSD-3-Clause
// Adaptation: a tracking law that learns the robot's inertial parameters while it moves.
#pragma once

#include "skinctl/dynamics/regressor.hpp"
#include "skinctl/tracking/detail/learning_law.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Rate and bounds of the learning.
template <std::size_t N, Real T = double>
struct AdaptationSettings {
  /// Rate of the learning [1/(N m rad)]: `Gamma = gamma bound^2`, parameter by parameter, so that all of them
  /// learn alike. `gamma sum (Y bound)^2 dt < lambda` must hold, with the regressor Y, the interval and the
  /// decay rate of the law; a UR5 meets it by far at the default.
  T gamma = T(2);
  InertialParameters<N, T> bound;  ///< largest deviation of the parameters from the model: see `deviations`
};

/// Bounds of the parameters as a share `part` of each one's own scale: of the mass, of the mass times `lever`
/// [m], of the mass times its square. The default lever is that of a rod of half a metre.
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

namespace detail {
template <std::size_t N, Real T>
struct LearntDeviation {
  InertialParameters<N, T> deviation;  ///< learnt deviation D from the model [kg, kg m, kg m^2]
};
}  // namespace detail

/// A tracking law `L` with `Y_r (Theta + D)` in place of `Y_r Theta`. The deviation D from the model is
/// learnt by `dD = -Gamma Y_r' S_q` (Slotine and Li) and kept within `+-bound` by projection: a step across
/// the bound is cut off, which never slows the decrease of the Lyapunov function. Y_r is that of the state at
/// which S_q is taken. D is constant while the skin pushes against the law, and numbers that are not finite
/// do not enter.
///
/// Learning needs motion: D converges only in the parameters that the motion excites, which is enough for
/// tracking.
template <class L>
class Adaptive : public detail::LearningLaw<Adaptive<L>, L, detail::LearntDeviation<L::N, typename L::T>> {
  using Base = detail::LearningLaw<Adaptive<L>, L, detail::LearntDeviation<L::N, typename L::T>>;

 public:
  using Base::N;
  using typename Base::Memory;
  using typename Base::Surface;
  using typename Base::T;
  using Settings = AdaptationSettings<N, T>;

  /// Throws `ConfigurationError` for a gamma or bounds that are negative or not finite.
  Adaptive(const L& law, const Settings& settings) : Base(law), settings_(settings) {
    require(settings.gamma >= T(0) && settings.gamma <= T(1e6), "gamma of the adaptation",
            static_cast<double>(settings.gamma), "0 to 1e6");
    for (const T& b : settings.bound.data)
      require(b >= T(0) && b <= T(1e6), "bound of a parameter", static_cast<double>(b), "0 to 1e6");
  }

  template <class K>
  [[nodiscard]] JointTorque<N, T> learnt_torque(const Memory& memory, const K& known,
                                                const Surface& at_t) const noexcept {
    return regressor_product(known.model(), known.q(), known.dq(), at_t.dq_r, at_t.ddq_r, memory.deviation);
  }
  template <class K>
  void learn(Memory& memory, const K& known, const T& dt, Opposition opposition,
             const Surface& at_t) const noexcept {
    if (opposition == Opposition::lasting) return;
    const auto slope =
        regressor_transposed_product(known.model(), known.q(), known.dq(), at_t.dq_r, at_t.ddq_r, at_t.S_q);
    for (std::size_t k = 0; k < InertialParameters<N, T>::size; ++k) {
      const T b = settings_.bound.data[k];
      T& d = memory.deviation.data[k];
      d = Base::kept(d - dt * settings_.gamma * b * b * slope.data[k], b, d);
    }
  }

 private:
  Settings settings_;
};

SKINCTL_END_NAMESPACE
