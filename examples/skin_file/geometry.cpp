#include "examples/skin_file/geometry.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

#include "examples/support/text.hpp"

namespace skin_file {
namespace {

using namespace skinctl;
using examples::text;
using Vector = Eigen::Vector3d;

constexpr double coincident = 1e-3;                    // [m] the smallest taxels in use are 4 mm apart
constexpr double smallest_pitch = 1.5e-3, far = 0.15;  // [m] of cells of one patch
constexpr double longest_link = 2;                     // [m] from a link's frame to its skin
constexpr double clearly = 0.3;                        // of the largest: a bend that is no noise of places

struct Place {
  std::uint32_t id = 0;
  Vector p, n;
  Eigen::Matrix3d axes;
};
using Places = std::vector<Place>;

std::string patch_name(const SkinFile::Patch& patch) {
  return "patch '" + patch.name + "'";
}

/// Median distance of a cell to the nearest one; infinite for one cell.
double pitch_of(const Places& places) {
  std::vector<double> nearest(places.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = i + 1; j < places.size(); ++j) {
      const double d = (places[i].p - places[j].p).norm();
      nearest[i] = std::min(nearest[i], d), nearest[j] = std::min(nearest[j], d);
    }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

/// Pairs of cells of one link at the same place.
void find_coincident(Places places, std::vector<std::string>& out) {
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.p.x() < b.p.x(); });
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = i + 1; j < places.size() && places[j].p.x() - places[i].p.x() < coincident; ++j)
      if (const double d = (places[i].p - places[j].p).norm(); d < coincident)
        out.push_back(text("cells %u and %u coincide: they are %.2g mm apart",
                           std::min(places[i].id, places[j].id), std::max(places[i].id, places[j].id),
                           1e3 * d));
}

/// Cells whose normal points against those around them.
void find_flipped(const Places& places, double pitch, const std::string& where,
                  std::vector<std::string>& out) {
  for (const Place& a : places) {
    Vector around = Vector::Zero();
    for (const Place& b : places) {
      const Vector d = b.p - a.p;
      const bool beside = std::abs(d.dot(a.n)) < 0.5 * d.norm();  // the other side of a thin body is not
      if (b.id != a.id && d.norm() < 1.5 * pitch && beside) around += b.n;
    }
    if (around.dot(a.n) < -0.5 * around.norm() && around.norm() > 0.5)
      out.push_back(where + text(", cell %u: its normal points against those of the cells around it", a.id));
  }
}

/// How places and normals go together: on a body that bulges, whoever lies further along an axis looks
/// further along it.
void find_inward(const Places& places, const std::string& where, std::vector<std::string>& out) {
  if (places.size() < 4) return;
  Vector p = Vector::Zero(), n = Vector::Zero();
  for (const Place& c : places) p += c.p, n += c.n;
  p /= double(places.size()), n /= double(places.size());
  Eigen::Matrix3d together = Eigen::Matrix3d::Zero();
  for (const Place& c : places) together += (c.p - p) * (c.n - n).transpose();
  together = ((together + together.transpose()) / (2 * double(places.size()))).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(together);
  const Vector bends = solver.eigenvalues();       // [m], ascending
  if (bends.cwiseAbs().maxCoeff() < 1e-3) return;  // flat
  if (-bends(0) > clearly * bends.cwiseAbs().maxCoeff() && bends(2) < clearly * -bends(0)) {
    out.push_back(where + ": the normals of its cells point into the body");
  } else if (-bends(0) > clearly * bends(2)) {
    const Vector axis = solver.eigenvectors().col(0);
    out.push_back(where +
                  text(": mirrored along (%.2f, %.2f, %.2f): cells further along it look back along it",
                       axis.x(), axis.y(), axis.z()));
  }
}

/// Neighbours lie where the ports of a TUM cell are that name them: 1 (+, +), 2 (+, -), 3 (-, +), 4 (-, -) of
/// x and y.
void find_mirrored_ports(const SkinFile::Patch& patch, const Places& places, std::vector<std::string>& out) {
  std::unordered_map<std::uint32_t, const Place*> by_id;
  for (const Place& c : places) by_id[c.id] = &c;
  double x = 0, y = 0;
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t port = 0; port < patch.cells[i].neighbours.size(); ++port) {
      const auto other = by_id.find(patch.cells[i].neighbours[port]);
      if (other == by_id.end()) continue;
      const Vector d = (places[i].axes.transpose() * (other->second->p - places[i].p)).normalized();
      x += port < 2 ? d.x() : -d.x();
      y += port % 2 == 0 ? d.y() : -d.y();
    }
  if (x * y < 0)
    out.push_back(patch_name(patch) +
                  ": mirrored: neighbours lie on the other side of the ports that name them");
  else if (x < 0)
    out.push_back(patch_name(patch) + ": neighbours lie opposite of the ports that name them");
}

/// The units of one patch; false if its other numbers say nothing then.
bool units_fit(const SkinFile::Patch& patch, const Places& places, double pitch,
               std::vector<std::string>& out) {
  double largest = 0;
  for (const Place& c : places) largest = std::max(largest, c.p.norm());
  if (pitch < smallest_pitch && places.size() > 2)
    out.push_back(
        patch_name(patch) +
        text(": its cells are %.2g mm apart: were its numbers divided by 1000 twice?", 1e3 * pitch));
  else if (pitch > far && places.size() > 2)
    out.push_back(patch_name(patch) +
                  text(": its cells are %.3g m apart: are its numbers millimetres?", pitch));
  else if (largest > longest_link)
    out.push_back(patch_name(patch) +
                  text(": it lies %.3g m from the frame of its link: are its numbers millimetres?", largest));
  else
    return true;
  return false;
}

}  // namespace

std::vector<std::string> geometry_faults(const SkinFile& file, const std::vector<PlacedSkinPatch>& placed) {
  std::vector<std::string> out;
  std::map<std::string, Places> links;
  for (const PlacedSkinPatch& on : placed) {
    const SkinFile::Patch& patch = file.patches[on.patch];
    Places places;
    for (const auto& cell : on.cells) {
      const auto& o = cell.X_LC.origin();
      const Eigen::Matrix3d axes = as_eigen(cell.X_LC.axes());
      places.push_back({cell.id, {o.x, o.y, o.z}, axes.col(2), axes});
    }
    const double pitch = pitch_of(places);
    if (!units_fit(patch, places, pitch, out)) continue;
    find_flipped(places, pitch, patch_name(patch), out);
    find_mirrored_ports(patch, places, out);
    Places& all = links[patch.link];
    all.insert(all.end(), places.begin(), places.end());
  }
  for (const auto& [link, places] : links) {
    find_coincident(places, out);
    find_inward(places, "link '" + link + "'", out);
  }
  return out;
}

}  // namespace skin_file
