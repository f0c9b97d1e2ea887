// fuzz_parsers: feeds every parser the inputs of its corpus, and damaged copies of them.
//
//     fuzz_parsers CORPUS [ROUNDS]          replays each input, then ROUNDS damaged copies of it (default: 200)
//     fuzz_parsers CORPUS --unpack FOLDER   writes the inputs as files for libFuzzer
//     fuzz_parsers CORPUS --pack FOLDER     makes the corpus of such files
//
// CORPUS is a folder with a file NAME.hex for each parser: one input a line.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "examples/fuzz/parsers.hpp"

namespace {

using Bytes = std::vector<std::uint8_t>;
namespace fs = std::filesystem;

std::vector<Bytes> read_corpus(const fs::path& file) {
  std::vector<Bytes> out;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    Bytes bytes;
    for (std::size_t k = 0; k + 1 < line.size(); k += 2)
      bytes.push_back(static_cast<std::uint8_t>(std::strtoul(line.substr(k, 2).c_str(), nullptr, 16)));
    out.push_back(std::move(bytes));
  }
  return out;
}
void write_corpus(const fs::path& file, const std::vector<Bytes>& inputs) {
  std::set<std::string> lines;
  for (const Bytes& bytes : inputs) {
    std::string line;
    for (const std::uint8_t b : bytes) {
      char digits[3];
      std::snprintf(digits, sizeof digits, "%02x", b);
      line += digits;
    }
    lines.insert(line);
  }
  std::ofstream out(file);
  for (const std::string& line : lines) out << line << '\n';
}
/// Bits, bytes, runs, lengths: what goes wrong on a line, and what an enemy would try.
void damage(Bytes& bytes, std::mt19937& rng) {
  for (std::size_t n = 1 + rng() % 4; n > 0 && !bytes.empty(); --n) {
    const std::size_t at = rng() % bytes.size();
    switch (rng() % 6) {
      case 0:
        bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1u << rng() % 8));
        break;
      case 1:
        bytes[at] = static_cast<std::uint8_t>(rng());
        break;
      case 2:
        bytes[at] = rng() % 2 ? 0xff : 0;
        break;
      case 3:
        bytes.resize(at);
        break;
      case 4:
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), 1 + rng() % 8, bytes[at]);
        break;
      default: {  // a part of it once more
        const Bytes part(
            bytes.begin() + static_cast<std::ptrdiff_t>(at),
            bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), at + rng() % 64)));
        bytes.insert(bytes.end(), part.begin(), part.end());
        break;
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool help = argc == 2 && std::strcmp(argv[1], "--help") == 0;
  if (argc < 2 || argv[1][0] == '-') {
    std::fprintf(
        help ? stdout : stderr,
        "fuzz_parsers CORPUS [ROUNDS | --unpack FOLDER | --pack FOLDER]\n"
        "Exit codes: 0 every parser has returned from every input, 1 a parser has no corpus, 2 usage\n");
    return help ? 0 : 2;
  }
  const fs::path corpus = argv[1];
  const auto all = fuzz::parsers();
  if (argc == 4 && std::strcmp(argv[2], "--unpack") == 0) {
    for (std::size_t p = 0; p < all.size(); ++p) {
      const auto inputs = read_corpus(corpus / (std::string(all[p].name) + ".hex"));
      for (std::size_t k = 0; k < inputs.size(); ++k) {
        std::ofstream out(fs::path(argv[3]) / (std::string(all[p].name) + "_" + std::to_string(k)),
                          std::ios::binary);
        out.put(static_cast<char>(p));
        out.write(reinterpret_cast<const char*>(inputs[k].data()),
                  static_cast<std::streamsize>(inputs[k].size()));
      }
    }
    return 0;
  }
  if (argc == 4 && std::strcmp(argv[2], "--pack") == 0) {
    std::vector<std::vector<Bytes>> inputs(all.size());
    for (const auto& entry : fs::directory_iterator(argv[3])) {
      std::ifstream in(entry.path(), std::ios::binary);
      Bytes bytes((std::istreambuf_iterator<char>(in)), {});
      if (!bytes.empty()) inputs[bytes[0] % all.size()].emplace_back(bytes.begin() + 1, bytes.end());
    }
    for (std::size_t p = 0; p < all.size(); ++p)
      write_corpus(corpus / (std::string(all[p].name) + ".hex"), inputs[p]);
    return 0;
  }
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 200;
  std::mt19937 rng(1);
  bool complete = true;
  for (const auto& parser : all) {
    const auto inputs = read_corpus(corpus / (std::string(parser.name) + ".hex"));
    std::size_t fed = 0;
    for (const Bytes& input : inputs) {
      parser.feed(input);
      ++fed;
      for (int k = 0; k < rounds; ++k, ++fed) {
        Bytes bytes = input;
        damage(bytes, rng);
        parser.feed(bytes);
      }
    }
    std::printf("%-18s %5zu inputs, %8zu fed\n", parser.name, inputs.size(), fed);
    complete = complete && !inputs.empty();
  }
  if (!complete) std::printf("a parser has no corpus\n");
  return complete ? 0 : 1;
}
