// A skin as characters: what its cells read now.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "examples/show_skin/unrolled.hpp"
#include "skinctl/sensing/cell_sample.hpp"

namespace show_skin {

struct ScreenSettings {
  int width = 100;      ///< [characters]
  bool colours = true;  ///< orange for force, blue for proximity
  double full = 0.5;    ///< reading of a force sensor shown as 9
  double rest = 0.02;   ///< readings below it are shown as nothing
  double near = 0.05;   ///< proximity from which a cell is shown as near
  skinctl::Nanoseconds silent = std::chrono::milliseconds(500);  ///< after so long a cell is shown as silent
};

/// `.` at rest, `1` to `9` pressed, `o` near something, `x` silent, `?` never heard.
class Screen {
 public:
  Screen(const skinctl::SkinFile& file, const ScreenSettings& settings);

  void hear(std::span<const skinctl::CellSample> samples);
  /// The whole picture, line by line; `status` is its first line.
  [[nodiscard]] std::string draw(skinctl::Nanoseconds now, const std::string& status) const;
  /// Samples of cells that the file does not have.
  [[nodiscard]] std::uint64_t unknown() const noexcept { return unknown_; }
  [[nodiscard]] std::size_t heard(skinctl::Nanoseconds now) const;
  [[nodiscard]] std::size_t cells() const noexcept { return cells_.size(); }

 private:
  struct Cell {
    bool heard = false;
    skinctl::Nanoseconds time{};
    float force = 0, proximity = 0;
  };
  struct Patch {
    std::string title;
    Layout layout;
    std::size_t first = 0;
  };
  [[nodiscard]] char symbol(const Cell& cell, skinctl::Nanoseconds now) const;

  ScreenSettings settings_;
  std::vector<Patch> patches_;
  std::vector<Cell> cells_;
  std::map<std::uint32_t, std::size_t> index_;
  std::uint64_t unknown_ = 0;
};

}  // namespace show_skin
