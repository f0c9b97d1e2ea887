// What poses, G, inverse dynamics and M of a UR5 cost on a Cortex-M3, which has no floating point, in
// instructions: float and double in software, and fixed point.
#include "../../bench/studies/fixed_point/fixed.hpp"

#include <cstdint>
#include <cstdio>

#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

// The processor's own timer, at 25 MHz: 40 instructions a tick where each takes a nanosecond of the
// emulator's clock.
volatile std::uint32_t* const systick = reinterpret_cast<volatile std::uint32_t*>(0xE000E010);

template <class V>
void keep(V& value) {
  asm volatile("" : : "g"(&value) : "memory");
}
template <class F>
unsigned instructions(F&& f) {
  constexpr unsigned times = 50;
  systick[1] = 0xFFFFFF;
  systick[2] = 0;
  systick[0] = 5;
  for (unsigned i = 0; i < times; ++i) f();
  return 40 * (0xFFFFFF - systick[2]) / times;
}

template <class T>
void row(const char* name) {
  const ur5::Model model;
  JointPosition<6, T> q{T(0.3), T(-1.2), T(1.4), T(-1.8), T(-1.57), T(0.3)};
  JointVelocity<6, T> dq{T(0.1), T(0.2), T(-0.3), T(0.1), T(0.2), T(-0.1)};
  JointAcceleration<6, T> ddq{T(0.1), T(0.2), T(0.3), T(0.4), T(0.5), T(0.6)};
  const auto pose = instructions([&] {
    keep(q);
    const Poses<ur5::Model, link_bit<5>, T> poses(model, q);
    keep(poses);
  });
  const auto gravity = instructions([&] {
    keep(q);
    const auto tau = gravity_torque(model, q);
    keep(tau);
  });
  const auto torque = instructions([&] {
    keep(q);
    const auto tau = inverse_dynamics(model, q, dq, ddq);
    keep(tau);
  });
  const auto mass = instructions([&] {
    keep(q);
    const auto m = mass_matrix(model, q);
    keep(m);
  });
  const auto tau = inverse_dynamics(model, q, dq, ddq);
  std::printf(
      "%-7s pose %6u  G %6u  inverse dynamics %6u  M %6u instructions; torque of the shoulder %.4f N m\n",
      name, pose, gravity, torque, mass, double(tau[1]));
}

}  // namespace

int main() {
  row<double>("double");
  row<float>("float");
  row<math::Q15_16>("Q15.16");
  row<math::Q11_20>("Q11.20");
  row<math::Q9_22>("Q9.22");
  return 0;
}
