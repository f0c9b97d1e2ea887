#include "examples/adapters/rsi/messages.hpp"

#include <charconv>
#include <cmath>

namespace adapters::rsi {
namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}
bool same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (lower(a[i]) != lower(b[i])) return false;
  return true;
}
bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}
std::string_view left_trimmed(std::string_view s) {
  while (!s.empty() && (is_space(s.front()) || s.front() == '\0')) s.remove_prefix(1);
  return s;
}
std::string_view trimmed(std::string_view s) {
  s = left_trimmed(s);
  while (!s.empty() && (is_space(s.back()) || s.back() == '\0')) s.remove_suffix(1);
  return s;
}
bool is_name(std::string_view s) {
  for (const char c : s)
    if (!((lower(c) >= 'a' && lower(c) <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-'))
      return false;
  return !s.empty() && ((lower(s[0]) >= 'a' && lower(s[0]) <= 'z') || s[0] == '_');
}

/// XML without comments, entities and sections: elements, attributes, text.
class Scanner {
 public:
  explicit Scanner(std::string_view xml) : left_(trimmed(xml)) {}

  /// Calls `f(element, attribute, value)`, for text with an empty attribute; false for what is no such XML,
  /// or if `f` says so.
  template <class F>
  bool each(std::string_view root, F&& f) {
    if (left_.size() > longest) return false;
    if (left_.starts_with("<?")) {
      const auto end = left_.find("?>");
      if (end == left_.npos) return false;
      left_ = trimmed(left_.substr(end + 2));
    }
    std::array<std::string_view, 4> open{};
    std::size_t depth = 0;
    do {
      const auto begin = left_.find('<');
      if (begin == left_.npos) return false;
      const auto text = trimmed(left_.substr(0, begin));
      if (!text.empty() && (depth == 0 || !f(open[depth - 1], std::string_view(), text))) return false;
      const auto end = left_.find('>', begin);
      if (end == left_.npos) return false;
      auto tag = left_.substr(begin + 1, end - begin - 1);
      left_.remove_prefix(end + 1);
      if (tag.starts_with('/')) {
        if (depth == 0 || !same(trimmed(tag.substr(1)), open[--depth])) return false;
        continue;
      }
      const bool closed = tag.ends_with('/');
      if (closed) tag.remove_suffix(1);
      const auto name = take_name(tag);
      if (!is_name(name) || (depth == 0 && !same(name, root)) || !attributes(name, tag, f)) return false;
      if (closed) continue;
      if (depth == open.size()) return false;
      open[depth++] = name;
    } while (depth > 0);
    return trimmed(left_).empty();
  }

 private:
  static std::string_view take_name(std::string_view& tag) {
    std::size_t n = 0;
    while (n < tag.size() && !is_space(tag[n]) && tag[n] != '=') ++n;
    const auto name = tag.substr(0, n);
    tag.remove_prefix(n);
    return name;
  }
  template <class F>
  static bool attributes(std::string_view element, std::string_view tag, F& f) {
    std::array<std::string_view, 16> names{};
    std::size_t n = 0;
    for (; !trimmed(tag).empty();) {
      if (!is_space(tag[0]) || n == names.size()) return false;
      tag = left_trimmed(tag);
      const auto name = take_name(tag);
      for (std::size_t i = 0; i < n; ++i)
        if (names[i] == name) return false;
      names[n++] = name;
      tag = left_trimmed(tag);
      if (!is_name(name) || !tag.starts_with('=')) return false;
      tag = left_trimmed(tag.substr(1));
      if (tag.empty() || (tag[0] != '"' && tag[0] != '\'')) return false;
      const auto end = tag.find(tag[0], 1);
      if (end == tag.npos || !f(element, name, tag.substr(1, end - 1))) return false;
      tag.remove_prefix(end + 1);
    }
    return true;
  }
  std::string_view left_;
};

template <class N>
bool whole(std::string_view s, N& out) {
  s = trimmed(s);
  const auto [end, error] = std::from_chars(s.data(), s.data() + s.size(), out);
  return error == std::errc() && end == s.data() + s.size();
}
bool number(std::string_view s, double& out) {
  return whole(s, out) && std::abs(out) <= 1e6;
}
/// Index of `letters[i]`, or of A1 to A6 where there are none; 6: none of them.
std::size_t index_of(std::string_view name, std::string_view letters) {
  if (letters.empty())
    return name.size() == 2 && lower(name[0]) == 'a' && name[1] >= '1' && name[1] <= '6'
               ? static_cast<std::size_t>(name[1] - '1')
               : 6;
  for (std::size_t i = 0; i < 6; ++i)
    if (name.size() == 1 && lower(name[0]) == letters[i]) return i;
  return 6;
}
/// Takes one of six numbers; `seen` has a bit for each.
bool take(std::string_view name, std::string_view value, std::string_view letters, std::array<double, 6>& out,
          unsigned& seen) {
  const auto i = index_of(name, letters);
  if (i == 6) return true;
  if (((seen >> i) & 1u) != 0) return false;
  seen |= 1u << i;
  return number(value, out[i]);
}
constexpr unsigned all_six = 0x3f;

/// Appends; once there was no room, nothing more.
class Printer {
 public:
  explicit Printer(std::span<char> to) : to_(to) {}
  Printer& operator<<(std::string_view s) {
    fits_ = fits_ && to_.size() - size_ >= s.size();
    if (fits_) size_ += s.copy(to_.data() + size_, s.size());
    return *this;
  }
  Printer& operator<<(double x) {
    char text[32];
    const auto end =
        std::to_chars(text, text + sizeof text, std::abs(x) <= 1e6 ? x : 0, std::chars_format::fixed, 6);
    return *this << std::string_view(text, static_cast<std::size_t>(end.ptr - text));
  }
  Printer& operator<<(std::uint64_t x) {
    char text[24];
    const auto end = std::to_chars(text, text + sizeof text, x);
    return *this << std::string_view(text, static_cast<std::size_t>(end.ptr - text));
  }
  Printer& six(std::string_view element, std::array<std::string_view, 6> names,
               const std::array<double, 6>& x) {
    *this << "<" << element;
    for (std::size_t i = 0; i < 6; ++i) *this << " " << names[i] << "=\"" << x[i] << "\"";
    return *this << "/>";
  }
  [[nodiscard]] std::size_t size() const { return fits_ ? size_ : 0; }

 private:
  std::span<char> to_;
  std::size_t size_ = 0;
  bool fits_ = true;
};
constexpr std::array<std::string_view, 6> axes{"A1", "A2", "A3", "A4", "A5", "A6"};
constexpr std::array<std::string_view, 6> frame{"X", "Y", "Z", "A", "B", "C"};

}  // namespace

bool parse(std::string_view xml, Rob& out) noexcept {
  out = {};
  unsigned actual = 0, setpoint = 0, wrench = 0;
  bool ipoc = false;
  const bool read = Scanner(xml).each("Rob", [&](auto element, auto name, auto value) {
    if (same(element, "AIPos")) return take(name, value, {}, out.actual, actual);
    if (same(element, "ASPos")) return take(name, value, {}, out.setpoint, setpoint);
    if (same(element, "FT")) return take(name, value, "xyzabc", out.wrench, wrench);
    if (same(element, "Delay") && same(name, "D")) return out.has_late = whole(value, out.late);
    if (same(element, "IPOC") && name.empty()) return ipoc = whole(value, out.ipoc);
    return true;
  });
  while (out.axes < 6 && ((actual >> out.axes) & 1u) != 0) ++out.axes;
  out.has_setpoint = setpoint == all_six;
  out.has_wrench = wrench == all_six;
  return read && ipoc && out.axes > 0;
}

bool parse(std::string_view xml, Sen& out) noexcept {
  out = {};
  unsigned seen = 0;
  bool ipoc = false;
  const bool read = Scanner(xml).each("Sen", [&](auto element, auto name, auto value) {
    if (same(element, "AK")) return take(name, value, {}, out.correction, seen);
    if (same(element, "Stop")) {
      out.stop = trimmed(value) == "1";
      return out.stop || trimmed(value) == "0";
    }
    if (same(element, "IPOC") && name.empty()) return ipoc = whole(value, out.ipoc);
    return true;
  });
  return read && ipoc && seen == all_six;
}

std::size_t print(const Rob& rob, std::span<char> to) noexcept {
  Printer p(to);
  p << "<Rob Type=\"KUKA\">";
  p.six("RIst", frame, {}).six("RSol", frame, {}).six("AIPos", axes, rob.actual);
  if (rob.has_setpoint) p.six("ASPos", axes, rob.setpoint);
  if (rob.has_wrench) p.six("FT", frame, rob.wrench);
  p << "<Delay D=\"" << std::uint64_t{rob.late} << "\"/><IPOC>" << rob.ipoc << "</IPOC></Rob>";
  return p.size();
}

std::size_t print(const Sen& sen, std::string_view type, std::span<char> to) noexcept {
  Printer p(to);
  p << "<Sen Type=\"" << type << "\"><Stop>" << std::uint64_t{sen.stop} << "</Stop>";
  p.six("AK", axes, sen.correction) << "<IPOC>" << sen.ipoc << "</IPOC></Sen>";
  return p.size();
}

}  // namespace adapters::rsi
