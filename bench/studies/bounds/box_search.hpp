// Best-first splitting of boxes: the largest proven error of a traced program over all of its inputs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <limits>
#include <utility>
#include <vector>

#include "bench/studies/proofs/traced_output.hpp"

namespace skinctl::bounds {

/// Processor time of this thread [s].
inline double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// An input of a program: `split` ones are halved, the others stay whole.
struct Range {
  math::Enclosure whole;
  bool split;
  float weight = 1;  ///< how wide it counts beside others: less than 1 for rates
};

/// The most inputs that one result may have split.
inline constexpr std::size_t most_split = 12;

/// A box of one result, and the proven errors there.
struct Piece {
  float key;  ///< in float, rounded up
  float in_double;
  std::uint32_t output;
  std::array<float, 2 * most_split> ends;  ///< lower and upper end of each split input; halving is exact
};

struct SearchResult {
  double in_float = 0, in_double = 0;  ///< proven
  std::size_t boxes = 0, evaluations = 0;
  double seconds = 0;
};

/// Best first: the box with the largest bound is halved along the input that gains most. Which one that is,
/// is tried where an input has not been halved at that width yet, and in one box of 64; else it is what
/// gained most at these widths so far, which leaves all lanes to boxes that stay.
class BoxSearch {
 public:
  using Output = math::TracedOutput;
  using L = Output::L;
  static constexpr std::size_t lanes = Output::lanes;

  /// @param ranges  of the inputs, for each output.
  BoxSearch(std::vector<Output>& outputs, std::vector<std::vector<Range>> ranges)
      : outputs_(outputs),
        ranges_(std::move(ranges)),
        heaps_(outputs.size()),
        gains_(outputs.size()),
        weights_(outputs.size()) {
    for (std::uint32_t k = 0; k < outputs_.size(); ++k) {
      Piece whole{};
      whole.output = k;
      std::size_t at = 0;
      for (const std::size_t i : outputs_[k].inputs())
        if (const Range& range = ranges_[k][i]; range.split && at < 2 * most_split) {
          whole.ends[at++] = -above(-range.whole.low);
          whole.ends[at++] = above(range.whole.high);
          weights_[k][at / 2 - 1] = range.weight;
        }
      joints_.push_back(at / 2);
      for (auto& gain : gains_[k]) gain.fill(-1);
      batch_.assign(1, whole);
      evaluate();
      heaps_[k].push_back(batch_[0]);
    }
  }

  /// Until nothing proven in float is above `goal`, or for `seconds` of processor time.
  SearchResult run(double goal, double seconds) {
    const double begin = processor_seconds();
    std::size_t evaluations = 0, held = heaps_.size();
    for (std::size_t step = 0; held < 4'000'000; ++step) {
      auto* worst = &heaps_[0];
      for (auto& heap : heaps_)
        if (!heap.empty() && (worst->empty() || heap.front().key > worst->front().key)) worst = &heap;
      if (worst->empty() || !(static_cast<double>(worst->front().key) > goal)) break;
      const std::size_t joints = joints_[worst->front().output];
      if (joints == 0) break;  // nothing to split: this is the bound
      if (step % 16 == 0 && processor_seconds() - begin > seconds) break;
      batch_.clear(), parents_.clear();
      for (std::size_t k = 0; k < lanes / 2 + 1 && !worst->empty(); ++k) {
        std::pop_heap(worst->begin(), worst->end(), less);
        const Piece piece = worst->back();
        worst->pop_back();
        const std::size_t joint = ++turn_ % 64 == 0 ? joints : likely(piece, joints);
        const bool tried = joint == joints;
        if (tried && k > 0) {  // a turn of its own
          worst->push_back(piece), std::push_heap(worst->begin(), worst->end(), less);
          break;
        }
        const float least = narrowest(piece, joints);
        for (std::size_t j = 0; j < joints; ++j)
          if (j == joint || (tried && width(piece, j) >= least)) halve(piece, j);
        if (tried || batch_.size() >= lanes) break;
      }
      evaluate();
      evaluations += batch_.size();
      keep(*worst, goal);
      held += parents_.size();
    }
    SearchResult out;
    out.in_float = settled_, out.in_double = settled_double_;
    for (const auto& heap : heaps_)
      for (const Piece& p : heap) {
        out.in_float = std::max(out.in_float, static_cast<double>(p.key));
        out.in_double = std::max(out.in_double, static_cast<double>(p.in_double));
      }
    out.boxes = boxes_;
    out.evaluations = evaluations;
    out.seconds = processor_seconds() - begin;
    return out;
  }

 private:
  struct Parent {
    Piece piece;
    std::size_t joint, level;
  };
  static constexpr std::size_t levels = 40;

  static float above(double x) noexcept {
    const auto y = static_cast<float>(x);
    return static_cast<double>(y) < x ? std::nextafter(y, std::numeric_limits<float>::infinity()) : y;
  }
  static bool less(const Piece& a, const Piece& b) noexcept { return a.key < b.key; }
  /// How often input `j` of a box has been halved.
  [[nodiscard]] static std::size_t level(const Piece& p, std::size_t j) noexcept {
    const float width = p.ends[2 * j + 1] - p.ends[2 * j];
    return std::min<std::size_t>(levels - 1,
                                 static_cast<std::size_t>(std::max(0.0f, std::round(4 - std::log2(width)))));
  }
  [[nodiscard]] float width(const Piece& p, std::size_t j) const noexcept {
    return weights_[p.output][j] * (p.ends[2 * j + 1] - p.ends[2 * j]);
  }
  /// Inputs that are much narrower than the widest one have to wait. (Half a turn gains nothing yet,
  /// whichever joint it is.)
  [[nodiscard]] float narrowest(const Piece& p, std::size_t joints) const noexcept {
    float widest = 0;
    for (std::size_t j = 0; j < joints; ++j) widest = std::max(widest, width(p, j));
    return widest * (widest > 1 ? 0.5f : 0.25f);
  }
  /// The input whose halving gained most at the widths of this box; `joints` where one is not known.
  [[nodiscard]] std::size_t likely(const Piece& p, std::size_t joints) const noexcept {
    std::size_t best = joints;
    float most = -1;
    const float least = narrowest(p, joints);
    for (std::size_t j = 0; j < joints; ++j) {
      if (width(p, j) < least) continue;
      const float gain = gains_[p.output][j][level(p, j)];
      if (gain < 0) return joints;
      if (gain > most) most = gain, best = j;
    }
    return best;
  }
  void halve(const Piece& piece, std::size_t j) {
    const float low = piece.ends[2 * j], middle = low + (piece.ends[2 * j + 1] - low) / 2;
    parents_.push_back({piece, j, level(piece, j)});
    batch_.push_back(piece);
    batch_.back().ends[2 * j + 1] = middle;
    batch_.push_back(piece);
    batch_.back().ends[2 * j] = middle;
  }
  /// Notes what halving gained, and keeps the halves of each box along its best input. What is below the goal
  /// is settled: only its largest bound is kept.
  void keep(std::vector<Piece>& heap, double goal) {
    for (std::size_t k = 0; k < parents_.size();) {
      const Piece& piece = parents_[k].piece;
      std::size_t best = k, next = k;
      float least = std::numeric_limits<float>::infinity();
      for (; next < parents_.size() && parents_[next].piece.ends == piece.ends; ++next) {
        const float a = batch_[2 * next].key, b = batch_[2 * next + 1].key;
        const float score = std::max(a, b) + 0.5f * std::min(a, b);
        const float gained = std::isfinite(score) ? std::max(0.0f, 1 - score / (1.5f * piece.key)) : 0;
        float& gain = gains_[piece.output][parents_[next].joint][parents_[next].level];
        gain = gain < 0 || !std::isfinite(gain) ? gained : gain + 0.1f * (gained - gain);
        if (score < least) least = score, best = next;
      }
      for (std::size_t b = 2 * best; b < 2 * best + 2; ++b) {
        Piece& half = batch_[b];
        half.key = std::min(half.key, piece.key);  // a part is no worse than the whole
        half.in_double = std::min(half.in_double, piece.in_double);
        ++boxes_;
        if (static_cast<double>(half.key) <= goal) {
          settled_ = std::max(settled_, static_cast<double>(half.key));
          settled_double_ = std::max(settled_double_, static_cast<double>(half.in_double));
        } else {
          heap.push_back(half), std::push_heap(heap.begin(), heap.end(), less);
        }
      }
      k = next;
    }
  }
  /// Errors of the batch, all of the same result.
  void evaluate() {
    Output& output = outputs_[batch_[0].output];
    const auto& ranges = ranges_[batch_[0].output];
    const auto& inputs = output.inputs();
    lows_.resize(inputs.size()), highs_.resize(inputs.size());
    for (std::size_t from = 0; from < batch_.size(); from += lanes) {
      const std::size_t held = std::min(lanes, batch_.size() - from);
      std::size_t split = 0;
      for (std::size_t i = 0; i < inputs.size(); ++i) {
        const Range& range = ranges[inputs[i]];
        const bool halved = range.split && split < most_split;
        double low[lanes], high[lanes];
        for (std::size_t w = 0; w < lanes; ++w) {
          const Piece& piece = batch_[from + std::min(w, held - 1)];
          low[w] = halved ? static_cast<double>(piece.ends[2 * split]) : range.whole.low;
          high[w] = halved ? static_cast<double>(piece.ends[2 * split + 1]) : range.whole.high;
        }
        lows_[i] = L::load(low), highs_[i] = L::load(high);
        split += halved;
      }
      const auto errors = output(lows_.data(), highs_.data());
      for (std::size_t w = 0; w < held; ++w) {
        batch_[from + w].key = static_cast<float>(errors.in_float[w] * (1 + 1e-6));
        batch_[from + w].in_double = static_cast<float>(errors.in_double[w] * (1 + 1e-6));
      }
    }
  }

  std::vector<Output>& outputs_;
  std::vector<std::vector<Range>> ranges_;
  std::vector<std::size_t> joints_;
  std::vector<std::vector<Piece>> heaps_;  // of each result
  std::vector<std::array<std::array<float, levels>, most_split>> gains_;
  std::vector<std::array<float, most_split>> weights_;
  std::vector<Piece> batch_;
  std::vector<Parent> parents_;
  std::vector<L> lows_, highs_;
  std::size_t turn_ = 0, boxes_ = 0;
  double settled_ = 0, settled_double_ = 0;
};

}  // namespace skinctl::bounds
