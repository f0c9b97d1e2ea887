// The door for libFuzzer, which looks for new inputs by coverage. FUZZ_PARSER=name keeps to one parser.
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "examples/fuzz/parsers.hpp"

namespace {

const fuzz::Parser* only = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* name = std::getenv("FUZZ_PARSER");
  if (name == nullptr) return 0;
  for (const auto& parser : fuzz::parsers())
    if (std::strcmp(parser.name, name) == 0) only = &parser;
  if (only == nullptr) {
    std::fprintf(stderr, "FUZZ_PARSER=%s: none of that name\n", name);
    std::exit(2);
  }
  return 0;
}
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // The first byte still chooses among all, so that inputs can be packed; those of other parsers are passed
  // over.
  if (size == 0 || (only != nullptr && &fuzz::parsers()[data[0] % fuzz::parsers().size()] != only)) return 0;
  fuzz::feed({data, size});
  return 0;
}
