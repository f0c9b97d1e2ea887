// The hash of a message type (REP 2016), computed from its definition: the oracle of the hashes that are written down.
#pragma once

#include <map>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "examples/support/sha256.hpp"
#include "skinctl/core/contract.hpp"

namespace skinctl::testing {

/// Reads a definition with its dependencies; writes the text whose SHA-256 is the type's hash.
class TypeDescription {
 public:
  TypeDescription(const std::string& name, const std::string& schema) : name_(name) {
    std::string type = name;
    std::istringstream lines(schema);
    for (std::string line; std::getline(lines, line);) {
      line = line.substr(0, line.find('#'));
      if (line.starts_with("====")) continue;
      if (line.starts_with("MSG: ")) {
        type = full_name(trimmed(line.substr(5)), "");
        types_[type];
      } else if (!trimmed(line).empty()) {
        add(type, trimmed(line));
      }
    }
    types_[name_];
  }

  [[nodiscard]] std::string json() const {
    std::set<std::string> used;
    collect(name_, used);
    used.erase(name_);
    std::string others;
    for (const auto& type : used) others += (others.empty() ? "" : ", ") + one(type);
    return R"({"type_description": )" + one(name_) + R"(, "referenced_type_descriptions": [)" + others + "]}";
  }

 private:
  struct Field {
    std::string name;
    std::string nested{};  ///< name of a message type; empty: a plain type
    unsigned id = 0;
    std::size_t capacity = 0;         ///< capacity of an array or bounded sequence
    std::size_t string_capacity = 0;  ///< capacity of a bounded string
  };

  static std::string trimmed(const std::string& s) {
    const auto from = s.find_first_not_of(" \t\r");
    return from == std::string::npos ? "" : s.substr(from, s.find_last_not_of(" \t\r") - from + 1);
  }
  /// "Header" and "std_msgs/Header" become "std_msgs/msg/Header".
  static std::string full_name(const std::string& type, const std::string& user) {
    const auto slash = type.find('/');
    if (slash == std::string::npos) return user.substr(0, user.rfind('/') + 1) + type;
    return type.find('/', slash + 1) != std::string::npos
               ? type
               : type.substr(0, slash) + "/msg" + type.substr(slash);
  }
  static std::size_t number(const std::string& digits, const std::string& line) {
    if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos)
      refuse("skinctl: message definition, line \"" + line + "\": no bound");
    return std::stoul(digits);
  }
  void add(const std::string& owner, const std::string& line) {
    const auto space = line.find_first_of(" \t");
    if (space == std::string::npos) refuse("skinctl: message definition, line \"" + line + "\": no name");
    std::string type = line.substr(0, space);
    const std::string rest = trimmed(line.substr(space));
    const auto name_end = rest.find_first_of(" \t=");
    if (name_end != std::string::npos && trimmed(rest.substr(name_end)).starts_with("="))
      return;  // a constant
    Field field{.name = rest.substr(0, name_end)};
    unsigned offset = 0;  // of arrays, bounded and unbounded sequences among the type ids
    if (const auto bracket = type.find('['); bracket != std::string::npos && type.ends_with("]")) {
      const std::string bound = type.substr(bracket + 1, type.size() - bracket - 2);
      offset = bound.empty() ? 144 : bound.starts_with("<=") ? 96 : 48;
      if (offset != 144) field.capacity = number(bound.substr(offset == 96 ? 2 : 0), line);
      type.resize(bracket);
    }
    if (const auto bound = type.find("<="); bound != std::string::npos) {
      field.string_capacity = number(type.substr(bound + 2), line);
      type.resize(bound);
    }
    static const std::map<std::string, unsigned> ids = {
        {"int8", 2},   {"uint8", 3}, {"int16", 4},  {"uint16", 5},   {"int32", 6},
        {"uint32", 7}, {"int64", 8}, {"uint64", 9}, {"float32", 10}, {"float64", 11},
        {"char", 3},   {"bool", 15}, {"byte", 16},  {"string", 17},  {"wstring", 18}};
    if (const auto plain = ids.find(type); plain != ids.end()) {
      field.id = plain->second + (field.string_capacity > 0 ? 4 : 0);  // bounded strings: 21, 22
    } else {
      field.id = 1;
      field.nested = full_name(type, owner);
    }
    field.id += offset;
    types_[owner].push_back(std::move(field));
  }
  void collect(const std::string& type, std::set<std::string>& used) const {
    const auto found = types_.find(type);
    if (found == types_.end())
      refuse("skinctl: message definition of " + name_ + ": no \"MSG: " + type + "\"");
    if (!used.insert(type).second) return;
    for (const Field& f : found->second)
      if (!f.nested.empty()) collect(f.nested, used);
  }
  [[nodiscard]] std::string one(const std::string& type) const {
    std::string fields;
    for (const Field& f : types_.at(type)) {
      fields += (fields.empty() ? "" : ", ") + (R"({"name": ")" + f.name) + R"(", "type": {"type_id": )" +
                std::to_string(f.id) + R"(, "capacity": )" + std::to_string(f.capacity) +
                R"(, "string_capacity": )" + std::to_string(f.string_capacity) +
                R"(, "nested_type_name": ")" + f.nested + R"("}})";
    }
    return R"({"type_name": ")" + type + R"(", "fields": [)" + fields + "]}";
  }

  std::string name_;
  std::map<std::string, std::vector<Field>> types_;
};

/// The hash of the type `name` with the definition `schema`: the type's `.msg` text, then each type that it uses.
/// Throws for a definition that is no ROS message, or lacks a type.
[[nodiscard]] inline std::string hash_of_message(const std::string& name, const std::string& schema) {
  return "RIHS01_" + examples::sha256(TypeDescription(name, schema).json());
}

}  // namespace skinctl::testing
