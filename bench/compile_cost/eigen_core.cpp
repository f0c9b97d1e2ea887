// What a user pays who includes Eigen and nothing else: the baseline of this folder.
#include <Eigen/Core>

int main() {
  return static_cast<int>(Eigen::Vector3d::Zero().sum());
}
