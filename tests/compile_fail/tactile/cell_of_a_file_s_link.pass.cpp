#include "skinctl/skinctl.hpp"

using namespace skinctl;

int main() {
  const Transform<NamedFrame<"wrist_3_link">, Cell> X_NC;
  const Transform<Link<5>, NamedFrame<"wrist_3_link">> X_LN;
  const PlacedCell<5> cell{1, X_LN * X_NC};
  return static_cast<int>(cell.id);
}
