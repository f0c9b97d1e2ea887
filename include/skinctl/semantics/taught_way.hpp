// SPDX-License-Identifier: BSD-3-Clause
// The way of a tool in use: found in the path of a hand, and kept as corners that straight lines join.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "skinctl/core/triple.hpp"
#include "skinctl/semantics/task.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The way of a hand that uses a tool: corners, joined by straight lines. A value, trivially copyable.
struct TaughtWay {
  static constexpr std::size_t capacity = 32;
  std::array<Xyz<double>, capacity>
      corners{};          ///< positions in the frame of the hand at its place of use [m]
  std::uint8_t size = 0;  ///< number of corners; 0: no way is known
};
/// The way of a tool in use, at each place of a task; others are empty.
using TaughtWays = std::array<TaughtWay, TaughtTask<1>::max_places>;

namespace detail {
/// The samples `from` to `to - 1` of a path, from the first to the last one in the ball in which a tool is
/// used.
struct UsedSpan {
  std::size_t centre = 0, from = 0, to = 0;
  double radius = 0;  ///< radius of the ball about the sample `centre` [m]; 0: no tool is used
};

/// The use of a tool between two samples of the path `p`: the ball in which the path is longest, with a
/// radius of `share` of how far the tool is carried, if its path there exceeds `min_path` radii.
[[nodiscard]] inline UsedSpan used_span(const std::vector<Xyz<double>>& p, std::size_t begin, std::size_t end,
                                        double share, double min_path) {
  double carried = 0;
  for (std::size_t i = begin; i < end; ++i) carried = std::max(carried, norm(Xyz<double>(p[i] - p[begin])));
  UsedSpan out{begin, begin, begin, share * carried};
  const auto inside = [&](std::size_t i, std::size_t c) {
    return norm(Xyz<double>(p[i] - p[c])) < out.radius;
  };
  double longest = 0;
  const std::size_t stride = 1 + (end - begin) / 200;
  for (std::size_t c = begin; c < end; c += stride) {
    double way = 0;
    for (std::size_t i = begin + 1; i < end; ++i)
      if (inside(i, c)) way += norm(Xyz<double>(p[i] - p[i - 1]));
    if (way > longest) longest = way, out.centre = c;
  }
  if (!(longest > min_path * out.radius)) return {};
  out.to = end;
  while (!inside(out.from, out.centre)) ++out.from;
  while (!inside(out.to - 1, out.centre)) --out.to;
  return out;
}

/// `s` without the ways that lead to where the tool is used and away: these are further from the middle of
/// the path `p` than its middle half, in time, gets.
[[nodiscard]] inline UsedSpan without_ends(const std::vector<Xyz<double>>& p, UsedSpan s) {
  constexpr double margin = 1.1;  // on the largest distance of the middle half
  const std::size_t quarter = (s.to - s.from) / 4, begin = s.from + quarter, end = s.to - quarter;
  Xyz<double> middle{0, 0, 0};
  for (std::size_t i = begin; i < end; ++i) middle = middle + (1.0 / static_cast<double>(end - begin)) * p[i];
  const auto far = [&](std::size_t i) { return norm(Xyz<double>(p[i] - middle)); };
  double most = 0;
  for (std::size_t i = begin; i < end; ++i) most = std::max(most, margin * far(i));
  while (s.from < begin && far(s.from) > most) ++s.from;
  while (s.to > end && far(s.to - 1) > most) --s.to;
  return s;
}

/// Adds the samples between `a` and `b` without which the way is further than `tolerance` from its path `p`,
/// until there are more corners than a way has.
inline void add_corners(const std::vector<Xyz<double>>& p, std::size_t a, std::size_t b, double tolerance,
                        std::vector<std::size_t>& corners) {
  if (corners.size() > TaughtWay::capacity) return;
  const Xyz<double> way = p[b] - p[a];
  const double square = dot(way, way);
  std::size_t farthest = a;
  double most = tolerance;
  for (std::size_t i = a + 1; i < b; ++i) {
    const Xyz<double> off = p[i] - p[a];
    const double s = square > 0 ? std::clamp(dot(off, way) / square, 0.0, 1.0) : 0.0;
    const double far = norm(Xyz<double>(off - s * way));
    if (far > most) most = far, farthest = i;
  }
  if (farthest == a) return;
  corners.push_back(farthest);
  add_corners(p, a, farthest, tolerance, corners);
  add_corners(p, farthest, b, tolerance, corners);
}
}  // namespace detail

/// The way whose corners are as few points of `path` as stay within `tolerance` [m] of all of them; a larger
/// tolerance where there are too many corners. Ramer, Douglas, Peucker. Empty for fewer than two points.
[[nodiscard]] inline TaughtWay taught_way(const std::vector<Xyz<double>>& path, double tolerance = 0.004) {
  TaughtWay out;
  if (path.size() < 2) return out;
  constexpr double coarser = 1.25;
  std::vector<std::size_t> corners;
  do {
    corners = {0, path.size() - 1};
    detail::add_corners(path, 0, path.size() - 1, tolerance, corners);
    tolerance *= coarser;
  } while (corners.size() > TaughtWay::capacity);
  std::sort(corners.begin(), corners.end());
  for (const std::size_t i : corners) out.corners[out.size++] = path[i];
  return out;
}

SKINCTL_END_NAMESPACE
