// Recordings of the iCub grasp dataset: a hand's joints and 60 taxels, slice by slice.
#pragma once

#include <array>
#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace touch_profile {

inline constexpr std::size_t taxels_per_finger = 12;
inline constexpr std::array<const char*, 5> fingers{"thumb", "index", "middle", "ring", "little"};
inline constexpr std::size_t taxel_count = taxels_per_finger * fingers.size();

/// One time slice.
struct Slice {
  std::array<double, 9> joints{};     ///< encoders 7 to 15 of the hand [deg]
  std::array<double, 5> strongest{};  ///< per finger, 255 - reading as the recorder noted it
  std::array<double, taxel_count>
      taxels{};  ///< readings 0 to 255, finger by finger; 255 = untouched, falls when pressed
};

struct Recording {
  std::string name;
  std::vector<Slice> slices;
};

/// Reads the dataset's text: a line with -10000, then seven lines a slice with 9, 5 and five times 12
/// numbers.
///
/// Throws `skinctl::ConfigurationError` with name and line when a line has too few or too many numbers, a
/// number is none or outside its range (taxels 0 to 255, joints +-360 deg), the file ends within a slice, has
/// no slice, or more than 100000.
Recording read_recording(std::istream& in, const std::string& name);

/// The same from a file; throws also when it cannot be opened.
Recording read_recording_file(const std::string& path);

}  // namespace touch_profile
