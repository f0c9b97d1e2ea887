// SPDX-License-Identifier: BSD-3-Clause
// The cells of a skin as a point cloud: prepared once, each cycle writes what changed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/io/ros_messages.hpp"
#include "skinctl/sensing/cell_sample.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One cell of `/skin/cells`, as it lies there: a place, and a whole `CellSample`, so that another computer
/// can control with it.
struct SkinPoint {
  enum Status : std::uint32_t {
    stale = 1,  ///< older than `SkinCloud::max_age`, or never heard
    masked = 2  ///< the readings do not count
  };
  std::array<float, 3> position{};  ///< position in the base [m]
  float force = 0;         ///< sum of the force readings, times the scale [N]; without a scale their sum
  float proximity = 0;     ///< proximity reading, in [0, 1]
  float temperature = 0;   ///< temperature [C]
  std::uint32_t cell = 0;  ///< id of the cell
  std::uint32_t status = stale;
  std::array<float, 3> forces{};  ///< the three force readings, each in [0, 1]
  std::int32_t age = 0;  ///< age of the sample at the message's stamp [ns], limited to the range of its type
  std::array<float, 3> acceleration{};               ///< proper acceleration along the cell's axes [m/s^2]
  std::uint16_t measured = unsaid, unrest = unsaid;  ///< see `CellSample`

  static constexpr std::array<ros::PointField, 17> fields = {{{"x", 0},
                                                              {"y", 4},
                                                              {"z", 8},
                                                              {"force", 12},
                                                              {"proximity", 16},
                                                              {"temperature", 20},
                                                              {"cell", 24, ros::PointNumber::u32},
                                                              {"status", 28, ros::PointNumber::u32},
                                                              {"force1", 32},
                                                              {"force2", 36},
                                                              {"force3", 40},
                                                              {"age", 44, ros::PointNumber::i32},
                                                              {"ax", 48},
                                                              {"ay", 52},
                                                              {"az", 56},
                                                              {"measured", 60, ros::PointNumber::u16},
                                                              {"unrest", 62, ros::PointNumber::u16}}};
};
static_assert(std::is_standard_layout_v<SkinPoint> && sizeof(SkinPoint) == 64);

/// A skin as a message that stays prepared: `set` writes a sample, `place` moves the cells of a link,
/// `encode` stamps. Nothing is allocated after the construction; not for several threads at once.
class SkinCloud {
 public:
  /// A cell: where it is in its link [m], and the number of that link for `place`.
  struct Cell {
    std::uint32_t id = 0;
    std::uint32_t link = 0;
    std::array<float, 3> position{};
  };
  struct Options {
    std::string frame = "base_link";
    float newtons = 1;  ///< force for which a cell's readings add up to 1 [N]; 1: `force` is the sum itself
    Nanoseconds max_age = 100ms;  ///< older samples are marked as stale
  };

  /// The cells of a link must be neighbours in the list. Throws `ConfigurationError` for more than 2^20
  /// cells, an id that occurs twice, links that come twice or are 2^20 or more, a place that is not finite, a
  /// scale outside of (0, 1e6] N or an age outside of (0, 1] s.
  explicit SkinCloud(const std::vector<Cell>& cells) : SkinCloud(cells, Options()) {}
  SKINCTL_COLD SkinCloud(const std::vector<Cell>& cells, const Options& options) : options_(options) {
    require(cells.size() <= max_cells, "SkinCloud: cells", double(cells.size()), "0 to 2^20");
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
      require(c.link < max_cells, "SkinCloud: link of a cell", double(c.link), "0 to 2^20 - 1");
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
    // Behind the points stands one byte, `is_dense`. They begin on a cache line, whatever the frame is
    // called.
    const std::size_t head = size_ - as_bytes.size() - 1;
    first_point_ = (head + sizeof(Line) - 1) / sizeof(Line);
    before_ = first_point_ * sizeof(Line) - head;
    lines_.resize(first_point_ + cells.size() + 1);
    CdrWriter writer(bytes());
    ros::encode(writer, cloud);
  }

  [[nodiscard]] static const MessageType& type() { return ros::PointCloud::type(); }
  [[nodiscard]] std::size_t cells() const noexcept { return homes_.size(); }

  /// Takes the newest sample of a cell. False for an id that the skin does not have; then nothing changes.
  SKINCTL_INLINE bool set(const CellSample& s) noexcept {
    return set(std::span<const CellSample>(&s, 1)) == 0;
  }
  /// Takes several samples, the later ones newer. Returns how many have an id that the skin does not have.
  SKINCTL_INLINE std::size_t set(std::span<const CellSample> samples) noexcept {
    SkinPoint* const points = this->points();
    std::int64_t* const times = times_.data();
    const float newtons = options_.newtons;
    const std::span<const std::uint32_t> direct(direct_);
    std::size_t unknown = 0;
    for (const CellSample& s : samples) {
      const std::size_t i = index(direct, s.cell);
      if (i == none) [[unlikely]] {
        ++unknown;
        continue;
      }
      SkinPoint& point = points[i];
      point.force = newtons * (s.force[0] + s.force[1] + s.force[2]);
      point.proximity = s.proximity;
      point.temperature = s.temperature;
      point.forces = s.force;
      point.acceleration = s.acceleration;
      point.measured = s.measured, point.unrest = s.unrest;
      times[i] = s.time.count();
    }
    return unknown;
  }
  /// Sets whether a cell is masked: its readings do not count. Returns false for an unknown id.
  bool mask(std::uint32_t id, bool masked) noexcept {
    const std::size_t i = index(direct_, id);
    if (i == none) return false;
    masks_[i] = masked ? std::uint32_t(SkinPoint::masked) : 0u;
    return true;
  }
  /// Moves the cells of link `link`, which has the axes `R` and the origin `p` in the base [m]; links without
  /// cells are ignored.
  void place(std::uint32_t link, const Rotation<double>& R, const Xyz<double>& p) noexcept {
    if (link >= links_.size()) return;
    const auto f = [](double x) { return static_cast<float>(x); };
    const float x[3] = {f(R.x.x), f(R.x.y), f(R.x.z)}, y[3] = {f(R.y.x), f(R.y.y), f(R.y.z)},
                z[3] = {f(R.z.x), f(R.z.y), f(R.z.z)}, o[3] = {f(p.x), f(p.y), f(p.z)};
    SkinPoint* const points = this->points();
    for (std::size_t i = links_[link].first; i < links_[link].last; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        points[i].position[k] = x[k] * homes_[i][0] + y[k] * homes_[i][1] + z[k] * homes_[i][2] + o[k];
  }
  /// The message with the stamp `now`: ages and staleness of all cells are as of then. Valid until the next
  /// call.
  [[nodiscard]] std::span<const unsigned char> encode(Nanoseconds now) noexcept {
    CdrWriter stamp(std::span<unsigned char>(bytes()).first(cdr_header_size + 8));
    ros::encode(stamp, now);
    const std::int64_t at = held(now);
    const std::size_t n = times_.size(), whole = n - n % block;
    for (std::size_t i = 0; i < whole; i += block) age_cells<block>(i, block, at);
    if (whole < n) age_cells<0>(whole, n - whole, at);
    return bytes();
  }

 private:
  static constexpr std::size_t none = ~std::size_t(0), max_cells = std::size_t(1) << 20;
  static constexpr std::int64_t never = std::numeric_limits<std::int64_t>::min();
  static constexpr std::size_t block = 32;  // ages are computed so many at once, and then spread out
  struct Range {
    std::size_t first = 0, last = 0;
  };
  struct alignas(64) Line {
    unsigned char bytes[64];
  };

  /// `t`, limited to 73 years on either side of 0. The difference of such a time and any other one does not
  /// come around to an age of 32 bits.
  static std::int64_t held(Nanoseconds t) noexcept {
    constexpr std::int64_t most = std::int64_t(1) << 61;
    return std::clamp(t.count(), -most, most);
  }
  /// Writes ages and staleness of the cells from `first` on: `N` of them, or `n` where N is 0.
  template <std::size_t N>
  SKINCTL_INLINE void age_cells(std::size_t first, std::size_t n, std::int64_t at) noexcept {
    if constexpr (N > 0) n = N;
    constexpr std::uint64_t half = std::uint64_t(1) << 31;
    const std::int64_t* const times = times_.data() + first;
    const auto limit = static_cast<std::int32_t>(options_.max_age.count());  // at most 1 s
    std::int32_t ages[block];
    std::uint32_t status[block];
    std::uint64_t far = 0;  // not 0: an age has more than 32 bits
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint64_t age = static_cast<std::uint64_t>(at) - static_cast<std::uint64_t>(times[k]);
      far |= (age + half) >> 32;
      ages[k] = static_cast<std::int32_t>(static_cast<std::uint32_t>(age));
    }
    if (far != 0) [[unlikely]]
      for (std::size_t k = 0; k < n; ++k) ages[k] = held_age(at, times[k]);
    for (std::size_t k = 0; k < n; ++k)
      status[k] = masks_[first + k] | (ages[k] > limit ? std::uint32_t(SkinPoint::stale) : 0u);
    SkinPoint* const points = this->points() + first;
    for (std::size_t k = 0; k < n; ++k) {
      points[k].status = status[k];
      points[k].age = ages[k];
    }
  }
  static std::int32_t held_age(std::int64_t at, std::int64_t time) noexcept {
    using Limits = std::numeric_limits<std::int32_t>;
    // Beyond the range by more than it holds: `at` is within 2^61.
    if (time < at - std::int64_t(Limits::max())) return Limits::max();
    if (time > at - std::int64_t(Limits::min())) return Limits::min();
    return static_cast<std::int32_t>(at - time);
  }
  SKINCTL_INLINE std::size_t index(std::span<const std::uint32_t> direct, std::uint32_t id) const noexcept {
    if (id < direct.size()) [[likely]]
      return direct[id] == free_slot ? none : direct[id];
    return direct.empty() ? hashed(id) : none;
  }
  std::size_t hashed(std::uint32_t id) const noexcept {
    for (std::size_t k = id * 0x9e3779b1u >> shift_;; k = (k + 1) & (slots_.size() - 1)) {
      const Slot slot = slots_[k];  // half of the slots are free: it ends
      if (slot.index == free_slot) return none;
      if (slot.id == id) return slot.index;
    }
  }
  [[nodiscard]] std::span<unsigned char> bytes() noexcept { return {lines_.front().bytes + before_, size_}; }
  [[nodiscard]] SkinPoint* points() noexcept { return reinterpret_cast<SkinPoint*>(&lines_[first_point_]); }

  struct Slot {
    std::uint32_t id = 0, index = free_slot;
  };
  static constexpr std::uint32_t free_slot = ~std::uint32_t(0);

  Options options_;
  std::vector<std::array<float, 3>> homes_;
  std::vector<std::int64_t> times_;
  std::vector<std::uint32_t> masks_;  // 0, or SkinPoint::masked
  std::vector<Range> links_;
  std::vector<std::uint32_t> direct_;  // the place of each id, if ids are small; else `slots_`
  std::vector<Slot> slots_;
  unsigned shift_ = 31;
  std::vector<Line> lines_;      // the message; every point has a cache line of its own
  std::size_t before_ = 0;       // bytes before the message
  std::size_t size_ = 0;         // of the message
  std::size_t first_point_ = 0;  // its line
};

SKINCTL_END_NAMESPACE
