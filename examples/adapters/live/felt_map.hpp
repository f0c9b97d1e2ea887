// How well each place of a skin feels, from a control loop to those who watch.
#pragma once

#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "examples/support/text.hpp"

namespace adapters::live {

/// The loop writes some places in each cycle, a viewer reads all of them: neither waits for the other.
class FeltMap {
 public:
  static constexpr std::size_t each_cycle = 8;  ///< places that are judged in a cycle

  /// @param cells  id of the cell at each place, in the order of the skin.
  explicit FeltMap(std::vector<std::uint32_t> cells)
      : cells_(std::move(cells)), noticed_(cells_.size()), speed_(cells_.size()) {}

  /// In the loop: the next places; `judge(i)` gives the least force that somebody notices at place i [N],
  /// infinite where nobody does, and the speed that it may have [m/s].
  template <class Judge>
  void look(const Judge& judge) noexcept {
    for (std::size_t k = 0; k < each_cycle && k < cells_.size(); ++k) {
      const auto [noticed, speed] = judge(next_);
      noticed_[next_].store(static_cast<float>(noticed), std::memory_order_relaxed);
      speed_[next_].store(static_cast<float>(speed), std::memory_order_relaxed);
      if (++next_ < cells_.size()) continue;
      next_ = 0;
      whole_.store(true, std::memory_order_release);
    }
  }
  /// Whether every place has been judged once.
  [[nodiscard]] bool whole() const noexcept { return whole_.load(std::memory_order_acquire); }
  /// `{"cells": [7], "noticed": [4.1], "speed": [0.25]}`; null: nobody notices a push there.
  [[nodiscard]] std::string text() const {
    std::string cells, noticed, speed;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const char* const comma = i > 0 ? "," : "";
      const float n = noticed_[i].load(std::memory_order_relaxed);
      cells += comma + std::to_string(cells_[i]);
      noticed += comma + (std::isfinite(n) ? examples::text("%.3g", double(n)) : std::string("null"));
      speed += comma + examples::text("%.3g", double(speed_[i].load(std::memory_order_relaxed)));
    }
    return R"({"cells":[)" + cells + R"(],"noticed":[)" + noticed + R"(],"speed":[)" + speed + "]}";
  }

 private:
  std::vector<std::uint32_t> cells_;
  std::vector<std::atomic<float>> noticed_, speed_;
  std::size_t next_ = 0;
  std::atomic<bool> whole_{false};
};

}  // namespace adapters::live
