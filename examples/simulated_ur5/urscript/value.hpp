// What a URScript variable holds.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "examples/simulated_ur5/kinematics.hpp"

namespace simulated_ur5::urscript {

class Value;

/// What `run` gives: a thread's number.
struct ThreadNumber {
  std::uint32_t number = 0;
  friend bool operator==(ThreadNumber, ThreadNumber) = default;
};

/// Items and how much they weigh together, so that a script cannot build what memory or stack does not hold.
struct List {
  std::vector<Value> items;
  std::uint32_t weight = 1, depth = 1;
};
struct Struct {
  std::vector<std::pair<std::string, Value>> fields;
  std::uint32_t weight = 1, depth = 1;
};

inline constexpr std::uint32_t heaviest_value = 4000, deepest_value = 8;
inline constexpr std::size_t longest_string = 4096;

class Value {
 public:
  Value() = default;
  Value(bool b) : v_(b) {}
  Value(std::int64_t i) : v_(i) {}
  Value(int i) : v_(std::int64_t{i}) {}
  Value(double d) : v_(d) {}
  Value(std::string s) : v_(std::move(s)) {}
  Value(const char* s) : v_(std::string(s)) {}
  Value(const Pose6& p) : v_(p) {}
  Value(ThreadNumber t) : v_(t) {}
  Value(List l) : v_(std::move(l)) {}
  Value(Struct s) : v_(std::move(s)) {}

  template <class T>
  const T* as() const {
    return std::get_if<T>(&v_);
  }
  template <class T>
  T* as() {
    return std::get_if<T>(&v_);
  }
  bool empty() const { return v_.index() == 0; }

  /// Of an integer, a float or a boolean.
  std::optional<double> number() const;
  /// Of a list of numbers or a pose.
  std::optional<std::vector<double>> numbers() const;
  /// Six numbers.
  std::optional<Pose6> six() const;
  bool truth() const;
  /// As textmsg and to_str write it.
  std::string text() const;

  std::uint32_t weight() const;
  std::uint32_t depth() const;

  friend bool operator==(const Value& a, const Value& b);

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Pose6, ThreadNumber, List, Struct> v_;
};

/// A list of `items`; nothing if it is too heavy or too deep.
std::optional<Value> list_of(std::vector<Value> items);
Value list_of(const std::vector<double>& numbers);
template <std::size_t N>
Value list_of(const std::array<double, N>& numbers) {
  return list_of(std::vector<double>(numbers.begin(), numbers.end()));
}

enum class Operation : std::uint8_t {
  add,
  subtract,
  multiply,
  divide,
  modulo,
  less,
  less_equal,
  equal,
  unequal
};

/// `a op b`: numbers; lists and poses item by item, and with a number. Nothing: the operands do not fit.
std::optional<Value> combine(Operation operation, const Value& a, const Value& b);

}  // namespace simulated_ur5::urscript
