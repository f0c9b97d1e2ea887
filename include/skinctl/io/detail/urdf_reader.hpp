// Reads a URDF: XML to joints and bodies, with complaints that name the element.
#pragma once

#include <tinyxml2.h>

#include <charconv>
#include <cstdio>
#include <cstring>
#include <map>
#include <string_view>

#include "skinctl/io/urdf_tree.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

inline constexpr std::size_t urdf_size_limit = std::size_t(16) << 20;

class UrdfReader {
 public:
  UrdfReader(std::string_view text, std::string source) { urdf_.source = std::move(source), parse(text); }
  [[nodiscard]] Urdf take() { return std::move(urdf_); }

 private:
  using Element = tinyxml2::XMLElement;
  struct Joint {
    const Element* xml;
    std::string name, type;
    std::size_t parent, child;
  };
  struct Link {
    const Element* xml;
    std::string name;
    int joint = -1;  ///< index into joints_ of the one that carries it
    bool placed = false;
  };

  std::string message(int line, const std::string& what) const {
    return "skinctl: " + urdf_.source + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what;
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

  void parse(std::string_view text) {
    if (text.size() > urdf_size_limit) fail(0, std::to_string(text.size()) + " bytes, allowed: 16 MiB");
    tinyxml2::XMLDocument xml;
    if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      fail(xml.ErrorLineNum(), std::string("no XML, or cut off: ") + xml.ErrorName());
    const Element* robot = xml.RootElement();
    if (robot == nullptr) fail(0, "no XML: it has no element");
    if (std::strcmp(robot->Name(), "robot") != 0) fail(*robot, "no URDF: its root is not <robot>");
    if (const char* name = robot->Attribute("name")) urdf_.name = name;
    for (auto* e = robot->FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
      const std::string name = text_of(*e, "name");
      if (!link_index_.emplace(name, links_.size()).second) fail(*e, "a second link of this name");
      links_.push_back({e, name});
    }
    if (links_.empty()) fail(*robot, "no <link>");
    std::map<std::string, int> names;
    for (auto* e = robot->FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
      Joint joint{e, text_of(*e, "name"), text_of(*e, "type"), link_of(*e, "parent"), link_of(*e, "child")};
      if (!names.emplace(joint.name, 0).second) fail(*e, "a second joint of this name");
      Link& child = links_[joint.child];
      if (child.joint >= 0)
        fail(*e, "its child link \"" + child.name + "\" hangs on joint \"" +
                     joints_[std::size_t(child.joint)].name + "\" already");
      child.joint = static_cast<int>(joints_.size());
      joints_.push_back(joint);
    }
    walk(root());
    for (const Link& l : links_)
      if (!l.placed)
        fail(*joints_[std::size_t(l.joint)].xml, "a loop: its child link \"" + l.name + "\" carries itself");
    if (urdf_.joints.empty()) fail(*robot, "no joint that moves");
    for (std::size_t j = 0; j < urdf_.joints.size(); ++j) finish(j);
  }

  std::string text_of(const Element& e, const char* attribute) const {
    const char* text = e.Attribute(attribute);
    if (text == nullptr || *text == 0) fail(e, std::string("no attribute \"") + attribute + '"');
    return text;
  }
  std::size_t link_of(const Element& joint, const char* end) const {
    const Element* e = joint.FirstChildElement(end);
    if (e == nullptr) fail(joint, std::string("no <") + end + ">");
    const char* link = e->Attribute("link");
    const auto found = link_index_.find(link ? link : "");
    if (found == link_index_.end())
      fail(joint, std::string("its ") + end + " link \"" + (link ? link : "") + "\" is unknown");
    return found->second;
  }
  std::size_t root() {
    std::size_t root = links_.size();
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (links_[i].joint >= 0) continue;
      if (root < links_.size())
        fail(*links_[i].xml,
             "hangs on no joint, and neither does \"" + links_[root].name + "\": one link only is the base");
      root = i;
    }
    if (root == links_.size())
      fail(*joints_[0].xml, "a loop: every link is the child of a joint, so there is no base");
    urdf_.base = links_[root].name;
    return root;
  }

  /// Numbers separated by blanks; `count` of them.
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
      const auto result = std::from_chars(at, end, out[k]);
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

  struct Place {
    Rotation<double> R;
    Xyz<double> p{0, 0, 0};
  };
  static Place product(const Place& a, const Place& b) { return {a.R * b.R, a.p + a.R * b.p}; }

  /// The `<origin>` of an element: `Rz(yaw) Ry(pitch) Rx(roll)`.
  Place origin(const Element& owner, const Element& of) const {
    Place X;
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
    if (!(size > 1e-9)) fail(joint, "an axis without direction");
    for (double& x : a) x /= size;
    const bool down = a[2] < 0;
    if (down) a = {-a[0], -a[1], -a[2]};
    const double x = a[0], y = a[1], z = a[2], f = 1 / (1 + z);
    const Rotation<double> R{{1 - f * x * x, -f * x * y, -x}, {-f * x * y, 1 - f * y * y, -y}, {x, y, z}};
    return down ? R * Rotation<double>{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}} : R;
  }

  /// The body of a link in its own frame, mass 0 where it has none.
  LinkInertia inertia(const Element& link, bool& given) {
    const Element* e = link.FirstChildElement("inertial");
    given = e != nullptr;
    if (!given) return {};
    const Element* m = e->FirstChildElement("mass");
    const Element* t = e->FirstChildElement("inertia");
    if (m == nullptr) fail(link, "<inertial> has no <mass>");
    if (t == nullptr) fail(link, "<inertial> has no <inertia>");
    LinkInertia in;
    in.mass = number(link, *m, "value");
    if (in.mass < 0) fail(link, "a negative mass");
    in.xx = number(link, *t, "ixx"), in.yy = number(link, *t, "iyy"), in.zz = number(link, *t, "izz");
    in.xy = number(link, *t, "ixy", "0"), in.xz = number(link, *t, "ixz", "0"),
    in.yz = number(link, *t, "iyz", "0");
    const double defect = density_defect(make_link({}, in));
    if (defect > makers_density)
      fail(link, "moments of inertia that no body has: each principal one is at most the sum of the others");
    if (defect > rounded_density) {
      char percent[16];
      std::snprintf(percent, sizeof percent, "%.2g", 100 * defect);
      urdf_.warnings.push_back(message(link, std::string("moments of inertia that no body has, by ") +
                                                 percent + " % of their size: taken as they are"));
    }
    const Place X = origin(link, *e);
    return seen_from(X.R, X.p, in);
  }

  /// Places the links below `root`, with a stack of its own: a file may nest deeper than the program's.
  void walk(std::size_t root) {
    std::vector<std::vector<std::size_t>> below(links_.size());
    for (const Joint& j : joints_) below[j.parent].push_back(j.child);
    struct Step {
      std::size_t link;
      int carrier;  ///< of the parent link
      Place X;      ///< of the parent link in the carrier's frame
    };
    std::vector<Step> open = {{root, -1, {}}};
    while (!open.empty()) {
      Step step = open.back();
      open.pop_back();
      Link& link = links_[step.link];
      link.placed = true;
      if (link.joint >= 0) pass(joints_[std::size_t(link.joint)], step.carrier, step.X);
      urdf_.frames.push_back({link.name, step.carrier, step.X.R, step.X.p});
      bool given = false;
      const LinkInertia own = inertia(*link.xml, given);
      if (step.carrier >= 0 && given) {
        const auto k = std::size_t(step.carrier);
        LinkInertia& body = urdf_.joints[k].placed.inertia;
        const LinkInertia part = seen_from(step.X.R, step.X.p, own);
        body = has_body_[k] ? combined(body, part) : part;
        has_body_[k] = true;
      }
      for (auto child = below[step.link].rbegin(); child != below[step.link].rend(); ++child)
        open.push_back({*child, step.carrier, step.X});
    }
  }
  /// From a joint's parent link to its child link.
  void pass(const Joint& j, int& carrier, Place& X) {
    X = product(X, origin(*j.xml, *j.xml));
    if (j.type == "fixed") return;
    UrdfJoint joint;
    joint.name = j.name;
    joint.link = links_[j.child].name;
    joint.parent = carrier;
    joint.line = j.xml->GetLineNum();
    if (j.type == "prismatic") {
      joint.kind = JointKind::prismatic;
    } else if (j.type == "continuous") {
      joint.continuous = true;
    } else if (j.type != "revolute") {
      fail(*j.xml, "type \"" + j.type + "\" is none of revolute, continuous, prismatic, fixed");
    }
    if (j.xml->FirstChildElement("mimic")) fail(*j.xml, "<mimic> is not supported");
    if (const Element* limit = j.xml->FirstChildElement("limit")) {
      if (!joint.continuous) {
        joint.lower = number(*j.xml, *limit, "lower", "0");
        joint.upper = number(*j.xml, *limit, "upper", "0");
        if (joint.lower > joint.upper) fail(*j.xml, "its lower limit lies above its upper");
      }
      if (limit->Attribute("velocity")) joint.velocity = number(*j.xml, *limit, "velocity");
      if (limit->Attribute("effort")) joint.effort = number(*j.xml, *limit, "effort");
    }
    const Rotation<double> turn = onto_axis(*j.xml);
    joint.placed.R = X.R * turn;
    joint.placed.p[0] = X.p.x, joint.placed.p[1] = X.p.y, joint.placed.p[2] = X.p.z;
    X = {turn.transpose(), {0, 0, 0}};
    carrier = static_cast<int>(urdf_.joints.size());
    urdf_.joints.push_back(joint);
    has_body_.push_back(false);
    moved_.push_back(j.child);
  }
  void finish(std::size_t j) const {
    const Link& link = links_[moved_[j]];
    if (!has_body_[j])
      fail(*link.xml, "joint \"" + urdf_.joints[j].name +
                          "\" moves it, but neither it nor what is fixed to it has an <inertial>");
  }

  Urdf urdf_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::map<std::string, std::size_t, std::less<>> link_index_;
  std::vector<bool> has_body_;      // per joint that moves
  std::vector<std::size_t> moved_;  // the link that it carries
};

}  // namespace detail
SKINCTL_END_NAMESPACE
