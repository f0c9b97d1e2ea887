// SPDX-License-Identifier: BSD-3-Clause
// A task as a drawing: the language of Graphviz.
#pragma once

#include <span>
#include <string>

#include "skinctl/semantics/task.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The words of an application for the numbers in a task.
struct TaskWords {
  std::span<const char* const> roles{};   ///< names of object classes
  std::span<const char* const> places{};  ///< names of places
};

namespace detail {
/// The text as a string of DOT, in quotes and escaped.
[[nodiscard]] inline std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}
[[nodiscard]] inline std::string word(std::span<const char* const> words, std::size_t i) {
  return i < words.size() ? words[i] : std::to_string(i);
}
/// The label of a step, for instance "put orange, box".
[[nodiscard]] inline std::string says(const Step& s, const TaskWords& words) {
  std::string text = s.does->name;
  text += ' ' + word(words.roles, s.role);
  if (s.place != no_place) text += ", " + word(words.places, s.place);
  return text;
}
[[nodiscard]] inline std::string node_of(std::uint8_t to) {
  return to == finish ? "done" : to == ask_person ? "ask" : "s" + std::to_string(to);
}
}  // namespace detail

/// A task's graph in the language of Graphviz: edges `done` are solid, `no` dashed, `failed` dotted.
template <std::size_t N>
[[nodiscard]] std::string to_dot(const TaughtTask<N>& task, const TaskWords& words = {}) {
  std::string out = "digraph " + detail::quoted(task.name) + " {\n  node [shape=box];\n";
  bool asks = false;
  for (std::size_t i = 0; i < task.size; ++i) {
    const Step& s = task.steps[i];
    const std::string here = "  " + detail::node_of(static_cast<std::uint8_t>(i));
    out += here + " [label=" + detail::quoted(detail::says(s, words)) + "];\n";
    out += here + " -> " + detail::node_of(s.done) + ";\n";
    if (s.no != nowhere) out += here + " -> " + detail::node_of(s.no) + " [style=dashed, label=no];\n";
    out += here + " -> " + detail::node_of(s.failed) + " [style=dotted, constraint=false];\n";
    asks = asks || s.done == ask_person || s.no == ask_person || s.failed == ask_person;
  }
  out += "  done [shape=doublecircle, label=\"\"];\n";
  if (asks) out += "  ask [shape=octagon];\n";
  return out + "}\n";
}

SKINCTL_END_NAMESPACE
