// expect: fixed to the base
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Description {
#ifdef SKINCTL_RIGHT
  static constexpr std::array<NamedLink, 1> named_links = {{{"pedestal", 0, {}, {0, 0, 0.1}}}};
#else
  static constexpr std::array<NamedLink, 1> named_links = {{{"pedestal", -1, {}, {0, 0, 0.1}}}};
#endif
};

int main() {
  const Transform<NamedFrame<"pedestal">, Cell> X_NC;
  static_cast<void>(patch_on<Description, "pedestal">({{1, X_NC}}));
}
