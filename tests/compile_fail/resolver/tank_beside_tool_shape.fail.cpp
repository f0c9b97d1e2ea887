// expect: no tank beside a tool's shape
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = Resolver<Interface::position, ur5::Model, double, CrankNicolson, 32, Passivity<EnergyTank<>>,
                       ToolShape<5>>;

constexpr std::size_t joints = Robot::joints;
