// The program as a user runs it, and its files, damaged ones too.
//
// Promise: a task that was shown once is read back, written, loaded and run among other things; what is
// refused says why; damaged files are refused
// Tried: packing, pancakes, sandwiches of simulated people; 24 new oranges at other places; each file cut
// and changed at random, 2000 times

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "examples/support/run_program.hpp"
#include "examples/teach/player.hpp"
#include "examples/teach/written.hpp"
#include "skinctl/testing/random.hpp"

namespace {
namespace fs = std::filesystem;

std::string run(const std::string& arguments, int expected) {
  return examples::run_program(TEACH_PROGRAM, arguments, expected);
}
bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}
std::string contents(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "teach-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};
/// `file` with a few bytes changed, or cut.
std::string damaged(std::string text, skinctl::testing::Random& random) {
  for (std::uint64_t k = random() % 6; k-- > 0;) text[random() % text.size()] = static_cast<char>(random());
  if (random() % 4 == 0) text.resize(random() % text.size());
  return text;
}
}  // namespace

TEST_CASE("teach: shown once, learnt, read back, and run among 24 new oranges at other places") {
  const Folder folder;
  const std::string led = folder.file("led.txt"), task = folder.file("task.json");
  run("record --task packing --seed 3 " + led, 0);
  const std::string said = run("learn " + led + " --task " + task + " --svg " + folder.file("task.svg") +
                                   " --xml " + folder.file("task.xml"),
                               0);
  for (const char* word : {"orange", "box", "bin", "squeeze", "proved"}) CHECK_MESSAGE(has(said, word), said);
  const std::string ran = run("run " + task + " --count 24 --seed 7 --quiet", 0);
  CHECK_MESSAGE(has(ran, "finished"), ran);
  CHECK_MESSAGE(has(ran, "orange, hard: box"), ran);
  CHECK_MESSAGE(has(ran, "orange, soft: bin"), ran);
  CHECK_MESSAGE(!has(ran, "hard: bin"), ran);
  CHECK_MESSAGE(!has(ran, "soft: box"), ran);
  CHECK(has(contents(folder.file("task.svg")), "<svg"));
  CHECK(has(contents(folder.file("task.xml")), "BTCPP_format=\"4\""));
  // What was written is what is loaded.
  auto loaded = teach::load(task);
  CHECK(teach::to_json(loaded) == contents(task));
  CHECK_FALSE(check(loaded.task).any());
}

TEST_CASE("teach: a branch whose ways meet again is read back, drawn and written with what follows") {
  using namespace skinctl;
  teach::NamedTask named;
  named.classes.names = {{1, "orange"}, {2, "cup"}};
  auto& t = named.task;
  const auto add = [&](Step s) { t.steps[t.size++] = s; };
  add(step_of<activity::Take>({.role = 1, .done = 1}));
  add(step_of<activity::Squeeze>({.role = 1, .done = 2, .no = 3, .border = 0}));
  add(step_of<activity::Release>({.role = 1, .done = 4}));
  add(step_of<activity::Release>({.role = 1, .done = 4}));
  add(step_of<activity::Take>({.role = 2, .done = finish}));
  t.border_count = 1, t.borders[0] = 700;
  CHECK(teach::to_text(named) ==
        "take the orange\nsqueeze the orange where it is\nif it is 700 N/m or harder:\n"
        "  put the orange down where it is\nsofter than 700 N/m:\n  put the orange down where it is\n"
        "take the cup\n");
  const std::string xml = teach::to_xml(named);
  CHECK(xml.find("</IfThenElse>") < xml.find("role=\"cup\""));
  CHECK(has(teach::to_svg(named), "cup"));
}

TEST_CASE("teach: other tasks, more people, and words while somebody shows") {
  const Folder folder;
  for (const char* task : {"pancake", "sandwich"}) {
    CAPTURE(task);
    const std::string led = folder.file(std::string(task) + ".txt");
    run("record --task " + std::string(task) + " --seed 4 " + led, 0);
    CHECK(has(run("learn " + led, 0), "proved"));
  }
  const std::string led = folder.file("sandwich.txt");
  const std::string live = run("live --task sandwich --seed 4 --speed 0", 0);
  for (const char* word : {"reach", "take", "put", "release", "cut"}) CHECK_MESSAGE(has(live, word), live);
  CHECK(run("live " + led + " --speed 0", 0) == live);
}

TEST_CASE("teach: what goes wrong has words and an exit code") {
  const Folder folder;
  run("", 2);
  run("live --task cooking", 2);
  run("run " + folder.file("none"), 1);
  CHECK(has(run("learn " + folder.file("none"), 1), "cannot read"));
  CHECK(has(run("record --people nobody " + folder.file("x"), 1), "no such people"));
  const auto says = [&](const std::string& text, const std::string& why) {
    std::ofstream(folder.file("wrong.txt")) << text;
    const std::string out = run("learn " + folder.file("wrong.txt"), 1);
    CHECK_MESSAGE(has(out, why), out);
  };
  says("", "no line of the hand");
  says("thing 1 orange\nhand 0 0 0 0 0 0 0 nan 0\n", "line 2");
  says("hand 0 0 0 0 0 0 0 1 0\nhand 0 0 0 0 0 0 0 1 0\n", "line 2: its time is not after");
  says("thing 1 or<nge\n", "a name of letters");
  says("thing 1 orange\nthing 1 apple\n", "two names");
  says("seen 0 0 0 0 0 0 0 0\n", "no such thing");
  says("foot 1 2\n", "neither thing, hand nor seen");
}

TEST_CASE("teach: 2000 damaged recordings and tasks are read or refused, and what is read is used") {
  const Folder folder;
  const std::string led = folder.file("led.txt"), task = folder.file("task.json"), bad = folder.file("bad");
  run("record --task packing --seed 3 " + led, 0);
  run("learn " + led + " --task " + task, 0);
  auto recording = teach::read(led);
  recording.shown.hand.resize(60);
  recording.shown.seen.resize(30);
  teach::write(recording, led);
  auto random = skinctl::testing::seeded(5);
  const std::string good[2] = {contents(led), contents(task)};
  int refused[2] = {};
  for (int i = 0; i < 2000; ++i) {
    const bool of_task = i % 2 == 1;
    std::ofstream(bad) << damaged(good[of_task], random);
    try {
      if (of_task) {
        auto read = teach::load(bad);
        CHECK_FALSE(check(read.task).any());
      } else {
        teach::play(teach::read(bad), [](const auto&...) {});
      }
    } catch (const std::runtime_error&) {
      ++refused[of_task];
    }
  }
  CHECK(refused[0] > 250);
  CHECK(refused[1] > 250);
}
