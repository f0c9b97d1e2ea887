// What the trade study leaves open, measured: what long sub-steps do to stiff contacts, the degree of the sines' polynomials, and the order of the velocity estimator.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "bench/studies/worlds/wall_contact.hpp"
#include "skinctl/math/sincos.hpp"
#include "skinctl/sensing/velocity_estimator.hpp"
#include "tests/support/closed_loop.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

RobotConfiguration<6> arm(Nanoseconds substep, double viscous) {
  RobotConfiguration<6> c{.limits = limits_of<ur5::Description>(1000.0),
                          .period = 8ms,
                          .delay = 8ms,
                          .lag = 8ms,
                          .virtual_damping = 4};
  c.viscous_friction = JointTorque<6>::constant(viscous);
  c.dead_band = JointPosition<6>::constant(0.02);
  c.substep = substep;
  return c;
}

void stiff_contact() {
  std::puts(
      "\nThe stiffest contact of a UR5 at the tool that swings out, without damping and with 100 N s/m along "
      "it [N/m]\n");
  std::puts("| sub-step [ms] | without | with damping |\n|---|---|---|");
  const double row[1][6] = {{0.1, 0.5, 0.4, 0.1, 0.02, 0}};
  const JointPosition<6> pose(home);
  for (const Nanoseconds h :
       {Nanoseconds(500us), Nanoseconds(1ms), Nanoseconds(2ms), Nanoseconds(4ms), Nanoseconds(8ms)}) {
    double found[2];
    for (int damped = 0; damped < 2; ++damped) {
      const auto c = arm(h, 2);
      double low = 10, high = 1e5;
      while (high / low > 1.01) {
        const double middle = std::sqrt(low * high);
        (swings_out(c, pose, row, middle, damped * 100.0) ? low : high) = middle;
      }
      found[damped] = low;
    }
    std::printf("| %.1f | %.0f | %.0f |\n", milliseconds(h), found[0], found[1]);
  }
}

/// Polynomials of `n` coefficients in r^2, through Chebyshev's points of |r| <= pi/4: r p(r^2) for the sine.
template <std::size_t n>
struct Polynomial {
  double c[n];
  explicit Polynomial(bool sine) {
    double a[n][n + 1];
    const double top = std::pow(std::numbers::pi / 4, 2);
    for (std::size_t k = 0; k < n; ++k) {
      const double z = 0.5 * top * (1 + std::cos(std::numbers::pi * (2.0 * double(k) + 1) / (2.0 * n))),
                   r = std::sqrt(z);
      for (std::size_t j = 0; j < n; ++j) a[k][j] = std::pow(z, double(j));
      a[k][n] = sine ? std::sin(r) / r : std::cos(r);
    }
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t best = k;
      for (std::size_t i = k; i < n; ++i)
        if (std::abs(a[i][k]) > std::abs(a[best][k])) best = i;
      std::swap(a[k], a[best]);
      for (std::size_t i = 0; i < n; ++i)
        if (i != k)
          for (std::size_t j = n + 1; j-- > k;) a[i][j] -= a[i][k] / a[k][k] * a[k][j];
    }
    for (std::size_t k = 0; k < n; ++k) c[k] = a[k][n] / a[k][k];
  }
  template <class T>
  SKINCTL_INLINE T operator()(const T& z) const {
    T y(c[n - 1]);
    for (std::size_t k = n - 1; k-- > 0;) y = y * z + T(c[k]);
    return y;
  }
};
template <class F>
double nanoseconds_of(F&& f) {
  double best = 1e300;
  for (int k = 0; k < 200; ++k) {
    const auto a = std::chrono::steady_clock::now();
    for (int i = 0; i < 200; ++i) f();
    best = std::min(
        best, std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - a).count() / 200);
  }
  return best;
}
template <std::size_t n>
void degree() {
  const Polynomial<n> s(true), c(false);
  double worst = 0;
  for (int k = -20000; k <= 20000; ++k) {
    const double r = k * (std::numbers::pi / 4 / 20000), z = r * r;
    worst = std::max({worst, std::abs(r * s(z) - std::sin(r)), std::abs(c(z) - std::cos(r))});
  }
  // Eight angles in lanes, the reduction of the angle left out: it is the same for all.
  using L = Lane<double, native_lanes<double>>;
  constexpr std::size_t blocks = 8 / L::lanes;
  double angles[8] = {0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7, -0.7};
  double out[16];
  const double ns = nanoseconds_of([&] {
    asm volatile("" : : "g"(angles) : "memory");
    for (std::size_t b = 0; b < blocks; ++b) {
      const L r = L::load(angles + b * L::lanes), z = r * r;
      (r * s(z)).store(out + b * L::lanes);
      c(z).store(out + 8 + b * L::lanes);
    }
    asm volatile("" : : "g"(out) : "memory");
  });
  std::printf("| %zu | %.1e | %.2g | %.1f |\n", n, worst, 1e3 * worst * 1.3 * 6, ns);
}

template <std::size_t Degree>
void estimator(const char* name) {
  using Estimator = VelocityEstimator<1, 5, Degree>;
  const Estimator e({.period = 3ms, .longest = 50ms, .step = 8.9e-5});
  typename Estimator::Memory m{};
  double worst = 0;
  const double w = 2 * std::numbers::pi;
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.003 * k, q = std::round(0.5 * std::sin(w * t) / 8.9e-5) * 8.9e-5;
    JointPosition<1> position;
    position[0] = q;
    static_cast<void>(e.observe(m, position, k * 3ms));
    if (k > 10) worst = std::max(worst, std::abs(m.state.dq[0] - 0.5 * w * std::cos(w * t)));
  }
  std::printf("| %s | %.4f | %.4f |\n", name, worst, worst * 0.1);
}

}  // namespace

int main() {
  stiff_contact();
  std::puts(
      "\nDegree of the polynomials for sine and cosine, in double: error, what that is at a tool 1.3 m away "
      "behind six joints "
      "[mm], time of eight angles [ns]\n\n| coefficients | error | mm | ns |\n|---|---|---|---|");
  degree<3>(), degree<4>(), degree<5>(), degree<6>(), degree<7>();
  std::puts(
      "\nVelocity from five positions of an Allegro at 333 Hz, steps of 0.089 mrad, 1 Hz and 0.5 rad: error "
      "[rad/s], of a "
      "fingertip [m/s]\n\n| estimator | rad/s | m/s |\n|---|---|---|");
  estimator<1>("line");
  estimator<2>("parabola");
  return 0;
}
