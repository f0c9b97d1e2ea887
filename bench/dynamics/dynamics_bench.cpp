// Dynamics of the UR5, of a calibrated UR5 and of the Allegro hand, beside KDL, MuJoCo and the hand-written
// floor.
#include <memory>

#include "bench/studies/floor/hand_floor.hpp"
#include "bench/studies/floor/ur5_floor.hpp"
#include "bench/support/fingers.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"

using namespace skinctl;
using bench::Numbers;

namespace {

/// The five jobs on one model of skinctl.
template <class T, class M>
void skinctl_rows(const std::string& scene, M model) {
  constexpr std::size_t N = M::joints;
  const std::string end = std::string("/") + scene + "/skinctl/" + bench::scalar_name<T>;
  if constexpr (!std::is_empty_v<M>) bench::hide(model);
  bench::row<N, T>("dynamics/inverse_dynamics" + end,
                   [model](const auto& s) { return inverse_dynamics(model, s.q, s.dq, s.ddq); });
  bench::row<N, T>("dynamics/yr_theta" + end,
                   [model](const auto& s) { return yr_theta(model, s.q, s.dq, s.dq_r, s.ddq); });
  bench::row<N, T>("dynamics/gravity" + end, [model](const auto& s) { return gravity_torque(model, s.q); });
  bench::row<N, T>("dynamics/mass_matrix" + end, [model](const auto& s) { return mass_matrix(model, s.q); });
  bench::row<N, T>("dynamics/forward_dynamics" + end,
                   [model](const auto& s) { return forward_dynamics(model, s.q, s.dq, s.tau).acceleration; });
}

/// The hand's four fingers side by side in lanes.
template <class T>
void hand_rows() {
  using F = bench::Fingers<T>;
  const std::string end = std::string("/hand/skinctl/") + bench::scalar_name<T>;
  bench::row<16, T>("dynamics/inverse_dynamics" + end, [hand = F()](const auto& s) {
    return hand.joints([&](const auto& m, std::size_t f) SKINCTL_INLINE_LAMBDA {
      return inverse_dynamics(m, F::of(s.q, f), F::of(s.dq, f), F::of(s.ddq, f));
    });
  });
  bench::row<16, T>("dynamics/gravity" + end, [hand = F()](const auto& s) {
    return hand.joints([&](const auto& m, std::size_t f)
                           SKINCTL_INLINE_LAMBDA { return gravity_torque(m, F::of(s.q, f)); });
  });
  bench::row<16, T>("dynamics/mass_matrix" + end, [hand = F()](const auto& s) {
    return hand.each([&](const auto& m, std::size_t f)
                         SKINCTL_INLINE_LAMBDA { return mass_matrix(m, F::of(s.q, f)); });
  });
  bench::row<16, T>("dynamics/forward_dynamics" + end, [hand = F()](const auto& s) {
    return hand.joints([&](const auto& m, std::size_t f) SKINCTL_INLINE_LAMBDA {
      return forward_dynamics(m, F::of(s.q, f), F::of(s.dq, f), F::of(s.tau, f)).acceleration;
    });
  });
}

/// Diagonal of K_d in the fused row.
constexpr double damping[6] = {7, 6, 5, 4, 3, 2};

/// What a joint controller of the UR5 asks for in one cycle: poses of all links, the Jacobian of the flange,
/// and Y_r Theta - K_d (dq - dq_r), from one set of sines and cosines.
template <class T>
struct Fused {
  using M = ur5::Model;
  static inline const auto X_LF =
      Transform<Link<5>, Flange, T>::translation_xyz(T(0), T(0), T(ur5::Description::d6));

  Poses<M, all_links(6), T> poses;
  decltype(skinctl::jacobian<5>(std::declval<decltype(poses)>(), X_LF)) jacobian;
  JointTorque<6, T> tau;

  Fused(const JointAngles<M, T>& angles, const bench::Motion<6, T>& s, const JointTorque<6, T>& K_d)
      : poses(M{}, angles),
        jacobian(skinctl::jacobian<5>(poses, X_LF)),
        tau(yr_theta(M{}, angles, s.dq, s.dq_r, s.ddq)) {
    for (std::size_t i = 0; i < 6; ++i) tau[i] -= K_d[i] * (s.dq[i] - s.dq_r[i]);
  }
};

template <class T>
void fused_row() {
  const auto K_d = JointTorque<6, T>::generate([](std::size_t i) { return static_cast<T>(damping[i]); });
  bench::row<6, T>(std::string("dynamics/fused/ur5/skinctl/") + bench::scalar_name<T>,
                   [K_d](const auto& s) { return Fused<T>(JointAngles<ur5::Model, T>({}, s.q), s, K_d); });
}

template <std::size_t N, class Oracle>
void peer_rows(const std::string& scene, const std::string& peer, const oracle::Robot& table) {
  const auto robot = std::make_shared<Oracle>(table);
  const std::string end = "/" + scene + "/" + peer + "/double";
  bench::row<N>("dynamics/inverse_dynamics" + end, [robot](const auto& s) {
    Numbers<N> tau;
    robot->inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, tau.data);
    return tau;
  });
  bench::row<N>("dynamics/gravity" + end, [robot](const auto& s) {
    Numbers<N> G;
    robot->gravity(s.q.data, G.data);
    return G;
  });
  bench::row<N>("dynamics/mass_matrix" + end, [robot](const auto& s) {
    Numbers<N * N> M;
    robot->mass_matrix(s.q.data, M.data);
    return M;
  });
  if constexpr (!(std::is_same_v<Oracle, oracle::KdlOracle> && N == 16)) {  // KDL has none for trees
    bench::row<N>("dynamics/forward_dynamics" + end, [robot](const auto& s) {
      Numbers<N> ddq;
      robot->forward_dynamics(s.q.data, s.dq.data, s.tau.data, ddq.data);
      return ddq;
    });
  }
}

void floor_rows() {
  namespace floor = bench_floor::ur5;
  bench::row<6>("dynamics/inverse_dynamics/ur5/floor/double", [](const auto& s) {
    Numbers<6> tau;
    floor::floor_inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, tau.data);
    return tau;
  });
  bench::row<6>("dynamics/yr_theta/ur5/floor/double", [](const auto& s) {
    Numbers<6> tau;
    floor::floor_yr_theta(s.q.data, s.dq.data, s.dq_r.data, s.ddq.data, tau.data);
    return tau;
  });
  bench::row<6>("dynamics/gravity/ur5/floor/double", [](const auto& s) {
    Numbers<6> G;
    floor::floor_gravity(s.q.data, G.data);
    return G;
  });
  bench::row<6>("dynamics/mass_matrix/ur5/floor/double", [](const auto& s) {
    Numbers<36> M;
    floor::floor_mass_matrix(s.q.data, M.data);
    return M;
  });
  bench::row<6>("dynamics/forward_dynamics/ur5/floor/double", [](const auto& s) {
    Numbers<6> ddq;
    floor::floor_forward_dynamics(s.q.data, s.dq.data, s.tau.data, ddq.data);
    return ddq;
  });
  bench::row<6>("dynamics/fused/ur5/floor/double", [](const auto& s) {
    Numbers<72 + 36 + 6> X;
    floor::floor_fk_jacobian_yr_theta_kd(s.q.data, s.dq.data, s.dq_r.data, s.ddq.data, damping, X.data,
                                         X.data + 72, X.data + 108);
    return X;
  });

  namespace hand = bench_floor::allegro;
  bench::row<16>("dynamics/inverse_dynamics/hand/floor/double", [](const auto& s) {
    Numbers<16> tau;
    hand::floor_inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, tau.data);
    return tau;
  });
  bench::row<16>("dynamics/gravity/hand/floor/double", [](const auto& s) {
    Numbers<16> G;
    hand::floor_gravity(s.q.data, G.data);
    return G;
  });
  bench::row<16>("dynamics/mass_matrix/hand/floor/double", [](const auto& s) {
    Numbers<40> M;
    hand::floor_mass_matrix(s.q.data, M.data);
    return M;
  });
  bench::row<16>("dynamics/forward_dynamics/hand/floor/double", [](const auto& s) {
    Numbers<16> ddq;
    hand::floor_forward_dynamics(s.q.data, s.dq.data, s.tau.data, ddq.data);
    return ddq;
  });
}

const bool registered = [] {
  skinctl_rows<double>("ur5", ur5::Model{});
  skinctl_rows<float>("ur5", ur5::Model{});
  skinctl_rows<double>("ur5-calibrated", calibrated_from<ur5::Description>());
  skinctl_rows<float>("ur5-calibrated", calibrated_from<ur5::Description, float>());
  hand_rows<double>();
  hand_rows<float>();
  fused_row<double>();
  fused_row<float>();
  floor_rows();
#if SKINCTL_HAS_KDL
  // KDL has no C dq_r: its inverse dynamics stand for Y_r Theta, for which it would need C and M besides.
  const auto kdl = std::make_shared<oracle::KdlOracle>(oracle::ur5());
  bench::row<6>("dynamics/fused/ur5/kdl/double", [kdl](const auto& s) {
    Numbers<12 * 10 + 36 + 6> X;
    double* tau = X.data + 156;
    kdl->peer_poses(s.q.data, X.data);
    kdl->peer_jacobian(s.q.data, X.data + 120);
    kdl->inverse_dynamics(s.q.data, s.dq.data, s.ddq.data, tau);
    for (std::size_t i = 0; i < 6; ++i) tau[i] -= damping[i] * (s.dq[i] - s.dq_r[i]);
    return X;
  });
  for (const char* scene : {"ur5", "ur5-calibrated"})
    peer_rows<6, oracle::KdlOracle>(scene, "kdl", oracle::ur5());
  peer_rows<16, oracle::KdlOracle>("hand", "kdl", oracle::allegro_right());
#endif
#if SKINCTL_HAS_MUJOCO
  for (const char* scene : {"ur5", "ur5-calibrated"})
    peer_rows<6, oracle::MujocoOracle>(scene, "mujoco", oracle::ur5());
  peer_rows<16, oracle::MujocoOracle>("hand", "mujoco", oracle::allegro_right());
#endif
  return true;
}();

}  // namespace
