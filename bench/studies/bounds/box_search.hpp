// Best-first splitting of boxes: the largest proven error of a traced program over all of its inputs.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <limits>
#include <vector>

#include "skinctl/math/traced_output.hpp"

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
};

/// The most inputs that one result may have split.
inline constexpr std::size_t most_split = 6;

/// A box of one result, and the proven errors there.
struct Piece {
  float key;  ///< in float, rounded up
  std::uint32_t output;
  double in_double;
  std::array<float, 2 * most_split> ends;  ///< lower and upper end of each split input; halving is exact
};

struct SearchResult {
  double in_float = 0, in_double = 0;  ///< proven
  std::size_t boxes = 0, evaluations = 0;
  double seconds = 0;
  std::vector<Piece> worst;  ///< those of the largest errors
};

class BoxSearch {
 public:
  using Output = math::TracedOutput;
  using L = Output::L;
  static constexpr std::size_t lanes = Output::lanes;

  BoxSearch(std::vector<Output>& outputs, const std::vector<Range>& ranges)
      : outputs_(outputs), ranges_(ranges) {
    for (std::uint32_t k = 0; k < outputs_.size(); ++k) {
      Piece whole{};
      whole.output = k;
      std::size_t at = 0;
      for (const std::size_t i : outputs_[k].inputs())
        if (ranges_[i].split && at < 2 * most_split) {
          whole.ends[at++] = static_cast<float>(ranges_[i].whole.low);
          whole.ends[at++] = static_cast<float>(ranges_[i].whole.high);
        }
      joints_.push_back(at / 2);
      batch_.assign(1, whole);
      evaluate();
      heap_.push_back(batch_[0]);
    }
    std::make_heap(heap_.begin(), heap_.end(), less);
  }

  /// Splits the worst box until nothing proven in float is above `goal`, or for `seconds` of processor time.
  SearchResult run(double goal, double seconds) {
    const double begin = processor_seconds();
    std::size_t evaluations = 0;
    for (std::size_t step = 0; static_cast<double>(heap_.front().key) > goal && heap_.size() < 6'000'000;
         ++step) {
      if (step % 64 == 0 && processor_seconds() - begin > seconds) break;
      const Piece piece = heap_.front();
      const std::size_t joints = joints_[piece.output];
      if (joints == 0) break;  // nothing to split: this is the bound
      std::pop_heap(heap_.begin(), heap_.end(), less);
      heap_.pop_back();
      choose(piece, joints);
      evaluate();
      evaluations += batch_.size();
      std::size_t best = 0;
      float least = std::numeric_limits<float>::infinity();
      for (std::size_t b = 0; b < batch_.size(); b += 2) {
        const float score =
            std::max(batch_[b].key, batch_[b + 1].key) + 0.5f * std::min(batch_[b].key, batch_[b + 1].key);
        if (score < least) least = score, best = b;
      }
      for (std::size_t b = best; b < best + 2; ++b) {
        batch_[b].key = std::min(batch_[b].key, piece.key);  // a part is no worse than the whole
        batch_[b].in_double = std::min(batch_[b].in_double, piece.in_double);
        heap_.push_back(batch_[b]);
        std::push_heap(heap_.begin(), heap_.end(), less);
      }
    }
    SearchResult out;
    for (const Piece& p : heap_) {
      out.in_float = std::max(out.in_float, static_cast<double>(p.key));
      out.in_double = std::max(out.in_double, p.in_double);
    }
    out.boxes = heap_.size();
    out.evaluations = evaluations;
    out.seconds = processor_seconds() - begin;
    std::vector<Piece> sorted = heap_;
    const std::size_t kept = std::min<std::size_t>(sorted.size(), 256);
    std::partial_sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(kept), sorted.end(),
                      [](const Piece& a, const Piece& b) { return a.key > b.key; });
    out.worst.assign(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(kept));
    return out;
  }

 private:
  static bool less(const Piece& a, const Piece& b) noexcept { return a.key < b.key; }
  /// Fills the batch with the halves of every joint that is not much narrower than the widest. (Half a turn gains
  /// nothing yet, whichever joint it is.)
  void choose(const Piece& piece, std::size_t joints) {
    batch_.clear();
    float widest = 0;
    for (std::size_t j = 0; j < joints; ++j)
      widest = std::max(widest, piece.ends[2 * j + 1] - piece.ends[2 * j]);
    const float least = widest * (widest > 1 ? 0.5f : 0.25f);
    for (std::size_t j = 0; j < joints; ++j) {
      const float low = piece.ends[2 * j], high = piece.ends[2 * j + 1];
      if (high - low < least) continue;
      const float middle = low + (high - low) / 2;
      batch_.push_back(piece);
      batch_.back().ends[2 * j + 1] = middle;
      batch_.push_back(piece);
      batch_.back().ends[2 * j] = middle;
    }
  }
  /// Errors of the batch, all of the same result.
  void evaluate() {
    Output& output = outputs_[batch_[0].output];
    const auto& inputs = output.inputs();
    lows_.resize(inputs.size()), highs_.resize(inputs.size());
    for (std::size_t from = 0; from < batch_.size(); from += lanes) {
      const std::size_t held = std::min(lanes, batch_.size() - from);
      std::size_t split = 0;
      for (std::size_t i = 0; i < inputs.size(); ++i) {
        const Range& range = ranges_[inputs[i]];
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
        batch_[from + w].in_double = errors.in_double[w];
      }
    }
  }

  std::vector<Output>& outputs_;
  const std::vector<Range>& ranges_;
  std::vector<std::size_t> joints_;
  std::vector<Piece> heap_, batch_;
  std::vector<L> lows_, highs_;
};

}  // namespace skinctl::bounds
