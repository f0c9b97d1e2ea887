// A column of a study's table: the median of its values, and the largest.
#pragma once

#include <algorithm>
#include <cstdio>
#include <vector>

struct MedianAndWorst {
  std::vector<double> values;
  /// @param format  of both.
  void print(const char* format) {
    std::sort(values.begin(), values.end());
    std::printf(format, values[values.size() / 2], values.back());
  }
};
