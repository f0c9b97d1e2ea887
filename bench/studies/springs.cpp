// Springs of 300 to 30 000 N/m at 125 to 1000 Hz: a hand leads an arm with 20 N into a spring, as it is, and
// with the felt mass that `StiffestContact` asks for and a force lead of 2 T.
//
// The force at rest is the hand's, whatever the rate. The largest force is compared with that of a mass m at
// speed v whose push is felt a time T later, `20 N + v (sqrt(k m) + k T)`, m the mass felt at the contact and
// T delay, lag, and one and a half periods.
#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>

#include "bench/studies/worlds/spring_wall.hpp"
#include "skinctl/passivity/stiffest_contact.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double push = 20;

/// The mass that is felt at the cell which meets the spring, at the pose in which the arm begins [kg].
double felt_mass() {
  const JointPosition<6> q{0.1, -1.2, 1.4, -1.8, -1.57, 0.3};
  const ur5::Model model;
  LinkWrenches<ur5::Model, link_bit<2>> w;
  const auto u = unit_wrench(forearm_cells()[1].X_LC);
  w.set<2>(u);
  const auto tau = skin_torque(model, q, w);
  JointAcceleration<6> a;
  math::Ldlt<6, double>(mass_matrix(model, q).data).solve(tau.data, a.data);
  double mobility = 0;
  for (std::size_t i = 0; i < 6; ++i) mobility += tau[i] * a[i];
  return 1 / mobility;
}

}  // namespace

int main() {
  const double m = felt_mass();
  const auto skin = forearm_skin();
  const auto law = SkinJointControl{} + GravityControl{};
  std::printf(
      "A hand leads a UR5 (8 ms delay, 8 ms lag, %.1f kg felt) with 20 N into a spring\n\n"
      "| spring [N/m] | rate [Hz] | as it is, without lead: largest [N] | swing at rest [N] | times heavier "
      "| "
      "speed [m/s] | largest [N] | of the predicted | at rest [N] | swing [N] |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n",
      m);
  int restless = 0, all = 0;
  double furthest = 0;
  for (const double k : {3e2, 1e3, 3e3, 1e4, 3e4})
    for (const Nanoseconds period : {8ms, 4ms, 2ms, 1ms}) {
      auto c = yielding_arm(period);
      c.force_lead = 0ns;
      const auto bare = led_into_a_spring(Cycle(by_position(ur5::Model{}, c), skin, law), c, k, push);
      c.force_lead = 2 * c.total_delay();
      const StiffestContact stiffest{.stiffness = k, .newtons = newtons_per_unit};
      const double heavier = std::max(1.0, stiffest.heavier(by_position(ur5::Model{}, c), skin));
      auto heavy = yielding_arm(period, 8ms, 8ms, heavier);
      heavy.force_lead = c.force_lead;
      const auto kept = led_into_a_spring(
          Cycle(by_position(ur5::Model{}, heavy, stiffest), forearm_skin(heavier), law), heavy, k, push);
      const double T = seconds<double>(c.delay + c.lag) + 1.5 * seconds<double>(period);
      const double predicted = push + kept.speed * (std::sqrt(k * heavier * m) + k * T);
      std::printf("| %.0f | %.0f | %.1f | %.1f | %.1f | %.3f | %.1f | %.2f | %.2f | %.2f |\n", k,
                  1 / seconds<double>(period), bare.peak, bare.swing, heavier, kept.speed, kept.peak,
                  kept.peak / predicted, kept.rest, kept.swing);
      ++all;
      restless += !kept.calm(push) || std::abs(kept.rest - push) > 0.05 * push;
      furthest = std::max(furthest, kept.peak / predicted);
    }
  std::printf("\n%d of %d do not rest within 5 %%; largest force at most %.2f of the predicted\n", restless,
              all, furthest);
  return restless == 0 && furthest <= 1 ? 0 : 1;
}
