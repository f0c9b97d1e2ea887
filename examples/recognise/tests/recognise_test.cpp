// The program as a user runs it, and its files, damaged ones too.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "examples/recognise/player.hpp"
#include "examples/support/run_program.hpp"

namespace {
namespace fs = std::filesystem;

std::string run(const std::string& arguments, int expected) {
  return examples::run_program(RECOGNISE_PROGRAM, arguments, expected);
}
bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}
class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "recognise-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    path = pattern;
  }
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path path;
};
}  // namespace

TEST_CASE("recognise: live and from a recording the words are the same, and tables follow") {
  const Folder folder;
  const std::string file = (folder.path / "led.txt").string();
  const std::string live = run("live --task sandwich --seed 3 --speed 0", 0);
  CHECK_MESSAGE(has(live, "cut"), live);
  for (const char* word : {"reach", "take", "put", "release", "by definition: right for 9"})
    CHECK_MESSAGE(has(live, word), word);
  run("record --task sandwich --seed 3 " + file, 0);
  const std::string played = run("play " + file, 0);
  // The file has nine digits: what was said and when agrees.
  CHECK(played.substr(0, played.find("by definition")) == live.substr(0, live.find("by definition")));
  CHECK(has(run("tables --people 1", 0), "by intent: right for"));
  // A cut is one use by intent; by definition it begins when the knife comes near the bread.
  const std::string meant = run("play --intent " + file, 0);
  CHECK(meant != played);
  CHECK_MESSAGE(has(meant, "cut"), meant);
}

TEST_CASE("recognise: what goes wrong has words and an exit code") {
  const Folder folder;
  run("", 2);
  run("live --task cooking", 2);
  CHECK(has(run("play " + (folder.path / "none").string(), 1), "cannot read"));
  const auto file = folder.path / "wrong.txt";
  const auto says = [&](const std::string& text, const std::string& why) {
    std::ofstream(file) << text;
    const std::string out = run("play " + file.string(), 1);
    CHECK_MESSAGE(has(out, why), out);
  };
  says("", "no line of the hand");
  says("thing 1\nhand 0 0 0 0 nan 0 0\n", "line 2");
  says("hand 0 0 0 0 1 0 0\nhand 0 0 0 0 1 0 0\n", "line 2: its time is not after");
  says("hand 0 0 0 0 1 77 0\n", "no such activity");
  says("seen 0 0 0 0 0\n", "no such thing");
  says("foot 1 2\n", "neither thing, hand nor seen");
}

TEST_CASE("recognise: 2000 damaged files are read or refused, and what is read can be played") {
  using namespace recognise;
  using namespace skinctl::testing;
  const Folder folder;
  const std::string file = (folder.path / "led.txt").string();
  auto random = seeded(5);
  const auto person = Person::any(random);
  auto recording = record(led_run(LedTask::table, person, 6), 7);
  recording.lines.resize(60);
  recording.seen.resize(30);
  write(recording, file);
  std::string good;
  std::getline(std::ifstream(file), good, '\0');
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string bad = good;
    for (std::uint64_t k = random() % 6; k-- > 0;) bad[random() % bad.size()] = static_cast<char>(random());
    if (random() % 4 == 0) bad.resize(random() % bad.size());
    std::ofstream(file) << bad;
    try {
      const auto read_back = read(file);
      play(read_back, [](const auto&...) {});
    } catch (const std::runtime_error&) {
      ++refused;
    }
  }
  CHECK(refused > 500);
}
