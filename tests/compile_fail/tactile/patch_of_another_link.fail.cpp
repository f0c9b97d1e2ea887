// expect: wrist_3_link.*NamedCell|NamedCell.*wrist_3_link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Description {
  static constexpr std::array<NamedLink, 2> named_links = {
      {{"wrist_3_link", 5, {}, {0, 0, 0.1}}, {"tool0", 5, {}, {0, 0, 0.2}}}};
};

int main() {
  const Transform<NamedFrame<"tool0">, Cell> X_NC;
#ifdef SKINCTL_RIGHT
  return static_cast<int>(patch_on<Description, "tool0">({{1, X_NC}}).placed().size());
#else
  return static_cast<int>(patch_on<Description, "wrist_3_link">({{1, X_NC}}).placed().size());
#endif
}
