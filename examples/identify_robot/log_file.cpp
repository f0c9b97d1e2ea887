#include "examples/identify_robot/log_file.hpp"

#include <charconv>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "skinctl/core/contract.hpp"
#include "skinctl/io/formatted.hpp"

namespace identify_robot {
namespace {

[[noreturn]] void refuse(const std::string& file, std::size_t line, const char* what) {
  throw skinctl::ConfigurationError(file + ":" + std::to_string(line) + ": " + what);
}

bool take_number(std::string_view& rest, double& x) {
  if (rest.empty() || rest.front() != ',') return false;
  rest.remove_prefix(1);
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), x);
  if (error != std::errc{}) return false;
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return std::isfinite(x);
}

}  // namespace

Log read_log(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw skinctl::ConfigurationError(file + ": cannot be read");
  Log log;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    std::string_view rest = line;
    const bool sent = rest.starts_with("sent,");
    if (!sent && !rest.starts_with("measured,")) refuse(file, number, "neither `sent,` nor `measured,`");
    rest.remove_prefix(sent ? 4 : 8);
    Log::Entry entry;
    bool good = take_number(rest, entry.time);
    for (double& q : entry.q) good = good && take_number(rest, q);
    if (!good || !rest.empty()) refuse(file, number, "not a time [s] and six angles [rad]");
    auto& entries = sent ? log.sent : log.measured;
    if (entries.size() >= 10'000'000) refuse(file, number, "more than ten million entries");
    entries.push_back(entry);
  }
  return log;
}

void write_log(const std::string& file, const Log& log) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (out == nullptr) throw skinctl::ConfigurationError(file + ": cannot be written");
  std::fputs("# time [s], six angles [rad]\n", out);
  const auto write = [&](const char* what, const auto& entries) {
    for (const auto& e : entries) {
      std::fputs(skinctl::formatted("%s,%.9f", what, e.time).c_str(), out);
      for (const double q : e.q) std::fputs(skinctl::formatted(",%.9f", q).c_str(), out);
      std::fputc('\n', out);
    }
  };
  write("sent", log.sent);
  write("measured", log.measured);
  const bool failed = std::ferror(out) != 0;
  if (std::fclose(out) != 0 || failed) throw skinctl::ConfigurationError(file + ": cannot be written");
}

}  // namespace identify_robot
