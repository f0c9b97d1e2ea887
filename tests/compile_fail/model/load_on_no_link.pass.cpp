#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(Loaded<ur5::Model, 5>(ur5::Model{}));
}
