// The floor under every UR5 number: the recursions of the textbooks, link by link in each link's own frame,
// written out by hand in plain doubles with every zero, one and constant of this robot folded.
#pragma once

#include "bench/studies/floor/floor.hpp"

/// Frames as the maker's Denavit-Hartenberg frames right after Rz(q). Arrays must not overlap.
namespace bench_floor::ur5 {

// Lengths [m], masses [kg], centres of mass [m] of links 1 to 6: Universal Robots, "DH parameters for
// calculations of kinematics and dynamics"; inertias [kg m^2]: Universal_Robots_ROS2_Description,
// config/ur5/physical_parameters.yaml.
inline constexpr double d1 = 0.089159, a2 = -0.425, a3 = -0.39225, d4 = 0.10915, d5 = 0.09465, d6 = 0.0823;
inline constexpr double g = 9.81;

namespace detail {
inline constexpr double m2 = 8.393, m3 = 2.33, m4 = 1.219, m5 = 1.219, m6 = 0.1879;
inline constexpr double c2x = a2 + 0.2125, c2z = 0.11336, c3x = a3 + 0.15, c3z = 0.0265;
inline constexpr double c4y = -0.01634, c4z = d4 - 0.0018, c5y = 0.01634, c5z = d5 - 0.0018,
                        c6z = d6 - 0.001159;
/// Link 1 about its joint; the others' second moments (integral of r r' dm) about their centres of mass.
inline constexpr double J1 = 0.01040625 + 3.7 * 0.00193 * 0.00193;
inline constexpr double I2 = 0.13388583541666665, S2x = I2 - 0.0151074 / 2, S2 = 0.0151074 / 2;
inline constexpr double I3 = 0.031216803515624995, S3x = I3 - 0.004095 / 2, S3 = 0.004095 / 2;
inline constexpr double S4 = 0.0021942 / 2, S4z = 0.002013889583333333 - S4;
inline constexpr double S5 = 0.0021942 / 2, S5z = 0.0018310395833333333 - S5;
inline constexpr double S6 = 0.0001321171875 / 2, S6z = 8.062475833333332e-05 - S6;

struct V {
  double x, y, z;
};
/// Rz(q)' v and Rz(q) v.
BENCH_FLOOR_INLINE V into(double s, double c, V v) {
  return {c * v.x + s * v.y, c * v.y - s * v.x, v.z};
}
BENCH_FLOOR_INLINE V out_of(double s, double c, V v) {
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

struct Motion {
  V w, r, al, a;
};

/// What the next link sees in its own frame, once its placement has been applied to `m`: turn, then add its
/// joint.
BENCH_FLOOR_INLINE Motion turned(double s, double c, const Motion& m, double dq, double dq_r, double ddq_r) {
  Motion n{into(s, c, m.w), into(s, c, m.r), into(s, c, m.al), into(s, c, m.a)};
  n.al.x += dq_r * n.w.y;
  n.al.y -= dq_r * n.w.x;
  n.al.z += ddq_r;
  n.w.z += dq;
  n.r.z += dq_r;
  return n;
}

/// E = [alpha]x + w r' - (w . r) 1.
struct Spin {
  double xx, xy, xz, yx, yy, yz, zx, zy, zz;
  BENCH_FLOOR_INLINE explicit Spin(const Motion& m) {
    const double px = m.w.x * m.r.x, py = m.w.y * m.r.y, pz = m.w.z * m.r.z;
    xx = -(py + pz), yy = -(px + pz), zz = -(px + py);
    xy = m.w.x * m.r.y - m.al.z, xz = m.w.x * m.r.z + m.al.y;
    yx = m.w.y * m.r.x + m.al.z, yz = m.w.y * m.r.z - m.al.x;
    zx = m.w.z * m.r.x - m.al.y, zy = m.w.z * m.r.y + m.al.x;
  }
};

struct Wrench {
  V f, n;
};

/// Links 2 to 6; `s`, `c` are those of q2 to q6.
struct Motions {
  Motion l2;
  Spin e2;
  Motion l3;
  Spin e3;
  Motion l4;
  Spin e4;
  Motion l5;
  Spin e5;
  Motion l6;
  Spin e6;

  // Link 1 turns about the vertical: (0, 0, dq1). Link 2 stands upright on it.
  BENCH_FLOOR_INLINE Motions(const double* s, const double* c, const double* dq, const double* dq_r,
                             const double* ddq_r)
      : l2{{s[0] * dq[0], c[0] * dq[0], dq[1]},
           {s[0] * dq_r[0], c[0] * dq_r[0], dq_r[1]},
           {s[0] * ddq_r[0] + dq_r[1] * (c[0] * dq[0]), c[0] * ddq_r[0] - dq_r[1] * (s[0] * dq[0]), ddq_r[1]},
           {s[0] * g, c[0] * g, 0}},
        e2(l2),
        l3(turned(s[1], c[1], {l2.w, l2.r, l2.al, {l2.a.x + a2 * e2.xx, l2.a.y + a2 * e2.yx, a2 * e2.zx}},
                  dq[2], dq_r[2], ddq_r[2])),
        e3(l3),
        l4(turned(s[2], c[2],
                  {l3.w, l3.r, l3.al, {l3.a.x + a3 * e3.xx, l3.a.y + a3 * e3.yx, l3.a.z + a3 * e3.zx}}, dq[3],
                  dq_r[3], ddq_r[3])),
        e4(l4),
        l5(turned(s[3], c[3],
                  {{l4.w.x, l4.w.z, -l4.w.y},
                   {l4.r.x, l4.r.z, -l4.r.y},
                   {l4.al.x, l4.al.z, -l4.al.y},
                   {l4.a.x + d4 * e4.xz, l4.a.z + d4 * e4.zz, -(l4.a.y + d4 * e4.yz)}},
                  dq[4], dq_r[4], ddq_r[4])),
        e5(l5),
        l6(turned(s[4], c[4],
                  {{l5.w.x, -l5.w.z, l5.w.y},
                   {l5.r.x, -l5.r.z, l5.r.y},
                   {l5.al.x, -l5.al.z, l5.al.y},
                   {l5.a.x + d5 * e5.xz, -(l5.a.z + d5 * e5.zz), l5.a.y + d5 * e5.yz}},
                  dq[5], dq_r[5], ddq_r[5])),
        e6(l6) {}
};

/// M a + C(w) r + G with Christoffel's C.
BENCH_FLOOR_INLINE void recursion(const double* s, const double* c, const double* dq, const double* dq_r,
                                  const double* ddq_r, double* tau) {
  const Motions m(s, c, dq, dq_r, ddq_r);
  const auto& [l2, e2, l3, e3, l4, e4, l5, e5, l6, e6] = m;

  Wrench h;
  h.f = {m6 * (l6.a.x + c6z * e6.xz), m6 * (l6.a.y + c6z * e6.yz), m6 * (l6.a.z + c6z * e6.zz)};
  h.n = {S6 * e6.zy - S6z * e6.yz - c6z * h.f.y, S6z * e6.xz - S6 * e6.zx + c6z * h.f.x,
         S6 * (e6.yx - e6.xy)};
  tau[5] = h.n.z;

  V f = out_of(s[4], c[4], h.f), n = out_of(s[4], c[4], h.n);
  f = {f.x, f.z, -f.y}, n = {n.x - d5 * f.y, n.z + d5 * f.x, -n.y};
  h.f = {m5 * (l5.a.x + c5y * e5.xy + c5z * e5.xz), m5 * (l5.a.y + c5y * e5.yy + c5z * e5.yz),
         m5 * (l5.a.z + c5y * e5.zy + c5z * e5.zz)};
  h.n = {n.x + S5 * e5.zy - S5z * e5.yz + c5y * h.f.z - c5z * h.f.y,
         n.y + S5z * e5.xz - S5 * e5.zx + c5z * h.f.x, n.z + S5 * (e5.yx - e5.xy) - c5y * h.f.x};
  h.f = {h.f.x + f.x, h.f.y + f.y, h.f.z + f.z};
  tau[4] = h.n.z;

  f = out_of(s[3], c[3], h.f), n = out_of(s[3], c[3], h.n);
  f = {f.x, -f.z, f.y}, n = {n.x - d4 * f.y, d4 * f.x - n.z, n.y};
  h.f = {m4 * (l4.a.x + c4y * e4.xy + c4z * e4.xz), m4 * (l4.a.y + c4y * e4.yy + c4z * e4.yz),
         m4 * (l4.a.z + c4y * e4.zy + c4z * e4.zz)};
  h.n = {n.x + S4 * e4.zy - S4z * e4.yz + c4y * h.f.z - c4z * h.f.y,
         n.y + S4z * e4.xz - S4 * e4.zx + c4z * h.f.x, n.z + S4 * (e4.yx - e4.xy) - c4y * h.f.x};
  h.f = {h.f.x + f.x, h.f.y + f.y, h.f.z + f.z};
  tau[3] = h.n.z;

  f = out_of(s[2], c[2], h.f), n = out_of(s[2], c[2], h.n);
  n.y -= a3 * f.z, n.z += a3 * f.y;
  h.f = {m3 * (l3.a.x + c3x * e3.xx + c3z * e3.xz), m3 * (l3.a.y + c3x * e3.yx + c3z * e3.yz),
         m3 * (l3.a.z + c3x * e3.zx + c3z * e3.zz)};
  h.n = {n.x + S3 * (e3.zy - e3.yz) - c3z * h.f.y, n.y + S3 * e3.xz - S3x * e3.zx + c3z * h.f.x - c3x * h.f.z,
         n.z + S3x * e3.yx - S3 * e3.xy + c3x * h.f.y};
  h.f = {h.f.x + f.x, h.f.y + f.y, h.f.z + f.z};
  tau[2] = h.n.z;

  // Of link 2 on, forces no longer matter, only moments.
  f = out_of(s[1], c[1], h.f), n = out_of(s[1], c[1], h.n);
  h.f = {m2 * (l2.a.x + c2x * e2.xx + c2z * e2.xz), m2 * (l2.a.y + c2x * e2.yx + c2z * e2.yz),
         m2 * (c2x * e2.zx + c2z * e2.zz)};
  h.n = {n.x + S2 * (e2.zy - e2.yz) - c2z * h.f.y,
         n.y - a2 * f.z + S2 * e2.xz - S2x * e2.zx + c2z * h.f.x - c2x * h.f.z,
         n.z + a2 * f.y + S2x * e2.yx - S2 * e2.xy + c2x * h.f.y};
  tau[1] = h.n.z;
  tau[0] = s[0] * h.n.x + c[0] * h.n.y + J1 * ddq_r[0];
}

/// The wrench of a body with the ten numbers `o` (mass, first moments, xx yy zz xy xz yz of its inertia about
/// the frame's origin).
BENCH_FLOOR_INLINE Wrench wrench_of(const double* o, const Motion& m, const Spin& e) {
  const double hx = o[1], hy = o[2], hz = o[3];
  const double xx = 0.5 * (o[5] + o[6] - o[4]), yy = 0.5 * (o[4] + o[6] - o[5]),
               zz = 0.5 * (o[4] + o[5] - o[6]);
  const double xy = -o[7], xz = -o[8], yz = -o[9];
  return {{o[0] * m.a.x + e.xx * hx + e.xy * hy + e.xz * hz, o[0] * m.a.y + e.yx * hx + e.yy * hy + e.yz * hz,
           o[0] * m.a.z + e.zx * hx + e.zy * hy + e.zz * hz},
          {e.zx * xy + e.zy * yy - e.yx * xz - e.yz * zz + (e.zz - e.yy) * yz + hy * m.a.z - hz * m.a.y,
           e.xy * yz + e.xz * zz - e.zx * xx - e.zy * xy + (e.xx - e.zz) * xz + hz * m.a.x - hx * m.a.z,
           e.yx * xx + e.yz * xz - e.xy * yy - e.xz * yz + (e.yy - e.xx) * xy + hx * m.a.y - hy * m.a.x}};
}

/// The same torques with the links' inertial parameters as numbers: ten a link.
BENCH_FLOOR_INLINE void recursion_of(const double* s, const double* c, const double* dq, const double* dq_r,
                                     const double* ddq_r, const double* theta, double* tau) {
  const Motions m(s, c, dq, dq_r, ddq_r);
  const auto sum = [](const Wrench& h, const V& f, const V& n) __attribute__((always_inline)) {
    return Wrench{{h.f.x + f.x, h.f.y + f.y, h.f.z + f.z}, {h.n.x + n.x, h.n.y + n.y, h.n.z + n.z}};
  };
  Wrench h = wrench_of(theta + 50, m.l6, m.e6);
  tau[5] = h.n.z;
  V f = out_of(s[4], c[4], h.f), n = out_of(s[4], c[4], h.n);
  f = {f.x, f.z, -f.y}, n = {n.x - d5 * f.y, n.z + d5 * f.x, -n.y};
  h = sum(wrench_of(theta + 40, m.l5, m.e5), f, n);
  tau[4] = h.n.z;
  f = out_of(s[3], c[3], h.f), n = out_of(s[3], c[3], h.n);
  f = {f.x, -f.z, f.y}, n = {n.x - d4 * f.y, d4 * f.x - n.z, n.y};
  h = sum(wrench_of(theta + 30, m.l4, m.e4), f, n);
  tau[3] = h.n.z;
  f = out_of(s[2], c[2], h.f), n = out_of(s[2], c[2], h.n);
  n.y -= a3 * f.z, n.z += a3 * f.y;
  h = sum(wrench_of(theta + 20, m.l3, m.e3), f, n);
  tau[2] = h.n.z;
  f = out_of(s[1], c[1], h.f), n = out_of(s[1], c[1], h.n);
  n.y -= a2 * f.z, n.z += a2 * f.y;
  h = sum(wrench_of(theta + 10, m.l2, m.e2), f, n);
  tau[1] = h.n.z;
  tau[0] = s[0] * h.n.x + c[0] * h.n.y + theta[6] * ddq_r[0];
}

/// Mass and moments of a link with all that it carries, about the origin and in the axes of its frame.
struct Composite {
  V h;
  double xx, yy, zz, xy, xz, yz;
};
BENCH_FLOOR_INLINE Composite out_of(double s, double c, const Composite& b) {
  const double u = c * b.xx - s * b.xy, v = c * b.xy - s * b.yy, xx = c * u - s * v;
  return {out_of(s, c, b.h),  xx, b.xx + b.yy - xx, b.zz, s * u + c * v, c * b.xz - s * b.yz,
          s * b.xz + c * b.yz};
}

/// The entries of M on and below the diagonal that are not zero.
struct Mass {
  double m11, m21, m31, m41, m51, m61, m22, m32, m42, m52, m62, m33, m43, m53, m63, m44, m54, m64, m55;
  static constexpr double m66 = 2 * S6;

  BENCH_FLOOR_INLINE Mass(const double* s, const double* c) {
    // Wrench (f, n) of a unit acceleration of joint i, carried down: its z moment is M_ji.
    const auto to4 = [&](V& f, V& n) __attribute__((always_inline)) {
      const V x = out_of(s[3], c[3], f), y = out_of(s[3], c[3], n);
      f = {x.x, -x.z, x.y}, n = {y.x - d4 * f.y, d4 * f.x - y.z, y.y};
    };
    const auto to3 = [&](V& f, V& n) __attribute__((always_inline)) {
      f = out_of(s[2], c[2], f), n = out_of(s[2], c[2], n);
      n.y -= a3 * f.z, n.z += a3 * f.y;
    };
    const auto to2 = [&](V& f, V& n) __attribute__((always_inline)) {
      f = out_of(s[1], c[1], f), n = out_of(s[1], c[1], n);
      n.y -= a2 * f.z, n.z += a2 * f.y;
    };
    const auto to1 = [&](const V& n) __attribute__((always_inline)) { return s[0] * n.x + c[0] * n.y; };

    // Link 6 carries only itself, with its first moment along z: no force, M_65 = 0.
    V f, n{-s[3] * m66, 0, c[3] * m66};
    m64 = n.z;
    n = out_of(s[2], c[2], n);
    m63 = n.z;
    n = out_of(s[1], c[1], n);
    m62 = n.z;
    m61 = to1(n);

    constexpr double h6 = m6 * c6z, zz6 = S6z + m6 * c6z * c6z;
    Composite b = out_of(s[4], c[4], Composite{{0, 0, h6}, S6, S6, zz6, 0, 0, 0});
    const Composite b5{{0, m5 * c5y + h6, m5 * c5z + m6 * d5},
                       S5 + b.xx,
                       S5 + m5 * c5y * c5y + b.zz,
                       S5z + m5 * c5z * c5z + b.yy + m6 * d5 * d5,
                       0,
                       0,
                       m5 * c5y * c5z + h6 * d5};
    m55 = b5.xx + b5.yy;
    f = {-b5.h.y, 0, 0}, n = {0, -b5.yz, m55};
    to4(f, n);
    m54 = n.z;
    to3(f, n);
    m53 = n.z;
    to2(f, n);
    m52 = n.z;
    m51 = to1(n);

    constexpr double m56 = m5 + m6, m456 = m4 + m56, m3456 = m3 + m456;
    b = out_of(s[3], c[3], b5);
    const Composite b4{{b.h.x, m4 * c4y - b.h.z, m4 * c4z + b.h.y + m56 * d4},
                       S4 + b.xx,
                       S4 + m4 * c4y * c4y + b.zz,
                       S4z + m4 * c4z * c4z + b.yy + d4 * (2 * b.h.y + m56 * d4),
                       -b.xz,
                       b.xy + b.h.x * d4,
                       m4 * c4y * c4z - b.yz - b.h.z * d4};
    m44 = b4.xx + b4.yy;
    f = {-b4.h.y, b4.h.x, 0}, n = {-b4.xz, -b4.yz, m44};
    to3(f, n);
    m43 = n.z;
    to2(f, n);
    m42 = n.z;
    m41 = to1(n);

    b = out_of(s[2], c[2], b4);
    const Composite b3{{m3 * c3x + b.h.x + m456 * a3, b.h.y, m3 * c3z + b.h.z},
                       S3x + m3 * c3x * c3x + b.xx + a3 * (2 * b.h.x + m456 * a3),
                       S3 + b.yy,
                       S3 + m3 * c3z * c3z + b.zz,
                       b.xy + a3 * b.h.y,
                       m3 * c3x * c3z + b.xz + a3 * b.h.z,
                       b.yz};
    m33 = b3.xx + b3.yy;
    f = {-b3.h.y, b3.h.x, 0}, n = {-b3.xz, -b3.yz, m33};
    to2(f, n);
    m32 = n.z;
    m31 = to1(n);

    b = out_of(s[1], c[1], b3);
    const double xx = S2x + m2 * c2x * c2x + b.xx + a2 * (2 * b.h.x + m3456 * a2), yy = S2 + b.yy;
    const double zz = S2 + m2 * c2z * c2z + b.zz, xy = b.xy + a2 * b.h.y;
    m22 = xx + yy;
    m21 = -s[0] * (m2 * c2x * c2z + b.xz + a2 * b.h.z) - c[0] * b.yz;
    // About the vertical, which is y of link 2 turned back by q2.
    m11 = J1 + zz + c[0] * (c[0] * xx - s[0] * xy) - s[0] * (c[0] * xy - s[0] * yy);
  }
};
}  // namespace detail

/// `X`: 12 numbers a link: the axes x, y, z of the link in the base, then its origin.
BENCH_FLOOR_INLINE void poses_from(const double* s, const double* c, double* __restrict X) {
  const auto put = [&](int i, double xx, double xy, double xz, double yx, double yy, double yz, double zx,
                       double zy, double zz, double px, double py, double pz) __attribute__((always_inline)) {
    double* o = X + 12 * i;
    o[0] = xx, o[1] = xy, o[2] = xz, o[3] = yx, o[4] = yy, o[5] = yz;
    o[6] = zx, o[7] = zy, o[8] = zz, o[9] = px, o[10] = py, o[11] = pz;
  };
  const double s1 = s[0], c1 = c[0];
  put(0, c1, s1, 0, -s1, c1, 0, 0, 0, 1, 0, 0, 0);
  const double x2x = c1 * c[1], x2y = s1 * c[1], y2x = -c1 * s[1], y2y = -s1 * s[1];
  put(1, x2x, x2y, s[1], y2x, y2y, c[1], s1, -c1, 0, 0, 0, d1);
  const double x3x = c[2] * x2x + s[2] * y2x, x3y = c[2] * x2y + s[2] * y2y, x3z = c[2] * s[1] + s[2] * c[1];
  const double y3x = c[2] * y2x - s[2] * x2x, y3y = c[2] * y2y - s[2] * x2y, y3z = c[2] * c[1] - s[2] * s[1];
  const double p3x = a2 * x2x, p3y = a2 * x2y, p3z = d1 + a2 * s[1];
  put(2, x3x, x3y, x3z, y3x, y3y, y3z, s1, -c1, 0, p3x, p3y, p3z);
  const double x4x = c[3] * x3x + s[3] * y3x, x4y = c[3] * x3y + s[3] * y3y, x4z = c[3] * x3z + s[3] * y3z;
  const double y4x = c[3] * y3x - s[3] * x3x, y4y = c[3] * y3y - s[3] * x3y, y4z = c[3] * y3z - s[3] * x3z;
  const double p4x = p3x + a3 * x3x, p4y = p3y + a3 * x3y, p4z = p3z + a3 * x3z;
  put(3, x4x, x4y, x4z, y4x, y4y, y4z, s1, -c1, 0, p4x, p4y, p4z);
  const double x5x = c[4] * x4x + s[4] * s1, x5y = c[4] * x4y - s[4] * c1, x5z = c[4] * x4z;
  const double y5x = c[4] * s1 - s[4] * x4x, y5y = -c[4] * c1 - s[4] * x4y, y5z = -s[4] * x4z;
  const double p5x = p4x + d4 * s1, p5y = p4y - d4 * c1;
  put(4, x5x, x5y, x5z, y5x, y5y, y5z, -y4x, -y4y, -y4z, p5x, p5y, p4z);
  put(5, c[5] * x5x + s[5] * y4x, c[5] * x5y + s[5] * y4y, c[5] * x5z + s[5] * y4z, c[5] * y4x - s[5] * x5x,
      c[5] * y4y - s[5] * x5y, c[5] * y4z - s[5] * x5z, y5x, y5y, y5z, p5x - d5 * y4x, p5y - d5 * y4y,
      p4z - d5 * y4z);
}

/// The Jacobian of the flange from the poses: 6 columns of 6, linear rows first, base axes.
BENCH_FLOOR_INLINE void jacobian_from(const double* X, double* __restrict J) {
  const double s1 = X[18], c1 = -X[19];  // z of link 2
  const double px = X[69] + d6 * X[66], py = X[70] + d6 * X[67], pz = X[71] + d6 * X[68];
  const auto put = [&](int i, double vx, double vy, double vz, double wx, double wy, double wz)
                       __attribute__((always_inline)) {
                         double* o = J + 6 * i;
                         o[0] = vx, o[1] = vy, o[2] = vz, o[3] = wx, o[4] = wy, o[5] = wz;
                       };
  put(0, -py, px, 0, 0, 0, 1);
  const double z2 = pz - d1, z3 = pz - X[35], z4 = pz - X[47];
  put(1, -c1 * z2, -s1 * z2, s1 * py + c1 * px, s1, -c1, 0);
  put(2, -c1 * z3, -s1 * z3, s1 * (py - X[34]) + c1 * (px - X[33]), s1, -c1, 0);
  put(3, -c1 * z4, -s1 * z4, s1 * (py - X[46]) + c1 * (px - X[45]), s1, -c1, 0);
  const double rx = px - X[57], ry = py - X[58], rz = pz - X[59], zx = X[54], zy = X[55], zz = X[56];
  put(4, zy * rz - zz * ry, zz * rx - zx * rz, zx * ry - zy * rx, zx, zy, zz);
  put(5, 0, 0, 0, X[66], X[67], X[68]);
}

/// Poses of the six links.
BENCH_FLOOR_INLINE void floor_fk(const double* __restrict q, double* __restrict X) {
  double s[6], c[6];
  sincos6(s, c, q[0], q[1], q[2], q[3], q[4], q[5]);
  poses_from(s, c, X);
}

/// Poses, and the Jacobian of the flange.
BENCH_FLOOR_INLINE void floor_fk_jacobian(const double* __restrict q, double* __restrict X,
                                          double* __restrict J) {
  double s[6], c[6];
  sincos6(s, c, q[0], q[1], q[2], q[3], q[4], q[5]);
  poses_from(s, c, X);
  jacobian_from(X, J);
}

BENCH_FLOOR_INLINE void floor_inverse_dynamics(const double* __restrict q, const double* __restrict dq,
                                               const double* __restrict ddq, double* __restrict tau) {
  double s[6], c[6];
  sincos6(s, c, q[1], q[2], q[3], q[4], q[5], q[5]);
  detail::recursion(s, c, dq, dq, ddq, tau);
}

/// M ddq_r + C(q, dq) dq_r + G with Christoffel's C.
BENCH_FLOOR_INLINE void floor_yr_theta(const double* __restrict q, const double* __restrict dq,
                                       const double* __restrict dq_r, const double* __restrict ddq_r,
                                       double* __restrict tau) {
  double s[6], c[6];
  sincos6(s, c, q[1], q[2], q[3], q[4], q[5], q[5]);
  detail::recursion(s, c, dq, dq_r, ddq_r, tau);
}

/// Y(q, dq, dq_r, ddq_r) theta without the matrix Y.
BENCH_FLOOR_INLINE void floor_regressor_product(const double* __restrict q, const double* __restrict dq,
                                                const double* __restrict dq_r, const double* __restrict ddq_r,
                                                const double* __restrict theta, double* __restrict tau) {
  double s[6], c[6];
  sincos6(s, c, q[1], q[2], q[3], q[4], q[5], q[5]);
  detail::recursion_of(s, c, dq, dq_r, ddq_r, theta, tau);
}

BENCH_FLOOR_INLINE void floor_gravity(const double* __restrict q, double* __restrict G) {
  using namespace detail;
  double s[4], c[4];
  sincos4(s, c, q[1], q[2], q[3], q[4]);
  // The vertical seen by links 2 to 5; joint 6 carries a body whose weight is on its axis.
  const double x2 = g * s[0], y2 = g * c[0];
  const double x3 = c[1] * x2 + s[1] * y2, y3 = c[1] * y2 - s[1] * x2;
  const double x4 = c[2] * x3 + s[2] * y3, y4 = c[2] * y3 - s[2] * x3;
  constexpr double m56 = m5 + m6, hy = m5 * c5y + m6 * c6z, hz = m5 * c5z + m6 * d5;
  G[5] = 0;
  G[4] = -hy * c[3] * x4;
  G[3] = (hz - m4 * c4y) * x4 - hy * s[3] * y4;
  G[2] = G[3] + ((m4 + m56) * a3 + m3 * c3x) * y3;
  G[1] = G[2] + ((m3 + m4 + m56) * a2 + m2 * c2x) * y2;
  G[0] = 0;
}

/// 6 x 6, both halves.
BENCH_FLOOR_INLINE void floor_mass_matrix(const double* __restrict q, double* __restrict M) {
  double s[6], c[6];
  sincos6(s, c, q[1], q[2], q[3], q[4], q[5], q[5]);
  const detail::Mass m(s, c);
  const auto put = [&](int i, int j, double x)
                       __attribute__((always_inline)) { M[6 * i + j - 7] = M[6 * j + i - 7] = x; };
  put(1, 1, m.m11), put(2, 1, m.m21), put(3, 1, m.m31), put(4, 1, m.m41), put(5, 1, m.m51), put(6, 1, m.m61);
  put(2, 2, m.m22), put(3, 2, m.m32), put(4, 2, m.m42), put(5, 2, m.m52), put(6, 2, m.m62);
  put(3, 3, m.m33), put(4, 3, m.m43), put(5, 3, m.m53), put(6, 3, m.m63);
  put(4, 4, m.m44), put(5, 4, m.m54), put(6, 4, m.m64), put(5, 5, m.m55), put(6, 5, 0), put(6, 6, m.m66);
}

/// Acceleration under the torque tau: M ddq = tau - C dq - G, M = L' D L eliminated from joint 6 down.
BENCH_FLOOR_INLINE void floor_forward_dynamics(const double* __restrict q, const double* __restrict dq,
                                               const double* __restrict tau, double* __restrict ddq) {
  double s[6], c[6], b[6];
  sincos6(s, c, q[1], q[2], q[3], q[4], q[5], q[5]);
  constexpr double zero[6] = {};
  detail::recursion(s, c, dq, dq, zero, b);
  detail::Mass m(s, c);
  double x1 = tau[0] - b[0], x2 = tau[1] - b[1], x3 = tau[2] - b[2];
  double x4 = tau[3] - b[3], x5 = tau[4] - b[4], x6 = tau[5] - b[5];

  constexpr double i6 = 1 / m.m66;
  const double l61 = m.m61 * i6, l62 = m.m62 * i6, l63 = m.m63 * i6, l64 = m.m64 * i6;
  m.m11 -= l61 * m.m61, m.m21 -= l61 * m.m62, m.m31 -= l61 * m.m63, m.m41 -= l61 * m.m64;
  m.m22 -= l62 * m.m62, m.m32 -= l62 * m.m63, m.m42 -= l62 * m.m64;
  m.m33 -= l63 * m.m63, m.m43 -= l63 * m.m64, m.m44 -= l64 * m.m64;
  x1 -= l61 * x6, x2 -= l62 * x6, x3 -= l63 * x6, x4 -= l64 * x6;

  const double i5 = 1 / m.m55;
  const double l51 = m.m51 * i5, l52 = m.m52 * i5, l53 = m.m53 * i5, l54 = m.m54 * i5;
  m.m11 -= l51 * m.m51, m.m21 -= l51 * m.m52, m.m31 -= l51 * m.m53, m.m41 -= l51 * m.m54;
  m.m22 -= l52 * m.m52, m.m32 -= l52 * m.m53, m.m42 -= l52 * m.m54;
  m.m33 -= l53 * m.m53, m.m43 -= l53 * m.m54, m.m44 -= l54 * m.m54;
  x1 -= l51 * x5, x2 -= l52 * x5, x3 -= l53 * x5, x4 -= l54 * x5;

  const double i4 = 1 / m.m44, l41 = m.m41 * i4, l42 = m.m42 * i4, l43 = m.m43 * i4;
  m.m11 -= l41 * m.m41, m.m21 -= l41 * m.m42, m.m31 -= l41 * m.m43;
  m.m22 -= l42 * m.m42, m.m32 -= l42 * m.m43, m.m33 -= l43 * m.m43;
  x1 -= l41 * x4, x2 -= l42 * x4, x3 -= l43 * x4;

  const double i3 = 1 / m.m33, l31 = m.m31 * i3, l32 = m.m32 * i3;
  m.m11 -= l31 * m.m31, m.m21 -= l31 * m.m32, m.m22 -= l32 * m.m32;
  x1 -= l31 * x3, x2 -= l32 * x3;

  const double i2 = 1 / m.m22, l21 = m.m21 * i2;
  m.m11 -= l21 * m.m21;
  x1 -= l21 * x2;

  x1 /= m.m11;
  x2 = x2 * i2 - l21 * x1;
  x3 = x3 * i3 - l31 * x1 - l32 * x2;
  x4 = x4 * i4 - l41 * x1 - l42 * x2 - l43 * x3;
  ddq[5] = x6 * i6 - l61 * x1 - l62 * x2 - l63 * x3 - l64 * x4;
  ddq[4] = x5 * i5 - l51 * x1 - l52 * x2 - l53 * x3 - l54 * x4;
  ddq[3] = x4;
  ddq[2] = x3;
  ddq[1] = x2;
  ddq[0] = x1;
}

/// Poses, the flange's Jacobian, and tau = Y_r Theta - K_d (dq - dq_r) with a diagonal K_d, sharing the
/// angles.
BENCH_FLOOR_INLINE void floor_fk_jacobian_yr_theta_kd(const double* __restrict q, const double* __restrict dq,
                                                      const double* __restrict dq_r,
                                                      const double* __restrict ddq_r,
                                                      const double* __restrict K_d, double* __restrict X,
                                                      double* __restrict J, double* __restrict tau) {
  double s[6], c[6];
  sincos6(s, c, q[0], q[1], q[2], q[3], q[4], q[5]);
  poses_from(s, c, X);
  jacobian_from(X, J);
  detail::recursion(s + 1, c + 1, dq, dq_r, ddq_r, tau);
  for (int i = 0; i < 6; ++i) tau[i] -= K_d[i] * (dq[i] - dq_r[i]);
}

}  // namespace bench_floor::ur5
