// After a touch of the whole arm: how far beyond its target does any joint swing? Random touches of 10 to 40
// N for 0.3 to 2 s, under way and at rest, at 125 and 500 Hz, for several weights of the skin.
//
//     antagonists [TOUCHES = 60] [PICTURE.svg]
//
// Returns 1 if an overshoot exceeds 5 % of its deflection.
#include <cstdio>
#include <cstdlib>

#include "bench/studies/worlds/touches.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/fusion/describe.hpp"
#include "skinctl/fusion/expression.hpp"

using namespace skinctl;

int main(int argc, char** argv) {
  const int touches = argc > 1 ? std::atoi(argv[1]) : 60;
  bool good = true;
  std::printf("%d touches a row\n%-40s %5s %6s %12s %12s %10s\n", touches, "law", "Hz", "joints",
              "furthest rad", "fastest Nm/s", "overshoot");
  plotting::Plot plot;
  plot.title = "Overshoot after a touch", plot.x_name = "weight of the skin",
  plot.y_name = "of the deflection [%]";
  plot.limits = {{5, "5 %"}};
  for (const char* name : {"125 Hz, K_c 4", "125 Hz, K_c 8", "500 Hz, K_c 4", "500 Hz, K_c 8"})
    plot.series.push_back({name, {}, {}});
  for (const double weight : {1.0, 3.0, 6.0})
    for (const double rate : {125.0, 500.0})
      for (const double K_c : {4.0, 8.0}) {
        const SplineJoint<6> reach({.dt = nanoseconds(1 / rate), .K_c = K_c});
        const auto law = weight * SkinJointControl{} + reach + GravityControl{};
        const auto r = testing::touch_and_release(
            law, [&](const auto& m) { return law.template memory<1>(m).plan.at(0, reach.settings()).q_d; },
            rate, touches);
        std::printf("%-40s %5.0f %6d %12.3f %12.0f %8.2f %%\n", describe(law).c_str(), rate, r.counted,
                    r.furthest, r.fastest, 100 * r.overshoot);
        auto& series = plot.series[(rate > 200 ? 2u : 0u) + (K_c > 6 ? 1u : 0u)];
        series.x.push_back(weight), series.y.push_back(100 * r.overshoot);
        good = good && r.overshoot <= 0.05;
      }
  if (argc > 2 && !plotting::write_svg(argv[2], plotting::svg_plot(plot))) return 1;
  return good ? 0 : 1;
}
