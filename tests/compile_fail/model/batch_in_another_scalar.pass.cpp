#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const std::vector<JointPosition<6, float>> q(8);
  const ModelBatch<ur5::Model, float> robots(ur5::Model{}, q.size());
  robots.for_each_group([&](const auto&, const auto& group) { static_cast<void>(group.read(q)); });
}
