// Writes the program that runs the blocks of examples/HOW_TO.md: `how_to_writer PAGE PROGRAM`.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

#include "tests/support/readme_blocks.hpp"

using namespace skinctl::testing;

namespace {

constexpr std::ptrdiff_t most_lines = 30;

/// `text` with its `#include`s moved to `includes`, where they stand outside of any namespace.
std::string without_includes(const std::string& text, std::string& includes) {
  std::string rest;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line == "#pragma once" || line == "#include \"simulated.hpp\"") line.clear();
    const bool include = line.rfind("#include", 0) == 0;
    if (include) includes += line + "\n";
    rest += include ? "\n" : line + "\n";
  }
  return rest;
}

/// Where an error of the compiler is to point.
std::string place(std::size_t line, const std::string& page) {
  return "#line " + std::to_string(line) + " \"" + page + "\"\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::cerr << "usage: how_to_writer PAGE PROGRAM\n", 2;
  std::ostringstream markdown;
  markdown << std::ifstream(argv[1]).rdbuf();
  const auto blocks = shown_programs(markdown.str());
  std::string includes, programs, table;
  int errors = blocks.size() < 2;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const auto& block = blocks[k];
    if (std::count(block.code.begin(), block.code.end(), '\n') > most_lines && k > 0)
      ++errors, std::cerr << argv[1] << ": more than " << most_lines << " lines: " << block.heading << "\n";
    if ((k > 0) != block.code.starts_with("#include \"simulated.hpp\"\n"))
      ++errors, std::cerr << argv[1]
                          << ": the first block is simulated.hpp, the others include it: " << block.heading
                          << "\n";
    if ((k > 0) == block.printed.empty())
      ++errors, std::cerr << argv[1] << ": all blocks but the first show what they print: " << block.heading
                          << "\n";
    std::string code = place(block.line, argv[1]) + without_includes(block.code, includes);
    if (k == 0) {
      programs += code;
      continue;
    }
    const std::string name = "block_" + std::to_string(k);
    const auto main_at = code.find("int main() {");
    if (main_at == code.npos) {
      ++errors, std::cerr << argv[1] << ": no `int main() {`: " << block.heading << "\n";
      continue;
    }
    code.replace(main_at, 12, "void run() {");
    programs += "namespace " + name + " {\n" + code + "}\n";
    table += "    {R\"page(" + block.heading + ")page\", " + name + "::run, R\"page(" + block.printed +
             ")page\"},\n";
  }
  if (errors > 0) return 1;
  std::ofstream(argv[2])
      << includes << "#include \"tests/how_to/compare.hpp\"\n"
      << programs << "#line 1 \"how_to\"\n"
      << "int main(int argc, char** argv) {\n  return skinctl::testing::compare(argc, argv, {\n"
      << table << "  });\n}\n";
  return 0;
}
