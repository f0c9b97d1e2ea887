// Records a run into an MCAP file while it runs: what replays, and what people look at.
#pragma once

#include "skinctl/recording/cycle_messages.hpp"
#include "skinctl/recording/cycle_thread.hpp"
#include "skinctl/recording/detail/pace.hpp"
#include "skinctl/recording/recorded_run.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The consumer that writes a file: every cycle as it is replayed, joint states and torque shares of every cycle, cells,
/// contacts and frames at 30 Hz, the status at 10 Hz, robot and skin once. A full disk costs messages, which are counted.
template <class C>
class McapRecorder : public CycleConsumer<C> {
 public:
  using typename CycleConsumer<C>::Beginning;

  /// Replaces an existing file. Throws `ConfigurationError` where it cannot be made, and where `CycleMessages` does.
  McapRecorder(const std::string& path, const RunIdentity& identity, RunDescription run)
      : messages_(std::move(run)), sink_(path), writer_(sink_) {
    writer_.metadata(RunIdentity::name, identity.facts<C>());
    start_ = writer_.channel(CycleTopic::start, CycleTopic::start_encoding);
    cycle_ = writer_.channel(CycleTopic::cycle, CycleTopic::cycle_encoding);
    joints_ = writer_.channel("/joint_states", ros::JointState::type());
    shares_ = writer_.channel("/skinctl/torque_shares", ros::Matrix::type());
    status_ = writer_.channel("/skinctl/status", ros::String::type());
    cells_ = writer_.channel("/skin/cells", SkinCloud::type());
    contacts_ = writer_.channel("/skin/contacts", ros::PointCloud::type());
    tf_ = writer_.channel("/tf", ros::Transforms::type());
    robot_ = writer_.channel("/robot_description", ros::String::type());
    layout_ = writer_.channel("/skin/layout", ros::String::type());
  }

  void start(const Beginning& begin, std::span<const unsigned char> bytes) override {
    const Nanoseconds now = begin.measured.time;
    writer_.write(start_, now, bytes);
    const auto latched = [&](McapChannel channel, const std::string& text) {
      if (!text.empty()) writer_.write(channel, now, messages_.encoded(ros::String{text}));
    };
    latched(robot_, messages_.run().urdf);
    latched(layout_, messages_.run().layout);
  }
  void cycle(const CycleRecord<C>& r) override {
    const Nanoseconds now = r.input.now;
    writer_.write(cycle_, now, r.bytes, r.number);
    messages_.take(r);
    since_ |= r.status;
    ++cycles_;
    writer_.write(joints_, now, messages_.joint_states(r));
    writer_.write(shares_, now, messages_.torque_shares(r));
    if (picture_.due(now)) {
      if (const auto bytes = messages_.cells(r); !bytes.empty()) writer_.write(cells_, now, bytes);
      if (const auto bytes = messages_.contacts(r); !bytes.empty()) writer_.write(contacts_, now, bytes);
      if (const auto bytes = messages_.tf(r); !bytes.empty()) writer_.write(tf_, now, bytes);
    }
    if (said_.due(now)) {
      writer_.write(status_, now, messages_.status(r, since_, dropped_));
      since_ = Status();
    }
  }
  /// A loop that stands closes its chunk too.
  void pause(std::uint64_t dropped) override {
    dropped_ = dropped;
    const auto now = std::chrono::steady_clock::now();
    if (now - flushed_ < std::chrono::seconds(1)) return;
    flushed_ = now;
    writer_.flush();
  }
  /// After the thread's end: writes the summary. False if anything was lost on the way; see `report`.
  bool finish() {
    const bool whole = writer_.finish();
    return whole && writer_.lost() == 0 && dropped_ == 0;
  }
  [[nodiscard]] std::uint64_t cycles() const noexcept { return cycles_; }
  /// Messages that a full disk refused.
  [[nodiscard]] std::uint64_t lost() const noexcept { return writer_.lost(); }
  /// Bytes of the file.
  [[nodiscard]] std::uint64_t size() const noexcept { return writer_.size(); }

 private:
  CycleMessages<C> messages_;
  FileSink sink_;
  McapWriter<FileSink> writer_;
  McapChannel start_, cycle_, joints_, shares_, status_, cells_, contacts_, tf_, robot_, layout_;
  detail::Pace picture_{33ms}, said_{100ms};
  Status since_;
  std::uint64_t cycles_ = 0, dropped_ = 0;
  std::chrono::steady_clock::time_point flushed_ = std::chrono::steady_clock::now();
};

SKINCTL_END_NAMESPACE
