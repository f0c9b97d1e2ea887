// Tables with a heading, one row a line, words between commas, in quotes where a word holds one.
#pragma once

#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace trade {

/// The words of a line; `""` in quotes is a quote.
[[nodiscard]] inline std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> out(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && inside && i + 1 < line.size() && line[i + 1] == '"')
      out.back() += line[++i];
    else if (c == '"')
      inside = !inside;
    else if (c == ',' && !inside)
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

/// Calls `each(words, place)` for each row of a file with this heading, `place` its file and line. Throws
/// `std::runtime_error` with its place where it is no such file: `what` it should be, or a row with another
/// number of words.
template <class Each>
void read_table(const std::string& file, const std::string& heading, const std::string& what, Each&& each) {
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || line != heading)
    throw std::runtime_error(file + ":1: not a file of " + what);
  const std::size_t columns = split(heading).size();
  for (std::size_t at = 2; std::getline(in, line); ++at) {
    const std::string place = file + ":" + std::to_string(at);
    const auto words = split(line);
    if (words.size() != columns)
      throw std::runtime_error(place + ": " + std::to_string(columns) + " columns expected");
    each(words, place);
  }
}

/// The number that a word is, `otherwise` if it is empty. Throws `std::runtime_error` for a word that is
/// none.
[[nodiscard]] inline double number_in(const std::string& word, double otherwise, const std::string& place) {
  if (word.empty()) return otherwise;
  char* end = nullptr;
  const double x = std::strtod(word.c_str(), &end);
  if (*end != 0) throw std::runtime_error(place + ": no number: " + word);
  return x;
}

}  // namespace trade
