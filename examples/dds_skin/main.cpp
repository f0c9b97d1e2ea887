// One skin, several computers: `dds_skin send` stands for the computer at the skin and publishes its cells;
// `dds_skin control` runs an arm that gives way to a skin which it only knows from DDS. See README.md beside
// this file.
#include <CLI/CLI.hpp>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <thread>

#include "examples/adapters/dds/skin.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"
#include "skinctl/io/ros_messages.hpp"
#include "skinctl/skinctl.hpp"

namespace {

using namespace skinctl;
using namespace adapters::dds;

constexpr std::size_t cells = 260;
constexpr JointPosition<6> home(std::array{0.0, -1.2, 1.4, -1.8, -1.57, 0.3});
namespace job = examples::job;

std::vector<SkinCloud::Cell> skin_cells() {
  std::vector<SkinCloud::Cell> out;
  const auto add = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& patch) {
    for (const auto& cell : patch.any()) {
      const auto& p = cell.X_LC.origin();
      out.push_back({cell.id,
                     static_cast<std::uint32_t>(I),
                     {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}});
    }
  };
  std::apply([&](const auto&... patch) { (add(patch), ...); }, ur5::skin_patches<cells>());
  return out;
}
Nanoseconds clock_now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

/// Every cell each 10 ms; two seconds after the start, eight cells of the forearm are pressed for as long.
job::Exit send(const ParticipantOptions& options, double rate, double seconds_long,
               const std::atomic<bool>& stopped, job::Progress& progress) {
  const auto places = skin_cells();
  SkinCloud cloud(places);
  const auto poses = link_poses(ur5::Model{}, home);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (cloud.place(I, poses.template get<I>().axes(), poses.template get<I>().origin()), ...);
  }(std::make_index_sequence<6>());
  Participant participant(options);
  RawWriter writer(participant, "/skin/cells", SkinCloud::type(), Delivery::sensor, skin_cloud_size(cells));
  std::uint32_t pressed = 0;  // the first cell on the forearm
  for (const auto& c : places) pressed = c.link == 2 && pressed == 0 ? c.id : pressed;
  const Nanoseconds began = clock_now();
  std::uint64_t sent = 0;
  for (auto next = std::chrono::steady_clock::now(); !stopped;) {
    next += std::chrono::nanoseconds(std::lround(1e9 / rate));
    std::this_thread::sleep_until(next);
    const Nanoseconds now = clock_now();
    const double t = seconds<double>(now - began);
    if (t > seconds_long) break;
    const float reading = t > 2 && t < 4 ? 0.2f : 0.0f;
    for (const auto& c : places) {
      const float force = c.id >= pressed && c.id < pressed + 8 ? reading : 0.0f;
      cloud.set({now - 500us, c.id, {force, force, 0}, 0, {0, 0, 9.81f}, 30});
    }
    sent += writer.write(cloud.encode(now));
    if (progress.due(t)) progress.show("%5.0f s  %d readers", t, writer.readers());
  }
  progress.clear();
  std::printf("sent %llu frames of %zu cells to %d readers\n", static_cast<unsigned long long>(sent), cells,
              writer.readers());
  return stopped ? job::Exit::interrupted : job::Exit::fine;
}

/// An arm by position that follows what it is told, at the pace of this computer's clock.
struct FollowingArm {
  State<6> state;
  std::chrono::steady_clock::time_point next = std::chrono::steady_clock::now();

  Heard wait(State<6>& out) noexcept {
    next += std::chrono::milliseconds(8);
    std::this_thread::sleep_until(next);
    state.time = clock_now();
    out = state;
    return Heard::state;
  }
  bool send(const PositionCommand<6>& command) noexcept {
    state.dq =
        JointVelocity<6>::generate([&](std::size_t i) { return (command.position[i] - state.q[i]) / 0.008; });
    state.q = command.position;
    return true;
  }
  void stop() noexcept {}
};
struct SkinOnRobotClock {
  SkinReader& reader;
  const FollowingArm& arm;
  std::span<const CellSample> poll() noexcept { return reader.poll(arm.state.time); }
};

job::Exit control(const ParticipantOptions& options, double seconds_long, const std::atomic<bool>& stopped,
                  job::Progress& progress) {
  SkinSettings settings;
  settings.max_age = 200ms;
  const Cycle scene(
      by_position(
          ur5::Model{},
          {.limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 4}),
      ur5_skin<cells>({.force = 40}, settings), SkinJointControl{} + GravityControl{});
  using Scene = std::remove_cvref_t<decltype(scene)>;
  Participant participant(options);
  SkinReader reader(participant, cells);
  RawWriter joints(participant, "/joint_states", ros::JointState::type(), Delivery::state, 4096);
  FollowingArm arm;
  arm.state.q = home;
  SkinOnRobotClock skin{reader, arm};
  const auto memory = std::make_unique<Scene::Memory>();
  double moved = 0;
  std::uint64_t touched = 0;
  const Nanoseconds began = clock_now();
  const auto report = run_loop(
      scene, *memory, arm, skin,
      {.cycles = static_cast<std::uint64_t>(seconds_long * 125), .period = 8ms, .stop = &stopped},
      [](auto&, auto&) { return true; },
      [&](const Scene::Input& input, const auto&, const auto&) {
        for (std::size_t i = 0; i < 6; ++i) moved = std::max(moved, std::abs(input.measured.q[i] - home[i]));
        for (const CellSample& s : input.samples) touched += s.force[0] > 0.1f;
        const double t = seconds<double>(input.now - began);
        if (progress.due(t))
          progress.show("%5.0f s  %llu samples of a touch, moved by %.3f rad", t,
                        static_cast<unsigned long long>(touched), moved);
      });
  progress.clear();
  std::printf("%llu cycles, %llu samples over DDS, %llu of them of a touch; the arm gave way by %.3f rad\n",
              static_cast<unsigned long long>(report.cycles), static_cast<unsigned long long>(report.samples),
              static_cast<unsigned long long>(touched), moved);
  std::printf("%llu messages refused, %llu without room; load p99 %.1f us\n",
              static_cast<unsigned long long>(reader.refused()),
              static_cast<unsigned long long>(reader.dropped()),
              1e-3 * static_cast<double>(report.load.percentile(0.99).count()));
  // Where it is now, for whoever listens.
  const std::vector<std::string> names = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                          "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  std::vector<unsigned char> bytes(4096);
  CdrWriter w(bytes);
  ros::encode(w, ros::JointState{arm.state.time, "", names, arm.state.q.data, arm.state.dq.data, {}});
  joints.write(w.bytes());
  if (stopped) return job::Exit::interrupted;
  if (report.samples == 0) {
    std::fprintf(stderr, "no skin was heard\n");
    return job::Exit::blind;
  }
  return job::Exit::fine;
}

int run(int argc, char** argv) {
  CLI::App app{"A skin over DDS: sent by one computer, an arm controlled with it on another."};
  app.footer(job::exit_help());
  app.require_subcommand(1);
  bool quiet = false;
  ParticipantOptions options;
  double rate = 100, seconds_long = 0;
  auto* send_command = app.add_subcommand("send", "Publishes /skin/cells of a UR5 with 260 cells");
  auto* control_command = app.add_subcommand("control", "Runs an arm that gives way to /skin/cells");
  for (auto* command : {send_command, control_command}) {
    command->add_option("--domain", options.domain, "DDS domain (ROS_DOMAIN_ID)")->capture_default_str();
    command->add_option("--interface", options.interface, "the only IPv4 address that is opened")
        ->capture_default_str();
    command->add_option("--seconds", seconds_long, "how long")->default_val(10)->check(CLI::Range(0.1, 1e6));
    command->add_flag("-q,--quiet", quiet, "no progress");
  }
  send_command->add_option("--rate", rate, "frames a second")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1000.0));
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  const job::StopSignals signals;
  job::Progress progress(quiet);
  return job::code(*send_command ? send(options, rate, seconds_long, signals.asked(), progress)
                                 : control(options, seconds_long, signals.asked(), progress));
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
}
