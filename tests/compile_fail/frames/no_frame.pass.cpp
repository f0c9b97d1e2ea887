#include "skinctl/core/joint.hpp"
#include "skinctl/core/lane.hpp"
#include "skinctl/frames/inertia.hpp"
#include "skinctl/frames/wrench.hpp"

using namespace skinctl;

struct Arm : FrameTag {};

using X_WA = Transform<World, Arm>;

int main() {}
