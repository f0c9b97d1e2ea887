#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointPosition<3> q{0.1, 0.2, 0.3};
  static_cast<void>(q);
}
