// What inverse dynamics cost by the number of joints, 2 to 64: straight-line code, the run-time loop, and KDL
// beside them: `joints [folder for the picture]`. Chains with random numbers known at run time.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

#include "examples/support/svg_plot.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"
#include "skinctl/dynamics/loop_dynamics.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Joints from which on straight-line code costs the compiler more than it gives.
constexpr std::size_t longest_unrolled = 24;

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

struct Curve {
  const char* name;
  std::vector<double> joints, ns;
};

template <std::size_t N>
void measure(Curve& straight, Curve& loop, Curve& kdl) {
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
  if constexpr (N <= longest_unrolled) {
    const double ns = median_ns([&](int k) {
      const auto s = static_cast<std::size_t>(k) % states;
      tau = inverse_dynamics(robot.model, q[s], dq[s], ddq[s]);
      kept();
    });
    straight.joints.push_back(double(N)), straight.ns.push_back(ns);
    std::printf(" %.0f |", ns);
  } else {
    std::printf(" - |");
  }
  const double by_loop = median_ns([&](int k) {
    const auto s = static_cast<std::size_t>(k) % states;
    tau = loop_yr_theta(robot.model, q[s], dq[s], dq[s], ddq[s]);
    kept();
  });
  loop.joints.push_back(double(N)), loop.ns.push_back(by_loop);
  oracle::KdlOracle peer(robot.table);
  const double by_kdl = median_ns([&](int k) {
    const auto s = static_cast<std::size_t>(k) % states;
    peer.inverse_dynamics(q[s].data, dq[s].data, ddq[s].data, tau.data);
    kept();
  });
  kdl.joints.push_back(double(N)), kdl.ns.push_back(by_kdl);
  const double best = N <= longest_unrolled ? straight.ns.back() : by_loop;
  std::printf(" %.0f | %.0f | %.1f |\n", by_loop, by_kdl, by_kdl / best);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
  const std::string folder = count > 1 ? words[1] : ".";
  Curve straight{"skinctl, straight-line", {}, {}}, loop{"skinctl, loop", {}, {}}, kdl{"KDL", {}, {}};
  std::puts(
      "Inverse dynamics of a chain with numbers known at run time, ns\n\n| joints | straight-line | loop | "
      "KDL "
      "| KDL / skinctl |\n|---|---|---|---|---|");
  measure<2>(straight, loop, kdl);
  measure<3>(straight, loop, kdl);
  measure<4>(straight, loop, kdl);
  measure<6>(straight, loop, kdl);
  measure<8>(straight, loop, kdl);
  measure<12>(straight, loop, kdl);
  measure<16>(straight, loop, kdl);
  measure<24>(straight, loop, kdl);
  measure<32>(straight, loop, kdl);
  measure<48>(straight, loop, kdl);
  measure<64>(straight, loop, kdl);

  const auto series = [](const Curve& c) { return plotting::Series{c.name, c.joints, c.ns}; };
  plotting::Plot ours, all;
  ours.title = "Inverse dynamics by the number of joints";
  ours.x_name = all.x_name = "joints";
  ours.y_name = all.y_name = "time [ns]";
  ours.series = {series(straight), series(loop)};
  all.title = "The same beside KDL";
  all.series = {series(straight), series(loop), series(kdl)};
  const std::string path = folder + "/cost_by_joints.svg";
  return plotting::write_svg(path, plotting::svg_figure("What inverse dynamics costs", {ours, all})) ? 0 : 1;
}
