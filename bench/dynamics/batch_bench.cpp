// Rollouts: 256 robots in lanes and one at a time; time is that of all of them.
#include "bench/support/bench.hpp"
#include "bench/support/rows.hpp"
#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/model/batch.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

constexpr std::size_t robots = 256;

template <std::size_t N, class T>
struct Pool {
  std::vector<JointPosition<N, T>> q;
  std::vector<JointVelocity<N, T>> dq;
  std::vector<JointAcceleration<N, T>> ddq;
  std::vector<JointTorque<N, T>> tau;

  Pool() : q(robots), dq(robots), ddq(robots), tau(robots) {
    bench::States<N, T> states;
    for (std::size_t k = 0; k < robots; ++k) {
      const auto& s = states.next();
      q[k] = s.q, dq[k] = s.dq, ddq[k] = s.ddq, tau[k] = s.tau;
    }
  }
};

/// `work(model, q, dq, ddq, tau)` of all robots, in lanes and one at a time.
template <class T, class M, class F>
void rows(const std::string& job, const std::string& scene, const M& model, F work) {
  constexpr std::size_t N = M::joints;
  const std::string end = std::string("/") + bench::scalar_name<T>;
  using Result = decltype(work(model, JointPosition<N, T>{}, JointVelocity<N, T>{}, JointAcceleration<N, T>{},
                               JointTorque<N, T>{}));
  const std::string name = "dynamics/" + job + "/256-" + scene;
  benchmark::RegisterBenchmark((name + "/skinctl-lanes" + end).c_str(), [=](benchmark::State& state) {
    const Pool<N, T> pool;
    const ModelBatch<M, T> batch(model, robots);
    std::vector<Result> out(robots);
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      batch.for_each_group([&](const auto& m, const auto& g) {
        g.write(work(m, g.read(pool.q), g.read(pool.dq), g.read(pool.ddq), g.read(pool.tau)), out);
      });
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    }
  });
  benchmark::RegisterBenchmark((name + "/skinctl" + end).c_str(), [=](benchmark::State& state) {
    const Pool<N, T> pool;
    std::vector<Result> out(robots);
    const bench::CountAllocations counted(state);
    for (auto _ : state) {
      for (std::size_t k = 0; k < robots; ++k)
        out[k] = work(model, pool.q[k], pool.dq[k], pool.ddq[k], pool.tau[k]);
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    }
  });
}

template <class T, class M>
void all(const std::string& scene, const M& model) {
  rows<T>("batch-inverse-dynamics", scene, model,
          [](const auto& m, const auto& q, const auto& dq, const auto& ddq, const auto&) {
            return inverse_dynamics(m, q, dq, ddq);
          });
  rows<T>("batch-gravity", scene, model,
          [](const auto& m, const auto& q, const auto&, const auto&, const auto&) {
            return gravity_torque(m, q);
          });
  rows<T>(
      "batch-mass-matrix", scene, model,
      [](const auto& m, const auto& q, const auto&, const auto&, const auto&) { return mass_matrix(m, q); });
  rows<T>("batch-forward-dynamics", scene, model,
          [](const auto& m, const auto& q, const auto& dq, const auto&, const auto& tau) {
            return forward_dynamics(m, q, dq, tau).acceleration;
          });
}

const bool registered = [] {
  all<double>("ur5", ur5::Model{});
  all<float>("ur5", ur5::Model{});
  all<double>("ur5-calibrated", calibrated_from<ur5::Description>());
  return true;
}();

}  // namespace
