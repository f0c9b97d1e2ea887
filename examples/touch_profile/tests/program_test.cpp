#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "examples/simulated_ur5/contact.hpp"
#include "examples/support/own_input.hpp"

namespace {

struct Outcome {
  int code = -1;
  std::string text;
};

/// Runs the program; `text` is what it says on both streams.
Outcome run(const std::string& arguments) {
  Outcome out;
  std::FILE* pipe = ::popen(("'" TOUCH_PROFILE_PROGRAM "' " + arguments + " 2>&1").c_str(), "r");
  REQUIRE(pipe != nullptr);
  char part[4096];
  for (std::size_t n = 0; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) out.text.append(part, n);
  const int status = ::pclose(pipe);
  out.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return out;
}

/// A folder of its own, removed at the end.
struct Folder {
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "touch_profile_XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return (path / name).string();
  }
  std::filesystem::path path;
};

std::string grasp() {
  std::string text = "-10000\n";
  for (const char* reading : {"243.0", "240.0", "231.0"}) {
    text += "1 2 3 4 5 6 7 8 9\n12 12 12 12 12\n";
    for (int finger = 0; finger < 5; ++finger) {
      for (int i = 0; i < 12; ++i) text += std::string(reading) + ' ';
      text += '\n';
    }
  }
  return text;
}

}  // namespace

TEST_CASE("touch_profile: recording in, profile out") {
  const Folder folder;
  const std::string in = folder.file("grasp.txt", grasp()), out = (folder.path / "touch.csv").string();
  CHECK(run(in + " --peak 24 --rate 5 --out " + out).code == 0);
  std::ifstream file(out);
  const auto profile = simulated_ur5::read_profile(file, out);
  CHECK(profile.at(0.2) == doctest::Approx(6));
  CHECK(profile.at(0.4) == doctest::Approx(24));
  CHECK(profile.duration() == doctest::Approx(0.9));

  const Outcome printed = run(in + " --taxels thumb,30-32");
  CHECK(printed.code == 0);
  CHECK(printed.text.find("over 15 taxels") != std::string::npos);
  std::istringstream rows(run("--generate").text);
  CHECK(simulated_ur5::read_profile(rows, "generated").duration() == doctest::Approx(1.6));
}

TEST_CASE("touch_profile: a profile is not written onto its recording") {
  examples::check_own_input_is_kept(TOUCH_PROFILE_PROGRAM, "IN --peak 24 --rate 5 --out OUT", grasp(), 2);
}

TEST_CASE("touch_profile: what cannot be is said and ends with a code") {
  const Folder folder;
  const std::string whole = grasp(), good = folder.file("good.txt", whole);
  const std::string cut = folder.file("cut.txt", whole.substr(0, whole.size() - 200));
  const auto refused = [](const std::string& arguments, int code, const std::string& because) {
    CAPTURE(arguments);
    const Outcome out = run(arguments);
    CAPTURE(out.text);
    CHECK(out.code == code);
    CHECK(out.text.find(because) != std::string::npos);
  };
  refused("", 2, "recording (or --generate) is required");
  refused("no_such_file.txt", 2, "cannot be opened");
  refused(cut, 2, "cut.txt:20: 4 numbers instead of 12 (taxels of middle)");
  refused(folder.file("lines.txt", whole.substr(0, whole.rfind('\n', whole.size() - 2) + 1)), 2,
          "the file ends within slice 3");
  refused(folder.file("garbage.txt", std::string("\x7f"
                                                 "ELF\0\1\2",
                                                 7)),
          2, "garbage.txt:1: no number");
  refused(good + " --peak -3", 2, "peak = -3, allowed: 0.01 to 1000 N");
  refused(good + " --threshold 5000", 2, "no touch");
  refused(good + " --taxels toe", 2, "'toe' is no finger");
  refused(good + " --rest 3", 2, "the recording has 3");
  refused(good + " --generate", 2, "excludes");
  refused(good + " --out " + (folder.path / "no/such/folder.csv").string(), 3, "cannot write");
}
