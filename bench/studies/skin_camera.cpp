// Patches placed on their links by a camera: 12 views, 0.5 pixels, a tenth to a third of the sightings wrong.
//
//   skin_camera [seeds, 8; NEES is of six times as many]
//
// Errors of the middles of the patches and of their turns, from starts 30 mm and 15 deg off; the camera from
// four hypotheses, three of them 60 mm and 5 deg off, one of them nonsense. Baseline: each patch from the
// single view in which most of its cells are seen, with the camera's true pose. Each pair of numbers: median
// and worst over the seeds.
//
// NEES: of a seed, 24 numbers of four patches. If covariances say how large errors are, it is chi^2 / 24,
// which is 1 +- 0.29; "within 99 %" counts the seeds between its quantiles, 0.412 and 1.898. A mean below 1
// is what the loss leaves out: information is counted by the weights of the loss, 0.85 in the mean for normal
// errors, and not more.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "bench/studies/median_and_worst.hpp"
#include "bench/studies/worlds/skin_sightings.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr double deg = 0.0174532925;

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 8;
  const std::vector<std::string> names = {"shoulder", "upper arm", "forearm", "wrist"};
  std::printf("%-12s %15s %15s %15s %15s %13s %9s\n", "wrong", "one view [mm]", "one view [deg]", "all [mm]",
              "all [deg]", "NEES / 6", "known");
  for (const double wrong : {0.1, 0.2, 0.3}) {
    MedianAndWorst one_p, one_r, p, r, consistency, known;
    for (int seed = 1; seed <= seeds; ++seed) {
      auto rng = seeded(std::uint64_t(seed));
      const SeenArm arm(rng);
      const auto views = arm.views(12, 0.5, wrong, 0.2, rng);
      const std::vector<FitPose> start = arm.placed(0.03, 15 * deg, rng);
      std::vector<FitPose> cameras;
      for (int k = 0; k < 3; ++k) cameras.push_back(SeenArm::about(arm.X_BaseCam, 0.06, 5 * deg, rng));
      cameras.push_back(SeenArm::about(arm.X_BaseCam, 0.6, 60 * deg, rng));
      const auto found = fit_sightings(arm.camera, arm.cells, names, views, start, cameras);
      const auto e = placement_error(found, arm);
      p.values.push_back(1e3 * e.place), r.values.push_back(e.turn / deg);
      consistency.values.push_back(e.nees);
      double n = 0;
      for (const auto& X : found.X_LinkRoot) n += X.known();
      known.values.push_back(n);

      SightingFit single = found;
      for (std::size_t i = 0; i < SeenArm::links; ++i) {
        const auto count = [&](const CameraView& v) {
          return std::count_if(v.seen.begin(), v.seen.end(), [&](const Sighting& s) { return s.patch == i; });
        };
        CameraView view = *std::max_element(
            views.begin(), views.end(), [&](const auto& a, const auto& b) { return count(a) < count(b); });
        std::erase_if(view.seen, [&](const Sighting& s) { return s.patch != i; });
        // The camera is held by lights of its own: its true pose.
        struct Held : detail::SightingProblem {
          [[nodiscard]] State plus(const State& x, const Eigen::VectorXd& d) const {
            Eigen::VectorXd own = d;
            own.head<6>().setZero();
            return SightingProblem::plus(x, own);
          }
        };
        const std::vector<CameraView> alone = {view};
        Held problem{{arm.camera, arm.cells, alone, 0.5, {Loss::Kind::cauchy, 3}}};
        Held::State x = {arm.X_BaseCam};
        x.insert(x.end(), start.begin(), start.end());
        for (const double pixel : {10.0, 4.0, 1.5, 0.5}) {
          problem.pixel = pixel;
          x = least_squares(problem, x).state;
        }
        single.X_LinkRoot[i].value = x[1 + i];
      }
      const auto s = placement_error(single, arm);
      one_p.values.push_back(1e3 * s.place), one_r.values.push_back(s.turn / deg);
    }
    std::printf("%2.0f %%        ", 100 * wrong);
    one_p.print(" %7.2f %7.2f"), one_r.print(" %7.2f %7.2f"), p.print(" %7.3f %7.3f"),
        r.print(" %7.3f %7.3f");
    consistency.print(" %6.2f %6.2f"), known.print(" %4.0f %4.0f");
    double sum = 0, squares = 0, within = 0;
    const int many = 6 * seeds;
    for (int seed = 1; seed <= many; ++seed) {
      auto rng = seeded(std::uint64_t(seed));
      const SeenArm arm(rng);
      const auto views = arm.views(12, 0.5, wrong, 0.2, rng);
      const auto start = arm.placed(0.03, 15 * deg, rng);
      const double nees = placement_error(fit_sightings(arm.camera, arm.cells, names, views, start,
                                                        {SeenArm::about(arm.X_BaseCam, 0.06, 5 * deg, rng)}),
                                          arm)
                              .nees;
      sum += nees / many, squares += nees * nees / many, within += nees > 0.412 && nees < 1.898;
    }
    std::printf("  NEES of %d seeds: mean %.2f +- %.2f, deviation %.2f (0.29), within 99 %%: %.0f\n", many,
                sum, std::sqrt((squares - sum * sum) / many), std::sqrt(squares - sum * sum), within);
    std::fflush(stdout);
  }
  return 0;
}
