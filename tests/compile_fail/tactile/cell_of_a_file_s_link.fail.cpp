// expect: (could not convert|no viable conversion).*NamedFrame
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<NamedFrame<"wrist_3_link">, Cell> X_NC;
  const PlacedCell<5> cell{1, X_NC};
  return static_cast<int>(cell.id);
}
