// skinctl around an arm that we did not write: MuJoCo, a UR5 under stiff position servos in steps of 0.2 ms.
// `plant [folder for pictures]`: the felt admittance, contacts with walls, the stiffest contact predicted and
// simulated, peak forces with and without skinctl.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "examples/support/svg_plot.hpp"
#include "tests/support/mujoco_plant.hpp"
#include "tests/support/plant_loop.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr Nanoseconds periods[] = {8ms, 2ms, 1ms};
constexpr double delays[] = {0, 0.008, 0.02, 0.04};

double rate(Nanoseconds period) {
  return 1 / seconds<double>(period);
}

void admittance() {
  std::printf(
      "Admittance at the contact, a hand of 800 N/m and 30 N s/m: greatest complex error\n\n"
      "| rate [Hz] | delay [ms] | T [ms] | f [1/s] | error | f with lead [1/s] | error "
      "|\n|---|---|---|---|---|---|---|\n");
  for (const Nanoseconds period : periods)
    for (const double delay : delays) {
      PlantLoop::Setting s{.period = period, .delay = delay, .lead = 0};
      const double T = PlantLoop(s).total_delay(), f = 0.05 / (2 * M_PI * T), fast = 0.3 / (2 * M_PI * T);
      double plain = 0, led = 0;
      for (const double part : {0.3, 0.6, 1.0}) plain = std::max(plain, admittance_error(s, part * f));
      s.lead = 1;
      for (const double part : {0.3, 0.6, 1.0}) led = std::max(led, admittance_error(s, part * fast));
      std::printf("| %.0f | %.0f | %.0f | %.2f | %.1f %% | %.2f | %.1f %% |\n", rate(period), 1e3 * delay,
                  1e3 * T, f, 100 * plain, fast, 100 * led);
      std::fflush(stdout);
    }
}

/// How many times stiffer a wall under its cover may be before it rings.
double margin_of(const PlantLoop::Setting& s, double k) {
  const ContactEnvironment<> e{.stiffness = k, .cover = 3e4, .force_gain = 1 / s.heavier};
  double row[6];
  std::copy_n(PlantLoop(s).contact().row, 6, row);
  return ContactStability<ur5::Model>(ur5::Model{}, PlantLoop::configuration(s), e).stiffest(s.q, row) /
         e.series();
}
/// Felt so much heavier that the margin is 2.
PlantLoop::Setting heavy_enough(PlantLoop::Setting s, double k) {
  while (margin_of(s, k) < 2) s.heavier *= 1.1;
  return s;
}

void walls() {
  std::printf(
      "\nLeaning with 20 N on a wall under a cover of 3e4 N/m, 20 s after contact\n\n"
      "| wall [N/m] | rate [Hz] | delay [ms] | margin | times heavier | mean [N] | swing [N] | calm | swing "
      "as it is, "
      "without lead [N] |\n|---|---|---|---|---|---|---|---|---|\n");
  int calm = 0, all = 0, refused = 0;
  for (const double k : {1e2, 1e3, 1e4, 1e5, 1e6})
    for (const Nanoseconds period : periods)
      for (const double delay : delays) {
        PlantLoop::Setting s{.period = period, .delay = delay, .lean = 20}, late = s;
        late.lead = 0;
        const auto heavy = heavy_enough(s, k);
        PlantLoop loop(heavy), bare(late);
        const auto kept = settle(loop, wall(k), 21), rings = settle(bare, wall(k), 21);
        ++all;
        calm += kept.calm();
        refused += heavy.heavier > 1;
        std::printf("| %.0e | %.0f | %.0f | %.2f | %.2f | %.2f | %.3f | %s | %.2f |\n", k, rate(period),
                    1e3 * delay, margin_of(s, k), heavy.heavier, kept.mean, kept.swing,
                    kept.calm() ? "yes" : "NO", rings.swing);
        std::fflush(stdout);
      }
  std::printf("\n%d of %d calm with the felt mass that the check asks for; %d would be refused without it\n",
              calm, all, refused);
}

void stiffest(const std::string& folder) {
  std::printf(
      "\nStiffest contact, predicted by Nyquist and simulated\n\n"
      "| rate [Hz] | delay [ms] | predicted [N/m] | simulated [N/m] | ratio |\n|---|---|---|---|---|\n");
  std::vector<std::pair<double, double>> points;
  for (const Nanoseconds period : periods)
    for (const double delay : delays)
      for (const double decay : {4.0, 12.0}) {
        PlantLoop::Setting s{.period = period, .delay = delay, .decay = decay};
        const ContactStability<ur5::Model> stability(ur5::Model{}, PlantLoop::configuration(s),
                                                     {.stiffness = 1e4});
        double row[6];
        std::copy_n(PlantLoop(s).contact().row, 6, row);
        const double k = stability.stiffest(s.q, row);
        double low = 0.5 * k, high = 1.6 * k;
        for (int n = 0; n < 7; ++n) {
          const double middle = 0.5 * (low + high);
          (dies_out(s, middle) ? low : high) = middle;
        }
        points.push_back({k, low});
        std::printf("| %.0f | %.0f | %.0f | %.0f | %.2f |\n", rate(period), 1e3 * delay, k, low, low / k);
        std::fflush(stdout);
      }
  std::sort(points.begin(), points.end());
  plotting::Plot plot;
  plot.title = "Stiffest stable contact of a UR5 in MuJoCo: simulated over predicted";
  plot.x_name = "predicted k_max, log10 of N/m";
  plot.y_name = "log10 of N/m";
  plotting::Series predicted{.name = "predicted", .x = {}, .y = {}},
      simulated{.name = "simulated", .x = {}, .y = {}};
  for (const auto& [k, found] : points) {
    predicted.x.push_back(std::log10(k)), predicted.y.push_back(std::log10(k));
    simulated.x.push_back(std::log10(k)), simulated.y.push_back(std::log10(found));
  }
  plot.series = {predicted, simulated};
  if (!folder.empty() && !plotting::write_svg(folder + "/stiffest_contact.svg", plotting::svg_plot(plot)))
    std::exit(1);
}

void peaks() {
  std::printf(
      "\nPeak force of a finger that comes at a speed and stops after a travel beyond the surface\n\n"
      "| stiffness [N/m] | speed [m/s] | travel [mm] | rigid [N] |");
  for (const double delay : {0.0, 0.008, 0.04}) std::printf(" %.0f ms [N] |", 1e3 * delay);
  std::printf("\n|---|---|---|---|---|---|---|\n");
  for (const double k : {1e3, 1e4, 1e5})
    for (const double speed : {0.05, 0.25})
      for (const double travel : {0.01, 0.04}) {
        const double series = k * 3e4 / (k + 3e4);
        const auto peak = [&](PlantLoop::Setting s) {
          PlantLoop loop(s);
          double most = 0;
          while (loop.time() < 1 + travel / speed + 0.5) {
            loop.step([&](double t, double depth, double) {
              const double way = std::min(travel, std::max(0.0, speed * (t - 0.5)));
              return std::max(0.0, series * (depth + way));
            });
            most = std::max(most, loop.force);
          }
          return most;
        };
        std::printf("| %.0e | %.2f | %.0f | %.0f |", k, speed, 1e3 * travel, peak({.yields = false}));
        for (const double delay : {0.0, 0.008, 0.04}) {
          PlantLoop::Setting s{.period = 2ms, .delay = delay};
          s = heavy_enough(s, k);
          std::printf(" %.0f |", peak(s));
        }
        std::printf("\n");
        std::fflush(stdout);
      }
}

}  // namespace

int main(int argc, char** argv) {
  admittance();
  walls();
  stiffest(argc > 1 ? argv[1] : "");
  peaks();
}
