// How well a calibration did: its files against the truth, and the main job with both.
#pragma once

#include <string>
#include <vector>

#include "examples/calibrate_skin/steps.hpp"

namespace calibrate_skin {

/// Cells that are not masked, against where they truly are.
struct SkinError {
  std::size_t cells = 0, of = 0, wrong_link = 0;
  double place_rms = 0, place_worst = 0;  ///< [m]
  double turn_rms = 0, turn_worst = 0;    ///< [rad]
};
[[nodiscard]] SkinError skin_error(const skinctl::SkinFile& found, const World& world,
                                   const Robot& robot = ur5_robot());

/// The index of a patch's link. Throws `std::runtime_error` for a name that no link has.
[[nodiscard]] std::size_t link_of(const skinctl::SkinFile::Patch& patch, const Robot& robot = ur5_robot());

/// Calibrates into `folder` without a camera, on a simulated robot that wears the skin of this seed and sends
/// its datagrams over a socket, of which a share is lost. Shares with the reader no more than these.
[[nodiscard]] SkinError over_wire(const fs::path& folder, std::uint64_t seed, double loss);

/// Places the patches of a calibration by `over_wire` anew, by their lights: the skin is told over the socket
/// which are on, and images of them are taken through a lens with distortion. Without OpenCV it throws.
[[nodiscard]] SkinError seen_over_wire(const fs::path& folder, std::uint64_t seed);

/// The model of a calibration against the robot as it is, in a hundred postures, rotors included.
struct MassError {
  double found = 0,
         maker =
             0;  ///< of `M(q)`, relative, rms: by the calibration, and by the maker's numbers without rotors
  int not_positive = 0;  ///< postures in which the found M is not positive definite
};
[[nodiscard]] MassError mass_error(const fs::path& folder, const World& world);

/// A touch of the same finger at the same cell, with the calibrated file and with the true one.
struct JobTouch {
  std::size_t link = 0;
  std::uint32_t cell = 0;
  double force[2] = {0, 0};       ///< peak of the finger's [N]: calibrated, true
  double deflection[2] = {0, 0};  ///< farthest that the touched point gave way [m]
  double left[2] = {0, 0};        ///< distance of that point from its task before the next touch [m]
};
/// Runs the main job twice on a simulated robot that wears the true skin: with `folder`/skin.json and with
/// the truth. Upper arm, forearm and first wrist are touched. Throws `std::runtime_error` if a run does not
/// end as it should.
[[nodiscard]] std::vector<JobTouch> main_job_on(const fs::path& folder, const World& world);

}  // namespace calibrate_skin
