// The result: what is not known well enough is masked.
#include <map>

#include "examples/calibrate_skin/json_values.hpp"
#include "examples/calibrate_skin/step_functions.hpp"
#include "examples/calibrate_skin/world.hpp"
#include "examples/support/text.hpp"
#include "skinctl/calibration/pose_uncertainty.hpp"

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

Json result_step(const World& world, const Options& options) {
  const Json net = read_json(options.folder / "network.json"),
             shapes = read_json(options.folder / "shape.json"),
             moved = read_json(options.folder / "lines.json"),
             seen = read_json(options.folder / "camera.json");
  std::map<int, Json> neighbours;
  for (const auto& names : net.at("cells")) neighbours[names.at("id").get<int>()] = names.at("neighbours");
  Json patches = Json::array();
  std::size_t masked = 0, all = 0;
  for (const auto& placed : seen.at("patches")) {
    if (!placed.at("known").get<bool>()) continue;
    const auto k = placed.at("patch").get<std::size_t>();
    const auto link = moved.at("links").at(k).at("link").get<std::size_t>();
    std::vector<Eigen::MatrixXd> configurations;
    const Robot& robot = options.arm.robot;
    for (const auto& q : robot.rest_poses(world.seed()))
      configurations.push_back(robot.transposed_jacobian(link, q));
    UncertainPatch patch{pose_of(placed.at("pose")), matrix_of(placed.at("covariance")), {}};
    const Json& cells = shapes.at("patches").at(k).at("cells");
    for (const auto& c : cells)
      patch.cells.push_back({pose_of(c.at("pose")), c.at("covariance").is_null()
                                                        ? Matrix6d(Matrix6d::Zero())
                                                        : matrix_of(c.at("covariance"))});
    Json out = Json::array();
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto why = cells.at(i).at("unknown").get<std::string>();
      const std::string mask =
          why.empty() ? mask_reason(configurations, patch, i) : std::string("pose unknown");
      ++all, masked += !mask.empty();
      out.push_back({{"id", cells.at(i).at("id")},
                     {"pose", cells.at(i).at("pose")},
                     {"covariance", cells.at(i).at("covariance")},
                     {"neighbours", neighbours[cells.at(i).at("id").get<int>()]},
                     {"masked", mask}});
    }
    patches.push_back({{"link", link},
                       {"pose", placed.at("pose")},
                       {"covariance", placed.at("covariance")},
                       {"cells", out}});
  }
  return {{"patches", patches},
          {"said", text("%zu cells in %zu patches, %zu of them masked", all, patches.size(), masked)}};
}

}  // namespace calibrate_skin
