// expect: constraint(s not satisfied| failure).*Transform<World, Arm>.*is_base_of_v<[^\n]*FrameTag
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
struct Arm : FrameTag {};
#else
struct Arm {};
#endif

using X_WA = Transform<World, Arm>;

int main() {}
