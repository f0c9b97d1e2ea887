// The floor under laws of the UR5's tool: their equations written out by hand in plain doubles, with the tool
// 0.15 m along the flange's axis and everything that a law does besides them (goals, ramps, limits,
// singularities) left out.
#pragma once

#include <cmath>

#include "bench/studies/floor/ur5_floor.hpp"

namespace bench_floor::ur5 {
namespace detail {

inline constexpr double tool = 0.15;  // from link 6 along its axis

BENCH_FLOOR_INLINE double dot3(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
BENCH_FLOOR_INLINE void cross3(const double* a, const double* b, double* r) {
  r[0] = a[1] * b[2] - a[2] * b[1], r[1] = a[2] * b[0] - a[0] * b[2], r[2] = a[0] * b[1] - a[1] * b[0];
}

/// Pose of the tool, X (axes, origin), and its Jacobian, 6 columns of 6.
BENCH_FLOOR_INLINE void tool_at(const double* q, double* X, double* J) {
  double links[72], of_flange[36];
  floor_fk_jacobian(q, links, of_flange);
  for (int i = 0; i < 12; ++i) X[i] = links[60 + i];
  double arm[3];
  for (int i = 0; i < 3; ++i) X[9 + i] += tool * X[6 + i], arm[i] = (tool - d6) * X[6 + i];
  for (int k = 0; k < 6; ++k) {
    double more[3];
    cross3(of_flange + 6 * k + 3, arm, more);
    for (int i = 0; i < 3; ++i)
      J[6 * k + i] = of_flange[6 * k + i] + more[i], J[6 * k + 3 + i] = of_flange[6 * k + 3 + i];
  }
}

/// `J^-1` by the inverse of the wrist's axes and of its complement.
struct ToolInverse {
  const double* J;
  double r[9], e[9], p[9];
  BENCH_FLOOR_INLINE explicit ToolInverse(const double* jacobian) : J(jacobian) {
    invert(J + 21, J + 27, J + 33, r);
    double s[9];
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) e[3 * k + i] = dot3(r + 3 * i, J + 6 * k + 3);
      for (int i = 0; i < 3; ++i)
        s[3 * k + i] =
            J[6 * k + i] - e[3 * k] * J[18 + i] - e[3 * k + 1] * J[24 + i] - e[3 * k + 2] * J[30 + i];
    }
    invert(s, s + 3, s + 6, p);
  }
  BENCH_FLOOR_INLINE static void invert(const double* a, const double* b, const double* c, double* m) {
    cross3(b, c, m), cross3(c, a, m + 3), cross3(a, b, m + 6);
    const double per = 1 / dot3(a, m);
    for (int i = 0; i < 9; ++i) m[i] *= per;
  }
  BENCH_FLOOR_INLINE void solve(const double* v, double* x) const {
    double y[3], d[3];
    for (int i = 0; i < 3; ++i) d[i] = dot3(r + 3 * i, v + 3);
    for (int i = 0; i < 3; ++i) y[i] = v[i] - d[0] * J[18 + i] - d[1] * J[24 + i] - d[2] * J[30 + i];
    for (int i = 0; i < 3; ++i) x[i] = dot3(p + 3 * i, y);
    for (int i = 0; i < 3; ++i) x[3 + i] = d[i] - x[0] * e[i] - x[1] * e[3 + i] - x[2] * e[6 + i];
  }
};

struct ToolReference {
  double dq_r[6], ddq_r[6], S[6], sign[6];
};

/// Eqs. (15)-(21) at a target that stands still, with the gains of `tracking_by_hand`.
BENCH_FLOOR_INLINE void reference(const double* q, const double* dq, const double* target,
                                  const double* sum_S, const double* sum_sign, ToolReference& out) {
  double X[12], J[36], V[6] = {}, E[9], e[6], dx_r[6], a[6];
  tool_at(q, X, J);
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i) V[i] += J[6 * k + i] * dq[k];
  // R R_d', its rotation vector by the half angle's tangent and atan.
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      E[3 * i + j] = X[i] * target[j] + X[3 + i] * target[3 + j] + X[6 + i] * target[6 + j];
  const double odd[3] = {E[7] - E[5], E[2] - E[6], E[3] - E[1]}, w = 1 + E[0] + E[4] + E[8];
  const double square = dot3(odd, odd), t = std::sqrt(square) / w;
  const double scale = t > 1e-9 ? 2 * std::atan(t) / (t * w) : 2 / w;
  for (int i = 0; i < 3; ++i) e[i] = X[9 + i] - target[9 + i], e[3 + i] = scale * odd[i];
  for (int i = 0; i < 6; ++i) {
    out.S[i] = V[i] + 5 * e[i];
    out.sign[i] = std::tanh(10 * out.S[i]);
    dx_r[i] = -5 * e[i] - sum_S[i] - 0.1 * sum_sign[i];
    a[i] = -5 * V[i] - out.S[i] - 0.1 * out.sign[i];
  }
  const ToolInverse inverse(J);
  inverse.solve(dx_r, out.dq_r);
  double outside[3] = {V[0], V[1], V[2]}, turn[3] = {};
  for (int k = 0; k < 6; ++k) {
    const double *l = J + 6 * k, *z = l + 3, v = out.dq_r[k];
    double x[3], y[3], u[3];
    cross3(turn, z, u);
    for (int i = 0; i < 3; ++i) a[3 + i] -= v * u[i], outside[i] -= dq[k] * l[i], turn[i] += dq[k] * z[i];
    cross3(turn, l, x), cross3(z, outside, y);
    for (int i = 0; i < 3; ++i) a[i] -= v * (x[i] + y[i]);
  }
  inverse.solve(a, out.ddq_r);
}

}  // namespace detail

/// Spline Operational at a fixed target: the reference now, once more at the middle of the interval, `Y_r
/// Theta - K_d S_q` there.
BENCH_FLOOR_INLINE void floor_operational(const double* q, const double* dq, const double* target, double dt,
                                          double* I1, double* I2, double* tau) {
  detail::ToolReference now, then;
  detail::reference(q, dq, target, I1, I2, now);
  double q_h[6], dq_h[6], ddq_r[6];
  for (int i = 0; i < 6; ++i) {
    const double a = now.ddq_r[i] - 25 * (dq[i] - now.dq_r[i]);
    q_h[i] = q[i] + 0.5 * dt * (dq[i] + 0.25 * dt * a), dq_h[i] = dq[i] + 0.5 * dt * a;
  }
  detail::reference(q_h, dq_h, target, I1, I2, then);
  for (int i = 0; i < 6; ++i) ddq_r[i] = then.ddq_r[i] - 25 * (dq_h[i] - then.dq_r[i]);
  floor_yr_theta(q_h, dq_h, then.dq_r, ddq_r, tau);
  for (int i = 0; i < 6; ++i) I1[i] += dt * now.S[i], I2[i] += dt * now.sign[i];
}

/// The force at the tool along z that is equivalent to the torques of the skin: `(J^-1 z)' tau`.
BENCH_FLOOR_INLINE double floor_tool_force(const double* q, const double* tau) {
  double X[12], J[36], x[6];
  detail::tool_at(q, X, J);
  const double z[6] = {0, 0, 1, 0, 0, 0};
  detail::ToolInverse(J).solve(z, x);
  double sum = 0;
  for (int i = 0; i < 6; ++i) sum += x[i] * tau[i];
  return sum;
}

/// One step of a robot with `mass` and `damping` at its tool (diagonals): `M_rest = M - J' G J` with `G = L
/// Re (L J M^-1 J' L + i a)^-1 L`, L the root of the mass; then `(M_rest + J'(mass + dt damping) J) dv = dt
/// (tau - C v - G)`.
BENCH_FLOOR_INLINE void floor_tool_shape(const double* q, const double* dq, const double* tau,
                                         const double* mass, const double* damping, double a, double dt,
                                         double* dv) {
  double X[12], J[36], M[36], bias[6], W[36], C[36], re[36], im[36] = {};
  constexpr double zero[6] = {};
  detail::tool_at(q, X, J);
  floor_mass_matrix(q, M);
  floor_inverse_dynamics(q, dq, zero, bias);
  double root[6];
  for (int k = 0; k < 6; ++k) root[k] = std::sqrt(mass[k]);
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) W[6 * i + k] = C[6 * i + k] = root[k] * J[6 * i + k];
  // M^-1 W' for all rows at once.
  double A[36];
  for (int i = 0; i < 36; ++i) A[i] = M[i];
  for (int k = 0; k < 6; ++k) {
    const double per = 1 / A[7 * k];
    for (int i = k + 1; i < 6; ++i) {
      const double f = A[6 * i + k] * per;
      for (int j = k + 1; j < 6; ++j) A[6 * i + j] -= f * A[6 * k + j];
      for (int j = 0; j < 6; ++j) C[6 * i + j] -= f * C[6 * k + j];
    }
  }
  for (int k = 6; k-- > 0;) {
    for (int i = k + 1; i < 6; ++i)
      for (int j = 0; j < 6; ++j) C[6 * k + j] -= A[6 * k + i] * C[6 * i + j];
    const double per = 1 / A[7 * k];
    for (int j = 0; j < 6; ++j) C[6 * k + j] *= per;
  }
  for (int k = 0; k < 6; ++k) {
    for (int l = 0; l < 6; ++l) {
      re[6 * k + l] = 0;
      for (int i = 0; i < 6; ++i) re[6 * k + l] += W[6 * i + k] * C[6 * i + l];
    }
    im[7 * k] = a;
  }
  for (int k = 0; k < 6; ++k) {
    const double x = re[7 * k], y = im[7 * k], per = 1 / (x * x + y * y), p = x * per, s = -y * per;
    double u[6], v[6];
    for (int j = 0; j < 6; ++j)
      u[j] = p * re[6 * k + j] - s * im[6 * k + j], v[j] = p * im[6 * k + j] + s * re[6 * k + j];
    u[k] = -p, v[k] = -s;
    for (int i = 0; i < 6; ++i) {
      if (i == k) continue;
      const double f = re[6 * i + k], h = im[6 * i + k];
      re[6 * i + k] = im[6 * i + k] = 0;
      for (int j = 0; j < 6; ++j) re[6 * i + j] -= f * u[j] - h * v[j], im[6 * i + j] -= f * v[j] + h * u[j];
    }
    for (int j = 0; j < 6; ++j) re[6 * k + j] = u[j], im[6 * k + j] = v[j];
  }
  // M_v + dt B_v
  for (int i = 0; i < 6; ++i) {
    double z[6] = {};
    for (int l = 0; l < 6; ++l)
      for (int k = 0; k < 6; ++k) z[k] += re[6 * l + k] * W[6 * i + l];
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k)
        M[6 * i + j] += W[6 * j + k] * z[k] + (mass[k] + dt * damping[k]) * J[6 * i + k] * J[6 * j + k];
    dv[i] = dt * (tau[i] - bias[i]);
  }
  for (int k = 0; k < 6; ++k) {
    const double per = 1 / M[7 * k];
    for (int i = k + 1; i < 6; ++i) {
      const double f = M[6 * i + k] * per;
      for (int j = k + 1; j < 6; ++j) M[6 * i + j] -= f * M[6 * k + j];
      dv[i] -= f * dv[k];
    }
  }
  for (int k = 6; k-- > 0;) {
    for (int j = k + 1; j < 6; ++j) dv[k] -= M[6 * k + j] * dv[j];
    dv[k] /= M[7 * k];
  }
}

}  // namespace bench_floor::ur5
