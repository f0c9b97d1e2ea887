#include "write_model.hpp"

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>

namespace urdf_to_model {
namespace {

/// The shortest text that is read back to the last bit.
std::string number(double x) {
  if (x - x != 0)
    return x > 0 ? "std::numeric_limits<double>::infinity()" : "-std::numeric_limits<double>::infinity()";
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

/// Words that name nothing of one's own: C++20's keywords, and the namespaces that the header needs.
bool is_reserved(const std::string& word) {
  static const std::set<std::string> words = {
      "alignas",   "alignof",   "and",         "and_eq",       "asm",
      "auto",      "bitand",    "bitor",       "bool",         "break",
      "case",      "catch",     "char",        "char16_t",     "char32_t",
      "char8_t",   "class",     "co_await",    "co_return",    "co_yield",
      "compl",     "concept",   "const",       "const_cast",   "consteval",
      "constexpr", "constinit", "continue",    "decltype",     "default",
      "delete",    "do",        "double",      "dynamic_cast", "else",
      "enum",      "explicit",  "export",      "extern",       "false",
      "float",     "for",       "friend",      "goto",         "if",
      "inline",    "int",       "long",        "main",         "mutable",
      "namespace", "new",       "noexcept",    "not",          "not_eq",
      "nullptr",   "operator",  "or",          "or_eq",        "posix",
      "private",   "protected", "public",      "register",     "reinterpret_cast",
      "requires",  "return",    "short",       "signed",       "sizeof",
      "skinctl",   "static",    "static_cast", "std",          "struct",
      "switch",    "template",  "this",        "thread_local", "throw",
      "true",      "try",       "typedef",     "typeid",       "typename",
      "union",     "unsigned",  "using",       "virtual",      "void",
      "volatile",  "wchar_t",   "while",       "xor",          "xor_eq"};
  return words.contains(word);
}
bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// A robot's name as a namespace: letters, digits and single underscores, never one of the language's words.
std::string identifier(const std::string& name) {
  std::string out;
  for (char c : name) {
    if (is_letter_or_digit(c)) {
      out += static_cast<char>(std::tolower(c));
    } else if (!out.empty() && out.back() != '_') {
      out += '_';
    }
  }
  while (!out.empty() && out.back() == '_') out.pop_back();
  if (out.empty()) return "robot";
  return is_reserved(out) || std::isdigit(static_cast<unsigned char>(out[0])) ? "robot_" + out : out;
}

/// The namespace that was asked for: `a` or `a::b`.
std::string checked(const std::string& space) {
  std::string word;
  bool good = true;
  const auto end_word = [&] {
    good = good && !word.empty() && word.find("__") == std::string::npos && word[0] != '_' &&
           !(word[0] >= '0' && word[0] <= '9') && !is_reserved(word);
    word.clear();
  };
  for (std::size_t i = 0; i < space.size(); ++i) {
    if (space.compare(i, 2, "::") == 0) {
      end_word(), ++i;
    } else {
      good = good && (is_letter_or_digit(space[i]) || space[i] == '_');
      word += space[i];
    }
  }
  end_word();
  if (!good)
    skinctl::refuse("skinctl: namespace \"" + space + "\": no name that C++ allows, such as my_robot");
  return space;
}

/// Printable on one line, in a comment.
std::string plain(const std::string& text) {
  std::string out;
  for (char c : text) out += c < 0x20 || c >= 0x7f || c == '"' || c == '\\' ? '?' : c;
  return out;
}

/// A literal with exactly these bytes.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7f || c == '"' || c == '\\' || c == '?') {
      char octal[8];
      std::snprintf(octal, sizeof octal, "\\%03o", static_cast<unsigned>(byte));
      out += octal;
    } else {
      out += c;
    }
  }
  return out + '"';
}

template <class F>
std::string list(std::size_t n, F&& item) {
  std::string text;
  for (std::size_t i = 0; i < n; ++i) text += (i ? ", " : "") + item(i);
  return text;
}

/// Makes a right angle exact that is one to within `snap`.
void make_exact(double& cos, double& sin, double snap) {
  if (std::abs(cos) <= snap) {
    cos = 0, sin = sin < 0 ? -1 : 1;
  } else if (std::abs(sin) <= snap) {
    sin = 0, cos = cos < 0 ? -1 : 1;
  }
}

/// The same for axes that lie along another frame's, if all three do.
void make_exact(skinctl::Rotation<double>& R, double snap) {
  skinctl::Rotation<double> exact = R;
  bool right = true;
  for (skinctl::Xyz<double>* axis : {&exact.x, &exact.y, &exact.z})
    for (double* x : {&axis->x, &axis->y, &axis->z}) {
      const double whole = std::round(*x);
      right = right && std::abs(*x - whole) <= snap;
      *x = whole + 0.0;
    }
  if (right) R = exact;
}

}  // namespace

std::string header(const skinctl::Urdf& urdf, const Settings& settings) {
  const std::size_t n = urdf.joints.size();
  skinctl::require(n <= 64, "joints of a static model", static_cast<double>(n), "1 to 64");
  for (const auto& joint : urdf.joints)
    if (!joint.question.empty())
      skinctl::detail::fail_urdf(urdf, joint, joint.question + "; --large-limits takes it as it is");
  auto links = skinctl::model_links(urdf).links;
  using P = skinctl::LinkParameter;
  for (auto& l : links) {
    make_exact(l[P::cos_gamma], l[P::sin_gamma], settings.snap);
    make_exact(l[P::cos_alpha], l[P::sin_alpha], settings.snap);
    make_exact(l[P::cos_beta], l[P::sin_beta], settings.snap);
  }
  const auto& joints = urdf.joints;
  const std::string space =
      settings.name_space.empty() ? identifier(urdf.name) : checked(settings.name_space);
  const std::string count = std::to_string(n);
  std::string out;
  out += "// Robot \"" + plain(urdf.name) +
         "\", written by urdf_to_model: write it anew instead of changing it.\n";
  out +=
      "#pragma once\n\n#include <array>\n#include <limits>\n\n#include \"skinctl/model/model.hpp\"\n"
      "#include \"skinctl/model/named_links.hpp\"\n\n";
  out += "namespace " + space + " {\n\n";
  out += "/// Links by the joint that moves them; the base is \"" + plain(urdf.base) + "\".\n";
  for (const auto& lock : urdf.locked)
    out += "/// Joint \"" + plain(lock.joint) + "\" stands still at " + number(lock.position) + ".\n";
  out += "struct Description {\n";
  out += "  static constexpr std::size_t joints = " + count + ";\n";
  out += "  static constexpr std::array<int, joints> parents = {" +
         list(n, [&](std::size_t i) { return std::to_string(joints[i].parent); }) + "};\n";
  out += "  static constexpr std::array<skinctl::JointKind, joints> kinds = {" +
         list(n,
              [&](std::size_t i) {
                return std::string("skinctl::JointKind::") +
                       (joints[i].kind == skinctl::JointKind::revolute ? "revolute" : "prismatic");
              }) +
         "};\n";
  out += "  static constexpr std::array<const char*, joints> names = {" +
         list(n, [&](std::size_t i) { return quoted(joints[i].name); }) + "};\n";
  out += "  static constexpr double gravity[3] = {" +
         list(3, [&](std::size_t i) { return number(settings.gravity[i]); }) + "};  // [m/s^2]\n";
  out += "  // In the order of skinctl::LinkParameter.\n";
  out += "  static constexpr std::array<skinctl::LinkParameters<double>, joints> links = {{\n";
  for (const auto& l : links)
    out += "      {{" + list(l.numbers.size(), [&](std::size_t k) { return number(l.numbers[k]); }) + "}},\n";
  out += "  }};\n";
  if (!urdf.assumed_masses.empty()) {
    out += "  // Masses that the file does not give; a robot by torque is refused with them [kg]:";
    for (const auto& a : urdf.assumed_masses) out += "\n  //   " + plain(a.link) + " " + number(a.mass);
    out += "\n  static constexpr bool masses_assumed = true;\n";
  }
  const auto limits = [&](const char* name, double skinctl::UrdfJoint::* limit, const char* unit) {
    out += std::string("  static constexpr std::array<double, joints> ") + name + " = {" +
           list(n, [&](std::size_t i) { return number(joints[i].*limit); }) + "};  // " + unit + "\n";
  };
  limits("lower", &skinctl::UrdfJoint::lower, "[rad] or [m]");
  limits("upper", &skinctl::UrdfJoint::upper, "[rad] or [m]");
  limits("max_velocity", &skinctl::UrdfJoint::velocity, "[rad/s] or [m/s]");
  limits("max_torque", &skinctl::UrdfJoint::effort, "[N m] or [N]");
  out +=
      "  // The links of the file: name, the model's link that carries each (-1: the base), and axes and "
      "origin there.\n";
  out += "  static constexpr std::array<skinctl::NamedLink, " + std::to_string(urdf.frames.size()) +
         "> named_links = {{\n";
  for (const auto& f : urdf.frames) {
    const auto triple = [&](const skinctl::Xyz<double>& v) {
      return "{" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "}";
    };
    skinctl::Rotation<double> R = f.R;
    make_exact(R, settings.snap);
    out += "      {" + quoted(f.name) + ", " + std::to_string(f.joint) + ", {" + triple(R.x) + ", " +
           triple(R.y) + ", " + triple(R.z) + "}, " + triple(f.p) + "},\n";
  }
  out += "  }};\n";
  out += "};\n\nusing Model = skinctl::StaticModel<Description>;\n\n";
  out += "/// Pose of a link of the file in the model: `X_LN<\"" + plain(urdf.frames.back().name) +
         "\">`, from `Link<I>` (`Base` if nothing moves it).\n"
         "template <skinctl::FrameName name>\n"
         "inline constexpr auto X_LN = skinctl::named_link_pose<Description, name>();\n\n";
  out += "}  // namespace " + space + "\n";
  return out;
}

}  // namespace urdf_to_model
