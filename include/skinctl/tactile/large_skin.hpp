// LargeSkin: up to a million cells, received beside the cycle, and the touch that a cycle takes from it.
#pragma once

#include "skinctl/tactile/detail/heap_store.hpp"
#include "skinctl/tactile/detail/summand.hpp"
#include "skinctl/tactile/skin_of.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
/// `to += factor from`, in double.
template <class A, class B>
SKINCTL_INLINE void add_scaled(A& to, double factor, const B& from) noexcept {
  for (std::size_t k = 0; k < A::count; ++k)
    for (std::size_t r = 0; r < 6; ++r) to.data[k][r] += factor * static_cast<double>(from.data[k][r]);
}
/// `factor (later - earlier)`, in the scalar of `W`.
template <class W, class A>
[[nodiscard]] SKINCTL_INLINE W mean_of(const A& later, const A& earlier, double factor) noexcept {
  W mean;
  for (std::size_t k = 0; k < A::count; ++k)
    for (std::size_t r = 0; r < 6; ++r)
      mean.data[k][r] = static_cast<typename W::scalar>(factor * (later.data[k][r] - earlier.data[k][r]));
  return mean;
}
}  // namespace detail

/// What a `LargeSkin` has to say to one cycle: small, whatever the number of its cells.
template <class W>
struct LargeSkinReport {
  using Total = LinkWrenches<typename W::model_type, W::links, double>;
  Nanoseconds from = Nanoseconds::min();  ///< end of the report before it
  Nanoseconds to = Nanoseconds::min();    ///< end of the time that it is about; `min`: of no time
  TouchWrenches<W> mean;                  ///< mean wrenches from then to now [N], [N m]
  TouchWrenches<W> held;                  ///< wrenches that are held at `to` [N], [N m]
  TouchWrenches<Total>
      impulse;    ///< of the pushes since the start [N s], [N m s]: no report that is lost lacks in it
  Status status;  ///< what `Skin::receive` gave
};

/// A skin of any number of cells that stays out of the memory that a cycle copies: its records lie on the
/// heap, and it is a function of its samples from its start on. It gives the same as a `Skin` of the same
/// cells (see there), and patches may have more than 8192 cells: each 8192 have a sum of their own, so all
/// stay exact.
///
///     LargeSkin<ur5::Model> skin(patches);
///     Cycle cycle(arm, LargeSkinTouch<ur5::Model>(), law);
///     input.sensed = skin.take(samples, now);   // then cycle.step(memory, input)
///
/// `take` allocates nothing and is bounded: per sample a constant, and 3 bits a cell to see which are silent.
/// @tparam Tuned  whether cells may have gains and thresholds of their own; 16 bytes a cell more.
template <Topology M, Real T = double, LinkMask Links = all_links(M::joints), bool Tuned = false>
class LargeSkin {
  struct Cells : detail::SkinCore<M, T, Links, detail::HeapStore, Tuned> {
    using Core = detail::SkinCore<M, T, Links, detail::HeapStore, Tuned>;
    SKINCTL_COLD Cells(const std::vector<SkinPatch>& patches, const SkinSettings& settings)
        : Core(settings, detail::count_cells(patches)) {
      require(detail::count_cells(patches) > 0, "LargeSkin: cells", 0, ">= 1");
      detail::add_patches<typename Core::Wrenches>(this->tables_, patches);
    }
  };

 public:
  using Wrenches = typename Cells::Wrenches;
  using Report = LargeSkinReport<Wrenches>;

  /// Throws `ConfigurationError` for what `SkinOf` refuses, except numbers of cells and patches: of cells there
  /// may be as many as ids, 2^20.
  SKINCTL_COLD explicit LargeSkin(const std::vector<SkinPatch>& patches, const SkinSettings& settings = {})
      : cells_(patches, settings), memory_(cells_.start(Nanoseconds::min())) {}

  /// Forgets all samples; the next report begins at `now`. Allocates.
  SKINCTL_COLD void start(Nanoseconds now) {
    memory_ = cells_.start(now);
    impulse_ = {};
    at_ = now;
  }
  /// Takes the samples that arrived up to `to`. Its first report, unless after `start`, begins at `to`.
  [[nodiscard]] Report take(std::span<const CellSample> samples, Nanoseconds to) noexcept {
    const Nanoseconds from = at_ == Nanoseconds::min() || to < at_ ? to : at_;
    if (memory_.begin == Nanoseconds::min()) memory_.begin = to;
    Report out;
    out.status = cells_.receive(memory_, samples, from, to, 1, &out.mean);
    const double whole = seconds<double>(detail::elapsed(from, to));
    detail::add_scaled(impulse_.force, whole, out.mean.force);
    detail::add_scaled(impulse_.proximity, whole, out.mean.proximity);
    out.impulse = impulse_;
    out.from = from;
    out.held = cells_.touch(memory_);
    out.to = at_ = to;
    return out;
  }

  /// The cells, with all members of a `Skin` that do not change a memory; and the memory for them.
  [[nodiscard]] const auto& cells() const noexcept { return cells_; }
  [[nodiscard]] const auto& memory() const noexcept { return memory_; }
  /// Bytes of records, sums and tables [B].
  [[nodiscard]] std::size_t bytes() const noexcept {
    return memory_.records.size() * sizeof(memory_.records[0]) +
           memory_.sums.size() * sizeof(memory_.sums[0]) +
           memory_.oldest.size() * (sizeof(memory_.oldest[0]) + sizeof(memory_.states[0])) +
           cells_.table_bytes();
  }

 private:
  Cells cells_;
  typename Cells::Memory memory_;
  TouchWrenches<typename Report::Total> impulse_{};
  Nanoseconds at_ = Nanoseconds::min();
};

/// The touch that a cycle takes from the reports of a `LargeSkin<M, T, Links>`, in the place of a skin.
///
/// The impulse of all reports arrives, whatever the intervals of cycles and reports: where no report has come
/// the last held wrenches go on, and the next report makes up for the difference. Without a report for
/// `max_age` nothing is felt (`sample_stale`), and nothing is made up for afterwards.
///
/// It tells no contacts apart: those are one wrench a link; and `nearest` is 1.
template <Topology M, Real T = double, LinkMask Links = all_links(M::joints)>
class LargeSkinTouch : public sensor_sums::Summand {
 public:
  using scalar = T;
  using Wrenches = LinkWrenches<M, Links, T>;
  using Touch = TouchWrenches<Wrenches>;
  using Sensed = LargeSkinReport<Wrenches>;
  static constexpr LinkMask links = Links;
  struct Memory {
    Nanoseconds to = Nanoseconds::min();  ///< end of the last report; `min`: nothing is felt
    Touch held{};                         ///< its held wrenches
    /// Impulse that was reported, and that has been given, since the first report [N s], [N m s].
    TouchWrenches<typename Sensed::Total> reported{}, given{};
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  /// Throws `ConfigurationError` unless `max_age` > 0.
  SKINCTL_COLD explicit LargeSkinTouch(Nanoseconds max_age = 50ms) : max_age_(max_age) {
    require(max_age > 0ns, "LargeSkinTouch: max_age", milliseconds(max_age), "> 0 ms");
  }
  [[nodiscard]] Memory start(Nanoseconds) const noexcept { return {}; }

  /// Takes a report that is later than the last one, and gives the mean touch over each of `parts` >= 1 equal
  /// parts of `(from, to]`: the same for each. A report with a NaN is refused (`sample_not_finite`).
  template <class State, class Means>
  Status receive(Memory& memory, std::span<const CellSample>, const Sensed& report, const State&,
                 Nanoseconds from, Nanoseconds to, std::size_t parts, Means* means) const noexcept {
    SKINCTL_EXPECTS(parts > 0 && means != nullptr, "at least one part of the interval");
    if (memory.to > to) memory.to = to;  // the clock was set back
    if (detail::elapsed(memory.to, to) >= max_age_) memory = {};
    Status status;
    bool fresh = false;
    if (report.to > to || detail::elapsed(report.to, to) >= max_age_) {
      status = memory.to == Nanoseconds::min() ? Reason::sample_stale : Status{};
    } else if (!finite(report)) {
      status = Reason::sample_not_finite;
    } else if (report.to > memory.to) {
      status = report.status;
      const bool first = memory.to == Nanoseconds::min();
      memory.held = report.held;
      memory.reported = report.impulse;
      memory.to = report.to;
      fresh = true;
      if (first) {  // what was before its time is not made up for, nor a time that is too long
        const bool brief = detail::elapsed(report.from, report.to) < max_age_;
        const double whole = seconds<double>(detail::elapsed(report.from, report.to));
        memory.given = report.impulse;
        if (brief) detail::add_scaled(memory.given.force, -whole, report.mean.force);
        if (brief) detail::add_scaled(memory.given.proximity, -whole, report.mean.proximity);
        fresh = brief;
      }
    }
    const double whole = seconds<double>(detail::elapsed(from, to));
    Touch mean = memory.held;
    if (whole > 0) {
      if (fresh) {
        mean = {detail::mean_of<Wrenches>(memory.reported.force, memory.given.force, 1 / whole),
                detail::mean_of<Wrenches>(memory.reported.proximity, memory.given.proximity, 1 / whole)};
      }
      detail::add_scaled(memory.given.force, whole, mean.force);
      detail::add_scaled(memory.given.proximity, whole, mean.proximity);
    } else {
      status |= Reason::interval_empty;
    }
    for (std::size_t j = 0; j < parts; ++j) {
      if constexpr (std::is_same_v<Means, Touch>) {
        means[j] = mean;
      } else {
        means[j] = mean.total();
      }
    }
    return status;
  }

  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept { return memory.held.total(); }
  [[nodiscard]] Touch touch(const Memory& memory) const noexcept { return memory.held; }
  /// Somebody may be at any distance.
  template <std::size_t I>
  [[nodiscard]] T nearest(const Memory&) const noexcept {
    return T(1);
  }

 private:
  static bool finite(const Sensed& report) noexcept {
    double none = 0;  // NaN as soon as one of them is not finite
    const auto look = [&](const auto& wrenches) {
      for (const auto& row : wrenches.data)
        for (const auto& x : row) none += static_cast<double>(x - x);
    };
    look(report.mean.force), look(report.mean.proximity);
    look(report.held.force), look(report.held.proximity);
    look(report.impulse.force), look(report.impulse.proximity);
    return none == 0;
  }
  Nanoseconds max_age_;
};

SKINCTL_END_NAMESPACE
