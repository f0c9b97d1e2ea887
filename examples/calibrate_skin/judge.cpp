#include "examples/calibrate_skin/judge.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "examples/calibrate_skin/masses.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/compliant_ur5/run.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/robots/ur5_links.hpp"
#include "skinctl/testing/random.hpp"

namespace calibrate_skin {

using namespace skinctl;

MassError mass_error(const fs::path& folder, const World& world) {
  const Json masses = read_json(folder / "masses.json");
  const auto axes = axes_of<6>(read_json(folder / "lines.json"));
  if (!axes.model || !masses.contains("bodies")) throw std::runtime_error("the calibration found no masses");
  RobotMasses found;
  found.bodies = masses.at("bodies").get<decltype(found.bodies)>();
  found.rotor = masses.at("rotor").get<JointAngles6>();
  FoundModel::Links links;
  const auto shape = calibrated_from<ur5::Description>();
  for (std::size_t i = 0; i < 6; ++i) links[i] = shape.link(i);
  const FoundModel maker(links), truth = with_bodies(maker, world.robot()),
                                 calibrated = with_bodies(*axes.model, found);
  auto rng = testing::seeded(17);
  MassError out;
  for (int k = 0; k < 100; ++k) {
    const JointAngles6 q = testing::random_array<6, double>(rng, 3.0);
    const auto M = mass_of(truth, world.robot(), q), of_found = mass_of(calibrated, found, q);
    out.found += (of_found - M).squaredNorm() / M.squaredNorm() / 100;
    out.maker += (mass_of(maker, {}, q) - M).squaredNorm() / M.squaredNorm() / 100;
    out.not_positive += of_found.llt().info() != Eigen::Success;
  }
  out.found = std::sqrt(out.found), out.maker = std::sqrt(out.maker);
  return out;
}

std::vector<JobTouch> main_job_on(const fs::path& folder, const World& world) {
  const SkinFile found = read_skin_file((folder / "skin.json").string());
  const fs::path truth = folder / "true_skin.json", scenario = folder / "scenario.toml";
  write_text(truth, skin_file_text(true_skin_file(found, world)));

  // The shipped scenario with other touches, and at rest.
  std::ifstream shipped(COMPLIANT_UR5_SCENARIO);
  std::string text{std::istreambuf_iterator<char>(shipped), {}};
  text.resize(std::min(text.find("[[goal]]"), text.size()));
  if (const auto at = text.find("duration = 60"); at != std::string::npos)
    text.replace(at, 13, "duration = 23");
  std::vector<JobTouch> out;
  for (const std::size_t link : {1u, 2u, 3u}) {
    // In the middle of its patch.
    const SkinFile::Cell* best = nullptr;
    std::ptrdiff_t most = -1;
    for (const auto& patch : found.patches)
      for (const auto& cell : patch.cells) {
        if (link_of(patch) != link || !cell.masked.empty()) continue;
        const auto n = std::count_if(cell.neighbours.begin(), cell.neighbours.end(),
                                     [](std::uint32_t id) { return id != SkinFile::nobody; });
        if (n > most) most = n, best = &cell;
      }
    if (best == nullptr) continue;
    text += "[[touch]]\nname = \"link " + std::to_string(link) + "\"\ncell = " + std::to_string(best->id) +
            "\nstart = " + std::to_string(2 + 7 * out.size()) +
            "\nstiffness = 3000\ndamping = 20\napproach_speed = 0.06\ntravel = 0.06\nhold = 0.6\n\n";
    out.push_back({.link = link, .cell = best->id});
  }
  write_text(scenario, text);

  for (const std::size_t which : {0u, 1u}) {
    compliant_ur5::Settings s;
    s.scenario = scenario.string();
    s.skin = which == 0 ? (folder / "skin.json").string() : truth.string();
    s.simulated_skin = truth.string();
    s.quiet = true, s.compare = false;
    compliant_ur5::read_scenario(s.scenario, s);
    compliant_ur5::RunLog log;
    const std::atomic<bool> stop{false};
    const auto outcome = compliant_ur5::run(s, stop, log);
    if (outcome != compliant_ur5::Outcome::fine)
      throw std::runtime_error(std::string("the main job ended: ") + examples::job::words(outcome));
    if (log.touches.size() != out.size())
      throw std::runtime_error("the main job felt " + std::to_string(log.touches.size()) + " touches of " +
                               std::to_string(out.size()));
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k].force[which] = log.touches[k].true_peak_force;
      out[k].deflection[which] = log.touches[k].deflection;
      out[k].left[which] = log.touches[k].return_error;
    }
  }
  return out;
}

}  // namespace calibrate_skin
