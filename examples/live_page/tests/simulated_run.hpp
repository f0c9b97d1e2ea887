// A UR5 with 260 cells under two pressing hands, streamed to a live view: what the tests of the page look at.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

#include "examples/adapters/live/live_view.hpp"
#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/cycle/stopwatch.hpp"
#include "skinctl/fusion/blended.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/io/skin_export.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf_writer.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/testing/pressing.hpp"

namespace live_page {

inline auto scene() {
  using namespace skinctl;
  const auto arm = by_position(
      ur5::Model{},
      {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4});
  return Cycle(arm, ur5_skin<260>({.force = 20}), blended(SkinJointControl{} + GravityControl{}));
}
using Scene = decltype(scene());

/// Runs the scene at its pace, in the caller's thread, with a robot that follows perfectly.
class SimulatedRun {
 public:
  [[nodiscard]] skinctl::RunDescription description() const {
    using namespace skinctl;
    RunDescription run;
    for (int i = 0; i < 6; ++i) run.joints.push_back("joint " + std::to_string(i));
    run.laws = {"skin joint", "gravity"};
    run.frames = frames_of<ur5::Ros2Links>();
    run.places = places_of(ur5::Model{});
    UrdfDress dress{.name = "ur5"};
    for (std::size_t i = 0; i < 6; ++i)
      dress.capsules.push_back({i, {ur5::tubes[i].from, ur5::tubes[i].to, ur5::tubes[i].radius}});
    dress.named_links.assign(ur5::Ros2Links::named_links.begin(), ur5::Ros2Links::named_links.end());
    run.urdf = urdf_text(ur5::Model{}, dress);
    run.layout = skin_file_text(ur5_skin_file<260>({}));
    for (std::uint32_t i = 0; i < 260; ++i) {
      const auto& p = places_[i].place;
      run.cells.push_back({i + 1,
                           static_cast<std::uint32_t>(places_[i].link),
                           {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}});
    }
    run.newtons = 20;
    run.pressed.places = places_;
    for (std::uint32_t id = 1; id <= 260; ++id) run.pressed.ids.push_back(id);
    run.pressed.threshold = 0.3;
    return run;
  }

  /// @param pace  of the cycles in real time; 0ns: as fast as possible.
  void run(std::size_t cycles, std::chrono::nanoseconds pace, skinctl::CycleThread<Scene>& thread,
           adapters::live::Requests& requests, const std::atomic<bool>& stop) {
    using namespace skinctl;
    const Scene cycle = scene();
    State<6> at{8ms, {0.4, -1.1, 1.2, -1.6, -1.4, 0.0}, {}};
    auto memory = std::make_unique<Scene::Memory>(cycle.start(at));
    thread.start(at);
    Scene::Input input;
    Stopwatch watch;
    auto due = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < cycles && !stop; ++k) {
      const double t = 0.008 * double(k);
      const std::array<testing::Pressing, 2> hands = {
          testing::Pressing{places_[60].link, places_[60].place, places_[60].normal, 0.05,
                            14 * std::max(0.0, std::sin(1.5 * t))},
          testing::Pressing{places_[180].link, places_[180].place, places_[180].normal, 0.04,
                            9 * std::max(0.0, std::sin(1.1 * t + 2))}};
      at.time += 8ms;
      input.now = at.time;
      input.measured = at;
      const auto samples = testing::pushed_samples(testing::pushes(places_, hands), 20, at.time);
      input.samples = samples;
      input.request = requests.take();
      input.goal.emplace();
      if (!requests.take(input.goal->of)) input.goal.reset();
      const auto out = cycle.step(*memory, input, watch);
      if (out.command.valid) at.q = out.command.position, at.dq = out.planned.velocity;
      thread(input, out, watch);
      due += pace;
      if (pace.count() > 0) std::this_thread::sleep_until(due);
    }
  }

 private:
  std::vector<skinctl::CellPlace> places_ = skinctl::cell_places(skinctl::ur5::skin_patches<260>({}));
};

}  // namespace live_page
