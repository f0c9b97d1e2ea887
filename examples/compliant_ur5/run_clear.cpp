#include "examples/compliant_ur5/run_with.hpp"

namespace compliant_ur5::running {

template Outcome run_by_skin<true>(const Settings&, const std::atomic<bool>&, RunLog&);
template Outcome replay_by_skin<true>(const Settings&);

}  // namespace compliant_ur5::running
