// Writes the programs of a page: `how_to_writer PAGE PROGRAM SERVER`. PROGRAM runs the blocks of
// examples/HOW_TO.md and compares what they print with what the page shows. SERVER is the block that includes
// an adapter: it runs until it is ended, and is compiled only.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <sstream>

#include "tests/support/readme_blocks.hpp"

using skinctl::testing::ShownBlock;

namespace {

constexpr std::ptrdiff_t max_lines = 30, max_lines_of_header = 56;
constexpr const char* includes_header = "#include \"simulated.hpp\"\n";

/// What is wrong with the block; empty: nothing.
std::string fault_of(const ShownBlock& block, bool is_header, bool is_server) {
  if (std::count(block.code.begin(), block.code.end(), '\n') > (is_header ? max_lines_of_header : max_lines))
    return "too many lines";
  if (is_header != block.code.starts_with("#pragma once\n"))
    return "the first block is the header, and no other";
  if (is_header) return "";
  if (block.code.find(includes_header) == std::string::npos) return "it does not include the header";
  if (block.code.find("\nint main() {\n") == std::string::npos) return "no main";
  if (is_server != block.printed.empty()) return "what it prints is not shown, or nothing runs it";
  return "";
}

bool needs_adapter(const ShownBlock& block) {
  return block.code.find("#include \"examples/") != std::string::npos;
}

/// The block without its `#include`s, which are added to `includes`. Errors of the compiler point to the
/// page.
std::string body_of(const ShownBlock& block, const std::string& page, std::string& includes) {
  std::string rest = "#line " + std::to_string(block.line) + " \"" + page + "\"\n";
  std::istringstream lines(block.code);
  for (std::string line; std::getline(lines, line); rest += line + "\n") {
    const bool include = line.starts_with("#include");
    if (include && line + "\n" != includes_header) includes += line + "\n";
    if (include || line == "#pragma once") line.clear();
  }
  return rest;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return std::cerr << "usage: how_to_writer PAGE PROGRAM SERVER\n", 2;
  const std::string page = argv[1];
  std::ostringstream markdown;
  markdown << std::ifstream(page).rdbuf();
  const auto blocks = skinctl::testing::shown_programs(markdown.str());
  std::ofstream program(argv[2]), server(argv[3]);
  std::string includes, programs, table, header;
  int faults = 0, servers = 0;
  for (const ShownBlock& block : blocks) {
    const bool is_header = &block == &blocks.front(), is_server = needs_adapter(block);
    if (const auto fault = fault_of(block, is_header, is_server); !fault.empty()) {
      std::cerr << page << ":" << block.line << ": " << block.heading << ": " << fault << "\n";
      ++faults;
    } else if (is_header) {
      programs += body_of(block, page, includes);
      header = includes + programs;
    } else if (is_server) {
      std::string own;
      const std::string body = body_of(block, page, own);
      server << own << header << body;
      ++servers;
    } else {
      std::string body = body_of(block, page, includes);
      body.replace(body.find("\nint main() {\n") + 1, 3, "void").replace(body.find("main() {\n"), 4, "run");
      const std::string name = "block_" + std::to_string(block.line);
      programs += "namespace " + name + " {\n" + body + "}\n";
      table += "{R\"page(" + block.heading + ")page\", " + name + "::run, R\"page(" + block.printed +
               ")page\"},\n";
    }
  }
  program << includes << "#include \"tests/how_to/compare.hpp\"\n"
          << programs << "#line 1 \"how_to\"\nint main(int argc, char** argv) {\n"
          << "return skinctl::testing::compare(argc, argv, {\n"
          << table << "});\n}\n";
  return faults > 0 || servers != 1 || !program.flush() || !server.flush();
}
