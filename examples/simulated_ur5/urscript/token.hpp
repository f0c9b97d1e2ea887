// URScript text as tokens.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace simulated_ur5::urscript {

/// Line and column in the text, counted from 1.
struct Place {
  int line = 1, column = 1;
};

/// Why a program cannot go on.
struct Problem {
  Place at;
  std::string text;
};

struct Token {
  enum class Kind { name, whole, real, text, sign, line_end, end };
  Kind kind = Kind::end;
  std::string_view text;
  Place at;

  /// For error texts.
  std::string words() const {
    if (kind == Kind::end) return "end_of_program";
    return kind == Kind::line_end ? "end_of_line" : std::string(text.substr(0, 60));
  }
  bool is(std::string_view s) const { return (kind == Kind::name || kind == Kind::sign) && text == s; }
};

/// All tokens of `text`, which must outlive them; the last one is `end`. Comments vanish, and so do the line
/// ends within brackets.
std::vector<Token> tokens_of(std::string_view text);

}  // namespace simulated_ur5::urscript
