// How a frame gives way (J M^-1 J'), kinetic energy and centre of mass, beside Eigen from our J and M, and
// MuJoCo.
#include <Eigen/Cholesky>
#include <memory>

#include "bench/support/rows.hpp"
#include "skinctl/dynamics/energy.hpp"
#include "skinctl/dynamics/operational_mobility.hpp"
#include "skinctl/kinematics/centre_of_mass.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/mujoco_oracle.hpp"

using namespace skinctl;

namespace {

template <class T>
void rows() {
  const std::string end = std::string("/ur5/skinctl/") + bench::scalar_name<T>;
  const ur5::Model model;
  bench::row<6, T>("dynamics/mobility" + end, [model](const auto& s) {
    const JointAngles<ur5::Model, T> angles(model, s.q);
    const auto J = jacobian<5>(Poses<ur5::Model, 0b111111, T>(model, angles));
    return operational_mobility(J, MassFactors<ur5::Model, T>(mass_matrix(model, angles)));
  });
  bench::row<6, T>("dynamics/centre-of-mass" + end,
                   [model](const auto& s) { return centre_of_mass(model, s.q); });
  bench::row<6, T>("dynamics/kinetic-energy-of-links" + end,
                   [model](const auto& s) { return kinetic_energy(model, s.q, s.dq); });
}

void twin_rows() {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;
  const ur5::Model model;
  bench::row<6>("dynamics/mobility/ur5/eigen/double", [model](const auto& s) {
    const Matrix J = as_eigen(jacobian<5>(link_poses(model, s.q)));
    const auto M = mass_matrix(model, s.q);
    return Matrix(J * Eigen::Map<const Matrix>(M.data).ldlt().solve(J.transpose()));
  });
  bench::row<6>("dynamics/kinetic-energy-of-links/ur5/eigen/double", [model](const auto& s) {
    const auto M = mass_matrix(model, s.q);
    const Eigen::Map<const Vector> dq(s.dq.data);
    return 0.5 * dq.dot(Eigen::Map<const Matrix>(M.data) * dq);
  });
#if SKINCTL_HAS_MUJOCO
  const auto mujoco = std::make_shared<oracle::MujocoOracle>(oracle::ur5());
  bench::row<6>("dynamics/mobility/ur5/mujoco/double", [mujoco](const auto& s) {
    bench::Numbers<36> A;
    mujoco->mobility(5, s.q.data, A.data);
    return A;
  });
  bench::row<6>("dynamics/kinetic-energy-of-links/ur5/mujoco/double", [mujoco](const auto& s) {
    bench::Numbers<2> energy;
    mujoco->energy(s.q.data, s.dq.data, energy.data[0], energy.data[1]);
    return energy;
  });
#endif
}

const bool registered = (rows<double>(), rows<float>(), twin_rows(), true);

}  // namespace
