#include "examples/compliant_ur5/run_with.hpp"

namespace compliant_ur5 {

template Outcome run_by<Sense::motors>(const Settings&, const std::atomic<bool>&, RunLog&);
template Outcome replay_by<Sense::motors>(const Settings&);

}  // namespace compliant_ur5
