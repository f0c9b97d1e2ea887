// SPDX-License-Identifier: BSD-3-Clause
// Operational-space shaping: a given mass and friction of the virtual robot at its tool.
#pragma once

#include <array>
#include <cmath>

#include "skinctl/core/detail/real_of_inverse.hpp"
#include "skinctl/core/joint_subset.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/kinematics/jacobian_rate.hpp"
#include "skinctl/math/detail/block_ldlt.hpp"
#include "skinctl/robot/robot_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// No tool shape: the virtual robot has its model's inertia plus the virtual inertia of the joints.
struct NoToolShape {};

/// The terms of a shaped virtual robot at one pose; not initialised.
template <std::size_t N, std::size_t Rows, Real T>
struct ToolTerms {
  using Matrix = MassMatrix<N, T>;
  T J[Rows][N];                               ///< Jacobian of the tool, base axes
  Matrix mass{typename Matrix::Unset{}};      ///< M_v, the mass matrix of the virtual robot
  Matrix rest{typename Matrix::Unset{}};      ///< M_rest, the part of M_v without effect on the tool
  Matrix friction{typename Matrix::Unset{}};  ///< friction matrix, `J' D J + rest_decay M_rest`
  Matrix implicit{
      typename Matrix::Unset{}};  ///< h times the share of `friction` that acts on the new velocity
  JointTorque<N, T> coriolis;     ///< C_v v, the Coriolis torque of the virtual robot [N m]
};

namespace detail {
struct NoWeight {
  template <Real T>
  static T weight(const T&, const T&) noexcept {
    return T(0);
  }
};
}  // namespace detail

/// At the point `X_LT` of link `L` the virtual robot feels like the mass `Lambda` with the friction `D`:
/// `Lambda dx'' + D dx' = F`, in every direction of translation (`Rows` 3) or of translation and rotation (6,
/// linear first), along the axes of the base. Joint motions that do not move the tool keep their joint-space
/// inertia.
///
///     M_v    = J' Lambda J + M_rest
///     B_v    = J' D J + rest_decay M_rest       (plus the joints' viscous friction, which is felt as well)
///     M_rest = M_0 - J' (J M_0^-1 J')^-1 J,     M_0 = M + diag(inertia)
///
/// M_rest has no effect on the tool (dynamically consistent). Its Coriolis torque is
/// `M_rest M_0^-1 C v + J' Lambda dJ v`: a free tool with the same mass in all directions moves in a straight
/// line.
///
/// **Singularities.** In a direction in which the tool hardly moves, `J' Lambda J` is almost zero: to feel as
/// configured, the joints would need extreme speeds. Each direction has a ratio rho of the configured mass to
/// the mass that M_0 has at the tool. The shaped ratio is `rho + 1/(1 + (rho/a)^2)`,
/// `a = (min_mass_ratio/1.8)^1.5`: as configured to 5 % for rho >= 1.5 `min_mass_ratio`, never less than
/// `min_mass_ratio`, and smoothly 1, the joint-space inertia, where the tool cannot move at all. So M_v is
/// positive definite and smooth everywhere, without a branch: `Re (rho + i a)^-1` in one elimination.
///
/// A law with a model of the masses (`Y_r Theta`) uses M, not M_v: the shape is for reactive laws and for
/// springs. The matrices are constant in base axes: a rotational inertia has no gyroscopic torque.
template <std::size_t L, std::size_t Rows = 6, Real T = double>
class ToolShape {
  static_assert(Rows == 3 || Rows == 6, "translation (3), or translation and rotation (6)");

 public:
  using RobotPart = detail::ToolShapePart;
  static constexpr std::size_t link = L;
  static constexpr std::size_t rows = Rows;
  using Matrix = std::array<std::array<T, Rows>, Rows>;
  struct Settings {
    Transform<Link<L>, Tool, T> X_LT = {};  ///< pose of the tool on the link
    Matrix mass = {};                       ///< Lambda: symmetric, positive definite [kg], [kg m^2]
    Matrix damping = {};                    ///< D: symmetric, positive semi-definite [N s/m], [N m s/rad]
    T rest_decay = T(4);                    ///< decay of joint motion that does not move the tool [1/s], >= 0
    T min_mass_ratio = T(0.15);             ///< minimum ratio of M_v to M_0 in any direction, 0.01 to 0.3
  };

  /// The diagonal matrix of `values`, for `Settings`.
  [[nodiscard]] static Matrix diagonal(const std::array<T, Rows>& values) noexcept {
    Matrix m{};
    for (std::size_t i = 0; i < Rows; ++i) m[i][i] = values[i];
    return m;
  }

  /// Throws `ConfigurationError` for a number out of its range, a matrix that is not symmetric or not
  /// positive.
  SKINCTL_COLD explicit ToolShape(const Settings& s) : s_(s) {
    using std::pow;
    const auto number = [](const T& x) { return static_cast<double>(x); };
    for (std::size_t i = 0; i < Rows; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        require(s.mass[i][j] == s.mass[j][i] && s.mass[i][j] <= T(1e6) && s.mass[i][j] >= T(-1e6),
                "mass at the tool", number(s.mass[i][j]), "a symmetric matrix, up to 1e6 kg");
        require(s.damping[i][j] == s.damping[j][i] && s.damping[i][j] <= T(1e6) && s.damping[i][j] >= T(-1e6),
                "damping at the tool", number(s.damping[i][j]), "a symmetric matrix, up to 1e6 N s/m");
      }
    require(s.rest_decay >= T(0) && s.rest_decay <= T(1e4), "decay of the rest", number(s.rest_decay),
            "0 to 1e4 1/s");
    require(s.min_mass_ratio >= T(0.01) && s.min_mass_ratio <= T(0.3), "min_mass_ratio",
            number(s.min_mass_ratio), "0.01 to 0.3");
    a_ = T(pow(s.min_mass_ratio / T(1.8), T(1.5)));
    require(factorise(s.mass, root_), "mass at the tool", number(s.mass[0][0]), "a positive definite matrix");
    Matrix above = s.damping, unused;
    T size(0);
    for (std::size_t i = 0; i < Rows; ++i) size = size + (s.damping[i][i] < T(0) ? T(0) : s.damping[i][i]);
    for (std::size_t i = 0; i < Rows; ++i) above[i][i] = above[i][i] + T(1e-5) * (size + T(1e-6));
    require(factorise(above, unused), "damping at the tool", number(s.damping[0][0]),
            "a positive semi-definite matrix");
    fastest_ = fastest();
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// The terms at the pose of `angles` and the velocity `v`, for the joint inertia `m0` and the torque
  /// `coriolis` = C v. False if `m0` could not be factorised: then nothing is written.
  ///
  /// @param h  length of the sub-step [s].
  /// @tparam Policy  the integration of friction over the sub-step.
  /// @tparam S       the joints of the virtual robot, which move the tool alone; `v` is that of all joints.
  template <class Policy, class S, class M, class Angles>
  [[nodiscard]] SKINCTL_NOINLINE bool terms(const M& model, const Angles& angles,
                                            const JointVelocity<M::joints, T>& v,
                                            const MassMatrix<S::count, T>& m0,
                                            const JointTorque<S::count, T>& coriolis, const T& h,
                                            ToolTerms<S::count, Rows, T>& out) const noexcept {
    static_assert(
        (ancestors<M>(L) & ~S::set) == 0,
        "ToolShape: on a link that no joint by torque moves; such a joint has the robot's own inertia");
    constexpr std::size_t N = S::count;
    const math::detail::OneSystem<N, T> factors(m0.data);
    if (!factors.positive_definite()) return false;
    using Joints = detail::Row<N, T>;    // over the joints
    using Space = detail::Row<Rows, T>;  // over the tool's directions
    const Poses<M, ancestors<M>(L), T> poses(model, angles);
    const auto jacobian_of_tool = jacobian<L>(poses, s_.X_LT);
    T columns[N][6] = {};
    jacobian_of_tool.for_each([&](auto i, const auto& c) SKINCTL_INLINE_LAMBDA {
      T(&to)[6] = columns[S::place(i.value)];
      to[0] = c.linear.x, to[1] = c.linear.y, to[2] = c.linear.z;
      to[3] = c.angular.x, to[4] = c.angular.y, to[5] = c.angular.z;
    });
    const auto bias = bias_acceleration(jacobian_of_tool, v);
    const T dJv[6] = {bias.linear.x,  bias.linear.y,  bias.linear.z,
                      bias.angular.x, bias.angular.y, bias.angular.z};
    const auto sum = [](auto count, auto&& term) SKINCTL_INLINE_LAMBDA {
      auto total = term(std::integral_constant<std::size_t, 0>{});
      detail::unrolled<count - 1>([&](auto k) SKINCTL_INLINE_LAMBDA {
        total = total + term(std::integral_constant<std::size_t, k + 1>{});
      });
      return total;
    };
    constexpr std::integral_constant<std::size_t, N> all_joints{};
    constexpr std::integral_constant<std::size_t, Rows> all_rows{};
    const auto rows_of = [](const Matrix& m, Space(&to)[Rows]) SKINCTL_INLINE_LAMBDA {
      detail::unrolled<Rows>([&](auto k) SKINCTL_INLINE_LAMBDA { to[k] = Space(m[k].data()); });
    };

    // W = S' J, whose mobility W M_0^-1 W' has the ratios rho as eigenvalues: by columns, one per joint.
    Space root[Rows], W[N], moved[N], mobility[Rows], Z[Rows];
    rows_of(root_, root);
    detail::for_each_of_few<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      W[i] = sum(all_rows, [&](auto p) SKINCTL_INLINE_LAMBDA { return columns[i][p] * root[p]; });
    });
    factors.solve(W, moved);
    detail::unrolled<Rows>([&](auto k) SKINCTL_INLINE_LAMBDA {
      mobility[k] = sum(all_joints, [&](auto i) SKINCTL_INLINE_LAMBDA { return W[i][k] * moved[i]; });
    });
    detail::real_of_inverse(mobility, a_, Z);

    // M_rest = M_0 - W' Z W, and the matrix that includes its friction.
    const T rate = s_.rest_decay, rest_weight = Policy::weight(T(h * rate), T(1)) * h * rate;
    const T weight = h * Policy::weight(T(h * fastest_), T(1));
    Joints J[Rows], WJ[Rows];  // rows of J and of W
    Space mass[Rows], damping[Rows];
    rows_of(s_.mass, mass), rows_of(s_.damping, damping);
    detail::unrolled<Rows>([&](auto k) SKINCTL_INLINE_LAMBDA {
      J[k] = Joints::of([&](auto i) SKINCTL_INLINE_LAMBDA { return columns[i][k]; });
      WJ[k] = Joints::of([&](auto i) SKINCTL_INLINE_LAMBDA { return W[i][k]; });
      J[k].store(out.J[k]);
    });
    const JointTorque<N, T> torque = coriolis;
    JointAcceleration<N, T> own;
    factors.solve(torque.data, own.data);
    Joints total = sum(all_rows, [&](auto k) SKINCTL_INLINE_LAMBDA {
      T force(0);
      for (std::size_t l = 0; l < Rows; ++l) force = force + s_.mass[k][l] * dJv[l];
      return force * J[k];
    });
    detail::for_each_of_few<N>([&](std::size_t i) SKINCTL_INLINE_LAMBDA {
      const auto times = [&](const auto& of, const auto& x) SKINCTL_INLINE_LAMBDA {
        return sum(all_rows, [&](auto l) SKINCTL_INLINE_LAMBDA { return x(l) * of[l]; });
      };
      const auto of_W = [&](auto l) SKINCTL_INLINE_LAMBDA { return W[i][l]; };
      const auto of_J = [&](auto l) SKINCTL_INLINE_LAMBDA { return columns[i][l]; };
      const Space ZW = times(Z, of_W), LJ = times(mass, of_J), DJ = times(damping, of_J);
      const Joints rest =
          Joints(m0.data + i * N) - times(WJ, [&](auto k) SKINCTL_INLINE_LAMBDA { return ZW[k]; });
      const Joints felt = times(J, [&](auto k) SKINCTL_INLINE_LAMBDA { return LJ[k]; });
      const Joints damped = times(J, [&](auto k) SKINCTL_INLINE_LAMBDA { return DJ[k]; });
      rest.store(out.rest.data + i * N);
      (rest + felt).store(out.mass.data + i * N);
      (damped + rate * rest).store(out.friction.data + i * N);
      (weight * damped + rest_weight * rest).store(out.implicit.data + i * N);
      total = total + own[i] * rest;
    });
    total.store(out.coriolis);
    return true;
  }
  /// The terms at `q` and at rest, for inspection; `inertia` is the virtual inertia of the joints. Zeros if
  /// the mass matrix could not be factorised.
  template <class M, std::size_t N>
  [[nodiscard]] SKINCTL_COLD ToolTerms<N, Rows, T> at(const M& model, const JointPosition<N, T>& q,
                                                      const JointTorque<N, T>& inertia = {}) const noexcept {
    const JointAngles<M, T> angles(model, q);
    MassMatrix<N, T> m = mass_matrix(model, angles);
    for (std::size_t i = 0; i < N; ++i) m(i, i) = m(i, i) + inertia[i];
    ToolTerms<N, Rows, T> out;
    if (terms<detail::NoWeight, AllJoints<N>>(model, angles, JointVelocity<N, T>{}, m, JointTorque<N, T>{},
                                              T(0), out))
      return out;
    for (auto& row : out.J)
      for (T& x : row) x = T(0);
    out.mass = out.rest = out.friction = out.implicit = MassMatrix<N, T>();
    return out;
  }

 private:
  /// `S S' = m`, S lower triangular. False if m is not positive definite.
  static bool factorise(const Matrix& m, Matrix& S) noexcept {
    using std::sqrt;
    S = {};
    for (std::size_t j = 0; j < Rows; ++j) {
      T d = m[j][j];
      for (std::size_t p = 0; p < j; ++p) d = d - S[j][p] * S[j][p];
      if (!(d > T(8) * std::numeric_limits<T>::epsilon() * m[j][j])) return false;
      S[j][j] = sqrt(d);
      for (std::size_t i = j + 1; i < Rows; ++i) {
        T s = m[i][j];
        for (std::size_t p = 0; p < j; ++p) s = s - S[i][p] * S[j][p];
        S[i][j] = s / S[j][j];
      }
    }
    return true;
  }
  /// The largest eigenvalue of `Lambda^-1 D` [1/s], by iteration.
  [[nodiscard]] SKINCTL_COLD T fastest() const noexcept {
    std::array<T, Rows> x;
    for (std::size_t i = 0; i < Rows; ++i) x[i] = T(1) + T(0.1) * T(static_cast<int>(i));
    T rate(0);
    for (int n = 0; n < 200; ++n) {
      std::array<T, Rows> y{};
      for (std::size_t i = 0; i < Rows; ++i)
        for (std::size_t j = 0; j < Rows; ++j) y[i] = y[i] + s_.damping[i][j] * x[j];
      for (std::size_t i = 0; i < Rows; ++i) {
        for (std::size_t p = 0; p < i; ++p) y[i] = y[i] - root_[i][p] * y[p];
        y[i] = y[i] / root_[i][i];
      }
      for (std::size_t i = Rows; i-- > 0;) {
        for (std::size_t p = i + 1; p < Rows; ++p) y[i] = y[i] - root_[p][i] * y[p];
        y[i] = y[i] / root_[i][i];
      }
      rate = T(0);
      for (const T& c : y) rate = (c < T(0) ? T(-c) : c) > rate ? (c < T(0) ? T(-c) : c) : rate;
      if (!(rate > T(0))) return T(0);
      for (std::size_t i = 0; i < Rows; ++i) x[i] = y[i] / rate;
    }
    return rate;
  }

  Settings s_;
  Matrix root_;       ///< root S of the mass, `S S' = Lambda`
  T a_ = T(0);        ///< mass ratio rho below which the joint-space inertia takes over
  T fastest_ = T(0);  ///< largest decay rate by the friction, of `Lambda^-1 D` [1/s]
};

SKINCTL_END_NAMESPACE
