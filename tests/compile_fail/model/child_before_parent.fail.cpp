// expect: parents come before children
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Crane {
  static constexpr std::size_t joints = 2;
#ifdef SKINCTL_RIGHT
  static constexpr std::array<int, 2> parents = {-1, 0};
#else
  static constexpr std::array<int, 2> parents = {1, -1};
#endif
  static constexpr auto kinds = all_of_kind<2>(JointKind::revolute);
};

int main() {
  static_cast<void>(sizeof(CalibratedModel<Crane>));
}
