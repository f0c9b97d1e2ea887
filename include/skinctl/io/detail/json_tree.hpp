// SPDX-License-Identifier: BSD-3-Clause
// JSON as a tree that remembers its lines. Needs nlohmann-json.
#pragma once

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A value of a JSON text, and the line in which it begins.
struct JsonValue {
  enum class Kind { null, boolean, number, text, list, table };
  Kind kind = Kind::null;
  int line = 0;
  double number = 0;
  std::string text;
  std::vector<std::string> keys;  ///< keys of a table, one for each of `items`
  std::vector<JsonValue> items;   ///< values of a list or a table

  [[nodiscard]] const char* what() const {
    static constexpr const char* names[] = {"null",   "true or false", "a number",
                                            "a text", "a list",        "a table"};
    return names[static_cast<int>(kind)];
  }
  [[nodiscard]] const JsonValue* find(std::string_view key) const {
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] == key) return &items[i];
    return nullptr;
  }
};

/// A text as a range of characters that counts its lines.
class LineIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineIterator(const char* at, int* line) : at_(at), line_(line) {}
  reference operator*() const { return *at_; }
  LineIterator& operator++() {
    if (*at_ == '\n') ++*line_;
    ++at_;
    return *this;
  }
  LineIterator operator++(int) {
    LineIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const LineIterator& a, const LineIterator& b) { return a.at_ == b.at_; }

 private:
  const char* at_;
  int* line_;
};

/// Builds the tree of a JSON text, at most `max_depth` deep. `finished(path, item)` sees each table that is
/// an item of a list as soon as it ends; true: it is used, and leaves the tree. `path` are the keys above it.
class JsonTree {
 public:
  using Finished = std::function<bool(const std::vector<std::string>& path, const JsonValue& item,
                                      const JsonValue& owner)>;
  static constexpr std::size_t max_depth = 8, longest_text = 1024, max_keys = 64;
  static constexpr std::size_t max_values = std::size_t(1) << 21;  ///< largest number in the tree at any time

  JsonTree(std::string_view text, std::string source, Finished finished)
      : source_(std::move(source)), finished_(std::move(finished)) {
    const LineIterator begin(text.data(), &line_), end(text.data() + text.size(), &line_);
    nlohmann::json::sax_parse(begin, end, this);
  }
  [[nodiscard]] const JsonValue& root() const { return root_; }
  [[nodiscard]] JsonValue take() { return std::move(root_); }

  // What nlohmann-json calls.
  bool null() { return add({}); }
  bool boolean(bool x) { return add({JsonValue::Kind::boolean, 0, x ? 1.0 : 0.0, {}, {}, {}}); }
  bool number_integer(std::int64_t x) { return add_number(static_cast<double>(x)); }
  bool number_unsigned(std::uint64_t x) { return add_number(static_cast<double>(x)); }
  bool number_float(double x, const std::string&) { return add_number(x); }
  bool string(std::string& x) {
    if (x.size() > longest_text) fail("a text of " + std::to_string(x.size()) + " bytes, allowed: 1024");
    return add({JsonValue::Kind::text, 0, 0, std::move(x), {}, {}});
  }
  bool binary(std::vector<std::uint8_t>&) { return false; }
  bool start_object(std::size_t) { return open(JsonValue::Kind::table); }
  bool start_array(std::size_t) { return open(JsonValue::Kind::list); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& x) {
    JsonValue& table = *open_.back();
    if (x.size() > longest_text) fail("a key of " + std::to_string(x.size()) + " bytes, allowed: 1024");
    if (table.find(x) != nullptr) fail("\"" + x + "\" occurs twice");
    if (table.keys.size() == max_keys) fail("more than 64 keys in a table");
    table.keys.push_back(std::move(x));
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& e) {
    // "[json.exception.parse_error.101] parse error at line 3, column 7: ..." without its number.
    const std::string_view what = e.what();
    const std::size_t after = what.find("] ");
    fail("no JSON: " + std::string(what.substr(after == std::string_view::npos ? 0 : after + 2, 200)));
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse("skinctl: " + source_ + ":" + std::to_string(line_) + ": " + what);
  }
  bool add_number(double x) { return add({JsonValue::Kind::number, 0, x, {}, {}, {}}); }
  JsonValue& put(JsonValue value) {
    value.line = line_;
    if (++values_ > max_values) fail("more than 2^21 values outside of cells");
    if (open_.empty()) {
      root_ = std::move(value);
      return root_;
    }
    open_.back()->items.push_back(std::move(value));
    return open_.back()->items.back();
  }
  bool add(JsonValue value) {
    put(std::move(value));
    return true;
  }
  bool open(JsonValue::Kind kind) {
    if (open_.size() == max_depth) fail("lists and tables more than 8 deep");
    JsonValue value;
    value.kind = kind;
    const std::size_t before = values_;
    open_.push_back(&put(std::move(value)));  // its owner grows only once it is closed: the address stays
    values_before_.push_back(before);
    return true;
  }
  bool close() {
    const JsonValue* done = open_.back();
    const std::size_t before = values_before_.back();
    open_.pop_back();
    values_before_.pop_back();
    if (done->kind != JsonValue::Kind::table || open_.size() < 2 ||
        open_.back()->kind != JsonValue::Kind::list)
      return true;
    path_.clear();
    for (const JsonValue* table : open_)
      if (table->kind == JsonValue::Kind::table) path_.push_back(table->keys.back());
    if (finished_(path_, *done, *open_[open_.size() - 2])) {
      open_.back()->items.pop_back();
      values_ = before;
    }
    return true;
  }

  std::string source_;
  Finished finished_;
  int line_ = 1;
  JsonValue root_;
  std::vector<JsonValue*> open_;
  std::vector<std::size_t> values_before_;
  std::size_t values_ = 0;
  std::vector<std::string> path_;
};

}  // namespace detail
SKINCTL_END_NAMESPACE
