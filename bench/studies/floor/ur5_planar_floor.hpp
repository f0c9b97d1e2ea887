// A lower floor under every UR5 number: what this one robot's geometry allows, in plain straight-line
// doubles.
#pragma once

#include "bench/studies/floor/floor.hpp"

/// Uses what holds for the UR5 and for few other robots: joints 2, 3 and 4 are parallel, so links 2 to 4 are
/// computed in one frame P that turns with joint 1 only (x outward, y up, z along the three axes), at the
/// sums of the angles; link 6 is symmetric about its axis, so its angle changes no torque, and links 5 and 6
/// are one rigid body plus a spin.
///
/// Frames as the maker's Denavit-Hartenberg frames right after Rz(q). Arrays must not overlap.
namespace bench_floor::ur5_planar {

// Lengths [m], masses [kg], centres of mass [m] of links 1 to 6: Universal Robots, "DH parameters for
// calculations of kinematics and dynamics"; inertias [kg m^2]: Universal_Robots_ROS2_Description,
// config/ur5/physical_parameters.yaml.
inline constexpr double d1 = 0.089159, a2 = -0.425, a3 = -0.39225, d4 = 0.10915, d5 = 0.09465, d6 = 0.0823;
inline constexpr double gravity_acceleration = 9.81;

namespace detail {
inline constexpr double m2 = 8.393, m3 = 2.33, m4 = 1.219, m5 = 1.219, m6 = 0.1879;
inline constexpr double c2x = a2 + 0.2125, c2z = 0.11336, c3x = a3 + 0.15, c3z = 0.0265;
inline constexpr double c4y = -0.01634, c4z = d4 - 0.0018, c5y = 0.01634, c5z = d5 - 0.0018,
                        c6 = d6 - 0.001159;
inline constexpr double I2x = 0.0151074, I2 = 0.13388583541666665, I3x = 0.004095, I3 = 0.031216803515624995;
inline constexpr double I4 = 0.002013889583333333, I4z = 0.0021942;
inline constexpr double I5 = 0.0018310395833333333, I5z = 0.0021942;
inline constexpr double I6 = 8.062475833333332e-05, I6z = 0.0001321171875;

/// Link 1 about the vertical.
inline constexpr double J1 = 0.01040625 + 3.7 * 0.00193 * 0.00193;
/// Link 2 about its joint: second moments S (integral of r r' dm).
inline constexpr double S2xx = I2 - I2x / 2 + m2 * c2x * c2x, S2yy = I2x / 2, S2zz = I2x / 2 + m2 * c2z * c2z;
inline constexpr double S2xz = m2 * c2x * c2z, S2xx_yy = S2xx - S2yy, S2yy_zz = S2yy + S2zz,
                        I2zz = S2xx + S2yy;
/// Link 3 about its centre of mass.
inline constexpr double S3xx_yy = I3 - I3x;
/// Links 5 and 6 as one body about the origin and in the axes of link 5, where link 6 points along y.
inline constexpr double m56 = m5 + m6, hy = m5 * c5y + m6 * c6, hz = m5 * c5z + m6 * d5;
inline constexpr double S6 = I6z / 2,
                        S6y = I6 - I6z / 2;  // link 6 across and along its axis, about its centre of mass
inline constexpr double Sxx = I5z / 2 + S6, Syy = I5z / 2 + m5 * c5y * c5y + S6y + m6 * c6 * c6;
inline constexpr double Szz = I5 - I5z / 2 + m5 * c5z * c5z + S6 + m6 * d5 * d5;
inline constexpr double Syz = m5 * c5y * c5z + m6 * c6 * d5;
inline constexpr double Sxx_yy = Sxx - Syy;

/// Sines and cosines of q2, q2 + q3, q2 + q3 + q4 and q5: all that torques depend on.
struct Angles {
  double s[6], c[6];
  BENCH_FLOOR_INLINE explicit Angles(const double* q) {
    const double q3 = q[1] + q[2], q4 = q3 + q[3];
    sincos4(s, c, q[1], q3, q4, q[4]);
  }
};

/// The same with those of q1 and q6.
struct AllAngles : Angles {
  BENCH_FLOOR_INLINE explicit AllAngles(const double* q) : Angles(q) {
    sincos_of<2>(s + 4, c + 4, q[0], q[5]);
  }
};

/// Rates of joint 1, sums up to joints 2, 3, 4, then joints 5 and 6.
struct Rates {
  double v1, v2, v3, v4, v5, v6;
  BENCH_FLOOR_INLINE explicit Rates(const double* x)
      : v1(x[0]), v2(x[1]), v3(x[1] + x[2]), v4(x[1] + x[2] + x[3]), v5(x[4]), v6(x[5]) {}
};

/// M a + C(w) r + G with Christoffel's C, for `g` upward acceleration of the base.
BENCH_FLOOR_INLINE void recursion(const double* s, const double* c, const Rates& w, const Rates& r,
                                  const Rates& a, double g, double* tau) {
  const double D = w.v1 * r.v1;
  // Acceleration of a unit vector along (links 2, 3) or across (link 4) each link, in P.
  const double P2 = w.v2 * r.v2, B2 = w.v1 * r.v2 + w.v2 * r.v1;
  const double P3 = w.v3 * r.v3, B3 = w.v1 * r.v3 + w.v3 * r.v1;
  const double P4 = w.v4 * r.v4, B4 = w.v1 * r.v4 + w.v4 * r.v1;
  const double x2 = -(D + P2) * c[0] - a.v2 * s[0], y2 = a.v2 * c[0] - P2 * s[0],
               z2 = B2 * s[0] - a.v1 * c[0];
  const double x3 = -(D + P3) * c[1] - a.v3 * s[1], y3 = a.v3 * c[1] - P3 * s[1],
               z3 = B3 * s[1] - a.v1 * c[1];
  const double x4 = (D + P4) * s[2] - a.v4 * c[2], y4 = -a.v4 * s[2] - P4 * c[2],
               z4 = a.v1 * s[2] + B4 * c[2];
  // Joint origins 3, 4, 5; a step along z of P accelerates by (a1, 0, -D).
  const double ax3 = a2 * x2, ay3 = g + a2 * y2, az3 = a2 * z2;
  const double ax4 = ax3 + a3 * x3, ay4 = ay3 + a3 * y3, az4 = az3 + a3 * z3;
  const double ax5 = ax4 + d4 * a.v1, az5 = az4 - d4 * D;
  // Forces of links 3 and 4.
  const double fx3 = m3 * (ax3 + c3x * x3 + c3z * a.v1), fy3 = m3 * (ay3 + c3x * y3);
  const double fz3 = m3 * (az3 + c3x * z3 - c3z * D);
  const double fx4 = m4 * (ax4 + c4y * x4 + c4z * a.v1), fy4 = m4 * (ay4 + c4y * y4);
  const double fz4 = m4 * (az4 + c4y * z4 - c4z * D);

  // Links 5 and 6 in Q = link 5's axes before q5: x along link 4, y along z of P, z = axis 5 (down when link
  // 4 lies).
  const double wx = w.v1 * s[2], wy = w.v4, wz = w.v5 - w.v1 * c[2];
  const double rx = r.v1 * s[2], ry = r.v4, rz = r.v5 - r.v1 * c[2];
  const double turn = w.v1 * r.v4;
  const double alx = c[2] * turn + s[2] * a.v1 + r.v5 * wy, aly = a.v4 - r.v5 * wx;
  const double alz = a.v5 + s[2] * turn - c[2] * a.v1;
  const double ax = c[2] * ax5 + s[2] * ay4, ay = az5, az = s[2] * ax5 - c[2] * ay4;
  const double pxx = wx * rx, pyy = wy * ry, pzz = wz * rz;
  const double Exx = -(pyy + pzz), Eyy = -(pxx + pzz), Ezz = -(pxx + pyy);
  const double Exy = wx * ry - alz, Exz = wx * rz + aly, Eyx = wy * rx + alz;
  const double Eyz = wy * rz - alx, Ezx = wz * rx - aly, Ezy = wz * ry + alx;
  // The body turned by q5.
  const double hqx = -hy * s[3], hqy = hy * c[3];
  const double qxx = Syy + Sxx_yy * c[3] * c[3], qyy = Sxx + Syy - qxx, qxy = Sxx_yy * s[3] * c[3];
  const double qxz = -Syz * s[3], qyz = Syz * c[3];
  const double fx = m56 * ax + Exx * hqx + Exy * hqy + Exz * hz;
  const double fy = m56 * ay + Eyx * hqx + Eyy * hqy + Eyz * hz;
  const double fz = m56 * az + Ezx * hqx + Ezy * hqy + Ezz * hz;
  // The spin of link 6 about its axis, y of link 5.
  const double wx5 = c[3] * wx + s[3] * wy, rx5 = c[3] * rx + s[3] * ry;
  const double kx = -S6 * (r.v6 * wz + w.v6 * rz), kz = S6 * (r.v6 * wx5 + w.v6 * rx5), ky = I6z * a.v6;
  const double nx = Ezx * qxy + Ezy * qyy + Ezz * qyz - Eyx * qxz - Eyy * qyz - Eyz * Szz + hqy * az -
                    hz * ay + kx * c[3] - ky * s[3];
  const double ny = Exx * qxz + Exy * qyz + Exz * Szz - Ezx * qxx - Ezy * qxy - Ezz * qxz + hz * ax -
                    hqx * az + kx * s[3] + ky * c[3];
  const double nz =
      Eyx * qxx + Eyy * qxy + Eyz * qxz - Exx * qxy - Exy * qyy - Exz * qyz + hqx * ay - hqy * ax + kz;
  tau[5] = I6z * (a.v6 + c[3] * aly - s[3] * alx) + S6 * (wx5 * rz - wz * rx5);
  tau[4] = nz;

  // Back in P, down to the base.
  const double Fx5 = c[2] * fx + s[2] * fz, Fy5 = s[2] * fx - c[2] * fz, Fz5 = fy;
  tau[3] = ny + I4z * a.v4 - c4y * (s[2] * fy4 + c[2] * fx4);
  const double up4 = s[2] * nx - c[2] * nz + d4 * Fx5 + c4z * fx4 + c4y * s[2] * fz4;
  const double Fx4 = Fx5 + fx4, Fy4 = Fy5 + fy4, Fz4 = Fz5 + fz4;
  const double S3 = S3xx_yy * c[1], S3xy = S3 * s[1];
  tau[2] = tau[3] + I3 * a.v3 + D * S3xy + c[1] * (a3 * Fy4 + c3x * fy3) - s[1] * (a3 * Fx4 + c3x * fx3);
  const double up3 = up4 - c[1] * (a3 * Fz4 + c3x * fz3) + c3z * fx3 - B3 * S3xy;
  const double Fx3 = Fx4 + fx3, Fy3 = Fy4 + fy3, Fz3 = Fz4 + fz3;
  const double S2 = S2xx_yy * c[0], S2xy = S2 * s[0];
  tau[1] = tau[2] + I2zz * a.v2 + D * S2xy - a.v1 * S2xz * s[0] + c[0] * (a2 * Fy3 + m2 * c2x * g) -
           s[0] * a2 * Fx3;
  tau[0] = up3 + a.v1 * (J1 + I4 + I3x + S2yy_zz + S3 * c[1] + S2 * c[0]) - c[0] * (a2 * Fz3 + P2 * S2xz) -
           a.v2 * S2xz * s[0] - B2 * S2xy;
}

/// Mass matrix in the coordinates q1, q2, q2 + q3, q2 + q3 + q4, q5, q6: the lower half that differs from
/// zero.
struct AbsoluteMass {
  double m11, m12, m13, m14, m15, m16, m22, m23, m24, m25, m33, m34, m35, m44, m45, m46;
  static constexpr double m55 = Sxx + Syy, m66 = I6z;

  BENCH_FLOOR_INLINE AbsoluteMass(const double* s, const double* c) {
    const double hqx = -hy * s[3], hqy = hy * c[3];
    const double qxx = Syy + Sxx_yy * c[3] * c[3];
    const double qxy = Sxx_yy * s[3] * c[3], qxz = -Syz * s[3], qyz = Syz * c[3];
    // Links 4, 5, 6 as one body in P, about joint 4; hqy + m56 d4 is the first moment of links 5 and 6 along
    // z.
    const double across = hz - m4 * c4y;  // first moment along -y of link 4
    const double hx = c[2] * hqx + s[2] * across, hy4 = s[2] * hqx - c[2] * across;
    const double hz4 = hqy + m56 * d4 + m4 * c4z;
    const double l3 = (m56 + m4) * a3 + m3 * c3x;
    constexpr double m4c = m4 * c4y * c4z;
    // Couplings of z and the plane: link 4's axes first.
    const double Sxz4 = qxy + d4 * hqx, Syz4 = -(qyz + d4 * hz) + m4c;  // along x of link 4, along its y
    const double couple = s[2] * Sxz4 + c[2] * Syz4;
    m44 = qxx + Szz + I4z + m4 * c4y * c4y;
    m34 = a3 * (c[1] * hx + s[1] * hy4);
    m24 = a2 * (c[0] * hx + s[0] * hy4);
    m33 = I3 + (m56 + m4) * a3 * a3 + m3 * c3x * c3x;
    m22 = I2zz + (m56 + m4 + m3) * a2 * a2;
    const double cos3 = c[0] * c[1] + s[0] * s[1];
    m23 = a2 * l3 * cos3;
    m14 = -couple;
    const double hz3 = a3 * hz4 + m3 * c3x * c3z;
    m13 = -s[1] * hz3;
    const double hz2 = a2 * (hz4 + m3 * c3z) + S2xz;
    m12 = -s[0] * hz2;
    // About the vertical: squares of the distances from it.
    const double x3 = a2 * c[0], x4 = x3 + a3 * c[1];
    const double xx = c[2] * c[2], ss = s[2] * s[2], cs = c[2] * s[2];
    const double Sxx4 = xx * qxx + 2 * cs * qxz + ss * (Szz + m4 * c4y * c4y);
    const double Szz4 = Sxx + Syy - qxx + d4 * (2 * hqy + m56 * d4) + m4 * c4z * c4z;
    m11 = J1 + S2yy_zz + S2xx_yy * c[0] * c[0] + I3x + S3xx_yy * c[1] * c[1] + m3 * c3z * c3z + I4 + Sxx4 +
          Szz4 + x4 * (2 * hx + (m56 + m4) * x4) + m3 * (x3 + c3x * c[1]) * (x3 + c3x * c[1]);
    // Joint 5: force (-hqy, hqx, 0) and moment (-qxz, -qyz, m55) in Q.
    m45 = -qyz;
    m35 = -a3 * hqy * (s[2] * c[1] - c[2] * s[1]);
    m25 = -a2 * hqy * (s[2] * c[0] - c[2] * s[0]);
    m15 = -s[2] * qxz - c[2] * (m55 + d4 * hqy) - x4 * hqx;
    m46 = I6z * c[3];
    m16 = -I6z * s[3] * s[2];
  }
};
}  // namespace detail

/// `X`: 12 numbers a link: the axes x, y, z of the link in the base, then its origin.
BENCH_FLOOR_INLINE void poses_from(const detail::AllAngles& t, double* __restrict X) {
  const double* s = t.s;
  const double* c = t.c;
  const double c1 = c[4], s1 = s[4], c6 = c[5], s6 = s[5];
  const auto put = [&](int i, double xx, double xy, double xz, double yx, double yy, double yz, double zx,
                       double zy, double zz, double px, double py, double pz) __attribute__((always_inline)) {
    double* o = X + 12 * i;
    o[0] = xx, o[1] = xy, o[2] = xz, o[3] = yx, o[4] = yy, o[5] = yz;
    o[6] = zx, o[7] = zy, o[8] = zz, o[9] = px, o[10] = py, o[11] = pz;
  };
  put(0, c1, s1, 0, -s1, c1, 0, 0, 0, 1, 0, 0, 0);
  put(1, c1 * c[0], s1 * c[0], s[0], -c1 * s[0], -s1 * s[0], c[0], s1, -c1, 0, 0, 0, d1);
  const double x3 = a2 * c[0], px3 = c1 * x3, py3 = s1 * x3, pz3 = d1 + a2 * s[0];
  put(2, c1 * c[1], s1 * c[1], s[1], -c1 * s[1], -s1 * s[1], c[1], s1, -c1, 0, px3, py3, pz3);
  const double x4 = x3 + a3 * c[1], px4 = c1 * x4, py4 = s1 * x4, pz4 = pz3 + a3 * s[1];
  const double x4x = c1 * c[2], x4y = s1 * c[2], y4x = -c1 * s[2], y4y = -s1 * s[2];
  put(3, x4x, x4y, s[2], y4x, y4y, c[2], s1, -c1, 0, px4, py4, pz4);
  const double x5x = c[3] * x4x + s[3] * s1, x5y = c[3] * x4y - s[3] * c1, x5z = c[3] * s[2];
  const double y5x = c[3] * s1 - s[3] * x4x, y5y = -c[3] * c1 - s[3] * x4y, y5z = -s[3] * s[2];
  const double px5 = px4 + d4 * s1, py5 = py4 - d4 * c1;
  put(4, x5x, x5y, x5z, y5x, y5y, y5z, -y4x, -y4y, -c[2], px5, py5, pz4);
  put(5, c6 * x5x + s6 * y4x, c6 * x5y + s6 * y4y, c6 * x5z + s6 * c[2], c6 * y4x - s6 * x5x,
      c6 * y4y - s6 * x5y, c6 * c[2] - s6 * x5z, y5x, y5y, y5z, px5 - d5 * y4x, py5 - d5 * y4y,
      pz4 - d5 * c[2]);
}

/// Poses of the six links.
BENCH_FLOOR_INLINE void floor_fk(const double* __restrict q, double* __restrict X) {
  poses_from(detail::AllAngles(q), X);
}

/// Poses, and the Jacobian of the flange: 6 columns of 6, linear rows first, base axes.
BENCH_FLOOR_INLINE void jacobian_from(const detail::AllAngles& t, double* __restrict J) {
  const double* s = t.s;
  const double* c = t.c;
  const double c1 = c[4], s1 = s[4];
  // In P: z5 = -y4, z6 = y5; the flange from joint 2, in P.
  const double y5p = -s[3] * c[2], y5q = -s[3] * s[2];  // y5 in P: (y5p, y5q, c5)
  const double x3 = a2 * c[0], y3 = a2 * s[0], x4 = x3 + a3 * c[1], y4 = y3 + a3 * s[1];
  const double ex = d5 * s[2] + d6 * y5p, ey = d6 * y5q - d5 * c[2],
               ez = d4 + d6 * c[3];  // from joint 4's origin
  const double x = x4 + ex, y = y4 + ey;
  const auto put = [&](int i, double vx, double vy, double vz, double wx, double wy, double wz)
                       __attribute__((always_inline)) {
                         double* o = J + 6 * i;
                         o[0] = vx, o[1] = vy, o[2] = vz, o[3] = wx, o[4] = wy, o[5] = wz;
                       };
  put(0, c1 * ez - s1 * x, c1 * x + s1 * ez, 0, 0, 0, 1);
  put(1, -c1 * y, -s1 * y, x, s1, -c1, 0);
  const double y_3 = y - y3, x_3 = x - x3;
  put(2, -c1 * y_3, -s1 * y_3, x_3, s1, -c1, 0);
  put(3, -c1 * ey, -s1 * ey, ex, s1, -c1, 0);
  // Joint 5: axis (s4, -c4, 0) in P, arm d6 y5 (the part along the axis is gone): d6 z5 x y5 = -d6 x5.
  const double x5p = c[3] * c[2], x5q = c[3] * s[2];  // x5 in P: (x5p, x5q, s5)
  const double vp = -d6 * x5p, vz = -d6 * s[3];
  put(4, c1 * vp + s1 * vz, s1 * vp - c1 * vz, -d6 * x5q, c1 * s[2], s1 * s[2], -c[2]);
  put(5, 0, 0, 0, c1 * y5p + s1 * c[3], s1 * y5p - c1 * c[3], y5q);
}

BENCH_FLOOR_INLINE void floor_fk_jacobian(const double* __restrict q, double* __restrict X,
                                          double* __restrict J) {
  const detail::AllAngles t(q);
  poses_from(t, X);
  jacobian_from(t, J);
}

BENCH_FLOOR_INLINE void floor_inverse_dynamics(const double* __restrict q, const double* __restrict dq,
                                               const double* __restrict ddq, double* __restrict tau) {
  const detail::Angles t(q);
  const detail::Rates w(dq);
  detail::recursion(t.s, t.c, w, w, detail::Rates(ddq), gravity_acceleration, tau);
}

/// M ddq_r + C(q, dq) dq_r + G with Christoffel's C.
BENCH_FLOOR_INLINE void floor_yr_theta(const double* __restrict q, const double* __restrict dq,
                                       const double* __restrict dq_r, const double* __restrict ddq_r,
                                       double* __restrict tau) {
  const detail::Angles t(q);
  detail::recursion(t.s, t.c, detail::Rates(dq), detail::Rates(dq_r), detail::Rates(ddq_r),
                    gravity_acceleration, tau);
}

BENCH_FLOOR_INLINE void floor_gravity(const double* __restrict q, double* __restrict G) {
  using namespace detail;
  const Angles t(q);
  constexpr double g = gravity_acceleration;
  G[0] = 0;
  G[5] = 0;
  G[4] = -g * hy * t.c[3] * t.s[2];
  G[3] = g * (hz - m4 * c4y) * t.s[2] - g * hy * t.s[3] * t.c[2];
  G[2] = G[3] + g * ((m56 + m4) * a3 + m3 * c3x) * t.c[1];
  G[1] = G[2] + g * ((m56 + m4 + m3) * a2 + m2 * c2x) * t.c[0];
}

/// 6 x 6, both halves.
BENCH_FLOOR_INLINE void floor_mass_matrix(const double* __restrict q, double* __restrict M) {
  const detail::Angles t(q);
  const detail::AbsoluteMass m(t.s, t.c);
  const auto put = [&](int i, int j, double x)
                       __attribute__((always_inline)) { M[6 * i + j] = M[6 * j + i] = x; };
  const double m3 = m.m33 + m.m34, m4 = m.m34 + m.m44, r34 = m3 + m4, r3 = m.m23 + m.m24;
  put(0, 0, m.m11);
  put(1, 0, m.m12 + m.m13 + m.m14);
  put(2, 0, m.m13 + m.m14);
  put(3, 0, m.m14);
  put(4, 0, m.m15);
  put(5, 0, m.m16);
  put(1, 1, m.m22 + 2 * r3 + r34);
  put(2, 1, r3 + r34);
  put(3, 1, m.m24 + m4);
  put(4, 1, m.m25 + m.m35 + m.m45);
  put(5, 1, m.m46);
  put(2, 2, r34);
  put(3, 2, m4);
  put(4, 2, m.m35 + m.m45);
  put(5, 2, m.m46);
  put(3, 3, m.m44);
  put(4, 3, m.m45);
  put(5, 3, m.m46);
  put(4, 4, m.m55);
  put(5, 4, 0);
  put(5, 5, m.m66);
}

/// Acceleration under the torque tau.
BENCH_FLOOR_INLINE void floor_forward_dynamics(const double* __restrict q, const double* __restrict dq,
                                               const double* __restrict tau, double* __restrict ddq) {
  using detail::AbsoluteMass;
  const detail::Angles t(q);
  const detail::Rates w(dq);
  constexpr double zero[6] = {};
  double b[6];
  detail::recursion(t.s, t.c, w, w, detail::Rates(zero), gravity_acceleration, b);
  const AbsoluteMass m(t.s, t.c);
  // Torques on the absolute angles, then joints 5 and 6 eliminated by constants.
  const double b5 = tau[4] - b[4], b6 = tau[5] - b[5], e4 = tau[3] - b[3], e3 = tau[2] - b[2];
  constexpr double k5 = 1 / AbsoluteMass::m55, k6 = 1 / AbsoluteMass::m66;
  const double u15 = k5 * m.m15, u25 = k5 * m.m25, u35 = k5 * m.m35, u45 = k5 * m.m45, u16 = k6 * m.m16;
  const double u46 = k6 * m.m46;
  const double b1 = tau[0] - b[0] - u15 * b5 - u16 * b6, b2 = tau[1] - b[1] - e3 - u25 * b5;
  const double b3 = e3 - e4 - u35 * b5, b4 = e4 - u45 * b5 - u46 * b6;
  const double a11 = m.m11 - u15 * m.m15 - u16 * m.m16, a12 = m.m12 - u15 * m.m25, a13 = m.m13 - u15 * m.m35;
  const double a14 = m.m14 - u15 * m.m45 - u16 * m.m46;
  const double a22 = m.m22 - u25 * m.m25, a23 = m.m23 - u25 * m.m35, a24 = m.m24 - u25 * m.m45;
  const double a33 = m.m33 - u35 * m.m35, a34 = m.m34 - u35 * m.m45, a44 = m.m44 - u45 * m.m45 - u46 * m.m46;
  // Two by two blocks: (q1, 4) eliminated first, then (2, 3).
  const double i0 = 1 / (a11 * a44 - a14 * a14);
  const double p2 = (a44 * a12 - a14 * a24) * i0, r2 = (a11 * a24 - a14 * a12) * i0;
  const double p3 = (a44 * a13 - a14 * a34) * i0, r3 = (a11 * a34 - a14 * a13) * i0;
  const double pb = (a44 * b1 - a14 * b4) * i0, rb = (a11 * b4 - a14 * b1) * i0;
  const double s22 = a22 - a12 * p2 - a24 * r2, s23 = a23 - a12 * p3 - a24 * r3,
               s33 = a33 - a13 * p3 - a34 * r3;
  const double c2 = b2 - a12 * pb - a24 * rb, c3 = b3 - a13 * pb - a34 * rb;
  const double i1 = 1 / (s22 * s33 - s23 * s23);
  const double x2 = (s33 * c2 - s23 * c3) * i1, x3 = (s22 * c3 - s23 * c2) * i1;
  const double x1 = pb - p2 * x2 - p3 * x3, x4 = rb - r2 * x2 - r3 * x3;
  ddq[0] = x1;
  ddq[1] = x2;
  ddq[2] = x3 - x2;
  ddq[3] = x4 - x3;
  ddq[4] = k5 * b5 - u15 * x1 - u25 * x2 - u35 * x3 - u45 * x4;
  ddq[5] = k6 * b6 - u16 * x1 - u46 * x4;
}

/// Poses, the flange's Jacobian, and tau = Y_r Theta - K_d (dq - dq_r) with a diagonal K_d, sharing the
/// angles.
BENCH_FLOOR_INLINE void floor_fk_jacobian_yr_theta_kd(const double* __restrict q, const double* __restrict dq,
                                                      const double* __restrict dq_r,
                                                      const double* __restrict ddq_r,
                                                      const double* __restrict K_d, double* __restrict X,
                                                      double* __restrict J, double* __restrict tau) {
  const detail::AllAngles t(q);
  poses_from(t, X);
  jacobian_from(t, J);
  detail::recursion(t.s, t.c, detail::Rates(dq), detail::Rates(dq_r), detail::Rates(ddq_r),
                    gravity_acceleration, tau);
  for (int i = 0; i < 6; ++i) tau[i] -= K_d[i] * (dq[i] - dq_r[i]);
}

}  // namespace bench_floor::ur5_planar
