// A simulated detector of objects: noisy, late, and it misses some.
#pragma once

#include <deque>
#include <random>
#include <vector>

#include "examples/packing_oranges/world.hpp"
#include "skinctl/semantics/world.hpp"

namespace packing {

struct DetectorSettings {
  skinctl::Nanoseconds period = 33ms;   ///< between two pictures
  skinctl::Nanoseconds latency = 60ms;  ///< from a picture until its detections arrive
  double sigma = 0.005;                 ///< deviation of each coordinate [m]
  double missed = 0.05;                 ///< share of the objects that a picture misses
};

/// What a picture shows, when it has arrived.
struct Picture {
  skinctl::Nanoseconds taken{}, arrives{};
  std::vector<skinctl::Detection<>> seen;
};

/// Takes pictures of a world. While it is `blind` it takes none, as when its process has died.
class Detector {
 public:
  Detector(const DetectorSettings& settings, std::uint64_t seed) : s_(settings), random_(seed) {}

  void step(const World& world, bool blind) {
    if (world.now() < next_) return;
    next_ = world.now() + s_.period;
    if (blind) return;
    Picture p{world.now(), world.now() + s_.latency, {}};
    for (std::size_t k = 0; k < arms * slots; ++k) {
      if (!world.there(k) || std::bernoulli_distribution(s_.missed)(random_)) continue;
      const auto at = world.orange(k);
      const auto noisy = [&](double x) { return x + s_.sigma * normal_(random_); };
      p.seen.push_back({.object = static_cast<std::uint8_t>(k),
                        .X_WO = skinctl::ObjectPose<>::translation_xyz(noisy(at.x), noisy(at.y), noisy(at.z)),
                        .sigma = s_.sigma,
                        .time = p.taken});
    }
    under_way_.push_back(std::move(p));
  }
  /// The next picture that has arrived, or none.
  [[nodiscard]] bool take(skinctl::Nanoseconds now, Picture& out) {
    if (under_way_.empty() || under_way_.front().arrives > now) return false;
    out = std::move(under_way_.front());
    under_way_.pop_front();
    return true;
  }

 private:
  DetectorSettings s_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::deque<Picture> under_way_;
  skinctl::Nanoseconds next_{};
};

}  // namespace packing
