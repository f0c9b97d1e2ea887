// Which virtual mass and damping rest in which contact: `stability_map [folder for pictures]`. One mass with
// friction, position commands, delay; then simulated and predicted k_max of a UR5 at 40 poses.
#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "bench/studies/worlds/wall_contact.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/passivity/contact_stability.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// The least friction [N s/m] with which a virtual mass has a gain margin of 2 in a contact of stiffness `k`,
/// by the same loop as `ContactStability`: `k exp(-s T_d) / ((m s^2 + b s) (tau s + 1))`.
double least_friction(double m, double k, double dead_time, double lag) {
  const auto margin = [&](double b) {
    // Phase -pi: atan(w m / b) + w T_d + atan(w tau) = pi / 2; the left side rises with w.
    double low = 1e-6, high = M_PI / (dead_time + 1e-9);
    for (int n = 0; n < 200; ++n) {
      const double w = 0.5 * (low + high);
      (std::atan(w * m / b) + w * dead_time + std::atan(w * lag) < M_PI / 2 ? low : high) = w;
    }
    const double w = low;
    return w * std::hypot(w * m, b) * std::hypot(1, w * lag) / k;
  };
  double low = 1e-6, high = 1e7;
  for (int n = 0; n < 200; ++n) {
    const double b = std::sqrt(low * high);
    (margin(b) < 2 ? low : high) = b;
  }
  return high;
}

void map(const std::string& folder) {
  std::printf(
      "Least damping [N s/m] with which a virtual mass rests in a contact with a gain margin of 2 (lag 8 "
      "ms); "
      "1.5 k T beside it\n\n| contact [N/m] | rate [Hz] | delay [ms] | 1 kg | 3 kg | 10 kg | 30 kg | 1.5 k T "
      "|\n"
      "|---|---|---|---|---|---|---|---|\n");
  std::vector<plotting::Plot> plots;
  for (const double k : {1e2, 1e3, 1e4, 3e4}) {
    plotting::Plot plot;
    plot.title = "Contact of " + std::to_string(static_cast<int>(k)) + " N/m: stable above the line";
    plot.x_name = "virtual mass, log10 of kg";
    plot.y_name = "damping, log10 of N s/m";
    for (const double rate : {125.0, 500.0, 1000.0})
      for (const double delay : {0.0, 0.008, 0.02, 0.04}) {
        const double dead = delay + 0.5 / rate;
        std::printf("| %.0e | %.0f | %.0f |", k, rate, 1e3 * delay);
        for (const double m : {1.0, 3.0, 10.0, 30.0})
          std::printf(" %.1f |", least_friction(m, k, dead, 0.008));
        std::printf(" %.1f |\n", contact_damping(k, dead + 0.008));
        if (rate != 500) continue;
        plotting::Series line{
            .name = std::to_string(static_cast<int>(1e3 * delay)) + " ms", .x = {}, .y = {}};
        for (double x = -0.5; x <= 2; x += 0.05) {
          line.x.push_back(x);
          line.y.push_back(std::log10(least_friction(std::pow(10, x), k, dead, 0.008)));
        }
        plot.series.push_back(line);
      }
    plots.push_back(plot);
  }
  if (!folder.empty() &&
      !plotting::write_svg(
          folder + "/stability_map.svg",
          plotting::svg_figure("Virtual mass and damping that rest in a contact, at 500 Hz and four delays",
                               plots)))
    std::exit(1);
}

void poses() {
  std::printf(
      "\nStiffest contact of a UR5 at 40 poses: simulated over predicted\n\n"
      "| rate [Hz] | delay [ms] | least | median | greatest |\n|---|---|---|---|---|\n");
  for (const Nanoseconds period : {8ms, 2ms, 1ms})
    for (const double delay : {0.008, 0.02}) {
      std::mt19937_64 rng(7);
      std::uniform_real_distribution<double> u(-1, 1);
      std::vector<double> ratios;
      for (int n = 0; n < 40; ++n) {
        JointPosition<6> q;
        for (double& x : q) x = 2.5 * u(rng);
        double row[6];
        for (std::size_t i = 0; i < 6; ++i)
          row[i] = u(rng) * std::array<double, 6>{0.6, 0.6, 0.4, 0.15, 0.1, 0}[i];
        RobotConfiguration<6> c{
            .limits = limits_of<ur5::Description>(1000.0), .period = period, .delay = nanoseconds(delay)};
        c.lag = 8ms;
        c.virtual_damping = 2 + 3 * (1 + u(rng));
        c.viscous_friction = {10, 10, 6, 2, 1, 0.5};
        const ContactStability<ur5::Model> stability(ur5::Model{}, c, {.stiffness = 1e4});
        const double k = stability.stiffest(q, row);
        double low = 0.5 * k, high = 1.5 * k;
        for (int m = 0; m < 8; ++m) {
          const double middle = 0.5 * (low + high);
          (swings_out(c, q, row, middle) ? low : high) = middle;
        }
        ratios.push_back(low / k);
      }
      std::sort(ratios.begin(), ratios.end());
      std::printf("| %.0f | %.0f | %.3f | %.3f | %.3f |\n", 1 / seconds<double>(period), 1e3 * delay,
                  ratios.front(), ratios[20], ratios.back());
      std::fflush(stdout);
    }
}

}  // namespace

int main(int argc, char** argv) {
  map(argc > 1 ? argv[1] : "");
  poses();
}
