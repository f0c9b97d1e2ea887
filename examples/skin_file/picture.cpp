#include "examples/skin_file/picture.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "examples/support/svg_plot.hpp"
#include "skinctl/core/xml_text.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/cover.hpp"

namespace skin_file {
namespace {

using skinctl::Rotation;
using skinctl::SkinFile;
using Vec = skinctl::Xyz<double>;

constexpr double view_width = 470, margin = 24, gap = 20, top = 84, row = 20;
constexpr std::size_t colours = 8;

/// A corner-to-corner hexagon of the file, in the base.
struct Hexagon {
  std::array<Vec, 6> corners;
  Vec middle, normal;
  std::size_t patch = 0, link = 0;
  std::uint32_t id = 0;
  bool masked = false, in_region = false;
};
struct View {
  const char* name;
  Vec right, up, viewer;
};

std::string number(double v) {
  std::string text = plotting::decimal(v, 1);
  if (text.rfind("\u2212", 0) == 0) text.replace(0, 3, "-");
  return text;
}

/// Median distance of a patch's cells from their nearest neighbour; TUM's pitch for a single one.
double pitch(const std::vector<skinctl::detail::AnyCell>& cells) {
  std::vector<double> nearest;
  for (std::size_t i = 0; i < cells.size() && i < 200; ++i) {
    double least = 1e9;
    for (std::size_t j = 0; j < cells.size(); ++j) {
      const Vec d = cells[i].X_LC.origin() - cells[j].X_LC.origin();
      if (i != j) least = std::min(least, std::sqrt(dot(d, d)));
    }
    nearest.push_back(least);
  }
  if (cells.size() < 2) return skinctl::HexagonalCell::flat_pitch;
  std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2),
                   nearest.end());
  return nearest[nearest.size() / 2];
}

std::vector<Hexagon> hexagons(const SkinFile& file, const std::vector<skinctl::PlacedSkinPatch>& placed,
                              const Pose& pose) {
  std::map<std::uint32_t, bool> regional;
  for (const auto& region : file.regions)
    for (const std::uint32_t id : region.cells) regional[id] = true;
  std::vector<Hexagon> out;
  for (const auto& on : placed) {
    const double edge =
        skinctl::HexagonalCell::edge * std::min(pitch(on.cells) / skinctl::HexagonalCell::flat_pitch, 2.0);
    for (std::size_t c = 0; c < on.cells.size(); ++c) {
      const auto& X = on.cells[c].X_LC;
      const Rotation<double> R = pose.R[on.link] * X.axes();
      Hexagon h;
      h.middle = pose.p[on.link] + pose.R[on.link] * X.origin();
      h.normal = R.z;
      h.patch = on.patch;
      h.link = on.link;
      h.id = on.cells[c].id;
      h.masked = !file.patches[on.patch].cells[c].masked.empty();
      h.in_region = regional.count(h.id) > 0;
      for (std::size_t k = 0; k < 6; ++k) {
        const double angle = 3.14159265358979 / 3 * static_cast<double>(k);
        h.corners[k] = h.middle + (edge * std::cos(angle)) * R.x + (edge * std::sin(angle)) * R.y;
      }
      out.push_back(h);
    }
  }
  return out;
}

class Drawing {
 public:
  Drawing(const View& view, const std::vector<Hexagon>& cells, const Pose& pose, double scale_limit)
      : view_(view), cells_(cells), pose_(pose) {
    const auto hold = [&](const Vec& p) {
      left_ = std::min(left_, dot(p, view.right)), right_ = std::max(right_, dot(p, view.right));
      low_ = std::min(low_, dot(p, view.up)), high_ = std::max(high_, dot(p, view.up));
    };
    hold({0, 0, 0});
    for (const Vec& p : pose.p) hold(p);
    for (const Hexagon& h : cells)
      for (const Vec& p : h.corners) hold(p);
    scale = std::min({(view_width - 2 * margin) / std::max(right_ - left_, 1e-3),
                      620 / std::max(high_ - low_, 1e-3), scale_limit});
    height = scale * (high_ - low_);
  }
  double scale = 1, height = 0;

  std::string svg(double x, double y) {
    x_ = x + 0.5 * (view_width - scale * (right_ - left_)), y_ = y;
    std::string out = "<text class=\"name\" x=\"" + number(x + 0.5 * view_width) + "\" y=\"" +
                      number(y - 28) + "\" text-anchor=\"middle\">" + view_.name + "</text>\n";
    // From far to near; what looks away is behind its link.
    std::vector<const Hexagon*> order;
    for (const Hexagon& h : cells_) order.push_back(&h);
    std::stable_sort(order.begin(), order.end(), [&](const Hexagon* a, const Hexagon* b) {
      return dot(a->middle, view_.viewer) < dot(b->middle, view_.viewer);
    });
    out += "<path class=\"far\" d=\"";
    for (const Hexagon* h : order)
      if (dot(h->normal, view_.viewer) <= 0) out += outline(*h);
    out += "\"/>\n" + bones();
    for (const Hexagon* h : order)
      if (dot(h->normal, view_.viewer) > 0) out += cell(*h);
    return out;
  }

 private:
  std::array<double, 2> seen(const Vec& p) const {
    return {x_ + scale * (dot(p, view_.right) - left_), y_ + scale * (high_ - dot(p, view_.up))};
  }
  std::string at(const Vec& p) const {
    const auto [x, y] = seen(p);
    return number(x) + ' ' + number(y);
  }
  std::string outline(const Hexagon& h) const {
    std::string d = "M";
    for (std::size_t k = 0; k < 6; ++k) d += (k > 0 ? "L" : "") + at(h.corners[k]);
    return d + 'Z';
  }
  std::string cell(const Hexagon& h) const {
    std::string out = "<path class=\"cell c" + std::to_string(h.patch % colours) + "\" d=\"" + outline(h) +
                      "\"><title>cell " + std::to_string(h.id) + "</title></path>";
    if (h.masked)
      out += "<path class=\"cross\" d=\"M" + at(h.corners[0]) + 'L' + at(h.corners[3]) + 'M' +
             at(h.corners[1]) + 'L' + at(h.corners[4]) + "\"/>";
    if (h.in_region && !h.masked) {
      const auto [x, y] = seen(h.middle);
      out += "<circle class=\"dot\" cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"2.2\"/>";
    }
    return out + '\n';
  }
  /// The links: from each joint to the axis of its cells, along it, and to the next joint.
  std::string bones() const {
    std::string out;
    for (std::size_t i = 0; i < pose_.p.size(); ++i) {
      if (pose_.parents[i] >= 0) {
        const auto parent = static_cast<std::size_t>(pose_.parents[i]);
        out += bone(parent, pose_.p[parent], pose_.p[i]);
      } else {
        out += "<path class=\"bone\" d=\"M" + at({0, 0, 0}) + 'L' + at(pose_.p[i]) + "\"/>";
      }
    }
    for (const Vec& p : pose_.p) {
      const auto [x, y] = seen(p);
      out += "<circle class=\"joint\" cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"4\"/>";
    }
    return out + '\n';
  }

  std::string bone(std::size_t link, const Vec& from, const Vec& to) const {
    // The normals of a tube's cells are square to its axis; those of a flat patch have no axis.
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Vec middle{0, 0, 0};
    double n = 0;
    for (const Hexagon& h : cells_) {
      if (h.link != link) continue;
      const Eigen::Vector3d normal(h.normal.x, h.normal.y, h.normal.z);
      squares += normal * normal.transpose();
      middle = middle + h.middle;
      n += 1;
    }
    std::string d = "M" + at(from);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares);
    if (n > 0 && solver.eigenvalues()[0] < 0.1 * n && solver.eigenvalues()[1] > 0.2 * n) {
      const Eigen::Vector3d v = solver.eigenvectors().col(0);
      const Vec axis{v[0], v[1], v[2]}, c = (1 / n) * middle;
      for (const Vec& end : {from, to}) d += 'L' + at(c + dot(end - c, axis) * axis);
    }
    return "<path class=\"bone\" d=\"" + d + 'L' + at(to) + "\"/>";
  }

  const View& view_;
  const std::vector<Hexagon>& cells_;
  const Pose& pose_;
  double left_ = 1e9, right_ = -1e9, low_ = 1e9, high_ = -1e9, x_ = 0, y_ = 0;
};

const char* const style = R"css(<style>
svg{--ink:#1c2733;--soft:#5b6b7b;--card:#fff;--line:#c3ccd6;font:14px system-ui,sans-serif}
@media(prefers-color-scheme:dark){svg{--ink:#e6edf3;--soft:#9aa7b5;--card:#12181f;--line:#3d4957}}
.card{fill:var(--card)}text{fill:var(--ink)}.title{font-size:17px;font-weight:600}.name,.note{fill:var(--soft)}
.cell{stroke:var(--card);stroke-width:.9}.far{fill:none;stroke:var(--line);stroke-width:.8}
.bone{stroke:var(--soft);stroke-width:9;stroke-linecap:round;stroke-linejoin:round;fill:none;opacity:.35}.joint{fill:var(--card);stroke:var(--soft);stroke-width:2}
.cross{stroke:var(--ink);stroke-width:1.6;fill:none}.dot{fill:var(--ink)}.ruler{stroke:var(--soft);stroke-width:1.5;fill:none}
.c0{fill:#3b7dd8}.c1{fill:#e08a1e}.c2{fill:#2f9e6e}.c3{fill:#c2559d}.c4{fill:#7d6bd0}.c5{fill:#c4a000}.c6{fill:#3fa7c4}.c7{fill:#d1574b}
</style>
)css";

}  // namespace

Pose ur5_at(const std::vector<double>& q) {
  skinctl::require(q.size() == 6, "number of positions", double(q.size()), "6, one a joint");
  skinctl::JointPosition<6> at;
  for (std::size_t i = 0; i < 6; ++i) at[i] = q[i];
  const auto poses = skinctl::link_poses(skinctl::ur5::Model{}, at);
  Pose out;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((out.R.push_back(poses.template get<I>().axes()), out.p.push_back(poses.template get<I>().origin()),
      out.parents.push_back(int(I) - 1)),
     ...);
  }(std::make_index_sequence<6>{});
  return out;
}

Pose urdf_at(const skinctl::Urdf& urdf, const std::vector<double>& q) {
  const std::size_t n = urdf.joints.size();
  skinctl::require(q.size() == n, "number of positions", double(q.size()), "one for each joint that moves");
  const auto about_z = [](double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    return Rotation<double>{{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
  };
  std::vector<int> parents;
  std::vector<skinctl::JointKind> kinds;
  std::vector<skinctl::PlacedLink> links;
  for (const auto& joint : urdf.joints)
    parents.push_back(joint.parent), kinds.push_back(joint.kind), links.push_back(joint.placed);
  std::vector<skinctl::LinkParameters<double>> unused(n);
  std::vector<double> turn(n);
  skinctl::detail::canonicalise(n, parents.data(), kinds.data(), links.data(), unused.data(), turn.data());

  Pose given, out;  // in the file's frames, and in the model's
  for (std::size_t i = 0; i < n; ++i) {
    const auto& joint = urdf.joints[i];
    const auto parent = static_cast<std::size_t>(std::max(joint.parent, 0));
    const Rotation<double> R = joint.parent < 0 ? Rotation<double>{} : given.R[parent];
    const Vec p = joint.parent < 0 ? Vec{0, 0, 0} : given.p[parent];
    const bool turns = joint.kind == skinctl::JointKind::revolute;
    const Rotation<double> placed = R * joint.placed.R;
    const double* const at = joint.placed.p;
    given.R.push_back(turns ? placed * about_z(q[i]) : placed);
    given.p.push_back(p + R * Vec{at[0], at[1], at[2]} + (turns ? 0 : q[i]) * placed.z);
    out.R.push_back(given.R[i] * about_z(turn[i]));
    out.p.push_back(given.p[i]);
    out.parents.push_back(joint.parent);
  }
  return out;
}

std::string picture(const SkinFile& file, const std::vector<skinctl::PlacedSkinPatch>& placed,
                    const Pose& pose) {
  const auto cells = hexagons(file, placed, pose);
  const double a = 0.6, c = std::cos(a), s = std::sin(a), tilt = 0.25, u = std::cos(tilt), v = std::sin(tilt);
  // Opposite directions, so that each cell faces one of the viewers.
  const Vec right{c, s, 0}, up{-v * s, v * c, u}, viewer{u * s, -u * c, v};
  const View views[2] = {{"from the front and above", right, up, viewer},
                         {"from behind and below", -right, up, -viewer}};
  const double scale =
      std::min(Drawing(views[0], cells, pose, 1e9).scale, Drawing(views[1], cells, pose, 1e9).scale);
  Drawing first(views[0], cells, pose, scale), second(views[1], cells, pose, scale);
  const double drawn = std::max(first.height, second.height), width = 2 * view_width + gap;
  const std::size_t lines = (file.patches.size() + 2) / 3;
  const bool masked = std::any_of(cells.begin(), cells.end(), [](const Hexagon& h) { return h.masked; });
  const double height = top + drawn + 66 + row * static_cast<double>(lines + 1);

  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + ' ' +
                    number(height) + "\" role=\"img\">\n" + style +
                    "<rect class=\"card\" width=\"100%\" height=\"100%\" rx=\"8\"/>\n";
  out += "<text class=\"title\" x=\"" + number(margin) + "\" y=\"28\">" +
         skinctl::xml_text(std::to_string(file.cells()) + " cells in " + std::to_string(file.patches.size()) +
                           (file.patches.size() == 1 ? " patch" : " patches")) +
         "</text>\n";
  out += first.svg(0, top) + second.svg(view_width + gap, top);

  double y = top + drawn + 34;
  const double mm100 = 0.1 * first.scale;
  out += "<path class=\"ruler\" d=\"M" + number(margin) + ' ' + number(y - 4) + "v8m0 -4h" + number(mm100) +
         "m0 -4v8\"/><text class=\"note\" x=\"" + number(margin + mm100 + 8) + "\" y=\"" + number(y + 5) +
         "\">100 mm</text>";
  std::string note = "outlined: cells that look away";
  if (!file.regions.empty()) note += " \u00b7 dot: in a region";
  if (masked) note += " \u00b7 cross: masked";
  out += "<text class=\"note\" x=\"" + number(width - margin) + "\" y=\"" + number(y + 5) +
         "\" text-anchor=\"end\">" + skinctl::xml_text(note) + "</text>\n";
  y += 30;
  const double column = (width - 2 * margin) / 3;
  for (std::size_t k = 0; k < file.patches.size(); ++k) {
    const auto& patch = file.patches[k];
    const double x = margin + column * static_cast<double>(k % 3),
                 line = y + row * static_cast<double>(k / 3);
    std::string name = patch.name + ": " + std::to_string(patch.cells.size()) + " on " + patch.link;
    if (name.size() > 44) name = name.substr(0, 41) + "...";
    out += "<rect class=\"c" + std::to_string(k % colours) + "\" x=\"" + number(x) + "\" y=\"" +
           number(line - 11) + "\" width=\"13\" height=\"13\" rx=\"3\"/><text x=\"" + number(x + 20) +
           "\" y=\"" + number(line) + "\">" + skinctl::xml_text(name) + "</text>\n";
  }
  return out + "</svg>\n";
}

}  // namespace skin_file
