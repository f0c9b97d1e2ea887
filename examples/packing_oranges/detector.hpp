// A simulated detector of objects: noisy, late, and it misses some. An honest one does not tell which orange
// it saw, and sees some that are not there.
#pragma once

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <vector>

#include "examples/packing_oranges/plan.hpp"
#include "examples/packing_oranges/world.hpp"
#include "skinctl/model/moving_base.hpp"
#include "skinctl/semantics/tracks_from_base.hpp"

namespace packing {

struct DetectorSettings {
  skinctl::Nanoseconds period = 33ms;   ///< between two pictures
  skinctl::Nanoseconds latency = 60ms;  ///< from a picture until its detections arrive
  double sigma = 0.005;                 ///< deviation of each coordinate [m]
  double missed = 0.05;                 ///< share of the objects that a picture misses
  bool numbers = true;        ///< it tells which orange it sees; false: the class, and with the errors below
  double flashes = 0.02;      ///< detections of nothing, for each of something
  double wrong_class = 0.01;  ///< share of the detections with another class
  int ghosts = 0;             ///< oranges that it sees in the feeds all the time, and that do not exist
  double bias = 0;            ///< of all places, in a direction that follows from the seed [m]
};

/// What a picture shows, when it has arrived.
struct Picture {
  skinctl::Nanoseconds taken{}, arrives{};
  std::vector<skinctl::Detection<>> seen;         ///< with numbers
  std::vector<skinctl::ClassDetection<>> things;  ///< without
  skinctl::BaseState<> base;                      ///< where the robot took itself to stand when it was taken
  double range = 1e9;                             ///< of the camera, from the robot's middle [m]
};

/// Takes pictures of a world. While it is `blind` it takes none, as when its process has died.
class Detector {
 public:
  Detector(const DetectorSettings& settings, std::uint64_t seed) : s_(settings), random_(seed) {
    if (s_.bias > 0) {
      const double angle = between(-M_PI, M_PI);
      bias_ = {s_.bias * std::cos(angle), s_.bias * std::sin(angle), 0};
    }
    if (s_.numbers) return;
    for (int g = 0; g < s_.ghosts; ++g) ghosts_.push_back(empty_place(static_cast<std::size_t>(g) % arms));
  }
  /// Where it sees oranges that do not exist, without its bias.
  [[nodiscard]] const std::vector<skinctl::Xyz<double>>& ghosts() const { return ghosts_; }
  [[nodiscard]] const skinctl::Xyz<double>& bias() const { return bias_; }
  /// A hand within this distance beside a thing, and at most so high above it, hides it [m].
  static constexpr double hides = 0.07, hides_below = 0.12;

  /// @param base  where a robot that drives takes itself to stand: its camera drives with it.
  void step(const World& world, bool blind, const skinctl::BaseState<>* base = nullptr) {
    if (world.now() < next_) return;
    next_ = world.now() + s_.period;
    if (blind) return;
    Picture p;
    p.taken = world.now(), p.arrives = p.taken + s_.latency;
    if (!s_.numbers) {
      if (base != nullptr) p.base = *base, p.range = camera_range;
      look(world, p);
      under_way_.push_back(std::move(p));
      return;
    }
    for (std::size_t k = 0; k < arms * slots; ++k) {
      if (!world.there(k) || std::bernoulli_distribution(s_.missed)(random_)) continue;
      const auto at = world.orange(k);
      const auto noisy = [&](double x) { return x + s_.sigma * normal_(random_); };
      p.seen.push_back({.object = static_cast<std::uint8_t>(k),
                        .X_WO = skinctl::ObjectPose<>::translation_xyz(noisy(at.x) + bias_.x,
                                                                       noisy(at.y) + bias_.y, noisy(at.z)),
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
  using Place = skinctl::Xyz<double>;
  [[nodiscard]] double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  [[nodiscard]] bool happens(double share) { return std::bernoulli_distribution(share)(random_); }
  [[nodiscard]] Place anywhere_in(std::size_t arm) {
    const Tray feed = feed_tray(arm);
    constexpr double margin = 0.03, middle = 0.038;
    return {feed.x + (feed.half_x - margin) * between(-1, 1),
            feed.y + (feed.half_y - margin) * between(-1, 1), middle};
  }
  /// In a feed, as far from where oranges lie and from other ghosts as an orange is wide.
  [[nodiscard]] Place empty_place(std::size_t arm) {
    for (;;) {
      const Place p = anywhere_in(arm);
      const auto far = [&](const Place& q) { return std::hypot(p.x - q.x, p.y - q.y) > 0.076; };
      bool empty = std::all_of(ghosts_.begin(), ghosts_.end(), far);
      for (std::size_t k = 0; k < feed_places; ++k) empty = empty && far(feed_place(arm, k));
      if (empty) return p;
    }
  }
  static constexpr double camera_range = 1.05;  ///< of a robot that drives: it sees the table before it [m]
  void look(const World& world, Picture& picture) {
    std::vector<skinctl::ClassDetection<>>& out = picture.things;
    const bool drives = picture.range < 1e9;
    const Standing robot = world.robot();
    const auto X_RW = robot.pose().inverse();
    const auto add = [&](const Place& p, skinctl::ObjectClass kind) {
      if (std::hypot(p.x - robot.x, p.y - robot.y) > picture.range) return;
      const auto noisy = [&](double x) { return x + s_.sigma * normal_(random_); };
      const skinctl::ObjectClass wrong = kind == bin_class ? box_class : bin_class;
      Place seen{noisy(p.x) + bias_.x, noisy(p.y) + bias_.y, noisy(p.z)};
      if (drives) {
        const skinctl::DetectionFromBase<> from_base{X_RW.origin() + X_RW.axes() * seen, s_.sigma, kind};
        seen = in_world(picture.base, from_base).p_W;
      }
      out.push_back({seen, s_.sigma, happens(s_.wrong_class) ? wrong : kind});
    };
    const auto see = [&](const Place& p, skinctl::ObjectClass kind) {
      bool hidden = false;
      for (std::size_t a = 0; a < arms; ++a) {
        const Place hand = world.hand(a);
        hidden = hidden || (std::hypot(hand.x - p.x, hand.y - p.y) < hides && hand.z - p.z < hides_below);
      }
      if (!hidden && !happens(s_.missed)) add(p, kind);
      if (happens(s_.flashes)) add(anywhere_in(happens(0.5) ? 1 : 0), orange_class);
    };
    for (std::size_t k = 0; k < arms * slots; ++k)
      if (world.there(k)) see(world.orange(k), world.has_tool(k) ? tool_class : orange_class);
    for (const Place& p : ghosts_) see(p, orange_class);
    for (std::size_t k = 0; k < tray_count; ++k) {
      const Tray t = world.tray(k);
      see({t.x, t.y, 0}, k == 0 ? box_class : bin_class);
    }
    for (const Place& p : table_marks)
      if (drives) see(p, mark_class);
    std::shuffle(out.begin(), out.end(), random_);
  }

  DetectorSettings s_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::deque<Picture> under_way_;
  skinctl::Nanoseconds next_{};
  Place bias_{0, 0, 0};
  std::vector<Place> ghosts_;
};

}  // namespace packing
