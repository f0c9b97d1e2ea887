#include <algorithm>
#include <limits>

#include "examples/adapters/clocked_driver.hpp"
#include "examples/adapters/egm/egm.hpp"
#include "examples/adapters/franka/franka.hpp"
#include "examples/adapters/fri/fri.hpp"
#include "examples/adapters/rsi/rsi.hpp"
#include "examples/adapters/stream_motion/stream_motion.hpp"
#include "examples/calibrate_skin/drive.hpp"
#include "examples/support/text.hpp"
#include "skinctl/hardware/scheduling.hpp"

namespace calibrate_skin {

namespace {

/// Throws unless every pose of the robot's motions is at most so far from where it stands [rad].
void require_within(double most, const JointAngles& from, const Robot& robot) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double way = std::max(robot.upper[i] - from[i], from[i] - robot.lower[i]);
    if (way <= most) continue;
    skinctl::refuse(examples::text(
        "joint %zu would go %.2f rad from where it stands, beyond the correction of %.2f rad: a shorter "
        "--reach, a start at home, or --max-correction as AXISCORR has it",
        i, way, most));
  }
}

template <class P>
std::unique_ptr<Drive> drive_by(P protocol, const ArmOptions& o) {
  skinctl::require(o.robot.joints() == P::joints, "joints of the robot", double(o.robot.joints()),
                   "as many as its controller moves: 6, of fri and franka 7");
  const adapters::ClockOptions clock{.give_up = adapters::Timeout(o.own_clock ? 4000 : 150),
                                     .real_time = !o.own_clock};
  if (!o.own_clock) o.say(skinctl::request_real_time().report);
  double most = std::numeric_limits<double>::infinity();
  if constexpr (requires { protocol.max_correction(); }) most = protocol.max_correction();
  auto drive = std::make_unique<DriveOf<adapters::ClockedDriver<P>, P::joints>>(std::move(protocol), clock);
  require_within(most, drive->start(), o.robot);
  return drive;
}
/// With `host` as the address of this computer.
template <class P, class O>
std::unique_ptr<Drive> drive_at(O its, const ArmOptions& o) {
  its.bind = o.host, its.period = skinctl::nanoseconds(o.period);
  if (o.port != 0) its.port = o.port;
  return drive_by(P(its), o);
}
template <class P, class O>
std::unique_ptr<Drive> drive_to(O its, const ArmOptions& o) {
  its.host = o.host;
  if (o.port != 0) its.port = o.port;
  return drive_by(P(its), o);
}

}  // namespace

std::unique_ptr<Drive> clocked_drive(const ArmOptions& o) {
  using namespace adapters;
  if (o.protocol == "rsi") return drive_at<rsi::Rsi>(rsi::Options{.max_correction = o.max_correction}, o);
  if (o.protocol == "egm") return drive_at<egm::Egm>(egm::Options{}, o);
  if (o.protocol == "fri") return drive_at<fri::Fri>(fri::Options{}, o);
  if (o.protocol == "franka") return drive_to<franka::Franka>(franka::Options{.stiffness = o.stiffness}, o);
  if (o.protocol == "stream_motion")
    return drive_to<stream_motion::StreamMotion>(stream_motion::Options{}, o);
  skinctl::refuse("no protocol " + o.protocol);
}

}  // namespace calibrate_skin
