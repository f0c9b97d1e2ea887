// The floor under skin torque on a UR5: sums over flat arrays and a backward pass, written out by hand with
// this robot's zeros, ones and lengths.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/studies/floor/floor.hpp"

namespace bench_floor {

/// An array that starts at a cache line.
template <class T>
class Line {
 public:
  explicit Line(std::size_t count) : lines_((count * sizeof(T) + 63) / 64) {}
  T* data() noexcept { return lines_[0].numbers; }
  const T* data() const noexcept { return lines_[0].numbers; }
  std::size_t size() const noexcept { return lines_.size() * (64 / sizeof(T)); }

 private:
  struct alignas(64) One {
    T numbers[64 / sizeof(T)] = {};
  };
  std::vector<One> lines_;
};

/// `w += sum of u s` over `blocks` pairs of blocks, `u` as `[block][6][W]`.
template <class T>
BENCH_FLOOR_INLINE void weigh(const T* u, const T* s, std::size_t pairs, T* w) {
  using L = skinctl::Lane<T>;
  constexpr std::size_t W = skinctl::native_lanes<T>;
  L a0(0), a1(0), a2(0), a3(0), a4(0), a5(0), b0(0), b1(0), b2(0), b3(0), b4(0), b5(0);
  for (; pairs > 0; --pairs, u += 12 * W, s += 2 * W) {
    const L x = L::load(s), y = L::load(s + W);
    a0 = a0 + x * L::load(u);
    a1 = a1 + x * L::load(u + W);
    a2 = a2 + x * L::load(u + 2 * W);
    a3 = a3 + x * L::load(u + 3 * W);
    a4 = a4 + x * L::load(u + 4 * W);
    a5 = a5 + x * L::load(u + 5 * W);
    b0 = b0 + y * L::load(u + 6 * W);
    b1 = b1 + y * L::load(u + 7 * W);
    b2 = b2 + y * L::load(u + 8 * W);
    b3 = b3 + y * L::load(u + 9 * W);
    b4 = b4 + y * L::load(u + 10 * W);
    b5 = b5 + y * L::load(u + 11 * W);
  }
  w[0] = sum(a0 + b0), w[1] = sum(a1 + b1), w[2] = sum(a2 + b2);
  w[3] = sum(a3 + b3), w[4] = sum(a4 + b4), w[5] = sum(a5 + b5);
}

/// Joint torques of a wrench on each of the six links: `w` six rows of force and moment.
template <class T>
BENCH_FLOOR_INLINE void ur5_backward(const T* sin, const T* cos, const T (*w)[6], T* tau) {
  constexpr T d1 = T(0.089159), a2 = T(-0.425), a3 = T(-0.39225), d4 = T(0.10915), d5 = T(0.09465);
  T fx = w[5][0], fy = w[5][1], fz = w[5][2], nx = w[5][3], ny = w[5][4], nz = w[5][5];
  tau[5] = nz;
  const auto turn = [](T s, T c, T& x, T& y) {
    const T t = c * x - s * y;
    y = s * x + c * y;
    x = t;
  };
  // Rx(-90): (x, z, -y); origin (0, 0, d5).
  turn(sin[5], cos[5], fx, fy), turn(sin[5], cos[5], nx, ny);
  T gx = fx, gy = fz, gz = -fy, mx = nx - d5 * gy, my = nz + d5 * gx, mz = -ny;
  fx = w[4][0] + gx, fy = w[4][1] + gy, fz = w[4][2] + gz;
  nx = w[4][3] + mx, ny = w[4][4] + my, nz = w[4][5] + mz;
  tau[4] = nz;
  // Rx(90): (x, -z, y); origin (0, 0, d4).
  turn(sin[4], cos[4], fx, fy), turn(sin[4], cos[4], nx, ny);
  gx = fx, gy = -fz, gz = fy, mx = nx - d4 * gy, my = -nz + d4 * gx, mz = ny;
  fx = w[3][0] + gx, fy = w[3][1] + gy, fz = w[3][2] + gz;
  nx = w[3][3] + mx, ny = w[3][4] + my, nz = w[3][5] + mz;
  tau[3] = nz;
  // Origin (a3, 0, 0).
  turn(sin[3], cos[3], fx, fy), turn(sin[3], cos[3], nx, ny);
  nx = w[2][3] + nx, ny = w[2][4] + ny - a3 * fz, nz = w[2][5] + nz + a3 * fy;
  fx = w[2][0] + fx, fy = w[2][1] + fy, fz = w[2][2] + fz;
  tau[2] = nz;
  // Origin (a2, 0, 0).
  turn(sin[2], cos[2], fx, fy), turn(sin[2], cos[2], nx, ny);
  nx = w[1][3] + nx, ny = w[1][4] + ny - a2 * fz, nz = w[1][5] + nz + a2 * fy;
  fx = w[1][0] + fx, fy = w[1][1] + fy, fz = w[1][2] + fz;
  tau[1] = nz;
  // Rx(90), origin (0, 0, d1); of link 0 only the moment about z is needed.
  turn(sin[1], cos[1], nx, ny);
  static_cast<void>(d1);
  tau[0] = w[0][5] + ny;
}

}  // namespace bench_floor
