#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const JointPosition<6> q;
  const JointPosition<7> q_7;
  static_cast<void>(q_7 - q_7);
}
