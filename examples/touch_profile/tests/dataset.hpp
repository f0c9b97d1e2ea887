// Where the recordings are; they are no part of the project.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

/// Set by a test that looked for the recordings in vain.
inline bool& dataset_missed() {
  static bool missed = false;
  return missed;
}

/// Recordings in order of their names; none when `SKINCTL_DATA_DIR` does not lead to them.
inline std::vector<std::filesystem::path> dataset() {
  std::vector<std::filesystem::path> files;
  if (const char* data = std::getenv("SKINCTL_DATA_DIR")) {
    const auto folder = std::filesystem::path(data) / "icub_grasp_tactile" / "iCubGraspDataset";
    std::error_code error;
    for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (it->path().extension() == ".txt") files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  dataset_missed() = files.empty();
  return files;
}
