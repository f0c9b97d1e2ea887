// A user's program with URDF and recording, whose bodies skinctl::io compiles.
#include <cstdio>
#include <filesystem>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/recording/mcap_recorder.hpp"
#include "skinctl/robots/ur5.hpp"

#ifdef TINYXML2_INCLUDED
#error "no parser is read here"
#endif

using namespace skinctl;

int main() {
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  const Cycle cycle(arm, NoSkin{}, GravityControl{});
  using Scene = std::remove_const_t<decltype(cycle)>;
  RunDescription run;
  run.joints = {"a", "b", "c", "d", "e", "f"};
  const auto path = std::filesystem::temp_directory_path() / "skinctl_reads_and_records.mcap";
  McapRecorder<Scene> recorder(path.string(), {.scene = "consumer"}, run);
  CycleThread<Scene> thread({&recorder});
  Scene::Input input;
  auto memory = cycle.start(input.measured);
  thread.start(input.measured);
  thread(input, cycle.step(memory, input), NoStopwatch{});
  thread.finish();
  const bool recorded = recorder.finish() && recorder.cycles() == 1 && recorder.size() > 1000;
  std::filesystem::remove(path);

#ifdef SKINCTL_HAS_TINYXML2
  const Urdf urdf = parse_urdf(
      "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/>"
      "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint></robot>");
  const bool read = urdf.joints.size() == 1;
#else
  const bool read = true;
#endif
  std::printf("recorded: %d, read: %d\n", recorded, read);
  return recorded && read ? 0 : 1;
}
