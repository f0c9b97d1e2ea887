// Kinematics and dynamics of a robot table by definition: products of poses, sums of energies, difference
// quotients. Slow on purpose; made for 50-digit numbers, where the quotients are exact to more than 30
// digits.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "tests/support/robot_table.hpp"

namespace oracle {

/// Vectors are std::vector<T>, matrices row-major std::vector<T>. Joints as in the table, bodies by their
/// index.
///
/// Exact up to rounding: poses, Jacobians, mass matrix, gravity torque, energies. By central difference
/// quotients of step h = eps^(1/3), relative error about h^2 (2e-34 with 50 digits, 1e-10 in double):
/// Christoffel's C and what contains it.
template <class T>
class EulerLagrange {
 public:
  using Vec3 = std::array<T, 3>;
  using Mat3 = std::array<T, 9>;
  using In = std::span<const T>;
  struct Pose {
    Mat3 R;
    Vec3 p;
  };

  explicit EulerLagrange(BasicRobot<T> robot)
      : robot_(std::move(robot)), joints_(robot_.joints()), n_(size(robot_.joint_count())) {}
  explicit EulerLagrange(const Robot& robot)
    requires(!std::is_same_v<T, double>)
      : EulerLagrange(exact<T>(robot)) {}

  [[nodiscard]] const BasicRobot<T>& robot() const { return robot_; }
  [[nodiscard]] std::size_t joint_count() const { return n_; }

  /// Poses of all bodies in the base frame.
  [[nodiscard]] std::vector<Pose> poses(In q) const {
    std::vector<Pose> X;
    for (int i = 0; i < robot_.body_count(); ++i) {
      const BasicBody<T>& b = robot_.body(i);
      Pose pose{b.R, b.p};
      if (b.parent >= 0) {
        const Pose& up = X[size(b.parent)];
        pose = {table_detail::product(up.R, b.R), sum(up.p, table_detail::product(up.R, b.p))};
      }
      if (b.motion == Motion::revolute) {
        using std::cos, std::sin;
        const T s = sin(q[joint(i)]), c = cos(q[joint(i)]);
        pose.R = table_detail::product(pose.R, Mat3{c, -s, T(0), s, c, T(0), T(0), T(0), T(1)});
      } else if (b.motion == Motion::prismatic) {
        for (std::size_t k = 0; k < 3; ++k) pose.p[k] += pose.R[3 * k + 2] * q[joint(i)];
      }
      X.push_back(pose);
    }
    return X;
  }

  [[nodiscard]] Pose pose(int body, In q) const { return poses(q)[size(body)]; }

  /// Velocity of a point given in the body's frame, and of the body: 6 x n, base axes, linear rows first.
  [[nodiscard]] std::vector<T> jacobian(int body, const Vec3& point, In q) const {
    return jacobian(poses(q), body, point);
  }
  /// The same where `poses(q)` are known already.
  [[nodiscard]] std::vector<T> jacobian(const std::vector<Pose>& X, int body, const Vec3& point) const {
    std::vector<T> J(6 * n_, T(0));
    const Vec3 x = sum(X[size(body)].p, table_detail::product(X[size(body)].R, point));
    for (int i = body; i >= 0; i = robot_.body(i).parent) {
      if (robot_.body(i).motion == Motion::fixed) continue;
      const Pose& pose = X[size(i)];
      const std::size_t c = joint(i);
      const Vec3 z{pose.R[2], pose.R[5], pose.R[8]};
      if (robot_.body(i).motion == Motion::prismatic) {
        for (std::size_t k = 0; k < 3; ++k) J[k * n_ + c] = z[k];
        continue;
      }
      const Vec3 d{x[0] - pose.p[0], x[1] - pose.p[1], x[2] - pose.p[2]};
      J[c] = z[1] * d[2] - z[2] * d[1];
      J[n_ + c] = z[2] * d[0] - z[0] * d[2];
      J[2 * n_ + c] = z[0] * d[1] - z[1] * d[0];
      for (std::size_t k = 0; k < 3; ++k) J[(3 + k) * n_ + c] = z[k];
    }
    return J;
  }

  /// sum over bodies of m Jv'Jv + Jw' I Jw, n x n.
  [[nodiscard]] std::vector<T> mass_matrix(In q) const {
    std::vector<T> M(n_ * n_, T(0));
    const std::vector<Pose> X = poses(q);
    for (int i = 0; i < robot_.body_count(); ++i) {
      const BasicBody<T>& b = robot_.body(i);
      const std::vector<T> J = jacobian(X, i, b.com);
      const std::vector<std::size_t> on = path(i);
      const Mat3 I = inertia_in_base(X, i);
      for (std::size_t c : on) {
        const Vec3 Iw = table_detail::product(I, Vec3{J[3 * n_ + c], J[4 * n_ + c], J[5 * n_ + c]});
        for (std::size_t r : on)
          for (std::size_t k = 0; k < 3; ++k)
            M[r * n_ + c] += b.mass * J[k * n_ + r] * J[k * n_ + c] + J[(3 + k) * n_ + r] * Iw[k];
      }
    }
    return M;
  }

  /// Torque that holds the robot: dV/dq = - sum m Jv' g.
  [[nodiscard]] std::vector<T> gravity(In q) const {
    std::vector<T> G(n_, T(0));
    const std::vector<Pose> X = poses(q);
    for (int i = 0; i < robot_.body_count(); ++i) {
      const std::vector<T> J = jacobian(X, i, robot_.body(i).com);
      for (std::size_t c : path(i))
        for (std::size_t k = 0; k < 3; ++k) G[c] -= robot_.body(i).mass * J[k * n_ + c] * robot_.gravity[k];
    }
    return G;
  }

  /// - sum m g . x_com: zero where all centres of mass are at the base's origin [J].
  [[nodiscard]] T potential_energy(In q) const {
    T V(0);
    const std::vector<Pose> X = poses(q);
    for (int i = 0; i < robot_.body_count(); ++i) {
      const BasicBody<T>& b = robot_.body(i);
      const Vec3 x = sum(X[size(i)].p, table_detail::product(X[size(i)].R, b.com));
      for (std::size_t k = 0; k < 3; ++k) V -= b.mass * robot_.gravity[k] * x[k];
    }
    return V;
  }

  /// dq' M dq / 2 [J].
  [[nodiscard]] T kinetic_energy(In q, In dq) const { return kinetic_form(q, dq, dq) / T(2); }

  /// Christoffel's C(q, dq), n x n: C_ij = sum_k (dM_ij/dq_k + dM_ik/dq_j - dM_jk/dq_i) dq_k / 2. 2n mass
  /// matrices.
  [[nodiscard]] std::vector<T> christoffel_matrix(In q, In dq) const {
    std::vector<std::vector<T>> dM;
    for (std::size_t k = 0; k < n_; ++k)
      dM.push_back(quotient([&](In at) { return mass_matrix(at); }, q, unit(k)));
    std::vector<T> C(n_ * n_, T(0));
    for (std::size_t i = 0; i < n_; ++i)
      for (std::size_t j = 0; j < n_; ++j)
        for (std::size_t k = 0; k < n_; ++k)
          C[i * n_ + j] += (dM[k][i * n_ + j] + dM[j][i * n_ + k] - dM[i][j * n_ + k]) * dq[k] / T(2);
    return C;
  }

  /// C(q, dq) dq_r without the matrix: half of d/dt(M dq_r) along dq + d/dt(M dq) along dq_r - grad(dq' M
  /// dq_r). For long chains: n evaluations of a scalar instead of 2n mass matrices.
  [[nodiscard]] std::vector<T> coriolis(In q, In dq, In dq_r) const {
    const std::vector<T> a = quotient([&](In at) { return product(mass_matrix(at), dq_r); }, q, dq);
    const std::vector<T> b = quotient([&](In at) { return product(mass_matrix(at), dq); }, q, dq_r);
    std::vector<T> result(n_);
    for (std::size_t i = 0; i < n_; ++i) {
      const auto form = [&](In at) { return std::vector<T>{kinetic_form(at, dq, dq_r)}; };
      result[i] = (a[i] + b[i] - quotient(form, q, unit(i))[0]) / T(2);
    }
    return result;
  }

  /// dM/dt along dq, n x n.
  [[nodiscard]] std::vector<T> mass_matrix_rate(In q, In dq) const {
    return quotient([&](In at) { return mass_matrix(at); }, q, dq);
  }

  /// dJ/dt along dq of the point's Jacobian, 6 x n.
  [[nodiscard]] std::vector<T> jacobian_rate(int body, const Vec3& point, In q, In dq) const {
    return quotient([&](In at) { return jacobian(body, point, at); }, q, dq);
  }

  /// -dV/dq by difference quotients: checks `gravity`.
  [[nodiscard]] std::vector<T> gravity_by_difference(In q) const {
    std::vector<T> G(n_);
    for (std::size_t i = 0; i < n_; ++i)
      G[i] = quotient([&](In at) { return std::vector<T>{potential_energy(at)}; }, q, unit(i))[0];
    return G;
  }

  /// Y_r Theta = M ddq_r + C(q, dq) dq_r + G.
  [[nodiscard]] std::vector<T> yr_theta(In q, In dq, In dq_r, In ddq_r) const {
    std::vector<T> tau = product(mass_matrix(q), ddq_r);
    const std::vector<T> Cv = coriolis(q, dq, dq_r), G = gravity(q);
    for (std::size_t i = 0; i < n_; ++i) tau[i] += Cv[i] + G[i];
    return tau;
  }

  /// M ddq + C dq + G.
  [[nodiscard]] std::vector<T> inverse_dynamics(In q, In dq, In ddq) const {
    return yr_theta(q, dq, dq, ddq);
  }

  /// The same by D'Alembert's principle, exact up to rounding: every body's rate of momentum, times its own
  /// Jacobian. `magnitude`, if given, receives per joint the sum of the magnitudes of the bodies' shares.
  [[nodiscard]] std::vector<T> dalembert(In q, In dq, In ddq, std::vector<T>* magnitude = nullptr) const {
    using table_detail::product;
    const std::vector<Pose> X = poses(q);
    std::vector<T> tau(n_, T(0));
    if (magnitude) *magnitude = tau;
    struct Moving {
      Vec3 w{}, alpha{}, a{};
    };
    std::vector<Moving> moving;
    for (int i = 0; i < robot_.body_count(); ++i) {
      const BasicBody<T>& b = robot_.body(i);
      Moving m;
      if (b.parent >= 0) {
        m = moving[size(b.parent)];
        const Vec3& up = X[size(b.parent)].p;
        const Vec3 r{X[size(i)].p[0] - up[0], X[size(i)].p[1] - up[1], X[size(i)].p[2] - up[2]};
        m.a = sum(m.a, sum(cross(m.alpha, r), cross(m.w, cross(m.w, r))));
      }
      const Vec3 z{X[size(i)].R[2], X[size(i)].R[5], X[size(i)].R[8]};
      if (b.motion == Motion::revolute) {
        const Vec3 turn = scaled(dq[joint(i)], z);
        m.alpha = sum(m.alpha, sum(scaled(ddq[joint(i)], z), cross(m.w, turn)));
        m.w = sum(m.w, turn);
      } else if (b.motion == Motion::prismatic) {
        m.a = sum(m.a, sum(scaled(ddq[joint(i)], z), scaled(T(2) * dq[joint(i)], cross(m.w, z))));
      }
      moving.push_back(m);
      const Vec3 c = product(X[size(i)].R, b.com);
      const Mat3 I = inertia_in_base(X, i);
      Vec3 f = sum(m.a, sum(cross(m.alpha, c), cross(m.w, cross(m.w, c))));
      for (std::size_t k = 0; k < 3; ++k) f[k] = b.mass * (f[k] - robot_.gravity[k]);
      const Vec3 n = sum(product(I, m.alpha), cross(m.w, product(I, m.w)));
      const std::vector<T> J = jacobian(X, i, b.com);
      for (std::size_t j : path(i)) {
        T share(0);
        for (std::size_t k = 0; k < 3; ++k) share += J[k * n_ + j] * f[k] + J[(3 + k) * n_ + j] * n[k];
        tau[j] += share;
        using std::abs;
        if (magnitude) (*magnitude)[j] += abs(share);
      }
    }
    return tau;
  }

  /// Acceleration under the torque tau: M ddq = tau - C dq - G, by Cholesky.
  [[nodiscard]] std::vector<T> forward_dynamics(In q, In dq, In tau) const {
    std::vector<T> x = dalembert(q, dq, std::vector<T>(n_, T(0)));
    for (std::size_t i = 0; i < n_; ++i) x[i] = tau[i] - x[i];
    return solved(mass_matrix(q), std::move(x));
  }

  /// The solution of L x = b for a symmetric positive definite matrix, by Cholesky.
  [[nodiscard]] static std::vector<T> solved(std::vector<T> L, std::vector<T> x) {
    const std::size_t n = x.size();
    for (std::size_t j = 0; j < n; ++j) {
      using std::sqrt;
      for (std::size_t k = 0; k < j; ++k) L[j * n + j] -= L[j * n + k] * L[j * n + k];
      L[j * n + j] = sqrt(L[j * n + j]);
      for (std::size_t i = j + 1; i < n; ++i) {
        for (std::size_t k = 0; k < j; ++k) L[i * n + j] -= L[i * n + k] * L[j * n + k];
        L[i * n + j] /= L[j * n + j];
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= L[i * n + k] * x[k];
      x[i] /= L[i * n + i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) x[i] -= L[k * n + i] * x[k];
      x[i] /= L[i * n + i];
    }
    return x;
  }

  /// Row-major A times x.
  [[nodiscard]] static std::vector<T> product(const std::vector<T>& A, In x) {
    std::vector<T> y(A.size() / x.size(), T(0));
    for (std::size_t i = 0; i < y.size(); ++i)
      for (std::size_t j = 0; j < x.size(); ++j) y[i] += A[i * x.size() + j] * x[j];
    return y;
  }

 private:
  static std::size_t size(int i) { return static_cast<std::size_t>(i); }
  std::size_t joint(int body) const { return size(joints_[size(body)]); }

  static Vec3 sum(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
  static Vec3 scaled(const T& s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
  static Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }

  /// Joints that move body i.
  std::vector<std::size_t> path(int i) const {
    std::vector<std::size_t> on;
    for (; i >= 0; i = robot_.body(i).parent)
      if (robot_.body(i).motion != Motion::fixed) on.push_back(joint(i));
    return on;
  }

  Mat3 inertia_in_base(const std::vector<Pose>& X, int i) const {
    const Mat3& R = X[size(i)].R;
    return table_detail::product(table_detail::product(R, robot_.body(i).inertia),
                                 table_detail::transposed(R));
  }

  /// a' M(q) b as the sum over bodies of m v_a . v_b + w_a . I w_b.
  T kinetic_form(In q, In a, In b) const {
    T sum(0);
    const std::vector<Pose> X = poses(q);
    for (int i = 0; i < robot_.body_count(); ++i) {
      const std::vector<T> J = jacobian(X, i, robot_.body(i).com);
      std::array<T, 6> va{}, vb{};
      for (std::size_t c : path(i))
        for (std::size_t k = 0; k < 6; ++k) va[k] += J[k * n_ + c] * a[c], vb[k] += J[k * n_ + c] * b[c];
      const Vec3 Iw = table_detail::product(inertia_in_base(X, i), Vec3{vb[3], vb[4], vb[5]});
      for (std::size_t k = 0; k < 3; ++k) sum += robot_.body(i).mass * va[k] * vb[k] + va[3 + k] * Iw[k];
    }
    return sum;
  }

  std::vector<T> unit(std::size_t k) const {
    std::vector<T> e(n_, T(0));
    e[k] = T(1);
    return e;
  }

  /// Derivative of f along `direction`. The step moves the fastest joint by eps^(1/3).
  template <class F>
  static std::vector<T> quotient(F&& f, In q, In direction) {
    using std::abs, std::cbrt;
    T fastest(0);
    for (const T& d : direction)
      if (abs(d) > fastest) fastest = abs(d);
    if (fastest == T(0)) return std::vector<T>(f(q).size(), T(0));
    static const T step = cbrt(std::numeric_limits<T>::epsilon());
    const T h = step / fastest;
    std::vector<T> ahead(q.begin(), q.end()), behind = ahead;
    for (std::size_t i = 0; i < ahead.size(); ++i)
      ahead[i] += h * direction[i], behind[i] -= h * direction[i];
    std::vector<T> difference = f(In(ahead));
    const std::vector<T> other = f(In(behind));
    for (std::size_t i = 0; i < difference.size(); ++i)
      difference[i] = (difference[i] - other[i]) / (T(2) * h);
    return difference;
  }

  BasicRobot<T> robot_;
  std::vector<int> joints_;
  std::size_t n_;
};

}  // namespace oracle
