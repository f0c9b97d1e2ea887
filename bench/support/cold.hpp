// Times of a function hot, and cold: with this program's code and its data flushed from the caches.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

extern "C" {
extern const char __executable_start, etext;  // NOLINT: the linker's names
}

namespace skinctl::bench {

/// Pushes this program's code, and `bytes` from `data` on, out of all caches. Elsewhere than on x86-64 by
/// reading much else, which leaves code where it is.
inline void flush(const void* data, std::size_t bytes) {
#if defined(__x86_64__)
  const auto lines = [](const char* from, const char* to) {
    for (const char* p = from; p < to; p += 64) _mm_clflush(p);
  };
  lines(&__executable_start, &etext);
  lines(static_cast<const char*>(data), static_cast<const char*>(data) + bytes);
  _mm_mfence();
#else
  static std::vector<char> much(std::size_t(64) << 20);
  for (std::size_t i = 0; i < much.size(); i += 64) ++much[i];
  static_cast<void>(data), static_cast<void>(bytes);
#endif
}
inline double now_us() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
inline double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + std::ptrdiff_t(x.size() / 2), x.end());
  return x[x.size() / 2];
}

/// One call right after another [us]. Others have the machine too: the fastest of some hundred rows of 50.
template <class F>
double hot(F&& once) {
  constexpr int row = 50;
  double best = 1e300;
  for (int k = 0; k < 400; ++k) {
    const double a = now_us();
    for (int i = 0; i < row; ++i) once();
    best = std::min(best, (now_us() - a) / row);
  }
  return best;
}
/// One call after a flush [us]: the median of some hundred, less what reading the clock takes then.
template <class F>
double cold(F&& once, const void* data, std::size_t bytes) {
  std::vector<double> took, clock;
  for (int k = 0; k < 201; ++k) {
    once();
    flush(data, bytes);
    double a = now_us();
    clock.push_back(now_us() - a);
    a = now_us();
    once();
    took.push_back(now_us() - a);
  }
  return median(took) - median(clock);
}

}  // namespace skinctl::bench
