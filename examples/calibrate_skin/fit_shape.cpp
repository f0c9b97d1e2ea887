#include "examples/calibrate_skin/fits.hpp"
#include "skinctl/calibration/reconstruction.hpp"

namespace calibrate_skin {

skinctl::Reconstruction fit_shape(const skinctl::PatchGraph& patch, const skinctl::RestReadings& readings,
                                  const skinctl::ReconstructionSettings& settings) {
  return skinctl::reconstruct(patch, readings, settings);
}

}  // namespace calibrate_skin
