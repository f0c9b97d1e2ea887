// Tables of TOML files: numbers, texts and flags by their keys, and what is wrong with them in words.
#pragma once

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "skinctl/core/contract.hpp"

namespace examples {

/// The tables of a file. Throws `skinctl::ConfigurationError` with the line of what is no TOML.
inline toml::table read_toml(const std::string& file) {
  try {
    return toml::parse_file(file);
  } catch (const toml::parse_error& e) {
    skinctl::refuse(file + ":" + std::to_string(e.source().begin.line) + ": " + std::string(e.description()));
  }
}

/// One table of a TOML file, with every key that was asked for ticked off. What is wrong is refused with
/// file, line and key.
class TomlTable {
 public:
  TomlTable(const std::string& file, const std::string& name, const toml::table& table)
      : file_(file), name_(name), table_(table) {}

  void number(const char* key, double& value) {
    if (const toml::node* node = find(key)) {
      const auto v = node->value<double>();
      if (!v) bad(*node, key, "a number");
      value = *v;
    }
  }
  void whole(const char* key, std::uint64_t& value, std::int64_t most) {
    if (const toml::node* node = find(key)) {
      const auto v = node->value_exact<std::int64_t>();
      if (!v || *v < 0 || *v > most) bad(*node, key, "a whole number of 0 to " + std::to_string(most));
      value = static_cast<std::uint64_t>(*v);
    }
  }
  void flag(const char* key, bool& value) {
    if (const toml::node* node = find(key)) {
      const auto v = node->value_exact<bool>();
      if (!v) bad(*node, key, "true or false");
      value = *v;
    }
  }
  bool text(const char* key, std::string& value) {
    const toml::node* node = find(key);
    if (!node) return false;
    const auto v = node->value_exact<std::string>();
    if (!v) bad(*node, key, "a text");
    value = *v;
    return true;
  }
  /// @param or_one  one number stands for all.
  template <std::size_t N>
  bool numbers(const char* key, std::array<double, N>& value, bool or_one = false) {
    std::vector<double> list;
    if (!numbers(key, list, N, or_one)) return false;
    std::copy(list.begin(), list.end(), value.begin());
    return true;
  }
  [[noreturn]] void bad(const toml::node& node, const char* key, const std::string& expected) const {
    skinctl::refuse(file_ + ":" + std::to_string(node.source().begin.line) + ": " + name_ + "." + key +
                    " must be " + expected);
  }
  [[noreturn]] void refuse_at(const char* key, const std::string& expected) const {
    if (const toml::node* node = table_.get(key)) bad(*node, key, expected);
    skinctl::refuse(file_ + ": " + name_ + "." + key + " must be " + expected);
  }
  /// Refuses keys that nobody asked for.
  void finish() const {
    for (const auto& [key, node] : table_)
      if (asked_.count(std::string(key.str())) == 0)
        skinctl::refuse(file_ + ":" + std::to_string(node.source().begin.line) + ": " + name_ +
                        " has no key '" + std::string(key.str()) + "'");
  }

 private:
  bool numbers(const char* key, std::vector<double>& value, std::size_t count, bool or_one) {
    const toml::node* node = find(key);
    if (!node) return false;
    value.clear();
    const std::string expected =
        (or_one ? std::string("one number or ") : std::string()) + std::to_string(count) + " numbers";
    if (const toml::array* list = node->as_array()) {
      for (const toml::node& item : *list) {
        const auto v = item.value<double>();
        if (!v) bad(*node, key, expected);
        value.push_back(*v);
      }
      if (value.size() != count) bad(*node, key, expected);
      return true;
    }
    const auto v = node->value<double>();
    if (!v || !or_one) bad(*node, key, expected);
    value.assign(count, *v);
    return true;
  }
  const toml::node* find(const char* key) {
    asked_.insert(key);
    return table_.get(key);
  }
  std::string file_, name_;
  const toml::table& table_;
  std::set<std::string> asked_;
};

}  // namespace examples
