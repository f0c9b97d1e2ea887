// Puts oranges before the arms, looks where they end, and keeps the count: the judge, who knows which one is good.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "examples/packing_oranges/world.hpp"

namespace packing {

struct SupplySettings {
  int oranges = 12;
  double good = 6000, bad = 2500;  ///< stiffness [N/m]
  double spread = 0.1;             ///< relative deviation of an orange from its kind
  double share = 0.5;              ///< of good ones
  bool waits = false;  ///< a place is filled again when its orange was let go elsewhere, not when it is taken
  /// Oranges stay in box and bins, until a person puts an empty one in the place of a full one, over which no hand is.
  bool stay = false;
  int full_box = 8, full_bin = 3;  ///< so many are full
  /// Arms put full boxes away: a person fetches one where an arm has put it, some time later, and puts an empty one
  /// where the boxes are filled.
  bool boxes_come = false;
  double fetched_after = 3;  ///< [s]
};

/// Where an orange has ended.
struct Packed {
  std::size_t arm = 0;
  bool good = false;
  double stiffness = 0;
  enum class End : unsigned char { box, bin, lost } end = End::lost;
  double time = 0;  ///< [s]
  [[nodiscard]] bool right() const { return end == (good ? End::box : End::bin); }
};

class Supply {
 public:
  Supply(const SupplySettings& settings, std::uint64_t seed) : s_(settings), random_(seed) {
    for (auto& row : at_) row.fill(nobody);
  }
  /// Every few milliseconds.
  void step(World& world) {
    for (std::size_t arm = 0; arm < arms; ++arm) {
      for (std::size_t k = arm * slots; k < (arm + 1) * slots; ++k)
        if (world.there(k)) look_at(world, arm, k);
      if (given_ < s_.oranges) fill(world, arm);
    }
    for (std::size_t k = 0; s_.stay && k < tray_count; ++k) put_away(world, k);
  }
  [[nodiscard]] bool over() const { return static_cast<int>(ended_.size()) == s_.oranges; }
  [[nodiscard]] const std::vector<Packed>& ended() const { return ended_; }
  [[nodiscard]] int given() const { return given_; }
  /// How often a person has put a full box or bin away.
  [[nodiscard]] int put_away() const { return put_away_; }
  /// How often a person has fetched a box where an arm had put it.
  [[nodiscard]] int fetched() const { return fetched_; }
  [[nodiscard]] const SupplySettings& settings() const { return s_; }
  [[nodiscard]] double stiffness(std::size_t slot) const { return kind_[slot].stiffness; }
  [[nodiscard]] bool good(std::size_t slot) const { return kind_[slot].good; }

 private:
  static constexpr std::size_t nobody = 99;
  struct Kind {
    bool good = false;
    double stiffness = 0;
    skinctl::Nanoseconds lies{};  ///< since when it has lain where it is
    int ended = -1;               ///< its number among `ended_`, where it has ended and stays
  };
  static constexpr double over_tray = 0.35;  ///< distance of a hand from the middle that is over a tray [m]

  void look_at(World& world, std::size_t arm, std::size_t k) {
    const auto p = world.orange(k);
    Kind& o = kind_[k];
    const auto now = world.now();
    const bool held = world.touched(k) >= skinctl::Nanoseconds(0) && now - world.touched(k) < 100ms;
    if (held || norm(world.orange_velocity(k)) > 0.05) o.lies = now;
    const bool waits = feed_tray(arm).holds(p);
    for (auto& place : at_[arm])
      if (place == k && (s_.waits ? !waits && !held : !waits || p.z > 0.1)) place = nobody;
    if (waits || held) return;
    const bool in_box = world.tray(0).holds(p);
    bool in_bin = false;
    for (std::size_t a = 0; a < arms; ++a) in_bin = in_bin || world.tray(1 + a).holds(p);
    const auto patience = in_box || in_bin ? 500ms : 3000ms;
    if (now - o.lies < patience && norm(p) < 3) return;
    const auto end = in_box ? Packed::End::box : in_bin ? Packed::End::bin : Packed::End::lost;
    if (o.ended >= 0)
      ended_[static_cast<std::size_t>(o.ended)].end = end;
    else
      ended_.push_back({arm, o.good, o.stiffness, end, skinctl::seconds<double>(now)});
    const bool stays = s_.stay && end != Packed::End::lost;
    if (stays && o.ended < 0) o.ended = static_cast<int>(ended_.size()) - 1;
    if (!stays) world.take_out(k);
  }
  void put_away(World& world, std::size_t tray) {
    const Tray at = world.tray(tray);
    int in_it = 0;
    const auto each = [&](const auto& f) {
      for (std::size_t k = 0; k < arms * slots; ++k)
        if (world.there(k) && kind_[k].ended >= 0 && at.holds(world.orange(k))) f(k);
    };
    each([&](std::size_t) { ++in_it; });
    if (in_it < (tray == 0 ? s_.full_box : s_.full_bin)) return;
    bool stands = true;
    for (std::size_t a = 0; a < arms; ++a)
      if (const auto p = world.hand(a); std::hypot(p.x - at.x, p.y - at.y) < over_tray) stands = false;
    if (tray == 0 && s_.boxes_come) {
      if (!stands || !is_put(at)) stood_since_ = world.now();
      if (world.now() - stood_since_ < skinctl::nanoseconds(s_.fetched_after)) return;
      ++fetched_;
    }
    if (!stands) return;
    each([&](std::size_t k) { world.take_out(k); });
    if (tray == 0 && s_.boxes_come) world.put_tray(0, {world.first()[0].x, world.first()[0].y, 0});
    ++put_away_;
  }
  /// Whether a box stands where an arm puts full ones.
  [[nodiscard]] static bool is_put(const Tray& box) {
    for (std::size_t a = 0; a < arms; ++a)
      if (const auto p = shelf_place(a); std::hypot(p.x - box.x, p.y - box.y) < put_within) return true;
    return false;
  }
  void fill(World& world, std::size_t arm) {
    for (std::size_t place = 0; place < feed_places; ++place) {
      if (at_[arm][place] != nobody || given_ >= s_.oranges) continue;
      for (std::size_t k = arm * slots; k < arm * slots + world.room(); ++k) {
        if (world.there(k)) continue;
        const auto p = feed_place(arm, place);
        bool room = norm(skinctl::Xyz<double>(world.hand(arm) - p)) > 0.25;
        for (std::size_t j = 0; j < arms * slots; ++j)
          room = room && (!world.there(j) || norm(skinctl::Xyz<double>(world.orange(j) - p)) > 0.12);
        if (!room) break;
        Kind& o = kind_[k];
        o.good = uniform_(random_) < s_.share;
        const double z = std::clamp(normal_(random_), -3.0, 3.0);
        o.stiffness = (o.good ? s_.good : s_.bad) * (1 + s_.spread * z);
        o.lies = world.now();
        o.ended = -1;
        const auto off = [&] { return 0.02 * (uniform_(random_) - 0.5); };
        const double dx = off(), dy = off(), radius = 0.038 + 0.008 * (uniform_(random_) - 0.5);
        world.put(k, {p.x + dx, p.y + dy, 0}, {radius, o.stiffness});
        at_[arm][place] = k;
        ++given_;
        break;
      }
    }
  }

  SupplySettings s_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{0, 1};
  std::normal_distribution<double> normal_;
  std::array<Kind, arms * slots> kind_{};
  std::array<std::array<std::size_t, feed_places>, arms> at_{};
  std::vector<Packed> ended_;
  int given_ = 0, put_away_ = 0, fetched_ = 0;
  skinctl::Nanoseconds stood_since_{};  ///< when a full box has stood where a person fetches it
};

}  // namespace packing
