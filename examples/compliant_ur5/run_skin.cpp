#include "examples/compliant_ur5/run_with.hpp"

namespace compliant_ur5 {
namespace {

using skinctl::Interface;

void refuse_torque(const Settings& s) {
  if (s.interface == Interface::torque)
    skinctl::refuse("--interface torque feels by the skin: without one use position or velocity");
}

}  // namespace

Outcome run(const Settings& settings, const std::atomic<bool>& stop, RunLog& log) {
  using namespace running;
  if (settings.sense != Sense::skin) refuse_torque(settings);
  if (settings.sense == Sense::wrist) return run_by<Sense::wrist>(settings, stop, log);
  if (settings.sense == Sense::motors) return run_by<Sense::motors>(settings, stop, log);
  switch (settings.interface) {
    case Interface::position:
      return run_with<Interface::position, Sense::skin>(settings, stop, log);
    case Interface::velocity:
      return run_with<Interface::velocity, Sense::skin>(settings, stop, log);
    default:
      return run_with<Interface::torque, Sense::skin>(settings, stop, log);
  }
}

Outcome replay(const Settings& settings) {
  using namespace running;
  if (settings.sense != Sense::skin) refuse_torque(settings);
  if (settings.sense == Sense::wrist) return replay_by<Sense::wrist>(settings);
  if (settings.sense == Sense::motors) return replay_by<Sense::motors>(settings);
  switch (settings.interface) {
    case Interface::position:
      return replay_with<Interface::position, Sense::skin>(settings);
    case Interface::velocity:
      return replay_with<Interface::velocity, Sense::skin>(settings);
    default:
      return replay_with<Interface::torque, Sense::skin>(settings);
  }
}

}  // namespace compliant_ur5
