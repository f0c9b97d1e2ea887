// The consumer that publishes a run over DDS.
#pragma once

#include "examples/adapters/dds/skin.hpp"
#include "skinctl/recording/cycle_messages.hpp"
#include "skinctl/recording/cycle_thread.hpp"

namespace adapters::dds {

/// Publishes cycles as ROS 2 has them: joint states of every cycle, reliably; cells as often as samples came,
/// best effort; robot and skin once, also for readers that come later. Each write is a system call in the
/// thread beside the loop.
template <class C>
class DdsView : public skinctl::CycleConsumer<C> {
 public:
  using typename skinctl::CycleConsumer<C>::Beginning;

  /// The participant must live longer. Throws where `RawWriter` and `CycleMessages` do.
  DdsView(Participant& participant, skinctl::RunDescription run)
      : messages_(std::move(run)),
        joints_(participant, "/joint_states", skinctl::ros::JointState::type(), Delivery::state, 16384),
        cells_(participant, "/skin/cells", skinctl::SkinCloud::type(), Delivery::sensor,
               skin_cloud_size(messages_.cloud().cells())),
        robot_(participant, "/robot_description", skinctl::ros::String::type(), Delivery::latched,
               messages_.run().urdf.size() + 16),
        layout_(participant, "/skin/layout", skinctl::ros::String::type(), Delivery::latched,
                messages_.run().layout.size() + 16) {}

  void start(const Beginning&, std::span<const unsigned char>) override {
    robot_.write(messages_.encoded(skinctl::ros::String{messages_.run().urdf}));
    layout_.write(messages_.encoded(skinctl::ros::String{messages_.run().layout}));
  }
  void cycle(const skinctl::CycleRecord<C>& r) override {
    messages_.take(r);
    refused_ += !joints_.write(messages_.joint_states(r));
    if (r.input.samples.empty()) return;
    const auto cells = messages_.cells(r);
    if (cells.empty()) return;
    refused_ += !cells_.write(cells);
    ++frames_;
  }
  [[nodiscard]] std::uint64_t frames() const noexcept { return frames_; }
  /// Messages that the middleware did not take.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  skinctl::CycleMessages<C> messages_;
  RawWriter joints_, cells_, robot_, layout_;
  std::uint64_t frames_ = 0, refused_ = 0;
};

}  // namespace adapters::dds
