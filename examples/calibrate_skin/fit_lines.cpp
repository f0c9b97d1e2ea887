#include "examples/calibrate_skin/fits.hpp"
#include "skinctl/calibration/joint_lines.hpp"

namespace calibrate_skin {

skinctl::JointLines fit_lines(const skinctl::MotionRecording& recording) {
  return skinctl::find_joint_lines(recording);
}

}  // namespace calibrate_skin
