#include "write_model.hpp"

#include <cctype>
#include <charconv>
#include <cmath>

namespace urdf_to_model {
namespace {

/// The shortest text that is read back to the last bit.
std::string number(double x) {
  if (x - x != 0)
    return x > 0 ? "std::numeric_limits<double>::infinity()" : "-std::numeric_limits<double>::infinity()";
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, x).ptr};
}

std::string identifier(const std::string& name) {
  std::string out;
  for (char c : name)
    out += std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
  if (out.empty() || std::isdigit(static_cast<unsigned char>(out[0]))) out = "robot_" + out;
  return out;
}

/// Printable on one line, as a comment or in quotes.
std::string plain(const std::string& text) {
  std::string out;
  for (char c : text) out += std::isprint(static_cast<unsigned char>(c)) && c != '"' && c != '\\' ? c : '?';
  return out;
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

}  // namespace

std::string header(const skinctl::Urdf& urdf, const Settings& settings) {
  const std::size_t n = urdf.joints.size();
  skinctl::require(n <= 64, "joints of a static model", static_cast<double>(n), "1 to 64");
  auto links = skinctl::model_links(urdf).links;
  using P = skinctl::Parameter;
  for (auto& l : links) {
    make_exact(l[P::cos_gamma], l[P::sin_gamma], settings.snap);
    make_exact(l[P::cos_alpha], l[P::sin_alpha], settings.snap);
    make_exact(l[P::cos_beta], l[P::sin_beta], settings.snap);
  }
  const auto& joints = urdf.joints;
  const std::string space = settings.name_space.empty() ? identifier(urdf.name) : settings.name_space;
  const std::string count = std::to_string(n);
  std::string out;
  out += "// Robot \"" + plain(urdf.name) +
         "\", written by urdf_to_model: write it anew instead of changing it.\n";
  out += "#pragma once\n\n#include <array>\n#include <limits>\n\n#include \"skinctl/model/model.hpp\"\n\n";
  out += "namespace " + space + " {\n\n";
  out += "/// Links by the joint that moves them; the base is \"" + plain(urdf.base) + "\".\n";
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
         list(n, [&](std::size_t i) { return '"' + plain(joints[i].name) + '"'; }) + "};\n";
  out += "  static constexpr double gravity[3] = {" +
         list(3, [&](std::size_t i) { return number(settings.gravity[i]); }) + "};  // [m/s^2]\n";
  out += "  // In the order of skinctl::Parameter.\n";
  out += "  static constexpr std::array<skinctl::LinkParameters<double>, joints> links = {{\n";
  for (const auto& l : links)
    out += "      {{" + list(l.numbers.size(), [&](std::size_t k) { return number(l.numbers[k]); }) + "}},\n";
  out += "  }};\n";
  const auto limits = [&](const char* name, double skinctl::UrdfJoint::* limit, const char* unit) {
    out += std::string("  static constexpr std::array<double, joints> ") + name + " = {" +
           list(n, [&](std::size_t i) { return number(joints[i].*limit); }) + "};  // " + unit + "\n";
  };
  limits("lower", &skinctl::UrdfJoint::lower, "[rad] or [m]");
  limits("upper", &skinctl::UrdfJoint::upper, "[rad] or [m]");
  limits("max_velocity", &skinctl::UrdfJoint::velocity, "[rad/s] or [m/s]");
  limits("max_torque", &skinctl::UrdfJoint::effort, "[N m] or [N]");
  out += "};\n\nusing Model = skinctl::StaticModel<Description>;\n\n}  // namespace " + space + "\n";
  return out;
}

}  // namespace urdf_to_model
