// Poses and Jacobians of the UR5 and of the Allegro hand, beside KDL, MuJoCo and the hand-written floor.
#include <memory>

#include "bench/floor/ur5_floor.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/model/allegro.hpp"
#include "skinctl/model/ur5.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/mujoco_oracle.hpp"

using namespace skinctl;
using bench::Numbers;

namespace {

template <class T, class M>
void arm_rows(const std::string& scene, M model) {
  const std::string end = "/" + scene + "/skinctl/" + bench::scalar_name<T>;
  if constexpr (!std::is_empty_v<M>) bench::hide(model);
  bench::row<6, T>("kinematics/poses" + end, [model](const auto& s) { return link_poses(model, s.q); });
  const auto X_LF = Transform<Link<5>, Flange, T>::translation_xyz(T(0), T(0), T(ur5::Description::d6));
  bench::row<6, T>("kinematics/jacobian" + end, [model, X_LF](const auto& s) {
    const auto poses = link_poses(model, s.q);
    return std::pair(poses, jacobian<5>(poses, X_LF));
  });
  bench::row<6, T>("kinematics/poses/" + scene + "-links-0-2/skinctl/" + bench::scalar_name<T>,
                   [model](const auto& s) { return link_poses<0b111>(model, s.q); });
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
  const auto hand = allegro::right_hand();
  bench::row<16>("kinematics/poses/hand/skinctl/double",
                 [hand](const auto& s) { return link_poses(hand, s.q); });
  bench::row<16>("kinematics/jacobian/hand/skinctl/double", [hand](const auto& s) {
    const auto poses = link_poses(hand, s.q);
    return std::tuple(poses, jacobian<3>(poses), jacobian<7>(poses), jacobian<11>(poses),
                      jacobian<15>(poses));
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
  peer_rows<6, oracle::KdlOracle>("ur5", "kdl", oracle::ur5());
  peer_rows<6, oracle::MujocoOracle>("ur5", "mujoco", oracle::ur5());
  peer_rows<16, oracle::KdlOracle>("hand", "kdl", oracle::allegro_right());
  peer_rows<16, oracle::MujocoOracle>("hand", "mujoco", oracle::allegro_right());
  return true;
}();

}  // namespace
