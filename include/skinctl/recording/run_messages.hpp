// SPDX-License-Identifier: BSD-3-Clause
// A run as ROS 2 messages: joint states, torque shares, cells, contacts, status. What files, streams and DDS
// send alike.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "skinctl/cycle/stage.hpp"
#include "skinctl/guard/faults.hpp"
#include "skinctl/io/formatted.hpp"
#include "skinctl/recording/contact_picture.hpp"
#include "skinctl/recording/cycle_numbers.hpp"
#include "skinctl/recording/run_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Encodes the topics of a cycle into bytes that stay until the next call. For the thread beside the loop.
/// `CycleMessages` is this for the cycles of a scene.
class RunMessages {
 public:
  using Bytes = std::span<const unsigned char>;

  /// Throws `ConfigurationError` for another number of names than joints, and where `SkinCloud` and
  /// `ContactPicture` do.
  RunMessages(RunDescription run, std::size_t joints, std::size_t laws)
      : joints_(joints),
        laws_(laws),
        run_(std::move(run)),
        cloud_(run_.cells, {run_.base, run_.newtons, run_.max_age}) {
    require(run_.joints.size() == joints, "RunDescription: joints", double(run_.joints.size()),
            "one name for each joint");
    if (!run_.pressed.places.empty())
      picture_ = std::make_unique<ContactPicture>(run_.pressed, double(run_.newtons));
    for (std::size_t k = 0; k < laws; ++k) {
      if (k >= run_.laws.size()) run_.laws.push_back("law " + std::to_string(k + 1));
      label_ += (k > 0 ? "," : "") + run_.laws[k];
    }
  }
  [[nodiscard]] const RunDescription& run() const noexcept { return run_; }

  /// Takes the samples of a cycle; to be called for each one before its messages.
  void take(const CycleNumbers& r) noexcept {
    cloud_.set(r.samples);
    if (picture_)
      for (const CellSample& s : r.samples) picture_->take(s);
  }
  /// `/tf`: every frame in the base, by the measured positions. Empty without frames.
  [[nodiscard]] Bytes tf(const CycleNumbers& r) {
    places(r);
    std::vector<ros::StampedTransform> all;
    for (const RunFrame& f : run_.frames) {
      if (f.link >= places_.size()) continue;
      const LinkPlace& l = places_[f.link];
      all.push_back({r.now, run_.base, f.name, l.R * f.in_link.p + l.p, l.R * f.in_link.R});
    }
    return all.empty() ? Bytes() : encoded(ros::Transforms{all});
  }
  /// `/skin/cells` as of this cycle; lies in this object until the next call. Empty without cells.
  [[nodiscard]] Bytes cells(const CycleNumbers& r) {
    if (cloud_.cells() == 0) return {};
    places(r);
    for (std::size_t i = 0; i < places_.size(); ++i)
      cloud_.place(static_cast<std::uint32_t>(i), places_[i].R, places_[i].p);
    return cloud_.encode(r.now);
  }
  /// `/skin/contacts` as of this cycle: clusters of pressed cells. Empty where the run tells no cells for it.
  [[nodiscard]] Bytes contacts(const CycleNumbers& r) {
    if (!picture_) return {};
    return encoded(contact_cloud(r.now, run_.base, picture_->find(r.now, places(r))));
  }
  /// Poses of the links in this cycle, by the measured positions; empty where the run does not tell.
  const std::vector<LinkPlace>& places(const CycleNumbers& r) {
    if (!run_.places) return places_;
    q_.assign(r.q.begin(), r.q.end());
    run_.places(q_, places_);
    return places_;
  }
  [[nodiscard]] SkinCloud& cloud() noexcept { return cloud_; }
  /// `/joint_states`: measured positions and velocities, commanded torques where the command has them.
  [[nodiscard]] Bytes joint_states(const CycleNumbers& r) {
    return encoded(ros::JointState{r.measured, "", run_.joints, r.q, r.dq, r.torque});
  }
  /// `/skinctl/torque_shares`: a row for each law [N m].
  [[nodiscard]] Bytes torque_shares(const CycleNumbers& r) {
    return encoded(ros::Matrix{{label_, "joint"}, laws_, joints_, r.shares});
  }
  /// `/skinctl/status`: JSON with the cycle's number, the names of reasons, the stages' times [us] and the
  /// cycles that found no room.
  [[nodiscard]] Bytes status(const CycleNumbers& r, Status since_last, std::uint64_t dropped) {
    std::string text = "{\"cycle\":" + std::to_string(r.number) + ",\"reasons\":[";
    const char* between = "";
    since_last.for_each([&](Reason reason) {
      text += between + ("\"" + std::string(name(reason)) + "\"");
      between = ",";
    });
    text += "],\"times_us\":{";
    for (std::size_t s = 0; s < stage_count; ++s) {
      text += formatted("%s\"%s\":%.3f", s > 0 ? "," : "", name(static_cast<CycleStage>(s)),
                        1e-3 * static_cast<double>(r.times[s].count()));
    }
    text += "},\"dropped\":" + std::to_string(dropped) + "}";
    return encoded(ros::String{text});
  }
  /// The bytes of any message; they lie in this object until the next one.
  template <class M>
  [[nodiscard]] Bytes encoded(const M& message) {
    for (;;) {
      CdrWriter writer(bytes_);
      ros::encode(writer, message);
      if (writer.fits()) return writer.bytes();
      bytes_.resize(writer.size());
    }
  }

 private:
  std::size_t joints_, laws_;
  RunDescription run_;
  SkinCloud cloud_;
  std::unique_ptr<ContactPicture> picture_;
  std::string label_;
  std::vector<double> q_;
  std::vector<LinkPlace> places_;
  std::vector<unsigned char> bytes_;
};

SKINCTL_END_NAMESPACE
