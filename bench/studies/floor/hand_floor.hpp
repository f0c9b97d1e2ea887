// The floor under the Allegro hand's numbers: its four fingers, one topology, written out by hand on a vector
// of four doubles.
#pragma once

#include <array>
#include <utility>

#include "bench/studies/floor/floor.hpp"
#include "tests/support/robot_table.hpp"

/// Joints 4f .. 4f+3 are finger f. The frames are those of `oracle::allegro_right()`, each turned about its
/// own z axis by `quarter_turns`, so that in all four fingers joint 1 is placed by Rx(-pi/2), joint 2 by
/// Rx(alpha) at (x, 0, z), and joint 3 by a step along x. Arrays must not overlap.
namespace bench_floor::allegro {

/// Lanes: all fingers where the target has registers of 32 bytes, else two by two.
inline constexpr std::size_t lanes = skinctl::native_lanes<double> >= 4 ? 4 : 2;
using L = skinctl::Lane<double, lanes>;

/// By how many quarter turns about z the frames differ from the table's: [finger][joint].
inline constexpr int quarter_turns[4][4] = {{0, 3, 3, 3}, {0, 3, 3, 3}, {0, 3, 3, 3}, {3, 2, 3, 3}};

namespace detail {
using Row = std::array<double, 4>;  // one number of each finger

/// Moments S (integral of r r' dm) about the frame's origin.
struct Moments {
  Row xx, yy, zz, xy, xz, yz;
};

struct Constants {
  Row R[9], p[3];        // base of each finger, row-major
  Row p1[3], J0;         // joint 1 on link 0; inertia of link 0 about its joint
  Row px2, pz2, ca, sa;  // joint 2 on link 1, alpha
  Row px3;               // joint 3 on link 2
  Row m1, m2, m3, h3;    // masses; first moment of link 3 with its tip, along x
  Moments S1, S2, S3;
};

/// Rz of quarter turns, exact.
inline std::array<double, 9> quarter(int turns) {
  constexpr double cosine[4] = {1, 0, -1, 0}, sine[4] = {0, 1, 0, -1};
  const double c = cosine[turns & 3], s = sine[turns & 3];
  return {c, -s, 0, s, c, 0, 0, 0, 1};
}

inline Constants make_constants() {
  using namespace oracle::table_detail;
  const oracle::Robot hand = oracle::without_fixed(oracle::allegro_right());
  Constants k{};
  for (std::size_t f = 0; f < 4; ++f) {
    std::array<double, 9> parent = quarter(0);
    for (std::size_t j = 0; j < 4; ++j) {
      const oracle::Body& b = hand.bodies[4 * f + j];
      const auto turn = quarter(quarter_turns[f][j]);
      const auto R = product(product(transposed(parent), b.R), turn);
      const auto p = product(transposed(parent), b.p), c = product(transposed(turn), b.com);
      auto I = product(product(transposed(turn), b.inertia), turn);
      const auto at_com = point_inertia(b.mass, c);
      for (std::size_t i = 0; i < 9; ++i) I[i] += at_com[i];
      const double half = (I[0] + I[4] + I[8]) / 2;
      parent = turn;
      Moments* S = j == 1 ? &k.S1 : j == 2 ? &k.S2 : &k.S3;
      if (j > 0) {
        S->xx[f] = half - I[0], S->yy[f] = half - I[4], S->zz[f] = half - I[8];
        S->xy[f] = -I[1], S->xz[f] = -I[2], S->yz[f] = -I[5];
      }
      if (j == 0) {
        for (std::size_t i = 0; i < 9; ++i) k.R[i][f] = R[i];
        for (std::size_t i = 0; i < 3; ++i) k.p[i][f] = p[i];
        k.J0[f] = I[8];
      } else if (j == 1) {
        for (std::size_t i = 0; i < 3; ++i) k.p1[i][f] = p[i];
        k.m1[f] = b.mass;
      } else if (j == 2) {
        k.px2[f] = p[0], k.pz2[f] = p[2], k.m2[f] = b.mass;
        k.ca[f] = R[8], k.sa[f] = -R[5];
      } else {
        k.px3[f] = p[0], k.m3[f] = b.mass, k.h3[f] = b.mass * c[0];
      }
    }
  }
  return k;
}
inline const Constants constants = make_constants();

BENCH_FLOOR_INLINE L at(const Row& row, std::size_t first) {
  return L::load(row.data() + first);
}

/// Joint j of the fingers `first` and after.
BENCH_FLOOR_INLINE L gather(const double* x, std::size_t first, std::size_t j) {
  return [&]<std::size_t... F>(std::index_sequence<F...>) __attribute__((always_inline)) {
    return L(typename L::Vector{x[4 * (first + F) + j]...});
  }(std::make_index_sequence<lanes>{});
}
BENCH_FLOOR_INLINE void scatter(L v, double* x, std::size_t first, std::size_t j) {
  for (std::size_t k = 0; k < lanes; ++k) x[4 * (first + k) + j] = v[k];
}

struct V {
  L x, y, z;
};
/// Rz(q)' v and Rz(q) v.
BENCH_FLOOR_INLINE V into(L s, L c, V v) {
  return {c * v.x + s * v.y, c * v.y - s * v.x, v.z};
}
BENCH_FLOOR_INLINE V out_of(L s, L c, V v) {
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}
/// Rx(alpha)' v and Rx(alpha) v.
BENCH_FLOOR_INLINE V tilt(L s, L c, V v) {
  return {v.x, c * v.y + s * v.z, c * v.z - s * v.y};
}
BENCH_FLOOR_INLINE V untilt(L s, L c, V v) {
  return {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
}

/// Sines and cosines of the joints' angles from x to x, in this header's frames.
struct Angles {
  L s[4], c[4];
  BENCH_FLOOR_INLINE Angles(const double* q, std::size_t first) {
    for (std::size_t j = 0; j < 4; ++j) {
      const auto y = skinctl::math::sincos(gather(q, first, j));
      s[j] = y.sin, c[j] = y.cos;
    }
    const L s1 = s[1];  // a quarter turn back
    s[1] = -c[1], c[1] = s1;
    const L s2 = s[2];  // the thumb a quarter turn ahead
    const L is_thumb = at({0, 0, 0, 1}, first);
    const auto thumb = is_thumb > L(0.5);
    s[2] = select(thumb, c[2], s2);
    c[2] = select(thumb, -s2, c[2]);
  }
};

/// E = [alpha]x + w w' - (w . w) 1, and the moment about the origin of a body with moments S.
struct Spin {
  L xx, xy, xz, yx, yy, yz, zx, zy, zz, sx, sy, sz;
  BENCH_FLOOR_INLINE Spin(const V& w, const V& al) {
    sx = w.x * w.x, sy = w.y * w.y, sz = w.z * w.z;
    const L pxy = w.x * w.y, pxz = w.x * w.z, pyz = w.y * w.z;
    xx = -(sy + sz), yy = -(sx + sz), zz = -(sx + sy);
    xy = pxy - al.z, yx = pxy + al.z, xz = pxz + al.y, zx = pxz - al.y, yz = pyz - al.x, zy = pyz + al.x;
  }
  BENCH_FLOOR_INLINE V moment(const Moments& S, std::size_t first) const {
    const L Sxx = at(S.xx, first), Syy = at(S.yy, first), Szz = at(S.zz, first);
    const L Sxy = at(S.xy, first), Sxz = at(S.xz, first), Syz = at(S.yz, first);
    return {zx * Sxy + zy * Syy + (sz - sy) * Syz - yx * Sxz - yz * Szz,
            xy * Syz + xz * Szz + (sx - sz) * Sxz - zx * Sxx - zy * Sxy,
            yx * Sxx + yz * Sxz + (sy - sx) * Sxy - xy * Syy - xz * Syz};
  }
};

/// M a + C(w) w + G of the fingers from `first` on.
BENCH_FLOOR_INLINE void recursion(const Angles& t, const L* v, const L* a, std::size_t first, L* tau) {
  const Constants& k = constants;
  const L g = L(9.81);
  const L px = at(k.p1[0], first), py = at(k.p1[1], first);
  const V g0 = into(t.s[0], t.c[0], {g * at(k.R[6], first), g * at(k.R[7], first), g * at(k.R[8], first)});
  const L v00 = v[0] * v[0];
  // Link 0 turns about its own z axis only; link 1 sees (0, -v0, 0) before its joint.
  const V w1{-t.s[1] * v[0], -t.c[1] * v[0], v[1]};
  const V al1{v[1] * w1.y - t.s[1] * a[0], -(t.c[1] * a[0]) - v[1] * w1.x, a[1]};
  const V a1 = into(t.s[1], t.c[1], {g0.x - v00 * px - a[0] * py, -g0.z, g0.y + a[0] * px - v00 * py});
  const Spin e1(w1, al1);

  const L x2 = at(k.px2, first), z2 = at(k.pz2, first), sa = at(k.sa, first), ca = at(k.ca, first);
  V w2 = into(t.s[2], t.c[2], tilt(sa, ca, w1)), al2 = into(t.s[2], t.c[2], tilt(sa, ca, al1));
  al2 = {al2.x + v[2] * w2.y, al2.y - v[2] * w2.x, al2.z + a[2]};
  w2.z = w2.z + v[2];
  const V a2 = into(
      t.s[2], t.c[2],
      tilt(sa, ca,
           {a1.x + x2 * e1.xx + z2 * e1.xz, a1.y + x2 * e1.yx + z2 * e1.yz, a1.z + x2 * e1.zx + z2 * e1.zz}));
  const Spin e2(w2, al2);

  const L x3 = at(k.px3, first);
  V w3 = into(t.s[3], t.c[3], w2), al3 = into(t.s[3], t.c[3], al2);
  al3 = {al3.x + v[3] * w3.y, al3.y - v[3] * w3.x, al3.z + a[3]};
  w3.z = w3.z + v[3];
  const V a3 = into(t.s[3], t.c[3], {a2.x + x3 * e2.xx, a2.y + x3 * e2.yx, a2.z + x3 * e2.zx});
  const Spin e3(w3, al3);

  const L m3 = at(k.m3, first), h3 = at(k.h3, first);
  V f{m3 * a3.x + h3 * e3.xx, m3 * a3.y + h3 * e3.yx, m3 * a3.z + h3 * e3.zx};
  V n = e3.moment(k.S3, first);
  n = {n.x, n.y - h3 * a3.z, n.z + h3 * a3.y};
  tau[3] = n.z;

  const L m2 = at(k.m2, first);
  f = out_of(t.s[3], t.c[3], f), n = out_of(t.s[3], t.c[3], n);
  V own = e2.moment(k.S2, first);
  n = {n.x + own.x, n.y - x3 * f.z + own.y, n.z + x3 * f.y + own.z};
  f = {f.x + m2 * a2.x, f.y + m2 * a2.y, f.z + m2 * a2.z};
  tau[2] = n.z;

  const L m1 = at(k.m1, first);
  f = untilt(sa, ca, out_of(t.s[2], t.c[2], f)), n = untilt(sa, ca, out_of(t.s[2], t.c[2], n));
  own = e1.moment(k.S1, first);
  n = {n.x - z2 * f.y + own.x, n.y + z2 * f.x - x2 * f.z + own.y, n.z + x2 * f.y + own.z};
  f = {f.x + m1 * a1.x, f.y + m1 * a1.y, f.z + m1 * a1.z};
  tau[1] = n.z;
  // Of link 0 only the moment about z: y of link 1 back by its joint, reversed; the force's y is z of link 1.
  const L fx = t.c[1] * f.x - t.s[1] * f.y;
  tau[0] = px * f.z - py * fx - (t.s[1] * n.x + t.c[1] * n.y) + at(k.J0, first) * a[0];
}

/// First moment and moments of a link and what it carries, about its origin, in its axes.
struct Composite {
  V h;
  L xx, yy, zz, xy, xz, yz;
};
BENCH_FLOOR_INLINE Composite out_of(L s, L c, const Composite& b) {
  const L u = c * b.xx - s * b.xy, v = c * b.xy - s * b.yy, xx = c * u - s * v;
  return {out_of(s, c, b.h),  xx, b.xx + b.yy - xx, b.zz, s * u + c * v, c * b.xz - s * b.yz,
          s * b.xz + c * b.yz};
}
BENCH_FLOOR_INLINE Composite untilt(L s, L c, const Composite& b) {
  const L u = c * b.yy - s * b.yz, v = c * b.yz - s * b.zz, yy = c * u - s * v;
  return {untilt(s, c, b.h),   b.xx,         yy, b.yy + b.zz - yy, c * b.xy - s * b.xz,
          s * b.xy + c * b.xz, s * u + c * v};
}

/// Lower half of the 4 x 4 block of each finger.
struct Mass {
  L m00, m10, m11, m20, m21, m22, m30, m31, m32, m33;

  BENCH_FLOOR_INLINE Mass(const Angles& t, std::size_t first) {
    const Constants& k = constants;
    const L px = at(k.p1[0], first), py = at(k.p1[1], first);
    const L x2 = at(k.px2, first), z2 = at(k.pz2, first), sa = at(k.sa, first), ca = at(k.ca, first);
    const L x3 = at(k.px3, first), m3 = at(k.m3, first), h3 = at(k.h3, first);
    const auto to1 = [&](V& f, V& n) __attribute__((always_inline)) {
      f = untilt(sa, ca, out_of(t.s[2], t.c[2], f)), n = untilt(sa, ca, out_of(t.s[2], t.c[2], n));
      n = {n.x - z2 * f.y, n.y + z2 * f.x - x2 * f.z, n.z + x2 * f.y};
    };
    const auto to0 = [&](const V& f, const V& n) __attribute__((always_inline)) {
      return px * f.z - py * (t.c[1] * f.x - t.s[1] * f.y) - (t.s[1] * n.x + t.c[1] * n.y);
    };
    // A unit acceleration of joint i asks for the wrench (z x h; -Sxz, -Syz, Sxx + Syy).
    const L zero = L(0.0);
    const Composite b3{{h3, zero, zero},   at(k.S3.xx, first), at(k.S3.yy, first), at(k.S3.zz, first),
                       at(k.S3.xy, first), at(k.S3.xz, first), at(k.S3.yz, first)};
    m33 = b3.xx + b3.yy;
    // Link 3's force is along its y axis.
    V f{-t.s[3] * h3, t.c[3] * h3, zero}, n = out_of(t.s[3], t.c[3], V{-b3.xz, -b3.yz, m33});
    n.z = n.z + x3 * f.y;
    m32 = n.z;
    to1(f, n);
    m31 = n.z;
    m30 = to0(f, n);

    const L m23 = at(k.m2, first) + m3, m123 = at(k.m1, first) + m23;
    const V hx{t.c[3] * h3, t.s[3] * h3, zero};
    const L u = t.c[3] * b3.xx - t.s[3] * b3.xy, w = t.c[3] * b3.xy - t.s[3] * b3.yy,
            xx3 = t.c[3] * u - t.s[3] * w;
    const Composite b2{{hx.x + m3 * x3, hx.y, zero},
                       at(k.S2.xx, first) + xx3 + x3 * (hx.x + hx.x + m3 * x3),
                       at(k.S2.yy, first) + b3.xx + b3.yy - xx3,
                       at(k.S2.zz, first) + b3.zz,
                       at(k.S2.xy, first) + t.s[3] * u + t.c[3] * w + x3 * hx.y,
                       at(k.S2.xz, first) + t.c[3] * b3.xz - t.s[3] * b3.yz,
                       at(k.S2.yz, first) + t.s[3] * b3.xz + t.c[3] * b3.yz};
    m22 = b2.xx + b2.yy;
    f = {-b2.h.y, b2.h.x, zero}, n = {-b2.xz, -b2.yz, m22};
    to1(f, n);
    m21 = n.z;
    m20 = to0(f, n);

    const Composite b = untilt(sa, ca, out_of(t.s[2], t.c[2], b2));
    const L hx1 = b.h.x + m23 * x2, hz1 = b.h.z + m23 * z2;
    const Composite b1{{hx1, b.h.y, hz1},
                       at(k.S1.xx, first) + b.xx + x2 * (b.h.x + hx1),
                       at(k.S1.yy, first) + b.yy,
                       at(k.S1.zz, first) + b.zz + z2 * (b.h.z + hz1),
                       at(k.S1.xy, first) + b.xy + x2 * b.h.y,
                       at(k.S1.xz, first) + b.xz + x2 * hz1 + b.h.x * z2,
                       at(k.S1.yz, first) + b.yz + b.h.y * z2};
    m11 = b1.xx + b1.yy;
    m10 = to0({-b1.h.y, b1.h.x, zero}, {-b1.xz, -b1.yz, m11});
    // About z of link 0, which is -y of link 1 before its joint.
    const L s = t.s[1], c = t.c[1];
    const L across = c * (c * b1.xx - s * b1.xy) - s * (c * b1.xy - s * b1.yy) + b1.zz;
    const L hx0 = c * b1.h.x - s * b1.h.y, hy0 = b1.h.z;
    m00 = at(k.J0, first) + across + px * (hx0 + hx0 + m123 * px) + py * (hy0 + hy0 + m123 * py);
  }
};
}  // namespace detail

/// `X[joint][number][finger]`, 4 x 12 x 4: axes x, y, z of each link in the palm, then its origin.
BENCH_FLOOR_INLINE void floor_fk(const double* __restrict q, double* __restrict X) {
  using namespace detail;
  const Constants& k = constants;
  for (std::size_t first = 0; first < 4; first += lanes) {
    const Angles t(q, first);
    const auto put = [&](std::size_t j, const V& x, const V& y, const V& z, const V& p)
                         __attribute__((always_inline)) {
                           const L numbers[12] = {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z, p.x, p.y, p.z};
                           for (std::size_t i = 0; i < 12; ++i)
                             numbers[i].store(X + 4 * (12 * j + i) + first);
                         };
    const auto mix = [](L a, const V& u, L b, const V& v) __attribute__((always_inline)) {
      return V{a * u.x + b * v.x, a * u.y + b * v.y, a * u.z + b * v.z};
    };
    const auto step = [](const V& p, L a, const V& u) __attribute__((always_inline)) {
      return V{p.x + a * u.x, p.y + a * u.y, p.z + a * u.z};
    };
    const V bx{at(k.R[0], first), at(k.R[3], first), at(k.R[6], first)};
    const V by{at(k.R[1], first), at(k.R[4], first), at(k.R[7], first)};
    const V z0{at(k.R[2], first), at(k.R[5], first), at(k.R[8], first)};
    const V p0{at(k.p[0], first), at(k.p[1], first), at(k.p[2], first)};
    const V x0 = mix(t.c[0], bx, t.s[0], by), y0 = mix(t.c[0], by, -t.s[0], bx);
    put(0, x0, y0, z0, p0);
    const V p1 = step(step(step(p0, at(k.p1[0], first), x0), at(k.p1[1], first), y0), at(k.p1[2], first), z0);
    const V x1 = mix(t.c[1], x0, -t.s[1], z0), y1 = mix(-t.c[1], z0, -t.s[1], x0);
    put(1, x1, y1, y0, p1);
    const L sa = at(k.sa, first), ca = at(k.ca, first);
    const V p2 = step(step(p1, at(k.px2, first), x1), at(k.pz2, first), y0);
    const V yt = mix(ca, y1, sa, y0), z2 = mix(ca, y0, -sa, y1);
    const V x2 = mix(t.c[2], x1, t.s[2], yt), y2 = mix(t.c[2], yt, -t.s[2], x1);
    put(2, x2, y2, z2, p2);
    const V x3 = mix(t.c[3], x2, t.s[3], y2), y3 = mix(t.c[3], y2, -t.s[3], x2);
    put(3, x3, y3, z2, step(p2, at(k.px3, first), x2));
  }
}

BENCH_FLOOR_INLINE void floor_inverse_dynamics(const double* __restrict q, const double* __restrict dq,
                                               const double* __restrict ddq, double* __restrict tau) {
  for (std::size_t first = 0; first < 4; first += lanes) {
    const detail::Angles t(q, first);
    L v[4], a[4], result[4];
    for (std::size_t j = 0; j < 4; ++j)
      v[j] = detail::gather(dq, first, j), a[j] = detail::gather(ddq, first, j);
    detail::recursion(t, v, a, first, result);
    for (std::size_t j = 0; j < 4; ++j) detail::scatter(result[j], tau, first, j);
  }
}

BENCH_FLOOR_INLINE void floor_gravity(const double* __restrict q, double* __restrict G) {
  using namespace detail;
  const Constants& k = constants;
  const L g = L(9.81);
  for (std::size_t first = 0; first < 4; first += lanes) {
    const Angles t(q, first);
    // The vertical seen by the four links, as in `recursion`.
    const V g0 = into(t.s[0], t.c[0], {g * at(k.R[6], first), g * at(k.R[7], first), g * at(k.R[8], first)});
    const V g1 = into(t.s[1], t.c[1], {g0.x, -g0.z, g0.y});
    const L sa = at(k.sa, first), ca = at(k.ca, first);
    const V g2 = into(t.s[2], t.c[2], tilt(sa, ca, g1));
    const L m3 = at(k.m3, first), h3 = at(k.h3, first), m23 = at(k.m2, first) + m3;
    const L m3x3 = m3 * at(k.px3, first), m123 = at(k.m1, first) + m23;
    // Joints 2 and 3 are parallel. The other links' centres of mass lie at their origins.
    const L tau3 = h3 * (t.c[3] * g2.y - t.s[3] * g2.x);
    const V h2 = untilt(sa, ca, out_of(t.s[2], t.c[2], V{m3x3 + t.c[3] * h3, t.s[3] * h3, L(0.0)}));
    const L h1x = h2.x + m23 * at(k.px2, first), h1z = h2.z + m23 * at(k.pz2, first);
    const L h0x = m123 * at(k.p1[0], first) + (t.c[1] * h1x - t.s[1] * h2.y);
    const L h0y = m123 * at(k.p1[1], first) + h1z;
    scatter(h0x * g0.y - h0y * g0.x, G, first, 0);
    scatter(h1x * g1.y - h2.y * g1.x, G, first, 1);
    scatter(tau3 + m3x3 * g2.y, G, first, 2);
    scatter(tau3, G, first, 3);
  }
}

/// `M[entry][finger]`, 10 x 4: the lower half of each finger's 4 x 4 block, row by row.
BENCH_FLOOR_INLINE void floor_mass_matrix(const double* __restrict q, double* __restrict M) {
  for (std::size_t first = 0; first < 4; first += lanes) {
    const detail::Mass m(detail::Angles(q, first), first);
    const L entries[10] = {m.m00, m.m10, m.m11, m.m20, m.m21, m.m22, m.m30, m.m31, m.m32, m.m33};
    for (std::size_t i = 0; i < 10; ++i) entries[i].store(M + 4 * i + first);
  }
}

/// Acceleration under the torque tau; M = L' D L eliminated from the finger tips.
BENCH_FLOOR_INLINE void floor_forward_dynamics(const double* __restrict q, const double* __restrict dq,
                                               const double* __restrict tau, double* __restrict ddq) {
  using detail::gather;
  for (std::size_t first = 0; first < 4; first += lanes) {
    const detail::Angles t(q, first);
    const L zero[4] = {L(0.0), L(0.0), L(0.0), L(0.0)};
    L v[4], b[4];
    for (std::size_t j = 0; j < 4; ++j) v[j] = gather(dq, first, j);
    detail::recursion(t, v, zero, first, b);
    detail::Mass m(t, first);
    L x0 = gather(tau, first, 0) - b[0], x1 = gather(tau, first, 1) - b[1];
    L x2 = gather(tau, first, 2) - b[2], x3 = gather(tau, first, 3) - b[3];
    const L one = L(1.0);
    const L i3 = one / m.m33, l30 = m.m30 * i3, l31 = m.m31 * i3, l32 = m.m32 * i3;
    m.m00 -= l30 * m.m30, m.m10 -= l30 * m.m31, m.m20 -= l30 * m.m32;
    m.m11 -= l31 * m.m31, m.m21 -= l31 * m.m32, m.m22 -= l32 * m.m32;
    x0 -= l30 * x3, x1 -= l31 * x3, x2 -= l32 * x3;
    const L i2 = one / m.m22, l20 = m.m20 * i2, l21 = m.m21 * i2;
    m.m00 -= l20 * m.m20, m.m10 -= l20 * m.m21, m.m11 -= l21 * m.m21;
    x0 -= l20 * x2, x1 -= l21 * x2;
    const L i1 = one / m.m11, l10 = m.m10 * i1;
    m.m00 -= l10 * m.m10, x0 -= l10 * x1;
    x0 = x0 / m.m00;
    x1 = x1 * i1 - l10 * x0;
    x2 = x2 * i2 - l20 * x0 - l21 * x1;
    x3 = x3 * i3 - l30 * x0 - l31 * x1 - l32 * x2;
    detail::scatter(x0, ddq, first, 0), detail::scatter(x1, ddq, first, 1);
    detail::scatter(x2, ddq, first, 2), detail::scatter(x3, ddq, first, 3);
  }
}

}  // namespace bench_floor::allegro
