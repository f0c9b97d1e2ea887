// The preparation of a skin's message.
#pragma once

#include <cmath>

#include "skinctl/io/skin_cloud.hpp"

SKINCTL_BEGIN_NAMESPACE

SKINCTL_COLD inline SkinCloud::SkinCloud(const std::vector<Cell>& cells, const Options& options)
    : options_(options) {
  require(cells.size() <= most_cells, "SkinCloud: cells", double(cells.size()), "0 to 2^20");
  require(options.newtons > 0 && options.newtons <= 1e6f, "SkinCloud: newtons", double(options.newtons),
          "> 0 to 1e6 N");
  require(options.max_age > 0ns && options.max_age <= 1s, "SkinCloud: max_age",
          double(options.max_age.count()) * 1e-9, "> 0 to 1 s");
  std::size_t slots = 2;
  while (slots < 2 * cells.size() + 2) slots *= 2, --shift_;
  slots_.resize(slots);
  std::vector<SkinPoint> points(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Cell& c = cells[i];
    require(hashed(c.id) == none, "SkinCloud: id of a cell", double(c.id), "given once");
    require(c.link < most_cells, "SkinCloud: link of a cell", double(c.link), "0 to 2^20 - 1");
    const float sum = c.position[0] + c.position[1] + c.position[2];
    require(std::isfinite(sum), "SkinCloud: place of a cell", double(sum), "finite m");
    std::size_t k = c.id * 0x9e3779b1u >> shift_;
    while (slots_[k].index != free_slot) k = (k + 1) & (slots - 1);
    slots_[k] = {c.id, static_cast<std::uint32_t>(i)};
    if (c.link >= links_.size()) links_.resize(c.link + 1);
    Range& range = links_[c.link];
    if (range.first == range.last) range = {i, i};
    require(range.last == i, "SkinCloud: cells of a link", double(c.link), "one after another");
    ++range.last;
    points[i].cell = c.id;
    points[i].position = c.position;
    homes_.push_back(c.position);
  }
  std::uint32_t highest = 0;
  for (const Cell& c : cells) highest = std::max(highest, c.id);
  if (highest < 8 * cells.size() + 1024) {
    direct_.assign(highest + 1, free_slot);
    for (std::size_t i = 0; i < cells.size(); ++i) direct_[cells[i].id] = static_cast<std::uint32_t>(i);
  }
  times_.assign(cells.size(), never);
  masks_.assign(cells.size(), 0);

  const std::span<const unsigned char> as_bytes(reinterpret_cast<const unsigned char*>(points.data()),
                                                points.size() * sizeof(SkinPoint));
  const ros::PointCloud cloud{0ns, options_.frame, SkinPoint::fields, sizeof(SkinPoint), as_bytes};
  CdrWriter measure{std::span<unsigned char>()};
  ros::encode(measure, cloud);
  size_ = measure.size();
  // Behind the points stands one byte, `is_dense`. They begin on a cache line, whatever the frame is called.
  const std::size_t head = size_ - as_bytes.size() - 1;
  first_point_ = (head + sizeof(Line) - 1) / sizeof(Line);
  before_ = first_point_ * sizeof(Line) - head;
  lines_.resize(first_point_ + cells.size() + 1);
  CdrWriter writer(bytes());
  ros::encode(writer, cloud);
}

SKINCTL_END_NAMESPACE
