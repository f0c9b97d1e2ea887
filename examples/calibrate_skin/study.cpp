// From a skin without names to the main job on its files, over seeds.
//
//   calibrate_skin_study [seeds, 8] [by_hand]
//
// Per seed: cells that count, their errors of place and turn against the truth (rms, worst), and force and
// way of the main job with the calibrated file, relative to the job with the true one: the farthest of three
// touches.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "examples/calibrate_skin/judge.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "skinctl/io/skin_file.hpp"

using namespace calibrate_skin;

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 8;
  const bool by_hand = argc > 2;
  std::printf("seed  cells  place [mm]     turn [deg]   force    way       M  following [mrad]  time [s]\n");
  std::vector<double> place, turned, force, way, mass, by_maker, following, following_maker;
  for (int seed = 1; seed <= seeds; ++seed) {
    Options options;
    options.folder = fs::temp_directory_path() / ("calibrate_skin_study_" + std::to_string(seed));
    options.shoulder_by_hand = by_hand;
    fs::remove_all(options.folder);
    fs::create_directories(options.folder);
    const auto from = std::chrono::steady_clock::now();
    try {
      const World world{std::uint64_t(seed)};
      run_steps(options, world);
      write_results(options);
      const auto file = skinctl::read_skin_file((options.folder / "skin.json").string());
      const SkinError e = skin_error(file, world);
      double f = 0, w = 0;
      for (const JobTouch& t : main_job_on(options.folder, world)) {
        f = std::max(f, std::abs(t.force[0] / t.force[1] - 1));
        w = std::max(w, std::abs(t.deflection[0] / t.deflection[1] - 1));
      }
      const MassError m = mass_error(options.folder, world);
      const Json both = read_json(options.folder / "masses.json").at("following");
      const auto follows = both.at("found").get<double>(), maker = both.at("maker").get<double>();
      std::printf(
          "%4d %4zu/%zu  %5.2f %5.2f   %5.2f %5.2f  %4.1f %%  %4.1f %%  %4.1f %%  %5.2f  %5.2f      "
          "%6.1f%s\n",
          seed, e.cells, e.of, 1e3 * e.place_rms, 1e3 * e.place_worst, 57.29578 * e.turn_rms,
          57.29578 * e.turn_worst, 100 * f, 100 * w, 100 * m.found, 1e3 * follows, 1e3 * maker,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count(),
          e.wrong_link > 0 ? "  WRONG LINK" : "");
      std::fflush(stdout);
      place.push_back(e.place_rms), turned.push_back(e.turn_rms), force.push_back(f), way.push_back(w);
      mass.push_back(m.found), by_maker.push_back(m.maker);
      following.push_back(follows), following_maker.push_back(maker);
    } catch (const std::exception& e) {
      std::printf("%4d  failed: %s\n", seed, e.what());
    }
    fs::remove_all(options.folder);
  }
  if (place.empty()) return 1;
  for (auto* all : {&place, &turned, &force, &way, &mass, &by_maker, &following, &following_maker})
    std::sort(all->begin(), all->end());
  const auto row = [](const char* name, const std::vector<double>& v, double unit) {
    std::printf("%-28s median %6.2f  worst %6.2f\n", name, unit * v[v.size() / 2], unit * v.back());
  };
  row("place, rms [mm]", place, 1e3), row("turn, rms [deg]", turned, 57.29578);
  row("force, off by [%]", force, 100), row("way, off by [%]", way, 100);
  row("M, off by [%]", mass, 100), row("  by the maker's numbers", by_maker, 100);
  row("following by torque [mrad]", following, 1e3), row("  with the maker's bodies", following_maker, 1e3);
  return 0;
}
