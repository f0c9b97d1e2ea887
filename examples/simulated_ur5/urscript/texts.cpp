// Functions of strings, and what a program tells people.
#include <algorithm>

#include "examples/simulated_ur5/urscript/builtin.hpp"
#include "examples/support/text.hpp"

namespace simulated_ur5::urscript {
namespace {

Outcome give_text(Call& c, std::string s) {
  if (s.size() > longest_string) return c.fail("runtime_error_string_too_long");
  return c.give(Value(std::move(s)));
}

Outcome concatenate(Call& c) {
  return give_text(c, c[0].text() + c[1].text());
}
Outcome sub(Call& c) {
  const std::string s = c.text(0);
  const double from = c.number(1, 0), count = c.number(2, 1e9);
  if (!(from >= 0 && from <= static_cast<double>(s.size())) || !(count >= 0))
    return c.fail("runtime_error_index");
  return give_text(c, s.substr(static_cast<std::size_t>(from),
                               static_cast<std::size_t>(std::min(count, static_cast<double>(s.size())))));
}
Outcome at(Call& c) {
  const std::string s = c.text(0);
  const double i = c.number(1, -1);
  if (!(i >= 0 && i < static_cast<double>(s.size()))) return c.fail("runtime_error_index");
  return give_text(c, s.substr(static_cast<std::size_t>(i), 1));
}
Outcome find(Call& c) {
  const std::string s = c.text(0);
  const auto from = static_cast<std::size_t>(std::clamp(c.number(2, 0), 0.0, static_cast<double>(s.size())));
  const auto found = s.find(c.text(1), from);
  return c.give(found == std::string::npos ? std::int64_t{-1} : static_cast<std::int64_t>(found));
}
Outcome to_number(Call& c) {
  const std::string s = c[0].text();
  std::string_view rest = s;
  double x = 0;
  if (!examples::take_number(rest, x)) return c.fail("runtime_error_type:number");
  const bool whole = s.find_first_of(".eE") == std::string::npos && std::abs(x) < 9e15;
  return c.give(whole ? Value(static_cast<std::int64_t>(x)) : Value(x));
}

Outcome message(Call& c) {
  c.robot.tell(
      {Notice::Kind::text, (c[0].text() + (c[1].empty() ? std::string() : c[1].text())).substr(0, 1024)});
  return Outcome::done;
}
/// A blocking popup halts nobody here: there is no one to press its button.
Outcome popup(Call& c) {
  Notice n{Notice::Kind::popup, c[0].text().substr(0, 1024), c.text(1, "Popup").substr(0, 255)};
  n.warning = c[2].truth();
  n.error = c[3].truth();
  n.blocking = c[4].truth();
  c.robot.tell(n);
  return Outcome::done;
}

constexpr Builtin text_table[] = {
    {"textmsg", "s1 s2", message},
    {"popup", "s title warning error blocking", popup},
    {"to_str", "val", [](Call& c) { return give_text(c, c[0].text()); }},
    {"to_num", "str", to_number},
    {"str_cat", "op1 op2", concatenate},
    {"str_len", "str", [](Call& c) { return c.give(static_cast<std::int64_t>(c.text(0).size())); }},
    {"str_empty", "str", [](Call& c) { return c.give(c.text(0).empty()); }},
    {"str_at", "src index", at},
    {"str_sub", "src index len", sub},
    {"str_find", "src target start_from", find},
};

}  // namespace

std::span<const Builtin> text_functions() {
  return text_table;
}

}  // namespace simulated_ur5::urscript
