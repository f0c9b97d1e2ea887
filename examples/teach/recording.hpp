// A demonstration as a file of text: what the hand did and felt, and where things were seen.
#pragma once

#include <map>
#include <string>

#include "skinctl/semantics/learn.hpp"

namespace teach {

/// The words for classes of things.
struct Classes {
  std::map<skinctl::ObjectClass, std::string> names;
  std::uint64_t containers = 0;  ///< bit k: things of class k are landmarks to put to
  [[nodiscard]] std::string name(skinctl::ObjectClass kind) const;
};
struct Recording {
  Classes classes;
  skinctl::Demonstration<> shown;
};

/// Writes it: lines `thing CLASS NAME [container]`, `hand TIME X Y Z RX RY RZ FORCE OPENING`, `seen TIME
/// THING X Y Z RX RY RZ`; seconds, metres, rotation vectors, newtons; OPENING -1: not measured.
void write(const Recording& recording, const std::string& file);
/// Reads it. Throws `std::runtime_error` with the number of the line that is wrong; at most 64 things and a
/// million lines.
[[nodiscard]] Recording read(const std::string& file);

}  // namespace teach
