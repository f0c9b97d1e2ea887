// playground_numbers: the scenario files of the main job as numbers for the page, one a line.
//
//   playground_numbers WITH_SKIN.toml WITHOUT_SKIN.toml
#include <cstdio>
#include <cstring>
#include <exception>

#include "examples/playground/playground.hpp"

int main(int argc, char** argv) try {
  if (argc != 3)
    return std::fprintf(stderr, "usage: playground_numbers WITH_SKIN.toml WITHOUT_SKIN.toml\n"), 2;
  const auto scenario = playground::read_scenarios(argv[1], argv[2]);
  std::array<double, sizeof scenario / sizeof(double)> numbers;
  std::memcpy(numbers.data(), &scenario, sizeof scenario);
  for (const double x : numbers) std::printf("%.17g\n", x);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "playground_numbers: %s\n", e.what());
  return 1;
}
