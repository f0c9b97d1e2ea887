#include "examples/simulated_ur5/joint_dynamics.hpp"

#include <algorithm>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/robots/ur5.hpp"

namespace simulated_ur5 {
namespace {

using Matrix = std::array<Joints, joint_count>;

/// Of a symmetric positive definite matrix, by Gauss-Jordan elimination.
Matrix inverse(Matrix a) {
  Matrix b{};
  for (std::size_t i = 0; i < joint_count; ++i) b[i][i] = 1;
  for (std::size_t k = 0; k < joint_count; ++k) {
    const double pivot = 1 / a[k][k];
    for (std::size_t j = 0; j < joint_count; ++j) {
      a[k][j] *= pivot;
      b[k][j] *= pivot;
    }
    for (std::size_t i = 0; i < joint_count; ++i) {
      if (i == k) continue;
      const double f = a[i][k];
      for (std::size_t j = 0; j < joint_count; ++j) {
        a[i][j] -= f * a[k][j];
        b[i][j] -= f * b[k][j];
      }
    }
  }
  return b;
}

}  // namespace

Bodies makers_bodies() {
  const auto maker = skinctl::calibrated_from<skinctl::ur5::Description>();
  Bodies::Links links;
  for (std::size_t i = 0; i < joint_count; ++i) links[i] = maker.link(i);
  return Bodies(links);
}

Joints torque_of_motion(const Joints& q, const Joints& dq, const Joints& ddq, const Bodies& bodies,
                        const JointDrives& drives) {
  const auto tau = skinctl::inverse_dynamics(bodies, skinctl::JointPosition<joint_count>(q),
                                             skinctl::JointVelocity<joint_count>(dq),
                                             skinctl::JointAcceleration<joint_count>(ddq));
  Joints out{};
  for (std::size_t i = 0; i < joint_count; ++i) out[i] = tau[i] + drives.rotor_inertia[i] * ddq[i];
  return out;
}

Joints speeds_after(const Joints& q, const Joints& dq, const Joints& torque, const Bodies& bodies,
                    const JointDrives& drives, double h, Joints& held) {
  using skinctl::JointAcceleration, skinctl::JointPosition, skinctl::JointVelocity;
  const auto mass = skinctl::mass_matrix(bodies, JointPosition<joint_count>(q));
  const auto bias =
      skinctl::inverse_dynamics(bodies, JointPosition<joint_count>(q), JointVelocity<joint_count>(dq),
                                JointAcceleration<joint_count>());
  Matrix A{};
  Joints impulse{};
  for (std::size_t i = 0; i < joint_count; ++i) {
    impulse[i] = h * (torque[i] - bias[i]);
    for (std::size_t j = 0; j < joint_count; ++j) {
      A[i][j] = mass(i, j);
      impulse[i] += mass(i, j) * dq[j];
    }
    A[i][i] += drives.rotor_inertia[i] + h * drives.viscous[i];
    impulse[i] += drives.rotor_inertia[i] * dq[i];
  }
  const Matrix B = inverse(A);
  Joints next{};
  for (std::size_t i = 0; i < joint_count; ++i)
    for (std::size_t j = 0; j < joint_count; ++j) next[i] += B[i][j] * (impulse[j] - h * held[j]);
  // One joint after the other takes the friction that would stop it, as far as it has it.
  for (int sweep = 0; sweep < 60; ++sweep) {
    double change = 0;
    for (std::size_t i = 0; i < joint_count; ++i) {
      const double f = std::clamp(held[i] + next[i] / (h * B[i][i]), -drives.coulomb[i], drives.coulomb[i]);
      const double more = f - held[i];
      held[i] = f;
      for (std::size_t j = 0; j < joint_count; ++j) next[j] -= h * B[j][i] * more;
      change = std::max(change, std::abs(more));
    }
    if (change < 1e-10) break;
  }
  return next;
}

double kinetic_energy(const Joints& q, const Joints& dq, const Bodies& bodies, const JointDrives& drives) {
  const auto mass = skinctl::mass_matrix(bodies, skinctl::JointPosition<joint_count>(q));
  double energy = 0;
  for (std::size_t i = 0; i < joint_count; ++i) {
    energy += 0.5 * drives.rotor_inertia[i] * dq[i] * dq[i];
    for (std::size_t j = 0; j < joint_count; ++j) energy += 0.5 * dq[i] * mass(i, j) * dq[j];
  }
  return energy;
}

}  // namespace simulated_ur5
