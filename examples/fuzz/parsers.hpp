// Every parser of bytes from outside, behind one door.
#pragma once

#include <cstdint>
#include <span>

namespace fuzz {

struct Parser {
  const char* name;
  void (*feed)(std::span<const std::uint8_t> bytes);  ///< whatever the bytes: it returns
};

/// All of them; the same order for good, as the first byte of an input chooses one.
std::span<const Parser> parsers();

/// Feeds all but the first byte to the parser that the first byte chooses.
void feed(std::span<const std::uint8_t> input);

}  // namespace fuzz
