// How a UR5 stood and was pushed during a run, for the top of a picture.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "examples/support/svg_plot.hpp"
#include "examples/support/text.hpp"
#include "examples/support/ur5_shape.hpp"

namespace examples {

/// An instant of a run.
struct SeenPose {
  skinctl::JointPosition<6> q;
  bool pushed = false;              ///< somebody pushes
  skinctl::Xyz<double> at, normal;  ///< place of the push and the skin's normal there [m, base's frame]
};

namespace sketching {
constexpr double height = 230, scale = 210;  // [px], [px/m]

/// From the side or from above; the arm stands at `foot` of its half.
struct View {
  const char* name;
  double foot_x, foot_y;
  bool above;
  std::string operator()(const skinctl::Xyz<double>& p) const {
    return text("%.1f %.1f", foot_x - scale * p.x, foot_y - scale * (above ? -p.y : p.z));
  }
};

inline std::string arm(const View& view, const SeenPose& pose, const char* kind) {
  std::string out = std::string("<g class=\"") + kind + "\">";
  auto links = ur5_capsules(ur5_poses(pose.q));
  std::stable_partition(links.begin(), links.end(), [](const Capsule& c) { return !c.covered; });
  for (const Capsule& c : links)
    out += "<path d=\"M" + view(c.from) + 'L' + view(c.to) +
           text("\" stroke-width=\"%.1f\"/>", 2 * scale * c.radius);
  return out + "</g>";
}
inline std::string hand(const View& view, const SeenPose& pose) {
  return "<path class=\"hand\" d=\"M" + view(pose.at + 0.18 * pose.normal) + 'L' +
         view(pose.at + 0.02 * pose.normal) + "\"/>";
}
}  // namespace sketching

/// The pose at the beginning, at the end of the first push, and at the end, from two sides.
inline plotting::Head sketch(const std::vector<SeenPose>& seen) {
  if (seen.empty()) return {};
  const auto first = std::find_if(seen.begin(), seen.end(), [](const SeenPose& p) { return p.pushed; });
  const auto last = std::find_if(first, seen.end(), [](const SeenPose& p) { return !p.pushed; });
  plotting::Head out;
  out.height = sketching::height + 26;
  out.style =
      ".sketch path{fill:none;stroke-linecap:round}.sketch .begin{stroke:#d0d7de}"
      ".sketch .pushed{stroke:#f2cc8f}.sketch .end{stroke:#1662d2;opacity:.75}"
      ".sketch .hand{stroke:#9a6700;stroke-width:9}"
      "@media(prefers-color-scheme:dark){.sketch .begin{stroke:#30363d}.sketch .pushed{stroke:#6b4e16}"
      ".sketch .end{stroke:#58a6ff}.sketch .hand{stroke:#e3b341}}";
  out.svg = "<g class=\"sketch\">";
  for (const sketching::View& view :
       {sketching::View{"from the side", 150, 220, false}, sketching::View{"from above", 630, 130, true}}) {
    out.svg += text("<text x=\"%.0f\" y=\"16\">%s</text>", view.foot_x - 150, view.name) +
               sketching::arm(view, seen.front(), "begin");
    if (last != first) out.svg += sketching::arm(view, *(last - 1), "pushed");
    out.svg += sketching::arm(view, seen.back(), "end");
    if (last != first) out.svg += sketching::hand(view, *first);
  }
  out.svg += std::string("</g><text x=\"0\" y=\"") + std::to_string(int(sketching::height) + 14) +
             "\">grey: at the beginning" + (last != first ? "; yellow: when the push ends" : "") +
             "; blue: at the end</text>";
  return out;
}

}  // namespace examples
