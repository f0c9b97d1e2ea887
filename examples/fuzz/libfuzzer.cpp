// The door for libFuzzer, which looks for new inputs by coverage.
#include <cstddef>

#include "examples/fuzz/parsers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::feed({data, size});
  return 0;
}
