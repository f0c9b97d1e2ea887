// expect: one joint vector of the batch.s scalar per robot
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const std::vector<JointPosition<6, float>> q(8);
#ifdef SKINCTL_RIGHT
  const ModelBatch<ur5::Model, float> robots(ur5::Model{}, q.size());
#else
  const ModelBatch<ur5::Model, double> robots(ur5::Model{}, q.size());
#endif
  robots.for_each_group([&](const auto&, const auto& group) { static_cast<void>(group.read(q)); });
}
