// What files and streams cost: `connect [seconds]` prints the times of encoding and of the hand-over out of
// the loop, and a loop's load with and without a recorder beside an empty loop's (`live_consumers` has all
// consumers). `connect count N` only hands 164 samples over N times, `stamp N` stamps 1260 cells, `patch N`
// sets 164 samples, for counters of instructions such as `valgrind --tool=callgrind`: two runs differ by
// those of the calls that one has more.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <thread>

#include "skinctl/control/gravity_control.hpp"
#include "skinctl/control/skin_joint_control.hpp"
#include "skinctl/fusion/expression.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/recording/mcap_recorder.hpp"
#include "skinctl/robots/ur5_links.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t all_cells = 1260, changed = 164;  // 13 %

/// Median time of `f` [ns] over batches of `n`.
template <class F>
double median(std::size_t n, F&& f) {
  std::vector<double> times;
  for (int batch = 0; batch < 201; ++batch) {
    const auto from = Stopwatch::now();
    for (std::size_t k = 0; k < n; ++k) f();
    times.push_back(double((Stopwatch::now() - from).count()) / double(n));
  }
  std::nth_element(times.begin(), times.begin() + 100, times.end());
  return times[100];
}

auto scene_of(Nanoseconds period) {
  return Cycle(by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0),
                                          .period = period,
                                          .delay = 8ms,
                                          .virtual_damping = 4}),
               ur5_skin<all_cells>({.force = 20}), SkinJointControl{} + GravityControl{});
}
using Scene = decltype(scene_of(8ms));

RunDescription description() {
  RunDescription run;
  run.joints = {"a", "b", "c", "d", "e", "f"};
  run.frames = frames_of<ur5::Ros2Links>();
  run.places = places_of(ur5::Model{});
  const auto add = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& patch) {
    for (const auto& cell : patch.any()) {
      const auto& p = cell.X_LC.origin();
      run.cells.push_back({cell.id, std::uint32_t(I), {float(p.x), float(p.y), float(p.z)}});
    }
  };
  std::apply([&](const auto&... patch) { (add(patch), ...); }, ur5::skin_patches<all_cells>());
  return run;
}

struct Samples {
  std::array<CellSample, all_cells> all{};
  explicit Samples(const std::vector<SkinCloud::Cell>& cells) {
    for (std::size_t i = 0; i < all_cells; ++i)  // neighbours in a cycle are not neighbours in the list
      all[i] = {.time = 1ms, .cell = cells[i * 467 % all_cells].id, .force = {0.01f, 0.02f, 0}};
  }
};

void hand_over_once(CycleHandOver<Scene>& ring, const Scene::Input& input, const Scene::Output& out,
                    const Stopwatch& watch) {
  ring(input, out, watch);
}
/// Empties the ring between batches, which is the other thread's time.
double hand_over_median(std::span<const CellSample> samples) {
  CycleHandOver<Scene> ring;
  Scene::Input input;
  input.samples = samples;
  const Scene::Output out{};
  const Stopwatch watch;
  std::vector<double> times;
  for (int batch = 0; batch < 201; ++batch) {
    const auto from = Stopwatch::now();
    for (int k = 0; k < 50; ++k) hand_over_once(ring, input, out, watch);
    times.push_back(double((Stopwatch::now() - from).count()) / 50);
    ring.consume([](const auto&, auto) {}, [](const auto&) {});
  }
  std::nth_element(times.begin(), times.begin() + 100, times.end());
  return times[100];
}

/// States at its pace by this computer's clock, of an arm that stands.
struct Paced {
  Nanoseconds period{}, next{}, now{};
  Heard wait(State<6>& state) noexcept {
    now += period;
    if (next.count() == 0) next = Stopwatch::now();
    next += period;
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(next));
    if (Stopwatch::now() - next > 10 * period) next = Stopwatch::now();
    state = {};
    state.time = now;
    state.q = home_position();
    return Heard::state;
  }
  bool send(const PositionCommand<6>&) noexcept { return true; }
  void stop() noexcept {}
};
struct Cells {
  const Paced* robot;
  Samples samples;
  std::size_t at = 0;
  std::span<const CellSample> poll() noexcept {
    at = at + changed > all_cells ? 0 : at + changed;
    at = std::min(at, all_cells - changed);
    for (std::size_t i = 0; i < changed; ++i) samples.all[at + i].time = robot->now - 1ms;
    return std::span(samples.all).subspan(at, changed);
  }
};
void row(const char* name, const Histogram& h) {
  const auto us = [&](double share) { return 1e-3 * double(h.percentile(share).count()); };
  std::printf("| %-34s | %7.2f | %7.1f | %7.1f | %7.1f |\n", name, us(0.5), us(0.99), us(0.999),
              1e-3 * double(h.max().count()));
  std::fflush(stdout);
}
template <class After>
void loop(const char* name, Nanoseconds period, std::uint64_t cycles, After&& after) {
  const auto scene = scene_of(period);
  Paced robot{period};
  Cells cells{&robot, Samples(description().cells)};
  const auto memory = std::make_unique<Scene::Memory>();
  after.start(robot.now);
  const auto report = run_loop(
      scene, *memory, robot, cells, {.cycles = cycles, .period = period}, [](auto&, auto&) { return true; },
      [&](const auto& input, const auto& out, const auto& watch) { after(input, out, watch); });
  row(name, report.load);
}
struct Nothing {
  void start(Nanoseconds) {}
  void operator()(const auto&, const auto&, const auto&) {}
};
struct Recorded {
  std::string path = (std::filesystem::temp_directory_path() / "skinctl_connect.mcap").string();
  McapRecorder<Scene> file{path, RunIdentity{"connect"}, description()};
  CycleThread<Scene> thread{{&file}};
  void start(Nanoseconds now) {
    State<6> state;
    state.time = now;
    state.q = home_position();
    thread.start(state);
  }
  void operator()(const auto& input, const auto& out, const auto& watch) { thread(input, out, watch); }
  ~Recorded() {
    thread.finish();
    file.finish();
    std::printf("  recorded: %llu cycles, %.1f MB, %llu without room, %llu refused by the disk\n",
                static_cast<unsigned long long>(file.cycles()), 1e-6 * double(file.size()),
                static_cast<unsigned long long>(thread.dropped()),
                static_cast<unsigned long long>(file.lost()));
    std::filesystem::remove(path);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const RunDescription run = description();
  const Samples samples(run.cells);
  if (argc > 2 && (std::strcmp(argv[1], "stamp") == 0 || std::strcmp(argv[1], "patch") == 0)) {
    SkinCloud cloud(run.cells);
    cloud.set(samples.all);
    for (int k = std::atoi(argv[2]); k > 0; --k)
      if (argv[1][0] == 's') {
        static_cast<void>(cloud.encode(2ms));
      } else {
        cloud.set(std::span(samples.all).first(changed));
      }
    return 0;
  }
  if (argc > 2 && std::strcmp(argv[1], "count") == 0) {
    CycleHandOver<Scene> ring(std::size_t(1) << 24);
    Scene::Input input;
    input.samples = std::span(samples.all).first(changed);
    const Scene::Output out{};
    for (int k = std::atoi(argv[2]); k > 0; --k) hand_over_once(ring, input, out, Stopwatch());
    return 0;
  }
  const double seconds_long = argc > 1 ? std::atof(argv[1]) : 10;

  SkinCloud cloud(run.cells);
  std::vector<LinkPlace> places;
  run.places(std::vector<double>(home.begin(), home.end()), places);
  Nanoseconds now = 2ms;
  const double never = median(20, [&] { static_cast<void>(cloud.encode(now += 10us)); });
  cloud.set(samples.all);
  now = 2ms;
  const double stamp = median(20, [&] { static_cast<void>(cloud.encode(now += 10us)); });
  const double place = median(20, [&] {
    for (std::uint32_t i = 0; i < places.size(); ++i) cloud.place(i, places[i].R, places[i].p);
  });
  const double patch = median(20, [&] { cloud.set(std::span(samples.all).first(changed)); });
  std::printf(
      "%zu cells: stamp, ages and staleness of all %.2f us (of cells that were never heard %.2f us), all "
      "moved with "
      "their links %.2f us, %zu samples %.2f us\n",
      cloud.cells(), 1e-3 * stamp, 1e-3 * never, 1e-3 * place, changed, 1e-3 * patch);
  std::printf("hand-over: no sample %.0f ns", hand_over_median({}));
  for (const std::size_t n : {std::size_t(34), changed, all_cells})
    std::printf(", %zu samples %.2f us", n, 1e-3 * hand_over_median(std::span(samples.all).first(n)));
  std::printf("\n");
  {
    std::vector<unsigned char> bytes(81'037);
    const auto message = cloud.encode(now);
    std::copy(message.begin(), message.end(), bytes.begin());
    volatile std::uint32_t sink = 0;
    const double crc = median(5, [&] { sink = sink + skinctl::detail::crc32(bytes); });
    std::printf("CRC-32 of %zu bytes %.1f us\n", bytes.size(), 1e-3 * crc);
  }

  const Nanoseconds period = 4ms;
  const auto cycles = static_cast<std::uint64_t>(seconds_long / 4e-3);
  std::printf("\nLoad of a loop at 250 Hz, %zu cells, %zu samples a cycle [us], %.0f s each\n\n", all_cells,
              changed, seconds_long);
  std::printf("| loop | median | p99 | p99.9 | worst |\n|---|---|---|---|---|\n");
  loop("a scene", period, cycles, Nothing{});
  loop("a scene, recorded", period, cycles, Recorded{});
  Paced robot{period};
  Histogram none;
  State<6> state;
  for (std::uint64_t k = 0; k < cycles; ++k) {
    robot.wait(state);
    const auto from = Stopwatch::now();
    none.record(Stopwatch::now() - from);
  }
  row("empty", none);
  return 0;
}
