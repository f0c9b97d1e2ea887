// A demonstration as a file of text: what the hand did and felt, where the things were, what the person meant.
#pragma once

#include <string>
#include <vector>

#include "examples/worlds/recognition.hpp"

namespace recognise {

using skinctl::Activity;
using skinctl::testing::LedRun;

/// One line of a recording.
struct Line {
  double time = 0;                        ///< [s]
  skinctl::Xyz<double> p{0.0, 0.0, 0.0};  ///< of the hand [m]
  double force = 0;                       ///< [N]
  Activity meant = Activity::unknown;     ///< by intent, if it is known
  Activity defined = Activity::unknown;   ///< by definition, if it is known
};
/// A thing was seen.
struct Seen {
  double time = 0;  ///< of the picture [s]
  std::uint8_t thing = 0;
  skinctl::Xyz<double> p{0.0, 0.0, 0.0};  ///< [m]
};
/// All of it.
struct Recording {
  std::vector<skinctl::ObjectClass> kinds;
  std::vector<Line> lines;
  std::vector<Seen> seen;  ///< in the order of their times
};

/// A recording as a simulated person makes it: 250 Hz, noise of 0.2 mm and 0.1 N, tremor, pictures at 30 Hz.
[[nodiscard]] Recording record(const LedRun& run, std::uint64_t seed);

/// Writes it: lines `thing KIND`, `hand TIME X Y Z FORCE MEANT DEFINED`, `seen TIME THING X Y Z`.
void write(const Recording& recording, const std::string& file);
/// Reads it. Throws `std::runtime_error` with the number of the line that is wrong; at most 6 things and 10 million lines.
[[nodiscard]] Recording read(const std::string& file);

}  // namespace recognise
