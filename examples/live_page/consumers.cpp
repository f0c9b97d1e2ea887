// What watching costs a loop: a scene of 1260 cells at 250 Hz without a consumer, recorded, streamed to a
// live view with a client, published over DDS, and all at once, beside a loop that does nothing, alone and
// with the same consumers at work. Rows take turns, so that a machine that is busy for a while is busy for
// all of them; how late it woke each one is printed.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "examples/adapters/live/live_view.hpp"
#include "examples/live_page/page.hpp"
#include "examples/live_page/tests/byte_client.hpp"
#include "examples/support/program.hpp"
#include "examples/support/svg_plot.hpp"
#include "skinctl/recording/mcap_recorder.hpp"
#include "skinctl/skinctl.hpp"
#ifdef SKINCTL_HAS_DDS
#include "examples/adapters/dds/dds_view.hpp"
#endif

using namespace skinctl;

namespace {

constexpr std::size_t all_cells = 1260, changed = 164;  // 13 % a cycle
constexpr Nanoseconds period = 4ms;
constexpr JointPosition<6> home{0.4, -1.1, 1.2, -1.6, -1.4, 0.0};

auto make_scene() {
  return Cycle(by_position(ur5::Model{}, {.limits = limits_of<ur5::Description>(15.0),
                                          .period = period,
                                          .delay = 8ms,
                                          .virtual_damping = 4}),
               ur5_skin<all_cells>({.force = 20}), SkinJointControl{} + GravityControl{});
}
using Scene = decltype(make_scene());

RunDescription description() {
  RunDescription run;
  run.joints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};
  run.laws = {"skin joint", "gravity"};
  run.frames = frames_of<ur5::Ros2Links>();
  run.places = places_of(ur5::Model{});
  run.newtons = 20;
  run.pressed.places = cell_places(ur5::skin_patches<all_cells>({}));
  const auto add = [&]<std::size_t I, std::size_t N>(const Patch<I, N>& patch) {
    for (const auto& cell : patch.any()) {
      const auto& p = cell.X_LC.origin();
      run.pressed.ids.push_back(cell.id);
      run.cells.push_back({cell.id, std::uint32_t(I), {float(p.x), float(p.y), float(p.z)}});
    }
  };
  std::apply([&](const auto&... patch) { (add(patch), ...); }, ur5::skin_patches<all_cells>());
  return run;
}

/// States at their pace by this computer's clock, of an arm that stands.
struct Paced {
  Nanoseconds next{}, now{};
  Histogram late;  ///< how much later than it asked for it was woken

  Heard wait(State<6>& state) noexcept {
    now += period;
    if (next == 0ns) next = Stopwatch::now();
    next += period;
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(next));
    const Nanoseconds off = Stopwatch::now() - next;
    late.record(off);
    if (off > 10 * period) next = Stopwatch::now();
    state = {};
    state.time = now;
    state.q = home;
    return Heard::state;
  }
  bool send(const PositionCommand<6>&) noexcept { return true; }
  void stop() noexcept {}
};
/// Every eighth of the skin in turn; a hand presses some of it.
struct Cells {
  const Paced* robot;
  std::array<CellSample, all_cells> all{};
  std::size_t at = 0;

  explicit Cells(const Paced& r, const std::vector<SkinCloud::Cell>& cells) : robot(&r) {
    for (std::size_t i = 0; i < all_cells; ++i)
      all[i] = {.cell = cells[i * 467 % all_cells].id, .force = {i % 50 == 0 ? 0.05f : 0.0f, 0, 0}};
  }
  std::span<const CellSample> poll() noexcept {
    at = at + 2 * changed > all_cells ? 0 : at + changed;
    for (std::size_t i = 0; i < changed; ++i) all[at + i].time = robot->now - 1ms;
    return std::span(all).subspan(at, changed);
  }
};

/// Whoever watches: made once, at work in the rows that name it.
struct Consumers {
  explicit Consumers(const RunDescription& run)
      : path(file_path()), file(path, RunIdentity{"consumers"}, run) {
    adapters::live::ServerOptions options;
    live_page::put_page(options);
    server.emplace(std::move(options));
    view.emplace(*server, requests, run);
    server->start();
    std::printf("live: %s\n", server->url().c_str());
    std::fflush(stdout);
#ifdef SKINCTL_HAS_DDS
    participant.emplace(adapters::dds::ParticipantOptions{.domain = 79});
    dds.emplace(*participant, run);
    other.emplace(adapters::dds::ParticipantOptions{.domain = 79});
    reader.emplace(*other, all_cells);
#endif
  }
  static std::string file_path() {
    return (std::filesystem::temp_directory_path() / "skinctl_consumers.mcap").string();
  }
  ~Consumers() { std::filesystem::remove(path); }

  std::string path;
  McapRecorder<Scene> file;
  adapters::live::Requests requests;
  std::optional<adapters::live::FoxgloveServer> server;
  std::optional<adapters::live::LiveView<Scene>> view;
#ifdef SKINCTL_HAS_DDS
  std::optional<adapters::dds::Participant> participant, other;
  std::optional<adapters::dds::DdsView<Scene>> dds;
  std::optional<adapters::dds::SkinReader> reader;
#endif
};

/// A client in a thread of its own that hears every topic.
class Listener {
 public:
  explicit Listener(std::uint16_t port) : thread_([this, port] { listen(port); }) {}
  ~Listener() {
    ending_ = true;
    thread_.join();
  }
  [[nodiscard]] std::uint64_t messages() const noexcept { return messages_; }

 private:
  void listen(std::uint16_t port) {
    live_page::Client client(port);
    client.send(live_page::Client::get("/", "127.0.0.1:" + std::to_string(port),
                                       live_page::Client::upgrade("foxglove.sdk.v1")));
    client.reply();
    nlohmann::json wanted = nlohmann::json::array();
    const auto offered = client.text("advertise");
    for (const auto& c : offered["channels"]) wanted.push_back({{"id", c["id"]}, {"channelId", c["id"]}});
    client.say({{"op", "subscribe"}, {"subscriptions", wanted}});
    while (!ending_)
      if (client.next(std::chrono::milliseconds(100))) ++messages_;
  }
  std::atomic<bool> ending_{false};
  std::atomic<std::uint64_t> messages_{0};
  std::thread thread_;
};

struct Row {
  const char* name;
  bool scene, recorded, live, dds;
  Histogram load{}, late{};
  std::uint64_t dropped = 0;
};

void run(Row& row, Consumers& consumers, const RunDescription& description, std::uint64_t cycles) {
  static const Scene scene = make_scene();
  std::vector<CycleConsumer<Scene>*> at_work;
  if (row.recorded) at_work.push_back(&consumers.file);
  if (row.live) at_work.push_back(&*consumers.view);
#ifdef SKINCTL_HAS_DDS
  if (row.dds) at_work.push_back(&*consumers.dds);
#endif
  std::optional<CycleThread<Scene>> thread;
  if (!at_work.empty()) thread.emplace(at_work);
  std::optional<Listener> listener;
  if (row.live) listener.emplace(consumers.server->port());
  Paced robot;
  Cells cells(robot, description.cells);
  State<6> standing;
  standing.q = home;
  if (thread) thread->start(standing);
  if (row.scene) {
    const auto memory = std::make_unique<Scene::Memory>();
    const auto report = run_loop(
        scene, *memory, robot, cells, {.cycles = cycles, .period = period}, [](auto&, auto&) { return true; },
        [&](const auto& input, const auto& out, const auto& watch) {
          if (thread) (*thread)(input, out, watch);
        });
    row.load.merge(report.load);
  } else {
    // Nothing between two looks at the clock; what the consumers get is handed over behind them.
    Scene::Input input;
    const Scene::Output out{};
    const Stopwatch watch;
    for (std::uint64_t k = 0; k < cycles; ++k) {
      robot.wait(input.measured);
      const Nanoseconds from = Stopwatch::now();
      row.load.record(Stopwatch::now() - from);
      input.now = robot.now;
      input.samples = cells.poll();
      if (thread) (*thread)(input, out, watch);
    }
  }
  row.late.merge(robot.late);
  if (!thread) return;
  thread->finish();
  row.dropped += thread->dropped();
}

double us(Nanoseconds t) {
  return 1e-3 * double(t.count());
}
/// How many cycles of a row took longer than each time, as a share, on scales of powers of ten.
plotting::Series tail(const char* name, const Histogram& h, int color, bool dashed) {
  plotting::Series s{name, {}, {}, color, dashed};
  std::uint64_t seen = 0;
  h.for_each([&](Nanoseconds end, std::uint64_t count) {
    s.x.push_back(std::log10(us(end)));
    s.y.push_back(std::log10(double(h.count() - seen) / double(h.count())));
    seen += count;
  });
  return s;
}

int work(double seconds_long, int rounds, const std::string& picture) {
  const RunDescription description = ::description();
  std::printf("%s", request_real_time().report.c_str());
  Consumers consumers(description);
#ifdef SKINCTL_HAS_DDS
  constexpr bool has_dds = true;
#else
  constexpr bool has_dds = false;
#endif
  std::vector<Row> rows = {{"nothing", false, false, false, false},
                           {"nothing, all consumers at work", false, true, true, has_dds},
                           {"the scene", true, false, false, false},
                           {"the scene, recorded", true, true, false, false},
                           {"the scene, live, a client that hears all", true, false, true, false}};
  if (has_dds) rows.push_back({"the scene, over DDS, a reader", true, false, false, true});
  rows.push_back({"the scene, all of them", true, true, true, has_dds});
  const auto cycles = static_cast<std::uint64_t>(seconds_long / seconds<double>(period));
  for (int round = 0; round < rounds; ++round)
    for (Row& row : rows) run(row, consumers, description, cycles);

  std::printf("\nLoad of a loop at 250 Hz, %zu cells, %zu samples a cycle [us], %d times %.0f s each\n\n",
              all_cells, changed, rounds, seconds_long);
  std::printf(
      "| loop | median | p99 | p99.9 | max | cycles dropped | woken > 0.1 ms late | > 1 ms | latest [ms] |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const Row& r : rows) {
    std::uint64_t late = 0, very = 0;
    r.late.for_each([&](Nanoseconds end, std::uint64_t n) {
      late += end > 100us ? n : 0;
      very += end > 1ms ? n : 0;
    });
    std::printf("| %s | %.2f | %.1f | %.1f | %.1f | %llu | %llu of %llu | %llu | %.2f |\n", r.name,
                us(r.load.percentile(0.5)), us(r.load.percentile(0.99)), us(r.load.percentile(0.999)),
                us(r.load.max()), static_cast<unsigned long long>(r.dropped),
                static_cast<unsigned long long>(late), static_cast<unsigned long long>(r.late.count()),
                static_cast<unsigned long long>(very), 1e-3 * us(r.late.max()));
  }
  const auto sent = consumers.server->statistics();
  std::printf(
      "\nrecorded %llu cycles, %.1f MB, %llu refused by the disk; streamed %llu messages, %llu dropped for "
      "slow clients\n",
      static_cast<unsigned long long>(consumers.file.cycles()), 1e-6 * double(consumers.file.size()),
      static_cast<unsigned long long>(consumers.file.lost()), static_cast<unsigned long long>(sent.sent),
      static_cast<unsigned long long>(sent.dropped));
#ifdef SKINCTL_HAS_DDS
  std::printf("published %llu frames over DDS, %llu messages refused\n",
              static_cast<unsigned long long>(consumers.dds->frames()),
              static_cast<unsigned long long>(consumers.dds->refused()));
#endif
  if (picture.empty()) return 0;
  plotting::Plot plot;
  plot.title = "Cycles that take longer";
  plot.x_name = "load [us], power of ten";
  plot.y_name = "share of cycles, power of ten";
  plot.from_zero = false;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k].scene)  // a loop that does nothing takes a hundredth of it
      plot.series.push_back(tail(rows[k].name, rows[k].load, static_cast<int>(k) - 2, false));
  return plotting::write_svg(picture, plotting::svg_plot(plot)) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  double seconds_long = 5;
  int rounds = 4;
  std::string picture;
  CLI::App app("What watching costs a loop: a table, and a plot.");
  app.add_option("--seconds", seconds_long, "of each row in a round")
      ->capture_default_str()
      ->check(CLI::Range(0.2, 1e4));
  app.add_option("--rounds", rounds, "of all rows")->capture_default_str()->check(CLI::Range(1, 10000));
  app.add_option("--picture", picture, "SVG file of the distributions");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  try {
    return work(seconds_long, rounds, picture);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "live_consumers: %s\n", e.what());
    return 1;
  }
}
