#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::SkinJointControl skin;
  const skinctl::GravityControl gravity;
  static_cast<void>(skin + gravity);
}
