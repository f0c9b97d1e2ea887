#include "examples/simulated_ur5/script.hpp"

#include <algorithm>
#include <string_view>

#include "examples/simulated_ur5/urscript/token.hpp"

namespace simulated_ur5 {
namespace {

using urscript::Token;

/// By how many blocks a line goes deeper.
int depth_change(std::string_view line) {
  int change = 0;
  for (const Token& t : urscript::tokens_of(line)) {
    if (t.kind != Token::Kind::name) continue;
    if (t.text == "def" || t.text == "sec" || t.text == "thread" || t.text == "if" || t.text == "while")
      ++change;
    if (t.text == "end") --change;
  }
  return change;
}

}  // namespace

bool ScriptReader::feed(std::span<const std::uint8_t> bytes, std::vector<std::string>& programs) {
  for (const std::uint8_t b : bytes) {
    if (b == 0 || b == '\r') continue;
    if (text_.size() >= longest_program) return false;
    text_.push_back(static_cast<char>(b));
    if (b == '\n' && !take_line(programs)) return false;
  }
  return true;
}

bool ScriptReader::take_line(std::vector<std::string>& programs) {
  const std::string_view line = std::string_view(text_).substr(line_);
  depth_ = std::max(0, depth_ + depth_change(line));
  line_ = text_.size();
  if (depth_ > 1'000'000) return false;
  if (depth_ > 0) return true;
  const auto tokens = urscript::tokens_of(text_);
  const bool any = std::any_of(tokens.begin(), tokens.end(), [](const Token& t) {
    return t.kind != Token::Kind::line_end && t.kind != Token::Kind::end;
  });
  if (any) programs.push_back(std::move(text_));
  text_.clear();
  line_ = 0;
  return true;
}

}  // namespace simulated_ur5
