// Skin files: write that of the UR5, check one, draw one, convert TUM's patch files. See README.md beside
// this file.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "examples/skin_file/geometry.hpp"
#include "examples/skin_file/picture.hpp"
#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/io/skin_export.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/skin_xml.hpp"
#include "skinctl/io/urdf.hpp"

namespace {

using namespace skinctl;

SkinFile ur5_skin_of(std::size_t cells, const std::vector<double>& force, double proximity) {
  std::array<CellGains, 6> gains{};
  for (std::size_t i = 0; i < 6; ++i)
    gains[i] = {.force = force[force.size() == 1 ? 0 : i], .proximity = proximity};
  switch (cells) {
    case 60:
      return ur5_skin_file<60>(gains);
    case 260:
      return ur5_skin_file<260>(gains);
    case 383:
      return ur5_skin_file<383>(gains);
    case 1260:
      return ur5_skin_file<1260>(gains);
    default:
      refuse("--cells " + std::to_string(cells) + ", allowed: 60, 260, 383 (all of TUM's size), 1260");
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Skin files (JSON, skinctl-skin-1): written, checked, drawn, converted."};
  app.require_subcommand(1);
  std::string file, output, urdf_file, link;
  std::vector<std::string> patches;
  std::vector<double> q, force = {60, 70, 50, 25, 15, 15};
  std::size_t cells = 260;
  double proximity = 0;
  UrdfOptions options;

  auto* ur5 = app.add_subcommand("ur5", "Writes the skin of ur5_skin<N>");
  ur5->add_option("--cells", cells, "60, 260, 383 or 1260")->capture_default_str();
  ur5->add_option("--force-gain", force, "of all links, or of each [N per unit of the three readings]");
  ur5->add_option("--proximity-gain", proximity, "[N per unit]")->capture_default_str();
  auto* check = app.add_subcommand("check", "Says what a file holds, or what is wrong with it");
  auto* draw = app.add_subcommand("draw", "Draws a skin on its robot as SVG");
  draw->add_option("--position", q, "of each joint [rad]");
  for (auto* command : {check, draw}) {
    command->add_option("file", file, "skin file")->required();
    command->add_option("--urdf", urdf_file,
                        "the robot; without it the UR5, with the names of its ROS 2 description");
    command->add_option("--tip", options.tip, "last link of a chain of the URDF");
  }
  auto* convert = app.add_subcommand("convert", "Patch files in XML, one a patch, as one skin file");
  convert->add_option("files", patches, "FILE, or NAME=FILE")->required();
  convert->add_option("--link", link, "that carries them; without it baseFrame of each file");
  convert->add_option("--force-gain", force, "of all patches [N per unit of the three readings]");
  for (auto* command : {ur5, draw, convert})
    command->add_option("-o,--output", output, "standard output if left out");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const auto write = [&](const std::string& text) {
    if (output.empty()) {
      std::fputs(text.c_str(), stdout);
      return;
    }
    std::ofstream out(output, std::ios::binary);
    out << text << std::flush;
    if (!out) refuse("skinctl: " + output + ": cannot be written");
  };
  if (*ur5) {
    if (force.size() != 1 && force.size() != 6) refuse("--force-gain: one number, or six");
    write(skin_file_text(ur5_skin_of(cells, force, proximity)));
    return 0;
  }
  if (*convert) {
    SkinFile all;
    for (const std::string& text : patches) {
      const std::size_t at = text.find('=');
      const std::string path = at == std::string::npos ? text : text.substr(at + 1);
      examples::refuse_own_input(output, {path});
      const std::size_t slash = path.rfind('/') + 1, dot = path.rfind('.');
      SkinXmlOptions how;
      how.name = at == std::string::npos ? path.substr(slash, dot > slash ? dot - slash : path.npos)
                                         : text.substr(0, at);
      how.link = link;
      how.gains.force = force.front();
      append(all, read_skin_xml(path, how));
    }
    write(skin_file_text(all));
    return 0;
  }

  examples::refuse_own_input(output, {file, urdf_file});
  const SkinFile skin = read_skin_file(file);
  std::vector<PlacedSkinPatch> placed;
  skin_file::Pose pose;
  if (urdf_file.empty()) {
    placed = place_skin<skinctl::ur5::Ros2Links>(skin);
    pose = skin_file::ur5_at(q.empty() ? std::vector<double>{0.0, -1.2, 1.4, -1.8, -1.57, 0.3} : q);
  } else {
    const Urdf urdf = read_urdf(urdf_file, options);
    placed = place_skin(skin, urdf);
    pose = skin_file::urdf_at(urdf, q.empty() ? std::vector<double>(urdf.joints.size()) : q);
  }
  if (*draw) {
    write(skin_file::picture(skin, placed, pose));
    return 0;
  }
  std::size_t masked = 0;
  for (const PlacedSkinPatch& on : placed) {
    const SkinFile::Patch& patch = skin.patches[on.patch];
    for (const auto& cell : patch.cells) masked += !cell.masked.empty();
    std::printf("%-16s %5zu cells on %s (joint %zu), %g N and %g N a unit of force and proximity\n",
                patch.name.c_str(), patch.cells.size(), patch.link.c_str(), on.link, patch.gains.force,
                patch.gains.proximity);
  }
  std::printf("%zu cells, %zu of them masked, %zu regions\n", skin.cells(), masked, skin.regions.size());
  constexpr std::size_t most = 20;
  const auto faults = skin_file::geometry_faults(skin, placed);
  for (std::size_t i = 0; i < std::min(faults.size(), most); ++i)
    std::fprintf(stderr, "skin_file: %s: %s\n", file.c_str(), faults[i].c_str());
  if (faults.size() > most) std::fprintf(stderr, "skin_file: and %zu more\n", faults.size() - most);
  return faults.empty() ? 0 : 2;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "skin_file: %s\n", e.what());
    return 2;
  }
}
