// SPDX-License-Identifier: BSD-3-Clause
// Elements of a URDF as names, numbers and placements, with error texts that name the element.
#pragma once

#include <tinyxml2.h>

#include <cstring>

#include "skinctl/io/detail/from_chars.hpp"
#include "skinctl/io/parse_urdf.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// A frame in another: axes and origin.
struct UrdfPlace {
  Rotation<double> R;
  Xyz<double> p{0, 0, 0};
};
inline UrdfPlace product(const UrdfPlace& a, const UrdfPlace& b) {
  return {a.R * b.R, a.p + a.R * b.p};
}

class UrdfText {
 public:
  using Element = tinyxml2::XMLElement;

  explicit UrdfText(std::string source) : source_(std::move(source)) {}

  std::string message(int line, const std::string& what) const {
    return "skinctl: " + source_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what;
  }
  std::string message(const Element& at, const std::string& what) const {
    const char* name = at.Attribute("name");
    return message(at.GetLineNum(), std::string("<") + at.Name() +
                                        (name ? std::string(" name=\"") + name + '"' : "") + ">: " + what);
  }
  template <class At>
  [[noreturn]] void fail(const At& at, const std::string& what) const {
    refuse(message(at, what));
  }

  std::string text_of(const Element& e, const char* attribute) const {
    const char* text = e.Attribute(attribute);
    if (text == nullptr || *text == 0) fail(e, std::string("no attribute \"") + attribute + '"');
    return text;
  }
  /// Reads `N` numbers separated by blanks from an attribute, or from `otherwise` where it is missing.
  template <std::size_t N>
  std::array<double, N> numbers(const Element& owner, const Element& e, const char* attribute,
                                const char* otherwise) const {
    const char* text = e.Attribute(attribute);
    if (text == nullptr) text = otherwise;
    if (text == nullptr) fail(owner, std::string("<") + e.Name() + "> has no attribute \"" + attribute + '"');
    std::array<double, N> out{};
    const char* at = text;
    const char* const end = text + std::strlen(text);
    const auto skip = [&] {
      while (at != end && std::strchr(" \t\n\r", *at)) ++at;
    };
    bool good = true;
    for (std::size_t k = 0; k < N && good; ++k) {
      skip();
      if (at != end && *at == '+') ++at;
      const auto result = detail::from_chars(at, end, out[k]);
      good = result.ec == std::errc() && out[k] - out[k] == 0;
      at = result.ptr;
    }
    skip();
    if (!good || at != end)
      fail(owner, std::string("<") + e.Name() + " " + attribute + "=\"" + text + "\">: " + std::to_string(N) +
                      (N == 1 ? " finite number" : " finite numbers") + " expected");
    return out;
  }
  double number(const Element& owner, const Element& e, const char* attribute,
                const char* otherwise = nullptr) const {
    return numbers<1>(owner, e, attribute, otherwise)[0];
  }

  /// The `<origin>` of an element: `Rz(yaw) Ry(pitch) Rx(roll)`.
  UrdfPlace origin(const Element& owner, const Element& of) const {
    UrdfPlace X;
    const Element* e = of.FirstChildElement("origin");
    if (e == nullptr) return X;
    const auto xyz = numbers<3>(owner, *e, "xyz", "0 0 0"), rpy = numbers<3>(owner, *e, "rpy", "0 0 0");
    const double sr = std::sin(rpy[0]), cr = std::cos(rpy[0]), sp = std::sin(rpy[1]), cp = std::cos(rpy[1]),
                 sy = std::sin(rpy[2]), cy = std::cos(rpy[2]);
    X.p = {xyz[0], xyz[1], xyz[2]};
    X.R = {{cy * cp, sy * cp, -sp},
           {cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr},
           {cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr}};
    return X;
  }
  /// The shortest turn of z onto the joint's axis; exact where the axis is one of the frame's.
  Rotation<double> onto_axis(const Element& joint) const {
    std::array<double, 3> a{1, 0, 0};
    if (const Element* e = joint.FirstChildElement("axis")) a = numbers<3>(joint, *e, "xyz", "1 0 0");
    const double size = std::hypot(a[0], a[1], a[2]);
    if (!(size > 1e-9 && size < 1e9)) fail(joint, "an axis without direction");
    for (double& x : a) x /= size;
    const bool down = a[2] < 0;
    if (down) a = {-a[0], -a[1], -a[2]};
    const double x = a[0], y = a[1], z = a[2], f = 1 / (1 + z);
    const Rotation<double> R{{1 - f * x * x, -f * x * y, -x}, {-f * x * y, 1 - f * y * y, -y}, {x, y, z}};
    return down ? R * Rotation<double>{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}} : R;
  }
  /// Pose of the child link of a joint at `position` in its frame at 0.
  UrdfPlace moved(const Element& joint, bool slides, double position) const {
    if (position == 0) return {};
    const Rotation<double> A = onto_axis(joint);
    if (slides) return {{}, position * A.z};
    const double c = std::cos(position), s = std::sin(position);
    return {A * Rotation<double>{{c, s, 0}, {-s, c, 0}, {0, 0, 1}} * A.transpose(), {0, 0, 0}};
  }

 private:
  std::string source_;
};

/// The first element that a xacro leaves when nobody expands it; null: none.
inline const tinyxml2::XMLElement* xacro_in(const tinyxml2::XMLElement& robot) {
  for (auto* e = robot.FirstChildElement(); e; e = e->NextSiblingElement()) {
    const char* name = e->Attribute("name");
    if (std::strncmp(e->Name(), "xacro:", 6) == 0 || (name && std::strstr(name, "${"))) return e;
  }
  return nullptr;
}

}  // namespace detail
SKINCTL_END_NAMESPACE
