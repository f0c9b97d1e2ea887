// SPDX-License-Identifier: BSD-3-Clause
// The regressor: joint torques as a linear function of the inertial parameters.
#pragma once

#include <bit>

#include "skinctl/core/eigen.hpp"
#include "skinctl/dynamics/detail/motion.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The ten inertial parameters of a link, in which its wrench is linear: mass, first moments and moments of
/// inertia about the origin of the link's frame, in its axes. `xy` is the element of the inertia matrix, the
/// negative integral of x y dm.
enum class Inertial : std::size_t { mass, h_x, h_y, h_z, xx, yy, zz, xy, xz, yz, count };

/// `Theta`: ten numbers a link [kg, kg m, kg m^2], links in the order of the model. Not checked: estimators
/// pass through physically impossible values.
template <std::size_t N, Scalar T = double>
struct InertialParameters {
  static constexpr std::size_t size = 10 * N;
  T data[size] = {};

  SKINCTL_INLINE constexpr T& operator()(std::size_t link, Inertial p) noexcept {
    return data[10 * link + std::size_t(p)];
  }
  SKINCTL_INLINE constexpr const T& operator()(std::size_t link, Inertial p) const noexcept {
    return data[10 * link + std::size_t(p)];
  }
};

namespace detail {

/// Number of pairs of a joint and a link that it carries, for the links before `link`.
template <Topology M>
constexpr std::size_t blocks_before(std::size_t link) noexcept {
  std::size_t n = 0;
  for (std::size_t i = 0; i < link; ++i) n += static_cast<std::size_t>(std::popcount(ancestors<M>(i)));
  return n;
}

/// Writes to `powers` the torques about a joint that carries a link, one for each of the link's ten inertial
/// parameters at 1: the dot products of the joint's unit twist (v, w) with the wrenches of the parameters.
template <Scalar T>
SKINCTL_INLINE void parameter_powers(const LinkMotion<T>& m, const Xyz<T>& v, const Xyz<T>& w,
                                     T* powers) noexcept {
  const auto& [ex, ey, ez] = m.spin;
  powers[0] = dot(v, m.a);
  const Xyz<T> a_w = cross(m.a, w);  // w . (e x a) = e . (a x w)
  powers[1] = v.x * ex.x + v.y * ey.x + v.z * ez.x + a_w.x;
  powers[2] = v.x * ex.y + v.y * ey.y + v.z * ez.y + a_w.y;
  powers[3] = v.x * ex.z + v.y * ey.z + v.z * ez.z + a_w.z;
  // Second moments of mass S: the moment has the components (E S)_zy - (E S)_yz and so on.
  const T half(0.5);
  const T p = w.z * ey.x - w.y * ez.x;  // of S_xx
  const T q = w.x * ez.y - w.z * ex.y;  // of S_yy
  const T r = w.y * ex.z - w.x * ey.z;  // of S_zz
  powers[4] = half * (q + r - p);
  powers[5] = half * (p + r - q);
  powers[6] = half * (p + q - r);
  powers[7] = -(w.x * ez.x - w.y * ez.y + w.z * (ey.y - ex.x));
  powers[8] = -(w.z * ey.z - w.x * ey.x + w.y * (ex.x - ez.z));
  powers[9] = -(w.x * (ez.z - ey.y) + w.y * ex.y - w.z * ex.z);
}

/// Links with the parameters `theta`, for the recursion of inverse dynamics.
template <Scalar Number>
struct ParameterBodies {
  const Number* theta;
  template <std::size_t Ix, Scalar T, class E, class A>
  SKINCTL_INLINE constexpr auto wrench(const E& spin, const A& a) const noexcept {
    const T* o = theta + 10 * Ix;
    const Xyz<T> h{o[1], o[2], o[3]};
    const T half(0.5);
    const Xyz<T> s_x{half * (o[5] + o[6] - o[4]), -o[7], -o[8]};
    const Xyz<T> s_y{-o[7], half * (o[4] + o[6] - o[5]), -o[9]};
    const Xyz<T> s_z{-o[8], -o[9], half * (o[4] + o[5] - o[6])};
    const auto& [ex, ey, ez] = spin;
    const Triple n{dot(ez, s_y) - dot(ey, s_z), dot(ex, s_z) - dot(ez, s_x), dot(ey, s_x) - dot(ex, s_y)};
    return ForceMoment{o[0] * a + spin * h, n + cross(h, a)};
  }
};

/// The velocity of a link's origin and its angular velocity, in its axes.
template <Scalar T>
struct LinkVelocity {
  Xyz<T> v, w;
};
template <Scalar T, class Frame>
SKINCTL_INLINE LinkVelocity<T> velocity_in_link(const Frame& frame, const LinkVelocity<T>& parent) noexcept {
  return {dense<T>(frame.to_link(parent.v + cross(parent.w, frame.p))), dense<T>(frame.to_link(parent.w))};
}

template <std::size_t Ix, class Input, Scalar T>
SKINCTL_INLINE void transposed_product(const Input& in, const LinkMotion<T>& parent,
                                       const LinkVelocity<T>& V_parent, const T* tau, T* out) noexcept {
  using M = std::remove_cvref_t<decltype(in.model)>;
  const auto frame = joint_frame<Ix>(in.model, in.angles);
  const LinkMotion<T> m = motion_of<Ix>(in, frame, parent);
  LinkVelocity<T> V = velocity_in_link(frame, V_parent);
  T& moved = M::kinds[Ix] == JointKind::revolute ? V.w.z : V.v.z;
  moved = moved + tau[Ix];
  parameter_powers(m, V.v, V.w, out + 10 * Ix);
  for_each_link<children<M, int(Ix)>>(
      [&](auto child) SKINCTL_INLINE_LAMBDA { transposed_product<child.value>(in, m, V, tau, out); });
}

}  // namespace detail

/// The regressor `Y(q, dq, dq_r, ddq_r)`, N x 10 N, with `Y Theta = M ddq_r + C(q, dq) dq_r + G` for every
/// parameter vector Theta (section 3.5; C is Christoffel's). A link's parameters have no effect on joints
/// that do not carry it: those blocks of ten are zero by topology, and neither stored nor multiplied.
template <Topology M, Scalar T = double>
class Regressor {
 public:
  static constexpr std::size_t joints = M::joints;

  template <RobotModel Robot, LinkMask Mask>
    requires(Robot::joints == M::joints)
  SKINCTL_INLINE Regressor(const Robot& model, const JointAngles<Robot, T, Mask>& angles,
                           const JointVelocity<joints, T>& dq, const JointVelocity<joints, T>& dq_r,
                           const JointAcceleration<joints, T>& ddq_r) noexcept {
    const detail::MotionInput<Robot, JointAngles<Robot, T, Mask>, T> in{model, angles, dq.data, dq_r.data,
                                                                        ddq_r.data};
    detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
      fill<child.value>(in, detail::motion_of_base<T>(model), nullptr);
    });
  }

  /// The torques of link `link`'s unit parameters at joint `joint`: ten numbers, null if zero by topology.
  [[nodiscard]] SKINCTL_INLINE const T* block(std::size_t joint, std::size_t link) const noexcept {
    return (ancestors<M>(link) >> joint) & 1u ? blocks_[slot(joint, link)] : nullptr;
  }
  /// The joint torques `Y Theta` [N m].
  [[nodiscard]] JointTorque<joints, T> operator*(const InertialParameters<joints, T>& theta) const noexcept {
    JointTorque<joints, T> tau;
    for (std::size_t link = 0; link < joints; ++link)
      for (std::size_t j = 0; j <= link; ++j)
        if (const T* y = block(j, link))
          for (std::size_t p = 0; p < 10; ++p) tau[j] = tau[j] + y[p] * theta.data[10 * link + p];
    return tau;
  }
  // clang-format off
  template <class Q> void operator*(const Q&) const = delete;  // Y takes inertial parameters of the same robot
  // clang-format on

  /// The full matrix, N x 10 N, zero blocks included.
  [[nodiscard]] friend EigenMatrix<T, int(joints), int(10 * joints)> as_eigen(const Regressor& Y) noexcept {
    EigenMatrix<T, int(joints), int(10 * joints)> m = EigenMatrix<T, int(joints), int(10 * joints)>::Zero();
    for (std::size_t link = 0; link < joints; ++link)
      for (std::size_t j = 0; j <= link; ++j)
        if (const T* y = Y.block(j, link))
          for (std::size_t p = 0; p < 10; ++p)
            m(static_cast<std::ptrdiff_t>(j), static_cast<std::ptrdiff_t>(10 * link + p)) = y[p];
    return m;
  }

 private:
  static constexpr std::size_t slot(std::size_t joint, std::size_t link) noexcept {
    return detail::blocks_before<M>(link) +
           static_cast<std::size_t>(std::popcount(ancestors<M>(link) & ((LinkMask(1) << joint) - 1)));
  }

  /// Collects the joints that carry link `Ix`, each as its unit velocity of the link; then writes the link's
  /// rows.
  template <std::size_t Ix, class Input>
  SKINCTL_INLINE void fill(const Input& in, const detail::LinkMotion<T>& parent,
                           const detail::LinkVelocity<T>* carriers) noexcept {
    constexpr auto count = static_cast<std::size_t>(std::popcount(ancestors<M>(Ix)));
    const auto frame = joint_frame<Ix>(in.model, in.angles);
    const detail::LinkMotion<T> m = detail::motion_of<Ix>(in, frame, parent);
    const Xyz<T> zero{T(0), T(0), T(0)};
    const Xyz<T> z{T(0), T(0), T(1)};
    detail::LinkVelocity<T> V[count];
    for (std::size_t k = 0; k + 1 < count; ++k) V[k] = detail::velocity_in_link(frame, carriers[k]);
    if constexpr (M::kinds[Ix] == JointKind::revolute) {
      V[count - 1] = {zero, z};
    } else {
      V[count - 1] = {z, zero};
    }
    constexpr std::size_t first = detail::blocks_before<M>(Ix);
    for (std::size_t k = 0; k < count; ++k) detail::parameter_powers(m, V[k].v, V[k].w, blocks_[first + k]);
    detail::for_each_link<children<M, int(Ix)>>([&](auto child)
                                                    SKINCTL_INLINE_LAMBDA { fill<child.value>(in, m, V); });
  }

  T blocks_[detail::blocks_before<M>(M::joints)][10];
};

/// The regressor of the paper's `Y_r Theta`. Only the placements and gravity of `model` are read.
template <RobotModel M, Scalar T>
[[nodiscard]] Regressor<M, T> regressor(const M& model, const JointPosition<M::joints, T>& q,
                                        const JointVelocity<M::joints, T>& dq,
                                        const JointVelocity<M::joints, T>& dq_r,
                                        const JointAcceleration<M::joints, T>& ddq_r) noexcept {
  return Regressor<M, T>(model, JointAngles<M, T>(model, q), dq, dq_r, ddq_r);
}

/// `Y Theta` [N m] without forming Y, at about the cost of inverse dynamics, for parameters that adaptation
/// changes in the loop. With `inertial_parameters(model)` it is `yr_theta`.
template <RobotModel M, Scalar T>
[[nodiscard]] JointTorque<M::joints, T> regressor_product(
    const M& model, const JointPosition<M::joints, T>& q, const JointVelocity<M::joints, T>& dq,
    const JointVelocity<M::joints, T>& dq_r, const JointAcceleration<M::joints, T>& ddq_r,
    const InertialParameters<M::joints, T>& theta) noexcept {
  const JointAngles<M, T> angles(model, q);
  JointTorque<M::joints, T> tau;
  detail::run_recursion_over<T>(model, detail::ParameterBodies<T>{theta.data}, angles,
                                detail::Values<T>{dq.data}, detail::Values<T>{dq_r.data},
                                detail::Values<T>{ddq_r.data}, -model.template gravity<T>(), tau.data);
  return tau;
}

/// `Y' s` without forming Y, for one number per joint, as in gradient adaptation `dTheta = -Gamma Y' S_q`.
/// Ten numbers a link, in one pass from the base to the tips.
template <RobotModel M, class K, Scalar T>
[[nodiscard]] InertialParameters<M::joints, T> regressor_transposed_product(
    const M& model, const JointPosition<M::joints, T>& q, const JointVelocity<M::joints, T>& dq,
    const JointVelocity<M::joints, T>& dq_r, const JointAcceleration<M::joints, T>& ddq_r,
    const JointVector<K, M::joints, T>& s) noexcept {
  const JointAngles<M, T> angles(model, q);
  const detail::MotionInput<M, JointAngles<M, T>, T> in{model, angles, dq.data, dq_r.data, ddq_r.data};
  InertialParameters<M::joints, T> out;
  const Xyz<T> zero{T(0), T(0), T(0)};
  detail::for_each_link<children<M, -1>>([&](auto child) SKINCTL_INLINE_LAMBDA {
    detail::transposed_product<child.value>(in, detail::motion_of_base<T>(model),
                                            detail::LinkVelocity<T>{zero, zero}, s.data, out.data);
  });
  return out;
}

/// The parameters of a model's links.
template <Scalar T = double, RobotModel M>
[[nodiscard]] InertialParameters<M::joints, T> inertial_parameters(const M& model) noexcept {
  InertialParameters<M::joints, T> theta;
  detail::unrolled<M::joints>([&](auto i) {
    using P = LinkParameter;
    T* const t = theta.data + 10 * i;
    const T m(model.template number<i, P::mass, T>());
    const Xyz<T> c = dense<T>(detail::centre_of_mass<i, T>(model));
    const Xyz<T> h = m * c;
    const T s_xx = T(model.template number<i, P::s_xx, T>()) + h.x * c.x;
    const T s_yy = T(model.template number<i, P::s_yy, T>()) + h.y * c.y;
    const T s_zz = T(model.template number<i, P::s_zz, T>()) + h.z * c.z;
    t[0] = m, t[1] = h.x, t[2] = h.y, t[3] = h.z;
    t[4] = s_yy + s_zz, t[5] = s_xx + s_zz, t[6] = s_xx + s_yy;
    t[7] = -(T(model.template number<i, P::s_xy, T>()) + h.x * c.y);
    t[8] = -(T(model.template number<i, P::s_xz, T>()) + h.x * c.z);
    t[9] = -(T(model.template number<i, P::s_yz, T>()) + h.y * c.z);
  });
  return theta;
}

SKINCTL_END_NAMESPACE
