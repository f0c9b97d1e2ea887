// Dynamics of the UR5, of a calibrated UR5 and of the Allegro hand, beside KDL, MuJoCo and the hand-written
// floor.
#include <memory>

#include "bench/floor/ur5_floor.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/mass_matrix.hpp"
#include "skinctl/model/allegro.hpp"
#include "skinctl/model/ur5.hpp"
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

/// A hand whose fingers run side by side in lanes: numbers of finger f stand at 4f to 4f + 3, as in the tree.
template <class T>
void hand_rows() {
  constexpr std::size_t W = native_lanes<T> >= 4 ? 4 : native_lanes<T>;
  if constexpr (W > 1) {
    using L = Lane<T, W>;
    using Fingers = std::array<CalibratedModel<allegro::Finger, L>, 4 / W>;
    const Fingers fingers = []<std::size_t... G>(std::index_sequence<G...>) {
      return Fingers{allegro::right_fingers<W, T>(G * W)...};
    }(std::make_index_sequence<4 / W>{});
    const auto each = [fingers](const auto& s, auto job) {
      std::array<decltype(job(fingers[0], JointPosition<4, L>{}, JointVelocity<4, L>{},
                              JointAcceleration<4, L>{}, JointTorque<4, L>{})),
                 4 / W>
          out;
      for (std::size_t g = 0; g < 4 / W; ++g)
        out[g] = job(fingers[g], allegro::to_lanes<W>(s.q, g * W), allegro::to_lanes<W>(s.dq, g * W),
                     allegro::to_lanes<W>(s.ddq, g * W), allegro::to_lanes<W>(s.tau, g * W));
      return out;
    };
    const std::string end = std::string("/hand/skinctl/") + bench::scalar_name<T>;
    bench::row<16, T>("dynamics/inverse_dynamics" + end, [each](const auto& s) {
      return each(s, [](const auto& m, const auto& q, const auto& dq, const auto& ddq, const auto&) {
        return inverse_dynamics(m, q, dq, ddq);
      });
    });
    bench::row<16, T>("dynamics/gravity" + end, [each](const auto& s) {
      return each(s, [](const auto& m, const auto& q, const auto&, const auto&, const auto&) {
        return gravity_torque(m, q);
      });
    });
    bench::row<16, T>("dynamics/mass_matrix" + end, [each](const auto& s) {
      return each(s, [](const auto& m, const auto& q, const auto&, const auto&, const auto&) {
        return mass_matrix(m, q);
      });
    });
    bench::row<16, T>("dynamics/forward_dynamics" + end, [each](const auto& s) {
      return each(s, [](const auto& m, const auto& q, const auto& dq, const auto&, const auto& tau) {
        return forward_dynamics(m, q, dq, tau).acceleration;
      });
    });
  }
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
}

const bool registered = [] {
  skinctl_rows<double>("ur5", ur5::Model{});
  skinctl_rows<float>("ur5", ur5::Model{});
  skinctl_rows<double>("ur5-calibrated", calibrated_from<ur5::Description>());
  skinctl_rows<float>("ur5-calibrated", calibrated_from<ur5::Description, float>());
  hand_rows<double>();
  hand_rows<float>();
  floor_rows();
  for (const char* scene : {"ur5", "ur5-calibrated"}) {
    peer_rows<6, oracle::KdlOracle>(scene, "kdl", oracle::ur5());
    peer_rows<6, oracle::MujocoOracle>(scene, "mujoco", oracle::ur5());
  }
  peer_rows<16, oracle::KdlOracle>("hand", "kdl", oracle::allegro_right());
  peer_rows<16, oracle::MujocoOracle>("hand", "mujoco", oracle::allegro_right());
  return true;
}();

}  // namespace
