// Poses and Jacobians of the UR5 and of the Allegro hand, beside KDL, MuJoCo and the hand-written floor.
#include <memory>

#include "bench/studies/floor/hand_floor.hpp"
#include "bench/studies/floor/ur5_floor.hpp"
#include "bench/support/fingers.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"

using namespace skinctl;
using bench::Numbers;

namespace {

/// Poses of all links and the Jacobian of the frame at `X_LP` on link `I`, made where they are returned: to
/// copy the poses costs as much as to compute them.
template <std::size_t I, class M, class P, class T>
struct PosesAndJacobian {
  Poses<M, all_links(M::joints), T> poses;
  Jacobian<M, ancestors<M>(I), P, P, Base, T> jacobian;

  SKINCTL_INLINE PosesAndJacobian(const M& model, const JointPosition<M::joints, T>& q,
                                  const Transform<Link<I>, P, T>& X_LP)
      : poses(model, q), jacobian(skinctl::jacobian<I>(poses, X_LP)) {}
};

template <class T, class M>
void arm_rows(const std::string& scene, M model) {
  const std::string end = "/" + scene + "/skinctl/" + bench::scalar_name<T>;
  if constexpr (!std::is_empty_v<M>) bench::hide(model);
  bench::row<6, T>("kinematics/poses" + end, [model](const auto& s) { return link_poses(model, s.q); });
  const auto X_LF = Transform<Link<5>, Flange, T>::translation_xyz(T(0), T(0), T(ur5::Description::d6));
  bench::row<6, T>("kinematics/jacobian" + end, [model, X_LF](const auto& s) {
    return PosesAndJacobian<5, M, Flange, T>(model, s.q, X_LF);
  });
  bench::row<6, T>("kinematics/poses/" + scene + "-links-0-2/skinctl/" + bench::scalar_name<T>,
                   [model](const auto& s) { return link_poses<0b111>(model, s.q); });
}

/// The hand's four fingers side by side in lanes.
template <class T>
void hand_rows() {
  using F = bench::Fingers<T>;
  using L = typename F::Model::scalar;
  const std::string end = std::string("/hand/skinctl/") + bench::scalar_name<T>;
  bench::row<16, T>("kinematics/poses" + end, [hand = F()](const auto& s) {
    return hand.each([&](const auto& m, std::size_t f)
                         SKINCTL_INLINE_LAMBDA { return link_poses(m, F::of(s.q, f)); });
  });
  bench::row<16, T>("kinematics/jacobian" + end, [hand = F()](const auto& s) {
    return hand.each([&](const auto& m, std::size_t f) SKINCTL_INLINE_LAMBDA {
      return PosesAndJacobian<3, typename F::Model, Link<3>, L>(m, F::of(s.q, f), {});
    });
  });
}

template <std::size_t N, class Oracle>
void peer_rows(const std::string& scene, const std::string& peer, const oracle::Robot& table) {
  const auto robot = std::make_shared<Oracle>(table);
  const std::string end = "/" + scene + "/" + peer + "/double";
  bench::row<N>("kinematics/poses" + end, [robot](const auto& s) {
    Numbers<12 * (N + 4)> X;
    robot->peer_poses(s.q.data, X.data);
    return X;
  });
  bench::row<N>("kinematics/jacobian" + end, [robot](const auto& s) {
    Numbers<6 * N*(N == 16 ? 4 : 1)> J;
    robot->peer_jacobian(s.q.data, J.data);
    return J;
  });
}

const bool registered = [] {
  arm_rows<double>("ur5", ur5::Model{});
  arm_rows<float>("ur5", ur5::Model{});
  arm_rows<double>("ur5-calibrated", calibrated_from<ur5::Description>());
  hand_rows<double>();
  hand_rows<float>();
  // The same hand as one tree of 16 joints, as skin on it needs it.
  const auto tree = allegro::right_hand();
  bench::row<16>("kinematics/poses/hand-tree/skinctl/double",
                 [tree](const auto& s) { return link_poses(tree, s.q); });
  bench::row<16>("kinematics/poses/hand/floor/double", [](const auto& s) {
    Numbers<192> X;
    bench_floor::allegro::floor_fk(s.q.data, X.data);
    return X;
  });
  bench::row<6>("kinematics/poses/ur5/floor/double", [](const auto& s) {
    Numbers<72> X;
    bench_floor::ur5::floor_fk(s.q.data, X.data);
    return X;
  });
  bench::row<6>("kinematics/jacobian/ur5/floor/double", [](const auto& s) {
    Numbers<72 + 36> X;
    bench_floor::ur5::floor_fk_jacobian(s.q.data, X.data, X.data + 72);
    return X;
  });
#if SKINCTL_HAS_KDL
  peer_rows<6, oracle::KdlOracle>("ur5", "kdl", oracle::ur5());
  peer_rows<16, oracle::KdlOracle>("hand", "kdl", oracle::allegro_right());
#endif
#if SKINCTL_HAS_MUJOCO
  peer_rows<6, oracle::MujocoOracle>("ur5", "mujoco", oracle::ur5());
  peer_rows<16, oracle::MujocoOracle>("hand", "mujoco", oracle::allegro_right());
#endif
  return true;
}();

}  // namespace
