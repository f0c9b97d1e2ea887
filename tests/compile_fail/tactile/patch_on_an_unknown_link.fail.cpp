// expect: no link of this name
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Description {
  static constexpr std::array<NamedLink, 1> named_links = {{{"wrist_3_link", 5, {}, {0, 0, 0.1}}}};
};

int main() {
#ifdef SKINCTL_RIGHT
  const Transform<NamedFrame<"wrist_3_link">, Cell> X_NC;
  static_cast<void>(patch_on<Description, "wrist_3_link">({{1, X_NC}}));
#else
  const Transform<NamedFrame<"writs_3_link">, Cell> X_NC;
  static_cast<void>(patch_on<Description, "writs_3_link">({{1, X_NC}}));
#endif
}
