#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

int main() {
  const Point<World> p_W, q_W;
  static_cast<void>(p_W - q_W);
}
