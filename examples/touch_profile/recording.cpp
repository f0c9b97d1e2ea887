#include "examples/touch_profile/recording.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <istream>
#include <span>

#include "skinctl/core/contract.hpp"

namespace touch_profile {
namespace {

constexpr std::size_t most_slices = 100'000, longest_line = 4096;

/// Lines of a stream, never longer than asked for, with the place for error texts.
class Lines {
 public:
  Lines(std::istream& in, const std::string& name) : in_(in), name_(name) {}

  [[noreturn]] void refuse(const std::string& why) const {
    skinctl::refuse(name_ + ':' + std::to_string(number_) + ": " + why);
  }

  /// False at the end of the file.
  bool next() {
    line_.clear();
    ++number_;
    bool any = false;
    for (char c = 0; in_.get(c); any = true) {
      if (c == '\n') return true;
      if (line_.size() == longest_line) refuse("a line longer than 4096 characters");
      line_ += c;
    }
    if (in_.bad()) refuse("cannot be read");
    return any;
  }
  bool blank() const { return line_.find_first_not_of(" \t\r") == std::string::npos; }

  void numbers(std::span<double> out, double low, double high, const std::string& what) const {
    const char* at = line_.data();
    const char* const end = at + line_.size();
    const auto skip = [&] {
      while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    };
    for (std::size_t i = 0; i < out.size(); ++i) {
      skip();
      if (at == end)
        refuse(std::to_string(i) + " numbers instead of " + std::to_string(out.size()) + " (" + what + ')');
      const auto [rest, error] = std::from_chars(at, end, out[i]);
      const bool word_ends = rest == end || *rest == ' ' || *rest == '\t' || *rest == '\r';
      if (error != std::errc{} || !word_ends || !std::isfinite(out[i])) refuse("no number (" + what + ')');
      if (out[i] < low || out[i] > high) {
        char text[96];
        std::snprintf(text, sizeof text, "%.9g is outside %g to %g", out[i], low, high);
        refuse(std::string(text) + " (" + what + ')');
      }
      at = rest;
    }
    skip();
    if (at != end) refuse("more than " + std::to_string(out.size()) + " numbers (" + what + ')');
  }

 private:
  std::istream& in_;
  const std::string& name_;
  std::string line_;
  std::size_t number_ = 0;
};

}  // namespace

Recording read_recording(std::istream& in, const std::string& name) {
  Recording recording;
  recording.name = name;
  Lines lines(in, name);
  std::array<double, 1> mark{};
  if (!lines.next()) lines.refuse("the file is empty");
  lines.numbers(mark, -10000, -10000, "first line, -10000");

  const auto need = [&](std::size_t slice) {
    if (!lines.next()) lines.refuse("the file ends within slice " + std::to_string(slice));
  };
  while (lines.next()) {
    if (lines.blank()) {
      while (lines.next())
        if (!lines.blank()) lines.refuse("an empty line between slices");
      break;
    }
    if (recording.slices.size() == most_slices) lines.refuse("more than 100000 slices");
    const std::size_t number = recording.slices.size() + 1;
    Slice& slice = recording.slices.emplace_back();
    lines.numbers(slice.joints, -360, 360, "joint encoders");
    need(number);
    lines.numbers(slice.strongest, 0, 255, "strongest taxel of each finger");
    for (std::size_t f = 0; f < fingers.size(); ++f) {
      need(number);
      lines.numbers(std::span(slice.taxels).subspan(f * taxels_per_finger, taxels_per_finger), 0, 255,
                    std::string("taxels of ") + fingers[f]);
    }
  }
  if (recording.slices.empty()) lines.refuse("no time slice");
  return recording;
}

Recording read_recording_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) skinctl::refuse(path + ": cannot be opened");
  return read_recording(in, path);
}

}  // namespace touch_profile
