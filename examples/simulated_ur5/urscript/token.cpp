#include "examples/simulated_ur5/urscript/token.hpp"

#include <algorithm>
#include <cctype>

namespace simulated_ur5::urscript {
namespace {

bool starts_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}
bool in_name(char c) {
  return starts_name(c) || digit(c);
}

/// Where the number that begins at `i` ends, and whether it is a float.
std::size_t number_end(std::string_view s, std::size_t i, bool& real) {
  const auto digits = [&] {
    while (i < s.size() && digit(s[i])) ++i;
  };
  digits();
  if (i < s.size() && s[i] == '.') {
    real = true;
    ++i;
    digits();
  }
  if (i < s.size() && (s[i] == 'e' || s[i] == 'E')) {
    std::size_t exponent = i + 1;
    if (exponent < s.size() && (s[exponent] == '+' || s[exponent] == '-')) ++exponent;
    if (exponent < s.size() && digit(s[exponent])) {
      real = true;
      i = exponent;
      digits();
    }
  }
  return i;
}

}  // namespace

std::vector<Token> tokens_of(std::string_view s) {
  constexpr std::string_view pairs[] = {"==", "!=", "<=", ">="};
  std::vector<Token> out;
  int line = 1, open = 0;
  std::size_t line_start = 0, i = 0;
  const auto add = [&](Token::Kind kind, std::size_t begin, std::size_t end) {
    out.push_back({kind, s.substr(begin, end - begin), {line, static_cast<int>(begin - line_start) + 1}});
    i = end;
  };
  while (i < s.size()) {
    const char c = s[i];
    if (c == '\n') {
      if (open <= 0) add(Token::Kind::line_end, i, i + 1);
      i = (i < s.size() && s[i] == '\n') ? i + 1 : i;
      ++line;
      line_start = i;
    } else if (c == '#') {
      i = std::min(s.find('\n', i), s.size());
    } else if (c == '"' || c == '\'') {
      std::size_t end = i + 1;
      while (end < s.size() && s[end] != c && s[end] != '\n') ++end;
      const std::size_t behind = end < s.size() && s[end] == c ? end + 1 : end;
      add(Token::Kind::text, i + 1, end);
      i = behind;
    } else if (starts_name(c)) {
      std::size_t end = i;
      while (end < s.size() && in_name(s[end])) ++end;
      add(Token::Kind::name, i, end);
    } else if (digit(c) || (c == '.' && i + 1 < s.size() && digit(s[i + 1]))) {
      bool real = false;
      const std::size_t end = number_end(s, i, real);
      add(real ? Token::Kind::real : Token::Kind::whole, i, end);
    } else if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      ++i;
    } else {
      if (c == '(' || c == '[') ++open;
      if (c == ')' || c == ']') --open;
      const bool two = std::find(std::begin(pairs), std::end(pairs), s.substr(i, 2)) != std::end(pairs);
      add(Token::Kind::sign, i, i + (two ? 2 : 1));
    }
  }
  out.push_back({Token::Kind::end, {}, {line, static_cast<int>(s.size() - line_start) + 1}});
  return out;
}

}  // namespace simulated_ur5::urscript
