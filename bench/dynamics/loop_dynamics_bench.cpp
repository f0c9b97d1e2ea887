// Poses and inverse dynamics by a loop at run time: a chain of 64 joints, and a UR5 beside straight-line
// code.
#include "bench/support/rows.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/loop_dynamics.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

template <std::size_t N, class M>
void rows(const std::string& scene, const M& model) {
  bench::row<N>("dynamics/loop-poses/" + scene + "/skinctl/double",
                [model](const auto& s) { return loop_poses(model, s.q); });
  bench::row<N>("dynamics/loop-yr-theta/" + scene + "/skinctl/double",
                [model](const auto& s) { return loop_yr_theta(model, s.q, s.dq, s.dq_r, s.ddq); });
}

CalibratedModel<Chain<64>> chain_of_64() {
  CalibratedModel<Chain<64>>::Links links;
  for (std::size_t i = 0; i < 64; ++i) links[i] = ur5::Description::links[i % 6];
  return CalibratedModel<Chain<64>>(links);
}

const bool registered = [] {
  const auto arm = calibrated_from<ur5::Description>();
  rows<6>("ur5-calibrated", arm);
  bench::row<6>("dynamics/straight-yr-theta/ur5-calibrated/skinctl/double",
                [arm](const auto& s) { return yr_theta(arm, s.q, s.dq, s.dq_r, s.ddq); });
  rows<64>("chain-64", chain_of_64());
  return true;
}();

}  // namespace
