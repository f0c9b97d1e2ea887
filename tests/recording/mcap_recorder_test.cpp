// Promise: a run replays from its file to the bit, and another scene or build is refused with both in
// words
// Tried: goals, stop, resume, weights, two configurations, broken states; cut files replay as far as they
// go. Also: `examples/compliant_ur5/tests/main_job_test.cpp`

#include "skinctl/recording/mcap_recorder.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "skinctl/cycle/configurations.hpp"
#include "skinctl/fusion/blended.hpp"
#include "skinctl/recording/recorded_run.hpp"
#include "skinctl/robots/ur5_links.hpp"
#include "skinctl/testing/allocation_guard.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"
#include "tests/support/wrong_text.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// Goals, weights of a blended sum, two configurations, touches: everything that a run can be told.
auto changing_scene(double force_gain = 40) {
  JointControlSettings<6> gains;
  gains.dt = 2500us;
  gains.lambda = 25;
  gains.K_c = 5;
  gains.tb = 4s;
  gains.virtual_dynamics = shape<double>(SceneSettings{});
  const auto scene = [&](double force) {
    SceneSettings s;
    s.force_gain = force;
    return make_scene<Interface::position, 260, double>(
        blended(1.0 * SkinJointControl{} + 1.0 * SplineJoint<6>(gains) + GravityControl{}), s);
  };
  return Configurations(scene(force_gain), scene(3 * force_gain));
}
using Scene = decltype(changing_scene());

RunDescription description() {
  RunDescription run;
  run.joints = {"a", "b", "c", "d", "e", "f"};
  run.laws = {"reach", "skin", "gravity"};
  run.urdf = "<robot/>";
  run.layout = "{}";
  run.pressed.threshold = 0.05;  // of readings up to 0.4
  run.frames = frames_of<ur5::Ros2Links>();
  run.places = places_of(ur5::Model{});
  for (std::uint32_t i = 0; i < 60; ++i) {
    run.cells.push_back({i, i / 10, {0.01f * float(i), 0, 0.05f}});
    run.pressed.places.push_back({i / 10, i / 10, {0.01 * i, 0.0, 0.05}, {0.0, 0.0, 1.0}});
    run.pressed.ids.push_back(i);
  }
  return run;
}

/// A run of touches, goals, a stop, a resume and nonsense, each cycle given to `after`.
template <class Start, class After>
void run(const Scene& scene, int cycles, Start&& start, After&& after) {
  auto memory = std::make_unique<Scene::Memory>();
  StiffJoints<> robot(home_position(), 8ms, 4ms);
  scene.start(*memory, robot.state());
  start(robot.state());
  oracle::Random random(5);
  std::array<CellSample, 40> samples;
  std::uint32_t configuration = 0, changes = 0;
  Status all;
  for (int k = 1; k <= cycles; ++k) {
    Scene::Input input;
    input.now = k * 8ms;
    input.measured = robot.run_to(input.now);
    if (k % 300 == 0) input.measured.q[2] = std::numeric_limits<double>::quiet_NaN();
    for (auto& s : samples)
      s = {.time = input.now - 1ms * random.index(8),
           .cell = static_cast<std::uint32_t>(random.index(261)),
           .force = {static_cast<float>(random.uniform(0, 0.4)), 0, 0}};
    input.samples = std::span(samples).first(static_cast<std::size_t>(k % 40));
    if (k % 100 == 0 || k % 150 == 0) input.goal.emplace();
    if (k % 100 == 0) {
      input.goal->goal = {home_position(), 0s};
      input.goal->goal->q_g[0] += 0.2;
    }
    if (k % 150 == 0) input.goal->weights.emplace().of = {k % 300 == 0 ? 1.0 : 0.3, 0.7, 1};
    input.configuration = static_cast<std::uint32_t>(k / 130 % 2);
    changes += input.configuration != configuration;
    configuration = input.configuration;
    input.request = k == 200 ? CycleRequest::stop : k == 220 ? CycleRequest::resume : CycleRequest::none;
    const auto out = scene.step(*memory, input);
    all |= out.status;
    after(input, out);
    robot.command(input.now, out.command.position);
  }
  if (cycles < 500) return;
  CHECK(changes == 4);
  for (const Reason r : {Reason::stopping, Reason::bumpless_transfer, Reason::state_not_finite})
    CHECK(all.has(r));
  CHECK_FALSE(all.has(Reason::configuration_refused));
}
std::string path_of(const char* name) {
  return (std::filesystem::temp_directory_path() / (std::string("skinctl_run_") + name + ".mcap")).string();
}
std::string words_of(const std::string& path, const RunIdentity& identity) {
  return complaint_of([&] { static_cast<void>(load_run<Scene>(path, identity)); });
}

}  // namespace

TEST_CASE("Run description: frames of a URDF that move, and the cells of placed patches, link by link") {
  Urdf urdf;
  urdf.frames = {{"base_link", -1, {}, {}}, {"hand", 2, {}, {0, 0, 0.1}}};
  const auto frames = frames_of(urdf);
  REQUIRE(frames.size() == 1);
  CHECK((frames[0].name == "hand" && frames[0].link == 2 && frames[0].in_link.p.z == 0.1));

  const auto at = [](double z) { return Transform<SomeLink, Cell>::translation_xyz(0, 0, z); };
  RunDescription run;
  add_cells(run, {SkinPatch{2, {}, {SkinCell{.id = 7, .X_LC = at(0.2)}, SkinCell{.id = 8, .X_LC = at(0.3)}}},
                  SkinPatch{0, {}, {SkinCell{.id = 9, .X_LC = at(0.4)}}}});
  CHECK(run.pressed.ids == std::vector<std::uint32_t>{7, 8, 9});
  CHECK((run.pressed.places[2].link == 0 && run.pressed.places[2].patch == 1));
  CHECK((run.cells[0].id == 9 && run.cells[0].link == 0 && run.cells[0].position[2] == 0.4f));
  CHECK((run.cells[1].id == 7 && run.cells[2].id == 8));
}

TEST_CASE(
    "McapRecorder: what the loop hands over replays from the file to the bit, and nothing is allocated "
    "there") {
  const auto scene = changing_scene();
  const auto path = path_of("recorder");
  const RunIdentity identity{"reaching, force gain 40"};
  McapRecorder<Scene> recorder(path, identity, description());
  CycleThread<Scene> thread({&recorder});
  const AllocationGuard guard;
  std::uint64_t allocated = 0;
  run(
      scene, 600, [&](const State<6>& s) { thread.start(s); },
      [&](const auto& input, const auto& out) {
        const auto before = guard.count();
        thread(input, out, NoStopwatch{});
        allocated += guard.count() - before;
      });
  thread.finish();
  CHECK(recorder.finish());
  CHECK(recorder.cycles() == 600);
  CHECK(recorder.lost() == 0);
  CHECK(thread.dropped() == 0);
  CHECK(allocated == 0);

  const auto loaded = load_run<Scene>(path, identity);
  CHECK(loaded.whole);
  CHECK(loaded.missing_cycles == 0);

  SUBCASE("it replays, from memory and from the file; another scene does otherwise") {
    const auto again = replay(scene, loaded.recording);
    CHECK(again.cycles == 600);
    CHECK(again.different == 0);
    CHECK(replay(changing_scene(41), loaded.recording).different > 0);
    const auto at_once = replay(path, scene, identity);
    CHECK(at_once.whole);
    CHECK(at_once.missing_cycles == 0);
    CHECK(at_once.cycles == 600);
    CHECK(at_once.different == 0);
  }
  SUBCASE("every topic is there, at its rate") {
    std::map<std::string, std::size_t> counts, sizes;
    const MappedFile file(path);
    read_mcap(file.bytes(), [&](const McapMessage& m) {
      ++counts[m.channel.topic];
      sizes[m.channel.topic] = m.bytes.size();
    });
    CHECK(counts["/skinctl/start"] == 1);
    CHECK(counts["/skinctl/cycle"] == 600);
    CHECK(counts["/joint_states"] == 600);
    CHECK(counts["/skinctl/torque_shares"] == 600);
    CHECK(counts["/robot_description"] == 1);
    CHECK(counts["/skin/layout"] == 1);
    const auto at = [&](const char* topic, std::size_t hz) {
      CAPTURE(topic);
      CHECK(counts[topic] >= hz * 47 / 10);  // 4.8 s
      CHECK(counts[topic] <= hz * 50 / 10);
    };
    at("/skin/cells", 30);
    at("/skin/contacts", 30);
    CHECK(sizes["/skin/contacts"] >= 225 + 32);  // one at least
    CHECK((sizes["/skin/contacts"] - 225) % 32 == 0);
    at("/tf", 30);
    at("/skinctl/status", 10);
    CHECK(sizes["/skin/cells"] == 60 * 64 + 449);
  }
  SUBCASE("another scene, build or kind is refused, with both in words") {
    CHECK(words_of(path, {"reaching, force gain 41"}) ==
          "skinctl: " + path +
              " was recorded with another scene:\n  there reaching, force gain 40\n  here  reaching, force "
              "gain 41");
    CHECK(words_of(path, {identity.scene, "GCC 1"}).find("another build:\n  there skinctl 0.1.0, ") !=
          std::string::npos);
    const auto single = [&] {
      static_cast<void>(
          load_run<decltype(reaching_scene<Interface::position, 260, float>())>(path, identity));
    };
    CHECK_THROWS_WITH_AS(single(), doctest::Contains("32-bit numbers"), ConfigurationError);
    CHECK(words_of("/nowhere/at/all", identity) == "skinctl: /nowhere/at/all: No such file or directory");
  }
  SUBCASE("a file that was cut replays as far as it goes") {
    for (const double share : {0.3, 0.7}) {
      const auto part = path_of("part");
      std::filesystem::copy_file(path, part, std::filesystem::copy_options::overwrite_existing);
      std::filesystem::resize_file(
          part, static_cast<std::uintmax_t>(share * double(std::filesystem::file_size(path))));
      const auto cut = load_run<Scene>(part, identity);
      CHECK_FALSE(cut.whole);
      CHECK(cut.recording.cycles() > 100);
      CHECK(cut.recording.cycles() < 600);
      CHECK(replay(scene, cut.recording).different == 0);
      std::filesystem::remove(part);
    }
  }
  std::filesystem::remove(path);
}

TEST_CASE(
    "CycleThread: a consumer that stands still costs cycles, which are counted; the run replays up to "
    "there") {
  struct Slow : CycleConsumer<Scene> {
    std::vector<std::uint32_t> numbers;
    std::atomic<bool> go{false};
    std::atomic<std::size_t> taken{0};
    void start(const Beginning&, std::span<const unsigned char>) override {}
    void cycle(const CycleRecord<Scene>& r) override {
      while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      numbers.push_back(r.number);
      ++taken;
    }
  } slow;
  const auto path = path_of("gap");
  const RunIdentity identity{"gap"};
  McapRecorder<Scene> recorder(path, identity, description());
  const auto scene = changing_scene();
  {
    CycleThread<Scene> thread({&slow, &recorder}, 1 << 16);
    int k = 0;
    run(
        scene, 300, [&](const State<6>& s) { thread.start(s); },
        [&](const auto& input, const auto& out) {
          thread(input, out, NoStopwatch{});
          slow.go = ++k >= 200;
          while (slow.go && slow.taken + thread.dropped() < std::size_t(k)) std::this_thread::yield();
        });
    thread.finish();
    CHECK(thread.dropped() > 50);
    CHECK(slow.numbers.size() + thread.dropped() == 300);
    CHECK(slow.numbers.back() == 299);
  }
  CHECK_FALSE(recorder.finish());
  const auto loaded = load_run<Scene>(path, identity);
  CHECK(loaded.missing_cycles == 300 - slow.numbers.size());
  CHECK(loaded.recording.cycles() > 10);
  CHECK(loaded.recording.cycles() < 150);
  CHECK(replay(scene, loaded.recording).different == 0);
  std::filesystem::remove(path);
}
