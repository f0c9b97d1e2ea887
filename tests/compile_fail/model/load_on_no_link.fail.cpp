// expect: the model has no such link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  static_cast<void>(Loaded<ur5::Model, 6>(ur5::Model{}));
}
