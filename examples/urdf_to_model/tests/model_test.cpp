// The header that urdf_to_model wrote, compiled, against the calibrated model read from the same file.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "robot.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/io/urdf.hpp"

using namespace skinctl;

int main() {
  constexpr std::size_t N = robot::Description::joints;
  const Urdf urdf = read_urdf(URDF_FILE);
  const auto calibrated = calibrated_from<robot::Description>(urdf);
  int wrong = 0;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t p = 0; p < std::size_t(LinkParameter::count); ++p) {
      const double a = robot::Description::links[i].numbers[p], b = calibrated.link(i).numbers[p];
      wrong += !(std::abs(a - b) <= 1e-15 * std::max(1.0, std::abs(b)));
    }
    wrong += robot::Description::names[i] != urdf.joints[i].name;
    wrong += robot::Description::upper[i] != urdf.joints[i].upper;
  }
  wrong += robot::Description::named_links.size() != urdf.frames.size();
  for (const NamedLink& link : robot::Description::named_links) {
    const UrdfFrame& frame = urdf.frame(link.name);
    wrong += link.link != frame.joint || !(link.R == frame.R) || !(link.p == frame.p);
  }
  std::mt19937_64 bits(1);
  std::uniform_real_distribution<double> any(-3, 3);
  double worst = 0;
  for (int k = 0; k < 1000; ++k) {
    JointPosition<N> q;
    JointVelocity<N> dq;
    JointAcceleration<N> ddq;
    for (std::size_t i = 0; i < N; ++i) q[i] = any(bits), dq[i] = any(bits), ddq[i] = any(bits);
    const auto a = inverse_dynamics(robot::Model{}, q, dq, ddq), b = inverse_dynamics(calibrated, q, dq, ddq);
    double size = 0, error = 0;
    for (std::size_t i = 0; i < N; ++i) {
      size = std::max(size, std::abs(b[i]));
      error = std::max(error, std::abs(a[i] - b[i]));
    }
    worst = std::max(worst, error / size);
  }
  std::printf("%s: %zu joints, %d numbers differ, torques by %.2g of the largest\n", URDF_FILE, N, wrong,
              worst);
#ifdef __FMA__
  const double allowed = 4e-15;  // the compiler fuses other products where zeros are types
#else
  const double allowed = 1e-15;
#endif
  return wrong == 0 && worst <= allowed ? 0 : 1;
}
