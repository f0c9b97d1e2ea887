// The space in which Joint Control tracks: the joints themselves.
#pragma once

#include "skinctl/control/sliding_surface.hpp"
#include "skinctl/core/status.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The joints as the coordinates of a tracking law: what `Tracking` asks of a space, at no cost.
///
/// A space has `joints` and `coordinates`, `Settings`, a `Memory` of its own, `needs`, and
/// - `site(known)`, `site(model, q, dq)`: all that it reads of a state;
/// - `where(site)`: the place from which a plan begins;
/// - `errors(target, site, memory)`: eqs. (13) or (20), (21);
/// - `surface(gains, inputs, site, memory)`: the surface and the reference motion of the joints;
/// - `course(surface)`: the reference motion of the coordinates;
/// - `slowness(errors, v_d)`: how long the largest error takes at the largest speed [s];
/// - `advanced(memory, surface)`, `status(memory)`.
template <std::size_t N, Real T = double>
class JointSpace {
 public:
  static constexpr std::size_t joints = N;
  static constexpr std::size_t coordinates = N;
  static constexpr Needs needs = {};
  using scalar = T;
  using Settings = JointControlSettings<N, T>;
  using Surface = SlidingSurface<N, T>;
  using Reference = JointReference<N, T>;
  using Inputs = SurfaceInputs<N, T>;
  struct Memory {};
  struct Site {
    const JointPosition<N, T>& q;
    const JointVelocity<N, T>& dq;
  };
  struct Course {
    const JointVelocity<N, T>& v;
    const JointAcceleration<N, T>& a;
  };

  explicit JointSpace(const Settings& settings) noexcept : max_velocity_(settings.max_velocity) {}
  [[nodiscard]] static SKINCTL_INLINE const JointControlSettings<N, T>& tracking(const Settings& s) noexcept {
    return s;
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE Site site(const K& known) const noexcept {
    return {known.q(), known.dq()};
  }
  template <class M>
  [[nodiscard]] SKINCTL_INLINE Site site(const M&, const JointPosition<N, T>& q,
                                         const JointVelocity<N, T>& dq) const noexcept {
    return {q, dq};
  }
  [[nodiscard]] static SKINCTL_INLINE const JointPosition<N, T>& where(const Site& at) noexcept {
    return at.q;
  }
  [[nodiscard]] SurfaceErrors<N, T> errors(const Reference& target, const Site& at,
                                           const Memory&) const noexcept {
    SurfaceErrors<N, T> error;
    for (std::size_t i = 0; i < N; ++i) {
      error.e[i] = at.q[i] - target.q_d[i];
      error.de[i] = error.slope[i] = at.dq[i] - target.dq_d[i];
      error.v_d[i] = target.dq_d[i];
      error.a_d[i] = target.ddq_d[i];
    }
    return error;
  }
  [[nodiscard]] SKINCTL_INLINE Surface surface(const SurfaceGains<T>& gains, const Inputs& in, const Site& at,
                                               const Memory&) const noexcept {
    return sliding_surface(gains, in, at.q, at.dq);
  }
  [[nodiscard]] static SKINCTL_INLINE Course course(const Surface& s) noexcept { return {s.dq_r, s.ddq_r}; }
  [[nodiscard]] T slowness(const T* e, const T* v_d) const noexcept {
    T most(0);
    for (std::size_t i = 0; i < N; ++i) {
      const T speed = max_velocity_[i] - detail::magnitude(v_d[i]);
      if (speed > T(0) && detail::magnitude(e[i]) > most * speed) most = detail::magnitude(e[i]) / speed;
    }
    return most;
  }
  [[nodiscard]] static SKINCTL_INLINE Memory advanced(const Memory&, const Surface&) noexcept { return {}; }
  [[nodiscard]] static SKINCTL_INLINE Status status(const Memory&) noexcept { return {}; }

 private:
  JointVelocity<N, T> max_velocity_;
};

SKINCTL_END_NAMESPACE
