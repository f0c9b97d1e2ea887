#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Robot = Resolver<Interface::position, ur5::Model, double, CrankNicolson, 32, Passivity<ContactDamper<>>,
                       ToolShape<5>>;

constexpr std::size_t joints = Robot::joints;
