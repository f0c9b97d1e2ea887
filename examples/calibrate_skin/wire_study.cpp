// A skin whose accelerations come over a socket beside the one that is simulated in the program: places of
// cells, by motion alone.
//
//   calibrate_skin_wire [seeds, 3]
#include <cstdio>
#include <cstdlib>

#include "examples/calibrate_skin/judge.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "skinctl/io/skin_file.hpp"

using namespace calibrate_skin;

namespace {

SkinError in_program(const fs::path& folder, std::uint64_t seed) {
  Options options;
  options.folder = folder;
  options.camera = options.masses = false;
  fs::remove_all(folder);
  fs::create_directories(folder);
  const World world(seed);
  run_steps(options, world);
  write_results(options);
  return skin_error(skinctl::read_skin_file((folder / "skin.json").string()), world);
}

void print(int seed, const char* skin, const SkinError& e) {
  std::printf("| %d | %s | %zu of %zu | %.2f, %.2f mm | %.2f, %.2f deg | %zu |\n", seed, skin, e.cells, e.of,
              1e3 * e.place_rms, 1e3 * e.place_worst, 57.29578 * e.turn_rms, 57.29578 * e.turn_worst,
              e.wrong_link);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 3;
  const fs::path folder = fs::temp_directory_path() / "calibrate_skin_wire";
  std::printf(
      "| seed | skin | cells | place: rms, worst | turn: rms, worst | on a wrong link "
      "|\n|---|---|---|---|---|---|\n");
  try {
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto s = std::uint64_t(seed);
      print(seed, "simulated in the program", in_program(folder, s));
      print(seed, "over a socket", over_wire(folder, s, 0));
      print(seed, "1 % of the datagrams lost", over_wire(folder, s, 0.01));
      print(seed, "5 % of the datagrams lost", over_wire(folder, s, 0.05));
    }
  } catch (const std::exception& e) {
    std::fprintf(stderr, "calibrate_skin_wire: %s\n", e.what());
    return 1;
  }
  fs::remove_all(folder);
  return 0;
}
