// What inverse dynamics cost by the number of joints, 2 to 24, and KDL beside it. Chains with random numbers
// known at run time.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Median of 15 rounds, ns a call.
template <class F>
double median_ns(F&& f) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> rounds;
  int calls = 16;
  while (rounds.size() < 15) {
    const auto begin = Clock::now();
    for (int i = 0; i < calls; ++i) f(i);
    const double ns = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
    if (ns < 2e5 && rounds.empty()) {
      calls *= 2;
    } else {
      rounds.push_back(ns / calls);
    }
  }
  std::sort(rounds.begin(), rounds.end());
  return rounds[rounds.size() / 2];
}

template <std::size_t N>
void measure() {
  const auto robot = random_robot<Chain<N>>("chain", N);
  oracle::Random random(N);
  constexpr std::size_t states = 64;
  std::vector<JointPosition<N>> q(states);
  std::vector<JointVelocity<N>> dq(states);
  std::vector<JointAcceleration<N>> ddq(states);
  for (std::size_t s = 0; s < states; ++s)
    for (std::size_t i = 0; i < N; ++i)
      q[s][i] = random.uniform(-3, 3), dq[s][i] = random.uniform(-1, 1), ddq[s][i] = random.uniform(-1, 1);
  JointTorque<N> tau;
  const auto kept = [&] { asm volatile("" : : "g"(&tau) : "memory"); };

  std::printf("| %zu |", N);
  const double ns = median_ns([&](int k) {
    const auto s = static_cast<std::size_t>(k) % states;
    tau = inverse_dynamics(robot.model, q[s], dq[s], ddq[s]);
    kept();
  });
  oracle::KdlOracle peer(robot.table);
  const double by_kdl = median_ns([&](int k) {
    const auto s = static_cast<std::size_t>(k) % states;
    peer.inverse_dynamics(q[s].data, dq[s].data, ddq[s].data, tau.data);
    kept();
  });
  std::printf(" %.0f | %.0f | %.1f |\n", ns, by_kdl, by_kdl / ns);
  std::fflush(stdout);
}

}  // namespace

int main() {
  std::puts(
      "Inverse dynamics of a chain with numbers known at run time, ns\n\n"
      "| joints | skinctl | KDL | KDL / skinctl |\n|---|---|---|---|");
  measure<2>();
  measure<3>();
  measure<4>();
  measure<6>();
  measure<8>();
  measure<12>();
  measure<16>();
  measure<24>();
}
