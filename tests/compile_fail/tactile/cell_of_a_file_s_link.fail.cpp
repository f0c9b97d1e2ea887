// expect: (could not convert|no viable conversion).*NamedFrame
#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<NamedFrame<"wrist_3_link">, Cell> X_NC;
#ifdef SKINCTL_RIGHT
  const Transform<Link<5>, NamedFrame<"wrist_3_link">> X_LN;
  const PlacedCell<5> cell{1, X_LN * X_NC};
#else
  const PlacedCell<5> cell{1, X_NC};
#endif
  return static_cast<int>(cell.id);
}
