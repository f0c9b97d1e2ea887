// Writes a header with a static model of the robot in a URDF file.
#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdio>
#include <exception>
#include <fstream>
#include <vector>

#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "write_model.hpp"

namespace {

/// `joint=position`, with the last `=` as the one that counts.
void add_lock(skinctl::UrdfOptions& options, const std::string& text) {
  const std::size_t at = text.rfind('=');
  double position = 0;
  const char* const end = text.data() + text.size();
  if (at == std::string::npos || at == 0 || std::from_chars(text.data() + at + 1, end, position).ptr != end ||
      at + 1 == text.size())
    skinctl::refuse("--lock " + text + ": joint=position expected [rad or m], such as elbow_joint=1.57");
  if (!options.locked.emplace(text.substr(0, at), position).second)
    skinctl::refuse("--lock " + text + ": this joint is locked already");
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"Writes a header with a static skinctl model of the robot in a URDF file."};
  std::string urdf, output;
  urdf_to_model::Settings settings;
  skinctl::UrdfOptions options;
  std::vector<double> gravity;
  std::vector<std::string> locks;
  app.add_option("urdf", urdf, "The robot")->required();
  app.add_option("-o,--output", output, "The header; standard output if left out");
  app.add_option("--namespace", settings.name_space, "Its namespace; the robot's name if left out");
  app.add_option("--gravity", gravity, "In the axes of the base link [m/s^2]; 0 0 -9.81 if left out")
      ->expected(3);
  app.add_option("--base", options.base, "The link that is the model's base; the root if left out");
  app.add_option("--tip", options.tip,
                 "The last link of a chain: joints off the way from the base stand still at 0");
  app.add_option("--lock", locks, "joint=position of a joint that stands still [rad or m]; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_flag("--large-limits", options.large_limits,
               "Limits beyond two turns and speeds beyond 60 rad/s are meant, and no degrees");
  app.add_option("--total-mass", options.total_mass,
                 "Of all links that move [kg]: spread over those to which the file gives no mass")
      ->check(CLI::Range(0.0, 1e5));
  app.add_option("--snap", settings.snap, "Angles this close to a right one become exact [rad]")
      ->check(CLI::Range(0.0, 1e-3));
  app.footer("Exit codes: 0 written, 1 the file cannot be read or written, 2 an option is wrong");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  for (std::size_t k = 0; k < gravity.size(); ++k) settings.gravity[k] = gravity[k];

  for (const std::string& lock : locks) add_lock(options, lock);
  examples::refuse_own_input(output, {urdf});
  const skinctl::Urdf robot = skinctl::read_urdf(urdf, options);
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
