// Where an arm was touched, drawn.
#pragma once

#include <string>

#include "examples/compliant_ur5/run_log.hpp"

namespace compliant_ur5 {

/// The UR5 at the first pose of the log, from its side and from above, as two SVG elements for a page with
/// `report_style`: links as capsules, the touched cells with the numbers of their touches (from 1, as in the
/// table), a scale. Of touches in more than 24 places the first 24 are marked. Empty where there is no pose.
std::string arm_picture(const RunLog& log);

/// The same arm with a dot for each place of its skin, by the class of the least force that somebody notices
/// there: `felt-0` up to 5 N, `felt-1` up to 25 N, `felt-2` above, `felt-3` none. Empty without a skin.
std::string felt_picture(const RunLog& log);

}  // namespace compliant_ur5
