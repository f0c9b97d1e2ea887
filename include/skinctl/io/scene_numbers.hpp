// SPDX-License-Identifier: BSD-3-Clause
// Numbers of a scene from a text file: gains, limits, cells that change without a compiler.
#pragma once

#include <algorithm>
#include <concepts>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/io/detail/from_chars.hpp"
#include "skinctl/io/detail/read_text.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Lines `name = number number ...`; what follows a `#` is a comment. A program asks by `set` for each number
/// that it lets a file change, and in the end by `finish` whether the file holds others: a name that nobody
/// asked for is a mistake in writing.
///
///     auto numbers = SceneNumbers::of_file("scene.txt");
///     CellGains gains{.force = 20};
///     numbers.set("skin.force", gains.force);
///     numbers.finish();
class SceneNumbers {
 public:
  /// Reads text; `source` is its name in error texts. Throws `ConfigurationError`, with source, line and
  /// name, for a line without `=`, a name that is empty or stands twice, and what is no finite number.
  explicit SceneNumbers(std::string_view text, std::string source = "numbers") : source_(std::move(source)) {
    int line = 0;
    while (!text.empty()) {
      const std::string_view whole = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(whole.size() + 1, text.size()));
      read(++line, trimmed(whole.substr(0, whole.find('#'))));
    }
  }
  /// Reads a file. Also throws `ConfigurationError` for one that cannot be read.
  [[nodiscard]] static SceneNumbers of_file(const std::string& path) {
    return SceneNumbers(detail::read_text(path), path);
  }

  /// Changes `value` if the file has the name. Throws `ConfigurationError` if it has not one number.
  template <std::floating_point T>
  void set(const std::string& name, T& value) {
    if (const Entry* e = take(name, 1)) value = number<T>(name, *e, 0);
  }
  /// Changes a duration if the file has the name; the file's number is in milliseconds.
  void set(const std::string& name, Nanoseconds& value) {
    const Entry* e = take(name, 1);
    if (e == nullptr) return;
    if (!(e->values[0] > -1e9 && e->values[0] < 1e9)) fail(e->line, name + ": allowed: less than 1e9 ms");
    value = Nanoseconds(static_cast<std::int64_t>(e->values[0] * 1e6 + (e->values[0] < 0 ? -0.5 : 0.5)));
  }
  /// Changes the first `count` numbers of an array or vector if the file has the name, with as many numbers
  /// or one for all.
  template <class V>
  void set(const std::string& name, V& values, std::size_t count) {
    const Entry* e = take(name, count);
    for (std::size_t i = 0; e != nullptr && i < count; ++i)
      values[i] = number<std::remove_cvref_t<decltype(values[i])>>(name, *e, e->values.size() > 1 ? i : 0);
  }
  /// Throws `ConfigurationError` naming the first name that nobody asked for.
  void finish() const {
    for (const auto& [name, entry] : entries_)
      if (!entry.taken) fail(entry.line, name + ": no number of this scene");
  }

 private:
  struct Entry {
    int line = 0;
    std::vector<double> values{};
    bool taken = false;
  };

  [[noreturn]] void fail(int line, const std::string& what) const {
    refuse("skinctl: " + source_ + ":" + std::to_string(line) + ": " + what);
  }
  static std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
  }
  void read(int line, std::string_view text) {
    if (text.empty()) return;
    const std::size_t equals = text.find('=');
    const std::string name(trimmed(text.substr(0, equals)));
    if (equals == std::string_view::npos || name.empty()) fail(line, "name = number expected");
    if (entries_.contains(name))
      fail(line, name + ": it stands in line " + std::to_string(entries_[name].line));
    Entry& entry = entries_[name];
    entry.line = line;
    for (text = trimmed(text.substr(equals + 1)); !text.empty(); text = trimmed(text)) {
      const std::string word(text.substr(0, text.find_first_of(" \t\r")));
      double value = 0;
      const auto result = detail::from_chars(word.data(), word.data() + word.size(), value);
      if (result.ec != std::errc() || result.ptr != word.data() + word.size() || value - value != 0)
        fail(line, name + ": \"" + word + "\" is no finite number");
      entry.values.push_back(value);
      text.remove_prefix(word.size());
    }
    if (entry.values.empty()) fail(line, name + ": a number is missing");
  }
  const Entry* take(const std::string& name, std::size_t count) {
    const auto found = entries_.find(name);
    if (found == entries_.end()) return nullptr;
    found->second.taken = true;
    const std::size_t there = found->second.values.size();
    if (there != 1 && there != count)
      fail(found->second.line,
           name + ": " + std::to_string(there) + " numbers, expected: " + std::to_string(count));
    return &found->second;
  }
  template <class T>
  T number(const std::string& name, const Entry& e, std::size_t i) const {
    const auto value = static_cast<T>(e.values[i]);
    if (value - value != 0) fail(e.line, name + ": too large for a float");
    return value;
  }

  std::string source_;
  std::map<std::string, Entry> entries_;
};

SKINCTL_END_NAMESPACE
