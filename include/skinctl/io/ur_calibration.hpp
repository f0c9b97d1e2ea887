// SPDX-License-Identifier: BSD-3-Clause
// The factory calibration of a Universal Robot from its calibration.conf.
#pragma once

#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>

#include "skinctl/io/detail/from_chars.hpp"
#include "skinctl/model/dh.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

inline constexpr std::size_t ur_calibration_size_limit = std::size_t(1) << 20;

/// Parses the lines of a calibration.conf one by one; every error names the source and the line.
class UrCalibrationReader {
 public:
  explicit UrCalibrationReader(std::string_view source) : source_(source) {}

  [[nodiscard]] DhDelta<6> read(std::string_view text) {
    if (text.size() > ur_calibration_size_limit) fail(std::to_string(text.size()) + " bytes, allowed: 1 MiB");
    bool mounting = false;
    while (!text.empty()) {
      ++line_;
      const std::size_t end = text.find('\n');
      const std::string_view line =
          trimmed(text.substr(0, end).substr(0, text.substr(0, end).find_first_of("#;")));
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
      if (line.empty()) continue;
      if (line.front() == '[' && line.find('=') == std::string_view::npos) {
        if (line.back() != ']') fail("a section without its closing bracket");
        mounting = trimmed(line.substr(1, line.size() - 2)) == "mounting";
      } else if (mounting) {
        entry(line);
      }
    }
    line_ = 0;
    for (const Row& row : rows_)
      if (row.line == 0) fail(std::string("no ") + row.name + " in [mounting]");
    return delta_;
  }

 private:
  struct Row {
    const char* name;
    std::array<double, 6>* numbers;
    double largest;
    const char* range;
    int line = 0;  ///< line of the list
  };

  [[noreturn]] void fail(const std::string& what) const {
    refuse("skinctl: " + source_ + (line_ > 0 ? ":" + std::to_string(line_) : "") + ": " + what);
  }
  static std::string_view trimmed(std::string_view s) {
    const auto first = s.find_first_not_of(" \t\r"), last = s.find_last_not_of(" \t\r");
    return first == std::string_view::npos ? std::string_view() : s.substr(first, last - first + 1);
  }

  void entry(std::string_view line) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) fail("no \"key = value\"");
    const std::string_view key = trimmed(line.substr(0, equals)), value = trimmed(line.substr(equals + 1));
    if (key == "calibration_status" && value != "2")
      fail("calibration_status is not 2: this robot's calibration is not in use");
    for (Row& row : rows_)
      if (key == row.name) numbers(row, value);
  }
  void numbers(Row& row, std::string_view value) {
    const std::string name = row.name;
    if (row.line > 0) fail("a second " + name + ", the first is in line " + std::to_string(row.line));
    row.line = line_;
    if (value.size() < 2 || value.front() != '[' || value.back() != ']')
      fail(name + " is no list in brackets");
    value = value.substr(1, value.size() - 2);
    for (std::size_t i = 0; i < 6; ++i) {
      const std::size_t comma = value.find(',');
      if ((comma == std::string_view::npos) != (i == 5)) fail(name + " has not six numbers");
      const std::string_view item = trimmed(value.substr(0, comma));
      double& x = (*row.numbers)[i];
      const auto [end, error] = detail::from_chars(item.data(), item.data() + item.size(), x);
      if (error != std::errc() || end != item.data() + item.size() || item.empty())
        fail(name + ": number " + std::to_string(i + 1) + " is none");
      if (!(x >= -row.largest && x <= row.largest))
        fail(name + ": number " + std::to_string(i + 1) + " lies outside of " + row.range);
      if (comma != std::string_view::npos) value.remove_prefix(comma + 1);
    }
  }

  std::string source_;
  int line_ = 0;
  DhDelta<6> delta_;
  // Between parallel axes a calibration may put the common normal hundreds of metres away: see calibrated_dh.
  Row rows_[4] = {{"delta_theta", &delta_.theta, 6.3, "+-6.3 rad"},
                  {"delta_a", &delta_.a, 1, "+-1 m"},
                  {"delta_d", &delta_.d, 1e4, "+-10000 m"},
                  {"delta_alpha", &delta_.alpha, 0.1, "+-0.1 rad"}};
};

}  // namespace detail

/// Reads the text of a calibration.conf, as stored on the controller: in its section `[mounting]` the lists
/// `delta_theta`, `delta_a`, `delta_d`, `delta_alpha` of six numbers [rad, m]. Comments (`#`, `;`), other
/// keys and sections are skipped. For `calibrated_universal_robot`. `source` is its name in error texts.
///
/// Throws `ConfigurationError`, with source and line, for:
/// - a list that is missing, given twice, or not of six finite numbers;
/// - a number beyond any calibration (|theta| > 6.3 rad, |a| > 1 m, |d| > 10 km, |alpha| > 0.1 rad);
/// - a `calibration_status` other than 2 (linearised);
/// - a line in that section that is not `key = value`;
/// - more than 1 MiB.
[[nodiscard]] inline DhDelta<6> parse_ur_calibration(std::string_view text,
                                                     std::string_view source = "calibration.conf") {
  return detail::UrCalibrationReader(source).read(text);
}

/// Reads a file; see `parse_ur_calibration`. Also throws `ConfigurationError` for a file that cannot be read.
[[nodiscard]] inline DhDelta<6> read_ur_calibration(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  if (file) {
    text.resize(detail::ur_calibration_size_limit + 1);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(file.gcount() > 0 ? static_cast<std::size_t>(file.gcount()) : 0);
  }
  if (file.bad() || (!file.eof() && text.size() <= detail::ur_calibration_size_limit))
    refuse("skinctl: " + path + ": cannot be read");
  return parse_ur_calibration(text, path);
}

SKINCTL_END_NAMESPACE
