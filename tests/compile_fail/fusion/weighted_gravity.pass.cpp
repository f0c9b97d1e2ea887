#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::SkinJointControl skin;
  static_cast<void>(0.5 * skin);
}
