// For tests: a program does not write over what it reads.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "examples/support/run_program.hpp"

namespace examples {

/// Runs `program arguments`, in which IN stands for a file with `content` and OUT for the same file by each
/// of its names; the program must end with `code` and words, and leave the file as it was.
inline void check_own_input_is_kept(const std::string& program, const std::string& arguments,
                                    const std::string& content, int code) {
  namespace fs = std::filesystem;
  std::string folder = (fs::temp_directory_path() / "skinctl_own_input_XXXXXX").string();
  REQUIRE(::mkdtemp(folder.data()) != nullptr);
  const fs::path in = fs::path(folder) / "in";
  const auto fill = [&] { std::ofstream(in, std::ios::binary) << content; };
  fill();
  fs::create_symlink(in, fs::path(folder) / "symbolic");
  fs::create_hard_link(in, fs::path(folder) / "hard");
  for (const char* name : {"in", "./in", "symbolic", "hard"}) {
    std::string words = arguments;
    for (const auto& [mark, path] : {std::pair{"IN", in}, {"OUT", fs::path(folder) / name}})
      if (const auto at = words.find(mark); at != words.npos)
        words.replace(at, std::string(mark).size(), path.string());
    CAPTURE(words);
    const std::string said = run_program(program, words, code);
    CHECK_MESSAGE(said.find("is the input") != std::string::npos, said);
    std::ifstream file(in, std::ios::binary);
    const std::string left{std::istreambuf_iterator<char>(file), {}};
    CHECK(left.size() == content.size());
    CHECK((left == content));
    fill();
  }
  fs::remove_all(folder);
}

}  // namespace examples
