#include "examples/calibrate_skin/images.hpp"

#include "examples/adapters/camera/lights.hpp"
#include "examples/adapters/camera/rendered.hpp"
#include "examples/support/text.hpp"
#include "skinctl/core/contract.hpp"

namespace calibrate_skin {

CameraReport seen_in_images(const World& world, const std::vector<JointAngles>& stood, std::string& said) {
  const CameraReport shown = world.seen(stood, false);
  CameraReport out{shown.camera, {}};
  std::mt19937_64 rng(world.seed());
  std::size_t spots = 0, unread = 0, twice = 0;
  for (std::size_t v = 0; v < stood.size(); ++v) {
    std::vector<camera::RenderedLight> lights;
    for (const auto& light : shown.lights) {
      if (light.view != v) continue;
      skinctl::require(light.id <= camera::Blinks::highest, "id of a light", double(light.id), "0 to 1023");
      lights.push_back({light.id, light.pixel.x(), light.pixel.y()});
    }
    const auto found = camera::find_lights(camera::rendered(lights, {.reflected = 0.2}, rng));
    spots += found.spots, unread += found.unsure + found.misread + found.large, twice += found.twice;
    for (const auto& light : found.lights) out.lights.push_back({v, light.id, light.pixel});
  }
  said = examples::text("  images: %zu spots in %zu views, %zu lights, %zu not read, %zu ids twice", spots,
                        stood.size(), out.lights.size(), unread, twice);
  return out;
}

}  // namespace calibrate_skin
