// Operational-space shaping: a given mass and friction of the virtual robot at its tool.
#pragma once

#include <array>
#include <cmath>

#include "skinctl/core/detail/real_of_inverse.hpp"
#include "skinctl/core/joint_subset.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/kinematics/jacobian_rate.hpp"
#include "skinctl/math/ldlt.hpp"
#include "skinctl/robot/robot_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// No tool shape: the virtual robot has its model's inertia plus the virtual inertia of the joints.
struct NoToolShape {};

/// The terms of a shaped virtual robot at one pose.
template <std::size_t N, std::size_t Rows, Real T>
struct ToolTerms {
  T J[Rows][N] = {};           ///< Jacobian of the tool, base axes
  MassMatrix<N, T> mass;       ///< M_v
  MassMatrix<N, T> rest;       ///< M_rest, the part of M_v without effect on the tool
  MassMatrix<N, T> friction;   ///< J' D J + rest_decay M_rest
  MassMatrix<N, T> implicit;   ///< h times the share of `friction` that acts on the new velocity
  JointTorque<N, T> coriolis;  ///< C_v v
};

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
/// `a = (lightest/1.8)^1.5`: as configured to 5 % for rho >= 1.5 `lightest`, never less than `lightest`, and
/// smoothly 1, the joint-space inertia, where the tool cannot move at all. So M_v is positive definite and
/// smooth everywhere, without a branch: `Re (rho + i a)^-1` in one elimination.
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
    T lightest = T(0.15);                   ///< minimum ratio of M_v to M_0 in any direction, 0.01 to 0.3
  };

  /// The diagonal matrix of these numbers.
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
    require(s.lightest >= T(0.01) && s.lightest <= T(0.3), "lightest", number(s.lightest), "0.01 to 0.3");
    a_ = T(pow(s.lightest / T(1.8), T(1.5)));
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
  /// `coriolis` = C v. False if `m0` could not be factorised.
  ///
  /// @param h  length of the sub-step [s].
  /// @tparam Policy  the integration of friction over the sub-step.
  /// @tparam S       the joints of the virtual robot, which move the tool alone; `v` is that of all joints.
  template <class Policy, class S, class M, class Angles>
  [[nodiscard]] SKINCTL_NOINLINE bool terms(const M& model, const Angles& angles,
                                            const JointVelocity<M::joints, T>& v,
                                            const MassMatrix<S::count, T>& m0,
                                            const JointTorque<S::count, T>& coriolis, const T& h,
                                            ToolTerms<S::count, Rows, T>& out) const noexcept;
  /// M_v and the friction matrix at `q`, for inspection; `inertia` is the virtual inertia of the joints.
  template <class M, std::size_t N>
  [[nodiscard]] SKINCTL_COLD ToolTerms<N, Rows, T> at(const M& model, const JointPosition<N, T>& q,
                                                      const JointTorque<N, T>& inertia = {}) const noexcept;

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
  Matrix root_;       ///< S, `S S' = Lambda`
  T a_ = T(0);        ///< ratio at which the joint-space inertia takes over
  T fastest_ = T(0);  ///< rate of the friction [1/s]
};

SKINCTL_END_NAMESPACE

#include "skinctl/robot/detail/tool_terms.hpp"
