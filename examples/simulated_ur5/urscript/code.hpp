// A compiled URScript program: instructions for a stack machine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "examples/simulated_ur5/urscript/token.hpp"
#include "examples/simulated_ur5/urscript/value.hpp"
#include "examples/simulated_ur5/version.hpp"

namespace simulated_ur5::urscript {

struct Builtin;

enum class Op : std::uint8_t {
  constant,    ///< push constants[a]
  load,        ///< push variable a (b: 1 global, 0 local)
  store,       ///< pop into variable a
  index,       ///< pop index and list, push the item
  store_item,  ///< pop value and index: variable a[index] = value
  field,       ///< pop a struct, push its field names[a]
  store_field,  ///< pop value: variable a.names[constant] = value; the name's constant is b / 2, b % 2 the scope
  make_list,    ///< pop a items
  make_pose,    ///< pop six numbers
  make_struct,  ///< pop as many values as calls[a] names
  binary,       ///< pop two, push `Operation(a)` of them; b: of them swapped
  negate,
  invert,       ///< not
  jump,         ///< to a
  jump_unless,  ///< pop; to a if it is not true
  keep_unless,  ///< and: to a with the value if it is not true, else pop
  keep_if,      ///< or
  call,         ///< calls[a]
  run,          ///< calls[a] in a thread of its own; push its number
  join,         ///< pop a thread's number, wait for its end
  kill,
  give,  ///< return the value on top
  pop,
  halt
};

struct Instruction {
  Op op = Op::halt;
  std::int32_t a = 0, b = 0;
  Place at;
};

struct Function {
  struct Parameter {
    std::string name;
    Value otherwise;  ///< empty: must be given
  };
  std::string name;
  std::vector<Parameter> parameters;
  std::int32_t start = 0;
  std::int32_t locals = 0;  ///< parameters included
  bool thread = false;
};

/// A call in the text. After linking one of `function` and `builtin` is set, and `target[i]` is the parameter
/// that argument i goes to.
struct CallSite {
  std::string name;
  Place at;
  std::vector<std::string> names;  ///< of the arguments; empty: by position
  std::vector<std::int32_t> target;
  std::int32_t function = -1;
  const Builtin* builtin = nullptr;
};

struct Code {
  std::string name;
  bool secondary = false;  ///< `sec`
  std::vector<Instruction> instructions;
  std::vector<Value> constants;
  std::vector<CallSite> calls;
  std::vector<Function> functions;  ///< 0: the program itself, whose variables are the globals
  std::vector<std::string> globals;
};

/// Compiles a program. Time and memory are linear in the text's length, nesting is bounded.
/// @param version  of the controller: functions that came later are unknown to it.
/// @return  the problem, or one without text: `code` is complete.
Problem compile(std::string_view text, const Version& version, Code& code);

}  // namespace simulated_ur5::urscript
