#include "examples/calibrate_skin/report.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>

#include "examples/support/report_style.hpp"
#include "examples/support/text.hpp"
#include "skinctl/calibration/turn.hpp"
#include "skinctl/core/xml_text.hpp"

namespace calibrate_skin {

using examples::text;

using namespace skinctl;

namespace {

const char* colour(std::size_t k) {
  static constexpr const char* all[] = {"#3b6ea5", "#c8742b", "#4c8c4a", "#9c4a6e", "#7a6bb0", "#8a7a3c"};
  return all[k % 6];
}

// The tree of the network: hops downwards, leaves side by side.
std::string tree_picture(const Json& net) {
  std::map<int, std::vector<int>> children;
  std::map<int, int> hops, label;
  for (const auto& c : net.at("cells")) {
    const int id = c.at("id").get<int>();
    children[c.at("parent").get<int>()].push_back(id);
    hops[id] = c.at("hops").get<int>();
    label[id] = c.at("label").get<int>();
  }
  for (auto& [id, own] : children)
    std::sort(own.begin(), own.end(), [&](int a, int b) { return label[a] < label[b]; });
  std::map<int, double> x;
  double next = 0;
  int deepest = 1;
  const std::function<double(int)> place = [&](int id) {
    double sum = 0;
    if (children[id].empty()) return x[id] = next++;
    for (const int c : children[id]) sum += place(c);
    return x[id] = sum / double(children[id].size());
  };
  hops[0] = 0;
  place(0);
  for (const auto& [id, h] : hops) deepest = std::max(deepest, h);
  const double wide = 1000 / std::max(1.0, next), high = std::min(34.0, 460.0 / deepest);
  std::string out = text("<svg viewBox='-12 -16 1024 %.0f' role='img' aria-label='tree of the network'>",
                         high * deepest + 34);
  for (const auto& [id, own] : children)
    for (const int c : own)
      out += text("<line x1='%.1f' y1='%.1f' x2='%.1f' y2='%.1f' stroke='#aaa'/>", wide * (x[id] + 0.5),
                  high * hops[id], wide * (x[c] + 0.5), high * hops[c]);
  std::map<int, std::size_t> patch;
  for (std::size_t k = 0; k < net.at("patches").size(); ++k)
    for (const auto& id : net.at("patches").at(k).at("ids")) patch[id.get<int>()] = k;
  const double r = std::clamp(0.36 * wide, 2.5, 9.0);
  for (const auto& [id, h] : hops)
    out += text("<circle cx='%.1f' cy='%.1f' r='%.1f' fill='%s'><title>%s</title></circle>",
                wide * (x[id] + 0.5), high * h, id == 0 ? 8.0 : r, id == 0 ? "#222" : colour(patch[id]),
                id == 0 ? "PC" : text("cell %d, label %d, %d hops", id, label[id], h).c_str());
  return out + "</svg>";
}

// Cells of a patch seen from a side and a little above; ellipses of their places' deviation, enlarged.
std::string patch_picture(const Json& patch, std::size_t k, double enlarged, const Eigen::Vector3d& from) {
  const Eigen::Vector3d z = from.normalized(),
                        x = Eigen::Vector3d::UnitZ().cross(z).norm() > 0.1
                                ? Eigen::Vector3d(Eigen::Vector3d::UnitZ().cross(z).normalized())
                                : Eigen::Vector3d::UnitX();
  Eigen::Matrix<double, 2, 3> P;
  P << x.transpose(), -z.cross(x).transpose();
  struct Drawn {
    double depth;
    std::string shape;
  };
  std::vector<Drawn> drawn;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (const auto& c : patch.at("cells")) {
    const FitPose X = pose_of(c.at("pose"));
    const bool known = c.at("unknown").get<std::string>().empty();
    std::string points;
    for (int i = 0; i < 6; ++i) {
      const double a = 1.0471975512 * i;
      const Eigen::Vector2d p =
          1e3 * P * (X * Eigen::Vector3d(0.0135 * std::cos(a), 0.0135 * std::sin(a), 0));
      low = low.cwiseMin(p), high = high.cwiseMax(p);
      points += text("%.1f,%.1f ", p.x(), p.y());
    }
    const double facing = X.R.col(2).dot(z);
    std::string shape = text(
        "<polygon points='%s' fill='%s' fill-opacity='%.2f' stroke='#333' stroke-width='0.4'%s><title>cell "
        "%d%s%s</title></polygon>",
        points.c_str(), facing > 0 ? colour(k) : "#ddd", facing > 0 ? 0.25 + 0.55 * facing : 0.5,
        known ? "" : " stroke-dasharray='2 2'", c.at("id").get<int>(), known ? "" : " ",
        xml_text(c.at("unknown").get<std::string>()).c_str());
    if (known && facing > 0 && !c.at("covariance").is_null()) {
      const Json& C = c.at("covariance");
      Eigen::Matrix3d place;
      place << C.at(0), C.at(1), C.at(2), C.at(1), C.at(6), C.at(7), C.at(2), C.at(7), C.at(11);
      const Eigen::Matrix2d seen = P * place * P.transpose();
      const double mean = 0.5 * seen.trace(), side = 0.5 * (seen(0, 0) - seen(1, 1)),
                   reach = std::hypot(side, seen(0, 1)), tilt = 0.5 * std::atan2(seen(0, 1), side);
      const Eigen::Vector2d at = 1e3 * P * X.p;
      shape += text(
          "<ellipse cx='%.1f' cy='%.1f' rx='%.2f' ry='%.2f' transform='rotate(%.1f %.1f %.1f)' fill='none' "
          "stroke='#b00020' stroke-width='0.7'/>",
          at.x(), at.y(), 1e3 * enlarged * std::sqrt(std::max(0.0, mean + reach)),
          1e3 * enlarged * std::sqrt(std::max(0.0, mean - reach)), 57.29578 * tilt, at.x(), at.y());
    }
    drawn.push_back({X.p.dot(z), shape});
  }
  std::sort(drawn.begin(), drawn.end(), [](const Drawn& a, const Drawn& b) { return a.depth < b.depth; });
  const Eigen::Vector2d size = high - low;
  std::string out = text("<svg viewBox='%.0f %.0f %.0f %.0f' role='img' aria-label='a patch'>", low.x() - 6,
                         low.y() - 6, size.x() + 12, size.y() + 12);
  for (const auto& d : drawn) out += d.shape;
  return out + "</svg>";
}

std::string table_of(const Json& unknown) {
  // Many cells of one patch with one reason are one line.
  std::map<std::string, std::pair<int, std::string>> lines;
  for (const auto& u : unknown) {
    std::string what = u.at("what").get<std::string>();
    if (what.rfind("cell ", 0) == 0) what = "cells: " + what.substr(what.find(' ', 5) + 1);
    if (const auto to = what.find(": to "); to != std::string::npos) what = what.substr(0, to);
    auto& line = lines[what];
    ++line.first, line.second = u.at("remedy").get<std::string>();
  }
  if (lines.empty()) return "<p>Everything was observable.</p>";
  std::string out = "<table><tr><th>what is not known</th><th>how often</th><th>what would show it</th></tr>";
  for (const auto& [what, line] : lines)
    out += "<tr><td>" + xml_text(what) + "</td><td>" + std::to_string(line.first) + "</td><td>" +
           xml_text(line.second.empty() ? "nothing that this method knows" : line.second) + "</td></tr>";
  return out + "</table>";
}

}  // namespace

std::string report_of(const fs::path& folder) {
  std::string out =
      "<!doctype html><html lang='en'><meta charset='utf-8'><meta name='viewport' "
      "content='width=device-width'><title>Calibration of a skin</title><style>" +
      std::string(examples::report_style) +
      "section{overflow-x:auto}section "
      "svg{display:block;width:100%;max-height:420px;background:var(--page)}h3{font-size:1rem;margin:14px 0 "
      "4px}"
      "td,th{text-align:left;white-space:normal}.row{display:grid;grid-template-columns:repeat(auto-fit,"
      "minmax(min(300px,100%),1fr));gap:14px}"
      "</style><main><h1>Calibration of a skin</h1>";
  const auto said = [&](const Json& j) {
    return "<p>" + xml_text(j.at("said").get<std::string>()) + ".</p>";
  };
  bool open = false;
  const auto part = [&](const char* title) {
    out += std::string(std::exchange(open, true) ? "</section>" : "") + "<section><h2>" + title + "</h2>";
  };
  const auto done = [&](const char* file) { return fs::exists(folder / file); };
  if (done("network.json")) {
    const Json net = read_json(folder / "network.json");
    part("Network");
    out += said(net) + tree_picture(net);
    for (const auto& c : net.at("complaints")) out += "<p>" + xml_text(c.get<std::string>()) + "</p>";
  }
  Json unknown = Json::array();
  if (done("shape.json")) {
    const Json shape = read_json(folder / "shape.json");
    part("Patches");
    out += said(shape) +
           "<p>Each from two sides. Red: one standard deviation of each cell's place, 50 times as large. "
           "Dashed: not known.</p>";
    std::size_t single = 0;
    for (std::size_t k = 0; k < shape.at("patches").size(); ++k) {
      const Json& p = shape.at("patches").at(k);
      if (p.at("cells").size() == 1) {  // nothing to see
        ++single;
        continue;
      }
      double place = 0, turn = 0;
      std::size_t known = 0;
      for (const auto& c : p.at("cells"))
        if (c.at("unknown").get<std::string>().empty()) {
          ++known;
          place = std::max(place, c.at("place_deviation").get<double>());
          turn = std::max(turn, c.at("turn_deviation").get<double>());
        }
      out += text("<h3>Patch of cell %d</h3><p>%zu cells, ", p.at("cells").at(0).at("id").get<int>(),
                  p.at("cells").size());
      if (known == 0)
        out += "none of which is known: what is drawn is a guess, and is not used.</p>";
      else
        out += text("%zu known, to %.2f mm and %.2f deg at worst; residual %.1f mg.</p>", known, 1e3 * place,
                    57.29578 * turn, 1e3 * p.at("residual").get<double>());
      out += "<div class='row'>" + patch_picture(p, k, 50, {0.6, -0.3, 1.2}) +
             patch_picture(p, k, 50, {-1, 0.5, -0.4}) + "</div>";
    }
    if (single > 0) out += text("<p>Besides these, single cells: %zu.</p>", single);
    for (const auto& u : shape.at("unobservable")) unknown.push_back(u);
  }
  if (done("lines.json")) {
    const Json motion = read_json(folder / "lines.json");
    part("Links and axes");
    out += said(motion);
    if (std::ifstream table(folder / "dh.txt"); table)
      out += "<pre>" + xml_text(std::string(std::istreambuf_iterator<char>(table), {})) + "</pre>";
    out += "<table><tr><th>axis</th><th>direction</th><th>to [deg]</th><th>to [mm]</th></tr>";
    for (std::size_t j = 0; j < motion.at("lines").size(); ++j) {
      const Json& l = motion.at("lines").at(j);
      const Json &d = l.at("direction"), &a = l.at("direction_deviation"), &b = l.at("position_deviation");
      out += text("<tr><td>%zu</td><td>%.4f %.4f %.4f</td><td>%s</td><td>%s</td></tr>", j,
                  d.at(0).get<double>(), d.at(1).get<double>(), d.at(2).get<double>(),
                  a.is_null() ? "-" : text("%.3f", 57.29578 * a.get<double>()).c_str(),
                  b.is_null() ? "-" : text("%.2f", 1e3 * b.get<double>()).c_str());
    }
    out += "</table>";
    for (const auto& u : motion.at("unobservable")) unknown.push_back(u);
  }
  if (done("camera.json")) {
    const Json camera = read_json(folder / "camera.json");
    part("Patches on links");
    out += said(camera) +
           "<table><tr><th>patch</th><th>lights that agree</th><th>place to [mm]</th><th>turn to "
           "[deg]</th><th>motion says [mm], [deg]</th></tr>";
    for (const auto& p : camera.at("patches")) {
      const Json& C = p.at("covariance");
      const auto root = [&](std::size_t a, std::size_t b, std::size_t c) {
        return std::sqrt(C.at(a).get<double>() + C.at(b).get<double>() + C.at(c).get<double>());
      };
      std::string apart = "-";
      if (p.contains("motion_off"))
        apart = text("%.1f, %.2f", 1e3 * p.at("motion_off").at(0).get<double>(),
                     57.29578 * p.at("motion_off").at(1).get<double>());
      out += text("<tr><td>%zu%s</td><td>%d</td><td>%.2f</td><td>%.2f</td><td>%s</td></tr>",
                  p.at("patch").get<std::size_t>() + 1, p.at("known").get<bool>() ? "" : " (not used)",
                  p.value("agreeing", 0), 1e3 * root(0, 6, 11), 57.29578 * root(15, 18, 20), apart.c_str());
    }
    out += "</table>";
    for (const auto& u : camera.at("unobservable")) unknown.push_back(u);
  }
  if (done("masses.json")) {
    const Json masses = read_json(folder / "masses.json");
    part("Masses and friction");
    out += said(masses);
    if (masses.contains("bodies")) {
      out +=
          "<table><tr><th>joint</th><th>mass of its link [kg]</th><th>viscous [N m s/rad]</th><th>dry [N "
          "m]</th>"
          "<th>rotor [kg m&sup2;]</th><th>rest [N m]</th><th>R&sup2;</th><th>R&sup2; by the maker's "
          "bodies</th></tr>";
      const auto at = [&](const char* what, std::size_t i) { return masses.at(what).at(i).get<double>(); };
      for (std::size_t i = 0; i < 6; ++i)
        out += text(
            "<tr><td>%zu</td><td>%.2f</td><td>%.2f</td><td>%.2f</td><td>%.3f</td><td>%.2f</td>"
            "<td>%.4f</td><td>%.4f</td></tr>",
            i, masses.at("bodies").at(i).at(0).get<double>(), at("viscous", i), at("coulomb", i),
            at("rotor", i), at("noise", i), at("predicted", i), at("predicted_by_maker", i));
      out +=
          "</table><p>R&sup2; is of torques that the fit has not seen. A mass by itself may not be known: "
          "see "
          "below.</p>";
      if (masses.contains("following"))
        out +=
            "<table><tr><th>a simulated arm follows by torque, friction as found</th><th>rms of the joints "
            "[mrad]</th></tr>";
      for (const auto& [key, what] :
           {std::pair{"found", "with what was found"},
            std::pair{"maker_with_rotors", "with the maker's bodies and these rotors"},
            std::pair{"maker", "with the maker's bodies, which have no rotors"}})
        if (masses.contains("following"))
          out += text("<tr><td>%s</td><td>%.2f</td></tr>", what,
                      1e3 * masses.at("following").at(key).get<double>());
      if (masses.contains("following")) out += "</table>";
      for (const auto& u : masses.at("unobservable")) unknown.push_back(u);
    }
  }
  if (done("result.json")) {
    const Json result = read_json(folder / "result.json");
    part("Result");
    out += said(result) + "<p>Written to <code>skin.json</code>.</p>";
  }
  part("What was not observable");
  return out + table_of(unknown) + "</section></main></html>\n";
}

}  // namespace calibrate_skin
