// SPDX-License-Identifier: BSD-3-Clause
// Samples of a skin from point clouds that another computer sent.
#pragma once

#include "skinctl/io/skin_cloud.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Takes the messages of a `SkinCloud` apart: the samples that are new since the message before.
///
/// Bytes are hostile: a message that is no PointCloud2 of one row with `SkinPoint::fields` (the last two
/// may be absent), is cut short, or has more points than the reader has room for, is refused and counted.
/// Readings are passed on as they are: the skin that takes them checks each sample. Nothing is allocated
/// after the construction.
class SkinCloudReader {
 public:
  /// Room for `most` cells. Throws `ConfigurationError` for 0 or more than 2^20.
  explicit SkinCloudReader(std::size_t most) {
    require(most > 0 && most <= (std::size_t(1) << 20), "SkinCloudReader: cells", double(most), "1 to 2^20");
    last_.resize(most);
    samples_.reserve(most);
  }

  /// The samples that `message` brings: those whose time is later than the last one of their cell, on the
  /// sender's clock, which the stamps of all topics share. Valid until the next call. A sample whose age is
  /// beyond what the message can say, 2.1 s, is left out.
  [[nodiscard]] std::span<const CellSample> read(std::span<const unsigned char> message) noexcept {
    samples_.clear();
    CdrReader r(message);
    const std::int64_t seconds = r.get<std::int32_t>();
    const Nanoseconds stamp(seconds * 1'000'000'000 + r.get<std::uint32_t>());
    static_cast<void>(r.text());
    const auto rows = r.get<std::uint32_t>(), points = r.get<std::uint32_t>();
    const std::size_t fields = r.count(13);
    const bool tells = fields == SkinPoint::fields.size();  // older senders: not of the measurements
    bool ours = rows == 1 && points <= last_.size() && (tells || fields == SkinPoint::fields.size() - 2);
    for (const ros::PointField& field : std::span(SkinPoint::fields).first(ours ? fields : 0)) {
      if (!ours) break;
      ours = r.text() == field.name && r.get<std::uint32_t>() == field.offset &&
             r.get<std::uint8_t>() == static_cast<std::uint8_t>(field.number) && r.get<std::uint32_t>() == 1;
    }
    ours = ours && !r.get<bool>() && r.get<std::uint32_t>() == sizeof(SkinPoint);
    const std::size_t size = std::size_t(points) * sizeof(SkinPoint);
    ours = ours && r.get<std::uint32_t>() == size && r.count(1) == size;
    const auto data = ours ? r.take(size) : std::span<const unsigned char>();
    static_cast<void>(r.get<bool>());
    if (!ours || !r.fits()) {
      ++refused_;
      return {};
    }
    for (std::size_t i = 0; i < points; ++i) {
      SkinPoint p;
      std::memcpy(&p, data.data() + i * sizeof p, sizeof p);
      if (!tells) p.measured = p.unrest = unsaid;
      constexpr auto most = std::numeric_limits<std::int32_t>::max();
      if (p.age >= most || p.age <= -most) continue;
      const Nanoseconds time = stamp - Nanoseconds(p.age);
      Last& last = last_[i];
      if (last.known && last.cell == p.cell && time <= last.time) continue;
      last = {time, p.cell, true};
      samples_.push_back(
          {time, p.cell, p.forces, p.proximity, p.acceleration, p.temperature, p.measured, p.unrest});
    }
    stamp_ = stamp;
    return samples_;
  }
  /// Stamp of the last message that was not refused.
  [[nodiscard]] Nanoseconds stamp() const noexcept { return stamp_; }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  struct Last {
    Nanoseconds time{};
    std::uint32_t cell = 0;
    bool known = false;
  };
  std::vector<Last> last_;  // by place in the message
  std::vector<CellSample> samples_;
  Nanoseconds stamp_{};
  std::uint64_t refused_ = 0;
};

SKINCTL_END_NAMESPACE
