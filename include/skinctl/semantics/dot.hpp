// Tasks for other programs and for people: Graphviz DOT, BehaviorTree.CPP 4, and a drawing.
#pragma once

#include <array>
#include <span>
#include <string>

#include "skinctl/core/xml_text.hpp"
#include "skinctl/semantics/task.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The words of an application for the numbers in a task.
struct TaskWords {
  std::span<const char* const> roles{};   ///< of object classes
  std::span<const char* const> places{};  ///< of places
};

namespace detail {
/// In the quotes of DOT.
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
/// "put orange, box".
[[nodiscard]] inline std::string says(const Step& s, const TaskWords& words) {
  std::string text = s.does->name;
  text += ' ' + word(words.roles, s.role);
  if (s.place != no_place) text += ", " + word(words.places, s.place);
  return text;
}
[[nodiscard]] inline std::string node_of(std::uint8_t to) {
  return to == finish ? "done" : to == ask_person ? "ask" : "s" + std::to_string(to);
}
/// The number of a step in the variable of a behaviour tree; -1: the end, -2: ask.
[[nodiscard]] inline std::string state_of(std::uint8_t to) {
  return to == finish ? "-1" : to == ask_person ? "-2" : std::to_string(to);
}
}  // namespace detail

/// The graph in the language of Graphviz: done solid, no dashed, failed dotted.
template <std::size_t N>
[[nodiscard]] std::string to_dot(const Task<N>& task, const TaskWords& words = {}) {
  std::string out = "digraph " + detail::quoted(task.name) + " {\n  node [shape=box];\n";
  bool asks = false;
  for (std::size_t i = 0; i < N; ++i) {
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

/// A tree for BehaviorTree.CPP 4 (Groot2 shows it). A graph with ways back is no tree, so the tree is a loop over the
/// steps, and the blackboard holds the number of the present one (-1: done, -2: ask).
///
/// The actions to register have the names of the activities; ports `role` and `place` (in), `answer` (out: true or
/// false). `Reverse` goes back after a failure, `AskPerson` calls somebody.
template <std::size_t N>
[[nodiscard]] std::string to_behaviour_tree(const Task<N>& task, const TaskWords& words = {}) {
  const std::string id = xml_text(task.name);
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<root BTCPP_format=\"4\" main_tree_to_execute=\"" + id +
      "\">\n  <BehaviorTree ID=\"" + id +
      "\">\n    <Sequence>\n      <Script code=\"step := 0\"/>\n"
      "      <RetryUntilSuccessful num_attempts=\"-1\">\n        <Sequence>\n";
  std::string models;
  std::size_t first_named = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const Step& s = task.steps[i];
    const std::string name = xml_text(s.does->name);
    const std::string then =
        s.no == nowhere ? "step := " + detail::state_of(s.done)
                        : "step := answer ? " + detail::state_of(s.done) + " : " + detail::state_of(s.no);
    out += "          <IfThenElse _skipIf=\"step != " + std::to_string(i) +
           "\">\n            <RetryUntilSuccessful num_attempts=\"" + std::to_string(s.does->retries + 1) +
           "\">\n              <Action ID=\"" + name + "\" role=\"" +
           xml_text(detail::word(words.roles, s.role)) + "\" place=\"" +
           (s.place == no_place ? "" : xml_text(detail::word(words.places, s.place))) +
           "\" answer=\"{answer}\"/>\n            </RetryUntilSuccessful>\n            <Script code=\"" +
           then + "\"/>\n            <Sequence>\n              <Action ID=\"" + activity::Reverse::rule.name +
           "\"/>\n              <Script code=\"step := " + detail::state_of(s.failed) +
           "\"/>\n            </Sequence>\n          </IfThenElse>\n";
    for (first_named = 0; task.steps[first_named].does != s.does;) ++first_named;
    if (first_named == i)
      models += "    <Action ID=\"" + name +
                "\">\n      <input_port name=\"role\"/>\n      <input_port name=\"place\"/>\n"
                "      <output_port name=\"answer\"/>\n    </Action>\n";
  }
  out +=
      "          <Sequence _skipIf=\"step != -2\">\n            <Action ID=\"AskPerson\"/>\n            "
      "<Script "
      "code=\"step := 0\"/>\n          </Sequence>\n          <ScriptCondition code=\"step == -1\"/>\n       "
      " "
      "</Sequence>\n      </RetryUntilSuccessful>\n    </Sequence>\n  </BehaviorTree>\n  <TreeNodesModel>\n" +
      models + "    <Action ID=\"" + activity::Reverse::rule.name +
      "\"/>\n    <Action ID=\"AskPerson\"/>\n  </TreeNodesModel>\n</root>\n";
  return out;
}

/// The graph as a drawing: steps from above; done runs down or on the right, no dashed, failed on the left.
template <std::size_t N>
[[nodiscard]] std::string to_svg(const Task<N>& task, const TaskWords& words = {}) {
  constexpr int width = 220, height = 34, pitch = 62, left = 150, top = 50;
  const auto row = [&](std::uint8_t to) { return to < N ? int(to) : to == finish ? int(N) : int(N) + 1; };
  const auto y_of = [&](int r) { return top + r * pitch; };
  bool asks = false;
  std::string shapes, lines;
  const auto text = [](int x, int y, const char* style, const std::string& t) {
    return "<text x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(y) + "\" " + style + ">" +
           xml_text(t) + "</text>\n";
  };
  const auto arrow = [&](std::size_t i, std::uint8_t to, const char* style, bool on_left, int lane) {
    const int from_y = y_of(int(i)) + height / 2, to_y = y_of(row(to)) + height / 2;
    std::string d;
    if (!on_left && row(to) == int(i) + 1) {
      const int x = left + width / 2;
      d = "M" + std::to_string(x) + " " + std::to_string(y_of(int(i)) + height) + " V" +
          std::to_string(y_of(row(to)) - 2);
    } else {
      const int side = on_left ? left : left + width,
                far = on_left ? left - 18 - lane : left + width + 18 + lane;
      d = "M" + std::to_string(side) + " " + std::to_string(from_y + (on_left ? 6 : 4)) + " H" +
          std::to_string(far) + " V" + std::to_string(to_y - 6) + " H" +
          std::to_string(on_left ? side - 2 : side + 2);
    }
    lines += "<path d=\"" + d + "\" fill=\"none\" " + style + " marker-end=\"url(#a)\"/>\n";
  };
  int right_lane = 0;
  for (std::size_t i = 0; i < N; ++i) {
    const Step& s = task.steps[i];
    const int y = y_of(int(i));
    shapes += "<rect x=\"" + std::to_string(left) + "\" y=\"" + std::to_string(y) + "\" width=\"" +
              std::to_string(width) + "\" height=\"" + std::to_string(height) +
              "\" rx=\"5\" fill=\"#eef3f8\" stroke=\"#345\"/>\n";
    shapes += text(left + width / 2, y + 21, "text-anchor=\"middle\"",
                   std::to_string(i) + "  " + detail::says(s, words));
    arrow(i, s.done, "stroke=\"#345\" stroke-width=\"1.4\"", false,
          row(s.done) == int(i) + 1 ? 0 : 12 * right_lane++);
    if (s.no != nowhere) {
      shapes += text(left + width + 4, y + 33, "font-size=\"10\" fill=\"#345\"", "no");
      arrow(i, s.no, "stroke=\"#345\" stroke-width=\"1.4\" stroke-dasharray=\"5 3\"", false,
            12 * right_lane++);
    }
    arrow(i, s.failed, "stroke=\"#b33\" stroke-width=\"1\" stroke-dasharray=\"2 3\"", true,
          8 * (int(i) % 12));
    asks = asks || s.done == ask_person || s.no == ask_person || s.failed == ask_person;
  }
  const auto end = [&](int r, const char* fill, const char* name) {
    shapes += "<rect x=\"" + std::to_string(left) + "\" y=\"" + std::to_string(y_of(r)) + "\" width=\"" +
              std::to_string(width) + "\" height=\"" + std::to_string(height) + "\" rx=\"17\" fill=\"" +
              fill + "\" stroke=\"#345\"/>\n" +
              text(left + width / 2, y_of(r) + 21, "text-anchor=\"middle\"", name);
  };
  end(int(N), "#dff0df", "done");
  if (asks) end(int(N) + 1, "#fbe3d6", "ask a person");
  const std::string w = std::to_string(left + width + 60 + 12 * right_lane),
                    h = std::to_string(y_of(int(N) + (asks ? 2 : 1)));
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h + "\" viewBox=\"0 0 " +
         w + " " + h +
         "\" font-family=\"sans-serif\" font-size=\"13\">\n<defs><marker id=\"a\" viewBox=\"0 0 8 8\" "
         "refX=\"7\" "
         "refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\"><path d=\"M0 0L8 4L0 8z\" "
         "fill=\"context-stroke\"/>"
         "</marker></defs>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         text(left, 30, "font-size=\"16\" font-weight=\"bold\"", task.name) + lines + shapes + "</svg>\n";
}

SKINCTL_END_NAMESPACE
