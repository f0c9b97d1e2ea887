// Writes a header with a static model of the robot in a URDF file.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fstream>
#include <vector>

#include "write_model.hpp"

int main(int argc, char** argv) try {
  CLI::App app{"Writes a header with a static skinctl model of the robot in a URDF file."};
  std::string urdf, output;
  urdf_to_model::Settings settings;
  std::vector<double> gravity;
  app.add_option("urdf", urdf, "The robot")->required();
  app.add_option("-o,--output", output, "The header; standard output if left out");
  app.add_option("--namespace", settings.name_space, "Its namespace; the robot's name if left out");
  app.add_option("--gravity", gravity, "In the axes of the base link [m/s^2]; 0 0 -9.81 if left out")
      ->expected(3);
  app.add_option("--snap", settings.snap, "Angles this close to a right one become exact [rad]")
      ->check(CLI::Range(0.0, 1e-3));
  CLI11_PARSE(app, argc, argv);
  for (std::size_t k = 0; k < gravity.size(); ++k) settings.gravity[k] = gravity[k];

  const skinctl::Urdf robot = skinctl::read_urdf(urdf);
  for (const std::string& warning : robot.warnings) std::fprintf(stderr, "%s\n", warning.c_str());
  const std::string text = urdf_to_model::header(robot, settings);
  if (output.empty()) {
    std::fputs(text.c_str(), stdout);
    return 0;
  }
  std::ofstream file(output);
  file << text;
  if (!file.flush()) {
    std::fprintf(stderr, "urdf_to_model: %s cannot be written\n", output.c_str());
    return 1;
  }
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "urdf_to_model: %s\n", e.what());
  return 1;
}
