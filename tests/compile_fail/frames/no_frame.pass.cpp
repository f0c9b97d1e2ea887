#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Arm : FrameTag {};

using X_WA = Transform<World, Arm>;

int main() {}
