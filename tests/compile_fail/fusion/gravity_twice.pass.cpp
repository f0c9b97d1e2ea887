#include "skinctl/skinctl.hpp"

int main() {
  const skinctl::GravityControl gravity;
  const skinctl::SkinJointControl skin;
  static_cast<void>(gravity + skin);
}
