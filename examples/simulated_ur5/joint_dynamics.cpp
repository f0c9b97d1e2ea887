#include "examples/simulated_ur5/joint_dynamics.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/robots/ur5.hpp"

namespace simulated_ur5 {

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
  using Vector = Eigen::Matrix<double, joint_count, 1>;
  Eigen::Matrix<double, joint_count, joint_count> A;
  Vector impulse;
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    impulse[i] = h * (torque[k] - bias[k] - held[k]) + drives.rotor_inertia[k] * dq[k];
    for (Eigen::Index j = 0; j < A.cols(); ++j) A(i, j) = mass(k, static_cast<std::size_t>(j));
    impulse[i] += A.row(i) * Eigen::Map<const Vector>(dq.data());
    A(i, i) += drives.rotor_inertia[k] + h * drives.viscous[k];
  }
  const decltype(A) B = A.inverse();
  Joints next{};
  Eigen::Map<Vector>(next.data()) = B * impulse;
  // One joint after the other takes the friction that would stop it, as far as it has it.
  for (int sweep = 0; sweep < 60; ++sweep) {
    double change = 0;
    for (std::size_t i = 0; i < joint_count; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const double f = std::clamp(held[i] + next[i] / (h * B(k, k)), -drives.coulomb[i], drives.coulomb[i]);
      const double more = f - held[i];
      held[i] = f;
      Eigen::Map<Vector>(next.data()) -= h * more * B.col(k);
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
