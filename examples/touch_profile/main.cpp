// touch_profile: a recorded grasp becomes a touch for the main job. See README.md beside this file.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>

#include "examples/support/output_file.hpp"
#include "examples/touch_profile/profile.hpp"

namespace {

// Exit codes, also in the README.
constexpr int exit_ok = 0, exit_refused = 2, exit_unwritable = 3;

}  // namespace

int main(int argc, char** argv) {
  touch_profile::Mapping mapping;
  std::string recording, out, taxels;
  bool generate = false;
  CLI::App app{"Turns a recording of the iCub grasp dataset into rows of time [s] and force [N]."};
  auto* file = app.add_option("recording", recording, "text file of the dataset");
  app.add_option("--out", out, "CSV file; without it the rows go to standard output");
  app.add_option("--peak", mapping.peak, "largest force [N]")->capture_default_str();
  auto* only_recorded =
      app.add_option("--rate", mapping.rate, "slices per second; the dataset does not state it")
          ->capture_default_str();
  app.add_option("--release", mapping.release, "seconds to let go after the last slice")
      ->capture_default_str();
  app.add_option("--rest", mapping.rest, "slices at the start that are untouched")->capture_default_str();
  app.add_option("--threshold", mapping.threshold, "smallest rise that is a touch [counts]")
      ->capture_default_str();
  app.add_option("--taxels,--taxel", taxels,
                 "thumb, index, middle, ring, little, 0 to 59, ranges; with commas");
  auto* computed = app.add_flag("--generate", generate, "a computed push instead of a recording");
  computed->excludes(file)->excludes(only_recorded);
  try {
    app.parse(argc, argv);
    if (!generate && recording.empty()) throw CLI::RequiredError("recording (or --generate)");
    examples::refuse_own_input(out, {recording});
    if (!taxels.empty()) mapping.taxels = touch_profile::parse_taxels(taxels);
    const auto profile =
        generate ? touch_profile::synthetic_push(mapping.peak)
                 : touch_profile::profile_of(touch_profile::read_recording_file(recording), mapping);
    std::ostringstream text;
    touch_profile::write_profile(text, profile);
    if (out.empty()) {
      std::cout << text.str() << std::flush;
      return std::cout ? exit_ok : exit_unwritable;
    }
    std::ofstream to(out, std::ios::binary | std::ios::trunc);
    to << text.str();
    to.close();
    if (!to) {
      std::fprintf(stderr, "touch_profile: cannot write '%s': %s\n", out.c_str(), std::strerror(errno));
      return exit_unwritable;
    }
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? exit_ok : exit_refused;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "touch_profile: %s\n", e.what());
    return exit_refused;
  }
  return exit_ok;
}
