// Motion of the joints in the null space of operational laws.
#pragma once

#include <cmath>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/joint.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A joint motion; the law uses its part in the null space of the tool.
template <std::size_t N, Scalar T = double>
struct NullMotion {
  JointVelocity<N, T> v;
  JointAcceleration<N, T> a;
};

/// The null space comes to rest, as fast as K_d stops it.
struct DampedNullSpace {
  static constexpr bool rests = true;
};

/// The null space is free: this law neither brakes nor drives it, and the skin moves it. (Its motion has no
/// acceleration in `ddq_r`.)
struct FreeNullSpace {
  static constexpr bool rests = false;
  template <std::size_t N, Real T>
  [[nodiscard]] NullMotion<N, T> motion(const JointPosition<N, T>&,
                                        const JointVelocity<N, T>& dq) const noexcept {
    return {dq, {}};
  }
};

/// The null space goes to a posture, `v = -rate (q - q_p)`, each joint at most at `fastest`:
/// `v_i = -fastest x / sqrt(1 + x^2)`, `x = rate (q_i - q_p,i) / fastest`.
template <std::size_t N, Real T = double>
class PostureNullSpace {
 public:
  static constexpr bool rests = false;
  /// @param rate     [1/s], > 0.
  /// @param fastest  [rad/s], > 0. Throws `ConfigurationError`.
  explicit PostureNullSpace(const JointPosition<N, T>& posture, const T& rate = T(1),
                            const T& fastest = T(0.5))
      : posture_(posture), rate_(rate), fastest_(fastest) {
    require(rate > T(0) && rate <= T(1e3), "rate of a posture", static_cast<double>(rate), "> 0 1/s");
    require(fastest > T(0) && fastest <= T(1e3), "fastest of a posture", static_cast<double>(fastest),
            "> 0 rad/s");
  }
  [[nodiscard]] NullMotion<N, T> motion(const JointPosition<N, T>& q,
                                        const JointVelocity<N, T>& dq) const noexcept {
    using std::sqrt;
    NullMotion<N, T> m;
    for (std::size_t i = 0; i < N; ++i) {
      const T x = rate_ * (q[i] - posture_[i]) / fastest_;
      // Far away the square would overflow, and the joint stand still: there 1 does not count.
      const T size = x < T(0) ? T(-x) : x;
      const T less = T(1) / (size < T(1e9) ? T(sqrt(T(1) + x * x)) : size);
      m.v[i] = -fastest_ * x * less;
      m.a[i] = -rate_ * dq[i] * less * less * less;
    }
    return m;
  }

 private:
  JointPosition<N, T> posture_;
  T rate_, fastest_;
};

SKINCTL_END_NAMESPACE
