// expect: send\(command\)|RobotDriver
#include "skinctl/skinctl.hpp"

using namespace skinctl;

using Scene = Cycle<ResolverBy<Interface::impedance, ur5::Model>, GravityControl>;

struct Driver {
  Heard wait(State<6>&) noexcept;
#ifdef SKINCTL_RIGHT
  bool send(const ImpedanceCommand<6>&) noexcept;
#else
  bool send(const PositionCommand<6>&) noexcept;  // the torque beside the positions would be lost
#endif
  void stop() noexcept;
};
static_assert(RobotDriver<Driver, decltype(Scene::Output::command), 6, double>);
