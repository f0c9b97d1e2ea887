// Uploaded text, cut into programs.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace simulated_ur5 {

/// Cuts uploaded text into programs: a `def` or `sec` block up to its `end`, or a single line outside of
/// blocks.
class ScriptReader {
 public:
  static constexpr std::size_t longest_program = 256 * 1024;

  /// Takes text and appends the programs that it completes to `programs`. False: a program was longer than
  /// `longest_program`; the reader is then of no further use.
  bool feed(std::span<const std::uint8_t> bytes, std::vector<std::string>& programs);
  /// A block or a line is under way.
  bool unfinished() const { return !text_.empty(); }

 private:
  bool take_line(std::vector<std::string>& programs);

  std::string text_;      ///< of the block under way
  std::size_t line_ = 0;  ///< where the line under way begins
  int depth_ = 0;
};

}  // namespace simulated_ur5
